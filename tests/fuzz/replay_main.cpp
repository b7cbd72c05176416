// Without libFuzzer: `fuzz_replay TARGET FOLDER` runs a target over the inputs in a folder, each of which
// must come to its end; `fuzz_replay --targets` names all; `fuzz_replay --seeds TARGET FOLDER` writes what to
// begin with.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/targets.h"

namespace {

using namespace coppice::fuzz;

int replay(const Target& target, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const auto& file : files) {
    std::cout << file.filename().string() << std::endl;  // the last one named is the one that fails
    std::ifstream in(file, std::ios::binary);
    const Input input{std::istreambuf_iterator<char>(in), {}};
    target.run(input);
  }
  std::cout << files.size() << " inputs of " << target.name << '\n';
  return files.empty() ? 1 : 0;
}

int write_seeds(const Target& target, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const Input& seed : target.seeds()) {
    std::ofstream out(folder / ("seed-" + std::to_string(++number)), std::ios::binary);
    out.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments == std::vector<std::string>{"--targets"}) {
    for (const auto& targets : {file_targets(), bus_targets()}) {
      for (const Target& target : targets) std::cout << target.name << '\n';
    }
    return 0;
  }
  const bool seeds = !arguments.empty() && arguments[0] == "--seeds";
  if (arguments.size() != (seeds ? 3u : 2u)) {
    std::cerr << "expected TARGET FOLDER, --seeds TARGET FOLDER or --targets\n";
    return 2;
  }
  const Target* const target = find_target(arguments[seeds ? 1 : 0]);
  if (target == nullptr) {
    std::cerr << "no target of that name; --targets names them\n";
    return 2;
  }
  return seeds ? write_seeds(*target, arguments[2]) : replay(*target, arguments[1]);
}

// The main program without libFuzzer: `fuzz_replay TARGET FOLDER` runs a target over its seeds and the inputs
// in a folder, each of which must end. `fuzz_replay --targets` lists all targets.
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
  const std::vector<Input> seeds = target.seeds();
  for (const Input& seed : seeds) target.run(seed);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const auto& file : files) {
    std::cout << file.filename().string() << std::endl;  // the last printed name is the one that fails
    std::ifstream in(file, std::ios::binary);
    const Input input{std::istreambuf_iterator<char>(in), {}};
    target.run(input);
  }
  std::cout << seeds.size() << " seeds and " << files.size() << " inputs of " << target.name << '\n';
  return seeds.empty() || files.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments == std::vector<std::string>{"--targets"}) {
    for (const auto& targets : all_targets()) {
      for (const Target& target : targets) std::cout << target.name << '\n';
    }
    return 0;
  }
  if (arguments.size() != 2) {
    std::cerr << "expected TARGET FOLDER or --targets\n";
    return 2;
  }
  const Target* const target = find_target(arguments[0]);
  if (target == nullptr) {
    std::cerr << "no target of that name; --targets names them\n";
    return 2;
  }
  return replay(*target, arguments[1]);
}

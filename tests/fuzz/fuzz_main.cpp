// The main program with libFuzzer: --target=NAME selects the target; --seeds=FOLDER first writes the seeds
// into a folder.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <spdlog/spdlog.h>

#include "tests/fuzz/targets.h"

namespace {

const coppice::fuzz::Target* target = nullptr;

void write_seeds(const std::filesystem::path& folder) {
  int number = 0;
  for (const coppice::fuzz::Input& seed : target->seeds()) {
    std::ofstream out(folder / ("seed-" + std::to_string(++number)), std::ios::binary);
    out.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
  }
}

/// The value of an argument `option=value`; empty if it is another option.
std::string_view value_of(std::string_view argument, std::string_view option) {
  return argument.starts_with(option) ? argument.substr(option.size()) : std::string_view();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  std::string_view seeds;
  for (int k = 1; k < *argc; ++k) {
    const std::string_view argument = (*argv)[k];
    if (const auto name = value_of(argument, "--target="); !name.empty())
      target = coppice::fuzz::find_target(name);
    if (const auto folder = value_of(argument, "--seeds="); !folder.empty()) seeds = folder;
  }
  if (target == nullptr) {
    std::fprintf(stderr, "expected --target=NAME of a target\n");
    std::exit(2);
  }
  if (!seeds.empty()) write_seeds(seeds);
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({data, size});
  return 0;
}

// With libFuzzer: --target=NAME says which.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <spdlog/spdlog.h>

#include "tests/fuzz/targets.h"

namespace {

const coppice::fuzz::Target* target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr const char* option = "--target=";
  for (int k = 1; k < *argc; ++k) {
    if (std::strncmp((*argv)[k], option, std::strlen(option)) == 0)
      target = coppice::fuzz::find_target((*argv)[k] + std::strlen(option));
  }
  if (target == nullptr) {
    std::fprintf(stderr, "expected --target=NAME of a target\n");
    std::exit(2);
  }
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->run({data, size});
  return 0;
}

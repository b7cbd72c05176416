// The command line `coppice`. Each command is a function of commands.h.

#include <exception>
#include <iostream>

#include <CLI/CLI.hpp>
#ifdef COPPICE_MIMALLOC
#include <mimalloc.h>
#endif

#include "coppice/command_table.h"
#include "runtime/command_line.h"
#include "runtime/process.h"

namespace {

using namespace coppice;

/// The memory of a simulated fleet exceeds the reach of a translation lookaside buffer with pages of 4 KiB.
void use_huge_pages() {
#ifdef COPPICE_MIMALLOC
  mi_option_enable(mi_option_large_os_pages);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app;
  CommandOptions options;
  ChosenCommand chosen;
  add_commands(app, options, chosen);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;

  set_up_logging("coppice", "info");
  if (app.got_subcommand("simulate") || app.got_subcommand("fuzz")) use_huge_pages();
  try {
    return chosen();
  } catch (const std::exception& problem) {
    std::cerr << problem.what() << '\n';
    return 2;
  }
}

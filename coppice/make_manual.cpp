// make_manual MAN1 COMPLETIONS: writes the compressed manual pages and the completions for bash into the two
// folders, from the options that the programs parse.

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include <zlib.h>

#include "coppice/command_table.h"
#include "coppice/completion.h"
#include "coppice/manual_page.h"

namespace {

using namespace coppice;

void write_compressed(const std::filesystem::path& file, const std::string& text) {
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> out(gzopen(file.c_str(), "wb9"), &gzclose);
  if (!out || gzwrite(out.get(), text.data(), static_cast<unsigned>(text.size())) <= 0 ||
      gzflush(out.get(), Z_FINISH) != Z_OK)
    throw std::runtime_error(file.string() + ": cannot be written");
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  if (!(out << text << std::flush)) throw std::runtime_error(file.string() + ": cannot be written");
}

void run(const std::filesystem::path& man1, const std::filesystem::path& completions) {
  visit_programs([&](const CLI::App& program) {
    for (const ManualPage& page : manual_pages(program))
      write_compressed(man1 / (page.name + ".1.gz"), page.text);
    write(completions / program.get_name(), bash_completion(program));
  });
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> arguments(argv, static_cast<std::size_t>(argc));
  if (arguments.size() != 3) {
    std::cerr << "expected two folders: make_manual MAN1 COMPLETIONS\n";
    return 2;
  }
  try {
    run(arguments[1], arguments[2]);
  } catch (const std::exception& problem) {
    std::cerr << problem.what() << '\n';
    return 2;
  }
  return 0;
}

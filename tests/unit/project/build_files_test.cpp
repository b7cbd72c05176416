// Tests of Coppice as a part of another CMake project.

#include <filesystem>
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

/// The compiler command for the consumer's own source.
std::string command_of_consumer(const std::filesystem::path& build) {
  const std::string commands = test::contents(build / "compile_commands.json");
  std::smatch found;
  if (!std::regex_search(commands, found, std::regex(R"re("command": "([^\n]*tests/consumer/main\.cpp))re")))
    return {};
  return found[1];
}

TEST(BuildFiles, ACMakeProjectAddsCoppiceWithoutInheritingItsOptions) {
  const test::TemporaryFolder folder;
  const std::filesystem::path build = folder.path() / "build";
  const std::string ours = COPPICE_SOURCE_DIR;
  const test::Outcome configured = test::shell(
      fmt::format("cmake -G Ninja -S '{0}/tests/consumer' -B '{1}' -DCOPPICE='{0}'", ours, build.string()));
  ASSERT_EQ(configured.exit_code, 0) << configured.output;
  const test::Outcome built =
      test::shell(fmt::format("cmake --build '{}' --target consumer", build.string()));
  ASSERT_EQ(built.exit_code, 0) << built.output;
  EXPECT_EQ(test::shell("'" + (build / "consumer").string() + "'").exit_code, 0);
  const std::string command = command_of_consumer(build);
  EXPECT_NE(command.find("-std="), std::string::npos) << command;
  EXPECT_FALSE(std::regex_search(command, std::regex(" -[WDf]"))) << command;
  const std::string tests = test::shell("cd '" + build.string() + "' && ctest -N").output;
  EXPECT_NE(tests.find("Total Tests: 0"), std::string::npos) << tests;
}

TEST(BuildFiles, NoBuildFileNamesATopLevelFolderOfCMake) {
  int files = 0;
  auto entry = std::filesystem::recursive_directory_iterator(COPPICE_SOURCE_DIR);
  for (; entry != std::filesystem::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && (name == "build" || name == "node_modules" || name == ".git"))
      entry.disable_recursion_pending();
    if (name != "CMakeLists.txt" && !name.ends_with(".cmake")) continue;
    const std::string text = test::contents(entry->path());
    EXPECT_EQ(text.find("CMAKE_SOURCE_DIR"), std::string::npos) << entry->path();
    EXPECT_EQ(text.find("CMAKE_BINARY_DIR"), std::string::npos) << entry->path();
    ++files;
  }
  EXPECT_GT(files, 10);
}

}  // namespace
}  // namespace coppice

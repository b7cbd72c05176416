// Test of the installed libraries: the examples build against them, as another project would, and run.
//
// CTest: PARALLEL

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

/// The installed files, and the examples that were built with them.
class Library : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<test::TemporaryFolder>();
    const std::string build = std::filesystem::path(COPPICE_BIN_DIR).parent_path().string();
    installed = test::shell(fmt::format("cmake --install '{}' --strip --prefix '{}'", build, at("prefix")));
    built = test::shell(fmt::format(
        "cmake -G Ninja -S '{}/examples/cpp' -B '{}' -DCMAKE_PREFIX_PATH='{}' -DCMAKE_CXX_FLAGS='{}' && "
        "cmake --build '{}'",
        COPPICE_SOURCE_DIR, at("examples"), at("prefix"), COPPICE_SANITIZER, at("examples")));
  }
  static void TearDownTestSuite() { folder.reset(); }

  void SetUp() override {
    ASSERT_EQ(installed.exit_code, 0) << installed.output;
    ASSERT_EQ(built.exit_code, 0) << built.output;
  }

  static std::string at(const std::string& name) { return (folder->path() / name).string(); }
  static std::string scenario(const std::string& name) {
    return "'" COPPICE_SOURCE_DIR "/scenarios/" + name + "'";
  }
  static test::Outcome run(const std::string& example, const std::string& arguments = "") {
    return test::shell("'" + at("examples/" + example) + "' " + arguments);
  }

  static inline std::unique_ptr<test::TemporaryFolder> folder{};
  static inline test::Outcome installed{};
  static inline test::Outcome built{};
};

TEST_F(Library, TheExamplesDoWhatTheySay) {
  const test::Outcome paths = run("plan_paths", scenario("rooms-8.map"));
  EXPECT_EQ(paths.exit_code, 0) << paths.output;
  EXPECT_EQ(std::ranges::count(paths.output, '\n'), 10) << paths.output;
  EXPECT_EQ(paths.output.find("no path"), std::string::npos) << paths.output;
  const test::Outcome trajectories = run("plan_trajectories");
  EXPECT_EQ(trajectories.exit_code, 0) << trajectories.output;
  const test::Outcome fleet = run("simulate_fleet", scenario("rooms-8.json"));
  EXPECT_EQ(fleet.exit_code, 0) << fleet.output;
  EXPECT_NE(fleet.output.find("all arrived"), std::string::npos) << fleet.output;
}

TEST_F(Library, BadInputIsAnErrorThatNamesIt) {
  const test::Outcome map = run("plan_paths", "nowhere.map");
  EXPECT_EQ(map.exit_code, 2);
  EXPECT_NE(map.output.find("nowhere.map"), std::string::npos) << map.output;
  EXPECT_EQ(run("simulate_fleet", "nowhere.json").exit_code, 2);
}

TEST_F(Library, NoLibraryNeedsDds) {
  for (const char* name : {"planning", "motion", "files", "simulation"}) {
    const std::string file = at("prefix") + fmt::format("/lib/libcoppice_{}.so", name);
    const test::Outcome needed = test::shell("ldd '" + file + "'");
    EXPECT_EQ(needed.exit_code, 0) << needed.output;
    EXPECT_EQ(needed.output.find("not found"), std::string::npos) << needed.output;
    EXPECT_EQ(needed.output.find("fastrtps"), std::string::npos) << needed.output;
  }
}

TEST_F(Library, PkgConfigGivesTheSameFlags) {
  const std::string pkg_config = "PKG_CONFIG_PATH='" + at("prefix/lib/pkgconfig") + "' pkg-config";
  const test::Outcome outcome = test::shell(fmt::format(
      "g++ -std=c++20 {} {}/examples/cpp/plan_trajectories.cpp -o '{}' $({} --cflags --libs coppice-motion) "
      "&& "
      "LD_LIBRARY_PATH='{}' '{}'",
      COPPICE_SANITIZER, COPPICE_SOURCE_DIR, at("swap"), pkg_config, at("prefix/lib"), at("swap")));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_EQ(test::shell(pkg_config + " --modversion coppice-simulation").output, COPPICE_VERSION "\n");
}

}  // namespace
}  // namespace coppice

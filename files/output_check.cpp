#include "files/output_check.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "coppice/files/input_error.h"
#include "files/text_file.h"

namespace coppice {

namespace {

namespace fs = std::filesystem;

/// Creates a file of that name and removes it again. Returns the error message, empty on success. Permissions
/// alone do not tell: a read-only file system, a full disk or a name that is too long fails only here. A file
/// that a killed process left there does no harm.
std::string problem_with_making(const std::string& file) {
  const int made = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (made < 0) return std::strerror(errno);
  ::close(made);
  ::unlink(file.c_str());
  return {};
}

std::string problem_with_output(const std::string& text) {
  std::error_code ignored;
  const fs::path file = text.empty() ? fs::path() : written_file(text);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (text.empty()) return "expected the name of a file";
  if (!file.has_filename() || fs::is_directory(file, ignored))
    return fmt::format("{} is a folder, expected a file", text);
  if (!fs::is_directory(folder, ignored))
    return fmt::format("{} cannot be written: there is no folder {}", text, folder.string());
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))  // a device or a pipe
    return ::access(file.c_str(), W_OK) == 0 ? "" : fmt::format("{} cannot be written: no permission", text);
  // The output is written beside the file and then renamed, so only the folder's permissions matter.
  const std::string problem = problem_with_making(fmt::format("{}.{}.tmp", file.string(), ::getpid()));
  return problem.empty() ? "" : fmt::format("{} cannot be written: {}", text, problem);
}

std::string problem_with_folder(const std::string& text) {
  std::error_code ignored;
  if (!fs::is_directory(text, ignored)) return fmt::format("there is no folder {}", text);
  const std::string problem = problem_with_making(fmt::format("{}/.{}.tmp", text, ::getpid()));
  return problem.empty() ? "" : fmt::format("nothing can be written to {}: {}", text, problem);
}

std::string problem_with_picture(const std::string& text) {
  std::error_code ignored;
  if (const std::string problem = problem_with_output(text); !problem.empty()) return problem;
  const bool is_device =
      std::filesystem::exists(text, ignored) && !std::filesystem::is_regular_file(text, ignored);
  if (is_device || ending_of(text) == ".svg") return {};
  return fmt::format("{} is not allowed, expected a name that ends in .svg", text);
}

}  // namespace

CLI::Validator output_folder() {
  return {[](std::string& text) { return problem_with_folder(text); }, "FOLDER"};
}

CLI::Validator output_file() {
  return {[](std::string& text) { return problem_with_output(text); }, "FILE"};
}

CLI::Validator picture_file() {
  return {[](std::string& text) { return problem_with_picture(text); }, "FILE"};
}

void check_output_folder(const std::string& folder) {
  if (const std::string problem = problem_with_folder(folder); !problem.empty()) throw InputError(problem);
}

}  // namespace coppice

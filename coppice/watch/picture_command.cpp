#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/run/process_fleet.h"
#include "files/temporary_folder.h"
#include "files/text_file.h"
#include "monitor/recording/picture_book.h"
#include "runtime/process.h"

namespace coppice {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds frame_poll_period{2};
constexpr double most_frames = 100'000;

/// A program that is not part of Coppice.
struct Tool {
  std::string name;
  std::string package;  ///< Debian's package
};
const Tool rsvg{"rsvg-convert", "librsvg2-bin"};
const Tool ffmpeg{"ffmpeg", "ffmpeg"};

fs::path place_of(const Tool& tool) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder) / tool.name;
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  throw InputError(fmt::format("{} is needed for this and is not installed (Debian: apt-get install {})",
                               tool.name, tool.package));
}

/// Runs the tool to its end. Throws InputError if it is missing or fails.
void run(const Tool& tool, const std::vector<std::string>& arguments, const fs::path& folder) {
  std::vector<std::string> command{place_of(tool).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  ProcessFleet process(folder);
  process.start(tool.name, command, ProcessFleet::Output::log);
  auto ended = process.reap();
  for (; !ended; ended = process.reap()) std::this_thread::sleep_for(frame_poll_period);
  if (ended->exit_code != 0)
    throw InputError(fmt::format("{} failed, exit code {}: {}", tool.name, ended->exit_code, ended->log_end));
}

void draw_png(const PictureContent& content, const fs::path& file, const fs::path& folder) {
  const fs::path drawing = folder / "picture.svg";
  write_picture(drawing, content);
  run(rsvg, {"--output", file.string(), drawing.string()}, folder);
}

double checked_time(const PictureBook& book, double time, const std::string& option) {
  if (!(time >= book.begin() && time <= book.end()))  // false for NaN, too
    throw InputError(fmt::format("{} {:g}: expected a fleet time of the recording, {:.2f} to {:.2f} s",
                                 option, time, book.begin(), book.end()));
  return time;
}

void make_picture(PictureBook& book, const PictureOptions& options) {
  const PictureContent content = book.at(checked_time(book, options.time.value_or(book.end()), "--time"));
  const fs::path file = options.output;
  if (ending_of(file) == ".svg") return write_picture(file, content);
  const TemporaryFolder folder;
  draw_png(content, file, folder.path());
}

void make_movie(PictureBook& book, const PictureOptions& options) {
  const fs::path file = options.output;
  const double from = checked_time(book, options.from.value_or(book.begin()), "--from");
  const double until = checked_time(book, options.until.value_or(book.end()), "--until");
  const double step = options.speed / options.frame_rate;
  const double frames = std::floor((until - from) / step) + 1;
  if (until < from || frames > most_frames)
    throw InputError(fmt::format("from {:g} s until {:g} s are {:g} frames, expected 1 to {:g}", from, until,
                                 std::max(0.0, frames), most_frames));
  (void)place_of(ffmpeg);  // fails now rather than after all frames
  const TemporaryFolder folder;
  for (int frame = 0; frame < static_cast<int>(frames) && !stop_requested(); ++frame) {
    draw_png(book.at(from + frame * step), folder.path() / fmt::format("frame-{:06}.png", frame),
             folder.path());
    if (!options.quiet) std::cout << fmt::format("\rframe {} of {:g}", frame + 1, frames) << std::flush;
  }
  if (!options.quiet) std::cout << '\n';
  if (stop_requested()) throw std::runtime_error("interrupted: " + options.output + " was not written");
  std::vector<std::string> arguments{"-y",
                                     "-loglevel",
                                     "error",
                                     "-framerate",
                                     fmt::format("{:g}", options.frame_rate),
                                     "-i",
                                     (folder.path() / "frame-%06d.png").string()};
  // GIF gets a palette of its own, for better colours. Codecs need sides of even length.
  const std::string filter = ending_of(file) == ".gif" ? "split[a][b];[a]palettegen[p];[b][p]paletteuse"
                                                       : "scale=trunc(iw/2)*2:trunc(ih/2)*2,format=yuv420p";
  arguments.insert(arguments.end(), {"-vf", filter, file.string()});
  run(ffmpeg, arguments, folder.path());
}

void check_extension(const std::string& file, const std::vector<std::string>& known) {
  if (std::ranges::count(known, ending_of(file)) > 0) return;
  throw InputError(fmt::format("{}: expected a name that ends with {}", file, fmt::join(known, " or ")));
}

}  // namespace

int picture_command(const PictureOptions& options) {
  install_stop_signals();
  check_extension(options.output, options.movie ? std::vector<std::string>{".gif", ".webm", ".mp4"}
                                                : std::vector<std::string>{".svg", ".png"});
  const Recording recording(options.recording);
  PictureBook book(recording);
  options.movie ? make_movie(book, options) : make_picture(book, options);
  if (!options.quiet) std::cout << options.output << '\n';
  return 0;
}

}  // namespace coppice

#include "runtime/process_clock.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "planning/number_text.h"
#include "planning/quantities.h"
#include "runtime/journal.h"

namespace coppice {

namespace {

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The kernel draws this name anew each time the machine is started.
std::string name_of_boot() {
  std::string name = contents("/proc/sys/kernel/random/boot_id");
  return name.substr(0, name.find_last_not_of(" \n") + 1);
}

std::optional<ClockMark> kept_in(const std::filesystem::path& file) {
  std::error_code none;
  if (file.empty() || !std::filesystem::exists(file, none)) return std::nullopt;
  auto mark = clock_mark_in(contents(file));
  if (!mark) spdlog::warn("{}: is damaged: goes on with the clock of the system", file.string());
  return mark;
}

std::filesystem::path file_in(const std::string& folder) {
  if (folder.empty()) return {};
  make_folder(folder);
  return std::filesystem::path(folder) / "clock";
}

}  // namespace

std::optional<ClockMark> clock_mark_in(const std::string& text) {
  std::istringstream words(text);
  std::string boot;
  std::string oscillator;
  std::string time;
  std::string more;
  if (!(words >> boot >> oscillator >> time) || words >> more) return std::nullopt;
  const auto count = decimal_number(oscillator);
  const auto at = decimal_number(time);
  if (!count || !at || !is_sane(*count) || *at < 0 || *at > latest_run) return std::nullopt;
  return ClockMark{boot, *count, *at};
}

std::string text_of(const ClockMark& mark) {
  return fmt::format("{} {:.6f} {:.6f}\n", mark.boot, mark.oscillator, mark.time);
}

DisciplinedClock clock_from(const std::optional<ClockMark>& kept, const std::string& boot,
                            const DisciplinedClock::Reading& now) {
  const bool goes_on = kept && kept->boot == boot && kept->oscillator <= now.oscillator;
  return {now, goes_on ? kept->time_at(now.oscillator) : now.system};
}

ProcessClock::ProcessClock(const std::string& folder)
    : file_(file_in(folder)),
      boot_(name_of_boot()),
      kept_(kept_in(file_)),
      clock_(clock_from(kept_, boot_, DisciplinedClock::read())) {
  if (kept_ && kept_->boot != boot_) kept_.reset();
  now();
}

WallTime ProcessClock::now() {
  const DisciplinedClock::Reading reading = DisciplinedClock::read();
  clock_.go_on(reading);
  tell();
  keep(reading);
  return clock_.time();
}

void ProcessClock::tell() {
  const double step = clock_.take_steps();
  if (std::abs(step) >= worth_telling)
    spdlog::warn("the clock of the system was set by {:+.1f} s: this process goes on with its own time",
                 step);
}

void ProcessClock::keep(const DisciplinedClock::Reading& reading) {
  if (file_.empty()) return;
  if (kept_ && std::abs(kept_->time_at(reading.oscillator) - clock_.time()) < worth_keeping) return;
  kept_ = ClockMark{boot_, reading.oscillator, clock_.time()};
  // Several processes may do this at a time. With a full disk the mark that is there stays.
  const std::filesystem::path temporary = file_.string() + fmt::format(".{}.tmp", ::getpid());
  std::ofstream out(temporary, std::ios::binary);
  out << text_of(*kept_);
  out.close();
  std::error_code problem;
  if (out)
    std::filesystem::rename(temporary, file_, problem);
  else
    std::filesystem::remove(temporary, problem);
}

}  // namespace coppice

// The report of a run: as JSON (idl/report.proto), and as a table for the terminal.
#pragma once

#include <filesystem>
#include <string>

#include "report.pb.h"

namespace coppice {

/// Throws InputError if the file cannot be written; then nothing is left of it.
void write_report(const std::filesystem::path& path, const proto::Report& report);

/// Throws InputError if the file is missing or no report.
proto::Report read_report(const std::filesystem::path& path);

/// Lines of at most about 100 characters: the fleet's figures, then a row for each robot.
std::string report_table(const proto::Report& report);

}  // namespace coppice

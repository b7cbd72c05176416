// The report of a run as JSON (idl/report.proto) and as a table for the terminal.
#pragma once

#include <filesystem>
#include <string>

#include "report.pb.h"

namespace coppice {

std::string report_json(const proto::Report& report);

/// Throws InputError if the file cannot be written; then no partial file is left.
void write_report(const std::filesystem::path& path, const proto::Report& report);

/// Throws InputError if the file is missing or is not a report.
proto::Report read_report(const std::filesystem::path& path);

/// The fleet's figures, then a row for each robot; lines of at most about 100 characters.
std::string report_table(const proto::Report& report);

}  // namespace coppice

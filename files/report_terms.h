// The meaning of the terms in the table and the report of a run.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace coppice {

struct Term {
  std::string_view name;
  std::string_view meaning;
};

/// The terms of the table that run, simulate, plan and the planner service print.
std::span<const Term> table_terms();

/// The terms of the report (idl/report.proto): "run_time", "robots[].load.periods".
std::span<const Term> report_terms();

/// The terms as help text (runtime/command_line.h).
std::string terms_of_table();
std::string terms_of_report();

}  // namespace coppice

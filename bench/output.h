// Writes the three files of an experiment.
#pragma once

#include <string>
#include <vector>

#include "bench/experiments.h"
#include "bench/plot.h"
#include "bench/table.h"
#include "files/text_file.h"

namespace coppice {

/// Writes NAME.csv (`trials`), NAME.md (`summary`) and NAME.svg. Called after each map, so that results are
/// kept if the next map fails.
inline void write_experiment(const ExperimentOptions& options, const std::string& name, const Table& trials,
                             const Table& summary, const std::vector<Plot>& plots, int plots_a_row) {
  const std::string file = options.output + "/" + name;
  write_file(file + ".csv", as_csv(trials));
  write_file(file + ".md", as_markdown(summary));
  write_file(file + ".svg", plots_svg(plots, plots_a_row));
}

}  // namespace coppice

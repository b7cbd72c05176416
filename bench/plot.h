// Line plots in a grid, as SVG, in the form of the paper's figures.
#pragma once

#include <string>
#include <vector>

namespace coppice {

struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> spread;  ///< half height of the error bars; empty for none
};

struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  bool logarithmic = false;  ///< the y axis; values above 0 only
  std::vector<Series> series;
};

/// `columns` plots per row. A series has the same colour in all plots, by its index.
std::string plots_svg(const std::vector<Plot>& plots, int columns);

}  // namespace coppice

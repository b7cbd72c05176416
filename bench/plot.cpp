#include "bench/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr double width = 300;
constexpr double height = 220;
constexpr double left = 58;
constexpr double right = 12;
constexpr double top = 28;
constexpr double bottom = 40;
constexpr double legend_height = 26;
constexpr std::array<const char*, 8> colours{"#1f77b4", "#d62728", "#2ca02c", "#9467bd",
                                             "#ff7f0e", "#8c564b", "#17becf", "#7f7f7f"};

const char* colour(std::size_t k) {
  return colours[k % colours.size()];
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

/// Converts values to pixels on one axis.
class Scale {
 public:
  Scale(Range range, double from, double to, bool logarithmic) : from_(from), to_(to), log_(logarithmic) {
    if (!(range.low <= range.high)) range = {1, 1};  // nothing to show; 0 has no logarithm
    if (log_) {
      low_ = std::floor(std::log10(range.low));
      high_ = std::max(low_ + 1, std::ceil(std::log10(range.high)));
    } else {
      low_ = 0;
      high_ = range.high > 0 ? range.high * 1.05 : 1;
    }
  }
  double operator()(double v) const {
    const double place = log_ ? std::log10(v) : v;
    return from_ + (to_ - from_) * (place - low_) / (high_ - low_);
  }
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    if (log_) {
      for (double e = low_; e <= high_; ++e) ticks.push_back(std::pow(10, e));
      return ticks;
    }
    double step = std::pow(10, std::floor(std::log10(high_)));
    if (high_ / step < 2)
      step /= 5;
    else if (high_ / step < 5)
      step /= 2;
    for (double v = 0; v <= high_ * (1 + 1e-9); v += step) ticks.push_back(v);
    return ticks;
  }

 private:
  double from_;
  double to_;
  bool log_;
  double low_ = 0;
  double high_ = 1;
};

std::string axes(const Plot& plot, const Scale& x, const Scale& y) {
  std::string svg = fmt::format(
      "<rect x='{:.0f}' y='{:.0f}' width='{:.0f}' height='{:.0f}' fill='none' stroke='#444'/>\n"
      "<text x='{:.0f}' y='18' text-anchor='middle' font-weight='bold'>{}</text>\n"
      "<text x='{:.0f}' y='{:.0f}' text-anchor='middle'>{}</text>\n"
      "<text transform='translate(12 {:.0f}) rotate(-90)' text-anchor='middle'>{}</text>\n",
      left, top, width - left - right, height - top - bottom, (left + width - right) / 2, plot.title,
      (left + width - right) / 2, height - 8, plot.x_label, (top + height - bottom) / 2, plot.y_label);
  for (const double v : y.ticks()) {
    svg += fmt::format(
        "<line x1='{0:.0f}' x2='{1:.0f}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/>"
        "<text x='{3:.0f}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n",
        left, width - right, y(v), left - 4, y(v) + 4, v);
  }
  for (const double v : x.ticks()) {
    svg += fmt::format("<text x='{:.1f}' y='{:.0f}' text-anchor='middle'>{:g}</text>\n", x(v),
                       height - bottom + 15, v);
  }
  return svg;
}

std::string drawn(const Plot& plot) {
  Range xs;
  Range ys;
  for (const Series& s : plot.series) {
    for (const double v : s.x) xs.take(v);
    for (const double v : s.y) {
      if (!plot.logarithmic || v > 0) ys.take(v);
    }
  }
  const Scale x(xs, left, width - right, false);
  const Scale y(ys, height - bottom, top, plot.logarithmic);
  std::string svg = axes(plot, x, y);
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const Series& s = plot.series[k];
    std::string points;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (plot.logarithmic && !(s.y[i] > 0)) continue;
      points += fmt::format("{:.1f},{:.1f} ", x(s.x[i]), y(s.y[i]));
      svg +=
          fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2.5' fill='{}'/>", x(s.x[i]), y(s.y[i]), colour(k));
      if (s.spread.empty() || !(s.spread[i] > 0)) continue;
      const double low =
          plot.logarithmic ? std::max(s.y[i] - s.spread[i], s.y[i] / 10) : s.y[i] - s.spread[i];
      svg +=
          fmt::format("<line x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2:.1f}' stroke='{3}'/>", x(s.x[i]),
                      std::min(y(low), height - bottom), std::max(y(s.y[i] + s.spread[i]), top), colour(k));
    }
    svg += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='1.5'/>\n", points,
                       colour(k));
  }
  return svg;
}

}  // namespace

std::string plots_svg(const std::vector<Plot>& plots, int columns) {
  const int rows = (static_cast<int>(plots.size()) + columns - 1) / columns;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} "
      "{1:.0f}' "
      "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
      columns * width, rows * height + legend_height);
  double at = left;
  for (std::size_t k = 0; !plots.empty() && k < plots[0].series.size(); ++k) {
    const std::string& name = plots[0].series[k].name;
    svg += fmt::format(
        "<rect x='{:.0f}' y='9' width='14' height='4' fill='{}'/><text x='{:.0f}' y='16'>{}</text>\n", at,
        colour(k), at + 18, name);
    at += 40 + 7 * static_cast<double>(name.size());
  }
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const auto column = static_cast<double>(k % static_cast<std::size_t>(columns));
    const auto row = static_cast<double>(k / static_cast<std::size_t>(columns));
    svg += fmt::format("<g transform='translate({:.0f} {:.0f})'>\n{}</g>\n", column * width,
                       legend_height + row * height, drawn(plots[k]));
  }
  return svg + "</svg>\n";
}

}  // namespace coppice

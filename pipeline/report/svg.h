// The drawn parts of report.html: legends, scale bars, histograms. All are inline SVG or HTML with text alternatives.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/report/images.h"

namespace sparsha::pipeline {

/// The colour ramp with its ticks, or the named states.
[[nodiscard]] std::string legend_svg(const Picture& picture);

/// A bar over the picture's lower left corner, sized in percent of the picture's width.
[[nodiscard]] std::string scale_bar_html(double picture_width_m);

/// Bars of equal bins; marks are vertical lines with a label ("median").
struct HistogramMark {
  double value_m;
  std::string label;
};
[[nodiscard]] std::string histogram_svg(const std::vector<std::uint64_t>& counts, double bin_m,
                                        const std::vector<HistogramMark>& marks, const std::string& alternative);

}  // namespace sparsha::pipeline

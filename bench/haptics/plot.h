// Time against error as a log-log scatter, one SVG without dependencies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::bench {

struct PlotPoint {
  std::string method;
  double ns = 0.0;
  double error = 0.0;
};

/// False when the file could not be written.
[[nodiscard]] bool write_plot(const std::filesystem::path& file, const std::vector<PlotPoint>& points);

}  // namespace sparsha::bench

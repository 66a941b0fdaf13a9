// Curves against time in panels above each other, one SVG without dependencies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::bench {

struct Curve {
  std::string name;
  std::string colour;
  std::string dashes;  ///< SVG dash pattern; empty: solid
  std::vector<double> x;
  std::vector<double> y;
};

struct Panel {
  std::string y_label;
  double x_from = 0.0;  ///< what lies outside is not drawn
  double x_to = 1.0;
  std::vector<Curve> curves;
  double mark_from = 0.0;  ///< shaded from here to mark_to, where that is greater
  double mark_to = 0.0;
};

/// False when the file could not be written.
[[nodiscard]] bool write_lines(const std::filesystem::path& file, const std::string& title, const std::string& x_label,
                               const std::vector<Panel>& panels);

}  // namespace sparsha::bench

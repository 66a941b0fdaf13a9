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

/// What the plot shows besides its points.
struct PlotMarks {
  std::string title = "Time of a proxy update against the force's mean relative error";
  std::string y_label = "mean relative force error";
  bool front = false;      ///< the Pareto front: no point of it is beaten in both time and error
  double budget_ns = 0.0;  ///< a vertical line; 0: none
  double felt_from = 0.0;  ///< a band of errors between which touch begins to feel them; none where 0
  double felt_to = 0.0;
};

/// False when the file could not be written.
[[nodiscard]] bool write_plot(const std::filesystem::path& file, const std::vector<PlotPoint>& points,
                              const PlotMarks& marks = {});

/// The points that no other beats in both time and error, by time.
[[nodiscard]] std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points);

}  // namespace sparsha::bench

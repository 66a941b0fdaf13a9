// Points that no surface goes through: on a straight line, or all in one place.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::pipeline {

struct StraightLine {
  double length = 0.0;  ///< 0: all points are in one place
  double across = 0.0;  ///< root mean square distance from the line
};

/// The line that the `points` points lie on of which this is a sample, but for one in 500: they spread across it by
/// less than a 50 000th of its length, or by less than a twentieth of their distance along it (and a
/// thousandth of its length), as coordinates do that were rounded, or by no more than float32 rounds them where all are
/// float32. Nothing for points that spread over a surface, a strip of two rows included, and without points.
[[nodiscard]] std::optional<StraightLine> straight_line(const std::vector<Eigen::Vector3d>& sample,
                                                        std::uint64_t points);

/// What the line is, in words; `length` of them names a length.
[[nodiscard]] std::string described(const StraightLine& line, const std::function<std::string(double)>& length);

/// Throws Error{input} when the points of so many files, in metres, lie on a straight line or in one place. `file`
/// names them.
void require_surface(const std::string& file, std::size_t files, const std::vector<Eigen::Vector3d>& sample_m,
                     std::uint64_t points);

}  // namespace sparsha::pipeline

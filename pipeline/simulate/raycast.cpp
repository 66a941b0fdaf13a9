// Descent through the pyramid of maxima.
#include "pipeline/simulate/raycast.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr int kCells = 1024;         // along the longer side
constexpr int kPiecesPerCell = 3;    // of a beam in a cell, tried for a change of sign
constexpr double kTolerance = 1e-9;  // of the size
constexpr std::size_t kRowsAtOnce = 16;
// Of the distance along a beam: what double precision tells apart for sure. Beams from very far away are no finer.
constexpr double kSteps = 8.0 * std::numeric_limits<double>::epsilon();

}  // namespace

HeightCaster::HeightCaster(Height height, double width_m, double length_m, ThreadPool& pool)
    : height_(std::move(height)), width_m_(width_m), length_m_(length_m) {
  const double size = std::max(width_m, length_m);
  cell_m_ = size / kCells;
  Level finest{std::max(1, static_cast<int>(std::ceil(width_m / cell_m_ - 1e-9))),
               std::max(1, static_cast<int>(std::ceil(length_m / cell_m_ - 1e-9))),
               {}};
  const auto columns = static_cast<std::size_t>(finest.nx) + 1;
  const auto rows = static_cast<std::size_t>(finest.ny) + 1;
  std::vector<float> samples(columns * rows);
  pool.for_ranges(rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      for (std::size_t i = 0; i < columns; ++i) {
        samples[j * columns + i] =
            static_cast<float>(height_(static_cast<double>(i) * cell_m_, static_cast<double>(j) * cell_m_));
      }
    }
  });
  const auto [least_sample, most_sample] = std::minmax_element(samples.begin(), samples.end());
  lowest_m_ = *least_sample - 0.1 * static_cast<double>(*most_sample - *least_sample) - 1e-3 * size;
  finest.maximum.resize((columns - 1) * (rows - 1));
  const auto floor_margin = static_cast<float>(1e-5 * size);
  for (std::size_t j = 0; j + 1 < rows; ++j) {
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const float* low = &samples[j * columns + i];
      const float* high = low + columns;
      const auto [least, most] = std::minmax({low[0], low[1], high[0], high[1]});
      finest.maximum[j * (columns - 1) + i] = most + 0.5F * (most - least) + floor_margin;
    }
  }
  levels_.push_back(std::move(finest));
  while (levels_.back().nx > 1 || levels_.back().ny > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.nx + 1) / 2, (fine.ny + 1) / 2, {}};
    coarse.maximum.assign(static_cast<std::size_t>(coarse.nx) * static_cast<std::size_t>(coarse.ny),
                          -std::numeric_limits<float>::infinity());
    for (int j = 0; j < fine.ny; ++j) {
      for (int i = 0; i < fine.nx; ++i) {
        float& most = coarse.maximum[static_cast<std::size_t>(j / 2) * static_cast<std::size_t>(coarse.nx) +
                                     static_cast<std::size_t>(i / 2)];
        most = std::max(most, fine.maximum[static_cast<std::size_t>(j) * static_cast<std::size_t>(fine.nx) +
                                           static_cast<std::size_t>(i)]);
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

std::optional<double> HeightCaster::meet_in_cell(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                                 double begin, double end) const {
  const auto above = [&](double t) {
    return origin.z() + t * direction.z() - height_(origin.x() + t * direction.x(), origin.y() + t * direction.y());
  };
  double outside = begin;
  for (int piece = 1; piece <= kPiecesPerCell; ++piece) {
    double inside = begin + (end - begin) * piece / kPiecesPerCell;
    double below = above(inside);
    if (below > 0.0) {
      outside = inside;
      continue;
    }
    double clear = above(outside);
    if (clear <= 0.0) return outside;
    // Regula falsi alternating with halving: fast on smooth stone, safe on a vertical step.
    const double tolerance = std::max(kTolerance * std::max(width_m_, length_m_), kSteps * end);
    for (bool halve = false; inside - outside > tolerance; halve = !halve) {
      const double share = halve ? 0.5 : std::clamp(clear / (clear - below), 0.01, 0.99);
      const double middle = outside + share * (inside - outside);
      const double value = above(middle);
      if (std::fabs(value) < 1e-3 * tolerance) return middle;
      if (value > 0.0) {
        outside = middle;
        clear = value;
      } else {
        inside = middle;
        below = value;
      }
    }
    return 0.5 * (outside + inside);
  }
  return std::nullopt;
}

std::optional<HeightCaster::Hit> HeightCaster::cast(const Eigen::Vector3d& origin,
                                                    const Eigen::Vector3d& direction) const {
  // The part of the beam over the domain and under the highest point.
  double begin = std::max(0.0, (highest_m() - origin.z()) / direction.z());
  double end = std::numeric_limits<double>::infinity();
  const std::array<double, 2> sizes{width_m_, length_m_};
  for (int axis = 0; axis < 2; ++axis) {
    const double d = direction[axis];
    const double o = origin[axis];
    const double size = sizes[static_cast<std::size_t>(axis)];
    if (std::fabs(d) < 1e-300) {
      if (o < 0.0 || o > size) return std::nullopt;
      continue;
    }
    const double a = -o / d;
    const double b = (size - o) / d;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!(begin < end)) return std::nullopt;
  const auto z_at = [&](double t) { return origin.z() + t * direction.z(); };
  if (z_at(begin) < height_(origin.x() + begin * direction.x(), origin.y() + begin * direction.y())) {
    return Hit{begin, true};
  }
  end = std::min(end, (lowest_m_ - origin.z()) / direction.z());
  double t = begin;
  int level = static_cast<int>(levels_.size()) - 1;
  const double nudge = std::max(1e-7 * cell_m_, kSteps * end);  // past a border, so that the next square is found
  while (t < end) {
    const Level& squares = levels_[static_cast<std::size_t>(level)];
    const double side = std::ldexp(cell_m_, level);
    const double ahead = t + nudge;
    const int i = std::clamp(static_cast<int>((origin.x() + ahead * direction.x()) / side), 0, squares.nx - 1);
    const int j = std::clamp(static_cast<int>((origin.y() + ahead * direction.y()) / side), 0, squares.ny - 1);
    double leave = end;
    const auto border = [&](double o, double d, int index) {
      if (std::fabs(d) < 1e-300) return;
      const double exit = ((d > 0.0 ? index + 1 : index) * side - o) / d;
      if (exit > t) leave = std::min(leave, exit);
    };
    border(origin.x(), direction.x(), i);
    border(origin.y(), direction.y(), j);
    const double maximum =
        squares
            .maximum[static_cast<std::size_t>(j) * static_cast<std::size_t>(squares.nx) + static_cast<std::size_t>(i)];
    if (z_at(leave) > maximum) {
      t = std::max(leave, ahead);
      level = std::min(level + 1, static_cast<int>(levels_.size()) - 1);
    } else if (level > 0) {
      --level;
    } else {
      if (const auto met = meet_in_cell(origin, direction, t, leave)) return Hit{*met, false};
      t = std::max(leave, ahead);
    }
  }
  return std::nullopt;
}

}  // namespace sparsha::pipeline

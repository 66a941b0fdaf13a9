#include "pipeline/scan/formats/text/column_shapes.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kFewestNumbered = 10;  // rows

bool is_whole(double value) { return value == std::floor(value); }

/// True when all sampled rows have finite values of [low, high] in columns first to first + 2.
bool in_range(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first, double low, double high,
              bool whole) {
  if (usual < first + 3) return false;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    for (std::size_t k = first; k < first + 3; ++k) {
      const double v = row.values[k];
      if (!(v >= low && v <= high) || (whole && !is_whole(v))) return false;
    }
  }
  return true;
}

}  // namespace

std::size_t usual_count(const std::vector<TableRow>& sample) {
  std::array<std::size_t, kMostColumns + 1> votes{};
  for (const TableRow& row : sample) ++votes[row.count];
  const auto usual = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  const auto ends_empty = [&](const TableRow& row) { return row.count != usual || row.ends_empty(); };
  const bool empty_end = usual > 3 && std::all_of(sample.begin(), sample.end(), ends_empty);
  return empty_end ? usual - 1 : usual;
}

bool are_rows_alike(const std::vector<TableRow>& sample, std::size_t usual) {
  return std::all_of(sample.begin(), sample.end(), [&](const TableRow& row) {
    return row.count == usual || (row.count == usual + 1 && row.ends_empty());
  });
}

bool look_like_colours(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  return in_range(sample, usual, first, 0.0, 255.0, true) || in_range(sample, usual, first, 0.0, 1.0, false);
}

bool look_like_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  std::size_t rows = 0;
  bool negative = false;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    const Eigen::Vector3d normal(row.values[first], row.values[first + 1], row.values[first + 2]);
    if (normal.isZero(0.0)) continue;  // of points for which none was found
    if (!(std::abs(normal.norm() - 1.0) < 0.01)) return false;
    negative = negative || (normal.array() < 0.0).any();
    ++rows;
  }
  return negative && rows >= 3;
}

std::size_t leading_numbers(const std::vector<TableRow>& sample, std::size_t usual) {
  std::size_t numbers = usual;
  for (const TableRow& row : sample) {
    if (row.count != usual) return 0;
    std::size_t k = 0;
    while (k < numbers && row.has_number(static_cast<int>(k))) ++k;
    numbers = k;
  }
  return numbers;
}

bool counts_rows(const std::vector<TableRow>& sample, std::size_t column) {
  if (sample.size() < kFewestNumbered) return false;
  for (std::size_t k = 0; k < sample.size(); ++k) {
    if (column >= sample[k].count || !is_whole(sample[k].values[column])) return false;
    if (k > 0 && sample[k].values[column] != sample[k - 1].values[column] + 1.0) return false;
  }
  return true;
}

bool may_be_row_names(const std::vector<TableRow>& sample) {
  for (std::size_t k = 0; k < sample.size(); ++k) {
    if (sample[k].has_word(0)) continue;
    if (!is_whole(sample[k].values[0]) || (k > 0 && !(sample[k].values[0] > sample[k - 1].values[0]))) return false;
  }
  return true;
}

bool look_numbered(const std::vector<TableRow>& sample, std::size_t usual) {
  const std::size_t numbers = leading_numbers(sample, usual);
  return (numbers == 4 || numbers >= 7) && counts_rows(sample, 0);
}

bool look_like_points3d(const std::vector<TableRow>& sample) {
  if (sample.size() < kFewestNumbered) return false;
  bool vary = false;
  bool fractions = false;
  for (const TableRow& row : sample) {
    if (row.count < 10 || (row.count % 2 != 0 && row.count < kMostColumns)) return false;
    for (std::size_t k = 0; k < row.count; ++k) {
      const double v = row.values[k];
      const bool counts = k == 0 || k > 7;
      const bool colour = k >= 4 && k <= 6;
      if (!std::isfinite(v) || (counts && !(v >= 0.0 && is_whole(v)))) return false;
      if (colour && !(v >= 0.0 && v <= 255.0 && is_whole(v))) return false;
    }
    if (!(row.values[7] >= 0.0)) return false;
    vary = vary || row.count != sample.front().count;
    fractions = fractions || !is_whole(row.values[1]) || !is_whole(row.values[2]) || !is_whole(row.values[3]);
  }
  return vary && fractions;
}

bool are_coordinates(const std::vector<TableRow>& sample, const std::array<int, 3>& xyz, double damaged) {
  std::size_t numbers = 0;
  std::size_t words = 0;
  for (const TableRow& row : sample) {
    words += std::any_of(xyz.begin(), xyz.end(), [&](int column) { return row.has_word(column); }) ? 1 : 0;
    numbers += std::all_of(xyz.begin(), xyz.end(), [&](int column) { return row.has_number(column); }) ? 1 : 0;
  }
  const auto rows = static_cast<double>(sample.size());
  return 2 * numbers >= sample.size() && static_cast<double>(words) <= damaged * rows;
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/formats/text/column_shapes.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/scan/look_alikes.h"

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

std::bitset<kMostColumns> columns_of_numbers(const std::vector<TableRow>& sample) {
  std::bitset<kMostColumns> columns;
  for (std::size_t k = 0; k < kMostColumns; ++k) {
    const auto has_number = [&](const TableRow& row) { return row.has_number(static_cast<int>(k)); };
    columns[k] = 2 * static_cast<std::size_t>(std::count_if(sample.begin(), sample.end(), has_number)) >= sample.size();
  }
  return columns;
}

bool are_rows_alike(const std::vector<TableRow>& sample, std::size_t usual) {
  return std::all_of(sample.begin(), sample.end(), [&](const TableRow& row) {
    return row.count == usual || (row.count == usual + 1 && row.ends_empty());
  });
}

bool look_like_colours(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  return in_range(sample, usual, first, 0.0, 255.0, true) || in_range(sample, usual, first, 0.0, 1.0, false);
}

bool look_like_words(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  constexpr double kMost = 65535.0, kTenBits = 1023.0;
  if (!in_range(sample, usual, first, 0.0, kMost, true)) return false;
  for (std::size_t k = first; k < first + 3; ++k) {
    const auto is_more = [&](const TableRow& row) { return row.count == usual && row.values[k] > kTenBits; };
    if (std::none_of(sample.begin(), sample.end(), is_more)) return false;
  }
  return true;
}

bool look_like_bytes_as_shares(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  if (!in_range(sample, usual, first, 0.0, 1.0, false)) return false;
  constexpr double kRounded = 0.01;  // of a step, beside what decimals leave
  constexpr std::size_t kFewest = 20;
  std::bitset<256> seen;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    for (std::size_t k = first; k < first + 3; ++k) {
      const double steps = 255.0 * row.values[k];
      if (std::abs(steps - std::round(steps)) > kRounded) return false;
      seen.set(static_cast<std::size_t>(std::lround(steps)));
    }
  }
  return seen.count() >= kFewest;
}

bool is_constant(const std::vector<TableRow>& sample, std::size_t usual, std::size_t column) {
  const auto is_usual = [&](const TableRow& row) { return row.count == usual; };
  const auto first = std::find_if(sample.begin(), sample.end(), is_usual);
  if (column >= usual || first == sample.end()) return false;
  const double value = first->values[column];
  return std::all_of(first, sample.end(),
                     [&](const TableRow& row) { return row.count != usual || row.values[column] == value; });
}

bool may_be_north_first(const std::vector<TableRow>& sample, int x, int y) {
  struct Grid {
    double least_north, most_north, least_east, most_east;  // metres
  };
  // UTM beyond 34 degrees; Gauss-Krueger with the zone's number, which says 5 where it could be a northing; LV95.
  static constexpr std::array<Grid, 3> kGrids{
      {{3.8e6, 1e7, 1.6e5, 8.4e5}, {4.9e6, 6.3e6, 2.2e6, 4.8e6}, {1.07e6, 1.3e6, 2.48e6, 2.84e6}}};
  return std::any_of(kGrids.begin(), kGrids.end(), [&](const Grid& grid) {
    return std::all_of(sample.begin(), sample.end(), [&](const TableRow& row) {
      if (!row.has_number(x) || !row.has_number(y)) return false;
      const double north = row.values[static_cast<std::size_t>(x)], east = row.values[static_cast<std::size_t>(y)];
      return north >= grid.least_north && north <= grid.most_north && east >= grid.least_east && east <= grid.most_east;
    });
  });
}

bool are_unit_vectors(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  if (usual < first + 3) return false;
  std::size_t rows = 0;
  for (const TableRow& row : sample) {
    if (row.count != usual) continue;
    const Eigen::Vector3d normal(row.values[first], row.values[first + 1], row.values[first + 2]);
    if (normal.isZero(0.0)) continue;  // of points for which none was found
    if (!(std::abs(normal.norm() - 1.0) < 0.01)) return false;
    ++rows;
  }
  return rows >= 3;
}

bool look_like_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  const bool negative = std::any_of(sample.begin(), sample.end(), [&](const TableRow& row) {
    const auto below = [](double v) { return v < 0.0; };
    return row.count == usual && std::any_of(row.values.begin() + static_cast<std::ptrdiff_t>(first),
                                             row.values.begin() + static_cast<std::ptrdiff_t>(first) + 3, below);
  });
  return negative && are_unit_vectors(sample, usual, first);
}

bool are_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first) {
  return are_unit_vectors(sample, usual, first) && !in_range(sample, usual, first, 0.0, 1.0, true);
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

std::size_t whole_before_fractions(const std::vector<TableRow>& sample, std::size_t usual) {
  constexpr std::size_t kFewest = 100;
  constexpr double kToAndFro = 0.1;
  constexpr double kMostly = 0.5;
  if (sample.size() < kFewest || !are_rows_alike(sample, usual)) return 0;
  const auto rows = static_cast<double>(sample.size());
  const auto share = [&](const auto& test) {
    return static_cast<double>(std::count_if(sample.begin(), sample.end(), test)) / rows;
  };
  const auto fractions = [&](std::size_t column) {
    return share(
        [&](const TableRow& row) { return std::isfinite(row.values[column]) && !is_whole(row.values[column]); });
  };
  std::size_t whole = 0;
  while (whole < 3 && whole < usual && fractions(whole) == 0.0) ++whole;
  if (whole == 0 || usual < whole + 3) return 0;
  for (std::size_t k = whole; k < whole + 3; ++k) {
    if (fractions(k) < kMostly) return 0;
  }
  if (whole == 3 && (look_like_normals(sample, usual, 3) || look_like_colours(sample, usual, 3))) return 0;
  if (whole > 1) return whole;
  std::size_t falls = 0;
  for (std::size_t k = 1; k < sample.size(); ++k) falls += sample[k].values[0] < sample[k - 1].values[0] ? 1 : 0;
  return static_cast<double>(falls) >= kToAndFro * rows ? 1 : 0;
}

bool look_like_poses(const std::vector<TableRow>& sample, std::size_t usual) {
  constexpr std::size_t kFewest = 3, kQuaternion = 4, kColumns = 8;
  constexpr double kUnit = 0.01;
  if (usual < kColumns || sample.size() < kFewest || !are_rows_alike(sample, usual)) return false;
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const std::array<double, kMostColumns>& values = sample[k].values;
    const Eigen::Vector4d quaternion(values[kQuaternion], values[5], values[6], values[7]);
    if (!(std::abs(quaternion.norm() - 1.0) < kUnit)) return false;
    if (k > 0 && !(values[0] > sample[k - 1].values[0])) return false;
  }
  return true;
}

bool looks_like_matrix(const std::vector<TableRow>& sample, std::size_t usual) {
  constexpr std::size_t kFewestColumns = 8, kFewestRows = 4;
  constexpr double kSmooth = 0.35, kSmoothEverywhere = 0.6;  // mean steps over the standard deviation of all values
  if (usual < kFewestColumns || sample.size() < kFewestRows || !are_rows_alike(sample, usual)) return false;
  std::vector<double> steps(usual, 0.0);  // from each column to the next
  double sum = 0.0;
  double squares = 0.0;
  const double first = sample[0].values[0];
  for (const TableRow& row : sample) {
    for (std::size_t k = 0; k < usual; ++k) {
      const double v = row.values[k] - first;
      if (!std::isfinite(v)) return false;
      sum += v;
      squares += v * v;
      if (k > 0) steps[k] += std::abs(row.values[k] - row.values[k - 1]);
    }
  }
  const auto rows = static_cast<double>(sample.size());
  const auto columns = static_cast<double>(usual);
  const double mean = sum / (rows * columns);
  const double deviation = std::sqrt(std::max(squares / (rows * columns) - mean * mean, 0.0));
  // Columns of several kinds differ where one ends and the next begins, however alike the others are.
  const double largest = *std::max_element(steps.begin(), steps.end()) / rows;
  const double usually = std::accumulate(steps.begin(), steps.end(), 0.0) / (rows * (columns - 1.0));
  return deviation > 0.0 && usually <= kSmooth * deviation && largest <= kSmoothEverywhere * deviation;
}

bool may_be_numbers_of_points(const std::vector<TableRow>& sample, const std::vector<int>& columns) {
  bool any_name = false;
  for (const TableRow& row : sample) {
    for (const int column : columns) {
      const auto k = static_cast<std::size_t>(column);
      if (row.has_number(column) && !is_whole(row.values[k])) return false;
      any_name = any_name || (row.has_word(column) && !are_numbers_but_for_look_alikes(row.words[k]));
    }
  }
  return any_name;
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

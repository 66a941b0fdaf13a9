#include "pipeline/scan/formats/grid/heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

namespace sparsha::pipeline::grid {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kBlanked = 1e30;  // Surfer's blank is 1.70141e38, float's largest 3.4e38

}  // namespace

bool parse_value(std::string_view word, double& value, bool& comma, bool& point) {
  std::array<char, 64> copy{};
  const char* begin = word.data();
  if (word.size() <= copy.size()) {
    if (const std::size_t at = word.find(','); at != std::string_view::npos) {
      std::copy(word.begin(), word.end(), copy.begin());
      copy[at] = '.';
      begin = copy.data();
      comma = true;
    } else if (word.find('.') != std::string_view::npos) {
      point = true;
    }
  }
  return parse_number(begin, begin + word.size(), value) == begin + word.size();
}

void require_plausible(const ScanFile& file, int line, const Raster& raster, std::size_t bytes_left) {
  constexpr std::uint64_t kSmall = 1U << 16;                 // whose rows are read, so that the error has its line
  const std::uint64_t most = (bytes_left + 1) / 2 + kSmall;  // a digit and a blank each
  if (raster.columns > most || raster.rows > most / raster.columns) {
    throw file.error_at(
        line,
        fmt::format("{} x {} values cannot be in the {} bytes that follow", raster.columns, raster.rows, bytes_left),
        "a header that fits the file; it may be cut short");
  }
  if (raster.columns * raster.rows >= std::numeric_limits<std::uint32_t>::max()) {
    throw file.error_at(line, fmt::format("a grid of {} x {} values", raster.columns, raster.rows),
                        "fewer than 2^32; a part of it");
  }
}

HeightReader::HeightReader(const ScanFile& file, ScanWriter& out, const Raster& raster, double no_data)
    : file_(file), out_(out), raster_(raster), no_data_(no_data), values_(file.bytes) {
  row_.reserve(static_cast<std::size_t>(raster.columns));
}

void HeightReader::read(LineReader& lines, std::string_view first) {
  const std::string promised = fmt::format("{} rows of {} values", raster_.rows, raster_.columns);
  values_ = lines;
  first_values_ = first;
  out_.begin(raster_.columns * raster_.rows, false, false);
  out_.scan().cell = {std::abs(raster_.dx), std::abs(raster_.dy)};
  bool comma = false, point = false;
  int line = lines.number();
  std::size_t told = 0;
  do {
    const int number = lines.number();
    for (std::string_view word = take_word(first); !word.empty(); word = take_word(first)) {
      if (word == "\x1A" && first.empty() && lines.offset() >= file_.bytes.size()) break;  // DOS's end of a file
      double value = 0.0;
      if (!parse_value(word, value, comma, point) || (comma && point)) {
        throw file_.error_at(number,
                             in_quotes(word) + (comma && point ? " among numbers with points" : " is not a number"),
                             "numbers with blanks between them, all with a point or all with a comma for decimals");
      }
      if (rows_ == raster_.rows) throw file_.error_at(number, "more values than the header promises", promised);
      if (row_.empty()) row_line_ = number;
      line = number;
      add_value(value);
      if (row_.size() == raster_.columns) {
        check_row_end(first.find_first_not_of(" \t\v\f") == std::string_view::npos, number, row_.size());
        end_row();
      }
    }
    if (one_line_ && !row_.empty()) check_row_end(false, number, row_.size());
    if (lines.offset() - told > (1U << 22)) {
      told = lines.offset();
      file_.done_before(told - 1);
    }
  } while (lines.next(first));
  if (rows_ < raster_.rows) {
    throw file_.error_at(line, fmt::format("the grid ends after {} of {} rows", rows_, raster_.rows),
                         promised + "; the file may be cut short");
  }
  tell_unlisted_no_data();
  doubt_lengths();
}

void HeightReader::check_row_end(bool at_line_end, int line, std::uint64_t found) {
  if (rows_ == 0) {
    by_lines_ = at_line_end;
    one_line_ = by_lines_ && row_line_ == line;
    return;
  }
  if (!by_lines_ || at_line_end) return;
  const std::string row = fmt::format("row {} of the grid", rows_ + 1);
  if (found < raster_.columns) {
    throw file_.error_at(line, fmt::format("{} has {} values", row, found), fmt::format("{} values", raster_.columns));
  }
  throw file_.error_at(line,
                       one_line_ ? fmt::format("{} has more than {} values", row, raster_.columns)
                                 : fmt::format("{}, which begins on line {}, does not end where a line ends, as the "
                                               "first one does",
                                               row, row_line_),
                       fmt::format("{} values in each row", raster_.columns));
}

bool HeightReader::is_no_data(double value) const { return static_cast<float>(value) == static_cast<float>(no_data_); }

/// Goes through all values when the first one is met that may be no data.
bool HeightReader::is_unlisted_no_data(double value) {
  if (!NoDataValues::is_candidate(value)) return false;
  if (!looked_for_unlisted_) {
    looked_for_unlisted_ = true;
    LineReader lines = values_;
    std::string_view line = first_values_;
    bool comma = false, point = false;
    std::size_t told = lines.offset();
    do {
      for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
        double other = 0.0;
        if (parse_value(word, other, comma, point) && !is_no_data(other)) unlisted_.add(other);
      }
      if (lines.offset() - told > (1U << 22)) {
        told = lines.offset();
        file_.throw_if_cancelled();
      }
    } while (lines.next(line));
    unlisted_.decide();
  }
  if (!unlisted_.contains(value)) return false;
  const auto found = std::find_if(unlisted_counts_.begin(), unlisted_counts_.end(),
                                  [&](const auto& entry) { return entry.first == value; });
  if (found == unlisted_counts_.end()) {
    unlisted_counts_.emplace_back(value, 1);
  } else {
    ++found->second;
  }
  return true;
}

void HeightReader::tell_unlisted_no_data() {
  for (const auto& [value, count] : unlisted_counts_) {
    out_.scan().warnings.push_back(fmt::format(
        "{} of {} values of the grid are {:.10g}, far from all others, as unknown heights are written, though the "
        "header does not say so; they are taken as unknown",
        count, raster_.columns * raster_.rows, value));
  }
}

void HeightReader::add_value(double value) {
  const bool no_data = is_no_data(value);
  if (no_data) ++no_data_count_;
  const bool known = !no_data && std::abs(value) < kBlanked && !is_unlisted_no_data(value);
  const double x = raster_.x + raster_.dx * static_cast<double>(row_.size());
  const double y = raster_.y + raster_.dy * static_cast<double>(rows_);
  known ? out_.add(x, y, value) : out_.add_invalid();
  row_.push_back(known ? value : kNaN);
}

void HeightReader::end_row() {
  constexpr std::size_t kSteps = 4096;
  const std::size_t stride = 1 + static_cast<std::size_t>(raster_.columns * raster_.rows / kSteps);
  for (std::size_t c = static_cast<std::size_t>(rows_) % stride; c + 1 < row_.size(); c += stride) {
    const double step = std::abs(row_[c + 1] - row_[c]);
    if (step > 0.0) steps_.push_back(step);
  }
  for (std::uint64_t c = 0; rows_ > 0 && c + 1 < raster_.columns; ++c) add_cell(c);
  std::swap(row_, before_);
  row_.clear();
  ++rows_;
}

/// Two triangles over the shorter diagonal, or one over the three corners that are known.
void HeightReader::add_cell(std::uint64_t column) {
  const auto c = static_cast<std::size_t>(column);
  const auto here = static_cast<std::uint32_t>(rows_ * raster_.columns + column);
  const auto there = static_cast<std::uint32_t>(here - raster_.columns);
  // Counterclockwise when rows go down and columns to the right.
  std::array<std::uint32_t, 4> corners{here, here + 1, there + 1, there};
  std::array<double, 4> z{row_[c], row_[c + 1], before_[c + 1], before_[c]};
  if ((raster_.dx > 0.0) == (raster_.dy > 0.0)) {
    std::reverse(corners.begin(), corners.end());
    std::reverse(z.begin(), z.end());
  }
  std::size_t unknown = 0, which = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (std::isnan(z[k])) {
      ++unknown;
      which = k;
    }
  }
  if (unknown > 1) return;
  const auto triangle = [&](std::size_t a) {
    out_.add_triangle(corners[a], corners[(a + 1) % 4], corners[(a + 2) % 4]);
  };
  if (unknown == 1) {
    triangle((which + 1) % 4);
  } else if (std::abs(z[0] - z[2]) <= std::abs(z[1] - z[3])) {
    triangle(0);
    triangle(2);
  } else {
    triangle(1);
    triangle(3);
  }
}

/// A grid in degrees with heights in metres or feet: its slopes are beyond any that a raster can hold.
void HeightReader::doubt_lengths() {
  constexpr double kSteepest = 50.0;
  constexpr double kWidest = 0.1;  // cells, in degrees
  const double cell = std::max(std::abs(raster_.dx), std::abs(raster_.dy));
  const auto most = [](double first, double step, std::uint64_t count) {
    return std::max(std::abs(first), std::abs(first + step * static_cast<double>(count - 1)));
  };
  if (steps_.empty() || cell > kWidest || most(raster_.x, raster_.dx, raster_.columns) > 180.0 ||
      most(raster_.y, raster_.dy, raster_.rows) > 90.0) {
    return;
  }
  const auto middle = steps_.begin() + static_cast<std::ptrdiff_t>(steps_.size() / 2);
  std::nth_element(steps_.begin(), middle, steps_.end());
  if (*middle < kSteepest * cell) return;
  RawScan& scan = out_.scan();
  scan.degrees = true;
  scan.guessed_degrees = true;
  scan.warnings.push_back(fmt::format(
      "x and y look like degrees of longitude and latitude: cells are {:.3g} wide, and heights differ by {:.3g} from "
      "one to the next; reproject the grid to metres, or give its 'units' if all three are lengths",
      cell, *middle));
}

}  // namespace sparsha::pipeline::grid

#include "pipeline/scan/formats/ptx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "pipeline/scan/scalar.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::array<std::size_t, 10> kHeaderShape = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};

/// Numbers of one line, at most eight; count of what is there, or nothing when a word is no number.
struct Row {
  std::array<double, 8> values{};
  std::size_t count = 0;
  bool good = true;
};

Row parse_row(std::string_view line) {
  Row row;
  const char* p = line.data();
  const char* const end = p + line.size();
  for (p = skip_blanks(p, end); p < end; p = skip_blanks(p, end)) {
    double value = 0.0;
    const char* const stop = parse_number(p, end, value);
    if (stop == nullptr || (stop < end && !is_blank(*stop)) || row.count == row.values.size()) {
      row.good = false;
      return row;
    }
    row.values[row.count++] = value;
    p = stop;
  }
  return row;
}

bool is_whole(double value) { return value >= 0.0 && value < 4294967296.0 && value == std::floor(value); }

bool next_row(LineReader& lines, Row& row, std::string_view& line) {
  while (lines.next(line)) {
    row = parse_row(line);
    if (!row.good || row.count > 0) return true;
  }
  return false;
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), lines_(file.bytes) {}

  void read() {
    std::string_view line;
    Row row;
    std::size_t scans = 0;
    while (next_row(lines_, row, line)) {
      read_header(row);
      if (scans == 0) begin();
      out_.set_station(shift_);  // the scanner is its own origin
      read_points();
      ++scans;
    }
    out_.scan().scans = scans;
  }

 private:
  void read_header(Row row) {
    std::array<Row, 10> header;
    std::string_view line;
    int first = 0;
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (i == 0) first = lines_.number();
      if (i > 0 && !next_row(lines_, row, line)) {
        throw file_.error_at(lines_.number(), "the file ends within a scan's header", "ten lines");
      }
      if (i == 0 && scan_line_ > 0 && row.good && row.count >= 3) {
        throw file_.error_at(lines_.number(),
                             "behind the scan that begins on line " + std::to_string(scan_line_) + " and has " +
                                 std::to_string(points_) + " points stands another point",
                             "as many points as its two first lines say");
      }
      if (!row.good || row.count != kHeaderShape[i]) {
        throw file_.error_at(lines_.number(), "bad line " + std::to_string(i + 1) + " of a PTX header",
                             std::to_string(kHeaderShape[i]) + " numbers");
      }
      header[i] = row;
    }
    if (!is_whole(header[0].values[0]) || !is_whole(header[1].values[0])) {
      throw file_.error_at(lines_.number(), "bad size of a scan's grid", "whole numbers of columns and rows");
    }
    scan_line_ = first;
    points_ = static_cast<std::uint64_t>(header[0].values[0]) * static_cast<std::uint64_t>(header[1].values[0]);
    constexpr std::uint64_t kShortest = 6;  // "0 0 0" and its end
    const std::uint64_t left = file_.bytes.size() - lines_.offset();
    if (points_ > (left + 1) / kShortest) {
      throw file_.error_at(
          lines_.number(),
          std::to_string(points_) + " points cannot be in the " + std::to_string(left) + " bytes that follow",
          "a header that fits the file; it may be cut short");
    }
    // Points are rows: p' = (x y z 1) M, the last line of M being the shift.
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 3; ++k) {
        const double value = header[static_cast<std::size_t>(6 + i)].values[static_cast<std::size_t>(k)];
        if (!std::isfinite(value)) throw file_.error_at(lines_.number(), "the scan's matrix is not finite", "numbers");
        i < 3 ? turn_(k, i) = value : shift_[k] = value;
      }
      if (header[static_cast<std::size_t>(6 + i)].values[3] != (i < 3 ? 0.0 : 1.0)) {
        throw file_.error_at(lines_.number() - 3 + i, "a scan's matrix that is not affine",
                             "0, 0, 0 and 1 in its last column");
      }
    }
    check_turn();
  }

  /// A scanner's pose turns and shifts. What scales or mirrors is taken as it stands, but told.
  void check_turn() {
    constexpr double kRounded = 1e-3;  // matrices are written with few digits
    const double volume = turn_.determinant();
    const double product = turn_.col(0).norm() * turn_.col(1).norm() * turn_.col(2).norm();
    if (!(std::fabs(volume) > 1e-9 * product)) {
      throw file_.error_at(lines_.number(), "a scan's matrix is singular", "a rotation and a translation");
    }
    const double off = (turn_.transpose() * turn_ - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (volume > 0.0 && off <= kRounded) return;
    out_.scan().warnings.push_back("the matrix that ends on line " + std::to_string(lines_.number()) +
                                   (volume < 0.0 ? " mirrors" : " scales or shears") +
                                   " its scan; applied as it stands");
  }

  void begin() {
    RawScan& scan = out_.scan();
    scan.format = "PTX text";
    scan.fields = {"x", "y", "z"};
    out_.begin(0, false, false);
  }

  void add_field(const char* name) {
    std::vector<std::string>& fields = out_.scan().fields;
    if (std::find(fields.begin(), fields.end(), name) == fields.end()) fields.emplace_back(name);
  }

  /// What a point has is told by the number of its values, since stations of one file differ: x y z, perhaps an
  /// intensity, perhaps red green blue. Within a station what one point has all have from then on, be it none.
  void use_columns(std::size_t columns) {
    if (columns == columns_) return;
    columns_ = columns;
    intensity_ = intensity_ || has_intensity();
    colour_ = colour_ || has_colour();
    if (intensity_) add_field("intensity");
    for (const char* name : {"red", "green", "blue"})
      if (colour_) add_field(name);
    out_.set_attributes(colour_, intensity_);
  }
  [[nodiscard]] bool has_intensity() const { return columns_ == 4 || columns_ >= 7; }
  [[nodiscard]] bool has_colour() const { return columns_ >= 6; }

  void read_points() {
    std::string_view line;
    Row row;
    columns_ = 0;
    colour_ = intensity_ = false;
    for (std::uint64_t i = 0; i < points_; ++i) {
      if (!next_row(lines_, row, line)) {
        throw file_.error_at(lines_.number(),
                             "the file ends after " + std::to_string(i) + " of " + std::to_string(points_) + " points",
                             "a line for each point");
      }
      if (row.good && row.count == 1) {
        throw file_.error_at(lines_.number(),
                             "the scan that begins on line " + std::to_string(scan_line_) + " has " +
                                 std::to_string(i) + " of its " + std::to_string(points_) +
                                 " points where the next one begins",
                             "a line for each point of its grid");
      }
      if (!row.good || row.count < 3 || row.count == 5) {
        throw file_.error_at(lines_.number(), in_quotes(line) + " is no PTX point",
                             "x y z intensity, or x y z intensity red green blue");
      }
      const Eigen::Vector3d p(row.values[0], row.values[1], row.values[2]);
      if (p.isZero(0.0)) {  // the grid's cell got no answer
        out_.add_invalid();
        continue;
      }
      use_columns(row.count);
      const Eigen::Vector3d q = turn_ * p + shift_;
      std::uint32_t rgba = kNoColour;
      if (has_colour()) {
        const std::size_t red = columns_ == 6 ? 3 : 4;
        rgba = pack_rgba(colour_byte(row.values[red], ColourScale::byte),
                         colour_byte(row.values[red + 1], ColourScale::byte),
                         colour_byte(row.values[red + 2], ColourScale::byte));
      }
      out_.add(q.x(), q.y(), q.z(), rgba, has_intensity() ? static_cast<float>(row.values[3]) : kNoIntensity);
      if ((i & 0xFFFF) == 0xFFFF) file_.done_before(lines_.offset() - 1);
    }
  }

  const ScanFile& file_;
  ScanWriter& out_;
  LineReader lines_;
  std::uint64_t points_ = 0;
  int scan_line_ = 0;        ///< where the station's header begins; 0 before the first
  std::size_t columns_ = 0;  ///< of the station's last point
  bool colour_ = false, intensity_ = false;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
};

}  // namespace

bool is_ptx(const ScanFile& file) {
  const std::string_view head = file.bytes.substr(0, 1 << 14);
  LineReader lines(head);
  std::string_view line;
  Row row;
  for (const std::size_t count : kHeaderShape) {
    if (!next_row(lines, row, line) || !row.good || row.count != count) return false;
    if (count == 1 && !is_whole(row.values[0])) return false;
  }
  return true;
}

void read_ptx(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline

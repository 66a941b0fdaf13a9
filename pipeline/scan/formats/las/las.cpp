#include "pipeline/scan/formats/las/las.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/formats/las/laz.h"
#include "pipeline/scan/formats/las/notes.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline {
namespace {

/// Withheld points are to be treated as deleted (LAS 1.4 R15, table 8 and 16); LAS 1.0 knows no such flag.
bool is_withheld(const las::Header& header, const char* point) {
  const auto flags = load<std::uint8_t>(point + 15);
  return header.format >= 6 ? (flags & 4) != 0 : header.minor > 0 && (flags & 128) != 0;
}

}  // namespace

bool is_las(const ScanFile& file) { return file.bytes.substr(0, 4) == "LASF"; }

namespace las {

PointReader::PointReader(const Header& header, const Units& units, ScanWriter& out)
    : header_(header), out_(out), colour_(header.colour_offset()), z_factor_(units.z_factor) {
  for (PointField& field : point_fields(header)) {
    out.scan().fields.push_back(field.name);
    const int slot = out.want(field.name);
    if (slot == ScanWriter::kUnwanted) continue;
    fields_.push_back({std::move(field), slot});
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t a = stored(header.box_low[k] - header.box_side, k);
    const std::int32_t b = stored(header.box_high[k] + header.box_side, k);
    low_[k] = std::min(a, b);  // a scale may be negative
    high_[k] = std::max(a, b);
    least_[k] = std::numeric_limits<std::int32_t>::max();
    most_[k] = std::numeric_limits<std::int32_t>::min();
  }
}

std::int32_t PointReader::stored(double coordinate, std::size_t axis) const {
  constexpr double kLow = std::numeric_limits<std::int32_t>::min();
  constexpr double kHigh = std::numeric_limits<std::int32_t>::max();
  const double number = (coordinate - header_.offset[axis]) / header_.scale[axis];
  if (!(number > kLow)) return std::numeric_limits<std::int32_t>::min();  // also of a box that is not a number
  return static_cast<std::int32_t>(std::min(number, kHigh));
}

void PointReader::finish(const ScanFile& file) {
  if (out_.is_part()) {
    out_.scan().needs_whole = withheld_ > 0 || outside_ > 0;
    return;
  }
  if (withheld_ > 0) {
    out_.scan().warnings.push_back(
        fmt::format("{} of {} points are withheld, as the file flags what was deleted; they are counted as invalid",
                    withheld_, withheld_ + count_));
  }
  compare_with_box(file);
}

void PointReader::compare_with_box(const ScanFile& file) {
  constexpr std::array<double, 3> kZero{};
  if (header_.box_low == kZero && header_.box_high == kZero) {
    if (outside_ > 0)
      out_.scan().notes.emplace_back("LAS: the header's box of the points is zero, as it was not filled in");
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(header_.box_low[k] > header_.box_high[k])) continue;
    out_.scan().warnings.push_back(fmt::format(
        "the header's box of the points has its least {0} ({1:.10g}) above its largest ({2:.10g}); it is not "
        "used",
        "xyz"[k], header_.box_low[k], header_.box_high[k]));
    return;
  }
  if (outside_ == 0 || !(header_.box_side > 0.0)) return;
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, (static_cast<double>(most_[k]) - least_[k]) * std::fabs(header_.scale[k]));
  }
  // Many points, and spread: a box that somebody forgot to move has the points' size.
  constexpr double kAbsurd = 100.0;
  if (outside_ > count_ / 100 && longest > kAbsurd * header_.box_side) {
    throw file.error(fmt::format("{} of {} points lie far outside the header's box, {:.3g} across where it has {:.3g}",
                                 outside_, count_, longest, header_.box_side),
                     "undamaged points; the file may have been copied as text");
  }
  out_.scan().warnings.push_back(
      fmt::format("{} of {} points lie far outside the box that the header gives", outside_, count_));
}

std::vector<std::pair<std::size_t, std::size_t>> PointReader::used_bytes() const {
  std::vector<std::pair<std::size_t, std::size_t>> used = {{0, 14}, {15, 16}};  // place, intensity, flags
  if (colour_ != 0) used.emplace_back(colour_, colour_ + 6);
  for (const WantedField& wanted : fields_) used.emplace_back(wanted.field.offset, wanted.field.end());
  return used;
}

void PointReader::look(const char* point) {
  if (colour_ == 0) return;
  for (std::size_t k = 0; k < 3; ++k) colours_.look(load<std::uint16_t>(point + colour_ + 2 * k));
  scale_ = colours_.scale();
}

void PointReader::set_colours(const ColourRange& colours) {
  colours_ = colours;
  scale_ = colours_.scale();
}

void PointReader::add(const char* point) {
  if (is_withheld(header_, point)) {
    out_.add_invalid();
    ++withheld_;
    return;
  }
  for (const WantedField& wanted : fields_) out_.set_field(wanted.slot, wanted.field.value(point));
  std::array<std::int32_t, 3> xyz;
  bool outside = false;
  for (std::size_t k = 0; k < 3; ++k) {
    xyz[k] = load<std::int32_t>(point + 4 * k);
    least_[k] = std::min(least_[k], xyz[k]);
    most_[k] = std::max(most_[k], xyz[k]);
    outside = outside || xyz[k] < low_[k] || xyz[k] > high_[k];
  }
  ++count_;
  outside_ += outside ? 1 : 0;
  const auto coordinate = [&](std::size_t k) {
    return static_cast<double>(xyz[k]) * header_.scale[k] + header_.offset[k];
  };
  std::uint32_t rgba = kWhite;
  if (colour_ != 0) {
    const auto channel = [&](std::size_t k) {
      return colour_byte(load<std::uint16_t>(point + colour_ + 2 * k), scale_);
    };
    rgba = pack_rgba(channel(0), channel(1), channel(2));
  }
  out_.add(coordinate(0), coordinate(1), z_factor_ == 1.0 ? coordinate(2) : coordinate(2) * z_factor_, rgba,
           static_cast<float>(load<std::uint16_t>(point + 12)));
}

}  // namespace las

void read_las(const ScanFile& file, ScanWriter& out) {
  const las::Header header = las::parse_header(file);
  const las::Units units = las::find_units(header);
  RawScan& scan = out.scan();
  scan.format =
      (header.compressed ? "LAZ 1." : "LAS 1.") + std::to_string(header.minor) + " pf" + std::to_string(header.format);
  scan.unit = units.unit;
  scan.degrees = units.degrees;
  scan.notes = las::notes_of(file, header);
  scan.warnings = header.warnings;
  scan.warnings.insert(scan.warnings.end(), units.warnings.begin(), units.warnings.end());
  scan.fields = {"x", "y", "z", "intensity"};
  const bool colour = header.colour_offset() != 0;
  if (colour) scan.fields.insert(scan.fields.end(), {"red", "green", "blue"});
  las::PointReader reader(header, units, out);
  if (header.compressed) {
    las::read_compressed(file, header, units, reader, out);
    reader.finish(file);
    return;
  }
  const auto [first, last] = out.part_of(header.points);
  out.begin(last - first, colour, true);
  const char* p = file.bytes.data() + header.first_point;
  if (colour) {
    at_sampled_records(header.points, [&](std::uint64_t i) {
      reader.look(p + i * header.record_size);
      return !reader.colours().is_decided();
    });
  }
  p += first * header.record_size;
  for (std::uint64_t i = first; i < last; ++i, p += header.record_size) {
    reader.add(p);
    if ((i & 0xFFFF) == 0xFFFF) file.done_before(static_cast<std::size_t>(p - file.bytes.data()));
  }
  reader.finish(file);
}

}  // namespace sparsha::pipeline

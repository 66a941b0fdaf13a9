// Points of LAS files, packed or not.
#pragma once

#include <utility>
#include <vector>

#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/formats/las/fields.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/formats/las/laz/points.h"
#include "pipeline/scan/scalar.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline::las {

/// Turns points, as LAS lays them out, into records.
class PointReader {
 public:
  PointReader(const Header& header, const Units& units, ScanWriter& out);

  /// To be called with some points before the first add(): finds the range of the colours.
  void look(const char* point);
  [[nodiscard]] const ColourRange& colours() const { return colours_; }
  /// What another reader found.
  void set_colours(const ColourRange& colours);
  void add(const char* point);
  /// Begin and end of the parts of a point that it looks at.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> used_bytes() const;
  /// To be called behind the last point: tells of points that are left out; throws Error{input}, or warns, when points
  /// lie far outside the header's box.
  void finish(const ScanFile& file);

 private:
  struct WantedField {
    PointField field;
    int slot = 0;
  };
  void compare_with_box(const ScanFile& file);
  [[nodiscard]] std::int32_t stored(double coordinate, std::size_t axis) const;

  const Header& header_;
  ScanWriter& out_;
  std::size_t colour_;
  std::vector<WantedField> fields_;
  std::uint64_t withheld_ = 0;
  double z_factor_;
  ColourRange colours_{false};
  ColourScale scale_ = ColourScale::byte;
  std::array<std::int32_t, 3> low_,
      high_;                                  ///< the box with a margin, as points store coordinates
  std::array<std::int32_t, 3> least_, most_;  ///< of the points
  std::uint64_t count_ = 0, outside_ = 0;
};

/// How the points are packed. Throws Error{input} without the record that describes it, laz::Damage when it makes no
/// sense.
[[nodiscard]] laz::Packing find_packing(const ScanFile& file, const Header& header);

/// Those that hold what the reader looks at.
[[nodiscard]] laz::Layers wanted_layers(const laz::Packing& packing, const PointReader& reader);

/// Lets the reader look at the colours of some of the file's chunks, of which all are given in its order: the first,
/// and unless that decides their scale others spread over the file. A damaged chunk tells nothing. Gives the bytes of
/// those that were read. Without chunks all points are looked at, up to the first that decides. Throws Cancelled.
std::uint64_t look_at_colours(const ScanFile& file, const laz::Source& source, const std::vector<laz::Chunk>& chunks,
                              PointReader& reader);

/// Reads LAZ points, chunks in parallel. Throws Error{input} with byte and chunk when the file is damaged.
void read_compressed(const ScanFile& file, const Header& header, const Units& units, PointReader& reader,
                     ScanWriter& out);

}  // namespace sparsha::pipeline::las

// Where every reader puts its records: checks that they are finite, blocks them, and turns polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/scan/reader.h"
#include "pipeline/scan/shared_reading.h"

namespace sparsha::pipeline {

/// 0xAABBGGRR.
[[nodiscard]] constexpr std::uint32_t pack_rgba(std::uint32_t r, std::uint32_t g, std::uint32_t b,
                                                std::uint32_t a = 255) {
  return r | g << 8 | b << 16 | a << 24;
}
/// From 0xAARRGGBB.
[[nodiscard]] constexpr std::uint32_t unpack_argb(std::uint32_t argb, bool opaque) {
  return pack_rgba(argb >> 16 & 255, argb >> 8 & 255, argb & 255, opaque ? 255 : argb >> 24);
}
/// A warning that faces' colours are not read: only points have colours.
[[nodiscard]] std::string unused_face_colours(std::uint64_t faces);
inline constexpr std::uint32_t kWhite = 0xFFFFFFFFu;

class ScanWriter {
 public:
  /// Points go to `sink`, or into `scan` when it is empty.
  ScanWriter(RawScan& scan, const PointSink& sink, const ReadOptions& options = {});

  /// Everything about the scan but its points; the reader fills it in.
  [[nodiscard]] RawScan& scan() { return scan_; }

  /// To be called once before the first record, with a number already checked against the file's size, and with what
  /// the records have.
  void begin(std::uint64_t records, bool colour, bool intensity, bool normals = false);
  [[nodiscard]] bool has_colour() const { return colour_; }
  /// Of so many records of one length the first that is wanted, and the one behind the last.
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> part_of(std::uint64_t records) const {
    return {record_at(records, from_), record_at(records, to_)};
  }
  [[nodiscard]] bool is_part() const { return from_ > 0.0 || to_ < 1.0; }
  /// See ReadOptions.
  [[nodiscard]] const Region& region() const { return region_; }
  [[nodiscard]] std::uint64_t enough() const { return enough_; }
  [[nodiscard]] bool whole_chunks_only() const { return whole_chunks_only_; }
  /// The file has no faces, so that nobody asks for the numbers of its invalid records: any number of them takes no
  /// memory.
  void expect_no_faces() { may_have_faces_ = false; }
  /// What the records from now on have: blocks of one file may differ. The points of the others get kNoColour,
  /// kNoIntensity and a normal of zero.
  void set_attributes(bool colour, bool intensity, bool normals = false);
  /// Records so far, valid or not.
  [[nodiscard]] std::uint64_t records() const { return valid_ + filled_ + scan_.invalid; }

  /// Records from now on were seen from here, file units.
  void set_station(const std::optional<Eigen::Vector3d>& place);

  /// Tells that records have a number of this name, as the file has it. Returns where set_field() puts it, kUnwanted
  /// when nobody asks for it. `counted`: it may be counted for people to see.
  [[nodiscard]] int want(std::string_view name, bool counted = true);
  static constexpr int kUnwanted = -1;
  /// Of the next record; those for which it is not called have none.
  void set_field(int slot, double value) {
    fields_[static_cast<std::size_t>(slot)].values[filled_] = static_cast<float>(value);
  }

  /// Of the next record, when there are normals: of any length, turned as the file's own pose turns points.
  void set_normal(double x, double y, double z) { normals_[filled_] = Eigen::Vector3d(x, y, z).cast<float>(); }

  /// One record. Counted as invalid when a coordinate is not finite.
  void add(double x, double y, double z) {
    if (!are_finite(x, y, z)) {
      add_invalid();
      return;
    }
    points_[filled_] = {x, y, z};
    if (++filled_ == kBlock) flush();
  }
  void add(double x, double y, double z, std::uint32_t rgba, float intensity = 0.0F) {
    rgba_[filled_] = rgba;
    intensity_[filled_] = intensity;
    add(x, y, z);
  }
  /// One record that the file itself flags as invalid.
  void add_invalid();

  /// A face over records (valid or not), which may be read before its points. Faces with vertices that do not exist are
  /// left out by finish() and counted in a warning.
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (scan_.faces.size() < face_room_) {
      scan_.faces.push_back({a, b, c});
    } else {
      add_beyond_room(a, b, c);
    }
  }
  void add_polygon(std::span<const std::uint32_t> corners);
  /// All faces so far name the records behind those that were said; none that is the last number becomes the first.
  void count_faces_from_zero();
  /// The file says that it has so many vertices and at least so many triangles. Throws when such a mesh is refused.
  void expect_mesh(std::uint64_t vertices, std::uint64_t triangles) const;
  /// Whether somebody may refuse a mesh by its size.
  [[nodiscard]] bool may_refuse() const { return static_cast<bool>(mesh_refusal_); }
  /// A file whose face has more is damaged or means harm; readers refuse it before they take memory for the face.
  static constexpr std::size_t kMostCorners = 65536;

  /// Hands over the last block, triangulates and renumbers the faces.
  void finish();

 private:
  static constexpr std::size_t kBlock = 4096;
  static bool are_finite(double x, double y, double z) { return ((x - x) + (y - y) + (z - z)) == 0.0; }
  /// A field that somebody asks for.
  struct WantedField {
    std::string key;
    std::optional<std::size_t> kept{};   ///< place among ReadOptions::fields
    std::optional<std::size_t> tally{};  ///< place among RawScan::tallies
    std::vector<float> values = std::vector<float>(kBlock, std::numeric_limits<float>::quiet_NaN());
  };
  void flush();
  void hand_over();
  FieldTally& tally_of(const std::string& key);
  void triangulate_polygons();
  void renumber_faces();
  void add_beyond_room(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  [[nodiscard]] std::uint64_t triangles() const;
  bool make_room_for_faces();

  RawScan& scan_;
  const PointSink& sink_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint32_t> rgba_;
  std::vector<float> intensity_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<std::string> kept_names_;
  ReadOptions::Tally tally_;
  std::vector<WantedField> fields_;
  std::size_t filled_ = 0;
  std::optional<Eigen::Vector3d> station_;
  std::uint64_t valid_ = 0;  ///< already handed over
  bool colour_ = false;
  bool has_intensity_ = false;
  bool has_normals_ = false;
  bool may_have_faces_ = true;
  std::vector<std::uint64_t> dropped_;   ///< numbers of invalid records, ascending; of files that may have faces
  std::vector<std::uint32_t> polygons_;  ///< corner count, then corners, of faces with more than three
  std::uint64_t polygon_triangles_ = 0;  ///< that they will give
  MeshRefusal mesh_refusal_;
  Region region_;
  std::uint64_t enough_;
  bool whole_chunks_only_;
  double from_, to_;
  std::size_t face_room_ = std::numeric_limits<std::size_t>::max();  ///< faces until somebody is asked again
  bool refused_ = false;                                             ///< faces are only counted
  std::uint64_t counted_ = 0;                                        ///< of them
};

}  // namespace sparsha::pipeline

// Checked readers for scan files. None trusts a header: sizes are compared with the file before memory is taken.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/fields.h"
#include "scene/config/scans.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// From point `first` on, points were seen from `place`, which is unknown where it is absent. File units.
struct RawStation {
  std::size_t first = 0;
  std::optional<Eigen::Vector3d> place;
};

/// What the columns of a text table are, and what tells it.
struct TextTable {
  enum class By : std::uint8_t {
    position,       ///< no names: x, y and z are the first three columns
    shape,          ///< no names, but the values leave no doubt
    names,          ///< the file's header
    configuration,  ///< `scans: columns`
  };
  By by = By::position;
  std::vector<std::string> columns;  ///< of most rows, in the words of `scans: columns`
};

/// Of a mesh of so many vertices and triangles: the error with which it is refused, or nothing when it may be read.
using MeshRefusal = std::function<std::optional<Error>(std::uint64_t vertices, std::uint64_t triangles)>;

/// Whether a point within this box may be wanted: file units, z as points have it; `unit` is what the file says.
using Region = std::function<bool(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                  const std::optional<scene::LengthUnit>& unit)>;

/// What is known of a file besides its bytes.
struct ReadOptions {
  enum class Tally : std::uint8_t {
    none,
    worth,  ///< of what tells the worth of a point, see tells_worth()
    all,    ///< of every number but coordinates, colours and normals
  };
  std::vector<std::string> columns{};  ///< ScanConfig::columns
  std::vector<std::string> fields{};   ///< whose values are wanted point by point, as field_key() gives them
  Tally tally = Tally::worth;          ///< what is counted in RawScan::tallies
  /// Asked before a mesh is in memory: when the file says how large it is, else while it is read; what is refused is
  /// only counted from then on, and its error thrown at the end.
  MeshRefusal mesh_refusal{};
  /// A format that keeps points in groups with known places (COPC) leaves those unread that this refuses, and counts
  /// them in RawScan::unread; others read all points.
  Region region{};
  /// A format that keeps coarse points apart from those that refine them (COPC) leaves levels unread that it does not
  /// need for so many points; 0: all points.
  std::uint64_t enough = 0;
  /// A format whose records have one length (is_quick_to_stream()) reads those from one share of all of them to
  /// another, see record_at(); others read all of them.
  double from = 0.0, to = 1.0;
  /// Damaged chunks of LAZ are left out and said, in place of an error.
  bool whole_chunks_only = false;
};

/// One scan as the file has it: file units, double, before any pose but with the file's own.
struct RawScan {
  std::string format;                               ///< "PLY binary little-endian", "LAS 1.2 pf3", ...
  std::vector<Eigen::Vector3d> points;              ///< finite ones only
  std::vector<std::uint32_t> rgba;                  ///< 0xAABBGGRR or kNoColour; empty or one per point
  std::vector<float> intensity;                     ///< kNoIntensity where unknown; empty or one per point
  std::vector<Eigen::Vector3f> normals;             ///< as stated, of any length, zero: none; empty or one per point
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< triangles of valid points, indices into `points`
  std::vector<std::vector<float>> values;  ///< of each of ReadOptions::fields: empty or one per point, NaN: none
  std::uint64_t records = 0;               ///< point records (STL: distinct vertices), invalid ones included
  std::uint64_t invalid = 0;               ///< records not finite or flagged invalid
  std::uint64_t unread = 0;                ///< records, beside `records`, that nobody wants by ReadOptions
  std::vector<std::string> notes;          ///< what is special in the file, for `sparsha info`
  std::vector<std::string> fields;         ///< "x", "y", "z", "red", ...
  std::vector<FieldTally> tallies;         ///< of valid points
  std::optional<scene::LengthUnit> unit;   ///< what the format says
  bool several_units = false;              ///< remarks give several, of which none is taken
  bool degrees = false;                    ///< x and y are longitude and latitude: shown by info, refused by load_scan
  bool guessed_degrees = false;  ///< so it seems, though the file does not say so; a configured unit overrules it
  std::size_t scans = 1;         ///< scans within the file
  std::optional<std::array<double, 7>> viewpoint;  ///< PCD: tx ty tz qw qx qy qz; shown, never applied
  std::vector<RawStation> stations;                ///< in memory only, ascending; streams name them block by block
  std::optional<TextTable> table;                  ///< of text tables of points
  std::optional<Eigen::Vector2d> cell;  ///< of grids of heights over x and y: their columns' and rows' distance
  bool needs_whole = false;             ///< of a part of the records: what is to be said of it depends on the others
  std::vector<std::string> warnings;
  std::string pieces;  ///< a warning too, of a scan in several pieces: only for those who take none away
};

/// Of a RawScan's format: whether z is up by its custom, else y.
[[nodiscard]] bool is_z_up(const std::string& format);
/// Whether y is up by its specification.
[[nodiscard]] bool is_y_up(const std::string& format);

/// Reads any supported file, told by content first and ending second. Throws Error{input} with file, line where there
/// is one, and what was expected; Cancelled when `progress` is cancelled. A
/// file that declares zero points gives zero points. Columns that are named for a file that is no text table are an
/// error, too.
[[nodiscard]] RawScan read_scan(const std::filesystem::path& file, const Progress* progress = nullptr,
                                const ReadOptions& options = {});

/// Some consecutive valid points of a scan; spans are good during the call only.
struct PointBlock {
  std::span<const Eigen::Vector3d> points;           ///< file units, the file's own pose applied
  std::span<const std::uint32_t> rgba;               ///< empty or one per point
  std::span<const float> intensity;                  ///< empty or one per point
  std::optional<Eigen::Vector3d> station{};          ///< where the scanner stood, when the file says so
  std::span<const Eigen::Vector3f> normals{};        ///< empty or one per point
  std::span<const std::span<const float>> fields{};  ///< of each of ReadOptions::fields: empty or one per point
};
using PointSink = std::function<void(const PointBlock&)>;

/// read_scan in constant memory for the points: they go to `sink` block by block, in the file's order, and the result
/// holds all the rest (faces too, but polygons as fans, right only where they are convex). Several threads may stream
/// different files.
RawScan stream_scan(const std::filesystem::path& file, const PointSink& sink, const Progress* progress = nullptr,
                    const ReadOptions& options = {});

/// Reads, scales and poses one configured scan: scan = pose * units * p. The origin is `origin_m` when given, else
/// common_origin's choice. Throws Error{input}, also on an empty scan; warns of implausible units through `progress`.
[[nodiscard]] Cloud load_scan(const scene::ScanConfig& scan, Progress& progress,
                              const std::optional<Eigen::Vector3d>& origin_m = std::nullopt);

/// Reads all scans of a configuration into one cloud with one origin, in the configuration's order. The origin depends
/// on the set of points only, neither on the order of files nor on that of points, and no outlier moves it far: the
/// median of the points in whole metres, so that a scan near its own zero keeps its float32 coordinates bit for bit.
[[nodiscard]] Cloud load_scans(const std::vector<scene::ScanConfig>& scans, Progress& progress,
                               std::vector<scene::ScanSource>* sources = nullptr);

/// What `sparsha info` prints of a scan.
struct ScanInfo {
  std::string format;
  std::uint64_t points = 0;
  std::uint64_t invalid = 0;
  std::vector<std::string> notes;                   ///< as RawScan has them
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();  ///< metres; file units when `units` is unknown or degrees
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
  double spacing_m = 0.0;  ///< median nearest-neighbour distance of a sample, duplicates left out; 0 when unknown
  std::vector<std::string> fields;
  std::vector<FieldTally> tallies;  ///< of the fields that are numbers: all but coordinates, colours and normals
  std::string units;                ///< "m", "ft", "unknown", ...
  std::uint64_t triangles = 0;      ///< of a mesh, on valid points
  std::uint64_t duplicates = 0;     ///< valid points that repeat another one exactly
  std::size_t scans = 1;
  std::optional<std::array<double, 7>> viewpoint;
  std::vector<std::string> warnings;
  std::vector<Eigen::Vector3d> sample_m;  ///< of the valid points, chosen by a hash; units as in min_m
};
[[nodiscard]] ScanInfo inspect_scan(const std::filesystem::path& file, const Progress* progress = nullptr);

}  // namespace sparsha::pipeline

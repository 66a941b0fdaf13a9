// One scan that was looked at: everything but its points, which are kept in double or streamed from the file again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/files/message.h"
#include "base/threads/progress.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/placement.h"
#include "pipeline/scan/raster_steps.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/seen_stations.h"
#include "pipeline/scan/set.h"
#include "pipeline/scan/shared_reading.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

struct LookedScan {
  std::filesystem::path file;
  ReadOptions options;
  RawScan raw;
  std::uint64_t faces = 0;  ///< of the file; `raw` holds them only where all is in memory
  bool streamed = false;
  std::uint64_t delivered = 0;  ///< finite points of the file
  std::uint64_t valid = 0;      ///< of these, without empty returns
  bool colour = false;
  bool intensity = false;
  bool normals = false;
  std::vector<bool> has_field;       ///< of ReadOptions::fields
  FileShare share;                   ///< what this process reads of it, when several do
  std::uint64_t own = 0;             ///< finite points of that
  std::size_t number = 0, size = 1;  ///< this process among those

  /// Points that were looked at, file units.
  struct Looked {
    std::uint64_t count = 0;
    PointSample sample;
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;

    void add(const Eigen::Vector3d& p, bool bounds) {
      ++count;
      sample.add(p);
      if (!bounds) return;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    void add(const Looked& other);
    void write(MessageWriter& message) const;
    void add(MessageReader& message);
  };
  Looked looked;      ///< all but
  Looked at_scanner;  ///< what may be empty returns, until their number is known
  Placement placement;
  std::vector<SeenStation> from;  ///< each station that the file names
  bool posed = false;             ///< by the configuration, which moves the file's origin
  RasterSteps about_origin;       ///< of points of a posed scan whose station the file does not name
  PointSample with_normal;        ///< points whose normals the file states, file units
  PointSample normal_at_scanner;

  /// Reads the scan, or what `share` leaves this process of it, and keeps all but its points. Throws Error{input}.
  [[nodiscard]] static std::unique_ptr<LookedScan> read(const scene::ScanConfig& config,
                                                        const std::vector<std::string>& fields, bool streamed,
                                                        Progress& progress, const MeshRefusal& mesh_refusal = {},
                                                        const ScanPart& part = {}, const FileShare& share = {});
  /// What is known of the scan before it is read.
  void prepare(const scene::ScanConfig& config, const std::vector<std::string>& fields, const ScanPart& part);
  /// Reads all of the scan and settles it.
  [[nodiscard]] static std::unique_ptr<LookedScan> look_at(const scene::ScanConfig& config,
                                                           const std::vector<std::string>& fields, bool streamed,
                                                           Progress& progress, const MeshRefusal& mesh_refusal = {},
                                                           const ScanPart& part = {});
  /// After all of it has been read: decides what is surface, doubts, warns and places it. Throws Error{input}.
  void settle(const scene::ScanConfig& config, Progress& progress);
  /// After the last block: whether what stands at the scanner is surface.
  void decide_empty_returns();

  /// What another process that has read a part of the scan, or all of it, needs to tell.
  void write(MessageWriter& message) const;
  void add(MessageReader& message, bool first);

  /// All of its points in the file's order; `shared`: of this process's share alone. Throws Error{input} when the file
  /// has not the points any more that were looked at.
  void for_each_block(const PointSink& sink, Progress& progress, bool shared = false) const;

  /// Metres a file unit.
  double scale(const scene::ScanConfig& config, Progress& progress) const;
  /// By the configuration, against or without the format's.
  [[nodiscard]] bool has_chosen_unit(const scene::ScanConfig& config) const;
  /// The farthest coordinate, outliers aside, file units.
  [[nodiscard]] double away() const;

 private:
  void take_pose_for_viewpoint(const scene::ScanConfig& config);
  void look_at_normals(const PointBlock& block);
  void look(const PointBlock& block, bool bounds);
  [[nodiscard]] PointSink without_empty_returns(const PointSink& sink) const;
  [[nodiscard]] PointSink share_of_points(const PointSink& sink) const;
};

}  // namespace sparsha::pipeline

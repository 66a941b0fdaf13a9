// A COPC file that stays open: its nodes, where they lie, and the points of those that somebody asks for.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/las/copc.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/placement.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

/// One thread at a time. Metres of the scan frame: unit and pose of the scan are applied.
class OctreeScan {
 public:
  struct Node {
    int level = 0;              ///< 0: the root; points of deeper levels come on top of those above them
    Eigen::Vector3d low, high;  ///< a box around its points, metres
    std::uint64_t points = 0;   ///< withheld ones too
    std::uint64_t bytes = 0;    ///< of the file
  };
  /// The points of a node relative to an origin.
  struct Points {
    std::vector<Eigen::Vector3f> places;  ///< metres
    std::vector<std::uint32_t> rgba;      ///< empty or one per point
    std::vector<float> intensity;         ///< empty or one per point
  };

  /// Null when the file is no COPC, its hierarchy is damaged, or its points alone tell the unit (`longest side`): then
  /// it is read as any scan. Throws Error{input}; Cancelled when `progress` is cancelled meanwhile.
  [[nodiscard]] static std::unique_ptr<OctreeScan> open(const scene::ScanConfig& scan, const Progress& progress);
  ~OctreeScan();
  OctreeScan(const OctreeScan&) = delete;
  OctreeScan& operator=(const OctreeScan&) = delete;

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }  ///< in the file's order
  [[nodiscard]] std::uint64_t points() const { return header_.points; }
  /// About how far apart the points of the levels down to this one are, metres.
  [[nodiscard]] double spacing_m(int level) const;
  /// The deepest level that ReadOptions::enough takes for so many points.
  [[nodiscard]] int level_of_points(std::uint64_t points) const { return octree_.level_of_points(points); }

  /// From now on read() leaves out points at 0 0 0 of the file, as ScanSet does where they are empty returns.
  void drop_empty_returns() { drop_empty_returns_ = true; }
  /// Throws Error{input} when the file became shorter since open(): then no node can be trusted any more.
  void require_whole() const { map_.require_whole(); }
  [[nodiscard]] const std::string& name() const { return file_.name; }  ///< of the file

  /// The points of some nodes, which are given in ascending order; reads no other bytes of the file's points. Throws
  /// Error{input}, Cancelled.
  [[nodiscard]] std::vector<Points> read(std::span<const std::size_t> nodes, const Eigen::Vector3d& origin_m,
                                         ThreadPool& pool);
  /// From any thread: read() throws Cancelled, now and from then on.
  void cancel() noexcept { stopped_.cancel(); }
  /// Of chunks, by open() and read().
  [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  explicit OctreeScan(const scene::ScanConfig& scan);
  void place_nodes(const scene::ScanConfig& scan);
  void look_at_colours();
  void add_records(std::string_view records, const Eigen::Vector3d& origin_m, Points& points) const;

  Progress stopped_;
  MappedFile map_;
  ScanFile file_;
  las::Header header_;
  las::Units units_;
  laz::Packing packing_;
  las::Octree octree_;
  Placement placement_;
  double metres_ = 1.0;  ///< in the file's unit
  std::vector<Node> nodes_;
  ColourRange colours_{false};
  std::uint64_t bytes_read_ = 0;
  bool drop_empty_returns_ = false;
};

}  // namespace sparsha::pipeline

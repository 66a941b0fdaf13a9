// The scans of a configuration, looked at once: everything but their points, which can be gone through again.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/fields.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/shared_reading.h"
#include "scene/config/filters.h"
#include "scene/config/scans.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Some consecutive points of a scan as a Cloud holds them: metres, rounded once from double relative to the set's
/// origin. Spans are good during the call only.
struct CloudBlock {
  std::span<const Eigen::Vector3f> points;
  std::span<const std::uint32_t> rgba;  ///< empty or one per point
  std::span<const float> intensity;     ///< empty or one per point
  /// Of each of ScanSet::fields(): empty or one per point.
  std::span<const std::span<const float>> fields{};
};

/// What is wanted of scans; formats that keep points in groups (COPC) leave the rest unread, others read all.
struct ScanPart {
  std::optional<scene::CropConfig> box{};  ///< points outside of it may be left out, too
  std::uint64_t enough = 0;                ///< points of a scan; 0: all
  bool whole_chunks_only = false;          ///< see ReadOptions
};

struct LookedScan;

class ScanSet {
 public:
  /// Where points wait between the first look and the second: `quickest` keeps those in memory that take long to
  /// decode, `disk` none.
  enum class Keep { quickest, disk };

  /// Reads every scan. Throws Error{input}, also when no scan has a point; warns of implausible units, and of a scan
  /// without a point beside others, which is left out. `digests`: the
  /// files' SHA-256 are taken meanwhile, for sources(). `fields`: what the points shall keep beside colour and
  /// intensity, as field_key() gives it. `mesh_refusal`: asked of all points and triangles of a mesh and the scans
  /// before it. `ranks`: the processes that read the set together, each its share (Keep::disk alone); all of them come
  /// to the same set, and all make the calls of this class that say so.
  ScanSet(const std::vector<scene::ScanConfig>& scans, Keep keep, bool digests, Progress& progress,
          const std::vector<std::string>& fields = {}, const MeshRefusal& mesh_refusal = {}, const ScanPart& part = {},
          ReadingRanks ranks = {});
  ~ScanSet();
  ScanSet(const ScanSet&) = delete;
  ScanSet& operator=(const ScanSet&) = delete;

  [[nodiscard]] std::uint64_t points() const { return points_; }    ///< finite ones, before rounding
  [[nodiscard]] std::uint64_t invalid() const { return invalid_; }  ///< the files' own, before rounding
  /// Points that are in the files beside those, and that nobody wants by ScanPart.
  [[nodiscard]] std::uint64_t unread() const { return unread_; }
  /// With Keep::disk: whether points at a scanner's place are left out as empty returns, see are_empty_returns().
  [[nodiscard]] bool drops_empty_returns() const;
  [[nodiscard]] std::uint64_t faces() const { return faces_; }
  [[nodiscard]] bool has_colour() const { return colour_; }
  [[nodiscard]] bool has_intensity() const { return intensity_; }
  [[nodiscard]] const std::vector<std::string>& fields() const { return fields_; }
  /// Of a scan, in the configuration's order: its fields as the file names them, and what is counted of those that tell
  /// a point's worth.
  [[nodiscard]] const std::vector<std::string>& fields_of(std::size_t scan) const;
  [[nodiscard]] const std::vector<FieldTally>& tallies_of(std::size_t scan) const;
  /// Throws Error{input} when no scan has one of fields(); the error names those that there are.
  void require_fields() const;
  /// By the custom of any of the formats, see is_z_up().
  [[nodiscard]] bool z_up() const { return z_up_; }
  /// Scans whose unit the configuration says and their format does not: how far the nearest of them lies from zero.
  [[nodiscard]] std::optional<double> nearest_of_chosen_unit_m() const { return nearest_of_chosen_unit_m_; }
  /// What is to be said of scans in several pieces, unless something takes pieces away.
  [[nodiscard]] const std::vector<std::string>& pieces() const { return pieces_; }
  /// The median of the points in whole metres: a function of the set of points alone.
  [[nodiscard]] const Eigen::Vector3d& origin_m() const { return origin_m_; }

  /// Some of the points, spread over all of them by a hash of their coordinates.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& sample_m() const { return sample_m_; }

  /// Throws Error{input} when the points of all scans together lie on a straight line or in one place.
  void require_surface() const;

  /// Where the scanners stood, for scans whose files or poses say so, and normals that files state.
  [[nodiscard]] std::vector<Station> stations() const;

  /// All points in one cloud, in the configuration's order. Points beyond float32 become invalid, and faces on them go.
  /// Gives back what Keep::quickest has kept, so that it comes last.
  [[nodiscard]] Cloud load(const Eigen::Vector3d& origin_m, Progress& progress);
  /// The same; `normals`: with those that the files state, turned by the scans' poses; zero for points that have none.
  [[nodiscard]] Cloud load(const Eigen::Vector3d& origin_m, Progress& progress, bool normals);

  /// The same points block by block, relative to origin_m(); returns how many are beyond float32. May be called again.
  /// Attributes are there when any of the scans has them. Of a set that is read by several processes these are the
  /// points of this one's share. Throws Cancelled.
  std::uint64_t stream(const std::function<void(const CloudBlock&)>& use, Progress& progress) const;

  /// Whether several processes read the set, and how they tell each other what they have found in their shares.
  [[nodiscard]] bool is_shared() const { return ranks_.size > 1; }
  [[nodiscard]] const ReadingRanks& ranks() const { return ranks_; }

  /// Waits for the digests; called by all processes.
  [[nodiscard]] std::vector<scene::ScanSource> sources();

 private:
  struct Told;
  void begin_digest(std::size_t scan);
  [[nodiscard]] std::vector<Told> look_together(bool digests, Progress& progress, const MeshRefusal& mesh_refusal,
                                                const ScanPart& part);
  [[nodiscard]] std::unique_ptr<LookedScan> take(Told&& told, std::size_t number, Progress& progress,
                                                 const MeshRefusal& mesh_refusal, const ScanPart& part) const;

  std::vector<scene::ScanConfig> configs_;
  std::vector<std::string> fields_;
  ReadingRanks ranks_;
  std::vector<std::unique_ptr<LookedScan>> scans_;
  std::vector<std::uint64_t> records_;
  std::shared_ptr<std::atomic<bool>> abandoned_;             ///< the digests look at it
  std::map<std::size_t, std::future<std::string>> digests_;  ///< of the scans whose digest this process takes
  std::uint64_t points_ = 0, invalid_ = 0, unread_ = 0;
  std::size_t faces_ = 0;
  std::vector<std::string> pieces_;
  std::vector<Eigen::Vector3d> sample_m_;
  std::optional<double> nearest_of_chosen_unit_m_;
  bool colour_ = false, intensity_ = false, normals_ = false, z_up_ = false;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::pipeline

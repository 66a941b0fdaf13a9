// One function a filter; what it found is put into words here.
#include "pipeline/filter/filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "base/numbers/statistics.h"
#include "base/text/text.h"
#include "pipeline/filter/clusters.h"
#include "pipeline/filter/mesh_pieces.h"
#include "pipeline/filter/neighbour_tree.h"
#include "pipeline/filter/outliers.h"
#include "pipeline/filter/plane.h"
#include "pipeline/filter/plane_doubt.h"
#include "pipeline/filter/point_test.h"
#include "pipeline/filter/smooth.h"
#include "pipeline/filter/thin.h"
#include "pipeline/filter/voxel.h"
#include "pipeline/scan/value_test.h"

namespace sparsha::pipeline {
namespace {

using Flags = std::vector<std::uint8_t>;

template <typename T>
void move_kept(std::vector<T>& values, std::size_t from, std::size_t to) {
  if (!values.empty()) values[to] = values[from];
}

template <typename T>
void cut(std::vector<T>& values, std::size_t kept) {
  if (!values.empty()) values.resize(kept);
}

bool keeps_all(const std::array<std::uint32_t, 3>& face, const Flags& keep) {
  return std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return keep[v] != 0; });
}

/// Corners of which every triangle loses another corner go too: they would be points beside the mesh.
void drop_stranded_corners(const Cloud& cloud, Flags& keep) {
  if (cloud.faces.empty()) return;
  Flags stranded(keep.size(), 0);
  for (const auto& face : cloud.faces) {
    for (const std::uint32_t v : face) stranded[v] = 1;
  }
  for (const auto& face : cloud.faces) {
    if (!keeps_all(face, keep)) continue;
    for (const std::uint32_t v : face) stranded[v] = 0;
  }
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (stranded[i] != 0) keep[i] = 0;
  }
}

/// Faces whose corners all stay, by the corners' new numbers.
void keep_faces(Cloud& cloud, const Flags& keep) {
  if (cloud.faces.empty()) return;
  std::vector<std::uint32_t> place(keep.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) place[i] = keep[i] != 0 ? next++ : 0;
  std::erase_if(cloud.faces, [&](const auto& face) { return !keeps_all(face, keep); });
  for (auto& face : cloud.faces) {
    for (std::uint32_t& v : face) v = place[v];
  }
}

/// Takes the points with keep[i] == 0 away, and faces with their corners. Returns how many points went.
std::uint64_t keep_only(Cloud& cloud, const Flags& keep) {
  float* const xyz = cloud.xyz1();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] == 0) continue;
    if (kept != i) {
      for (std::size_t k = 0; k < 3; ++k) xyz[4 * kept + k] = xyz[4 * i + k];
      move_kept(cloud.rgba, i, kept);
      move_kept(cloud.intensity, i, kept);
      move_kept(cloud.normals, i, kept);
      move_kept(cloud.measured, i, kept);
      for (PointField& field : cloud.fields) move_kept(field.values, i, kept);
    }
    ++kept;
  }
  const std::size_t gone = keep.size() - kept;
  if (gone == 0) return 0;
  keep_faces(cloud, keep);
  cloud.resize_points(kept);
  cut(cloud.rgba, kept);
  cut(cloud.intensity, kept);
  cut(cloud.normals, kept);
  cut(cloud.measured, kept);
  for (PointField& field : cloud.fields) cut(field.values, kept);
  return gone;
}

Eigen::Vector3f as_measured(const Cloud& cloud, std::size_t i) {
  return cloud.measured.empty() ? Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(cloud.xyz1() + 4 * i))
                                : cloud.measured[i];
}

/// Appends the points with keep[i] == 0 to `removed`.
void copy_removed(const Cloud& cloud, const Flags& keep, Cloud& removed) {
  std::size_t next = removed.size();
  removed.origin_m = cloud.origin_m;
  removed.resize_points(next + static_cast<std::size_t>(std::count(keep.begin(), keep.end(), std::uint8_t{0})));
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) continue;
    const Eigen::Vector3f p = as_measured(cloud, i);
    std::copy_n(p.data(), 3, removed.xyz1() + 4 * next);
    ++next;
  }
}

Flags kept_by(const Cloud& cloud, const PointTest& test, const Context& context) {
  constexpr std::size_t kPointsATime = std::size_t{1} << 16;
  Flags keep(cloud.size());
  const float* const xyz = cloud.xyz1();
  context.pool.for_ranges(keep.size(), kPointsATime, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      keep[i] = keeps(test, cloud.origin_m, Eigen::Map<const Eigen::Vector3f>(xyz + 4 * i)) ? 1 : 0;
    }
  });
  return keep;
}

/// Median distance of a point to its nearest neighbour. For messages.
double spacing_of(const Cloud& cloud, const Context& context) {
  if (cloud.size() < 2) return 0.0;
  std::vector<float> nearest = NeighbourTree(cloud.xyz1(), cloud.size(), context).mean_distances(1, context);
  return static_cast<double>(median(nearest));
}

/// Applies one filter after the other to a cloud.
class FilterRun {
 public:
  FilterRun(Cloud& cloud, const Context& context, const FilterNeeds& needs)
      : cloud_(cloud), context_(context), needs_(needs) {}

  FilterSteps run(const std::vector<scene::FilterConfig>& filters) {
    for (std::size_t k = 0; k < filters.size(); ++k) {
      done_ = static_cast<double>(k) / static_cast<double>(filters.size());
      each_ = 1.0 / static_cast<double>(filters.size());
      context_.progress.at(done_);
      result_.steps.emplace_back().name = scene::filter_name(filters[k]);
      at_key_of(filters[k], [&] {
        std::visit([&](const auto& filter) { apply(filter); }, filters[k]);
        if (cloud_.size() == 0) throw nothing_left(step().name, step().found);
      });
    }
    return std::move(result_);
  }

 private:
  FilterStep& step() { return result_.steps.back(); }

  void take_away(Flags keep) {
    const std::size_t faces = cloud_.faces.size();
    // Of points that stand for others, few are corners of one triangle.
    if (step().merges && std::find(keep.begin(), keep.end(), std::uint8_t{0}) != keep.end()) cloud_.faces.clear();
    drop_stranded_corners(cloud_, keep);
    if (!step().merges) {
      for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] == 0) step().sample.add(cloud_.origin_m + as_measured(cloud_, i).cast<double>());
      }
    }
    if (step().outliers && needs_.removed_outliers != nullptr) copy_removed(cloud_, keep, *needs_.removed_outliers);
    step().removed = keep_only(cloud_, keep);
    if (const std::size_t gone = faces - cloud_.faces.size(); gone > 0) {
      step().found += fmt::format("{}{} of {} triangles go with their corners", step().found.empty() ? "" : "; ",
                                  count_text(gone), count_text(faces));
    }
  }

  void apply(const scene::CropConfig& crop) { take_away(kept_by(cloud_, crop, context_)); }
  void apply(const scene::PassConfig& pass) { take_away(kept_by(cloud_, pass, context_)); }

  void apply(const scene::VoxelConfig& voxel) {
    step().merges = true;
    const std::size_t before = cloud_.size();
    thin_to_voxels(cloud_, voxel.leaf_m, context_.progress);
    step().removed = before - cloud_.size();
    cloud_.faces.clear();
  }

  void apply(const scene::OutlierConfig& outliers) {
    step().outliers = true;
    Flags keep = outliers.method == scene::OutlierConfig::Method::pcl
                     ? statistical_inliers_by_pcl(cloud_, outliers, context_.progress)
                     : statistical_inliers(cloud_, outliers, context_);
    keep_corners_of_large_pieces(keep);
    take_away(std::move(keep));
  }

  void apply(const scene::RadiusOutlierConfig& outliers) {
    step().outliers = true;
    Flags keep = outliers.method == scene::RadiusOutlierConfig::Method::pcl
                     ? radius_inliers_by_pcl(cloud_, outliers, context_.progress)
                     : radius_inliers(cloud_, outliers, context_);
    keep_corners_of_large_pieces(keep);
    const auto gone = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), std::uint8_t{0}));
    if (2 * gone > keep.size()) {
      const std::string most = fmt::format(
          "{} of the points have fewer than {} neighbours within {}; half of the points have "
          "their nearest one within {}",
          share_text(gone, keep.size()), outliers.neighbours, length_text(outliers.radius_m),
          length_text(spacing_of(cloud_, context_)));
      if (gone < keep.size()) {
        context_.progress.warn("the filter 'radius_outliers' takes most of the points away: " + most +
                               "; give a larger radius_mm or fewer neighbours");
      }
      step().found += (step().found.empty() ? "" : "; ") + most;
    }
    take_away(std::move(keep));
  }

  /// Corners of large triangles lie far apart and are no noise. What is left of the mesh to take away are specks; says
  /// so, and warns where these are much of it.
  void keep_corners_of_large_pieces(Flags& keep) {
    constexpr double kLargePiece = 0.01;  // of the area
    constexpr double kMuch = 0.05;
    if (cloud_.faces.empty() || share_of_area_lost(cloud_, keep) == 0.0) return;
    const Flags stays = corners_of_large_pieces(cloud_, kLargePiece);
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (keep[i] != 0 || stays[i] == 0) continue;
      keep[i] = 1;
      ++count;
    }
    if (count > 0) {
      step().found = fmt::format("{} corner{} of triangles far from others stay{}, as part of a large surface",
                                 count_text(count), count == 1 ? "" : "s", count == 1 ? "s" : "");
    }
    if (const double lost = share_of_area_lost(cloud_, keep); lost > kMuch) {
      context_.progress.warn(fmt::format(
          "the filter '{}' takes {:.0f} % of the meshes' area away: corners of triangles lie farther from each other "
          "than points of a scan do; leave it out where there is a mesh, and take specks away by 'keep' or 'crop'",
          step().name, 100.0 * lost));
    }
  }

  void apply(const scene::RemovePlaneConfig& config) {
    PlaneSample sample(config.distance_m);
    const float* const xyz = cloud_.xyz1();
    for (std::size_t i = 0; i < cloud_.size(); ++i) {
      if ((i & 0xFFFF) == 0) context_.progress.throw_if_cancelled();
      sample.add(Eigen::Map<const Eigen::Vector3f>(xyz + 4 * i));
    }
    const FoundPlane plane = find_plane(sample, config, context_);
    step().found = to_string(plane);
    step().of_object = plane.of_object;
    const std::uint64_t before = cloud_.size();
    for (std::size_t i = 0; i < cloud_.size(); ++i) {
      const double height = height_m(plane.cut, Eigen::Map<const Eigen::Vector3f>(xyz + 4 * i));
      if (std::abs(height) <= plane.cut.distance_m) ++step().in_plane;
    }
    take_away(kept_by(cloud_, plane.cut, context_));
    warn_of_plane(step(), before, context_.progress);
  }

  void apply(const scene::KeepConfig& config) {
    const KeptCluster kept = choose_cluster(cloud_, config, context_);
    const std::uint64_t before = cloud_.size();
    step().found = fmt::format("{} cluster{}; the one kept has {} points", count_text(kept.clusters),
                               kept.clusters == 1 ? "" : "s", count_text(kept.points));
    if (kept.next > 0) step().found += fmt::format(", the largest other one {}", count_text(kept.next));
    if (config.nearest_to_m) step().found += fmt::format("; it is {} from nearest_to", length_text(kept.away_m));
    require_cluster(config, kept);
    take_away(kept.keep);
    if (config.nearest_to_m && kept.away_m > config.tolerance_m) {
      context_.progress.warn(
          fmt::format("the cluster that 'keep' keeps lies {} from nearest_to, farther than "
                      "tolerance_mm; nearest_to is a place of the scan frame, metres",
                      length_text(kept.away_m)));
    }
    if (!config.nearest_to_m && 2 * kept.next > kept.points) {
      context_.progress.warn(fmt::format(
          "the filter 'keep' keeps a cluster of {} points and takes one of {} away ({} points in all): if that belongs "
          "to the object too, give a larger tolerance_mm",
          count_text(kept.points), count_text(kept.next), count_text(before)));
    }
  }

  /// Throws when what would be kept cannot be meant.
  void require_cluster(const scene::KeepConfig& config, const KeptCluster& kept) {
    const auto refuse = [&](const std::string& wrong, const std::string& expected) {
      throw Error(ErrorKind::input, {}, "the filter 'keep' finds no cluster: " + wrong, expected);
    };
    if (2 * kept.alone > cloud_.size()) {
      refuse(fmt::format("{} of the points have none or one other within {}; half of the points have their nearest one "
                         "within {}",
                         share_text(kept.alone, cloud_.size()), length_text(config.tolerance_m),
                         length_text(spacing_of(cloud_, context_))),
             "a larger tolerance_mm: a few times the points' distance");
    }
    const double size = diagonal();
    if (config.nearest_to_m && kept.away_m > size) {
      refuse(fmt::format("the nearest one lies {} from nearest_to, and all points together are {} large",
                         length_text(kept.away_m), length_text(size)),
             "a place on or near the object, scan frame, metres");
    }
  }

  [[nodiscard]] double diagonal() const {
    Eigen::Vector3f low = Eigen::Map<const Eigen::Vector3f>(cloud_.xyz1());
    Eigen::Vector3f high = low;
    for (std::size_t i = 0; i < cloud_.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3f> p(cloud_.xyz1() + 4 * i);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    return (high - low).cast<double>().norm();
  }

  void apply(const scene::SmoothConfig& config) {
    const Smoothing smoothing =
        smooth_points(cloud_, config, context_, [&](double share) { context_.progress.at(done_ + each_ * share); });
    const std::uint64_t all = cloud_.size();
    if (smoothing.unmoved == all) {
      throw Error(ErrorKind::input, {},
                  fmt::format("the filter 'smooth' moves nothing: no point has two neighbours within {} and a surface "
                              "through them; half of the points have their nearest one within {}",
                              length_text(config.radius_m), length_text(spacing_of(cloud_, context_))),
                  "a larger radius_mm: three times the points' distance or more");
    }
    result_.moved_rms_m = std::hypot(result_.moved_rms_m, smoothing.rms_m);
    step().found =
        fmt::format("points moved by {} RMS, at most {}", length_text(smoothing.rms_m), length_text(smoothing.most_m));
    if (smoothing.unmoved > 0) step().found += fmt::format("; {} not moved", count_text(smoothing.unmoved));
    constexpr std::uint64_t kFew = 100;
    if (smoothing.unmoved > all / kFew) {
      context_.progress.warn(fmt::format(
          "the filter 'smooth' leaves {} of the points where they are, since fewer than three points lie within {}: "
          "half of the points have their nearest one within {}; give a larger radius_mm",
          share_text(smoothing.unmoved, all), length_text(config.radius_m), length_text(spacing_of(cloud_, context_))));
    }
  }

  void apply(const scene::ThinConfig& config) {
    step().merges = true;
    const double spacing = needs_.spacing_m ? needs_.spacing_m(cloud_) : spacing_of(cloud_, context_);
    if (!(spacing > 0.0)) throw nothing_left("thin", "all points are in one place");
    take_away(thinned(cloud_, spacing, config.points_per_node, context_));
    step().found = fmt::format("at most {} point{} in a cube of {}", config.points_per_node,
                               config.points_per_node == 1 ? "" : "s", length_text(spacing));
  }

  void apply(const scene::FieldConfig& field) { take_away_by(field); }
  void apply(const scene::ClassesConfig& classes) { take_away_by(classes); }

  template <typename Test>
  void take_away_by(const Test& test) {
    const std::vector<float>& values = field_values(field_of(test));
    Flags keep(cloud_.size());
    std::uint64_t unknown = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      keep[i] = keeps(test, values[i]) ? 1 : 0;
      unknown += std::isnan(values[i]) ? 1 : 0;
    }
    step().found = unknown_text(unknown);
    take_away(keep);
  }

  [[nodiscard]] const std::vector<float>& field_values(const std::string& name) const {
    if (name == kIntensityField && !cloud_.intensity.empty()) return cloud_.intensity;
    for (const PointField& field : cloud_.fields) {
      if (field.name == name) return field.values;
    }
    throw Error(ErrorKind::input, {}, "no scan has the field '" + name + "'",
                "a field of the scans, as `sparsha info` lists them");
  }

  Cloud& cloud_;
  const Context& context_;
  const FilterNeeds& needs_;
  FilterSteps result_;
  double done_ = 0.0;  ///< share of the stage before the present filter
  double each_ = 1.0;  ///< share of a filter
};

std::uint64_t sum_of(const std::vector<FilterStep>& steps, bool outliers) {
  return std::accumulate(steps.begin(), steps.end(), std::uint64_t{0}, [&](std::uint64_t sum, const FilterStep& step) {
    return step.outliers == outliers ? sum + step.removed : sum;
  });
}

}  // namespace

std::uint64_t FilterSteps::filtered() const { return sum_of(steps, false); }
std::uint64_t FilterSteps::outliers() const { return sum_of(steps, true); }

PointSample sample_of_kept(const Cloud& cloud) {
  PointSample sample(FilterSteps::kSample);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    sample.add(cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(cloud.xyz1() + 4 * i).cast<double>());
  }
  return sample;
}

Error nothing_left(const std::string& filter, const std::string& found) {
  return {ErrorKind::input,
          {},
          "nothing is left after the filter '" + filter + "'" + (found.empty() ? "" : ": " + found),
          "a filter that keeps some points"};
}

std::string field_of(const scene::FilterConfig& filter) {
  if (const auto* field = std::get_if<scene::FieldConfig>(&filter)) return field_of(*field);
  if (const auto* classes = std::get_if<scene::ClassesConfig>(&filter)) return field_of(*classes);
  return {};
}

std::vector<std::string> fields_of(const std::vector<scene::FilterConfig>& filters) {
  std::vector<std::string> fields;
  for (const scene::FilterConfig& filter : filters) {
    const std::string field = field_of(filter);
    if (field.empty() || field == kIntensityField) continue;
    if (std::find(fields.begin(), fields.end(), field) == fields.end()) fields.push_back(field);
  }
  return fields;
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{:.1f} %",
                     100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(1, whole)));
}

std::string unknown_text(std::uint64_t points) {
  if (points == 0) return {};
  return fmt::format("{} point{} without a value stay{}", count_text(points), points == 1 ? "" : "s",
                     points == 1 ? "s" : "");
}

FilterSteps apply_filters(Cloud& cloud, const std::vector<scene::FilterConfig>& filters, const Context& context,
                          const FilterNeeds& needs) {
  return FilterRun(cloud, context, needs).run(filters);
}

}  // namespace sparsha::pipeline

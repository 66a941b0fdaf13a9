// The filters beside PCL's own on the same cloud: time, and how far the results agree.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>

#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include "pipeline/filter/filter.h"
#include "points.h"
#include "run.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

using pipeline::Cloud;
using pipeline::FilterConfig;

/// A relief of 1 m with 0.2 mm of noise and 0.5 % of strays, and a second group of points beside it.
Cloud scanned(std::size_t count) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  test::Points points;
  for (std::size_t i = 0; i < count; ++i) {
    double noise = -6.0;  // of twelve uniform numbers: nearly Gaussian
    for (int k = 0; k < 12; ++k) noise += uniform();
    const bool beside = i % 4 == 0;
    const double x = beside ? 1.1 + 0.3 * uniform() : uniform();
    const double y = uniform();
    double z = 0.03 * std::sin(19.0 * x) * std::cos(23.0 * y) + 0.0002 * noise;
    if (uniform() < 0.005) z += uniform() - 0.5;
    points.push_back({x, y, z});
  }
  return test::make_cloud(points);
}

Cloud copy_of(const Cloud& cloud) {
  Cloud copy = cloud;
  copy.points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(*cloud.points);
  return copy;
}

template <typename Work>
double seconds_of(const Work& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

struct Timed {
  double seconds = 1e300;
  Cloud cloud;
};
Timed timed(const Cloud& original, const FilterConfig& filter, unsigned threads, int times) {
  Timed best;
  for (int k = 0; k < times; ++k) {
    Cloud cloud = copy_of(original);
    ThreadPool pool(threads);
    Progress progress;
    best.seconds = std::min(best.seconds, seconds_of([&] {
                              (void)pipeline::apply_filters(cloud, {filter}, {pool, progress});
                            }));
    best.cloud = std::move(cloud);
  }
  return best;
}

Timed voxels_by_pcl(const Cloud& original, double leaf_m, int times) {
  Timed best;
  for (int k = 0; k < times; ++k) {
    pcl::VoxelGrid<pcl::PointXYZ> filter;
    const auto leaf = static_cast<float>(leaf_m);
    filter.setLeafSize(leaf, leaf, leaf);
    filter.setInputCloud(original.points);
    best.seconds = std::min(best.seconds, seconds_of([&] { filter.filter(*best.cloud.points); }));
  }
  return best;
}

/// How far the points of one cloud are from the nearest of the other, micrometres: at most, and the share within one.
struct Apart {
  double most_um = 0.0;
  double within_one_percent = 0.0;
};
Apart apart(const Cloud& a, const Cloud& b) {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(b.points);
  pcl::Indices found(1);
  std::vector<float> squares(1);
  Apart result;
  for (const pcl::PointXYZ& p : *a.points) {
    tree.nearestKSearch(p, 1, found, squares);
    const double away_um = 1e6 * std::sqrt(static_cast<double>(squares[0]));
    result.most_um = std::max(result.most_um, away_um);
    result.within_one_percent += away_um <= 1.0 ? 100.0 : 0.0;
  }
  result.within_one_percent /= static_cast<double>(a.size());
  return result;
}

class Rows {
 public:
  explicit Rows(const std::filesystem::path& file) : csv_(file) {
    csv_ << "filter,points,own_1_s,own_2_s,pcl_s,agreement\n";
    fmt::print(
        "\n## Filters beside PCL's\n\n| filter | ours, 1 thread, ms | 2 threads | PCL's, ms | results |\n"
        "| --- | --- | --- | --- | --- |\n");
  }
  void add(const std::string& filter, std::size_t points, double one_s, double two_s, double pcl_s,
           const std::string& agreement) {
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {} |\n", filter, 1e3 * one_s, 1e3 * two_s, 1e3 * pcl_s, agreement);
    std::fflush(stdout);
    csv_ << fmt::format("\"{}\",{},{},{},{},\"{}\"\n", filter, points, one_s, two_s, pcl_s, agreement);
  }

 private:
  std::ofstream csv_;
};

}  // namespace

void run_filters(const RunOptions& options) {
  using pipeline::KeepConfig;
  using pipeline::OutlierConfig;
  using pipeline::RadiusOutlierConfig;
  using pipeline::SmoothConfig;
  const int times = options.every ? 3 : 1;
  const Cloud cloud = scanned(options.quick ? 200'000 : options.every ? 1'000'000 : 400'000);
  const double spacing_m = 1.14 / std::sqrt(static_cast<double>(cloud.size()));
  Rows rows(options.out / "pipeline_filters.csv");
  const auto compare = [&](const std::string& name, const FilterConfig& own, const FilterConfig& pcls) {
    const Timed one = timed(cloud, own, 1, times);
    const Timed two = timed(cloud, own, 2, times);
    const Timed theirs = timed(cloud, pcls, 1, times);
    const bool moves = std::holds_alternative<SmoothConfig>(own);
    rows.add(name, cloud.size(), one.seconds, two.seconds, theirs.seconds,
             moves ? fmt::format("at most {:.2g} um apart", apart(one.cloud, theirs.cloud).most_um)
                   : fmt::format("{:.4f} % decided alike", agreement_percent(cloud, one.cloud, theirs.cloud)));
  };
  compare("`outliers`, 8 neighbours, 2 sigma", OutlierConfig{8, 2.0, OutlierConfig::Method::fast},
          OutlierConfig{8, 2.0, OutlierConfig::Method::pcl});
  const double radius_m = 4.0 * spacing_m;
  compare("`radius_outliers`, 4 within 4 spacings", RadiusOutlierConfig{radius_m, 4, RadiusOutlierConfig::Method::fast},
          RadiusOutlierConfig{radius_m, 4, RadiusOutlierConfig::Method::pcl});
  compare("`keep`, 4 spacings", KeepConfig{{}, radius_m, KeepConfig::Method::fast},
          KeepConfig{{}, radius_m, KeepConfig::Method::pcl});
  compare("`smooth`, 4 spacings, order 2", SmoothConfig{radius_m, 2, SmoothConfig::Method::fast},
          SmoothConfig{radius_m, 2, SmoothConfig::Method::pcl});
  const pipeline::VoxelConfig voxel{4.0 * spacing_m};
  const Timed one = timed(cloud, voxel, 1, times);
  const Timed two = timed(cloud, voxel, 2, times);
  const Timed theirs = voxels_by_pcl(cloud, voxel.leaf_m, times);
  rows.add("`voxel`, 4 spacings", cloud.size(), one.seconds, two.seconds, theirs.seconds,
           fmt::format("{} and {} points, {:.4f} % within 1 um", one.cloud.size(), theirs.cloud.size(),
                       apart(one.cloud, theirs.cloud).within_one_percent));
}

}  // namespace sparsha::bench

// The filters beside PCL's own on the same cloud: time, and how far the results agree.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include "bench/pipeline/points.h"
#include "bench/pipeline/run.h"
#include "bench/report/turns.h"
#include "pipeline/filter/filter.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

using pipeline::Cloud;
using scene::FilterConfig;

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

/// One way to filter: leaves its result and returns the seconds that the filter alone took.
struct Way {
  std::string method;
  unsigned threads = 1;
  std::function<double(Cloud& result)> run;
};

Way by_filter(std::string method, const Cloud& original, const FilterConfig& filter, unsigned threads) {
  return {std::move(method), threads, [&original, filter, threads](Cloud& result) {
            result = copy_of(original);
            ThreadPool pool(threads);
            Progress progress;
            return seconds_of([&] { (void)pipeline::apply_filters(result, {filter}, {pool, progress}); });
          }};
}

Way voxels_by_pcl(const Cloud& original, double leaf_m) {
  return {"PCL", 1, [&original, leaf = static_cast<float>(leaf_m)](Cloud& result) {
            pcl::VoxelGrid<pcl::PointXYZ> filter;
            filter.setLeafSize(leaf, leaf, leaf);
            filter.setInputCloud(original.points);
            result = Cloud{};
            return seconds_of([&] { filter.filter(*result.points); });
          }};
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

/// Ours on one thread and on two and PCL's take turns; the agreement is that of ours on one thread with PCL's.
class Comparison {
 public:
  Comparison(const std::filesystem::path& file, const Cloud& cloud) : csv_(file), cloud_(cloud) {
    csv_ << "filter,method,threads,points,rounds,median_s,longest_s,ratio,ratio_low,ratio_high,agreement\n";
    fmt::print(
        "\n## Filters beside PCL's, {} rounds\n\n| filter | method | threads | median, ms | longest, ms | time over "
        "ours on one thread | results |\n| --- | --- | --- | --- | --- | --- | --- |\n",
        kRounds);
  }
  using Agreement = std::function<std::string(const Cloud& ours, const Cloud& theirs)>;
  void add(const std::string& filter, const FilterConfig& own, const Way& theirs, const Agreement& agreement) {
    const std::vector<Way> ways{by_filter("sparsha", cloud_, own, 1), by_filter("sparsha", cloud_, own, 2), theirs};
    std::vector<Cloud> results(ways.size());
    std::vector<Turn> turns;
    for (std::size_t n = 0; n < ways.size(); ++n)
      turns.push_back({[&run = ways[n].run, &result = results[n]] { return run(result); }});
    const std::vector<TurnTimes> taken = take_turns(turns, kRounds);
    for (std::size_t n = 0; n < ways.size(); ++n)
      row(filter, ways[n], taken[n], n + 1 == ways.size() ? agreement(results.front(), results.back()) : "");
  }

 private:
  static constexpr int kRounds = 5;

  void row(const std::string& filter, const Way& way, const TurnTimes& t, const std::string& agreement) {
    fmt::print("| {} | {} | {} | {:.0f} | {:.0f} | {:.3g} ({:.3g} to {:.3g}) | {} |\n", filter, way.method, way.threads,
               1e3 * t.median(), 1e3 * t.longest(), t.ratio, t.ratio_low, t.ratio_high, agreement);
    std::fflush(stdout);
    csv_ << fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},\"{}\"\n", filter, way.method, way.threads, cloud_.size(),
                        t.times.size(), t.median(), t.longest(), t.ratio, t.ratio_low, t.ratio_high, agreement);
  }

  std::ofstream csv_;
  const Cloud& cloud_;
};

}  // namespace

void run_filters(const RunOptions& options) {
  using scene::KeepConfig;
  using scene::OutlierConfig;
  using scene::RadiusOutlierConfig;
  using scene::SmoothConfig;
  // Small enough for five rounds in the time that a mode has.
  const Cloud cloud = scanned(options.quick ? 60'000 : options.every ? 1'000'000 : 150'000);
  const double spacing_m = 1.14 / std::sqrt(static_cast<double>(cloud.size()));
  Comparison table(options.out / "pipeline_filters.csv", cloud);
  const auto compare = [&](const std::string& name, const FilterConfig& own, const FilterConfig& pcls) {
    const bool moves = std::holds_alternative<SmoothConfig>(own);
    table.add(name, own, by_filter("PCL", cloud, pcls, 1), [&](const Cloud& ours, const Cloud& theirs) {
      return moves ? fmt::format("at most {:.2g} um apart", apart(ours, theirs).most_um)
                   : fmt::format("{:.4f} % decided alike", agreement_percent(cloud, ours, theirs));
    });
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
  const scene::VoxelConfig voxel{4.0 * spacing_m};
  table.add("`voxel`, 4 spacings", voxel, voxels_by_pcl(cloud, voxel.leaf_m),
            [](const Cloud& ours, const Cloud& theirs) {
              return fmt::format("{} and {} points, {:.4f} % within 1 um", ours.size(), theirs.size(),
                                 apart(ours, theirs).within_one_percent);
            });
}

}  // namespace sparsha::bench

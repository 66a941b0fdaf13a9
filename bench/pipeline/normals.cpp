// Normals of closed objects: tangent discs, which the projection draws anyway, beside pcl::NormalEstimationOMP. Both
// through 14 neighbours, judged against the true normals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <pcl/point_types.h>
#include <pcl/kdtree/impl/kdtree_flann.hpp>

#include "base/numbers/statistics.h"
#include "bench/pipeline/disc_list.h"
#include "bench/pipeline/pcl_normals.h"
#include "bench/pipeline/run.h"
#include "bench/report/turns.h"
#include "pipeline/projection/tangent_discs.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

using test::ObjectScan;

constexpr double kSteep = 0.2;  // z of true normals below which discs are not asked for

struct Figures {
  double median_deg = 0.0, p95_deg = 0.0;
};

/// A way to find normals: `run` returns the seconds that it took, `figures` judges what the last run found.
struct Way {
  const char* method;
  std::function<double()> run;
  std::function<Figures()> figures;
};

/// Of the angles between unsigned normals, of points whose true normal is not steep.
Figures judged(std::vector<double> degrees) {
  if (degrees.empty()) return {};
  return {quantile(degrees, 0.5), quantile(degrees, 0.95)};
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.normalized().dot(b)))) * 180.0 / std::numbers::pi;
}

Figures judge_normals(const ObjectScan& scan, const std::vector<Eigen::Vector3f>& normals) {
  std::vector<double> degrees;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    if (std::abs(scan.normals[k].z()) < kSteep) continue;
    const Eigen::Vector3d normal = normals[k].cast<double>();
    if (normal.allFinite()) degrees.push_back(angle_deg(normal, scan.normals[k]));
  }
  return judged(std::move(degrees));
}

Way by_pcl(const ObjectScan& scan, const pipeline::Cloud& cloud, unsigned threads) {
  const auto normals = std::make_shared<std::vector<Eigen::Vector3f>>();
  return {"pcl::NormalEstimationOMP",
          [&cloud, threads, normals] { return seconds_of([&] { *normals = by_pcl_normals(cloud, 14, threads); }); },
          [&scan, normals] { return judge_normals(scan, *normals); }};
}

pipeline::BinLattice columns_of(const pipeline::OrientedPoints& points, const pipeline::DiscRule& rule) {
  const Eigen::Array2f extent = points.max_m.head<2>() - points.min_m.head<2>();
  const pipeline::BinLattice nodes{static_cast<int>(extent.x() / rule.spacing_m) + 2,
                                   static_cast<int>(extent.y() / rule.spacing_m) + 2, rule.spacing_m,
                                   static_cast<double>(points.min_m.x()), static_cast<double>(points.min_m.y())};
  return pipeline::disc_columns(nodes, rule);
}

Figures judge_discs(const ObjectScan& scan, const pipeline::Cloud& cloud, const pipeline::TangentDiscs& discs) {
  // A disc's foot lies beside its point.
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud.points);
  pcl::Indices near(1);
  std::vector<float> squares(1);
  std::vector<double> degrees;
  for (const std::size_t d : disc_indices(discs)) {
    tree.nearestKSearch({discs.x[d], discs.y[d], discs.height(d)}, 1, near, squares);
    const Eigen::Vector3d& truth = scan.normals[static_cast<std::size_t>(near[0])];
    if (std::abs(truth.z()) < kSteep) continue;
    const Eigen::Vector3d normal(-static_cast<double>(discs.slope_x[d]), -static_cast<double>(discs.slope_y[d]), 1.0);
    degrees.push_back(angle_deg(normal, truth));
  }
  return judged(std::move(degrees));
}

Way by_discs(const ObjectScan& scan, const pipeline::Cloud& cloud, unsigned threads) {
  struct Work {
    ThreadPool pool;
    pipeline::OrientedPoints points;
    pipeline::DiscRule rule;
    pipeline::BinLattice columns;
    pipeline::TangentDiscs discs;
    explicit Work(unsigned count) : pool(count) {}
  };
  const auto work = std::make_shared<Work>(threads);
  work->points = pipeline::orient_points(pipeline::raw_points(cloud), cloud.origin_m, Eigen::Matrix4d::Identity(),
                                         cloud.origin_m, work->pool);
  work->rule.spacing_m = scan.spacing_m;
  work->columns = columns_of(work->points, work->rule);
  return {"tangent discs",
          [work] {
            return seconds_of([&] {
              work->discs = pipeline::find_discs(work->points, {}, work->columns,
                                                 pipeline::BinWindow::all(work->columns), work->rule, true, work->pool);
            });
          },
          [work, &scan, &cloud] { return judge_discs(scan, cloud, work->discs); }};
}

class Rows {
 public:
  explicit Rows(const std::filesystem::path& file) : csv_(file) {
    csv_ << "object,points,noise_spacings,method,threads,rounds,median_s,longest_s,ratio,ratio_low,ratio_high,"
            "median_deg,p95_deg\n";
    fmt::print(
        "\n## Normals through 14 neighbours, {} rounds\n\n| object, points, noise in spacings | method | threads | "
        "median, s | longest, s | time over ours | median error | 95 % |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        kRounds);
  }
  /// Discs and PCL's normals take turns on one scan.
  void add(const std::string& object, double noise, const ObjectScan& scan, unsigned threads) {
    const pipeline::Cloud cloud = test::make_cloud(scan.points);
    std::vector<Way> ways{by_discs(scan, cloud, threads)};
    if (threads == 1 || pcl_normals_have_threads()) ways.push_back(by_pcl(scan, cloud, threads));
    std::vector<Turn> turns;
    for (const Way& way : ways) turns.push_back({way.run});
    const std::vector<TurnTimes> taken = take_turns(turns, kRounds);
    for (std::size_t n = 0; n < ways.size(); ++n) {
      const TurnTimes& t = taken[n];
      const Figures f = ways[n].figures();
      fmt::print(
          "| {}, {}, {} | {} | {} | {:.3f} | {:.3f} | {:.3g} ({:.3g} to {:.3g}) | {:.2f}\u00B0 | {:.1f}\u00B0 |\n",
          object, cloud.size(), noise, ways[n].method, threads, t.median(), t.longest(), t.ratio, t.ratio_low,
          t.ratio_high, f.median_deg, f.p95_deg);
      csv_ << fmt::format("{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", object, cloud.size(),
                          noise, ways[n].method, threads, t.times.size(), t.median(), t.longest(), t.ratio, t.ratio_low,
                          t.ratio_high, f.median_deg, f.p95_deg);
    }
  }

 private:
  static constexpr int kRounds = 5;
  std::ofstream csv_;
};

}  // namespace

void run_normals(const RunOptions& options) {
  Rows rows(options.out / "pipeline_normals.csv");
  for (const test::NamedObject& named : test::analytic_objects()) {
    if (!options.scenes.empty() && named.name.find(options.scenes) == std::string::npos) continue;
    for (const double noise : {0.1, 0.3}) {
      test::ScanOptions how;
      how.points = options.every ? 1'000'000 : 100'000;
      how.noise_spacings = noise;
      const ObjectScan scan = test::scan_object(*named.object, how);
      for (const unsigned threads : {1U, 2U}) rows.add(named.name, noise, scan, threads);
    }
  }
}

}  // namespace sparsha::bench

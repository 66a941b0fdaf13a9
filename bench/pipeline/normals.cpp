// Normals of closed objects: tangent discs, which the projection draws anyway, beside pcl::NormalEstimationOMP. Both
// through 14 neighbours, judged against the true normals.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>

#include <pcl/point_types.h>
#include <pcl/features/impl/normal_3d.hpp>
#include <pcl/features/impl/normal_3d_omp.hpp>
#include <pcl/kdtree/impl/kdtree_flann.hpp>
#include <pcl/search/impl/kdtree.hpp>

#include "pipeline/projection/tangent_discs.h"
#include "run.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

using test::ObjectScan;

constexpr double kSteep = 0.2;  // z of true normals below which discs are not asked for

struct Figures {
  double seconds = 0.0;
  double median_deg = 0.0, p95_deg = 0.0;
};

double seconds_since(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Of the angles between unsigned normals, of points whose true normal is not steep.
Figures judged(std::vector<double> degrees, double seconds) {
  std::sort(degrees.begin(), degrees.end());
  const auto rank = [&](double share) {
    return degrees.empty() ? 0.0 : degrees[static_cast<std::size_t>(share * static_cast<double>(degrees.size() - 1))];
  };
  return {seconds, rank(0.5), rank(0.95)};
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.normalized().dot(b)))) * 180.0 / std::numbers::pi;
}

Figures by_pcl(const ObjectScan& scan, const pipeline::Cloud& cloud, unsigned threads) {
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(threads);
  estimation.setInputCloud(cloud.points);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(14);
  pcl::PointCloud<pcl::Normal> normals;
  const auto began = std::chrono::steady_clock::now();
  estimation.compute(normals);
  const double seconds = seconds_since(began);
  std::vector<double> degrees;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    if (std::abs(scan.normals[k].z()) < kSteep) continue;
    const Eigen::Vector3d normal = normals[k].getNormalVector3fMap().cast<double>();
    if (normal.allFinite()) degrees.push_back(angle_deg(normal, scan.normals[k]));
  }
  return judged(std::move(degrees), seconds);
}

Figures by_discs(const ObjectScan& scan, const pipeline::Cloud& cloud, unsigned threads) {
  ThreadPool pool(threads);
  const pipeline::OrientedPoints points = pipeline::orient_points(pipeline::raw_points(cloud), cloud.origin_m,
                                                                  Eigen::Matrix4d::Identity(), cloud.origin_m, pool);
  pipeline::DiscRule rule;
  rule.spacing_m = scan.spacing_m;
  const Eigen::Array2f extent = points.max_m.head<2>() - points.min_m.head<2>();
  const pipeline::BinLattice nodes{static_cast<int>(extent.x() / scan.spacing_m) + 2,
                                   static_cast<int>(extent.y() / scan.spacing_m) + 2, scan.spacing_m,
                                   static_cast<double>(points.min_m.x()), static_cast<double>(points.min_m.y())};
  const pipeline::BinLattice columns = pipeline::disc_columns(nodes, rule);
  const auto began = std::chrono::steady_clock::now();
  const pipeline::TangentDiscs discs =
      pipeline::find_discs(points, {}, columns, pipeline::BinWindow::all(columns), rule, true, pool);
  const double seconds = seconds_since(began);

  // A disc's foot lies beside its point.
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud.points);
  pcl::Indices near(1);
  std::vector<float> squares(1);
  std::vector<double> degrees;
  const std::size_t count =
      discs.start[static_cast<std::size_t>(columns.bins_y()) * static_cast<std::size_t>(columns.bins_x() + 1) - 1];
  for (std::size_t d = 0; d < count; ++d) {
    if (!(discs.radius2[d] > 0.0F)) continue;
    tree.nearestKSearch({discs.x[d], discs.y[d], discs.height(d)}, 1, near, squares);
    const Eigen::Vector3d& truth = scan.normals[static_cast<std::size_t>(near[0])];
    if (std::abs(truth.z()) < kSteep) continue;
    const Eigen::Vector3d normal(-static_cast<double>(discs.slope_x[d]), -static_cast<double>(discs.slope_y[d]), 1.0);
    degrees.push_back(angle_deg(normal, truth));
  }
  return judged(std::move(degrees), seconds);
}

}  // namespace

void run_normals(const RunOptions& options) {
  std::ofstream csv(options.out / "pipeline_normals.csv");
  csv << "object,points,noise_spacings,method,threads,seconds,median_deg,p95_deg\n";
  fmt::print(
      "\n## Normals through 14 neighbours\n\n| object, points, noise in spacings | method | threads | s | median "
      "error | 95 % |\n| --- | --- | --- | --- | --- | --- |\n");
  for (const test::NamedObject& named : test::analytic_objects()) {
    if (!options.scenes.empty() && named.name.find(options.scenes) == std::string::npos) continue;
    for (const double noise : {0.1, 0.3}) {
      test::ScanOptions how;
      how.points = options.every ? 1'000'000 : 100'000;
      how.noise_spacings = noise;
      const ObjectScan scan = test::scan_object(*named.object, how);
      const pipeline::Cloud cloud = test::make_cloud(scan.points);
      for (const unsigned threads : {1U, 2U}) {
        for (const bool discs : {true, false}) {
          const Figures f = discs ? by_discs(scan, cloud, threads) : by_pcl(scan, cloud, threads);
          const char* method = discs ? "tangent discs" : "pcl::NormalEstimationOMP";
          fmt::print("| {}, {}, {} | {} | {} | {:.2f} | {:.2f}\u00B0 | {:.1f}\u00B0 |\n", named.name, how.points, noise,
                     method, threads, f.seconds, f.median_deg, f.p95_deg);
          csv << fmt::format("{},{},{},{},{},{:.4f},{:.4f},{:.4f}\n", named.name, how.points, noise, method, threads,
                             f.seconds, f.median_deg, f.p95_deg);
        }
      }
    }
  }
}

}  // namespace sparsha::bench

// Registration beside what PCL's users write: IterativeClosestPoint, one scan after the other onto those before it.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>

#include <pcl/common/transforms.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

#include "bench/pipeline/run.h"
#include "bench/report/turns.h"
#include "pipeline/register/posed_scan.h"
#include "scene/config/config.h"
#include "tests/support/stations.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using pipeline::PosedScan;
using scene::ScanConfig;
using Poses = std::vector<Eigen::Matrix4d>;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

PclCloud posed(const PosedScan& scan) {
  PclCloud cloud;
  for (const pipeline::StationSurface::Element& element : scan.medium->elements()) {
    const Eigen::Vector3f p = (scan.pose * element.point).cast<float>();
    cloud.emplace_back(p.x(), p.y(), p.z());
  }
  return cloud;
}

Eigen::Matrix4f icp(const PclCloud& source, const PclCloud& target, const Eigen::Matrix4f& guess, double within_m) {
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> alignment;
  alignment.setInputSource(source.makeShared());
  alignment.setInputTarget(target.makeShared());
  alignment.setMaxCorrespondenceDistance(within_m);
  alignment.setMaximumIterations(100);
  alignment.setTransformationEpsilon(1e-12);
  PclCloud aligned;
  alignment.align(aligned, guess);
  return alignment.getFinalTransformation();
}

/// The thinned points of read_posed_scans(), first within 5 % of the longest side (of 5, 10 and 15 % what leaves
/// the least error), then within three spacings.
Poses by_plain_icp(const std::vector<ScanConfig>& rough) {
  Progress progress;
  ThreadPool pool(2);
  const pipeline::PosedScans scans = pipeline::read_posed_scans(rough, 0.0, true, {pool, progress});
  PclCloud target = posed(scans.scans.front());
  Poses poses{rough.front().pose};
  for (std::size_t s = 1; s < rough.size(); ++s) {
    const PclCloud source = posed(scans.scans[s]);
    Eigen::Matrix4f motion = icp(source, target, Eigen::Matrix4f::Identity(), 0.05 * scans.longest_m());
    motion = icp(source, target, motion, 3.0 * scans.spacing_m(&PosedScan::medium));
    PclCloud aligned;
    pcl::transformPointCloud(source, aligned, motion);
    target += aligned;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(Eigen::Matrix3d(motion.topLeftCorner<3, 3>().cast<double>()))
                        .normalized()
                        .toRotationMatrix();
    pose.translation() = motion.topRightCorner<3, 1>().cast<double>();
    poses.push_back(scans.pose_of(s, pose * scans.scans[s].pose));
  }
  return poses;
}

Poses by_sparsha(const std::vector<ScanConfig>& rough, scene::RegisterConfig::Method method) {
  scene::RegisterConfig config;
  config.method = method;
  return pipeline::testing::registered(rough, config).poses;
}

struct Object {
  std::string name;
  std::vector<ScanConfig> truth;
};

std::vector<Object> objects(const RunOptions& options) {
  std::vector<Object> result;
  result.push_back({"sample relief, 3 stations",
                    scene::load_config(fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml").scans});
  const fs::path folder = options.work / "ring";
  fs::create_directories(folder);
  result.push_back({"vessel, 8 stations in a circle", pipeline::testing::ring(
                                                          folder, 8, [](int) { return 20000; }, 1e-4, 1)});
  if (const char* scans = std::getenv("SPARSHA_SCANS_DIR")) {
    const fs::path bunny = fs::path(scans) / "scans" / "bunny_range";
    if (fs::exists(bunny)) result.push_back({"Stanford bunny, 4 range scans", pipeline::testing::bunny(bunny)});
  }
  return result;
}

}  // namespace

void run_registration(const RunOptions& options) {
  using Method = scene::RegisterConfig::Method;
  constexpr int kRounds = 3;
  std::ofstream csv(options.out / "pipeline_registration.csv");
  csv << "scans,method,seed,rounds,median_s,longest_s,ratio,ratio_low,ratio_high,rms_mm\n";
  fmt::print(
      "\n## Registration, 5 degrees and 10 mm off, {} rounds\n\n| scans | method | seed | median, s | longest, s | "
      "time "
      "over ours | RMS, mm |\n| --- | --- | --- | --- | --- | --- | --- |\n",
      kRounds);
  const std::vector<std::pair<std::string, std::function<Poses(const std::vector<ScanConfig>&)>>> methods{
      {"sparsha gicp", [](const auto& rough) { return by_sparsha(rough, Method::gicp); }},
      {"sparsha icp", [](const auto& rough) { return by_sparsha(rough, Method::icp); }},
      {"pcl::IterativeClosestPoint, scan by scan", by_plain_icp}};
  for (const Object& object : objects(options))
    for (std::uint64_t seed = 1; seed <= (options.every ? 3U : 1U); ++seed) {
      const std::vector<ScanConfig> rough = pipeline::testing::disturbed(object.truth, seed, 5.0, 0.010);
      std::vector<Poses> found(methods.size());
      std::vector<Turn> turns;
      for (std::size_t n = 0; n < methods.size(); ++n)
        turns.push_back({[&method = methods[n].second, &poses = found[n], &rough] {
          return seconds_of([&] { poses = method(rough); });
        }});
      const std::vector<TurnTimes> taken = take_turns(turns, kRounds);
      for (std::size_t n = 0; n < methods.size(); ++n) {
        const TurnTimes& t = taken[n];
        const double rms_mm = 1e3 * pipeline::testing::rms_error(object.truth, found[n]);
        csv << fmt::format("\"{}\",\"{}\",{},{},{},{},{},{},{},{}\n", object.name, methods[n].first, seed,
                           t.times.size(), t.median(), t.longest(), t.ratio, t.ratio_low, t.ratio_high, rms_mm);
        fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.3g} ({:.3g} to {:.3g}) | {:.3g} |\n", object.name,
                   methods[n].first, seed, t.median(), t.longest(), t.ratio, t.ratio_low, t.ratio_high, rms_mm);
        std::fflush(stdout);
      }
    }
}

}  // namespace sparsha::bench

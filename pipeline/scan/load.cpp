// From files to one cloud in metres.
#include "base/threads/progress.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/set.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

Cloud load_scan(const scene::ScanConfig& scan, Progress& progress, const std::optional<Eigen::Vector3d>& origin_m) {
  ScanSet set({scan}, ScanSet::Keep::quickest, false, progress);
  return set.load(origin_m ? *origin_m : set.origin_m(), progress);
}

Cloud load_scans(const std::vector<scene::ScanConfig>& scans, Progress& progress,
                 std::vector<scene::ScanSource>* sources) {
  ScanSet set(scans, ScanSet::Keep::quickest, sources != nullptr, progress);
  Cloud cloud = set.load(set.origin_m(), progress);
  if (sources != nullptr) {
    for (scene::ScanSource& source : set.sources()) sources->push_back(std::move(source));
  }
  return cloud;
}

}  // namespace sparsha::pipeline

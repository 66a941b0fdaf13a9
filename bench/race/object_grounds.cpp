// Grounds of things instead of formulas.
#include <cstdlib>
#include <optional>

#include "bench/race/spline_ground.h"
#include "pipeline/simulate/surface.h"
#include "tests/support/closed_objects.h"

namespace sparsha::bench {
namespace {

constexpr int kSide = 257;

/// The largest square about the middle that the object covers; nothing when it covers none.
std::optional<std::vector<double>> middle_of(const test::ClosedObject& object) {
  const std::array<double, 4> box = object.bounds_m();
  const double x0 = 0.5 * (box[0] + box[2]), y0 = 0.5 * (box[1] + box[3]);
  const double whole = std::min(box[2] - box[0], box[3] - box[1]);
  for (const double share : {0.6, 0.5, 0.4, 0.3, 0.2, 0.1}) {
    const double width = share * whole;
    std::vector<double> heights;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const auto z = object.front_m(x0 + width * (static_cast<double>(i) / (kSide - 1) - 0.5),
                                      y0 + width * (static_cast<double>(j) / (kSide - 1) - 0.5));
        if (!z) break;
        heights.push_back(*z / width);
      }
    if (heights.size() == static_cast<std::size_t>(kSide) * kSide) return heights;
  }
  return std::nullopt;
}

}  // namespace

std::vector<protocol::Ground> object_grounds(double depth_m) {
  std::vector<protocol::Ground> grounds;
  {
    constexpr double kWidth_m = 0.36;  // scaled to 1
    pipeline::SurfaceConfig config;
    config.width_m = kWidth_m;
    config.height_m = 0.44;
    config.form = pipeline::ReliefForm{};
    const pipeline::Surface relief(config);
    std::vector<double> heights;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i)
        heights.push_back(relief.z(kWidth_m * i / (kSide - 1), 0.08 + kWidth_m * j / (kSide - 1)) / kWidth_m);
    grounds.push_back(spline_ground("sample", std::move(heights), kSide, depth_m));
  }
  if (auto heights = middle_of(*test::make_two_spheres()))
    grounds.push_back(spline_ground("closed: two spheres", std::move(*heights), kSide, depth_m));
  const char* scans = std::getenv("SPARSHA_SCANS_DIR");
  std::size_t real = 0;
  for (const test::NamedObject& named : test::mesh_objects(scans == nullptr ? "" : scans)) {
    if (real == 2) break;
    auto heights = middle_of(*named.object);
    if (!heights) continue;
    grounds.push_back(spline_ground("scan: " + named.name, std::move(*heights), kSide, depth_m));
    ++real;
  }
  return grounds;
}

}  // namespace sparsha::bench

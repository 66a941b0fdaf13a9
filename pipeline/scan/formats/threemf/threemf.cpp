#include "pipeline/scan/formats/threemf/threemf.h"

#include <algorithm>
#include <limits>
#include <set>

#include <fmt/format.h>

#include <Eigen/LU>

#include "pipeline/scan/formats/threemf/model.h"
#include "pipeline/scan/formats/threemf/unit.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

using threemf::Object;
using threemf::ObjectKey;
using threemf::Package;
using threemf::Use;

/// Calls use(object, place) for each mesh that is built, wherever components put it.
class Built {
 public:
  Built(const ScanFile& file, const Package& package) : file_(file), package_(package) {}

  template <typename Visit>
  void for_each(const Visit& visit) {
    for (const Use& item : items()) go(item, Eigen::Matrix4d::Identity(), 0, visit);
  }
  [[nodiscard]] std::uint64_t supports() const { return supports_; }
  /// Objects without a mesh and components, as often as they are built.
  [[nodiscard]] std::uint64_t bare() const { return bare_; }

 private:
  /// Where nothing is said to be built, what is no component.
  [[nodiscard]] std::vector<Use> items() const {
    if (!package_.items.empty()) return package_.items;
    std::set<ObjectKey> components;
    for (const auto& [key, object] : package_.objects) {
      for (const Use& use : object.components) components.insert(use.object);
    }
    std::vector<Use> items;
    for (const auto& [key, object] : package_.objects) {
      if (!components.contains(key)) items.push_back({key, Eigen::Matrix4d::Identity()});
    }
    return items;
  }

  template <typename Visit>
  void go(const Use& use, const Eigen::Matrix4d& before, int depth, const Visit& visit) {
    const auto found = package_.objects.find(use.object);
    if (found == package_.objects.end()) {
      throw file_.error("the 3MF model uses an object " + in_quotes(use.object.second) + " that is not there",
                        "a whole model");
    }
    constexpr int kDeepest = 64;
    constexpr std::uint64_t kMostUses = 1'000'000;
    if (depth > kDeepest || ++uses_ > kMostUses) {
      throw file_.error("the 3MF model's components have themselves or far too many for components",
                        "components that end");
    }
    const Object& object = found->second;
    if (object.support) {
      ++supports_;
      return;
    }
    const Eigen::Matrix4d place = before * use.place;
    bare_ += object.vertices.empty() && object.components.empty() ? 1 : 0;
    if (!object.vertices.empty()) visit(object, place);
    for (const Use& component : object.components) go(component, place, depth + 1, visit);
  }

  const ScanFile& file_;
  const Package& package_;
  std::uint64_t supports_ = 0, bare_ = 0, uses_ = 0;
};

}  // namespace

bool is_3mf(const ScanFile& file) {
  if (!file.bytes.starts_with("PK\x03\x04")) return false;
  if (file.extension == "3mf") return true;
  constexpr std::size_t kLooked = 1 << 16;
  const std::string_view end = file.bytes.substr(file.bytes.size() - std::min(file.bytes.size(), kLooked));
  return end.find("3D/3dmodel.model") != std::string_view::npos;
}

void read_3mf(const ScanFile& file, ScanWriter& out) {
  const Package package = threemf::read_package(file, ZipArchive(file));
  const threemf::Unit unit = threemf::unit_of(file, package.unit);
  RawScan& scan = out.scan();
  scan.format = "3MF";
  scan.unit = unit.unit;
  scan.fields = {"x", "y", "z"};
  std::uint64_t vertices = 0, triangles = 0, meshes = 0;
  Built(file, package).for_each([&](const Object& object, const Eigen::Matrix4d&) {
    vertices += object.vertices.size();
    triangles += object.triangles.size();
    ++meshes;
  });
  // A mesh may be built often, but not without end.
  constexpr std::uint64_t kTimes = 256;
  if (vertices > kTimes * package.bytes || vertices >= std::numeric_limits<std::uint32_t>::max()) {
    throw file.error(fmt::format("its build has {} vertices of {} bytes of model", vertices, package.bytes),
                     "a package that repeats its meshes less often");
  }
  if (meshes == 0) throw file.empty("the 3MF model builds no mesh", "an object with vertices and triangles");
  out.expect_mesh(vertices, triangles);
  out.begin(0, false, false);
  Built built(file, package);
  built.for_each([&](const Object& object, const Eigen::Matrix4d& place) {
    file.throw_if_cancelled();
    const auto first = static_cast<std::uint32_t>(out.records());
    for (const Eigen::Vector3d& vertex : object.vertices) {
      const Eigen::Vector3d p = unit.factor * (place.topLeftCorner<3, 3>() * vertex + place.topRightCorner<3, 1>());
      out.add(p.x(), p.y(), p.z());
    }
    const bool mirrored = place.topLeftCorner<3, 3>().determinant() < 0.0;
    const auto count = static_cast<std::uint32_t>(object.vertices.size());
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    const auto corner = [&](std::uint32_t v) { return v < count ? first + v : kNone; };
    for (const auto& t : object.triangles) {
      mirrored ? out.add_triangle(corner(t[0]), corner(t[2]), corner(t[1]))
               : out.add_triangle(corner(t[0]), corner(t[1]), corner(t[2]));
    }
  });
  scan.notes.push_back(
      fmt::format("3MF: {} meshes built of {} objects, unit {}", meshes, package.objects.size(), package.unit));
  if (built.supports() > 0) scan.warnings.push_back(fmt::format("{} supports are left out", built.supports()));
  if (built.bare() > 0) {
    scan.warnings.push_back(
        built.bare() == 1
            ? "an object that is built has neither a mesh nor components; left out"
            : fmt::format("{} objects that are built have neither meshes nor components; left out", built.bare()));
  }
  scan.warnings.insert(scan.warnings.end(), package.warnings.begin(), package.warnings.end());
  for (const auto& [what, count] : package.unread)
    scan.warnings.push_back(
        fmt::format("the {} elements '{}' of its objects, which extensions of 3MF add, are not read", count, what));
  if (package.coloured) scan.warnings.push_back("the colours and materials of its triangles are not read");
}

}  // namespace sparsha::pipeline

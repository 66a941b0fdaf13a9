// A triangle mesh as a closed object: sampled by area, judged by the highest triangle.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <Eigen/Geometry>

#include "base/error.h"
#include "pipeline/scan/reader.h"
#include "tests/support/closed_objects.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

class MeshObject : public ClosedObject {
 public:
  MeshObject(std::vector<Vector3d> points, std::vector<std::array<std::uint32_t, 3>> faces)
      : points_(std::move(points)), faces_(std::move(faces)) {
    bounds_m_ = {1e300, 1e300, -1e300, -1e300};
    for (const auto& face : faces_) {
      const auto [a, b, c] = corners(face);
      area_m2_ += 0.5 * (b - a).cross(c - a).norm();
      sums_m2_.push_back(area_m2_);
      for (const Vector3d& p : {a, b, c}) {
        bounds_m_ = {std::min(bounds_m_[0], p.x()), std::min(bounds_m_[1], p.y()), std::max(bounds_m_[2], p.x()),
                     std::max(bounds_m_[3], p.y())};
      }
    }
    fill_bins();
  }

  double area_m2() const override { return area_m2_; }
  std::array<double, 4> bounds_m() const override { return bounds_m_; }

  SurfacePoint sample(std::mt19937_64& random) const override {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto found = std::lower_bound(sums_m2_.begin(), sums_m2_.end(), unit(random) * area_m2_);
    const auto [a, b, c] = corners(faces_[static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(found - sums_m2_.begin(), static_cast<std::ptrdiff_t>(faces_.size()) - 1))]);
    double r = unit(random), s = unit(random);
    if (r + s > 1.0) {
      r = 1.0 - r;
      s = 1.0 - s;
    }
    return {a + r * (b - a) + s * (c - a), (b - a).cross(c - a).normalized()};
  }

  std::optional<double> front_m(double x, double y) const override {
    const int i = bin(x, 0), j = bin(y, 1);
    if (i < 0 || j < 0 || i >= columns_ || j >= rows_) return std::nullopt;
    std::optional<double> highest;
    for (const std::uint32_t k : bins_[bin_index(i, j)]) {
      const auto [a, b, c] = corners(faces_[k]);
      const double area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
      if (area == 0.0) continue;
      const double u = ((x - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (y - a.y())) / area;
      const double v = ((b.x() - a.x()) * (y - a.y()) - (x - a.x()) * (b.y() - a.y())) / area;
      constexpr double kSlack = 1e-9;
      if (u < -kSlack || v < -kSlack || u + v > 1.0 + kSlack) continue;
      const double z = a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z());
      if (!highest || z > *highest) highest = z;
    }
    return highest;
  }

 private:
  std::array<Vector3d, 3> corners(const std::array<std::uint32_t, 3>& face) const {
    return {points_[face[0]], points_[face[1]], points_[face[2]]};
  }
  int bin(double value, std::size_t axis) const {
    return static_cast<int>(std::floor((value - bounds_m_[axis]) / bin_m_));
  }
  std::size_t bin_index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
  }

  void fill_bins() {
    constexpr double kBins = 400.0;
    bin_m_ = std::max(bounds_m_[2] - bounds_m_[0], bounds_m_[3] - bounds_m_[1]) / kBins;
    columns_ = bin(bounds_m_[2], 0) + 1;
    rows_ = bin(bounds_m_[3], 1) + 1;
    bins_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::uint32_t k = 0; k < faces_.size(); ++k) {
      const auto [a, b, c] = corners(faces_[k]);
      const auto [x0, x1] = std::minmax({a.x(), b.x(), c.x()});
      const auto [y0, y1] = std::minmax({a.y(), b.y(), c.y()});
      for (int j = bin(y0, 1); j <= bin(y1, 1); ++j) {
        for (int i = bin(x0, 0); i <= bin(x1, 0); ++i) bins_[bin_index(i, j)].push_back(k);
      }
    }
  }

  std::vector<Vector3d> points_;
  std::vector<std::array<std::uint32_t, 3>> faces_;
  std::vector<double> sums_m2_;
  double area_m2_ = 0.0;
  std::array<double, 4> bounds_m_{};
  double bin_m_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::uint32_t>> bins_;
};

}  // namespace

ObjectPtr load_mesh_object(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return nullptr;
  pipeline::RawScan scan = pipeline::read_scan(file);
  if (scan.faces.empty()) throw input_error(file.string(), "it has no faces", "a mesh of triangles");
  return std::make_shared<MeshObject>(std::move(scan.points), std::move(scan.faces));
}

std::vector<NamedObject> mesh_objects(const std::filesystem::path& folder) {
  std::vector<NamedObject> objects;
  if (folder.empty()) return objects;
  for (const char* name : {"heritage/lionstatue.obj", "heritage/nefertiti-lowres.obj", "scans/bun_zipper.ply",
                           "heritage/laurana.ply", "heritage/igea.ply", "heritage/demosthenes-low-res.obj"}) {
    const std::filesystem::path file = folder / name;
    if (ObjectPtr object = load_mesh_object(file)) objects.push_back({file.filename().string(), std::move(object)});
  }
  return objects;
}

}  // namespace sparsha::test

// Bytes to scans: regular lattices, strips, single rows, planes, spheres, exact multiples of the spacing, repeated
// points, points on a line, huge and tiny coordinates, few points.
#include "tests/support/whole_way.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

/// Bytes one after the other; zeros when they are used up.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  unsigned next() { return at_ < bytes_.size() ? bytes_[at_++] : 0U; }
  /// One of 0 to count - 1.
  unsigned pick(unsigned count) { return next() % count; }
  template <typename Value, std::size_t count>
  Value one_of(const std::array<Value, count>& values) {
    return values[pick(static_cast<unsigned>(count))];
  }
  bool one_in(unsigned count) { return next() % count == count - 1; }
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_.subspan(at_); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

/// A number from 0 to 1 that belongs to n (splitmix64).
double noise(std::uint64_t n) {
  n += 0x9E3779B97F4A7C15ULL;
  n = (n ^ n >> 30U) * 0xBF58476D1CE4E5B9ULL;
  n = (n ^ n >> 27U) * 0x94D049BB133111EBULL;
  return static_cast<double>((n ^ n >> 31U) >> 11U) * 0x1p-53;
}

struct Shape {
  std::vector<Vector3d> points;
  int nx = 0, ny = 0;      ///< of a lattice, row by row
  double spacing_m = 1.0;  ///< of whole points
  std::string words;
};

/// In spacings.
double height(unsigned kind, int i, int j) {
  switch (kind) {
    case 0:
      return 0.0;
    case 1:
      return (i * 7 + j * 3) % 5;  // whole multiples of the spacing
    case 2:
      return 2.0 * std::sin(0.4 * i) * std::cos(0.3 * j);  // waves
    case 3:
      return noise(static_cast<std::uint64_t>(i * 4096 + j));  // rough
    case 4:
      return i > 8 ? 12.0 : 0.0;  // a step
    case 5:
      return i == 3 && j == 1 ? 1e4 : 0.0;  // a spike
    case 6:
      return 0.75 * i;  // a slope
    case 7:
      return (i + j) % 2 * 40.0;  // needles
    case 8:
      return 4.0 * (i % 3);  // slices of exactly one block
    default:
      return 1e-9 * noise(static_cast<std::uint64_t>(i + 77 * j));
  }
}

Shape lattice(Bytes& bytes, int nx, int ny) {
  Shape shape;
  const unsigned kind = bytes.pick(10);
  shape.nx = nx;
  shape.ny = ny;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) shape.points.emplace_back(i, j, height(kind, i, j));
  shape.words = fmt::format("{} x {} lattice, heights {}", nx, ny, kind);
  return shape;
}

Shape shape_of(Bytes& bytes) {
  constexpr std::array<int, 16> kSides = {2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 20, 31, 32, 33, 40, 50};
  constexpr std::array<int, 10> kLong = {17, 63, 64, 65, 129, 200, 201, 255, 257, 450};
  Shape shape;
  switch (bytes.pick(9)) {
    case 0: {
      const int nx = bytes.one_of(kSides);
      return lattice(bytes, nx, bytes.one_of(kSides));
    }
    case 1:
      return lattice(bytes, bytes.one_of(kLong), 2 + static_cast<int>(bytes.pick(4)));
    case 2:
      return lattice(bytes, 2 + static_cast<int>(bytes.pick(4)), bytes.one_of(kLong));
    case 3:
      return lattice(bytes, 1, bytes.one_of(kSides));  // a single row
    case 4: {
      const int count = 20 + 4 * static_cast<int>(bytes.next());
      for (int k = 0; k < count; ++k) {  // a sphere, points on a spiral
        const double z = 1.0 - 2.0 * (k + 0.5) / count, r = std::sqrt(1.0 - z * z), a = k * 2.399963229728653;
        shape.points.push_back(10.0 * Vector3d(r * std::cos(a), r * std::sin(a), z));
      }
      shape.words = fmt::format("sphere of {}", count);
      return shape;
    }
    case 5: {
      const int count = 4 * static_cast<int>(bytes.next());
      for (int k = 0; k < count; ++k) {
        const auto n = static_cast<std::uint64_t>(3 * k);
        shape.points.push_back(20.0 * Vector3d(noise(n), noise(n + 1), noise(n + 2)));
      }
      shape.words = fmt::format("box of {}", count);
      return shape;
    }
    case 6: {
      const int count = static_cast<int>(bytes.pick(12));
      for (int k = 0; k < count; ++k) {
        const double x = static_cast<double>(bytes.pick(16)), y = static_cast<double>(bytes.pick(16));
        shape.points.emplace_back(x, y, static_cast<double>(bytes.pick(8)));
      }
      shape.words = fmt::format("{} points", count);
      return shape;
    }
    case 7: {
      const int count = 3 + static_cast<int>(bytes.next());
      const int aside = static_cast<int>(bytes.pick(4));
      for (int k = 0; k < count; ++k) shape.points.emplace_back(k, 2 * k, 0.5 * k);
      for (int k = 0; k < aside; ++k) shape.points.emplace_back(k, 5 + k, k);
      shape.words = fmt::format("line of {} and {} beside it", count, aside);
      return shape;
    }
    default: {
      const int side = bytes.one_of(kSides);
      shape = lattice(bytes, side, side);  // with a back
      const std::size_t count = shape.points.size();
      for (std::size_t k = 0; k < count; ++k) shape.points.push_back(shape.points[k] - Vector3d(0, 0, 10));
      shape.nx = shape.ny = 0;
      shape.words += " with a back";
      return shape;
    }
  }
}

void change(Shape& shape, Bytes& bytes) {
  if (bytes.one_in(3)) {
    const double jitter = bytes.one_of(std::array{1e-6, 0.01, 0.1, 0.4});
    for (std::size_t k = 0; k < shape.points.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        shape.points[k][axis] += jitter * (noise(3 * k + static_cast<std::uint64_t>(axis)) - 0.5);
    shape.words += fmt::format(", jitter {}", jitter);
  }
  if (bytes.one_in(4)) {
    const Vector3d axis = bytes.one_of(std::array{Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 2, 3)});
    const double angle = bytes.one_of(std::array{0.3, 0.25 * std::numbers::pi, 0.5 * std::numbers::pi, 1.5});
    for (Vector3d& p : shape.points) p = Eigen::AngleAxisd(angle, axis.normalized()) * p;
    shape.words += fmt::format(", turned by {}", angle);
  }
  if (bytes.one_in(4)) {
    const auto from = static_cast<std::size_t>(bytes.next());
    const std::size_t count = shape.points.size();
    for (std::size_t k = from; k < count; k += 1 + bytes.pick(3)) shape.points.push_back(shape.points[k]);
    shape.words += ", repeated points";
  }
  const double spacing =
      bytes.one_of(std::array{1e-3, 1e-3, 0.01, 1.0, 0.1, 1.0 / 3.0, 1e-6, 1e-12, 1e-30, 1e3, 1e9, 1e30, 1.0 / 1024});
  const double offset = bytes.one_of(std::array{0.0, 0.0, 0.0, 1.0, 1e3, 5e6, 1e9, -0.5, 1e15});
  shape.spacing_m = spacing;
  for (Vector3d& p : shape.points) p = spacing * p + offset * spacing * Vector3d(1, 1.25, 0.5);
  shape.words += fmt::format(", spacing {}, offset {}", spacing, offset);
}

std::string number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : std::string("nan");
}

void add_faces(const Shape& shape, Bytes& bytes, std::vector<std::array<int, 3>>& faces) {
  const unsigned kind = bytes.pick(4);
  const auto count = static_cast<int>(shape.points.size());
  if (shape.nx > 1 && shape.ny > 1 && kind < 3) {
    for (int j = 0; j + 1 < shape.ny; ++j)
      for (int i = 0; i + 1 < shape.nx; ++i) {
        const int n = j * shape.nx + i;
        if (kind == 1 && n > 3) return;  // few faces among many vertices
        if (kind == 2 && n % 3 == 0) continue;
        faces.push_back({n, n + 1, n + shape.nx});
        faces.push_back({n + 1, n + shape.nx + 1, n + shape.nx});
      }
    return;
  }
  for (int k = 0; k < 40 && count > 0; ++k) {
    const auto corner = [&](int c) {
      return static_cast<int>(noise(static_cast<std::uint64_t>(3 * k + c)) * count) % count;
    };
    faces.push_back({corner(0), corner(1), k % 7 == 0 ? corner(1) : corner(2)});
  }
}

void write_scan(const Shape& shape, Bytes& bytes, Recipe& recipe) {
  const int digits = bytes.one_of(std::array{17, 9, 6, 4});
  const unsigned holes = bytes.one_of(std::array{0U, 0U, 2U, 3U, 10U});  // one of so many is left out
  const bool invalid = bytes.one_in(8);
  const bool colour = bytes.one_in(4);
  const bool mesh = bytes.one_in(3);
  std::vector<std::array<int, 3>> faces;
  if (mesh) add_faces(shape, bytes, faces);
  std::string rows;
  std::size_t written = 0;
  for (std::size_t k = 0; k < shape.points.size(); ++k) {
    if (!mesh && holes > 0 && noise(k) < 1.0 / holes) continue;
    Vector3d p = shape.points[k];
    if (invalid && k % 11 == 5) p.x() = std::numeric_limits<double>::quiet_NaN();
    rows += number(p.x(), digits) + " " + number(p.y(), digits) + " " + number(p.z(), digits);
    if (colour) rows += fmt::format(" {} {} 77", k % 256, (k / 7) % 256);
    rows += "\n";
    ++written;
  }
  for (const std::array<int, 3>& f : faces) rows += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
  recipe.name = "scan.ply";
  recipe.scan = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}", written,
      colour ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "");
  if (mesh) recipe.scan += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", faces.size());
  recipe.scan += "end_header\n" + rows;
  recipe.words = fmt::format("{}, {} digits{}{}", shape.words, digits, holes > 0 ? ", holes" : "",
                             mesh ? fmt::format(", {} faces", faces.size()) : std::string());
}

void choose_filters(Bytes& bytes, double spacing_m, scene::Config& config) {
  if (!bytes.one_in(3)) return;
  switch (bytes.pick(7)) {
    case 0:
      config.filters.push_back({scene::VoxelConfig{2.0 * spacing_m}});
      break;
    case 1:
      config.filters.push_back({scene::OutlierConfig{}});
      break;
    case 2:
      config.filters.push_back({scene::RadiusOutlierConfig{}});
      break;
    case 3:
      config.filters.push_back({scene::RemovePlaneConfig{}});
      break;
    case 4:
      config.filters.push_back({scene::KeepConfig{std::nullopt, 1.5 * spacing_m, {}}});
      break;
    case 5:
      config.filters.push_back({scene::SmoothConfig{3.0 * spacing_m, 2, {}}});
      break;
    default:
      config.filters.push_back({scene::ThinConfig{1}});
      break;
  }
}

scene::Config config_of(Bytes& bytes, double spacing_m) {
  scene::Config config;
  config.levels.window = bytes.one_of(std::array{16, 32, 200});
  switch (bytes.pick(4)) {
    case 0:
      config.grid.size = 2 + static_cast<int>(bytes.pick(70));
      break;
    case 1:
      config.grid.spacing_m = spacing_m;
      break;
    case 2:
      config.grid.spacing_m = spacing_m * bytes.one_of(std::array{0.5, 2.0, 0.3, 1.0 / 3.0});
      break;
    default:
      break;
  }
  config.grid.colour = bytes.one_in(2);
  if (bytes.one_in(2)) config.fill = scene::FillConfig{3.0 * spacing_m};
  if (bytes.one_in(2)) {
    config.texture = scene::TextureConfig{2.0 * spacing_m, 0.5 * spacing_m, {}};
    if (bytes.one_in(2)) {
      config.friction = scene::FrictionConfig{};
      config.friction->law =
          bytes.one_of(std::array{scene::FrictionConfig::Law::curvature, scene::FrictionConfig::Law::paper,
                                  scene::FrictionConfig::Law::constant});
    }
  }
  if (!bytes.one_in(4)) config.check = scene::CheckConfig{bytes.one_of(std::array<std::int64_t, 3>{0, 50, 5000})};
  if (bytes.one_in(4)) {
    config.orientation.face =
        bytes.one_of(std::array{scene::OrientationConfig::Face::automatic, scene::OrientationConfig::Face::plane,
                                scene::OrientationConfig::Face::principal});
  }
  config.haptics.grain = bytes.one_in(4);
  choose_filters(bytes, spacing_m, config);
  return config;
}

}  // namespace

Recipe recipe_of(std::span<const std::uint8_t> bytes) {
  Bytes source(bytes);
  Recipe recipe;
  recipe.suggested = source.one_in(4);
  recipe.points_at_once = source.one_in(3) ? 50 : 0;
  Shape shape = shape_of(source);
  change(shape, source);
  recipe.config = config_of(source, shape.spacing_m);
  write_scan(shape, source, recipe);
  recipe.words +=
      fmt::format("; grid {} of {} m, {}{}{}", recipe.config.grid.size, recipe.config.grid.spacing_m,
                  recipe.suggested ? "suggested, " : "",
                  recipe.config.filters.empty() ? "no filter" : scene::filter_name(recipe.config.filters.front()),
                  recipe.config.check ? ", checked" : "");
  return recipe;
}

}  // namespace sparsha::test

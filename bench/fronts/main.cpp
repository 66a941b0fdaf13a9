// bench_fronts PICTURE.png SCAN...: a contact sheet of the fronts that `sparsha new` chooses, to be judged by eye. One
// row a scan: the chosen side, then the others; on the terminal the row's file, the view, and what was said of its
// front.
// bench_fronts --turned PICTURE.png SCAN...: the first guess for each scan as it is, then turned at random; on the
// terminal each guess in the scan's own frame, by how much it differs from the first one, and the time that it took.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/error.h"
#include "base/png/png.h"
#include "base/threads/progress.h"
#include "pipeline/orient/thumbnails.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/units.h"
#include "pipeline/suggest/suggest.h"
#include "pipeline/suggest/view.h"

namespace {

using sparsha::pipeline::Thumbnail;

constexpr int kTile = 170;  // pixels, at least as wide as a thumbnail
constexpr int kSides = 6;

// The scan's surface in metres, spread evenly.
sparsha::pipeline::EvenPoints object_of(const sparsha::scene::ScanConfig& scan, sparsha::Progress& progress) {
  const sparsha::pipeline::ScanStatistics statistics = sparsha::pipeline::scan_statistics(scan.file, progress);
  sparsha::pipeline::SeenScans seen;
  seen.look_at(statistics, sparsha::scene::metres_in(scan.units.unit));
  return sparsha::pipeline::even_points(seen.triangles_m.empty() ? seen.points_m : seen.triangles_m);
}

// The side that a configuration shows. Its rotation's rows are right, up and towards the viewer.
sparsha::pipeline::View view_of(const sparsha::scene::Config& config) {
  const Eigen::Matrix3d turn = config.orientation.scan_to_grid.topLeftCorner<3, 3>();
  sparsha::pipeline::View view;
  view.up = turn.row(1);
  view.look_from = turn.row(2);
  return view;
}

// Into the middle of a tile; what does not fit is cut off.
void place(const Thumbnail& thumbnail, int row, int column, std::vector<std::uint8_t>& sheet) {
  const int shift = (kTile - thumbnail.side) / 2;
  for (int y = 0; y < kTile; ++y) {
    for (int x = 0; x < kTile; ++x) {
      const int u = x - shift;
      const int v = y - shift;
      if (u < 0 || v < 0 || u >= thumbnail.side || v >= thumbnail.side) continue;
      const std::uint8_t grey = thumbnail.grey[static_cast<std::size_t>(v * thumbnail.side + u)];
      const auto at = static_cast<std::size_t>((row * kTile + y) * kSides * kTile + column * kTile + x);
      std::fill_n(sheet.begin() + static_cast<std::ptrdiff_t>(3 * at), 3, grey);
    }
  }
}

void write_sheet(const std::filesystem::path& picture, int rows, const std::vector<std::uint8_t>& sheet) {
  sparsha::PngFormat format;
  format.width = kSides * kTile;
  format.height = rows * kTile;
  sparsha::write_png(picture, format, sheet);
}

int run(const std::filesystem::path& picture, const std::vector<std::filesystem::path>& scans) {
  std::vector<std::uint8_t> sheet;
  int rows = 0;
  for (const std::filesystem::path& scan : scans) {
    sparsha::Progress progress;
    try {
      const sparsha::pipeline::Suggestion suggestion = sparsha::pipeline::suggest_config({scan}, {}, progress);
      const sparsha::pipeline::View view = view_of(suggestion.config);
      const std::size_t begin = suggestion.yaml.find("\n#", suggestion.yaml.find("\norientation:")) + 2;
      fmt::print("{:2} {}{}: from {:.3f} {:.3f} {:.3f}, up {:.3f} {:.3f} {:.3f}:{}\n", rows + 1,
                 scan.filename().string(), suggestion.sides.empty() ? "" : " (open)", view.look_from.x(),
                 view.look_from.y(), view.look_from.z(), view.up.x(), view.up.y(), view.up.z(),
                 suggestion.yaml.substr(begin, suggestion.yaml.find('\n', begin) - begin));
      sheet.resize(sheet.size() + static_cast<std::size_t>(3 * kTile * kTile * kSides), Thumbnail::kNothing);
      const auto object = object_of(suggestion.config.scans.front(), progress);
      const std::vector<Thumbnail> sides = sparsha::pipeline::six_thumbnails(object, view.look_from, view.up);
      for (std::size_t k = 0; k < sides.size(); ++k) place(sides[k], rows, static_cast<int>(k), sheet);
      ++rows;
    } catch (const sparsha::Error& error) {
      fmt::print("-- {}: {}\n", scan.filename().string(), error.what());
    }
  }
  if (rows == 0) return 1;
  write_sheet(picture, rows, sheet);
  return 0;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

// What is seen of a scan turned by `turn`.
sparsha::pipeline::SeenScans seen_turned(const sparsha::pipeline::ScanStatistics& statistics,
                                         const Eigen::Matrix3d& turn) {
  sparsha::pipeline::ScanStatistics turned = statistics;
  for (Eigen::Vector3d& p : turned.scan.points) p = turn * p;
  turned.stated_facing = turn * turned.stated_facing;
  sparsha::pipeline::SeenScans seen;
  seen.look_at(turned, sparsha::scene::metres_in(turned.scan.unit.value_or(sparsha::scene::LengthUnit::m)));
  return seen;
}

int run_turned(const std::filesystem::path& picture, const std::vector<std::filesystem::path>& scans) {
  using Seconds = std::chrono::duration<double>;
  std::vector<std::uint8_t> sheet;
  int rows = 0;
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  for (const std::filesystem::path& file : scans) {
    sparsha::Progress progress;
    const sparsha::pipeline::ScanStatistics statistics = sparsha::pipeline::scan_statistics(file, progress);
    sheet.resize(sheet.size() + static_cast<std::size_t>(3 * kTile * kTile * kSides), Thumbnail::kNothing);
    std::optional<sparsha::pipeline::View> first;
    for (int n = 0; n < kSides; ++n) {
      const Eigen::Quaterniond any(normal(random), normal(random), normal(random), normal(random));
      const Eigen::Matrix3d turn = n == 0 ? Eigen::Matrix3d::Identity() : any.normalized().toRotationMatrix();
      const sparsha::pipeline::SeenScans seen = seen_turned(statistics, turn);
      const auto begin = std::chrono::steady_clock::now();
      const sparsha::pipeline::Sides sides = sparsha::pipeline::sides_of(seen, {});
      const Seconds took = std::chrono::steady_clock::now() - begin;
      sparsha::pipeline::View view = sides.views.front();
      const auto object = sparsha::pipeline::even_points(seen.triangles_m.empty() ? seen.points_m : seen.triangles_m);
      place(sparsha::pipeline::thumbnail_of(object, {"front", view.look_from, view.up}), rows, n, sheet);
      view.look_from = turn.transpose() * view.look_from;
      view.up = turn.transpose() * view.up;
      if (!first) first = view;
      fmt::print(
          "{} {}{}: from {:.2f} {:.2f} {:.2f}, up {:.2f} {:.2f} {:.2f}; off by {:.0f}, up by {:.0f} degrees; {:.2f} "
          "s\n",
          n == 0 ? file.filename().string() : "  turned", n == 0 ? "" : fmt::format("{}", n),
          sides.open ? " (open)" : "", view.look_from.x(), view.look_from.y(), view.look_from.z(), view.up.x(),
          view.up.y(), view.up.z(), angle_deg(view.look_from, first->look_from), angle_deg(view.up, first->up),
          took.count());
    }
    ++rows;
  }
  if (rows == 0) return 1;
  write_sheet(picture, rows, sheet);
  return 0;
}

}  // namespace

int main(int count, char** words) {
  const bool turned = count > 1 && std::string_view(words[1]) == "--turned";
  const int picture = turned ? 2 : 1;
  if (count < picture + 2) {
    std::fputs("usage: bench_fronts [--turned] PICTURE.png SCAN...\n", stderr);
    return 2;
  }
  try {
    return (turned ? run_turned : run)(words[picture], {words + picture + 1, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

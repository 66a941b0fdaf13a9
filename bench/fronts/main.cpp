// bench_fronts PICTURE.png SCAN...: a contact sheet of the fronts that `sparsha new` chooses, to be judged by eye. One
// row a scan: the chosen side, then the others; on the terminal the row's file, the view, and what was said of its
// front.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <vector>

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
  seen.look_at(statistics.scan, statistics.runs, sparsha::scene::metres_in(scan.units.unit));
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
  sparsha::PngFormat format;
  format.width = kSides * kTile;
  format.height = rows * kTile;
  sparsha::write_png(picture, format, sheet);
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::fputs("usage: bench_fronts PICTURE.png SCAN...\n", stderr);
    return 2;
  }
  try {
    return run(words[1], {words + 2, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

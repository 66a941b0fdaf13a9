#include "haptics/around/object_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "base/error.h"

namespace sparsha::haptics {
namespace {

constexpr double kBlockCells = 8.0;          // width of a block
constexpr double kNearCells = 2.5;           // two sheets so near are looked at
constexpr double kSteep = 0.5;               // facing below which the proxy looks for another sheet
constexpr double kSameGapCells = 0.5;        // of two sheets of one surface, at most
constexpr double kSameNormal = 0.866025404;  // cosine of 30 degrees

/// Use(i, j, cell index) of all cells that are worth something.
template <typename Use>
void for_cells(const SheetSurface& sheet, const Use& use) {
  const scene::Lattice& lattice = sheet.surface->lattice;
  std::size_t cell = 0;
  for (int j = 0; j + 1 < lattice.ny; ++j)
    for (int i = 0; i + 1 < lattice.nx; ++i, ++cell)
      if (sheet.cells[cell] != kNoCell) use(i, j, cell);
}

std::array<Eigen::Vector3d, 4> corners_of(const SheetSurface& sheet, int i, int j) {
  const scene::Lattice& lattice = sheet.surface->lattice;
  std::array<Eigen::Vector3d, 4> corners;
  for (int k = 0; k < 4; ++k) {
    const int a = i + k % 2;
    const int b = j + k / 2;
    corners[static_cast<std::size_t>(k)] =
        sheet.to_object({a * lattice.spacing_m, b * lattice.spacing_m,
                         static_cast<double>(sheet.surface->height_m[lattice.index(a, b)])});
  }
  return corners;
}

BlockIndex index_of(const std::vector<SheetSurface>& sheets, double spacing_m) {
  BlockIndex measure(kBlockCells * spacing_m, {});
  std::vector<BlockIndex::Entry> entries;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    std::uint64_t last = ~std::uint64_t{0};
    for_cells(sheets[s], [&](int i, int j, std::size_t) {
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& corner : corners_of(sheets[s], i, j)) box.extend(corner);
      const Eigen::Vector3d reach = Eigen::Vector3d::Constant(kNearCells * spacing_m);
      const BlockPlace low = measure.block_of(box.min() - reach);
      const BlockPlace high = measure.block_of(box.max() + reach);
      for (int x = low.x(); x <= high.x(); ++x)
        for (int y = low.y(); y <= high.y(); ++y)
          for (int z = low.z(); z <= high.z(); ++z) {
            const std::uint64_t key = BlockIndex::key_of({x, y, z});
            if (key != last || low == high) entries.push_back({key, static_cast<std::uint32_t>(s)});
            last = key;
          }
    });
  }
  return {kBlockCells * spacing_m, std::move(entries)};
}

/// Steep cells, and those near another sheet that is not the same surface.
bool needs_a_look(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m,
                  const Eigen::Vector3d& normal, double facing) {
  if (facing < kSteep) return true;
  const double near_m = kNearCells * object.spacing_m;
  for (const std::uint32_t other : object.blocks.sheets_at(place_m)) {
    if (other == own) continue;
    const SheetView view = view_of(object.sheets[other], place_m);
    if (view.cell == kNoCell || std::abs(view.gap_m) > near_m) continue;
    const bool same =
        std::abs(view.gap_m) <= kSameGapCells * object.spacing_m && view.normal.dot(normal) >= kSameNormal;
    if (!same) return true;
  }
  return false;
}

void mark_looks(ObjectSurface& object) {
  std::vector<std::vector<std::uint8_t>> marks;
  for (std::size_t s = 0; s < object.sheets.size(); ++s) {
    const SheetSurface& sheet = object.sheets[s];
    std::vector<std::uint8_t> mine = sheet.cells;
    for_cells(sheet, [&](int i, int j, std::size_t cell) {
      if (sheet.cells[cell] < kOpenCell) return;
      const double half = 0.5 * object.spacing_m;
      const double h = object.spacing_m;
      const Eigen::Vector3d middle =
          sheet.to_object({i * h + half, j * h + half, sheet.surface->height(i * h + half, j * h + half)});
      const SheetView own = view_of(sheet, middle);
      if (needs_a_look(object, static_cast<std::uint32_t>(s), middle, own.normal, own.facing)) mine[cell] = kLookCell;
    });
    marks.push_back(std::move(mine));
  }
  for (std::size_t s = 0; s < marks.size(); ++s) object.sheets[s].cells = std::move(marks[s]);
}

/// The distance of open cells from the nearest one that is not, by a chamfer of the chessboard metric (Rosenfeld &
/// Pfaltz 1966).
void count_open_cells(SheetSurface& sheet) {
  const int nx = sheet.surface->lattice.nx - 1;
  const int ny = sheet.surface->lattice.ny - 1;
  const auto at = [&](int i, int j) -> int { return sheet.cell(i, j); };
  const auto lower = [&](int i, int j, int di, int dj) {
    std::uint8_t& cell =
        sheet.cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)];
    if (cell < kOpenCell) return;
    int least = 255;
    for (int k = -1; k <= 1; ++k) least = std::min(least, at(i + k, j + dj));
    least = std::min(least, at(i + di, j));
    cell =
        static_cast<std::uint8_t>(std::min<int>(cell, std::max<int>(kOpenCell, std::max<int>(least, kLookCell) + 1)));
  };
  for (std::uint8_t& cell : sheet.cells)
    if (cell >= kOpenCell) cell = 255;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) lower(i, j, -1, -1);
  for (int j = ny - 1; j >= 0; --j)
    for (int i = nx - 1; i >= 0; --i) lower(i, j, 1, 1);
}

std::shared_ptr<ObjectSurface> object_of(const scene::Charts& charts, const AroundFriction& friction) {
  if (charts.sheets.empty() || !(charts.spacing_m > 0.0))
    throw Error(ErrorKind::failure, {}, "charts without a sheet", "at least one sheet and a positive spacing");
  auto object = std::make_shared<ObjectSurface>();
  object->spacing_m = charts.spacing_m;
  object->origin_m = charts.origin_m;
  object->box_m = box_of(charts);
  object->sheets.reserve(charts.sheets.size());
  for (const scene::Sheet& sheet : charts.sheets) {
    for (const scene::Sheet& piece : pieces_of(sheet, charts.spacing_m)) {
      object->sheets.push_back(make_sheet_surface(charts, piece, friction));
      object->sheets.back().number = static_cast<std::uint32_t>(object->charted);
    }
    ++object->charted;
  }
  object->blocks = index_of(object->sheets, charts.spacing_m);
  mark_looks(*object);
  for (SheetSurface& sheet : object->sheets) count_open_cells(sheet);
  return object;
}

}  // namespace

Eigen::AlignedBox3d box_of(const scene::Charts& charts) {
  Eigen::AlignedBox3d box;
  for (const scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j))) box.extend(charts.place_m(sheet, i, j));
  return box;
}

std::shared_ptr<const ObjectSurface> make_object_surface(const scene::Charts& charts, const AroundFriction& friction,
                                                         std::shared_ptr<const scene::Charts> kept) {
  std::shared_ptr<ObjectSurface> object = object_of(charts, friction);
  object->charts = std::move(kept);
  return object;
}

}  // namespace sparsha::haptics

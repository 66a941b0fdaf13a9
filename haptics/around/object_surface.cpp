#include "haptics/around/object_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include <Eigen/Geometry>

#include "base/error.h"

namespace sparsha::haptics {
namespace {

constexpr double kBlockCells = 4.0;    // width of a block
constexpr double kNearCells = 2.5;     // two sheets so near are looked at
constexpr double kSteep = 0.5;         // facing below which the proxy looks for another sheet
constexpr double kSameGapCells = 0.5;  // of two sheets of one surface, at most
constexpr double kNearNormal = 0.5;    // of 60 degrees: the same surface where a sheet ends
constexpr double kEndGapCells = 1.5;   // of two sheets of one surface where one ends, at most
constexpr double kWallNormal = 0.7;    // cosine of 45 degrees: least that faces of a hollow corner turn by
constexpr double kFoldCells = 0.5;     // that two faces of a hollow corner lie before each other, at least
constexpr double kBehindCells = 0.5;   // of a floor's cell behind its wall, at most
constexpr double kBeyondCells = 0.2;   // of what a face goes on as behind the other, at most
constexpr double kFootCells = 1.5;     // so far below its floor a wall is not measured
constexpr int kWallCells = 3;          // so far above its floor a wall is measured

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

/// Use(block) of all blocks that are so near to a cell.
template <typename Use>
void for_blocks(const BlockIndex& blocks, const SheetSurface& sheet, int i, int j, double reach_m, const Use& use) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners_of(sheet, i, j)) box.extend(corner);
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_m);
  const BlockPlace low = blocks.block_of(box.min() - reach);
  const BlockPlace high = blocks.block_of(box.max() + reach);
  for (int x = low.x(); x <= high.x(); ++x)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int z = low.z(); z <= high.z(); ++z) use(BlockPlace(x, y, z));
}

/// The blocks that were asked for last: most cells lie in blocks that cells before them lie in, too.
template <class Value>
class LastBlocks {
 public:
  /// The value of a block; `make(key)` gives it for one that is not among the last ones.
  template <typename Make>
  const Value& of(const BlockPlace& block, const Make& make) {
    const std::uint64_t key = BlockIndex::key_of(block);
    Slot& slot = slots_[static_cast<std::size_t>(block.x() & 15) << 8U |
                        static_cast<std::size_t>(block.y() & 15) << 4U | static_cast<std::size_t>(block.z() & 15)];
    if (slot.key != key) slot = {key, make(key)};
    return slot.value;
  }

 private:
  struct Slot {
    std::uint64_t key = ~std::uint64_t{0};
    Value value{};
  };
  std::vector<Slot> slots_ = std::vector<Slot>(4096);
};

BlockIndex index_of(const std::vector<SheetSurface>& sheets, double spacing_m) {
  const BlockIndex measure(kBlockCells * spacing_m, {});
  std::vector<BlockIndex::Entry> entries;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    LastBlocks<bool> last;
    for_cells(sheets[s], [&](int i, int j, std::size_t) {
      for_blocks(measure, sheets[s], i, j, kNearCells * spacing_m, [&](const BlockPlace& block) {
        static_cast<void>(last.of(block, [&](std::uint64_t key) {
          entries.push_back({key, static_cast<std::uint32_t>(s)});
          return true;
        }));
      });
    });
  }
  return {kBlockCells * spacing_m, std::move(entries)};
}

/// What a cell's bilinear and B-spline patches lie within: the sixteen nodes about it, or where they are nearly in a
/// plane, its corners and a slack. Cubics between nodes differ from straight lines by 1/8 of the second differences,
/// those of the B-spline at nodes by 1/6 besides.
class CellHull {
 public:
  CellHull(const SheetSurface& sheet, int i, int j, const std::array<Eigen::Vector3d, 4>& corners) {
    constexpr double kShare = 0.3;
    constexpr double kNearlyPlane = 0.2;  // cells
    const scene::Lattice& lattice = sheet.surface->lattice;
    const auto height = [&](int a, int b) {
      return static_cast<double>(
          sheet.surface->height_m[lattice.index(std::clamp(a, 0, lattice.nx - 1), std::clamp(b, 0, lattice.ny - 1))]);
    };
    double along_u = 0.0, along_v = 0.0;
    for (int k = 0; k < 2; ++k)
      for (int l = -1; l <= 2; ++l) {
        const int a = i + k, b = j + k;
        along_u = std::max(along_u, std::abs(height(a - 1, j + l) - 2.0 * height(a, j + l) + height(a + 1, j + l)));
        along_v = std::max(along_v, std::abs(height(i + l, b - 1) - 2.0 * height(i + l, b) + height(i + l, b + 1)));
      }
    slack_m_ = kShare * (along_u + along_v);
    std::copy(corners.begin(), corners.end(), places_m_.begin());
    if (slack_m_ <= kNearlyPlane * lattice.spacing_m) return;
    slack_m_ = 0.0;
    count_ = places_m_.size();
    for (int k = 0; k < 16; ++k) {
      const int a = i - 1 + k % 4, b = j - 1 + k / 4;
      places_m_[static_cast<std::size_t>(k)] =
          sheet.to_object({a * lattice.spacing_m, b * lattice.spacing_m, height(a, b)});
    }
  }
  void widen(Passing& passing) const {
    const auto slack_m = static_cast<float>(slack_m_);
    for (std::size_t k = 0; k < count_; ++k) {
      const auto at_m = static_cast<float>(passing.height_m(places_m_[k]));
      passing.low_m = std::min(passing.low_m, at_m - slack_m);
      passing.high_m = std::max(passing.high_m, at_m + slack_m);
    }
  }

 private:
  std::array<Eigen::Vector3d, 16> places_m_;
  std::size_t count_ = 4;
  double slack_m_ = 0.0;
};

/// The planes that hold each sheet in each block: along the mean normal of the cells in it, or the normal of any cell
/// near to it.
void set_planes(ObjectSurface& object) {
  for (std::size_t s = 0; s < object.sheets.size(); ++s) {
    const SheetSurface& sheet = object.sheets[s];
    LastBlocks<Passing*> last;
    const auto passing_in = [&](const BlockPlace& block) -> Passing& {
      return *last.of(block, [&](std::uint64_t) { return object.blocks.find(block, static_cast<std::uint32_t>(s)); });
    };
    const auto normal_of = [&](const std::array<Eigen::Vector3d, 4>& corners) {
      return Eigen::Vector3f((corners[3] - corners[0]).cross(corners[2] - corners[1]).cast<float>());
    };
    for_cells(sheet, [&](int i, int j, std::size_t) {
      const auto corners = corners_of(sheet, i, j);
      passing_in(object.blocks.block_of(0.5 * (corners[0] + corners[3]))).normal += normal_of(corners);
    });
    for_cells(sheet, [&](int i, int j, std::size_t) {
      const auto corners = corners_of(sheet, i, j);
      const CellHull hull(sheet, i, j, corners);
      for_blocks(object.blocks, sheet, i, j, kPassingReach * object.spacing_m, [&](const BlockPlace& block) {
        Passing& passing = passing_in(block);
        if (passing.low_m > passing.high_m) {
          if (passing.normal.isZero(0.0F)) passing.normal = normal_of(corners);
          passing.normal.normalize();
        }
        hull.widen(passing);
      });
    });
  }
}

/// A place of a sheet and its normal there.
struct Facet {
  Eigen::Vector3d place_m, normal;
};

/// The mean of the measured cells that are nearest to a cell of the rim; nothing without any.
std::optional<Facet> border_of(const SheetSurface& sheet, int i, int j, double spacing_m) {
  constexpr int kReach = kRimCells + 1;
  int nearest = std::numeric_limits<int>::max(), count = 0;
  Facet sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int b = -kReach; b <= kReach; ++b)
    for (int a = -kReach; a <= kReach; ++a) {
      const int squared = a * a + b * b;
      if (squared > nearest || sheet.cell(i + a, j + b) < kLookCell) continue;
      const double x_m = (i + a + 0.5) * spacing_m, y_m = (j + b + 0.5) * spacing_m;
      const SheetView view = view_of(sheet, sheet.to_object({x_m, y_m, 0.0}));
      if (squared < nearest) nearest = squared, count = 0, sum = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
      sum.place_m += sheet.to_object(view.local);
      sum.normal += view.normal;
      ++count;
    }
  if (count == 0) return {};
  return Facet{sum.place_m / count, sum.normal.normalized()};
}

/// Is a sheet the wall of a hollow corner whose floor has this border, where a place continues the floor? The measured
/// floor lies before the measured wall, and the wall before the floor. The wall has no part behind the floor.
bool is_wall_of(const SheetSurface& wall, const Facet& floor, const Eigen::Vector3d& place_m, double spacing_m) {
  const double h = spacing_m;
  const auto height_m = [&](const SheetView& view) {
    return (wall.to_object(view.local) - floor.place_m).dot(floor.normal);
  };
  const SheetView foot = view_of(wall, place_m - kFootCells * h * floor.normal);
  if (foot.cell >= kLookCell && std::abs(foot.gap_m) <= kNearCells * h && height_m(foot) < -kFoldCells * h)
    return false;
  for (int k = 1; k <= kWallCells; ++k) {
    const SheetView view = view_of(wall, place_m + k * h * floor.normal);
    if (view.cell < kLookCell || std::abs(view.gap_m) > kNearCells * h) continue;
    if (std::abs(view.normal.dot(floor.normal)) >= kWallNormal || height_m(view) < kFoldCells * h) continue;
    const Eigen::Vector3d on_wall_m = wall.to_object(view.local);
    if ((floor.place_m - on_wall_m).dot(view.normal) < kFoldCells * h) continue;
    if ((place_m - on_wall_m).dot(view.normal) >= -kBehindCells * h) return true;
  }
  return false;
}

/// May a cell of the rim at a place be closed? Not where the surface goes on in another sheet, nor behind one.
bool may_close(const ObjectSurface& object, std::size_t own, const Facet& floor, const Eigen::Vector3d& place_m) {
  const double h = object.spacing_m;
  for (const Passing& passing : object.blocks.sheets_at(place_m)) {
    if (passing.sheet == own) continue;
    const SheetView view = view_of(object.sheets[passing.sheet], place_m);
    if (view.cell < kOpenCell || std::abs(view.gap_m) > kNearCells * h) continue;
    const bool goes_on = std::abs(view.gap_m) <= kEndGapCells * h && view.normal.dot(floor.normal) >= kNearNormal;
    if (goes_on || view.gap_m < -kBehindCells * h) return false;
  }
  return true;
}

/// Does a cell of the rim lie before the wall of a hollow corner?
bool is_before_wall(const ObjectSurface& object, std::size_t own, const Facet& floor, const Eigen::Vector3d& place_m) {
  for (const Passing& passing : object.blocks.sheets_at(place_m))
    if (passing.sheet != own && is_wall_of(object.sheets[passing.sheet], floor, place_m, object.spacing_m)) return true;
  return false;
}

/// Is a place behind another sheet, near to it?
bool is_behind(const ObjectSurface& object, std::size_t own, const Eigen::Vector3d& place_m) {
  const double h = object.spacing_m;
  for (const Passing& passing : object.blocks.sheets_at(place_m)) {
    if (passing.sheet == own) continue;
    const SheetView view = view_of(object.sheets[passing.sheet], place_m);
    if (view.cell >= kLookCell && view.gap_m < -kBeyondCells * h && view.gap_m > -kNearCells * h) return true;
  }
  return false;
}

/// The middle of a cell, on the sheet.
Eigen::Vector3d middle_of(const SheetSurface& sheet, int i, int j, double spacing_m) {
  const double x_m = (i + 0.5) * spacing_m, y_m = (j + 0.5) * spacing_m;
  return sheet.to_object({x_m, y_m, sheet.surface->height(x_m, y_m)});
}

/// Between the measured nodes of the two faces of a hollow corner there are some whose normals are of both: faces go on
/// there along their slopes until they meet, and that counts as a closed hole. Where three faces meet they come nearer
/// to each other with every pass.
void close_corners(ObjectSurface& object) {
  constexpr int kPasses = 2;
  const double h = object.spacing_m;
  using Cells = std::vector<std::uint8_t>;
  const auto set_cells = [&](std::vector<Cells>& cells) {
    for (std::size_t s = 0; s < cells.size(); ++s) object.sheets[s].cells = std::move(cells[s]);
  };
  std::vector<Cells> before;
  for (const SheetSurface& sheet : object.sheets) before.push_back(sheet.cells);
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Cells> cells;
    bool any_sheet = false;
    for (std::size_t s = 0; s < object.sheets.size(); ++s) {
      const SheetSurface& sheet = object.sheets[s];
      Cells filled = sheet.cells;
      std::vector<std::size_t> candidates;
      bool any = false;
      for_cells(sheet, [&](int i, int j, std::size_t cell) {
        if (sheet.cells[cell] != kRimCell) return;
        const std::optional<Facet> floor = border_of(sheet, i, j, h);
        const Eigen::Vector3d place_m = middle_of(sheet, i, j, h);
        if (!floor || !may_close(object, s, *floor, place_m)) return;
        candidates.push_back(cell);
        if (!is_before_wall(object, s, *floor, place_m)) return;
        filled[cell] = kLookCell;
        any = true;
      });
      if (any) {
        const Cells closed = close_holes(sheet, filled);
        for (const std::size_t cell : candidates)
          if (closed[cell] != 0) filled[cell] = kLookCell;
      }
      any_sheet = any_sheet || any;
      cells.push_back(std::move(filled));
    }
    if (!any_sheet) break;
    set_cells(cells);
  }
  // What has gone on beyond the line where they meet is none of the object's.
  std::vector<Cells> cells;
  for (std::size_t s = 0; s < object.sheets.size(); ++s) {
    const SheetSurface& sheet = object.sheets[s];
    cells.push_back(sheet.cells);
    for_cells(sheet, [&](int i, int j, std::size_t cell) {
      if (before[s][cell] == kRimCell && sheet.cells[cell] != kRimCell &&
          is_behind(object, s, middle_of(sheet, i, j, h)))
        cells[s][cell] = kRimCell;
    });
  }
  set_cells(cells);
}

/// Steep cells, and those near another sheet that is not the same surface.
bool needs_a_look(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& place_m,
                  const Eigen::Vector3d& normal, double facing) {
  if (facing < kSteep) return true;
  const double near_m = kNearCells * object.spacing_m;
  for (const Passing& other : object.blocks.sheets_at(place_m)) {
    if (other.sheet == own) continue;
    const SheetView view = view_of(object.sheets[other.sheet], place_m);
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

/// An enclosure, made on a thread of its own: it takes half as long as all the rest of an object, which does not use
/// it.
class EnclosureMade {
 public:
  explicit EnclosureMade(const scene::Charts& charts) : thread_([this, &charts] { make(charts); }) {}
  ~EnclosureMade() {
    if (thread_.joinable()) thread_.join();
  }
  EnclosureMade(const EnclosureMade&) = delete;
  EnclosureMade& operator=(const EnclosureMade&) = delete;

  /// Once. Throws what making it threw.
  [[nodiscard]] std::shared_ptr<const Enclosure> get() {
    thread_.join();
    if (failed_) std::rethrow_exception(failed_);
    return made_;
  }

 private:
  void make(const scene::Charts& charts) noexcept {
    try {
      made_ = std::make_shared<const Enclosure>(charts);
    } catch (...) {
      failed_ = std::current_exception();
    }
  }

  std::shared_ptr<const Enclosure> made_;
  std::exception_ptr failed_;
  std::thread thread_;  // last: it uses the others
};

/// To the envelope, which a node's place lies `texture_m` before along its normal.
void take_texture_off(scene::Sheet& sheet) {
  for (std::size_t node = 0; node < sheet.count(); ++node)
    if (sheet.measured(node)) sheet.height_m[node] = sheet.envelope_m(node);
}

// The pieces are those of the surface as scanned, with its texture or without: a swap keeps the proxy's sheet by
// number.
std::shared_ptr<ObjectSurface> object_of(const scene::Charts& charts, const AroundFriction& friction, bool texture,
                                         const ObjectSurface* like) {
  if (!texture && !has_envelope(charts))
    throw Error(ErrorKind::failure, {}, "charts whose sheets have no envelope", "sheets built with a block texture");
  if (charts.sheets.empty() || !(charts.spacing_m > 0.0))
    throw Error(ErrorKind::failure, {}, "charts without a sheet", "at least one sheet and a positive spacing");
  std::optional<EnclosureMade> enclosure;
  if (like == nullptr) enclosure.emplace(charts);
  auto object = std::make_shared<ObjectSurface>();
  object->spacing_m = charts.spacing_m;
  object->origin_m = charts.origin_m;
  object->box_m = box_of(charts);
  object->sheets.reserve(charts.sheets.size());
  for (const scene::Sheet& sheet : charts.sheets) {
    for (scene::Sheet& piece : pieces_of(sheet, charts.spacing_m)) {
      if (!texture) take_texture_off(piece);
      object->sheets.push_back(make_sheet_surface(charts, piece, friction));
      object->sheets.back().number = static_cast<std::uint32_t>(object->charted);
    }
    ++object->charted;
  }
  object->blocks = index_of(object->sheets, charts.spacing_m);
  set_planes(*object);
  close_corners(*object);
  mark_looks(*object);
  for (SheetSurface& sheet : object->sheets) count_open_cells(sheet);
  object->enclosure = like != nullptr ? like->enclosure : enclosure->get();
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

bool has_envelope(const scene::Charts& charts) {
  return std::all_of(charts.sheets.begin(), charts.sheets.end(),
                     [](const scene::Sheet& sheet) { return sheet.texture_m.size() == sheet.count(); });
}

std::shared_ptr<const ObjectSurface> make_object_surface(const scene::Charts& charts, const AroundFriction& friction,
                                                         std::shared_ptr<const scene::Charts> kept, bool texture,
                                                         const ObjectSurface* like) {
  std::shared_ptr<ObjectSurface> object = object_of(charts, friction, texture, like);
  object->charts = std::move(kept);
  return object;
}

}  // namespace sparsha::haptics

#include "haptics/around/sheet_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sparsha::haptics {
namespace {

constexpr int kMargin = kRimCells + 2;  // nodes about a sheet's box
constexpr double kStep = 0.3;           // facing of a step between two parts of a sheet, which is no surface
constexpr int kSmallest = 16;           // nodes across a piece that is not cut further
constexpr int kOverlap = 6;             // nodes that a piece goes on beyond the cut

/// A sheet's nodes and cells with the margin about them.
struct Padded {
  int nx, ny;
  std::vector<float> height_m;
  std::vector<std::uint8_t> cells;  // of the (nx-1)*(ny-1) cells: 1 where trusted

  [[nodiscard]] std::size_t node(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] std::size_t cell(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx - 1) + static_cast<std::size_t>(i);
  }
};

Padded pad(const scene::Sheet& sheet) {
  Padded padded{sheet.nx + 2 * kMargin, sheet.ny + 2 * kMargin, {}, {}};
  padded.height_m.assign(static_cast<std::size_t>(padded.nx) * static_cast<std::size_t>(padded.ny),
                         scene::kUnknownHeight);
  padded.cells.assign(static_cast<std::size_t>(padded.nx - 1) * static_cast<std::size_t>(padded.ny - 1), 0);
  for (int j = 0; j < sheet.ny; ++j) {
    for (int i = 0; i < sheet.nx; ++i) {
      const std::size_t node = sheet.index(i, j);
      if (!sheet.measured(node)) continue;
      padded.height_m[padded.node(i + kMargin, j + kMargin)] = sheet.height_m[node];
      if ((sheet.mask[node] & scene::Sheet::kCell) != 0) padded.cells[padded.cell(i + kMargin, j + kMargin)] = 1;
    }
  }
  return padded;
}

/// Nodes within kRimCells of measured ones get the mean of the tangent planes of those that are nearest.
void continue_by_slopes(const scene::Sheet& sheet, double spacing_m, Padded& padded) {
  const std::vector<float> measured = padded.height_m;
  for (int j = 0; j < padded.ny; ++j) {
    for (int i = 0; i < padded.nx; ++i) {
      if (std::isfinite(measured[padded.node(i, j)])) continue;
      int nearest = std::numeric_limits<int>::max();
      double sum = 0.0;
      int count = 0;
      for (int dj = -kMargin; dj <= kMargin; ++dj) {
        for (int di = -kMargin; di <= kMargin; ++di) {
          const int a = i + di - kMargin;
          const int b = j + dj - kMargin;
          if (a < 0 || b < 0 || a >= sheet.nx || b >= sheet.ny || !sheet.measured(sheet.index(a, b))) continue;
          const int squared = di * di + dj * dj;
          if (squared > nearest) continue;
          if (squared < nearest) nearest = squared, sum = 0.0, count = 0;
          const std::size_t node = sheet.index(a, b);
          sum += static_cast<double>(sheet.height_m[node]) -
                 spacing_m *
                     (di * static_cast<double>(sheet.slope_u[node]) + dj * static_cast<double>(sheet.slope_v[node]));
          ++count;
        }
      }
      if (count > 0) padded.height_m[padded.node(i, j)] = static_cast<float>(sum / count);
    }
  }
}

/// What is touched lies within a curved surface's nodes as mean over a cell: bilinear cells by 1/12 of the second
/// differences along both axes, rounded ones by 1/6. Nodes are moved out by the middle of both, but for those at the
/// sheet's border and at what bends as edges do.
void move_out(const scene::Sheet& sheet, double spacing_m, Padded& padded) {
  constexpr double kShare = 0.125;
  constexpr double kMostBend = 2.0;  // spacings, of a second difference
  constexpr int kBorder = 1;         // nodes
  const std::vector<float> before = padded.height_m;
  const auto bend_m = [&](std::size_t node, std::size_t step) {
    return static_cast<double>(before[node - step]) - 2.0 * static_cast<double>(before[node]) +
           static_cast<double>(before[node + step]);
  };
  const auto is_inner = [&](int i, int j) {
    for (int b = -kBorder; b <= kBorder; ++b)
      for (int a = -kBorder; a <= kBorder; ++a)
        if (!sheet.measured(sheet.index(i + a, j + b))) return false;
    return true;
  };
  for (int j = kBorder; j + kBorder < sheet.ny; ++j) {
    for (int i = kBorder; i + kBorder < sheet.nx; ++i) {
      if (!is_inner(i, j)) continue;
      const std::size_t node = padded.node(i + kMargin, j + kMargin);
      const double along_u = bend_m(node, 1);
      const double along_v = bend_m(node, static_cast<std::size_t>(padded.nx));
      if (std::max(std::abs(along_u), std::abs(along_v)) > kMostBend * spacing_m) continue;
      padded.height_m[node] -= static_cast<float>(kShare * (along_u + along_v));
    }
  }
}

/// How many cells a sheet is across.
struct Across {
  int nx, ny;
  [[nodiscard]] std::size_t cell(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
};

/// Cells within `reach` of cells that are set.
std::vector<std::uint8_t> grown(const Across& size, const std::vector<std::uint8_t>& cells, int reach,
                                bool beyond_is_set) {
  const int nx = size.nx;
  const int ny = size.ny;
  const auto pass = [&](const std::vector<std::uint8_t>& from, int di, int dj) {
    std::vector<std::uint8_t> to(from.size(), 0);
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        bool set = false;
        for (int k = -reach; k <= reach && !set; ++k) {
          const int a = i + k * di;
          const int b = j + k * dj;
          set = a < 0 || b < 0 || a >= nx || b >= ny ? beyond_is_set : from[size.cell(a, b)] != 0;
        }
        to[size.cell(i, j)] = set ? 1 : 0;
      }
    }
    return to;
  };
  return pass(pass(cells, 1, 0), 0, 1);
}

/// The curvature at a padded node, or where none is known there, the mean of those of the nearest nodes of the margin.
double curvature_about(const scene::Sheet& sheet, int i, int j) {
  if (sheet.curvature_per_m.empty()) return std::numeric_limits<double>::quiet_NaN();
  for (int reach = 0; reach <= kMargin; ++reach) {
    double sum = 0.0;
    int count = 0;
    for (int dj = -reach; dj <= reach; ++dj)
      for (int di = -reach; di <= reach; ++di) {
        const int a = i + di - kMargin, b = j + dj - kMargin;
        if (std::max(std::abs(di), std::abs(dj)) != reach || a < 0 || b < 0 || a >= sheet.nx || b >= sheet.ny) continue;
        const double k = static_cast<double>(sheet.curvature_per_m[sheet.index(a, b)]);
        if (!std::isfinite(k)) continue;
        sum += k;
        ++count;
      }
    if (count > 0) return sum / count;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

FrictionMap friction_of(const SheetSurface& surface, const scene::Sheet& sheet, const Padded& padded, double spacing_m,
                        const AroundFriction& friction) {
  FrictionMap result;
  result.mu_dynamic.reserve(padded.height_m.size());
  result.mu_static.reserve(padded.height_m.size());
  for (int j = 0; j < padded.ny; ++j)
    for (int i = 0; i < padded.nx; ++i) {
      const double height_m = static_cast<double>(padded.height_m[padded.node(i, j)]);
      std::array<float, 2> mu{static_cast<float>(friction.mu_dynamic), static_cast<float>(friction.mu_static)};
      if (std::isfinite(height_m))
        mu = friction.at(surface.to_object({i * spacing_m, j * spacing_m, height_m}), curvature_about(sheet, i, j));
      result.mu_dynamic.push_back(mu[0]);
      result.mu_static.push_back(std::max(mu[0], mu[1]));
    }
  return result;
}

/// Holes of at most 2 kRimCells cells are closed.
std::vector<std::uint8_t> closed(const Across& size, const std::vector<std::uint8_t>& cells) {
  std::vector<std::uint8_t> outside = grown(size, cells, kRimCells, false);
  for (std::uint8_t& cell : outside) cell = cell != 0 ? 0 : 1;
  outside = grown(size, outside, kRimCells, true);
  for (std::size_t k = 0; k < outside.size(); ++k) outside[k] = outside[k] == 0 || cells[k] != 0 ? 1 : 0;
  return outside;
}

/// The steepest that a cell is between its nodes, as the cosine of its normal and the sheet's direction; NaN where a
/// node is unknown.
double least_facing(const Padded& padded, int i, int j, double spacing_m) {
  const auto z = [&](int a, int b) {
    return static_cast<double>(padded.height_m[padded.node(i + a, j + b)]) / spacing_m;
  };
  double steepest = 0.0;
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l < 2; ++l) steepest = std::max(steepest, std::hypot(z(1, k) - z(0, k), z(l, 1) - z(l, 0)));
  }
  return std::isfinite(z(0, 0) + z(1, 0) + z(0, 1) + z(1, 1)) ? 1.0 / std::hypot(1.0, steepest)
                                                              : std::numeric_limits<double>::quiet_NaN();
}

/// Cells between two parts of a sheet that do not go on into each other.
std::vector<std::uint8_t> steps_of(const Padded& padded, double spacing_m) {
  std::vector<std::uint8_t> steps(padded.cells.size(), 0);
  for (int j = 0; j + 1 < padded.ny; ++j) {
    for (int i = 0; i + 1 < padded.nx; ++i) {
      const std::size_t cell = padded.cell(i, j);
      steps[cell] = padded.cells[cell] == 0 && least_facing(padded, i, j, spacing_m) < kStep ? 1 : 0;
    }
  }
  return steps;
}

/// Whether a part of the sheet ends near to where another begins at a different height.
bool has_step(const scene::Sheet& sheet, double spacing_m) {
  const auto is_cell = [&](int i, int j) {
    return i >= 0 && j >= 0 && (sheet.mask[sheet.index(i, j)] & scene::Sheet::kCell) != 0;
  };
  const double steepest = std::sqrt(1.0 / (kStep * kStep) - 1.0);
  // Along a row or column: from each measured node to the next one, unless a cell holds both.
  const auto steps_along = [&](int lines, int length, const auto& at, const auto& joined) {
    for (int line = 0; line < lines; ++line) {
      int last = -1;
      for (int k = 0; k < length; ++k) {
        if (!sheet.measured(at(line, k))) continue;
        const int apart = k - last;
        const bool near = last >= 0 && apart <= 2 * kRimCells && !(apart == 1 && joined(line, last));
        if (near) {
          const double rise =
              static_cast<double>(sheet.height_m[at(line, k)]) - static_cast<double>(sheet.height_m[at(line, last)]);
          if (std::abs(rise) > steepest * apart * spacing_m) return true;
        }
        last = k;
      }
    }
    return false;
  };
  return steps_along(
             sheet.ny, sheet.nx, [&](int j, int i) { return sheet.index(i, j); },
             [&](int j, int i) { return is_cell(i, j) || is_cell(i, j - 1); }) ||
         steps_along(
             sheet.nx, sheet.ny, [&](int i, int j) { return sheet.index(i, j); },
             [&](int i, int j) { return is_cell(i, j) || is_cell(i - 1, j); });
}

/// The nodes of columns and rows [i0, i1) x [j0, j1) whose `part` is this, in a box that holds them tightly.
scene::Sheet cut_out(const scene::Sheet& sheet, const std::vector<int>& parts, int part) {
  int i0 = sheet.nx, j0 = sheet.ny, i1 = 0, j1 = 0;
  for (int j = 0; j < sheet.ny; ++j) {
    for (int i = 0; i < sheet.nx; ++i) {
      if (parts[sheet.index(i, j)] != part) continue;
      i0 = std::min(i0, i), i1 = std::max(i1, i + 1);
      j0 = std::min(j0, j), j1 = std::max(j1, j + 1);
    }
  }
  scene::Sheet piece;
  piece.side = sheet.side;
  piece.first_u = sheet.first_u + i0;
  piece.first_v = sheet.first_v + j0;
  piece.nx = i1 - i0;
  piece.ny = j1 - j0;
  const auto is_part = [&](int i, int j) { return i < i1 && j < j1 && parts[sheet.index(i, j)] == part; };
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) {
      const std::size_t node = sheet.index(i, j);
      const bool mine = is_part(i, j);
      const bool cell = mine && is_part(i + 1, j) && is_part(i, j + 1) && is_part(i + 1, j + 1);
      piece.height_m.push_back(mine ? sheet.height_m[node] : scene::kUnknownHeight);
      piece.slope_u.push_back(mine ? sheet.slope_u[node] : scene::kUnknownHeight);
      piece.slope_v.push_back(mine ? sheet.slope_v[node] : scene::kUnknownHeight);
      const unsigned kept = cell ? sheet.mask[node] : sheet.mask[node] & ~unsigned{scene::Sheet::kCell};
      piece.mask.push_back(mine ? static_cast<std::uint8_t>(kept) : std::uint8_t{0});
      if (!sheet.texture_m.empty()) piece.texture_m.push_back(mine ? sheet.texture_m[node] : scene::kUnknownHeight);
      if (!sheet.curvature_per_m.empty())
        piece.curvature_per_m.push_back(mine ? sheet.curvature_per_m[node] : scene::kUnknownHeight);
    }
  }
  return piece;
}

/// The connected parts of a sheet between two columns or rows: nodes that share cells.
std::vector<scene::Sheet> parts_of(const scene::Sheet& sheet, int i0, int i1, int j0, int j1) {
  std::vector<int> parts(sheet.count(), -1);
  std::vector<std::size_t> open;
  int count = 0;
  const auto is_cell = [&](int i, int j) {
    return i >= i0 && j >= j0 && i + 1 < i1 && j + 1 < j1 && (sheet.mask[sheet.index(i, j)] & scene::Sheet::kCell) != 0;
  };
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) {
      if (!is_cell(i, j) || parts[sheet.index(i, j)] >= 0) continue;
      open.assign(1, sheet.index(i, j));
      parts[open.front()] = count;
      while (!open.empty()) {
        const int a = static_cast<int>(open.back()) % sheet.nx;
        const int b = static_cast<int>(open.back()) / sheet.nx;
        open.pop_back();
        for (int dj = -1; dj <= 0; ++dj) {
          for (int di = -1; di <= 0; ++di) {
            if (!is_cell(a + di, b + dj)) continue;
            for (int corner = 0; corner < 4; ++corner) {
              const std::size_t node = sheet.index(a + di + corner % 2, b + dj + corner / 2);
              if (parts[node] >= 0) continue;
              parts[node] = count;
              open.push_back(node);
            }
          }
        }
      }
      ++count;
    }
  }
  std::vector<scene::Sheet> pieces;
  for (int part = 0; part < count; ++part) pieces.push_back(cut_out(sheet, parts, part));
  return pieces;
}

}  // namespace

std::array<std::int32_t, 2> recorded_cell(const SheetSurface& sheet, const Eigen::Vector3d& object_m,
                                          double spacing_m) noexcept {
  constexpr std::int32_t kSheetCells = 1 << 16;
  constexpr std::uint32_t kSheetNumbers = 1U << 15;
  const Eigen::Vector3d chart_m = sheet.axes.to_chart(object_m);
  const auto cell = [&](double place_m) {
    const double at = std::floor(place_m / spacing_m) + kSheetCells / 2;
    return static_cast<std::int32_t>(std::clamp(at, 0.0, kSheetCells - 1.0));
  };
  return {static_cast<std::int32_t>(sheet.number % kSheetNumbers) * kSheetCells + cell(chart_m.x()), cell(chart_m.y())};
}

SheetSurface make_sheet_surface(const scene::Charts& charts, const scene::Sheet& sheet,
                                const AroundFriction& friction) {
  Padded padded = pad(sheet);
  continue_by_slopes(sheet, charts.spacing_m, padded);
  move_out(sheet, charts.spacing_m, padded);
  const std::vector<std::uint8_t> steps = steps_of(padded, charts.spacing_m);
  const Across across{padded.nx - 1, padded.ny - 1};
  std::vector<std::uint8_t> trusted = closed(across, padded.cells);
  for (std::size_t k = 0; k < trusted.size(); ++k) trusted[k] = steps[k] == 0 ? trusted[k] : 0;
  std::vector<std::uint8_t> rim = grown(across, trusted, kRimCells, false);
  for (std::size_t k = 0; k < rim.size(); ++k) rim[k] = steps[k] == 0 ? rim[k] : 0;
  SheetSurface result;
  result.axes = scene::SideAxes::of(sheet.side);
  result.corner_m = {(sheet.first_u - kMargin) * charts.spacing_m, (sheet.first_v - kMargin) * charts.spacing_m, 0.0};
  result.cells.resize(trusted.size());
  for (std::size_t k = 0; k < trusted.size(); ++k)
    result.cells[k] = trusted[k] != 0 ? kOpenCell : rim[k] != 0 ? kRimCell : kNoCell;
  SurfaceParts parts;
  parts.lattice = {padded.nx, padded.ny, charts.spacing_m, Eigen::Vector3d::Zero()};
  if (friction.at) {
    parts.friction = friction_of(result, sheet, padded, charts.spacing_m, friction);
  } else if (friction.mu_static > 0.0) {
    parts.friction.mu_dynamic.assign(padded.height_m.size(), static_cast<float>(friction.mu_dynamic));
    parts.friction.mu_static.assign(padded.height_m.size(),
                                    static_cast<float>(std::max(friction.mu_static, friction.mu_dynamic)));
  }
  parts.cell_flags.resize(trusted.size());
  for (std::size_t k = 0; k < trusted.size(); ++k)
    parts.cell_flags[k] = padded.cells[k] != 0 ? 0 : trusted[k] != 0 ? kCellFilled : kCellUnknown;
  parts.height_m = std::move(padded.height_m);
  result.surface = make_surface(std::move(parts));
  return result;
}

std::vector<std::uint8_t> close_holes(const SheetSurface& sheet, const std::vector<std::uint8_t>& cells) {
  std::vector<std::uint8_t> measured(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) measured[k] = cells[k] >= kLookCell ? 1 : 0;
  return closed({sheet.surface->lattice.nx - 1, sheet.surface->lattice.ny - 1}, measured);
}

SheetView view_of(const SheetSurface& sheet, const Eigen::Vector3d& object_m) noexcept {
  SheetView view;
  const MongeSurface& surface = *sheet.surface;
  const Eigen::Vector3d local = sheet.to_local(object_m);
  const double cells_per_m = 1.0 / surface.lattice.spacing_m;
  const double x = local.x() * cells_per_m;
  const double y = local.y() * cells_per_m;
  if (!(x >= 0.0 && y >= 0.0 && x < surface.lattice.nx - 1 && y < surface.lattice.ny - 1)) return view;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  view.cell = sheet.cell(i, j);
  if (view.cell == kNoCell) return view;
  const float* low = surface.height_m.data() + surface.lattice.index(i, j);
  const float* high = low + surface.lattice.nx;
  const double z = low[0];
  const double a = static_cast<double>(low[1]) - z;
  const double b = static_cast<double>(high[0]) - z;
  const double c = static_cast<double>(high[1]) - static_cast<double>(high[0]) - a;
  const double s = x - i;
  const double t = y - j;
  const double height = z + s * a + t * (b + s * c);
  const double fs = (a + c * t) * cells_per_m;
  const double ft = (b + c * s) * cells_per_m;
  view.facing = 1.0 / std::sqrt(1.0 + fs * fs + ft * ft);
  view.gap_m = (local.z() - height) * view.facing;
  view.local = {local.x(), local.y(), height};
  view.normal = sheet.turn_to_object(Eigen::Vector3d(-fs * view.facing, -ft * view.facing, view.facing));
  return view;
}

std::vector<scene::Sheet> pieces_of(const scene::Sheet& sheet, double spacing_m) {
  std::vector<scene::Sheet> done;
  std::vector<scene::Sheet> left{sheet};
  while (!left.empty()) {
    const scene::Sheet next = std::move(left.back());
    left.pop_back();
    if (std::max(next.nx, next.ny) <= kSmallest || !has_step(next, spacing_m)) {
      done.push_back(next);
      continue;
    }
    const bool across = next.nx >= next.ny;
    const int middle = (across ? next.nx : next.ny) / 2;
    const int low = middle + kOverlap / 2;
    const int high = middle - kOverlap / 2;
    for (scene::Sheet& piece : parts_of(next, 0, across ? low : next.nx, 0, across ? next.ny : low))
      left.push_back(std::move(piece));
    for (scene::Sheet& piece : parts_of(next, across ? high : 0, next.nx, across ? 0 : high, next.ny))
      left.push_back(std::move(piece));
  }
  return done;
}

}  // namespace sparsha::haptics

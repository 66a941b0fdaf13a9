#include "audio/scrape/object_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "audio/scrape/catmull_rom.h"
#include "scene/scene.h"

namespace sparsha::audio {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kStays = 0.5;    // cosine of 60 degrees: so far a needle stays on its sheet
constexpr double kOnSheet = 3.0;  // spacings along a side: a place is on a sheet

}  // namespace

ObjectProfile::ObjectProfile(scene::ScenePointer scene, bool texture, std::shared_ptr<const scene::GrainField> grain)
    : scene_(std::move(scene)),
      charts_(*scene_->description().charts),
      texture_(texture),
      grain_(scene_->description(), std::move(grain)) {}

const Eigen::Vector3d& ObjectProfile::origin_m() const noexcept { return charts_.origin_m; }

std::optional<ObjectProfile::Cell> ObjectProfile::cell_at(const scene::Sheet& sheet,
                                                          const Eigen::Vector3d& place_m) const noexcept {
  const Eigen::Vector3d in_chart = scene::SideAxes::of(sheet.side).to_chart(place_m);
  const double u = in_chart.x() / charts_.spacing_m - sheet.first_u;
  const double v = in_chart.y() / charts_.spacing_m - sheet.first_v;
  if (!(u >= 0.0 && v >= 0.0 && u <= sheet.nx - 1 && v <= sheet.ny - 1) || sheet.nx < 2 || sheet.ny < 2)
    return std::nullopt;
  Cell cell;
  cell.i = std::min(static_cast<int>(u), sheet.nx - 2);
  cell.j = std::min(static_cast<int>(v), sheet.ny - 2);
  cell.s = u - cell.i;
  cell.t = v - cell.j;
  cell.w_m = in_chart.z();
  return cell;
}

double ObjectProfile::node_m(const scene::Sheet& sheet, std::size_t node) const noexcept {
  return static_cast<double>(texture_ || sheet.texture_m.empty() ? sheet.height_m[node] : sheet.envelope_m(node));
}

/// Of a place on the sheet; empty where it is not on it.
std::optional<double> ObjectProfile::facing_of(const scene::Sheet& sheet,
                                               const Eigen::Vector3d& place_m) const noexcept {
  const std::optional<Cell> cell = cell_at(sheet, place_m);
  if (!cell || (sheet.mask[sheet.index(cell->i, cell->j)] & scene::Sheet::kCell) == 0) return std::nullopt;
  const auto height = [&](int i, int j) { return node_m(sheet, sheet.index(cell->i + i, cell->j + j)); };
  const double low_m = std::min({height(0, 0), height(1, 0), height(0, 1), height(1, 1)});
  const double high_m = std::max({height(0, 0), height(1, 0), height(0, 1), height(1, 1)});
  const double slack_m = kOnSheet * charts_.spacing_m;
  if (!(cell->w_m >= low_m - slack_m && cell->w_m <= high_m + slack_m)) return std::nullopt;
  return in_chart_normal(sheet, *cell).z();
}

std::size_t ObjectProfile::sheet_at(const Eigen::Vector3d& place_m, std::size_t last) const noexcept {
  const std::vector<scene::Sheet>& sheets = charts_.sheets;
  if (last < sheets.size() && facing_of(sheets[last], place_m).value_or(0.0) >= kStays) return last;
  std::size_t best = last;
  double most = 0.0;
  for (std::size_t sheet = 0; sheet < sheets.size(); ++sheet) {
    const double facing = facing_of(sheets[sheet], place_m).value_or(0.0);
    if (facing <= most) continue;
    most = facing;
    best = sheet;
  }
  return best;
}

double ObjectProfile::height_m(std::size_t number, const Eigen::Vector3d& place_m) const noexcept {
  if (number >= charts_.sheets.size()) return kNan;
  const scene::Sheet& sheet = charts_.sheets[number];
  const std::optional<Cell> cell = cell_at(sheet, place_m);
  if (!cell) return kNan;
  const auto measured = [&](int i, int j) {
    return i >= 0 && j >= 0 && i < sheet.nx && j < sheet.ny && sheet.measured(sheet.index(i, j));
  };
  // Where a node is missing the cell's own one beside it goes on.
  const auto node = [&](int a, int b) {
    for (const auto& [i, j] : {std::pair(a, b), std::pair(std::clamp(a, 0, 1), b), std::pair(a, std::clamp(b, 0, 1)),
                               std::pair(std::clamp(a, 0, 1), std::clamp(b, 0, 1))})
      if (measured(cell->i + i, cell->j + j)) return node_m(sheet, sheet.index(cell->i + i, cell->j + j));
    return kNan;
  };
  const auto in_u = catmull_rom(cell->s);
  const auto in_v = catmull_rom(cell->t);
  double height_m = 0.0;
  for (int b = 0; b < 4; ++b) {
    double sum_m = 0.0;
    for (int a = 0; a < 4; ++a) sum_m += in_u[static_cast<std::size_t>(a)] * node(a - 1, b - 1);
    height_m += in_v[static_cast<std::size_t>(b)] * sum_m;
  }
  return height_m;
}

/// Between the nodes of a cell that are measured, in the frame of its side; along the side where none is.
Eigen::Vector3d ObjectProfile::in_chart_normal(const scene::Sheet& sheet, const Cell& cell) const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int b = 0; b <= 1; ++b)
    for (int a = 0; a <= 1; ++a) {
      const std::size_t node = sheet.index(cell.i + a, cell.j + b);
      if (!sheet.measured(node)) continue;
      const double share = (a == 0 ? 1.0 - cell.s : cell.s) * (b == 0 ? 1.0 - cell.t : cell.t);
      const Eigen::Vector3d normal(-static_cast<double>(sheet.slope_u[node]), -static_cast<double>(sheet.slope_v[node]),
                                   1.0);
      sum += share * normal.normalized();
    }
  return sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

double ObjectProfile::facing(std::size_t number, const Eigen::Vector3d& place_m) const noexcept {
  if (number >= charts_.sheets.size()) return 1.0;
  const std::optional<Cell> cell = cell_at(charts_.sheets[number], place_m);
  return cell ? in_chart_normal(charts_.sheets[number], *cell).z() : 1.0;
}

double ObjectProfile::grain_m(std::size_t number, const Eigen::Vector3d& place_m, double per_sample_m,
                              double shortest_m) const noexcept {
  if (number >= charts_.sheets.size()) return 0.0;
  const scene::Sheet& sheet = charts_.sheets[number];
  const std::optional<Cell> cell = cell_at(sheet, place_m);
  if (!cell) return 0.0;
  const Eigen::Vector3d normal = scene::SideAxes::of(sheet.side).to_grid(in_chart_normal(sheet, *cell));
  return grain_.height_m(charts_.origin_m + place_m, &normal, per_sample_m, shortest_m);
}

}  // namespace sparsha::audio

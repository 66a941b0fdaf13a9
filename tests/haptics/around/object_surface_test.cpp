// What an object that is touched knows of its sheets, before anything touches it.
#include "haptics/around/object_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"
#include "tests/support/wandering_hand.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::test {
namespace {

using Eigen::Vector3d;

TEST(Around, EveryBlockKnowsBetweenWhichPlanesItsSheetsLie) {
  const Touched on = touched("knot", make_knot());
  const haptics::ObjectSurface& object = *on.surface;
  std::size_t cells = 0, apart = 0, above = 0;
  for (std::size_t s = 0; s < object.sheets.size(); ++s) {
    const haptics::SheetSurface& sheet = object.sheets[s];
    const scene::Lattice& lattice = sheet.surface->lattice;
    for (int j = 0; j + 1 < lattice.ny; ++j)
      for (int i = 0; i + 1 < lattice.nx; ++i) {
        if (sheet.cell(i, j) < haptics::kLookCell) continue;
        const double x = (i + 0.3) * on.h, y = (j + 0.6) * on.h;
        const Vector3d at = sheet.to_object({x, y, touched_height(*sheet.surface, x, y, haptics::CellShape::rounded)});
        const Vector3d outside = at + 3.0 * on.h * view_of(sheet, at).normal;
        ++cells;
        bool found = false;
        for (const haptics::Passing& passing : object.blocks.sheets_at(at)) {
          if (passing.sheet != s) continue;
          found = true;
          apart += passing.is_apart(at, at, 1e-3 * on.h) ? 1 : 0;
          above += passing.is_apart(outside, outside, on.h) ? 1 : 0;
        }
        ASSERT_TRUE(found);
      }
  }
  EXPECT_GT(cells, 10'000U);
  EXPECT_EQ(apart, 0U);
  EXPECT_GT(above, cells / 2) << "planes that are of use";
}

TEST(Around, CellsOfTwoPiecesOfASheetAreRecordedAsTwo) {
  // A ramp that goes once around its middle and ends beside its beginning, higher.
  constexpr double kSpacing = 0.001;
  const auto angle = [](double u, double v) { return std::atan2(-v, -u) + std::numbers::pi; };
  scene::Charts charts = charts_of(
      [&](scene::Side side, double u, double v) -> std::optional<SeenSurface> {
        const double radius = std::hypot(u, v);
        if (side != scene::Side::front || radius < 0.02 || radius > 0.04) return std::nullopt;
        const double rise = 0.01;
        return SeenSurface{rise * angle(u, v), -rise * v / (radius * radius), rise * u / (radius * radius)};
      },
      41, kSpacing);
  std::erase_if(charts.sheets, [](const scene::Sheet& sheet) { return sheet.side != scene::Side::front; });
  scene::Sheet& ramp = charts.sheets[0];
  const auto here = [&](int i, int j) { return angle((ramp.first_u + i) * kSpacing, (ramp.first_v + j) * kSpacing); };
  for (int j = 0; j + 1 < ramp.ny; ++j)
    for (int i = 0; i + 1 < ramp.nx; ++i) {
      const auto [low, high] = std::minmax({here(i, j), here(i + 1, j), here(i, j + 1), here(i + 1, j + 1)});
      if (high - low > 1.0) ramp.mask[ramp.index(i, j)] &= scene::Sheet::kMeasured;
    }
  const auto object = haptics::make_object_surface(charts);
  ASSERT_GE(object->sheets.size(), 2U) << "the ramp is cut";
  std::map<std::array<std::int32_t, 2>, Eigen::Vector3d> places;
  for (const haptics::SheetSurface& sheet : object->sheets) {
    const scene::Lattice& lattice = sheet.surface->lattice;
    for (int j = 0; j + 1 < lattice.ny; ++j)
      for (int i = 0; i + 1 < lattice.nx; ++i) {
        if (sheet.cell(i, j) < haptics::kLookCell) continue;
        const double u = (i + 0.5) * kSpacing, v = (j + 0.5) * kSpacing;
        const Eigen::Vector3d at = sheet.to_object({u, v, sheet.surface->height(u, v)});
        const auto [known, fresh] = places.emplace(haptics::recorded_cell(sheet, at, kSpacing), at);
        EXPECT_LT((known->second - at).head<2>().norm(), kSpacing);
      }
  }
  EXPECT_NEAR(static_cast<double>(places.size()), std::numbers::pi * (40.0 * 40.0 - 20.0 * 20.0), 500.0);
}

TEST(Around, WithoutASheetThereIsNothingToTouch) { EXPECT_THROW((void)haptics::make_object_surface({}), Error); }

}  // namespace
}  // namespace sparsha::test

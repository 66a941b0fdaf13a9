// Boxes, polygons and labels as places: against brute force that shares no code with them.
#include "scene/area/area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "scene/area/region_frame.h"
#include "tests/support/sanitized.h"

namespace sparsha::scene {
namespace {

using Corners = std::vector<std::array<double, 2>>;

/// Edges that a ray in an odd direction crosses, by Cramer's rule in long double.
bool oracle_holds(const Corners& corners, double x, double y) {
  const long double angle = 1.2345678901234567L;
  const long double rx = std::cos(angle), ry = std::sin(angle);
  int crossings = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto& a = corners[k];
    const auto& b = corners[(k + 1) % corners.size()];
    const long double ex = static_cast<long double>(b[0]) - a[0], ey = static_cast<long double>(b[1]) - a[1];
    const long double ax = static_cast<long double>(a[0]) - x, ay = static_cast<long double>(a[1]) - y;
    const long double determinant = ex * ry - ey * rx;
    if (determinant == 0.0L) continue;
    const long double along_edge = (rx * ay - ry * ax) / determinant;
    const long double along_ray = (ex * ay - ey * ax) / determinant;
    crossings += along_edge >= 0.0L && along_edge < 1.0L && along_ray > 0.0L;
  }
  return crossings % 2 == 1;
}

/// By the angle under which each edge is seen: of the corners and the feet of perpendiculars.
double oracle_distance(const Corners& corners, double x, double y) {
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto& a = corners[k];
    const auto& b = corners[(k + 1) % corners.size()];
    const double to_a = std::hypot(a[0] - x, a[1] - y), to_b = std::hypot(b[0] - x, b[1] - y);
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    least = std::min({least, to_a, to_b});
    // Both angles at the edge are acute: the foot lies on it.
    if (to_a * to_a + length * length > to_b * to_b && to_b * to_b + length * length > to_a * to_a) {
      const double area = std::abs((a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y));
      least = std::min(least, area / length);
    }
  }
  return least;
}

Corners star(int corners, double outer, double inner, double x = 0.0, double y = 0.0) {
  Corners result;
  for (int k = 0; k < corners; ++k) {
    const double angle = 0.1 + 2.0 * std::numbers::pi * k / corners;
    const double radius = k % 2 == 0 ? outer : inner;
    result.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return result;
}

/// Teeth from the left to the right, one above the other.
Corners comb(int teeth) {
  Corners result{{-0.1, 0.0}};
  for (int k = 0; k < teeth; ++k) {
    const double y = static_cast<double>(k) / teeth;
    result.push_back({1.0 + 0.01 * (k % 7), y});
    result.push_back({0.01 * (k % 5), y + 0.5 / teeth});
  }
  result.push_back({-0.1, 1.0});
  return result;
}

Corners scribble(int corners, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Corners result;
  for (int k = 0; k < corners; ++k) result.push_back({unit(random), unit(random)});
  return result;
}

std::vector<std::pair<const char*, Corners>> shapes() {
  const Corners el{{0, 0}, {1, 0}, {1, 0.3}, {0.3, 0.3}, {0.3, 1}, {0, 1}};
  Corners backwards = el;
  std::reverse(backwards.begin(), backwards.end());
  Corners far = el;
  for (auto& corner : far) corner = {corner[0] + 4.5e6, corner[1] - 5.5e6};
  return {{"an L", el},
          {"backwards", backwards},
          {"in national coordinates", far},
          {"a triangle", {{0, 0}, {1, 0.1}, {0.4, 0.9}}},
          {"a notch", {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.2}, {0, 1}}},
          {"the first corner once more", {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}},
          {"a bow tie", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}},
          {"an hourglass", {{0, 0}, {1, 0}, {0, 1}, {1, 1}}},
          {"a pentagram", {{0.5, 1}, {0.8, 0}, {0, 0.62}, {1, 0.62}, {0.2, 0}}},
          {"a star of a thousand corners", star(1000, 1.0, 0.6)},
          {"a disc of a thousand corners", star(1000, 1.0, 1.0)},
          {"a comb", comb(499)},
          {"a scribble", scribble(40, 1)},
          {"a thick scribble", scribble(1000, 2)}};
}

std::array<double, 4> bounds_of(const Corners& corners) {
  std::array<double, 4> b{corners[0][0], corners[0][1], corners[0][0], corners[0][1]};
  for (const auto& c : corners)
    b = {std::min(b[0], c[0]), std::min(b[1], c[1]), std::max(b[2], c[0]), std::max(b[3], c[1])};
  return b;
}

TEST(Polygon, HoldsWhatLiesBehindAnOddNumberOfItsEdges) {
  std::mt19937 random(11);
  for (const auto& [name, corners] : shapes()) {
    const Polygon polygon(corners);
    const auto b = bounds_of(corners);
    std::uniform_real_distribution<double> x(b[0] - 0.1 * (b[2] - b[0]), b[2] + 0.1 * (b[2] - b[0]));
    std::uniform_real_distribution<double> y(b[1] - 0.1 * (b[3] - b[1]), b[3] + 0.1 * (b[3] - b[1]));
    const double rounding = 1e-13 * std::max(std::abs(b[2]), std::abs(b[1]));
    int inside = 0;
    const int places = corners.size() > 100 ? 4000 : 20000;
    for (int k = 0; k < places; ++k) {
      const double px = x(random);
      // Also at the very height of a corner.
      const double py = k % 4 == 0 ? corners[static_cast<std::size_t>(k) % corners.size()][1] : y(random);
      if (oracle_distance(corners, px, py) <= rounding) continue;
      ASSERT_EQ(polygon.holds(px, py), oracle_holds(corners, px, py)) << name << ' ' << px << ' ' << py;
      inside += polygon.holds(px, py) ? 1 : 0;
    }
    EXPECT_GT(inside, places / 40) << name;
  }
}

TEST(Polygon, DistancesAreThoseToTheNearestEdge) {
  std::mt19937 random(12);
  for (const auto& [name, corners] : shapes()) {
    const Polygon polygon(corners);
    const auto b = bounds_of(corners);
    std::uniform_real_distribution<double> x(b[0] - 0.5, b[2] + 0.5), y(b[1] - 0.5, b[3] + 0.5);
    const double rounding = 1e-12 + 4e-16 * std::abs(b[1]) * 100.0;
    for (int k = 0; k < 2000; ++k) {
      const double px = x(random), py = y(random);
      const double truth = oracle_distance(corners, px, py);
      // The oracle's areas lose half of the digits on short edges.
      ASSERT_NEAR(polygon.to_border_m(px, py, HUGE_VAL), truth, rounding + 1e-9) << name;
      ASSERT_EQ(polygon.to_border_m(px, py, 0.9 * truth), 0.9 * truth) << name << ": no farther than asked";
    }
  }
}

TEST(Polygon, ThePlaceToGoToLiesInside) {
  for (const auto& [name, corners] : shapes()) {
    const Area area(std::make_shared<const Polygon>(corners));
    ASSERT_TRUE(area.middle_m()) << name;
    EXPECT_TRUE(oracle_holds(corners, area.middle_m()->x(), area.middle_m()->y())) << name;
  }
  const Area notched(std::make_shared<const Polygon>(Corners{{0, 0}, {1, 0}, {1, 1}, {0.5, 0.2}, {0, 1}}));
  EXPECT_FALSE(notched.holds(0.5, 0.5)) << "the middle of its box lies in the notch";
}

TEST(Polygon, WithoutAnAreaIsNowhere) {
  const std::vector<Corners> cases = {{},
                                      {{1, 1}},
                                      {{0, 0}, {1, 1}},
                                      {{0, 0}, {1, 0}, {2, 0}},
                                      {{0, 0}, {1, 1}, {2, 0}, {1, 1}},
                                      {{3, 3}, {3, 3}, {3, 3}},
                                      {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 0}, {1, 1}}};
  for (const Corners& corners : cases) {
    const Area area(std::make_shared<const Polygon>(corners));
    EXPECT_FALSE(area.bounds_m());
    EXPECT_FALSE(area.middle_m());
    EXPECT_FALSE(area.holds(0.5, 0.25));
    EXPECT_EQ(area.share_inside(0.5, 0.25, 0.01), 0.0);
    EXPECT_LT(area.inside_m(0.5, 0.25), 0.0);
  }
}

TEST(Polygon, WithAHoleAndAWayToItHasNoBorderAlongTheWay) {
  const Corners ring{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
  const Area area(std::make_shared<const Polygon>(ring));
  EXPECT_FALSE(area.holds(2.0, 2.0));
  EXPECT_TRUE(area.holds(0.5, 2.0));
  EXPECT_EQ(area.share_inside(0.5, 0.5, 0.4), 1.0) << "on the way from the corner to the hole";
}

TEST(Area, OfAPolygonIsThatOfTheSameBoxButOutsideItsCorners) {
  const Area box(0.25, -1.0, 0.75, 2.0);
  const Area polygon(std::make_shared<const Polygon>(Corners{{0.25, -1}, {0.75, -1}, {0.75, 2}, {0.25, 2}}));
  constexpr double kWidth = 0.1;
  std::mt19937 random(13);
  std::uniform_real_distribution<double> x(0.1, 0.9), y(-1.2, 2.2);
  for (int k = 0; k < 50000; ++k) {
    const double px = x(random), py = y(random);
    EXPECT_EQ(box.share_inside(px, py, kWidth), share_inside({0.25, -1.0, 0.75, 2.0}, px, py, kWidth));
    EXPECT_EQ(box.holds(px, py), polygon.holds(px, py));
    const bool corner = (px < 0.25 || px > 0.75) && (py < -1.0 || py > 2.0);
    const double difference = polygon.share_inside(px, py, kWidth) - box.share_inside(px, py, kWidth);
    if (corner) {
      EXPECT_LE(difference, 1e-15);
      EXPECT_GE(difference, -0.1) << "a disc and a square of half a border";
    } else {
      EXPECT_NEAR(difference, 0.0, 1e-14);
    }
  }
  EXPECT_EQ(*polygon.middle_m(), *box.middle_m());
  EXPECT_EQ(*polygon.bounds_m(), *box.bounds_m());
  EXPECT_EQ(polygon.area_m2(), box.area_m2());
}

TEST(Area, FadesAcrossAPolygonsBorderWithoutAJumpHalfOnTheBorderItself) {
  std::mt19937 random(14);
  for (const auto& [name, corners] : shapes()) {
    const Area area(std::make_shared<const Polygon>(corners));
    const auto b = bounds_of(corners);
    const double width = 0.05;
    std::uniform_real_distribution<double> x(b[0] - 0.1, b[2] + 0.1), y(b[1] - 0.1, b[3] + 0.1);
    for (int k = 0; k < 500; ++k) {
      double px = x(random), py = y(random);
      double last = area.share_inside(px, py, width);
      for (int step = 0; step < 20; ++step) {
        px += 0.001, py -= 0.0005;
        const double here = area.share_inside(px, py, width);
        // Of the cubic the steepest is 1.5 in its middle.
        ASSERT_LE(std::abs(here - last), 1.5 * std::hypot(0.001, 0.0005) / width + 1e-9) << name;
        ASSERT_EQ(here > 0.5, here == 0.5 ? false : area.holds(px, py)) << name;
        if (oracle_distance(corners, px, py) > 0.5 * width) {
          ASSERT_EQ(here, area.holds(px, py) ? 1.0 : 0.0) << name;
        }
        last = here;
      }
    }
  }
}

TEST(Area, OfPlacesThatAreNoNumbersHoldsNothing) {
  const double nan = std::nan("");
  auto map = std::make_shared<LabelMap>();
  *map = {2, 2, {1, 1, 1, 1}, {0, 0, 1, 1}};
  for (const Area& area : {Area(), Area(0, 0, 1, 1), Area(std::make_shared<const Polygon>(star(50, 1.0, 0.4))),
                           Area(std::make_shared<const LabelArea>(map, 1))}) {
    for (const auto& [x, y] : {std::pair(nan, 0.5), {0.5, nan}, {HUGE_VAL, 0.5}, {0.5, -HUGE_VAL}}) {
      EXPECT_FALSE(area.holds(x, y));
      if (area.box() != nullptr) continue;
      EXPECT_EQ(area.share_inside(x, y, 0.1), 0.0);
    }
  }
}

/// A picture from its rows, top first; ' ' is 0.
std::shared_ptr<const LabelMap> picture(const std::vector<std::string>& rows, const std::array<double, 4>& bounds_m) {
  auto map = std::make_shared<LabelMap>();
  map->height = static_cast<int>(rows.size());
  map->width = static_cast<int>(rows.front().size());
  map->bounds_m = bounds_m;
  for (const std::string& row : rows)
    for (const char c : row) map->values.push_back(c == ' ' ? 0 : static_cast<std::uint16_t>(c - '0'));
  return map;
}

/// A blob with a hole and an island, 120 x 90 pixels of 1 mm, with its corner at (2, -3).
std::shared_ptr<const LabelMap> blobs() {
  auto map = std::make_shared<LabelMap>();
  *map = {120, 90, std::vector<std::uint16_t>(120 * 90, 0), {2.0, -3.0, 2.12, -2.91}};
  for (int row = 0; row < 90; ++row)
    for (int column = 0; column < 120; ++column) {
      const double wobble = 25.0 + 5.0 * std::sin(5.0 * std::atan2(row - 40.0, column - 45.0));
      const double r = std::hypot(column - 45.0, row - 40.0);
      const bool inside = (r < wobble && r > 8.0) || (column >= 90 && column < 110 && row >= 60 && row < 75);
      map->values[static_cast<std::size_t>(row * 120 + column)] = inside ? 7 : (column + row) % 3 == 0 ? 4 : 0;
    }
  return map;
}

/// From a place to the nearest pixel that has the label, or has not, as squares; outside the picture none has it.
double oracle_to_pixels(const LabelMap& map, int label, bool with, double x, double y) {
  const double w = (map.bounds_m[2] - map.bounds_m[0]) / map.width,
               h = (map.bounds_m[3] - map.bounds_m[1]) / map.height;
  double least = HUGE_VAL;
  for (int row = -1; row <= map.height; ++row)
    for (int column = -1; column <= map.width; ++column) {
      const bool beyond = row < 0 || column < 0 || row == map.height || column == map.width;
      const bool has = !beyond && map.values[static_cast<std::size_t>(row * map.width + column)] == label;
      if (has != with) continue;
      const double left = map.bounds_m[0] + column * w, top = map.bounds_m[3] - row * h;
      least =
          std::min(least, std::hypot(std::max({left - x, 0.0, x - left - w}), std::max({top - h - y, 0.0, y - top})));
    }
  return least;
}

TEST(LabelArea, DistancesAreThoseToThePixelsWithinAPixel) {
  const auto map = blobs();
  const LabelArea area(map, 7);
  std::mt19937 random(15);
  std::uniform_real_distribution<double> x(2.0, 2.12), y(-3.0, -2.91);
  for (int k = 0; k < 1500; ++k) {
    const double px = x(random), py = y(random);
    const double inside = oracle_to_pixels(*map, 7, false, px, py);
    const double outside = oracle_to_pixels(*map, 7, true, px, py);
    ASSERT_EQ(area.holds(px, py), outside == 0.0);
    const double truth = inside > 0.0 ? inside : -outside;
    if (std::abs(truth) > 0.0024) {
      EXPECT_EQ(area.inside_m(px, py) > 0.0, truth > 0.0);
      EXPECT_GT(std::abs(area.inside_m(px, py)), 0.0015);
    } else {
      EXPECT_NEAR(area.inside_m(px, py), truth, 0.00075) << px << ' ' << py;
    }
  }
}

TEST(LabelArea, IsExactAlongStraightBordersAndGoesOnSmoothlyFarAway) {
  const auto map = picture({"      ", " 1111 ", " 1111 ", " 1111 ", " 1111 ", "      "}, {0, 0, 0.6, 0.6});
  const LabelArea area(map, 1);
  for (double x = 0.11; x < 0.25; x += 0.013) EXPECT_NEAR(area.inside_m(x, 0.31), x - 0.1, 1e-7) << x;
  for (double x = 0.05; x < 0.15; x += 0.003) EXPECT_NEAR(area.inside_m(x, 0.31), x - 0.1, 1e-7) << x;
  double last = area.inside_m(-3.0, 0.31);
  for (double x = -3.0; x < 3.5; x += 0.01) {
    const double here = area.inside_m(x, 0.31);
    EXPECT_LE(std::abs(here - last), 0.01 + 1e-6) << x;
    last = here;
  }
  EXPECT_NEAR(area.inside_m(-3.0, 0.31), -3.1, 0.05);
  EXPECT_EQ(Area(std::make_shared<const LabelArea>(map, 1)).share_inside(-3.0, 0.31, 0.01), 0.0);
}

TEST(LabelArea, FadesWithoutAJumpAndIsNowhereWithoutAPixel) {
  const auto map = blobs();
  const Area area(std::make_shared<const LabelArea>(map, 7));
  std::mt19937 random(16);
  std::uniform_real_distribution<double> x(1.99, 2.13), y(-3.01, -2.90);
  constexpr double kWidth = 0.004;
  for (int k = 0; k < 2000; ++k) {
    const double px = x(random), py = y(random);
    const double step = area.share_inside(px + 1e-5, py, kWidth) - area.share_inside(px, py, kWidth);
    ASSERT_LE(std::abs(step), 1.5 * 1e-5 / kWidth * 1.5) << "bilinear between samples";
  }
  const Area nowhere(std::make_shared<const LabelArea>(map, 9));
  EXPECT_FALSE(nowhere.bounds_m());
  EXPECT_FALSE(nowhere.middle_m());
  EXPECT_TRUE(nowhere.borders_m().empty());
  EXPECT_EQ(nowhere.share_inside(2.05, -2.95, kWidth), 0.0);
}

TEST(LabelArea, OfSeveralPiecesIsGoneToWhereItIsDeepest) {
  const auto map = blobs();
  const Area area(std::make_shared<const LabelArea>(map, 7));
  const Eigen::Vector2d middle = *area.middle_m();
  EXPECT_TRUE(area.holds(middle.x(), middle.y()));
  EXPECT_GT(oracle_to_pixels(*map, 7, false, middle.x(), middle.y()), 0.005);
  // Two pieces beside each other: the middle of both lies between them.
  const Area two(
      std::make_shared<const LabelArea>(picture({"        ", " 33  333", " 33  333", "     333"}, {0, 0, 8, 4}), 3));
  EXPECT_TRUE(two.holds(two.middle_m()->x(), two.middle_m()->y()));
  EXPECT_GT(two.middle_m()->x(), 5.0) << "the larger one";
  EXPECT_EQ(two.area_m2(), 13.0);
  EXPECT_EQ(*two.bounds_m(), (Area::Box{1, 0, 8, 3}));
}

TEST(LabelArea, BordersGoRoundPiecesAndHolesWithinAPixel) {
  const auto map = blobs();
  const Area area(std::make_shared<const LabelArea>(map, 7));
  const auto borders = area.borders_m();
  ASSERT_EQ(borders.size(), 3U) << "a blob, its hole, an island";
  for (const auto& border : borders) {
    EXPECT_EQ(border.front(), border.back());
    for (std::size_t k = 0; k + 1 < border.size(); ++k)
      for (int part = 0; part < 4; ++part) {
        const Eigen::Vector2d p = border[k] + (border[k + 1] - border[k]) * part / 4.0;
        EXPECT_LE(
            std::max(oracle_to_pixels(*map, 7, true, p.x(), p.y()), oracle_to_pixels(*map, 7, false, p.x(), p.y())),
            0.001);
      }
  }
}

TEST(LabelArea, OfALargePictureKeepsFewerSamplesAndTheSamePlaces) {
  auto map = std::make_shared<LabelMap>();
  *map = {3000, 3000, std::vector<std::uint16_t>(9'000'000, 0), {0.0, 0.0, 3.0, 3.0}};
  for (int row = 500; row < 2900; ++row)
    for (int column = 100; column < 2900; ++column) map->values[static_cast<std::size_t>(row * 3000 + column)] = 5;
  const Area area(std::make_shared<const LabelArea>(map, 5));
  EXPECT_NEAR(area.inside_m(0.11, 1.5), 0.01, 0.0011);
  EXPECT_NEAR(area.inside_m(0.09, 1.5), -0.01, 0.0011);
  EXPECT_TRUE(area.holds(0.1001, 1.5));
  EXPECT_FALSE(area.holds(0.0999, 1.5));
  EXPECT_EQ(area.borders_m().size(), 1U);
}

TEST(Area, AnswersTheServoFastWhateverItsShape) {
#if SPARSHA_SANITIZED || !defined(NDEBUG)
  GTEST_SKIP() << "times of a build for release alone";
#endif
  constexpr std::size_t kPlaces = 4096;
  struct Timed {
    std::string name;
    Area area;
    double width;
    std::vector<std::array<double, 2>> places;
    double ns = HUGE_VAL;
  };
  std::vector<Timed> parts;
  const auto add = [&parts](const std::string& name, const Area& area, double width) {
    const Area::Box b = *area.bounds_m();
    std::mt19937 random(17);
    std::uniform_real_distribution<double> x(b[0], b[2]), y(b[1], b[3]);
    Timed part{name, area, width, std::vector<std::array<double, 2>>(kPlaces)};
    for (auto& place : part.places) place = {x(random), y(random)};
    parts.push_back(std::move(part));
  };
  for (const double width : {0.02, 0.2, 2.0})  // 1 %, 10 % and all of the part
    for (const auto& [name, corners] : shapes()) add(name, Area(std::make_shared<const Polygon>(corners)), width);
  add("a label", Area(std::make_shared<const LabelArea>(blobs(), 7)), 0.004);
  double sum = 0.0;
  for (int round = 0; round < 30; ++round)
    for (Timed& part : parts) {
      const auto began = std::chrono::steady_clock::now();
      for (const auto& place : part.places) sum += part.area.share_inside(place[0], place[1], part.width);
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - began;
      part.ns = std::min(part.ns, took.count() / static_cast<double>(kPlaces));
    }
  EXPECT_GT(sum, 0.0);
  // Against a part of six corners, timed in the same rounds: looking at each of a thousand corners would take 170 times
  // as long.
  const double few_ns = parts.front().ns;
  for (const Timed& part : parts) {
    std::printf("[          ] %5.0f ns  %s, border %.3f\n", part.ns, part.name.c_str(), part.width);
    EXPECT_LT(part.ns, (part.name == "a thick scribble" ? 120.0 : 60.0) * few_ns) << part.name;
  }
}

// A box of the scans' frame, asked in a frame that is turned, moved and half as large: against the sides of the box as
// six planes in that frame.
TEST(Area, ABoxInSpaceIsInsideOfItsSixPlanes) {
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()) *
                                Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  const Eigen::Vector3d moved(3.0, -2.0, 1.0);
  RegionFrame scan_from_region;
  scan_from_region << 2.0 * turn, moved;
  const std::array<double, 6> box{-1.0, -2.0, 0.5, 1.5, 1.0, 2.5};
  const Area area(SolidBox::of(box, scan_from_region));
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> unit(-3.0, 3.0);
  std::size_t inside = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Eigen::Vector3d scan(unit(random), unit(random), unit(random));
    const Eigen::Vector3d region = turn.transpose() * (scan - moved) / 2.0;
    double depth = std::numeric_limits<double>::infinity();  // regions' frame, half as long
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      depth = std::min({depth, 0.5 * (scan[axis] - box[a]), 0.5 * (box[a + 3] - scan[axis])});
    }
    if (std::abs(depth) < 1e-9) continue;
    inside += depth > 0.0 ? 1 : 0;
    ASSERT_EQ(area.holds(region), depth > 0.0);
    ASSERT_EQ(area.decides(region, 0.1), depth > 0.0);
    const double share = area.share_inside(region, 0.2);
    ASSERT_EQ(share == 1.0, depth >= 0.1 - 1e-12 || share == 1.0);
    if (std::abs(depth) < 0.1) {
      const double t = 0.5 + depth / 0.2;
      ASSERT_NEAR(share, t * t * (3.0 - 2.0 * t), 1e-9);
    } else {
      ASSERT_EQ(share, depth > 0.0 ? 1.0 : 0.0);
    }
    if (depth > 0.0) {
      ASSERT_TRUE(area.holds(region.x(), region.y())) << "within its outline";
    }
  }
  EXPECT_GT(inside, 500U);
  const Eigen::Vector3d middle = turn.transpose() * (Eigen::Vector3d(0.25, -0.5, 1.5) - moved) / 2.0;
  EXPECT_LT((area.solid()->middle_m() - middle).norm(), 1e-12);
  EXPECT_EQ(Area(Area::Box{0, 0, 1, 1}).holds(Eigen::Vector3d(0.5, 0.5, 99.0)), true) << "others have no depth";
}

}  // namespace
}  // namespace sparsha::scene

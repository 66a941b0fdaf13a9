// What a picture that moves is made of: no more for a finer scene, and hardly another picture.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "../relief_scene.h"
#include "../studio.h"
#include "scene/scene.h"

namespace sparsha::viewer::test {
namespace {

/// A round stone with rings that stand before it: rims and depth steps, as statues have.
scene::ScenePointer statue(int nodes) {
  const double spacing_m = 0.4 / (nodes - 1);
  return scene_of(
      [](double x_m, double y_m) {
        const double r = std::hypot(x_m - 0.2, y_m - 0.2) + 0.004 * std::sin(25.0 * std::atan2(y_m - 0.2, x_m - 0.2));
        if (r > 0.19) return std::numeric_limits<double>::quiet_NaN();
        return 0.01 * std::sin(40.0 * x_m) * std::cos(30.0 * y_m) + (std::fmod(r, 0.02) < 0.01 ? 0.03 : 0.0);
      },
      {nodes, nodes, spacing_m, nodes > 600 ? 4 : 2});
}

struct Moving {
  unsigned triangles = 0;  ///< the fewest of some pictures: others draw the overview as well
  std::vector<unsigned char> pixels;
};

Moving turn(const scene::ScenePointer& scene) {
  Studio studio(scene);
  const gl::Target target(1280, 720, false);
  double time_s = 0.0;
  const auto frame = [&](double step_s, bool finished) {
    time_s += step_s;
    studio.controller().update(time_s, {}, 1280, 720,
                               [&](double x_m, double y_m) { return studio.picture().height_at(x_m, y_m); });
    studio.controller().frame().finished = finished;
    studio.picture().draw(studio.controller().frame(), target.framebuffer(), 1280, 720);
  };
  frame(1.0, true);
  frame(5.0, true);
  Moving moving;
  moving.triangles = std::numeric_limits<unsigned>::max();
  unsigned query = 0;
  glGenQueries(1, &query);
  for (int k = 0; k < 4; ++k) {
    studio.controller().act(Action::turn_left);
    glBeginQuery(GL_PRIMITIVES_GENERATED, query);
    frame(0.05, false);
    glEndQuery(GL_PRIMITIVES_GENERATED);
    unsigned count = 0;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &count);
    moving.triangles = std::min(moving.triangles, count);
  }
  glDeleteQueries(1, &query);
  moving.pixels = target.read_pixels();
  return moving;
}

TEST(MovingPicture, OfAFinerSceneCostsNoMoreAndLooksTheSame) {
  {
    const gl::OffscreenContext context;
    if (!gl::is_software()) GTEST_SKIP() << "a graphics card draws all of it";
  }
  const Moving coarse = turn(statue(501)), fine = turn(statue(1001));
  EXPECT_GT(coarse.triangles, 1000U);
  EXPECT_LT(fine.triangles, 1.25 * coarse.triangles);
  ASSERT_EQ(coarse.pixels.size(), fine.pixels.size());
  double squares = 0.0;
  for (std::size_t k = 0; k < coarse.pixels.size(); ++k)
    squares += std::pow(static_cast<double>(coarse.pixels[k]) - fine.pixels[k], 2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(coarse.pixels.size())), 8.0) << "30 dB";
}

}  // namespace
}  // namespace sparsha::viewer::test

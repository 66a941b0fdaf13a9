// Loops of touch with and without the governor, which two tables compare.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <vector>

#include "base/threads/thread_pool.h"
#include "scene/scene_fwd.h"
#include "tests/support/touch_loop.h"

namespace sparsha::bench {

/// Hands of the tables.
inline constexpr std::array kHandMasses_kg{0.05, 0.15, 0.5};
inline constexpr std::array kHandDampings_n_s_per_m{0.3, 0.5, 1.0, 2.0, 5.0, 10.0};

struct TouchRun {
  test::TouchCase c;
  test::TouchResult governed, free;
};

/// Fills in the results, on all processors: nothing is timed, and each run has its own seed.
inline void run_both_ways(std::vector<TouchRun>& runs) {
  std::map<test::Ground, scene::ScenePointer> scenes;
  for (const test::Ground ground : test::kGrounds) scenes[ground] = test::make_ground(ground);
  ThreadPool().for_ranges(runs.size(), 1, [&](std::size_t k, std::size_t) {
    test::TouchCase c = runs[k].c;
    runs[k].governed = test::touch(c, scenes.at(c.ground));
    c.governed = false;
    runs[k].free = test::touch(c, scenes.at(c.ground));
  });
}

}  // namespace sparsha::bench

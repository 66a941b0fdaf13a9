// A recording of a run with impact, grain and parts holds all that a replay needs for the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "haptics/device/simulated/simulated_device.h"
#include "haptics/effects/surface_effects.h"
#include "haptics/replay/recorded_run.h"
#include "haptics/session/session.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/test_folder.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

/// The scene of the session's tests, and its middle of wood and soft.
scene::ScenePointer invented_scene() {
  const auto stone = [](double x, double y) {
    return sparsha::test::hills_m(x, y) + 0.0001 * std::sin(900.0 * x) * std::sin(700.0 * y);
  };
  return sparsha::test::scene_of(stone, 401, 0.1, 101, Eigen::Vector3d(2.0, -3.0, 0.5), [](scene::SceneDescription& d) {
    d.config.friction = scene::FrictionConfig{};
    d.config.friction->law = scene::FrictionConfig::Law::constant;
    d.config.haptics.impact = true;
    d.config.haptics.grain = true;
    scene::PartTouch touch;
    touch.material = scene::Material::wood;
    touch.stiffness_n_per_m = 500.0;
    touch.mu_dynamic = 0.3;
    d.config.parts.push_back({"middle", "", {2.03, -2.97, 2.07, -2.93}, touch});
  });
}

/// Replays a recording tick by tick; counts the ticks for which `counted` holds.
template <typename Counted>
std::size_t expect_same_bits(const scene::ScenePointer& scene, const std::filesystem::path& recorded, Counted counted) {
  const Recording recording(recorded);
  RecordedRun run(scene, recording, RendererOptions{});
  std::size_t differing = 0;
  std::size_t count = 0;
  std::ifstream file(recorded);
  std::string live;
  std::getline(file, live);
  std::size_t row = 0;
  // From a column of run.csv to the next.
  const auto field = [](const std::string& line, std::size_t column) {
    std::size_t from = 0;
    for (std::size_t k = 0; k < column; ++k) from = line.find(',', from) + 1;
    return std::stod(line.substr(from));
  };
  constexpr std::size_t kCommandedX = 20;
  while (!run.finished()) {
    if (run.needs_window()) run.change_window();
    run.step();
    const State& state = run.renderer().state();
    if (!std::getline(file, live)) ADD_FAILURE() << "row " << row << " is missing";
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (field(live, kCommandedX + axis) != state.commanded_force_n[axis] && ++differing < 5)
        ADD_FAILURE() << "row " << row << ": " << live << " and " << state.commanded_force_n[axis];
    if (counted(state)) ++count;
    ++row;
  }
  EXPECT_EQ(differing, 0U);
  return count;
}

TEST(Replay, OfARunWithImpactGrainAndPartsCommandsTheSameBits) {
  const test::TestFolder folder;
  const auto scene = invented_scene();
  SessionOptions options;
  options.record = folder / "run.csv";
  Session session(scene, make_simulated_device(3, 3.0), options);
  run_to_the_end(session, {{Request::Kind::zoom_in},
                           {Request::Kind::pan, 0.2, -0.1},
                           {Request::Kind::set_stiffness, 500.0},
                           {Request::Kind::zoom_in},
                           {Request::Kind::zoom_out}});
  const std::size_t added = expect_same_bits(scene, options.record, [](const State& state) {
    return (state.flags & kFlagImpact) != 0 && (state.flags & kFlagGrain) != 0 &&
           state.commanded_force_n != state.force_n && state.contact != 0;
  });
  EXPECT_GT(added, 100U) << "impact and grain were felt at all";
}

TEST(Replay, OfARunWithAGuideAndTicksCommandsTheSameBits) {
  const test::TestFolder folder;
  const auto scene = sparsha::test::scene_of(
      sparsha::test::hills_m, 401, 0.1, 101, Eigen::Vector3d::Zero(), [](scene::SceneDescription& d) {
        d.config.cues = scene::CuesConfig{};
        d.config.parts.push_back({"left", "Left", {0.0, 0.0, 0.05, 0.1}});
        d.config.guide = scene::GuideConfig{};
        d.config.guide->path = scene::GuideConfig::Path::drawn;
        // To and fro, so that a line is near wherever the hand is.
        for (int k = 0; k <= 50; ++k)
          d.config.guide->line_m.push_back({k % 4 == 0 || k % 4 == 3 ? 0.0 : 0.1, 0.004 * (k / 2)});
      });
  SessionOptions options;
  options.record = folder / "run.csv";
  Session session(scene, make_simulated_device(3, 3.0), options);
  run_to_the_end(session, {{Request::Kind::guide}, {Request::Kind::zoom_in}});
  std::size_t cues = 0;
  const std::size_t led = expect_same_bits(scene, options.record, [&](const State& state) {
    cues = state.cues[0] + state.cues[3];
    return (state.flags & kFlagGuided) != 0;
  });
  EXPECT_GT(led, 100U) << "the hand was led at all";
  EXPECT_GT(cues, 0U) << "the view changed, or the part was entered";
}

TEST(Replay, OfARunWithAGuideOnAWholeObjectCommandsTheSameBits) {
  const test::TestFolder folder;
  const auto scene = sparsha::test::whole_scene(sparsha::test::ball_charts(), 0.1, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    d.config.guide = scene::GuideConfig{};
    d.config.guide->path = scene::GuideConfig::Path::drawn;
    for (int k = 0; k <= 50; ++k)
      d.config.guide->line_m.push_back({k % 4 == 0 || k % 4 == 3 ? -0.025 : 0.025, -0.025 + 0.002 * (k / 2)});
  });
  SessionOptions options;
  options.record = folder / "run.csv";
  Session session(scene, make_simulated_device(3, 3.0), options);
  run_to_the_end(session, {{Request::Kind::guide}, {Request::Kind::turn, 20.0, 30.0}});
  bool across = false;
  const std::size_t led = expect_same_bits(scene, options.record, [&](const State& state) {
    across = across || state.guide_n[2] != 0.0;
    return (state.flags & kFlagGuided) != 0;
  });
  EXPECT_GT(led, 100U) << "the hand was led at all";
  EXPECT_TRUE(across) << "not in one plane";
}

TEST(Replay, OfARunWithoutImpactAndGrainAddsNoneWhateverTheSceneSaysNow) {
  const test::TestFolder folder;
  SessionOptions options;
  options.record = folder / "run.csv";
  Session session(textured_scene(), make_simulated_device(3, 1.0), options);
  run_to_the_end(session);
  const Recording recording(options.record);
  for (const RecordedWindow& window : recording.windows()) {
    EXPECT_FALSE(window.plan.impact);
    EXPECT_FALSE(window.plan.grain);
  }
  RecordedRun run(invented_scene(), recording, RendererOptions{});
  EXPECT_FALSE(run.renderer().window().surface->effects != nullptr &&
               (run.renderer().window().surface->effects->impact || run.renderer().window().surface->effects->grain));
}

}  // namespace
}  // namespace sparsha::haptics

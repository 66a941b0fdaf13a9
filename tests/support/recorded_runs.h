// A scene with grain, and runs from start to end, for tests of the session.
#pragma once

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "haptics/replay/path_device.h"
#include "haptics/replay/recording.h"
#include "haptics/session/session.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {

/// Hills with grain on a square of 0.1 m, constant friction, one part.
inline scene::ScenePointer textured_scene(int nodes = 401) {
  const auto stone = [](double x, double y) {
    return sparsha::test::hills_m(x, y) + 0.0003 * std::sin(900.0 * x) * std::sin(700.0 * y);
  };
  return sparsha::test::scene_of(stone, nodes, 0.1, 101, Eigen::Vector3d(2.0, -3.0, 0.5),
                                 [](scene::SceneDescription& d) {
                                   d.config.friction = scene::FrictionConfig{};
                                   d.config.friction->law = scene::FrictionConfig::Law::constant;
                                   d.config.parts.push_back({"middle", "The middle of it", {2.0, -3.0, 2.1, -2.9}});
                                 });
}

/// From start to stop; one of `wishes` is posted every 0.3 s.
inline SessionSummary run_to_the_end(Session& session, const std::vector<Request>& wishes = {}) {
  session.start();
  std::size_t next = 0;
  while (!session.finished()) {
    session.poll();
    if (next < wishes.size() && session.state().read().time_s > 0.3 * static_cast<double>(next + 1))
      session.requests().post(wishes[next++]);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return session.stop();
}

/// What `explore --device playback:FILE` makes of a recording: shown again on `scene` or on those that were kept with
/// it, or rendered anew when it has no windows.
inline std::unique_ptr<Session> session_of(const scene::ScenePointer& scene, const std::filesystem::path& file,
                                           const SessionOptions& options) {
  auto recording = std::make_shared<const Recording>(file);
  if (recording->windows().empty()) return std::make_unique<Session>(scene, make_path_device(recording), options);
  auto kept = open_kept_scenes(*recording, scene::Trust::own_folder);
  return std::make_unique<Session>(kept.value_or(RecordedScenes(scene)), recording, options);
}

}  // namespace sparsha::haptics

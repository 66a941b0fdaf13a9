// A controller over a scene, driven by pixels that are computed from places of the object.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "scene/folder/folder.h"
#include "tests/viewer/relief_scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer::test {

inline double slope(double x_m, double) { return 0.1 * x_m; }

struct MarkingBench {
  std::vector<std::string> spoken;
  std::vector<std::vector<scene::PartConfig>> saved;
  bool takes_parts = true;
  scene::ScenePointer scene;
  std::unique_ptr<Controller> controller;
  double time_s = 0.0;
  haptics::State state;

  explicit MarkingBench(scene::ScenePointer made) : scene(std::move(made)) {
    Connections connections;
    connections.speak = [this](const std::string& words) { spoken.push_back(words); };
    connections.save_parts = [this](const std::vector<scene::PartConfig>& parts) {
      saved.push_back(parts);
      return takes_parts;
    };
    controller = std::make_unique<Controller>(connections, ViewSettings{});
    controller->set_scene(scene);
    run();
  }
  void run() {
    for (int k = 0; k < 60; ++k) controller->update(time_s += 0.02, state, 1280, 720, slope);
  }
  [[nodiscard]] Layout layout() const { return layout_of(1280, 720, controller->settings()); }
  [[nodiscard]] View view() const {
    return make_view(controller->frame().camera, layout().detail.width, layout().detail.height);
  }
  void point_at(double x_m, double y_m) {
    const Stage stage = stage_of(scene->description());
    const auto pixel = view().to_pixel(stage.to_world({x_m, y_m, slope(x_m, y_m)}));
    ASSERT_TRUE(pixel);
    controller->mouse_move(layout().detail.x + pixel->x(), pixel->y(), layout(), view(), stage, slope);
  }
  void click(double x_m, double y_m) {
    point_at(x_m, y_m);
    controller->mouse_button(0, true, 0);
    controller->mouse_button(0, false, 0);
    run();
  }
  void key(int key, int modifiers = 0) {
    controller->press({key, modifiers});
    run();
  }
  void type(const std::string& words) {
    for (const char c : words) controller->type(static_cast<char32_t>(c));
    run();
  }
  [[nodiscard]] const Marks& marks() const { return controller->frame().marks; }
};

inline scene::ScenePointer plate(const sparsha::test::EditDescription& edit = {}) {
  return scene_of(slope, {201, 201, 0.001, 1}, edit);
}

}  // namespace sparsha::viewer::test

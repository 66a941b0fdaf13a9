// The material of parts of any shape, as it sounds.
#include <gtest/gtest.h>

#include "tests/audio/audio_scene.h"
#include "tests/support/part_scenes.h"

namespace {

using namespace sparsha;

TEST(Materials, OfPolygonsAndLabelsSoundInsideThemAndNotInTheirNotches) {
  const audio_scene::Folder folder;
  scene::PartTouch touch;
  touch.material = scene::Material::wood;
  const auto scene = sparsha::test::els(folder / "labels.png", touch, [](scene::SceneDescription& d) {
    d.config.audio->material = scene::MaterialSoundConfig{};
    scene::AudioRegionConfig own;
    own.name = "own";
    own.label = 5;
    own.sound = scene::ModalConfig{};
    d.config.audio->regions = {own};
    d.config.parts[1].touch.material = scene::Material::bronze;
    scene::PartConfig box = d.config.parts[0];
    box.name = "box";
    box.polygon_m.clear();
    box.box_m = {0.06, 0.06, 0.09, 0.09};
    d.config.parts.push_back(box);
  });
  const auto sounds = audio::make_sound_bank(*scene, 48000);
  const auto name_at = [&](double x_m, double y_m) {
    const auto region = sounds->region_at({x_m, y_m, 0.0});
    return region ? sounds->regions[*region].name : std::string("none");
  };
  EXPECT_TRUE(sounds->warnings.empty());
  EXPECT_EQ(name_at(0.066, 0.032), "Polygon");
  EXPECT_EQ(name_at(0.082, 0.032), "") << "its notch is of the whole scene's material";
  EXPECT_EQ(name_at(0.016, 0.032), "own") << "regions come first";
  EXPECT_EQ(name_at(0.032, 0.032), "");
  EXPECT_EQ(name_at(0.07, 0.07), "box");
  // A tap on the polygon is wood, as one on a box of wood is.
  audio::Synth polygon(sounds), box(sounds);
  ASSERT_TRUE(polygon.contact(audio_scene::touch(0.0, 0.066, 0.032, 1.0), 0));
  ASSERT_TRUE(box.contact(audio_scene::touch(0.0, 0.075, 0.075, 1.0), 0));
  EXPECT_EQ(audio_scene::render(polygon, 0.2), audio_scene::render(box, 0.2));
}

}  // namespace

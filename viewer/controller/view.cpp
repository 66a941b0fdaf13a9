// What is drawn and how: maps, looks, contour lines, stereo, the strip.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text/text.h"
#include "scene/scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer {

// What is drawn, and how.
bool Controller::set_view(Action action) {
  ViewSettings& settings = frame_.settings;
  const auto turn = [&](const char* what, bool& setting) {
    setting = !setting;
    tell(fmt::format("{} {}", what, setting ? "on" : "off"));
    return true;
  };
  switch (action) {
    case Action::colour:
    case Action::colour_back:
      if (!scene_) return true;
      settings.colour = next_mode(scene_->description(), settings.colour, action == Action::colour ? 1 : -1);
      tell(fmt::format("Colour: {}", name_of(settings.colour)));
      return true;
    case Action::look:
    case Action::look_back:
      settings.look =
          static_cast<Look>((static_cast<int>(settings.look) + (action == Action::look ? 1 : kLooks - 1)) % kLooks);
      tell(fmt::format("Look: {}", name_of(settings.look)));
      return true;
    case Action::contours_finer:
    case Action::contours_coarser:
      set_contours(action == Action::contours_finer);
      return true;
    case Action::show_parts:
      turn("The parts' boxes", settings.parts);
      if (settings.parts && frame_.marks.parts.empty()) tell("There are no parts yet: Shift K adds one");
      return true;
    case Action::filled:
      return turn("Marks on filled areas", settings.mark_filled);
    case Action::outline:
      return turn("Outline of what was measured", settings.outline);
    case Action::contrast:
      return turn("High contrast", settings.high_contrast);
    case Action::large_type:
      return turn("Large type", settings.large_type);
    case Action::figures:
      settings.figures = !settings.figures;
      return true;
    case Action::help:
      frame_.help_page = settings.help ? frame_.help_page + 1 : 0;
      settings.help = frame_.help_page < (settings.help ? help_pages_ : 1);
      boxes_.clear();  // those of the next picture count
      return true;
    case Action::strip_pause:
      frame_.strip.pause(!frame_.strip.paused());
      tell(frame_.strip.paused() ? "Strip paused" : "Strip goes on");
      return true;
    case Action::strip_save:
      save_strip();
      return true;
    default:
      return false;
  }
}

void Controller::set_contours(bool finer) {
  if (!scene_) return;
  const scene::SceneDescription& scene = scene_->description();
  double& step_m = frame_.settings.contour_m;
  step_m = next_contour_m(step_m, scene.height_max_m - scene.height_min_m, finer);
  tell(step_m > 0.0 ? fmt::format("Contour lines every {}", length_text(step_m, TextStyle::screen))
                    : std::string("Contour lines off"));
}

void Controller::save_strip() {
  const std::string file = dated_name("sparsha-strip", ".csv");
  try {
    frame_.strip.write_csv(file);
    tell("Saved " + file);
  } catch (const Error& error) {
    tell("Not saved: " + error.wrong(), haptics::Announcement::Priority::warning);
  }
}

bool Controller::set_stereo(Action action) {
  Stereo& stereo = frame_.settings.stereo;
  constexpr std::array kNames{"Stereo off", "Stereo: red and cyan, colours", "Stereo: red and cyan, grey",
                              "Stereo: side by side"};
  const auto step = [&](double& value, double factor, double low, double high, const char* what) {
    value = std::clamp(value * factor, low, high);
    tell(fmt::format("{} {:.1f} %", what, 100.0 * value));
    return true;
  };
  constexpr double kStep = 1.15;
  switch (action) {
    case Action::stereo:
      stereo.mode = static_cast<StereoMode>((static_cast<std::size_t>(stereo.mode) + 1) % kNames.size());
      tell(kNames[static_cast<std::size_t>(stereo.mode)]);
      return true;
    case Action::swap_eyes:
      stereo.swapped = !stereo.swapped;
      tell(stereo.swapped ? "Eyes swapped" : "Eyes as usual");
      return true;
    case Action::eyes_apart:
      return step(stereo.separation, kStep, 0.005, 0.25, "Separation of the eyes");
    case Action::eyes_together:
      return step(stereo.separation, 1.0 / kStep, 0.005, 0.25, "Separation of the eyes");
    case Action::screen_nearer:
      return step(stereo.convergence, 1.0 / 1.03, 0.5, 2.0, "Zero parallax at");
    case Action::screen_farther:
      return step(stereo.convergence, 1.03, 0.5, 2.0, "Zero parallax at");
    default:
      return false;
  }
}

}  // namespace sparsha::viewer

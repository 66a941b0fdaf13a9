// What the command line of `sparsha explore` says.
#pragma once

#include <string>
#include <vector>

namespace sparsha::app {

struct ExploreArguments {
  std::vector<std::string> scene;  ///< a scene, a configuration, or scans
  std::string device = "auto";
  bool headless = false;
  double duration_s = 0.0;
  std::string record;
  std::string screenshot;
  std::string audio_out;
  std::string audio_device;
  bool list_audio = false;
  bool no_texture = false;
  bool no_friction = false;
  bool speech = false;
  std::string language;
  bool kiosk = false;
  std::string scenes;
  bool direct = false;
  std::string study;
  std::string firmware;
  std::string memory;  ///< for the points of raw scans; empty: kMostPointsShown
};

}  // namespace sparsha::app

// The whole configuration as plain values, one member a block of the YAML file (docs/configuration.md); each block has
// a header of its own beside this one. An absent optional block is an empty std::optional and costs nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/config/audio.h"
#include "scene/config/cues.h"
#include "scene/config/filters.h"
#include "scene/config/grid.h"
#include "scene/config/guide.h"
#include "scene/config/haptics.h"
#include "scene/config/layers.h"
#include "scene/config/orientation.h"
#include "scene/config/parts.h"
#include "scene/config/registration.h"
#include "scene/config/scans.h"
#include "scene/config/speech.h"
#include "scene/config/unroll.h"
#include "scene/config/viewer.h"

namespace sparsha::yaml {
struct Node;
}

namespace sparsha::scene {

struct Config {
  std::vector<ScanConfig> scans;
  std::vector<FilterConfig> filters;
  std::optional<RegisterConfig> registration;  ///< the block `register`
  OrientationConfig orientation;
  GridConfig grid;
  std::optional<AroundConfig> around;
  std::optional<UnrollConfig> unroll;
  std::optional<FillConfig> fill;
  std::optional<TextureConfig> texture;
  std::optional<FrictionConfig> friction;
  LevelsConfig levels;
  std::optional<CheckConfig> check;
  HapticsConfig haptics;
  std::vector<PartConfig> parts;
  std::optional<AudioConfig> audio;
  std::optional<SpeechConfig> speech;
  std::optional<GuideConfig> guide;
  std::optional<CuesConfig> cues;
  ViewerConfig viewer;
};

/// Reads a configuration; paths become relative to `folder` (the file's own). Throws Error{usage} with line, column and
/// the nearest valid key. Contradictions (size and spacing_mm, singular matrices, parallel `up`) are errors too.
[[nodiscard]] Config parse_config(const yaml::Node& root, const std::filesystem::path& folder);

/// True for the scene.yaml of a scene: a configuration, and what was made of it.
[[nodiscard]] bool describes_scene(const yaml::Node& root);

/// Of a scene.yaml the configuration alone: the scene can be built again.
[[nodiscard]] Config load_config(const std::filesystem::path& file, const std::vector<std::string>& settings = {});

/// The same configuration as YAML text that parse_config reads back to equal values.
[[nodiscard]] std::string to_yaml(const Config& config);

}  // namespace sparsha::scene

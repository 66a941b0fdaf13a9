// The configuration's block `audio`: what sounds where.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scene/material/materials.h"

namespace sparsha::scene {

/// One decaying partial of a note.
struct ModeConfig {
  double frequency_hz = 0.0;
  double decay_s = 0.0;   ///< to fall by 60 dB
  double level_db = 0.0;  ///< relative to the others
};

/// A pillar's note, or, as `sparsha sound fit` gives them, the modes of a recorded strike.
struct ModalConfig {
  double frequency_hz = 240.0;
  double decay_s = 1.2;
  std::vector<ModeConfig> modes;  ///< when not empty, these and not the bar's
};

/// The sound of a material; what is absent is the table's (scene/material/materials.h).
struct MaterialSoundConfig {
  Material material = Material::granite;
  std::optional<double> frequency_hz;
  std::optional<double> damping;
  std::optional<double> brightness;
};

struct AudioRegionConfig {
  enum class Loop { none, one_period };
  std::string name;
  std::optional<std::array<double, 4>> box_m;  ///< grid frame
  std::optional<int> label;                    ///< of the label image
  std::variant<ModalConfig, std::filesystem::path, MaterialSoundConfig> sound;
  std::vector<std::array<double, 2>> polygon_m{};  ///< corners, grid frame; empty: none
  Loop loop = Loop::none;                          ///< of a clip: one period of it, repeated while it decays
  std::optional<std::array<double, 6>> solid_m{};  ///< xmin ymin zmin xmax ymax zmax, frame of the scans
  [[nodiscard]] bool has_place() const { return box_m || label || solid_m || !polygon_m.empty(); }
};

/// A picture of whole numbers that lies over the grid: pixels of value n belong to the regions and parts with
/// `label: n`.
struct LabelImageConfig {
  std::filesystem::path file;                     ///< PNG, grey or palette; the top row is the largest y
  std::optional<std::array<double, 4>> bounds_m;  ///< that it covers, grid frame; absent: the whole grid
};

struct AudioConfig {
  std::vector<AudioRegionConfig> regions;
  std::optional<double> friction_sound_gain;
  bool friction_sound_grain = true;             ///< what lies between the nodes is heard as the grain continues it
  std::optional<MaterialSoundConfig> material;  ///< of every place without a region; absent: these are mute
  std::optional<LabelImageConfig> labels;
  bool find_pillars = false;  ///< regions without a place lie on the pillars that are found when the scene is built
};

}  // namespace sparsha::scene

// What sound costs: 32 struck things of 32 modes each, and a stroke over rough stone with its grain, at 48 kHz.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "audio/synth.h"
#include "base/numbers/statistics.h"
#include "scene/scene.h"

namespace {

using namespace sparsha;

constexpr int kVoices = 32;
constexpr int kModes = 32;
constexpr std::size_t kBlock = 128;  // frames
constexpr double kRate = 48000.0;

/// Stone of 0.2 m whose heights follow no straight line, with that many regions side by side.
scene::ScenePointer rough_stone(int voices) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid({401, 401, 0.0005, Eigen::Vector3d::Zero()});
  const scene::Lattice& lattice = layers.grid.lattice;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      double height = 0.0;
      for (int k = 1; k < 40; ++k)
        height += 2e-4 / k * std::sin(70.0 * k * lattice.x_m(i) + 53.0 * k * lattice.y_m(j) + k * k);
      layers.grid.height_m[lattice.index(i, j)] = static_cast<float>(height);
      layers.grid.state[lattice.index(i, j)] = scene::NodeState::measured;
    }
  scene::SceneDescription description;
  description.levels = {lattice};
  description.config.audio = scene::AudioConfig{};
  description.config.audio->friction_sound_gain = 0.5;
  for (int v = 0; v < voices; ++v) {
    scene::ModalConfig modal;
    for (int m = 0; m < kModes; ++m) modal.modes.push_back({100.0 + 7.0 * v + 180.0 * m, 30.0, -0.5 * m});
    scene::AudioRegionConfig region;
    region.name = "voice";
    region.box_m = {0.2 * v / voices, 0.0, 0.2 * (v + 1) / voices, 0.2};
    region.sound = modal;
    description.config.audio->regions.push_back(region);
  }
  return scene::make_scene(std::move(description), {layers});
}

/// Share of a core (processor time) that a second of sound takes, over `seconds` of it: the median of whole seconds.
double load(int voices, bool strokes, int seconds) {
  const scene::ScenePointer scene = rough_stone(std::max(voices, 1));
  audio::Synth synth(audio::make_sound_bank(*scene, static_cast<int>(kRate)));
  audio::ProfileReader reader(scene, true);
  std::shared_ptr<const audio::Profile> profile;
  for (int v = 0; v < voices; ++v) synth.strike({static_cast<std::size_t>(v), 1.0, 0.5}, 0);
  std::vector<float> block(2 * kBlock);
  std::vector<double> loads;
  for (int second = 0; second < seconds; ++second) {
    const std::clock_t began = std::clock();
    for (std::size_t done = 0; done < static_cast<std::size_t>(kRate); done += kBlock) {
      if (strokes) {
        haptics::State state;
        state.time_s = static_cast<double>(synth.frame()) / kRate;
        ++state.tick;
        state.proxy_m = state.place_m = {0.1 + 0.08 * std::sin(2.0 * state.time_s), 0.1, 0.0};
        state.normal = {0.0, 0.0, 1.0};
        state.force_n = {0.0, 0.0, 1.0};
        state.contact = 1;
        state.flags = haptics::kFlagTexture;
        state.window = {0, 0, 401, 401};
        if (auto next = reader.update(state)) synth.profile(profile = next, synth.frame());
        synth.state(state, synth.frame() + kBlock);
      }
      synth.render(block);
    }
    loads.push_back(static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  }
  return sparsha::median(loads);
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path out = ".";
  int seconds = 9;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--out") == 0) out = argv[i + 1];
    if (std::strcmp(argv[i], "--mode") == 0 && std::strcmp(argv[i + 1], "quick") == 0) seconds = 3;
  }
  std::filesystem::create_directories(out);
  std::ofstream csv(out / "sound.csv");
  csv << "method,voices,modes,stroke,core_share\n";
  struct Row {
    int voices;
    bool stroke;
  };
  for (const Row& row : {Row{0, true}, Row{kVoices, false}, Row{kVoices, true}}) {
    const double share = load(row.voices, row.stroke, seconds);
    csv << "modal," << row.voices << ',' << (row.voices > 0 ? kModes : 0) << ',' << (row.stroke ? 1 : 0) << ',' << share
        << '\n';
    std::printf("sound: %2d voices of %d modes%s: %.1f %% of a core\n", row.voices, kModes,
                row.stroke ? " and a stroke" : "", 100.0 * share);
  }
  return csv.good() ? 0 : 1;
}

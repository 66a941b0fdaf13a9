// Regions of the configuration made ready to sound.
#include "audio/sound_bank.h"

#include <filesystem>

#include "pipeline/base/error.h"

namespace sparsha::audio {

std::optional<std::size_t> SoundBank::region_at(double x_m, double y_m) const noexcept {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (!regions[i].box_m) continue;
    const auto& [left, bottom, right, top] = *regions[i].box_m;
    if (x_m >= left && x_m <= right && y_m >= bottom && y_m <= top) return i;
  }
  return std::nullopt;
}

std::shared_ptr<const SoundBank> make_sound_bank(const pipeline::Scene& scene, int sample_rate_hz) {
  auto bank = std::make_shared<SoundBank>();
  bank->sample_rate_hz = sample_rate_hz;
  const auto& audio = scene.description().config.audio;
  if (!audio) return bank;
  bank->scrape_gain = audio->friction_sound_gain.value_or(0.0);
  for (const pipeline::AudioRegionConfig& config : audio->regions) {
    SoundRegion region{config.name, config.box_m, PillarModes{}};
    if (!config.box_m)
      bank->warnings.push_back("audio region '" + config.name +
                               "' stays silent: the scene has no label layer, only box_m regions sound");
    if (const auto* modal = std::get_if<pipeline::ModalConfig>(&config.sound)) {
      if (!(modal->frequency_hz >= 10.0 && modal->frequency_hz <= 16000.0))
        throw usage_error("audio region '" + config.name + "': impossible frequency_hz", "10 to 16000 Hz");
      if (!(modal->decay_s >= 0.001 && modal->decay_s <= 60.0))
        throw usage_error("audio region '" + config.name + "': impossible decay_s",
                          "0.001 to 60 s, the time to fall by 60 dB");
      region.sound = pillar_modes(*modal, 0.45 * sample_rate_hz);
    } else {
      region.sound = load_clip(std::get<std::filesystem::path>(config.sound), sample_rate_hz);
    }
    bank->regions.push_back(std::move(region));
  }
  return bank;
}

}  // namespace sparsha::audio

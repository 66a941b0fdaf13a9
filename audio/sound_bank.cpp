// Regions of the configuration made ready to sound.
#include "audio/sound_bank.h"

#include <filesystem>
#include <map>

#include "base/error.h"
#include "scene/regions.h"
#include "scene/sound_limits.h"

namespace sparsha::audio {
namespace {

// Clips that regions share, each decoded once.
class ClipShelf {
 public:
  explicit ClipShelf(int sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  std::shared_ptr<const Clip> get(const std::filesystem::path& file) {
    std::shared_ptr<const Clip>& clip = clips_[file.lexically_normal()];
    if (clip) return clip;
    clip = std::make_shared<const Clip>(load_clip(file, sample_rate_hz_));
    samples_ += clip->samples.size();
    if (samples_ > kMostSamples)
      throw input_error(file.string(), "with it, the scene's clips take more than 1 GB of memory", "shorter sounds");
    return clip;
  }

 private:
  static constexpr std::size_t kMostSamples = std::size_t{1} << 28U;  // of 4 bytes
  int sample_rate_hz_;
  std::size_t samples_ = 0;
  std::map<std::filesystem::path, std::shared_ptr<const Clip>> clips_;
};

}  // namespace

std::optional<std::size_t> SoundBank::region_at(double x_m, double y_m) const noexcept {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].box_m && pipeline::in_box(*regions[i].box_m, x_m, y_m)) return i;
  }
  return std::nullopt;
}

std::shared_ptr<const SoundBank> make_sound_bank(const pipeline::Scene& scene, int sample_rate_hz) {
  auto bank = std::make_shared<SoundBank>();
  bank->sample_rate_hz = sample_rate_hz;
  const auto& audio = scene.description().config.audio;
  if (!audio) return bank;
  ClipShelf clips(sample_rate_hz);
  bank->scrape_gain = audio->friction_sound_gain.value_or(0.0);
  for (const pipeline::AudioRegionConfig& config : audio->regions) {
    SoundRegion region{config.name, config.box_m, PillarModes{}};
    if (!config.box_m)
      bank->warnings.push_back("audio region '" + config.name +
                               "' stays silent: the scene has no label layer, only box_m regions sound");
    if (const auto* modal = std::get_if<pipeline::ModalConfig>(&config.sound)) {
      if (!(modal->frequency_hz >= pipeline::kLeastFrequency_hz && modal->frequency_hz <= pipeline::kMostFrequency_hz))
        throw usage_error("audio region '" + config.name + "': impossible frequency_hz", "10 to 16000 Hz");
      if (!(modal->decay_s >= pipeline::kLeastDecay_s && modal->decay_s <= pipeline::kMostDecay_s))
        throw usage_error("audio region '" + config.name + "': impossible decay_s",
                          "0.005 to 60 s, the time to fall by 60 dB");
      region.sound = pillar_modes(*modal, 0.45 * sample_rate_hz);
    } else {
      region.sound = clips.get(std::get<std::filesystem::path>(config.sound));
    }
    bank->regions.push_back(std::move(region));
  }
  return bank;
}

}  // namespace sparsha::audio

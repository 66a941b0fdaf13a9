// Regions of the configuration made ready to sound.
#include "audio/sound_bank.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "base/error.h"
#include "scene/area/regions.h"
#include "scene/material/sound_limits.h"
#include "scene/scene.h"

namespace sparsha::audio {
namespace {

// Clips that regions share, each decoded once.
class ClipShelf {
 public:
  explicit ClipShelf(int sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  std::shared_ptr<const Clip> get(const std::filesystem::path& file, scene::AudioRegionConfig::Loop loop) {
    std::shared_ptr<const Clip>& clip = clips_[{file.lexically_normal(), loop}];
    if (clip) return clip;
    Clip loaded = load_clip(file, sample_rate_hz_);
    if (loop == scene::AudioRegionConfig::Loop::one_period)
      loaded = loop_one_period(loaded, sample_rate_hz_, file.string());
    end_softly(loaded, sample_rate_hz_);
    clip = std::make_shared<const Clip>(std::move(loaded));
    samples_ += clip->samples.size();
    if (samples_ > kMostSamples)
      throw input_error(file.string(), "with it, the scene's clips take more than 1 GB of memory", "shorter sounds");
    return clip;
  }

 private:
  static constexpr std::size_t kMostSamples = std::size_t{1} << 28U;  // of 4 bytes
  int sample_rate_hz_;
  std::size_t samples_ = 0;
  std::map<std::pair<std::filesystem::path, scene::AudioRegionConfig::Loop>, std::shared_ptr<const Clip>> clips_;
};

void check(const scene::ModalConfig& modal, const std::string& name) {
  const auto checked = [&](double frequency_hz, double decay_s) {
    if (!(frequency_hz >= scene::kLeastFrequency_hz && frequency_hz <= scene::kMostFrequency_hz))
      throw usage_error("audio region '" + name + "': impossible frequency_hz", "10 to 16000 Hz");
    if (!(decay_s >= scene::kLeastDecay_s && decay_s <= scene::kMostDecay_s))
      throw usage_error("audio region '" + name + "': impossible decay_s", "0.005 to 60 s, the time to fall by 60 dB");
  };
  checked(modal.frequency_hz, modal.decay_s);
  for (const scene::ModeConfig& mode : modal.modes) checked(mode.frequency_hz, mode.decay_s);
}

// The regions of a configuration, one by one.
class BankMaker {
 public:
  BankMaker(SoundBank& bank, const scene::SceneDescription& scene)
      : bank_(bank),
        scene_(scene),
        labels_(scene.config.audio ? scene::label_map_of(scene) : nullptr),
        limit_hz_(0.45 * bank.sample_rate_hz),
        clips_(bank.sample_rate_hz) {}

  void add_ground(const std::optional<scene::MaterialSoundConfig>& material) {
    scene::MaterialSoundConfig ground;
    ground.material = scene_.config.haptics.material;
    bank_.scrapes.push_back(scrape_of(material.value_or(ground)));
  }
  void add(const scene::AudioRegionConfig& config) {
    SoundRegion region{config.name, area_of(config), Modes{}};
    if (config.label && !labels_) {
      bank_.warnings.push_back("audio region '" + config.name +
                               "' stays silent: it has a label, and the audio block no label image");
    } else if (!config.has_place()) {
      bank_.warnings.push_back("audio region '" + config.name + "' stays silent: no pillar was found for it");
    }
    if (const auto* modal = std::get_if<scene::ModalConfig>(&config.sound)) {
      check(*modal, config.name);
      region.sound = pillar_modes(*modal, limit_hz_);
    } else if (const auto* material = std::get_if<scene::MaterialSoundConfig>(&config.sound)) {
      add_material(region, *material);
    } else {
      region.sound = clips_.get(std::get<std::filesystem::path>(config.sound), config.loop);
    }
    bank_.regions.push_back(std::move(region));
  }
  void add_part(std::size_t index) {
    const scene::PartConfig& part = scene_.config.parts[index];
    SoundRegion region{part.name, scene::area_of(scene_, index), Modes{}};
    scene::MaterialSoundConfig sound;
    sound.material = *part.touch.material;
    add_material(region, sound);
    bank_.regions.push_back(std::move(region));
  }
  void add_everywhere(const scene::MaterialSoundConfig& material) {
    SoundRegion region{"", {}, plate_modes(sound_of(material), limit_hz_)};
    region.everywhere = true;
    bank_.regions.push_back(std::move(region));
  }

 private:
  [[nodiscard]] scene::Area area_of(const scene::AudioRegionConfig& config) const {
    using scene::LabelArea;
    if (config.box_m) return scene::Area(*config.box_m);
    if (config.solid_m) return scene::solid_area(scene_, *config.solid_m);
    if (!config.polygon_m.empty()) return scene::Area(std::make_shared<const scene::Polygon>(config.polygon_m));
    if (!config.label || !labels_) return {};
    return scene::Area(std::make_shared<const LabelArea>(labels_, *config.label, LabelArea::Border::none));
  }
  [[nodiscard]] ScrapeSound scrape_of(const scene::MaterialSoundConfig& material) const {
    return {plate_modes(sound_of(material), limit_hz_), scene::touch_of(material.material).grain_gain};
  }
  void add_material(SoundRegion& region, const scene::MaterialSoundConfig& material) {
    region.sound = plate_modes(sound_of(material), limit_hz_);
    region.scrape = bank_.scrapes.size();
    bank_.scrapes.push_back(scrape_of(material));
  }

  SoundBank& bank_;
  const scene::SceneDescription& scene_;
  std::shared_ptr<const scene::LabelMap> labels_;
  double limit_hz_;
  ClipShelf clips_;
};

}  // namespace

std::optional<std::size_t> SoundBank::region_at(const std::array<double, 3>& place_m) const noexcept {
  const Eigen::Vector3d place(place_m[0], place_m[1], place_m[2]);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const SoundRegion& region = regions[i];
    if (region.everywhere && std::isfinite(place.x()) && std::isfinite(place.y())) return i;
    if (region.area.holds(place)) return i;
  }
  return std::nullopt;
}

void require_clips(const scene::Config& config) {
  constexpr int kAnyRate_hz = 48000;
  ClipShelf clips(kAnyRate_hz);
  if (!config.audio) return;
  for (const scene::AudioRegionConfig& region : config.audio->regions)
    if (const auto* file = std::get_if<std::filesystem::path>(&region.sound))
      static_cast<void>(clips.get(*file, region.loop));
}

std::shared_ptr<const SoundBank> make_sound_bank(const scene::Scene& scene, int sample_rate_hz) {
  auto bank = std::make_shared<SoundBank>();
  bank->sample_rate_hz = sample_rate_hz;
  const scene::SceneDescription& description = scene.description();
  const auto& audio = description.config.audio;
  bank->cues = description.config.cues;
  BankMaker maker(*bank, description);
  maker.add_ground(audio ? audio->material : std::nullopt);
  if (!audio) return bank;
  bank->scrape_gain = audio->friction_sound_gain.value_or(0.0);
  bank->scrape_grain = audio->friction_sound_grain;
  for (const scene::AudioRegionConfig& region : audio->regions) maker.add(region);
  if (!audio->material) return bank;
  // Parts that have a material sound of it, and what is left of the whole scene's.
  const auto& parts = description.config.parts;
  for (std::size_t part = 0; part < parts.size(); ++part)
    if (parts[part].touch.material) maker.add_part(part);
  maker.add_everywhere(*audio->material);
  return bank;
}

}  // namespace sparsha::audio

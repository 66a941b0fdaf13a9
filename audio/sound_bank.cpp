// Regions of the configuration made ready to sound.
#include "audio/sound_bank.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "base/error.h"
#include "scene/regions.h"
#include "scene/sound_limits.h"

namespace sparsha::audio {
namespace {

// Clips that regions share, each decoded once.
class ClipShelf {
 public:
  explicit ClipShelf(int sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  std::shared_ptr<const Clip> get(const std::filesystem::path& file, pipeline::AudioRegionConfig::Loop loop) {
    std::shared_ptr<const Clip>& clip = clips_[{file.lexically_normal(), loop}];
    if (clip) return clip;
    Clip loaded = load_clip(file, sample_rate_hz_);
    if (loop == pipeline::AudioRegionConfig::Loop::one_period)
      loaded = loop_one_period(loaded, sample_rate_hz_, file.string());
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
  std::map<std::pair<std::filesystem::path, pipeline::AudioRegionConfig::Loop>, std::shared_ptr<const Clip>> clips_;
};

bool in_polygon(const std::vector<std::array<double, 2>>& corners, double x, double y) {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const auto& a = corners[i];
    const auto& b = corners[j];
    if ((a[1] > y) != (b[1] > y) && x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
  }
  return inside;
}

void check(const pipeline::ModalConfig& modal, const std::string& name) {
  const auto checked = [&](double frequency_hz, double decay_s) {
    if (!(frequency_hz >= pipeline::kLeastFrequency_hz && frequency_hz <= pipeline::kMostFrequency_hz))
      throw usage_error("audio region '" + name + "': impossible frequency_hz", "10 to 16000 Hz");
    if (!(decay_s >= pipeline::kLeastDecay_s && decay_s <= pipeline::kMostDecay_s))
      throw usage_error("audio region '" + name + "': impossible decay_s", "0.005 to 60 s, the time to fall by 60 dB");
  };
  checked(modal.frequency_hz, modal.decay_s);
  for (const pipeline::ModeConfig& mode : modal.modes) checked(mode.frequency_hz, mode.decay_s);
}

// The regions of a configuration, one by one.
class BankMaker {
 public:
  BankMaker(SoundBank& bank, const pipeline::SceneDescription& scene)
      : bank_(bank), scene_(scene), limit_hz_(0.45 * bank.sample_rate_hz), clips_(bank.sample_rate_hz) {}

  void add_ground(const std::optional<pipeline::MaterialSoundConfig>& material) {
    pipeline::MaterialSoundConfig ground;
    ground.material = scene_.config.haptics.material;
    bank_.scrapes.push_back(scrape_of(material.value_or(ground)));
  }
  void add(const pipeline::AudioRegionConfig& config) {
    SoundRegion region{config.name, config.box_m, Modes{}, config.polygon_m};
    region.label = config.label.value_or(0);
    if (region.label > 0 && !bank_.labels) {
      bank_.warnings.push_back("audio region '" + config.name +
                               "' stays silent: it has a label, and the audio block no label image");
      region.label = 0;
    } else if (!config.has_place()) {
      bank_.warnings.push_back("audio region '" + config.name + "' stays silent: no pillar was found for it");
    }
    if (const auto* modal = std::get_if<pipeline::ModalConfig>(&config.sound)) {
      check(*modal, config.name);
      region.sound = pillar_modes(*modal, limit_hz_);
    } else if (const auto* material = std::get_if<pipeline::MaterialSoundConfig>(&config.sound)) {
      add_material(region, *material);
    } else {
      region.sound = clips_.get(std::get<std::filesystem::path>(config.sound), config.loop);
    }
    bank_.regions.push_back(std::move(region));
  }
  void add_part(const pipeline::PartConfig& part) {
    SoundRegion region{part.name, part.box_m, Modes{}};
    pipeline::MaterialSoundConfig sound;
    sound.material = *part.touch.material;
    add_material(region, sound);
    bank_.regions.push_back(std::move(region));
  }
  void add_everywhere(const pipeline::MaterialSoundConfig& material) {
    SoundRegion region{"", std::nullopt, plate_modes(sound_of(material), limit_hz_)};
    region.everywhere = true;
    bank_.regions.push_back(std::move(region));
  }

 private:
  [[nodiscard]] ScrapeSound scrape_of(const pipeline::MaterialSoundConfig& material) const {
    return {plate_modes(sound_of(material), limit_hz_), pipeline::touch_of(material.material).grain_gain};
  }
  void add_material(SoundRegion& region, const pipeline::MaterialSoundConfig& material) {
    region.sound = plate_modes(sound_of(material), limit_hz_);
    region.scrape = bank_.scrapes.size();
    bank_.scrapes.push_back(scrape_of(material));
  }

  SoundBank& bank_;
  const pipeline::SceneDescription& scene_;
  double limit_hz_;
  ClipShelf clips_;
};

LabelMap load_labels(const pipeline::LabelImageConfig& config, const pipeline::Lattice& grid) {
  LabelMap labels;
  labels.image = read_number_png(config.file);
  labels.bounds_m = config.bounds_m.value_or(
      std::array<double, 4>{grid.x_m(0), grid.y_m(0), grid.x_m(grid.nx - 1), grid.y_m(grid.ny - 1)});
  return labels;
}

}  // namespace

int LabelMap::at(double x_m, double y_m) const noexcept {
  if (!pipeline::in_box(bounds_m, x_m, y_m)) return 0;
  const auto pixel = [](double share, int count) {
    return std::min(count - 1, static_cast<int>(share * static_cast<double>(count)));
  };
  const int column = pixel((x_m - bounds_m[0]) / (bounds_m[2] - bounds_m[0]), image.width);
  const int row = pixel((bounds_m[3] - y_m) / (bounds_m[3] - bounds_m[1]), image.height);
  return image
      .values[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(column)];
}

std::optional<std::size_t> SoundBank::region_at(double x_m, double y_m) const noexcept {
  const int label = labels ? labels->at(x_m, y_m) : 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const SoundRegion& region = regions[i];
    if (region.everywhere && std::isfinite(x_m) && std::isfinite(y_m)) return i;
    if (region.box_m && pipeline::in_box(*region.box_m, x_m, y_m)) return i;
    if (region.label > 0 && region.label == label) return i;
    if (!region.polygon_m.empty() && in_polygon(region.polygon_m, x_m, y_m)) return i;
  }
  return std::nullopt;
}

std::shared_ptr<const SoundBank> make_sound_bank(const pipeline::Scene& scene, int sample_rate_hz) {
  auto bank = std::make_shared<SoundBank>();
  bank->sample_rate_hz = sample_rate_hz;
  const pipeline::SceneDescription& description = scene.description();
  const auto& audio = description.config.audio;
  bank->cues = description.config.cues;
  BankMaker maker(*bank, description);
  maker.add_ground(audio ? audio->material : std::nullopt);
  if (!audio) return bank;
  bank->scrape_gain = audio->friction_sound_gain.value_or(0.0);
  bank->scrape_grain = audio->friction_sound_grain;
  if (audio->labels) bank->labels = load_labels(*audio->labels, description.levels.front());
  for (const pipeline::AudioRegionConfig& region : audio->regions) maker.add(region);
  if (!audio->material) return bank;
  // Parts that have a material sound of it, and what is left of the whole scene's.
  for (const pipeline::PartConfig& part : description.config.parts)
    if (part.touch.material) maker.add_part(part);
  maker.add_everywhere(*audio->material);
  return bank;
}

}  // namespace sparsha::audio

// sparsha sound fit STRIKE.wav: a note for `audio.regions` from a recorded strike.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/terminal/terminal.h"
#include "audio/clip/clip.h"
#include "audio/modal/fit.h"
#include "base/error.h"

namespace sparsha::app {
namespace {

constexpr int kRate_hz = 48000;

struct Arguments {
  std::string file;
  std::size_t modes = 16;
};

std::string yaml_of(const std::vector<scene::ModeConfig>& modes) {
  std::string text = "modal:\n  modes:\n";
  for (const scene::ModeConfig& mode : modes) {
    text += fmt::format("    - {{frequency_hz: {:.3f}, decay_s: {:.4f}, level_db: {:.2f}}}\n", mode.frequency_hz,
                        mode.decay_s, mode.level_db);
  }
  return text;
}

std::string json_of(const std::vector<scene::ModeConfig>& modes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const scene::ModeConfig& mode : modes)
    list.push_back({{"frequency_hz", mode.frequency_hz}, {"decay_s", mode.decay_s}, {"level_db", mode.level_db}});
  return nlohmann::ordered_json{{"modal", {{"modes", list}}}}.dump(2) + "\n";
}

/// ": modes that beat, or a hum, near 440, 655 Hz".
std::string beats_at(const std::vector<double>& frequencies_hz) {
  return fmt::format(": modes that beat, or a hum, near {:.0f} Hz", fmt::join(frequencies_hz, ", "));
}

/// The louder one: the sum of two microphones lacks the modes that reach them in opposite phase.
std::vector<float> louder_channel(const audio::Clip& clip) {
  std::array<double, 2> energy{};
  for (std::size_t i = 0; i < clip.samples.size(); ++i)
    energy[i % 2] += static_cast<double>(clip.samples[i]) * static_cast<double>(clip.samples[i]);
  std::vector<float> mono;
  mono.reserve(clip.frames());
  for (std::size_t i = energy[1] > energy[0] ? 1 : 0; i < clip.samples.size(); i += 2) mono.push_back(clip.samples[i]);
  return mono;
}

int run_fit(const Arguments& arguments, const CommonOptions& common) {
  const audio::Clip clip = audio::load_clip(arguments.file, kRate_hz);
  std::vector<double> uneven_hz;
  const std::vector<scene::ModeConfig> modes =
      audio::fit_modes(louder_channel(clip), kRate_hz, arguments.modes, &uneven_hz);
  if (modes.empty() && uneven_hz.empty())
    throw input_error(arguments.file, "nothing in it rings", "one strike of something that rings for 0.03 s or more");
  if (modes.empty())
    throw input_error(arguments.file, "no tone in it dies away evenly" + beats_at(uneven_hz),
                      "one strike of something whose modes do not beat; or the recording itself, as a clip");
  if (!uneven_hz.empty()) {
    Terminal terminal(common);
    terminal.progress().warn("what does not die away evenly is left out" + beats_at(uneven_hz) +
                             "; the recording itself, as a clip, keeps it");
  }
  print(common.json ? json_of(modes) : common.plain ? modes_sentences(modes) : yaml_of(modes));
  return 0;
}

}  // namespace

void add_sound(Command app, const CommonOptions& common, Run& run) {
  Command command = app.add_subcommand("sound", "Sounds for a scene's regions");
  command.requires_subcommand();
  auto arguments = std::make_shared<Arguments>();
  Command fit = command.add_subcommand("fit", "The modes of a recorded strike, as a `modal:` block");
  fit.add_option("strike", arguments->file, "a recording of one strike: WAV, FLAC, Ogg").required();
  fit.add_option("--modes", arguments->modes, "how many at most")
      .shows_default()
      .check(whole_between(std::size_t{1}, std::size_t{32}));
  fit.callback([arguments, &common, &run] { run = [arguments, &common] { return run_fit(*arguments, common); }; });
}

}  // namespace sparsha::app

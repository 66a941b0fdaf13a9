// sparsha explore SCENE|CONFIG|SCAN: touch, see and hear.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/exploration/devices.h"
#include "app/exploration/exhibits.h"
#include "app/exploration/exploration.h"
#include "app/exploration/explore_arguments.h"
#include "app/exploration/study.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "audio/live/stream.h"
#include "base/error.h"
#include "base/phrases/phrases.h"
#include "base/text/lower_case.h"
#include "base/text/printable.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

void check_output_folder(const std::string& file, const char* option) {
  if (file.empty()) return;
  const fs::path folder = fs::path(file).parent_path();
  std::error_code code;
  if (!folder.empty() && !fs::is_directory(folder, code)) {
    throw usage_error(fmt::format("{} {}: the folder does not exist", option, file), "an existing folder");
  }
  if (fs::is_directory(file, code)) {
    throw usage_error(fmt::format("{} {}: this is a folder", option, file), "the name of a file");
  }
}

void require_ending(const std::string& file, const char* option, const char* ending, const char* what) {
  std::error_code code;
  if (file.empty() || lower_case(fs::path(file).extension().string()) == ending || fs::is_character_file(file, code))
    return;
  throw usage_error(fmt::format("{} {}: {}", option, file, what), fmt::format("a name that ends in {}", ending));
}

// A kiosk without a window has two meanings left: it waits for a device, and it has several scenes.
void refuse_idle(const ExploreArguments& arguments) {
  require_use_of_firmware(arguments.device, arguments.firmware);
  const bool waits = arguments.device != "simulated" && !arguments.device.starts_with("playback:");
  if (arguments.kiosk && arguments.headless && arguments.scenes.empty() && !waits)
    throw usage_error("--kiosk means nothing here", "a window, --scenes DIR or a device for a hand");
}

void check_arguments(const ExploreArguments& arguments) {
  if (arguments.scene.empty() == arguments.scenes.empty())
    throw usage_error(arguments.scene.empty() ? "nothing to explore" : "--scenes and a scene",
                      "a scene, a configuration or scans; or --kiosk --scenes DIR");
  if (!arguments.scenes.empty() && (!arguments.kiosk || arguments.device.starts_with("playback:")))
    throw usage_error("--scenes without an exhibition", "--kiosk --scenes DIR, and a device for a hand");
  refuse_idle(arguments);
  check_output_folder(arguments.record, "--record");
  check_output_folder(arguments.screenshot, "--screenshot");
  check_output_folder(arguments.audio_out, "--audio-out");
  require_ending(arguments.screenshot, "--screenshot", ".png", "the picture is a PNG");
  require_ending(arguments.audio_out, "--audio-out", ".wav", "the sound is a WAV");
  check_study(arguments.study);
  const std::string playback = "playback:";
  const bool plays = arguments.device.starts_with(playback);
  const std::vector<std::string> shown = arguments.scenes.empty() ? arguments.scene : scenes_in(arguments.scenes);
  check_outputs({{"--record", arguments.record},
                 {"--screenshot", arguments.screenshot},
                 {"--audio-out", arguments.audio_out},
                 {"--study", study_file(arguments.study)}},
                shown, {{"--device", plays ? arguments.device.substr(playback.size()) : ""}});
  if (std::isnan(arguments.duration_s)) throw usage_error("--duration nan", "seconds");
}

// One line per device that can play.
int list_audio(const CommonOptions& common) {
  if (common.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const audio::OutputDevice& device : audio::output_devices())
      list.push_back({{"number", device.number},
                      {"name", device.name},
                      {"system", device.system},
                      {"channels", device.channels},
                      {"rate_hz", device.rate_hz},
                      {"latency_s", device.latency_s},
                      {"chosen", device.chosen}});
    print(list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return 0;
  }
  std::string text;
  for (const audio::OutputDevice& device : audio::output_devices()) {
    text +=
        fmt::format("{:>3}{} {} ({}): {} channels, {:.0f} Hz, {:.1f} ms\n", device.number, device.chosen ? '*' : ' ',
                    printable(device.name), device.system, device.channels, device.rate_hz, 1000.0 * device.latency_s);
  }
  print(text.empty() ? "no sound device\n" : text);
  return 0;
}

int run_explore(const ExploreArguments& arguments, const CommonOptions& common) {
  if (arguments.list_audio) return list_audio(common);
  check_arguments(arguments);
  Terminal terminal(common);
  const bool keys = arguments.device == "keys";  // of the terminal, not of a window
  const bool window = !arguments.headless && !keys && viewer::display_available();
  if (!arguments.headless && !window && !keys && arguments.device != "auto") {
    terminal.message("no display: running without a window");
  }
  Exploration exploration(arguments, common, terminal, window);
  exploration.run(window);
  exploration.deliver(common);
  return 0;
}

}  // namespace

void add_explore(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<ExploreArguments>();
  Command command = app.add_subcommand("explore", "Touch, see and hear a scene");
  command.add_option("scene", arguments->scene, "scene folder, configuration or scans").expects(1, -1);
  command.add_option("--device", arguments->device, device_names()).shows_default();
  command.add_flag("--headless", arguments->headless, "no window");
  command.add_option("--duration", arguments->duration_s, "seconds; default: until stopped").check(between(0.001, 1e7));
  command.add_option("--firmware", arguments->firmware,
                     "firmware image for a Falcon that runs none; default: SPARSHA_FALCON_FIRMWARE, "
                     "~/.config/sparsha/falcon.bin");
  command.add_option("--record", arguments->record, "run.csv, one row per tick");
  command.add_option("--screenshot", arguments->screenshot, "view.png, 1280x720, the last touch of the run");
  command.add_option("--audio-out", arguments->audio_out, "run.wav, its start is t_s = 0");
  command.add_option("--audio-device", arguments->audio_device,
                     "what plays the sound: a number or a part of a name; default: JACK, else the system's");
  command.add_flag("--list-audio", arguments->list_audio, "list what can play, and end");
  command.add_flag("--no-texture", arguments->no_texture, "render the envelope, without surface effects");
  command.add_flag("--no-friction", arguments->no_friction, "render without friction");
  command.add_flag("--speech", arguments->speech, "speak announcements");
  command.add_option("--language", arguments->language, "of announcements and speech; default: the scene's, else en")
      .check(one_of(Phrases::languages()));
  command.add_flag("--kiosk", arguments->kiosk, "full screen, for exhibitions");
  command.add_option("--scenes", arguments->scenes, "with --kiosk: a folder of scenes that visitors choose from");
  command.add_option("--memory", arguments->memory, "for the points of scans that are looked at, e.g. 2GB");
  command.add_flag("--direct", arguments->direct, "build scans at once, without turning the object first");
  command.add_option("--study", arguments->study, "append the session and the visitor's rating to NAME.csv");
  command.callback(
      [arguments, &common, &run] { run = [arguments, &common] { return run_explore(*arguments, common); }; });
}

}  // namespace sparsha::app

// sparsha device list|check|monitor|home|calibrate|emulate.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/emulate.h"
#include "app/commands/sentences.h"
#include "app/exploration/speaker.h"
#include "app/terminal/printable.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/phrases.h"
#include "haptics/device/falcon/calibration.h"
#include "haptics/device/falcon/check.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/homing_advice.h"
#include "haptics/device/falcon/usb_transport.h"
#include "haptics/servo/real_time.h"
#include "scene/config/config.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace falcon = haptics::falcon;
using Json = nlohmann::ordered_json;

namespace {

constexpr int kDeviceError = 4;
constexpr double kStandardGravityMPerS2 = 9.80665;

std::string list_sentences(const std::vector<falcon::FoundFalcon>& falcons, bool display) {
  std::string text;
  for (const falcon::FoundFalcon& found : falcons)
    text += fmt::format("The Falcon at bus {} and address {} {}.\n", found.bus, found.address,
                        found.accessible ? "is available" : "is not available: " + found.problem);
  if (falcons.empty()) text += "There is no Falcon.\n";
  text += display ? "The pointer is available: the mouse is the hand.\n"
                  : "The pointer is not available: it needs a display.\n";
  text += "The simulated hand is available: it explores by itself.\n";
  return text + "A recorded run is played back as the device playback, a colon and its file.\n";
}

int list_devices(const CommonOptions& common) {
  const std::vector<falcon::FoundFalcon> falcons = falcon::find_falcons();
  const bool display = viewer::display_available();
  if (common.json) {
    Json json = Json::array();
    for (const falcon::FoundFalcon& found : falcons) {
      json.push_back({{"name", "falcon"},
                      {"bus", found.bus},
                      {"address", found.address},
                      {"available", found.accessible},
                      {"problem", found.problem}});
    }
    if (falcons.empty()) json.push_back({{"name", "falcon"}, {"available", false}, {"problem", "not connected"}});
    json.push_back({{"name", "pointer"}, {"available", display}});
    json.push_back({{"name", "simulated"}, {"available", true}});
    json.push_back({{"name", "playback"}, {"available", true}});
    print(json.dump(2));
    return 0;
  }
  if (common.plain) {
    print(list_sentences(falcons, display));
    return 0;
  }
  std::string text;
  for (const falcon::FoundFalcon& found : falcons) {
    text += fmt::format("falcon      bus {} address {}: {}\n", found.bus, found.address,
                        found.accessible ? "available; `sparsha device check` tests it" : found.problem);
  }
  if (falcons.empty()) text += "falcon      none is connected\n";
  text += fmt::format("pointer     {}\n", display ? "available: the mouse is the hand" : "needs a display");
  text += "simulated   available: a seeded hand explores by itself\n";
  text += "playback    available: playback:FILE repeats a recorded run.csv\n";
  print(text);
  return 0;
}

Json step_json(const falcon::CheckStep& step) {
  static constexpr const char* kResults[] = {"passed", "failed", "skipped"};
  return {{"step", step.name},
          {"result", kResults[static_cast<std::size_t>(step.result)]},
          {"detail", step.detail},
          {"remedy", step.remedy}};
}

// Walks USB, permission, power, firmware, homing and link; what failed comes with its remedy.
int report_check(const falcon::CheckReport& report, const CommonOptions& common) {
  if (common.json) {
    Json steps = Json::array();
    for (const falcon::CheckStep& step : report.steps) steps.push_back(step_json(step));
    const bool linked = report.link.asked > 0;
    print(Json{{"passed", report.passed()},
               {"verdict", linked ? Json(falcon::name_of(report.verdict.grade)) : Json()},
               {"steps", steps},
               {"link",
                {{"asked", report.link.asked},
                 {"answered", report.link.answered},
                 {"rate_hz", report.link.rate_hz},
                 {"p50_ms", report.link.p50_ms},
                 {"p99_ms", report.link.p99_ms},
                 {"max_ms", report.link.max_ms}}}}
              .dump(2));
  } else if (common.plain) {
    print(device_check_sentences(report));
  } else {
    static constexpr const char* kMarks[] = {"ok", "FAILED", "skipped"};
    std::string text;
    for (const falcon::CheckStep& step : report.steps) {
      text += fmt::format("{:<12}{:<9}{}\n", step.name, kMarks[static_cast<std::size_t>(step.result)], step.detail);
      if (!step.remedy.empty()) text += fmt::format("{:21}remedy: {}\n", "", step.remedy);
    }
    if (report.link.asked > 0) text += fmt::format("verdict     {}\n", falcon::name_of(report.verdict.grade));
    print(text);
  }
  return report.passed() ? 0 : kDeviceError;
}

std::string held_buttons(std::uint8_t buttons) {
  static constexpr const char* kNames[] = {"right", "front", "centre", "left"};
  std::string text;
  for (unsigned bit = 0; bit < 4; ++bit)
    if ((buttons >> bit & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : "+", kNames[bit]);
  return text.empty() ? "none" : text;
}

/// What lines of the monitor sum up since the one before.
struct Since {
  double time_s = 0.0;
  std::uint64_t answers = 0;
  double longest_s = 0.0;
};

std::string reading_text(const falcon::Reading& reading, const Since& since) {
  const Eigen::Vector3d mm = reading.position_m * 1e3;
  return fmt::format(
      "{:8.2f} s  {:7.2f} {:7.2f} {:7.2f} mm  {}  buttons {:<8} {:4.0f} answers/s, longest {:.2f} ms", reading.time_s,
      mm.x(), mm.y(), mm.z(), reading.homed ? "homed    " : "not homed", held_buttons(reading.answer.buttons),
      static_cast<double>(since.answers) / std::max(1e-3, reading.time_s - since.time_s), since.longest_s * 1e3);
}

std::string reading_sentence(const falcon::Reading& reading) {
  const Eigen::Vector3d mm = reading.position_m * 1e3;
  return fmt::format(
      "After {:.1f} seconds the grip is at {:.0f}, {:.0f} and {:.0f} millimetres, it is {}, and of its buttons {} "
      "held.",
      reading.time_s, mm.x(), mm.y(), mm.z(), reading.homed ? "homed" : "not homed",
      reading.answer.buttons == 0 ? "none is" : held_buttons(reading.answer.buttons) + " are");
}

Json reading_json(const falcon::Reading& reading, const Since& since) {
  return {{"t_s", reading.time_s},
          {"position_m", {reading.position_m.x(), reading.position_m.y(), reading.position_m.z()}},
          {"homed", reading.homed},
          {"buttons", held_buttons(reading.answer.buttons)},
          {"rate_hz", static_cast<double>(since.answers) / std::max(1e-3, reading.time_s - since.time_s)},
          {"longest_ms", since.longest_s * 1e3}};
}

/// The first Falcon with its firmware running.
std::unique_ptr<falcon::Transport> running_falcon(const falcon::FalconOptions& options) {
  auto wire = falcon::open_usb_transport();
  falcon::bring_up(*wire, falcon::firmware_image(options), 10, falcon::loading(options));
  return wire;
}

/// Prints ten lines a second until stopped.
int monitor_device(const CommonOptions& common, const falcon::FalconOptions& options, double duration_s) {
  const auto wire = running_falcon(options);
  Since since;
  falcon::monitor(*wire, [&](const falcon::Reading& reading) {
    ++since.answers;
    since.longest_s = std::max(since.longest_s, reading.round_trip_s);
    if (reading.time_s >= since.time_s + 0.1) {
      print(common.json    ? reading_json(reading, since).dump()
            : common.plain ? reading_sentence(reading)
                           : reading_text(reading, since));
      flush_output();  // live, and over when nobody reads any more
      since = {reading.time_s, 0, 0.0};
    }
    return !interrupted() && (duration_s <= 0.0 || reading.time_s < duration_s);
  });
  return 0;
}

int calibrate_device(const CommonOptions& common, const falcon::FalconOptions& device_options, double weight_g) {
  falcon::require_calibration_place();
  const Terminal terminal(common);
  falcon::CalibrationOptions options;
  options.weight_n = weight_g * 1e-3 * kStandardGravityMPerS2;
  falcon::FalconOptions usual = device_options;
  usual.counts_per_newton_metre = options.counts_per_newton_metre;
  const auto device = falcon::make_falcon_device(usual);
  if (!haptics::request_real_time(haptics::kServoPriority))
    terminal.message("warning: no real-time priority was granted; hold the weight low over a table");
  const auto found = falcon::calibrate(
      *device, options, [&terminal](const std::string& words) { terminal.message(words); }, interrupted);
  if (!found) throw Error(ErrorKind::failure, {}, "calibration: stopped", "all steps taken");
  falcon::store_calibration(found->counts_per_newton_metre);
  const std::string file = printable(falcon::calibration_file().string());
  if (common.json) {
    print(Json{{"counts_per_newton_metre", found->counts_per_newton_metre},
               {"weight_n", found->weight_n},
               {"empty_n", found->empty_n},
               {"loaded_n", found->loaded_n},
               {"standard_error_n", found->scatter_n},
               {"file", file}}
              .dump(2));
  } else {
    const double scale = found->counts_per_newton_metre;
    const double error = scale * found->scatter_n / (found->loaded_n - found->empty_n);
    print(common.plain
              ? fmt::format("The scale is {:.0f} motor counts per newton metre, give or take {:.0f}. It is kept in {}.",
                            scale, error, file)
              : fmt::format("{:.0f} motor counts per newton metre (+- {:.0f}); kept in {}", scale, error, file));
  }
  return 0;
}

/// Words that are shown, and spoken where that is wanted.
class Guide {
 public:
  Guide(const CommonOptions& common, bool speaks, const std::string& language)
      : terminal_(common), phrases_(Phrases::of(language)), speaker_(config_of(language), speaks, {}) {}
  void say(const char* phrase) {
    haptics::Announcement words;
    words.text = phrases_.text_or(phrase);
    words.sequence = ++said_;
    terminal_.message(words.text);
    speaker_.hear(words);
  }

 private:
  static scene::SpeechConfig config_of(const std::string& language) {
    scene::SpeechConfig config;
    config.language = language;
    return config;
  }
  Terminal terminal_;
  Phrases phrases_;
  Speaker speaker_;
  std::uint64_t said_ = 0;
};

int home_device(const CommonOptions& common, const falcon::FalconOptions& options, Guide& guide) {
  constexpr double kTimeout_s = 60.0;
  const auto wire = running_falcon(options);
  const haptics::DeviceAdvice* told = nullptr;
  double changed_s = 0.0;
  std::uint8_t flags = 0;
  const bool homed = falcon::home(*wire, kTimeout_s, [&](const falcon::Reading& reading) {
    if (reading.answer.homed != flags) changed_s = reading.time_s;
    flags = reading.answer.homed;
    const auto* const advice = falcon::homing_advice(flags, reading.time_s - changed_s > falcon::kSlowHoming_s);
    if (!reading.homed && advice != told) guide.say(advice->phrase);
    told = advice;
    return !interrupted();
  });
  if (homed) {
    print(common.json ? "{\"homed\": true}" : common.plain ? "The Falcon is homed." : "homed");
    return 0;
  }
  if (interrupted()) throw Cancelled();
  throw Error(ErrorKind::device, {}, "the Falcon did not home within a minute",
              "the grip pulled fully out, then pushed fully in");
}

}  // namespace

void add_device(Command app, const CommonOptions& common, Run& run) {
  struct Arguments {
    falcon::FalconOptions device;
    double duration_s = 0.0;
    double link_s = 10.0;
    double weight_g = 200.0;
    bool speech = false;
    std::string language = "en";
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("device", "The haptic device: what is there and what state it is in");
  command.requires_subcommand();
  const auto add = [&](const char* name, const char* what, auto job) {
    Command added = command.add_subcommand(name, what);
    added.callback([job, &run] { run = job; });
    return added;
  };
  arguments->device.stop = interrupted;
  const auto add_on_falcon = [&](const char* name, const char* what, auto job) {
    Command added = add(name, what, [arguments, &common, job] {
      const Terminal terminal(common);
      arguments->device.say = [&terminal](const std::string& words) { terminal.message(words); };
      return job();
    });
    added.add_option("--firmware", arguments->device.firmware, "firmware image for a Falcon that runs none");
    return added;
  };
  add("list", "devices that explore can use now", [&common] { return list_devices(common); });
  add_on_falcon("check", "walk USB, permission, power, firmware, homing and link",
                [arguments, &common] {
                  // Measured as the servo would talk.
                  static_cast<void>(haptics::request_real_time(haptics::kServoPriority));
                  return report_check(falcon::check_falcon(arguments->device, arguments->link_s), common);
                })
      .add_option("--duration", arguments->link_s, "seconds for which the link is measured")
      .check(between(0.1, 3600.0))
      .shows_default();
  add_on_falcon("monitor", "print position, buttons and rate as they come; forces stay zero",
                [arguments, &common] { return monitor_device(common, arguments->device, arguments->duration_s); })
      .add_option("--duration", arguments->duration_s, "seconds; default: until stopped")
      .check(between(0.001, 1e7));
  Command home = add_on_falcon("home", "home the encoders; words say how", [arguments, &common] {
    Guide guide(common, arguments->speech, arguments->language);
    return home_device(common, arguments->device, guide);
  });
  home.add_flag("--speech", arguments->speech, "speak the words");
  home.add_option("--language", arguments->language, "of the words")
      .check(one_of(Phrases::languages()))
      .shows_default();
  add_on_falcon("calibrate", "find the motors' scale with a known weight, and keep it",
                [arguments, &common] { return calibrate_device(common, arguments->device, arguments->weight_g); })
      .add_option("--weight-g", arguments->weight_g, "grams that will hang from the grip")
      .check(between(20.0, 1000.0))
      .shows_default();
  add_emulate(command, common, run);
}

}  // namespace sparsha::app

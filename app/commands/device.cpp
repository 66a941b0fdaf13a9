// sparsha device list|check|monitor|home|calibrate|emulate.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/device_watch.h"
#include "app/commands/emulate.h"
#include "app/commands/sentences.h"
#include "app/exploration/devices.h"
#include "app/exploration/speaker.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/phrases/phrases.h"
#include "base/text/printable.h"
#include "haptics/device/kind.h"
#include "haptics/servo/real_time.h"
#include "scene/config/config.h"
#include "viewer/viewer.h"

namespace sparsha::app {
using Json = nlohmann::ordered_json;

namespace {

constexpr int kDeviceError = 4;
constexpr double kStandardGravityMPerS2 = 9.80665;

haptics::DeviceRequest looked_for() {
  haptics::DeviceRequest request;
  request.window = viewer::display_available();
  return request;
}

std::string list_sentence(const haptics::DeviceKind& kind, const haptics::FoundDevice& found) {
  const std::string place = found.place.empty() ? "" : " at " + found.place;
  if (found.available) return fmt::format("The device {}{} is available: {}.\n", kind.name, place, kind.what);
  return fmt::format("The device {}{} is not available: {}.\n", kind.name, place, found.problem);
}

std::string list_line(const haptics::DeviceKind& kind, const haptics::FoundDevice& found) {
  const std::string place = found.place.empty() ? "" : found.place + ": ";
  return fmt::format("{:<11} {}{}\n", kind.name, place,
                     found.available ? fmt::format("available: {}", kind.what) : found.problem);
}

Json list_json(const haptics::DeviceKind& kind, const haptics::FoundDevice& found) {
  Json json{{"name", kind.name}};
  for (const auto& [name, number] : found.numbers) json[name] = number;
  json["available"] = found.available;
  json["problem"] = found.problem;
  return json;
}

int list_devices(const CommonOptions& common) {
  const haptics::DeviceRequest request = looked_for();
  Json json = Json::array();
  std::string text;
  for (const haptics::DeviceKind& kind : device_kinds())
    for (const haptics::FoundDevice& found : kind.find(request)) {
      json.push_back(list_json(kind, found));
      text += common.plain ? list_sentence(kind, found) : list_line(kind, found);
    }
  print(common.json ? json.dump(2) : text);
  return 0;
}

Json step_json(const haptics::CheckStep& step) {
  static constexpr const char* kResults[] = {"passed", "failed", "skipped"};
  return {{"step", step.name},
          {"result", kResults[static_cast<std::size_t>(step.result)]},
          {"detail", step.detail},
          {"remedy", step.remedy}};
}

// Walks USB, permission, power, firmware, homing and link; what failed comes with its remedy.
int report_check(const haptics::CheckReport& report, const CommonOptions& common) {
  if (common.json) {
    Json steps = Json::array();
    for (const haptics::CheckStep& step : report.steps) steps.push_back(step_json(step));
    const bool linked = report.link.asked > 0;
    print(Json{{"passed", report.passed()},
               {"verdict", linked ? Json(haptics::name_of(report.verdict.grade)) : Json()},
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
    for (const haptics::CheckStep& step : report.steps) {
      text += fmt::format("{:<12}{:<9}{}\n", step.name, kMarks[static_cast<std::size_t>(step.result)], step.detail);
      if (!step.remedy.empty()) text += fmt::format("{:21}remedy: {}\n", "", step.remedy);
    }
    if (report.link.asked > 0) text += fmt::format("verdict     {}\n", haptics::name_of(report.verdict.grade));
    print(text);
  }
  return report.passed() ? 0 : kDeviceError;
}

std::string calibrated_names() {
  std::string names;
  for (const haptics::DeviceKind& kind : device_kinds())
    if (kind.calibrate) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

int calibrate_device(const CommonOptions& common, const haptics::DeviceKind& kind,
                     const haptics::DeviceRequest& request, double weight_g) {
  if (!kind.calibrate)
    throw usage_error(fmt::format("the device '{}' has nothing to calibrate here", kind.name),
                      "a device whose motors' scale is not known: " + calibrated_names());
  if (!haptics::request_real_time(haptics::kServoPriority))
    request.say("warning: no real-time priority was granted; hold the weight low over a table");
  const haptics::CalibrationReport found = kind.calibrate(request, weight_g * 1e-3 * kStandardGravityMPerS2);
  const std::string file = printable(found.file.string());
  if (common.json) {
    Json json;
    for (const auto& [name, value] : found.numbers) json[name] = value;
    json["file"] = file;
    print(json.dump(2));
  } else {
    print(common.plain ? fmt::format("{} It is kept in {}.", found.sentence, file)
                       : fmt::format("{}; kept in {}", found.line, file));
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

}  // namespace

void add_device(Command app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string name = "falcon";
    haptics::DeviceRequest request;
    CheckWish check;
    double duration_s = 0.0;
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
  arguments->request.stop = interrupted;
  const auto add_on_device = [&](const char* name, const char* what, auto job) {
    Command added = add(name, what, [arguments, &common, job] {
      require_use_of_firmware(arguments->name, arguments->request.firmware);
      const Terminal terminal(common);
      arguments->request.say = [&terminal](const std::string& words) { terminal.message(words); };
      return job();
    });
    added.add_option("--firmware", arguments->request.firmware, "firmware image for a Falcon that runs none");
    return added;
  };
  const auto add_on_any = [&](const char* name, const char* what, auto job) {
    Command added = add_on_device(name, what, job);
    added.add_option("--device", arguments->name, named_devices()).shows_default();
    return added;
  };
  add("list", "devices that explore can use now", [&common] { return list_devices(common); });
  Command check = add_on_any("check", "walk every step to the device, with its remedy", [arguments, &common] {
    // Measured as the servo would talk.
    static_cast<void>(haptics::request_real_time(haptics::kServoPriority));
    const NamedKind named = kind_of(arguments->name);
    arguments->request.argument = named.argument;
    return report_check(check_device(*named.kind, arguments->request, arguments->check), common);
  });
  check.add_option("--duration", arguments->check.seconds, "seconds for which the link is measured")
      .check(between(0.1, 3600.0))
      .shows_default();
  check.add_flag("--conformance", arguments->check.conformance,
                 "try what a driver may do wrong, and say what a hand would feel of it; forces stay zero");
  add_on_any("monitor", "print position, buttons and rate as they come; forces stay zero",
             [arguments, &common] {
               arguments->request.watch_only = true;
               return monitor_device(*make_device(arguments->name, arguments->request), common, arguments->duration_s);
             })
      .add_option("--duration", arguments->duration_s, "seconds; default: until stopped")
      .check(between(0.001, 1e7));
  Command home = add_on_any("home", "home the device; words say how", [arguments, &common] {
    Guide guide(common, arguments->speech, arguments->language);
    return home_device(*make_device(arguments->name, arguments->request), common,
                       [&guide](const char* phrase) { guide.say(phrase); });
  });
  home.add_flag("--speech", arguments->speech, "speak the words");
  home.add_option("--language", arguments->language, "of the words")
      .check(one_of(Phrases::languages()))
      .shows_default();
  add_on_any("calibrate", "find the motors' scale of a device with a known weight, and keep it",
             [arguments, &common] {
               const NamedKind named = kind_of(arguments->name);
               arguments->request.argument = named.argument;
               return calibrate_device(common, *named.kind, arguments->request, arguments->weight_g);
             })
      .add_option("--weight-g", arguments->weight_g, "grams that will hang from the grip")
      .check(between(20.0, 1000.0))
      .shows_default();
  add_emulate(command, common, run);
}

}  // namespace sparsha::app

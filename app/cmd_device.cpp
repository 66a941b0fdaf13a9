// sparsha device list|check|monitor|home|emulate.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/cmd_emulate.h"
#include "app/commands.h"
#include "app/terminal.h"
#include "base/error.h"
#include "haptics/device/falcon/check.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/usb_transport.h"
#include "haptics/servo/real_time.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace falcon = haptics::falcon;
using Json = nlohmann::ordered_json;

namespace {

constexpr int kDeviceError = 4;

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

std::string reading_text(const falcon::Reading& reading) {
  const Eigen::Vector3d mm = reading.position_m * 1e3;
  return fmt::format("{:8.3f} s  {:7.2f} {:7.2f} {:7.2f} mm  {}  round trip {:.2f} ms", reading.time_s, mm.x(), mm.y(),
                     mm.z(), reading.homed ? "homed" : "not homed", reading.round_trip_s * 1e3);
}

// Prints ten lines a second until stopped.
int monitor_device(double duration_s) {
  const auto wire = falcon::open_usb_transport();
  double next_s = 0.0;
  falcon::monitor(*wire, [&](const falcon::Reading& reading) {
    if (reading.time_s >= next_s) {
      print(reading_text(reading));
      next_s = reading.time_s + 0.1;
    }
    return !interrupted() && (duration_s <= 0.0 || reading.time_s < duration_s);
  });
  return 0;
}

int home_device(const CommonOptions& common) {
  constexpr double kTimeoutS = 60.0;
  const Terminal terminal(common);
  const auto wire = falcon::open_usb_transport();
  terminal.message("pull the grip fully out, then push it fully in");
  if (falcon::home(*wire, kTimeoutS)) {
    print(common.json ? "{\"homed\": true}" : "homed");
    return 0;
  }
  throw Error(ErrorKind::device, {}, "the Falcon did not home within a minute",
              "the grip pulled fully out, then pushed fully in");
}

}  // namespace

void add_device(CLI::App& app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string firmware;
    double duration_s = 0.0;
    double link_s = 10.0;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("device", "The haptic device: what is there and what state it is in");
  command->require_subcommand(1);
  command->add_subcommand("list", "devices that explore can use now")->callback([&common, &run] {
    run = [&common] { return list_devices(common); };
  });
  CLI::App* check = command->add_subcommand("check", "walk USB, permission, power, firmware, homing and link");
  check->add_option("--firmware", arguments->firmware, "firmware image for a Falcon that runs none");
  check->add_option("--duration", arguments->link_s, "seconds for which the link is measured")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  check->callback([arguments, &common, &run] {
    run = [arguments, &common] {
      falcon::FalconOptions options;
      options.firmware = arguments->firmware;
      static_cast<void>(haptics::request_real_time(haptics::kServoPriority));  // measured as the servo would talk
      return report_check(falcon::check_falcon(options, arguments->link_s), common);
    };
  });
  CLI::App* monitor = command->add_subcommand("monitor", "print positions as they come; forces stay zero");
  monitor->add_option("--duration", arguments->duration_s, "seconds; default: until stopped");
  monitor->callback([arguments, &run] { run = [arguments] { return monitor_device(arguments->duration_s); }; });
  command->add_subcommand("home", "home the encoders")->callback([&common, &run] {
    run = [&common] { return home_device(common); };
  });
  add_emulate(*command, common, run);
}

}  // namespace sparsha::app

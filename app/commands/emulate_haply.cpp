#include "app/commands/emulate_haply.h"

#include <fmt/format.h>

#include <fstream>

#include "app/commands/emulate.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/system/process.h"
#include "emulator/haply_service.h"
#include "haptics/device/haply/haply.h"

namespace sparsha::app {
namespace {

struct Fault {
  const char* name;
  const char* what;
  void (*apply)(emulator::HaplyOptions&);
};

using Options = emulator::HaplyOptions;

// Those in time begin two seconds after the first force, last for one, and come again.
const Fault kFaults[] = {
    {"brake", "the emergency brake is pulled for a second, again and again", [](Options& o) { o.brake = true; }},
    {"disconnect", "the device leaves for a second, again and again", [](Options& o) { o.disconnect = true; }},
    {"events-end", "the port that tells of the emergency brake closes for a second, again and again",
     [](Options& o) { o.loses_events = true; }},
    {"service-ends", "the service ends, and is there again a second later", [](Options& o) { o.dies = true; }},
    {"silence", "no answers for a second, again and again", [](Options& o) { o.silent = true; }},
    {"bad-json", "an answer is no JSON, every three seconds", [](Options& o) { o.malformed = true; }},
    {"bad-frame", "an answer is no frame, every three seconds", [](Options& o) { o.not_framed = true; }},
    {"second-client", "another program pushes by 1.5 N for a second, again and again",
     [](Options& o) { o.second_client = true; }},
    {"late-answers", "answers come 1 to 20 ms late", [](Options& o) { o.late = true; }},
    {"split-frames", "each message comes in three frames and six pieces", [](Options& o) { o.split = true; }},
    {"merged-frames", "two answers come at once", [](Options& o) { o.merged = true; }},
    {"keeps-settings", "basis and preset are others, whatever is configured",
     [](Options& o) { o.keeps_settings = true; }},
    {"other-words", "exponents, unknown keys and kinds, ids last, a wireless grip",
     [](Options& o) { o.other_words = true; }},
    {"no-preset", "the configuration tells of no preset", [](Options& o) { o.no_preset = true; }},
    {"no-damping", "it does not take the damping that it is asked for", [](Options& o) { o.damps = false; }},
    {"version-3.1", "an older service: no events, forces under `values` alone",
     [](Options& o) { o.version_3_1 = true; }},
    {"version-3.6", "a service that nobody knows yet: it takes forces under another key",
     [](Options& o) { o.version_3_6 = true; }},
    {"gate", "the force gate lets 60 % through", [](Options& o) { o.gate = 0.6; }},
    {"two-devices", "there are two", [](Options& o) { o.devices = 2; }},
};

emulator::HaplyOptions options_of(const std::vector<std::string>& names) {
  emulator::HaplyOptions options;
  options.grip_tilt_rad = -0.6;  // as a pen is held
  const haptics::haply::HaplyOptions ports = haptics::haply::options_of({});
  options.port = ports.port;
  options.events_port = ports.events_port;
  apply_faults(kFaults, names, options);
  return options;
}

}  // namespace

std::string haply_faults() {
  std::string text;
  for (const Fault& fault : kFaults) text += fmt::format("\n{}: {}", fault.name, fault.what);
  return text;
}

int emulate_haply(const HaplyEmulation& emulation, const CommonOptions& common) {
  const emulator::HaplyOptions options = options_of(emulation.faults);
  std::ofstream log;
  if (!emulation.log.empty()) {
    log.open(emulation.log, std::ios::binary);
    if (!log) throw usage_error("--log " + emulation.log + ": cannot be written", "a file in an existing folder");
    log << "t_s,direction,message\n";
  }
  emulator::HaplyService service(options, emulator::make_person(emulation.person));
  service.set_log([&log](const emulator::HaplyMessage& message) {
    if (!log.is_open()) return;
    std::string quoted;
    for (const char one : message.text) quoted += one == '"' ? "\"\"" : std::string(1, one);
    log << fmt::format("{:.6f},{},\"{}\"\n", message.time_s, message.to_client ? "in" : "out", quoted);
  });
  std::vector<std::string> command = common.command;
  if (command.empty()) command = {system::program_file().string(), "device", "check", "--device", "haply"};
  const int code = system::run_program(command, {}, interrupted);
  const Terminal terminal(common);
  terminal.message(
      fmt::format("emulated Inverse Service: {} commands, {} of them with force while it was stopped; {:.2f} N at most",
                  service.commands(), service.unsafe_commands(), service.strongest_n()));
  if (log.is_open() && !log.flush())
    throw Error(ErrorKind::failure, {emulation.log}, "the messages could not be written", "a disk with room");
  return code;
}

}  // namespace sparsha::app

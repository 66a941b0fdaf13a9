// sparsha device emulate: runs any program on a USB bus with an emulated Falcon, or beside an emulated Inverse Service.
#include "app/commands/emulate.h"

#include "app/commands/emulate_haply.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/exploration/tour.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "app/words/results.h"
#include "base/error.h"
#include "base/files/files.h"
#include "base/system.h"
#include "base/system/process.h"
#include "emulator/person.h"
#include "emulator/usb_bus.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/simulated/exploration_script.h"
#include "haptics/servo/real_time.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

struct Setting {
  emulator::FalconOptions falcon;
  emulator::BusFaults bus;
  bool second = false;
};

struct Fault {
  const char* name;
  const char* what;
  void (*apply)(Setting&);
};

// Each is what a cable, a hub, a supply or the firmware has been seen to do.
const Fault kFaults[] = {
    {"bad-echo", "the first upload's echo has a wrong byte", [](Setting& s) { s.falcon.corrupt_echo_byte = 2600; }},
    {"lost-bytes", "every 499th byte that the firmware says is lost",
     [](Setting& s) { s.falcon.lose_byte_every = 499; }},
    {"lost-answers", "every 17th command gets no answer", [](Setting& s) { s.falcon.lose_every = 17; }},
    {"split-packets", "answers come in two USB packets", [](Setting& s) { s.falcon.split_answers = true; }},
    {"garbage", "noise between the answers, and every 13th answer malformed",
     [](Setting& s) {
       s.falcon.garbage = true;
       s.falcon.garble_every = 13;
     }},
    {"stall", "every two seconds the IN endpoint stalls until it is cleared",
     [](Setting& s) { s.bus.stall_every_s = 2.0; }},
    {"silence", "every two seconds the firmware says nothing for 0.3 s, its motors as they were",
     [](Setting& s) { s.falcon.silent_every_s = 2.0; }},
    {"failed-transfers", "every 50th transfer fails", [](Setting& s) { s.bus.fail_every = 50; }},
    {"late-answers", "answers come 1 to 20 ms late", [](Setting& s) { s.falcon.latest_answer_s = 0.020; }},
    {"unplug", "2 s after its first force it is unplugged for a second and loses its power, again and again",
     [](Setting& s) { s.bus.unplug_after_s = 2.0; }},
    {"power-cut", "2 s after its first force its power supply is pulled for 3 s, USB stays, again and again",
     [](Setting& s) {
       s.bus.unplug_after_s = 2.0;
       s.bus.replug_after_s = 3.0;
       s.bus.power_only = true;
     }},
    {"dead-port", "2 s after its first force every transfer fails for 1.5 s, its motors as they were",
     [](Setting& s) { s.bus.dead_after_s = 2.0; }},
    {"three-tries", "two uploads echo well and yet run nothing", [](Setting& s) { s.falcon.failed_loads = 2; }},
    {"late-arm", "the right arm's encoder is not homed before 7 s are over",
     [](Setting& s) { s.falcon.arm_missing_s = 7.0; }},
    {"no-event-character", "the USB bridge takes the event character, and answers wait for its timer all the same",
     [](Setting& s) { s.falcon.heeds_event_character = false; }},
    {"deaf", "the boot loader answers only the 20th greeting", [](Setting& s) { s.falcon.deaf_handshakes = 19; }},
    {"no-power", "its power supply is not plugged in", [](Setting& s) { s.falcon.powered = false; }},
    {"warm-start", "another program has left it running and homed",
     [](Setting& s) { s.falcon.firmware_loaded = s.falcon.homed = true; }},
    {"second-falcon", "there are two", [](Setting& s) { s.second = true; }},
};

struct Arguments {
  std::string device = "falcon";
  std::vector<std::string> faults;
  std::string scene;
  std::string log;
  double weight_g = 0.0;
};

Setting setting_of(const std::vector<std::string>& names) {
  Setting setting;
  setting.falcon.firmware_loaded = false;
  apply_faults(kFaults, names, setting);
  return setting;
}

// The person of --scene knows where things are: a tour of its sounds and parts, then rounds by chance.
emulator::Explore tour_through(const scene::SceneDescription& scene) {
  constexpr std::uint64_t kSeed = 1;
  const Eigen::Vector3d centre = haptics::falcon::FalconOptions{}.centre_m;
  auto script = std::make_shared<haptics::ExplorationScript>(kSeed, haptics::falcon::falcon_info().workspace_width_m,
                                                             tour_of(scene));
  return [script, centre](double dt_s, const emulator::Vec3& felt, const emulator::Vec3& hand) {
    const Eigen::Vector3d wish =
        script->advance({felt[0], felt[1], felt[2]}, Eigen::Vector3d(hand[0], hand[1], hand[2]) - centre, dt_s) +
        centre;
    return emulator::Wish{{wish.x(), wish.y(), wish.z()}, static_cast<std::uint8_t>(script->buttons() & 0xFU)};
  };
}

// Bytes on the wire, one packet a line.
class WireLog {
 public:
  explicit WireLog(const std::string& file) : file_(file) {
    if (file.empty()) return;
    out_.open(file, std::ios::binary);
    if (!out_) throw usage_error("--log " + file + ": cannot be written", "a file in an existing folder");
    out_ << "t_s,event,bytes\n";
  }
  void write(const emulator::WireEvent& event) {
    if (!out_.is_open()) return;
    static constexpr const char* kKinds[] = {"out", "in", "control", "plugged", "unplugged", "power-off", "power-on"};
    std::string bytes;
    for (const std::uint8_t byte : event.bytes) bytes += fmt::format("{:02x}", byte);
    const std::lock_guard lock(mutex_);
    out_ << fmt::format("{:.6f},{},{}\n", event.time_s, kKinds[static_cast<std::size_t>(event.kind)], bytes);
    out_.flush();  // whoever watches a run reads along
  }
  /// Throws Error{failure} when not all of it has been written.
  void finish() {
    if (out_.is_open() && !out_.flush())
      throw Error(ErrorKind::failure, {file_}, "the bytes on the wire could not be written", "a disk with room");
  }

 private:
  std::string file_;
  std::ofstream out_;
  std::mutex mutex_;
};

// Bytes for an emulated boot loader, which takes any.
class MadeFirmware {
 public:
  MadeFirmware() : file_(system::temporary_folder() / fmt::format("sparsha-emulated-{}.bin", system::process_id())) {
    std::string bytes(8192, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>((i * 2654435761U) >> 13U);
    write_file(file_, bytes);
  }
  ~MadeFirmware() {
    std::error_code code;
    fs::remove(file_, code);
  }
  MadeFirmware(const MadeFirmware&) = delete;
  MadeFirmware& operator=(const MadeFirmware&) = delete;
  [[nodiscard]] const fs::path& file() const { return file_; }

 private:
  fs::path file_;
};

int run_emulate(const Arguments& arguments, const CommonOptions& common) {
  const bool haply = arguments.device == "haply";
  const Setting setting = haply ? Setting() : setting_of(arguments.faults);
  check_outputs({{"--log", arguments.log}}, {arguments.scene});
  Terminal terminal(common);
  emulator::PersonOptions person;
  person.weight_kg = arguments.weight_g * 1e-3;
  if (!arguments.scene.empty())
    person.explore = tour_through(scene_from({arguments.scene}, common.trusted(), terminal.progress())->description());
  if (haply) return emulate_haply({arguments.faults, arguments.log, person}, common);
  WireLog log(arguments.log);
  auto falcon = std::make_shared<emulator::Falcon>(setting.falcon);
  falcon->set_hand(emulator::make_person(person));
  falcon->set_log([&log](const emulator::WireEvent& event) { log.write(event); });
  std::vector<std::shared_ptr<emulator::Falcon>> falcons{falcon};
  if (setting.second) falcons.push_back(std::make_shared<emulator::Falcon>(setting.falcon));

  std::vector<std::string> command = common.command;
  if (command.empty()) {
    command = {system::program_file().string(), "device", "check"};
    if (common.json) command.insert(command.begin() + 1, "--json");
  }
  int code = 0;
  double requests = -1.0;
  {
    // The device's own time does not wait for this machine's other programs, where that is granted. The bus's threads
    // inherit it; COMMAND does not.
    constexpr int kBusPriority = 75;
    static_cast<void>(haptics::request_real_time(kBusPriority));
    emulator::UsbBus bus(falcons, setting.bus);
    std::optional<MadeFirmware> firmware;
    auto environment = emulator::UsbBus::environment();
    if (std::getenv("SPARSHA_FALCON_FIRMWARE") == nullptr)
      environment.emplace_back("SPARSHA_FALCON_FIRMWARE", firmware.emplace().file().string());
    code = system::run_program(command, environment, interrupted);
    // What a program leaves behind, such as a guard of its motors, has as long as with a real Falcon.
    constexpr std::chrono::milliseconds kLook{10};
    constexpr int kLooks = 100;
    for (int look = 0; look < kLooks && falcon->motors() != std::array<int, 3>{}; ++look)
      std::this_thread::sleep_for(kLook);
    requests = bus.requests_per_command(0);
  }
  const bool force = falcon->motors() != std::array<int, 3>{};
  terminal.message(fmt::format(
      "emulated Falcon: {} commands, {} of them with force before homing{}; motors {} at the end", falcon->commands(),
      falcon->unsafe_commands(), requests < 0.0 ? "" : fmt::format("; {:.1f} requests of the bus for each", requests),
      force ? "ON" : "off"));
  if (force) return static_cast<int>(ErrorKind::device);
  if (code == 0) log.finish();  // else what the command says counts more
  return code;
}

}  // namespace

void add_emulate(Command device, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = device.add_subcommand(
      "emulate",
      "run a program with an emulated Falcon on an emulated USB bus (umockdev), or beside an emulated Inverse Service");
  std::string faults = "what is wrong with it; may be given more than once:";
  for (const Fault& fault : kFaults) faults += fmt::format("\n{}: {}", fault.name, fault.what);
  faults += "\nOf haply:" + haply_faults();
  command.add_option("--device", arguments->device, "what is emulated")
      .check(one_of({"falcon", "haply"}))
      .shows_default();
  command.add_option("--fault", arguments->faults, faults).expects(1).collects();
  command.add_option("--scene", arguments->scene, "what the person at the grip tours");
  command.add_option("--weight-g", arguments->weight_g, "grams that the person hangs from the grip, for calibrate")
      .check(between(0.0, 1000.0));
  command.add_option("--log", arguments->log, "all bytes on the wire, as CSV");
  command.footer("sparsha device emulate [OPTIONS] -- COMMAND...; without one: device check");
  command.callback(
      [arguments, &common, &run] { run = [arguments, &common] { return run_emulate(*arguments, common); }; });
}

}  // namespace sparsha::app

#include "emulator/usb_bus.h"

#include <cstdlib>
#include <cstring>

#include "base/error.h"

#if defined(SPARSHA_HAVE_UMOCKDEV)
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "base/files/files.h"
#include "base/system.h"
#include "emulator/usb_descriptors.h"
#include "emulator/usb_port.h"
#endif

namespace sparsha::emulator {
namespace {

constexpr const char* kPreload = "libumockdev-preload.so.0";

}  // namespace

bool UsbBus::preloaded() {
  const char* preload = std::getenv("LD_PRELOAD");
  return preload != nullptr && std::strstr(preload, "umockdev") != nullptr;
}

std::vector<std::pair<std::string, std::string>> UsbBus::environment() {
  const char* others = std::getenv("LD_PRELOAD");
  if (preloaded()) return {{"LD_PRELOAD", others}};
  return {{"LD_PRELOAD", others == nullptr ? kPreload : std::string(kPreload) + ":" + others}};
}

#if !defined(SPARSHA_HAVE_UMOCKDEV)

struct UsbBus::Implementation {};
UsbBus::UsbBus(std::vector<std::shared_ptr<Falcon>>, const BusFaults&) {
  throw Error(ErrorKind::device, {}, "no emulated USB bus: this program was built without umockdev",
              "a build on Linux with libumockdev-dev");
}
UsbBus::~UsbBus() = default;
void UsbBus::unplug(std::size_t) {}
void UsbBus::replug(std::size_t, bool) {}
void UsbBus::hold_writes(std::size_t, bool) {}
double UsbBus::requests_per_command(std::size_t) const { return -1.0; }
double UsbBus::now_s() const { return 0.0; }

#else

namespace {

using Steady = std::chrono::steady_clock;
constexpr int kFirstAddress = 5;

/// Throws where umockdev would end the program: it keeps the bus in a folder for temporary files.
UMockdevTestbed* make_testbed(const Umockdev& umock) {
  require_writable(system::temporary_folder() / "umockdev");
  UMockdevTestbed* const testbed = umock.testbed_new();
  // umockdev keeps a connection to this for each name under /dev that is looked for in vain, and ends the program at
  // the fiftieth: ALSA looks for 32 sound cards.
  std::error_code code;
  if (const char* const root = std::getenv("UMOCKDEV_DIR"))
    std::filesystem::remove(std::filesystem::path(root) / "ioctl" / "_default", code);
  return testbed;
}

std::string descriptors_in_hex() {
  std::string hex;
  for (const std::uint8_t byte : kDeviceDescriptor) hex += fmt::format("{:02x}", byte);
  for (const std::uint8_t byte : kConfigurationDescriptor) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace

struct UsbBus::Implementation {
  struct Place {
    Implementation* bus = nullptr;
    std::unique_ptr<UsbPort> port;
    std::string path;  ///< of the port in sysfs
    std::string node;
    UMockdevIoctlBase* handler = nullptr;
  };

  Implementation(std::vector<std::shared_ptr<Falcon>> falcons, const BusFaults& bus_faults)
      : umock(umockdev()), faults(bus_faults), testbed(make_testbed(umock)) {
    for (std::size_t i = 0; i < falcons.size(); ++i) {
      auto place = std::make_unique<Place>();
      place->bus = this;
      place->port = std::make_unique<UsbPort>(umock, std::move(falcons[i]), faults);
      place->path = fmt::format("/devices/usb1/1-{}", i + 1);
      places.push_back(std::move(place));
      attach(*places.back());
    }
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    thread.join();
    for (const auto& place : places) detach(*place);
    umock.object_unref(testbed);
  }

  void attach(Place& place) {
    const int address = next_address++;
    place.node = fmt::format("/dev/bus/usb/001/{:03}", address);
    place.handler = umock.ioctl_base_new();
    umock.signal_connect(place.handler, "handle-ioctl", G_CALLBACK(&Implementation::on_ioctl), &place, nullptr,
                         G_CONNECT_AFTER);
    umock.attach_ioctl(testbed, place.node.c_str(), place.handler, nullptr);
    const std::string text = fmt::format(
        "P: {0}\nN: bus/usb/001/{1:03}\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM={1:03}\n"
        "E: DEVNAME=/dev/bus/usb/001/{1:03}\nE: DEVTYPE=usb_device\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\n"
        "A: devnum={1}\\n\nA: speed=12\\n\nA: idVendor=0403\\n\nA: idProduct=cb48\\n\nA: product={3}\\n\nH: "
        "descriptors={2}\n",
        place.path, address, descriptors_in_hex(), kProduct);
    umock.add_from_string(testbed, text.c_str(), nullptr);
  }

  void detach(Place& place) {
    if (place.handler == nullptr) return;
    umock.detach_ioctl(testbed, place.node.c_str(), nullptr);
    umock.object_unref(place.handler);
    place.handler = nullptr;
  }

  [[nodiscard]] double now_s() const { return std::chrono::duration<double>(Steady::now() - began).count(); }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, Place* place) {
    Implementation& self = *place->bus;
    bool sooner = false;
    {
      const std::lock_guard lock(self.mutex);
      place->port->handle(client, self.now_s());
      sooner = place->port->next_s() < self.served_next_s;
    }
    if (sooner) self.wake.notify_all();
    return gboolean{1};
  }

  void run() {
    std::unique_lock lock(mutex);
    while (!stopping) {
      for (std::size_t i = 0; i < places.size(); ++i) pull_and_push(lock, i);
      const double now = now_s();
      double next = now + 0.1;
      for (const auto& place : places) {
        place->port->serve(now);
        next = std::min(next, place->port->next_s());
      }
      served_next_s = next;
      if (next > now)
        wake.wait_until(lock,
                        began + std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(next)));
    }
  }

  /// The fault of a plug that does not hold.
  void pull_and_push(std::unique_lock<std::mutex>& lock, std::size_t i) {
    if (faults.unplug_after_s <= 0.0) return;
    UsbPort& port = *places[i]->port;
    const double first = port.first_force_s();
    if (first < 0.0) return;
    const double in_use_s = now_s() - first;
    const bool works = faults.power_only ? port.falcon().powered() : port.falcon().plugged();
    const bool pull = works && in_use_s > faults.unplug_after_s;
    const bool push = !works && in_use_s > faults.unplug_after_s + faults.replug_after_s;
    if (!pull && !push) return;
    if (faults.power_only) {
      port.falcon().set_power(push, now_s());
      if (push) port.count_from_now();
      return;
    }
    lock.unlock();
    if (pull) unplug(i, false);
    if (push) replug(i, false);
    lock.lock();
  }

  void unplug(std::size_t i, bool power) {
    Place& place = *places.at(i);
    {
      const std::lock_guard lock(mutex);
      if (!place.port->falcon().plugged()) return;
      place.port->falcon().unplug(power, now_s());
      place.port->disconnect();
    }
    umock.uevent(testbed, ("/sys" + place.path).c_str(), "remove");
    umock.remove_device(testbed, ("/sys" + place.path).c_str());
  }

  void replug(std::size_t i, bool power) {
    Place& place = *places.at(i);
    if (place.port->falcon().plugged()) return;
    detach(place);
    if (!power) place.port->falcon().power_cycle();
    {
      const std::lock_guard lock(mutex);
      place.port->count_from_now();
      place.port->falcon().plug(now_s());
    }
    attach(place);
    umock.uevent(testbed, ("/sys" + place.path).c_str(), "add");
  }

  const Umockdev& umock;
  BusFaults faults;
  UMockdevTestbed* testbed;
  std::vector<std::unique_ptr<Place>> places;
  int next_address = kFirstAddress;
  Steady::time_point began = Steady::now();
  std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  double served_next_s = 0.0;  ///< when the thread looks at the ports again, unless it is woken
  std::thread thread;
};

UsbBus::UsbBus(std::vector<std::shared_ptr<Falcon>> falcons, const BusFaults& faults)
    : implementation_(std::make_unique<Implementation>(std::move(falcons), faults)) {}
UsbBus::~UsbBus() = default;
void UsbBus::unplug(std::size_t port) { implementation_->unplug(port, true); }
void UsbBus::replug(std::size_t port, bool power) { implementation_->replug(port, power); }
void UsbBus::hold_writes(std::size_t port, bool on) {
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->places.at(port)->port->hold_writes(on, implementation_->now_s());
  }
  implementation_->wake.notify_all();
}
double UsbBus::requests_per_command(std::size_t port) const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->places.at(port)->port->requests_per_command();
}
double UsbBus::now_s() const { return implementation_->now_s(); }

#endif

}  // namespace sparsha::emulator

// usbfs requests answered by the emulator, through umockdev.
#include "emulated_bus.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <list>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

namespace emulated_bus {
namespace {

using sparsha::haptics::falcon::FalconEmulator;
using sparsha::haptics::falcon::Request;
using Steady = std::chrono::steady_clock;

const char* const kNode = "/dev/bus/usb/001/005";
// Device: 2.0, vendor class, 64 bytes, 0403:cb48. Configuration: one interface, bulk IN 0x81 and bulk OUT 0x02 of 64
// bytes.
const char* const kDescription =
    "P: /devices/usb1/1-1\n"
    "N: bus/usb/001/005\n"
    "E: SUBSYSTEM=usb\n"
    "E: DRIVER=usb\n"
    "E: BUSNUM=001\n"
    "E: DEVNUM=005\n"
    "E: DEVNAME=/dev/bus/usb/001/005\n"
    "E: DEVTYPE=usb_device\n"
    "A: bConfigurationValue=1\\n\n"
    "A: busnum=1\\n\n"
    "A: devnum=5\\n\n"
    "A: speed=12\\n\n"
    "H: descriptors="
    "120100020000004003044"
    "8cb000400000001"
    "09022000010100802d"
    "0904000002ffffff00"
    "07058102400000"
    "07050202400000\n";

/// A request block on its way. umockdev's reference is ours.
struct Block {
  UMockdevIoctlData* data = nullptr;
  [[nodiscard]] usbdevfs_urb& urb() const { return *reinterpret_cast<usbdevfs_urb*>(data->data); }
  [[nodiscard]] std::uint8_t* bytes() const { return static_cast<std::uint8_t*>(urb().buffer); }
};

}  // namespace

bool possible() {
  const char* preloaded = std::getenv("LD_PRELOAD");
  return preloaded != nullptr && std::strstr(preloaded, "umockdev") != nullptr;
}

struct Bus::Implementation {
  std::shared_ptr<FalconEmulator> falcon;
  UMockdevTestbed* testbed = nullptr;
  UMockdevIoctlBase* handler = nullptr;
  std::list<Block> waiting;  ///< reads without data yet
  std::deque<Block> finished;
  Steady::time_point began = Steady::now();
  Steady::time_point asked = began;  ///< last write: its answer takes a frame

  ~Implementation() {
    for (const Block& block : waiting) umockdev_ioctl_data_unref(block.data);
    for (const Block& block : finished) umockdev_ioctl_data_unref(block.data);
  }

  void submit(UMockdevIoctlData* argument) {
    Block block{umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr)};
    usbdevfs_urb& urb = block.urb();
    UMockdevIoctlData* buffer = umockdev_ioctl_data_resolve(block.data, offsetof(usbdevfs_urb, buffer),
                                                            static_cast<gsize>(urb.buffer_length), nullptr);
    if (buffer != nullptr) umockdev_ioctl_data_unref(buffer);  // the block keeps it
    const double now_s = std::chrono::duration<double>(Steady::now() - began).count();
    urb.status = 0;
    if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
      const std::uint8_t* setup = block.bytes();
      if (setup[0] == 0x40)
        falcon->control(static_cast<Request>(setup[1]), static_cast<std::uint16_t>(setup[2] | (setup[3] << 8U)));
      urb.actual_length = 0;
      finished.push_back(block);
    } else if (urb.endpoint == 0x02) {
      falcon->write({block.bytes(), static_cast<std::size_t>(urb.buffer_length)}, now_s);
      asked = Steady::now();
      urb.actual_length = urb.buffer_length;
      finished.push_back(block);
    } else {
      waiting.push_back(block);
    }
  }

  /// True when a finished block was handed back.
  bool reap(UMockdevIoctlData* argument) {
    if (finished.empty() && !waiting.empty() && Steady::now() - asked > std::chrono::microseconds(500)) {
      const auto data = falcon->read();
      // Nothing to say: modem status once the latency timer runs out.
      if (!data.empty() || Steady::now() - asked > std::chrono::milliseconds(16)) {
        Block block = waiting.front();
        waiting.pop_front();
        block.bytes()[0] = 0x01;
        block.bytes()[1] = 0x60;
        std::memcpy(block.bytes() + 2, data.data(), data.size());
        block.urb().actual_length = static_cast<int>(2 + data.size());
        asked = data.empty() ? Steady::now() : asked;
        finished.push_back(block);
      }
    }
    if (finished.empty()) return false;
    const Block block = finished.front();
    finished.pop_front();
    UMockdevIoctlData* pointer = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
    umockdev_ioctl_data_set_ptr(pointer, 0, block.data);
    umockdev_ioctl_data_unref(pointer);
    umockdev_ioctl_data_unref(block.data);
    return true;
  }

  bool discard(UMockdevIoctlData* argument) {
    const gulong address = *reinterpret_cast<gulong*>(argument->data);
    for (auto block = waiting.begin(); block != waiting.end(); ++block) {
      if (block->data->client_addr != address) continue;
      block->urb().status = -ENOENT;
      block->urb().actual_length = 0;
      finished.push_back(*block);
      waiting.erase(block);
      return true;
    }
    return false;
  }

  static gboolean handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, Implementation* self) {
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    const auto done = [client](glong result, int error) {
      umockdev_ioctl_client_complete(client, result, error);
      return gboolean{1};
    };
    if (!self->falcon->plugged()) return done(-1, ENODEV);
    switch (umockdev_ioctl_client_get_request(client)) {
      case USBDEVFS_GET_CAPABILITIES: {
        UMockdevIoctlData* flags = umockdev_ioctl_data_resolve(argument, 0, sizeof(guint32), nullptr);
        *reinterpret_cast<guint32*>(flags->data) = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                                   USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
        umockdev_ioctl_data_unref(flags);
        return done(0, 0);
      }
      case USBDEVFS_CLAIMINTERFACE:
      case USBDEVFS_RELEASEINTERFACE:
      case USBDEVFS_DISCONNECT_CLAIM:
      case USBDEVFS_CLEAR_HALT:
      case USBDEVFS_RESET:
        return done(0, 0);
      case USBDEVFS_GETDRIVER:
        return done(-1, ENODATA);
      case USBDEVFS_SUBMITURB:
        self->submit(argument);
        return done(0, 0);
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY:
        return self->reap(argument) ? done(0, 0) : done(-1, EAGAIN);
      case USBDEVFS_DISCARDURB:
        return self->discard(argument) ? done(0, 0) : done(-1, EINVAL);
      default:
        return done(-1, ENOTTY);
    }
  }
};

Bus::Bus(std::shared_ptr<FalconEmulator> falcon) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.falcon = std::move(falcon);
  self.testbed = umockdev_testbed_new();
  self.handler = umockdev_ioctl_base_new();
  g_signal_connect_after(self.handler, "handle-ioctl", G_CALLBACK(&Implementation::handle), &self);
  umockdev_testbed_attach_ioctl(self.testbed, kNode, self.handler, nullptr);
  umockdev_testbed_add_from_string(self.testbed, kDescription, nullptr);
}

Bus::~Bus() {
  umockdev_testbed_detach_ioctl(implementation_->testbed, kNode, nullptr);
  g_object_unref(implementation_->handler);
  g_object_unref(implementation_->testbed);
}

}  // namespace emulated_bus

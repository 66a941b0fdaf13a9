// libusb behind Transport: blocking transfers while opening; then one read always outstanding and writes from a small
// pool.
#include "haptics/device/falcon/usb_transport.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>

#include <libusb.h>

#include "base/error.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/packet.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
constexpr unsigned char kOut = 0x02, kIn = 0x81;
constexpr int kInterface = 0;
constexpr unsigned kControlTimeout_ms = 1000;
constexpr unsigned kPostTimeout_ms = 100;
constexpr std::size_t kPosts = 4, kUrgent = 4, kReceived = 8;
const char* const kUdevRule =
    "a udev rule, e.g. /etc/udev/rules.d/40-falcon.rules: SUBSYSTEM==\"usb\", ATTR{idVendor}==\"0403\", "
    "ATTR{idProduct}==\"cb48\", MODE=\"0664\", GROUP=\"plugdev\"; then replug";

/// libusb's context, closed with its last user.
class Context {
 public:
  Context() {
    if (libusb_init(&context_) != 0) context_ = nullptr;
  }
  ~Context() {
    if (context_ != nullptr) libusb_exit(context_);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  [[nodiscard]] libusb_context* get() const { return context_; }

 private:
  libusb_context* context_ = nullptr;
};

/// Calls `visit` for each Falcon until it returns true.
template <typename Visit>
void each_falcon(libusb_context* context, const Visit& visit) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context, &devices);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[i], &descriptor) != 0) continue;
    if (descriptor.idVendor == kVendor && descriptor.idProduct == kProduct && visit(devices[i])) break;
  }
  if (devices != nullptr) libusb_free_device_list(devices, 1);
}

class UsbTransport final : public Transport {
 public:
  UsbTransport() {
    if (context_.get() == nullptr)
      throw Error(ErrorKind::device, {}, "Falcon: this machine has no USB",
                  "a machine with USB, or --device pointer or simulated");
    int status = LIBUSB_ERROR_NO_DEVICE;
    each_falcon(context_.get(), [&](libusb_device* device) {
      status = libusb_open(device, &handle_);
      return status == 0;
    });
    if (status == LIBUSB_ERROR_ACCESS)
      throw Error(ErrorKind::device, {}, "Falcon: this user may not open it", kUdevRule);
    if (status != 0)
      throw Error(ErrorKind::device, {}, "no Falcon is plugged in",
                  "a Novint Falcon (USB 0403:cb48), or --device pointer or simulated");
    static_cast<void>(libusb_set_auto_detach_kernel_driver(handle_, 1));
    status = libusb_claim_interface(handle_, kInterface);
    if (status != 0) {
      libusb_close(handle_);
      throw Error(ErrorKind::device, {},
                  std::string("Falcon: another program holds it (") + libusb_error_name(status) + ")",
                  "that program ended");
    }
    for (Slot& slot : posts_) prepare(slot);
    for (Slot& slot : urgents_) prepare(slot);
    incoming_.transfer = libusb_alloc_transfer(0);
  }

  ~UsbTransport() override {
    const auto busy = [this] {
      bool any = incoming_.busy.load();
      for (Slot& slot : posts_) any = any || slot.busy.load();
      for (Slot& slot : urgents_) any = any || slot.busy.load();
      return any;
    };
    closing_.store(true);
    // What was posted (zeros) goes out; the read that waits for answers is called back.
    const Steady::time_point limit = Steady::now() + std::chrono::milliseconds(500);
    if (incoming_.busy.load()) libusb_cancel_transfer(incoming_.transfer);
    while (busy() && Steady::now() < limit) {
      timeval wait{0, 10000};
      libusb_handle_events_timeout_completed(context_.get(), &wait, nullptr);
    }
    if (!busy()) {  // else the system still owns them: better lost than freed
      libusb_free_transfer(incoming_.transfer);
      for (Slot& slot : posts_) libusb_free_transfer(slot.transfer);
      for (Slot& slot : urgents_) libusb_free_transfer(slot.transfer);
    }
    libusb_release_interface(handle_, kInterface);
    libusb_close(handle_);
  }

  TransportStatus control(Request request, std::uint16_t value) noexcept override {
    constexpr std::uint8_t kVendorOut = 0x40;
    const int status = libusb_control_transfer(handle_, kVendorOut, static_cast<std::uint8_t>(request), value, 0,
                                               nullptr, 0, kControlTimeout_ms);
    return status >= 0 ? TransportStatus::ok : status_of(status);
  }

  TransportStatus write(std::span<const std::uint8_t> bytes, int timeout_ms) noexcept override {
    std::array<std::uint8_t, kUsbPacketBytes> copy{};
    const std::size_t size = std::min(bytes.size(), copy.size());
    std::memcpy(copy.data(), bytes.data(), size);
    int sent = 0;
    const int status = libusb_bulk_transfer(handle_, kOut, copy.data(), static_cast<int>(size), &sent,
                                            static_cast<unsigned>(timeout_ms));
    if (status != 0) return status_of(status);
    return static_cast<std::size_t>(sent) == size ? TransportStatus::ok : TransportStatus::nothing;
  }

  TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept override {
    if (incoming_.busy.load()) return receive(packet, size, timeout_ms * 1e-3);
    int got = 0;
    const int status = libusb_bulk_transfer(handle_, kIn, packet.data(), static_cast<int>(packet.size()), &got,
                                            static_cast<unsigned>(std::max(1, timeout_ms)));
    size = static_cast<std::size_t>(got);
    if (status == LIBUSB_ERROR_TIMEOUT && got > 0) return TransportStatus::ok;
    return status == 0 ? TransportStatus::ok : status_of(status);
  }

  TransportStatus post(std::span<const std::uint8_t> bytes) noexcept override { return submit(posts_, bytes); }

  TransportStatus receive(UsbPacket& packet, std::size_t& size, double timeout_s) noexcept override {
    const Steady::time_point limit = Steady::now() + std::chrono::duration_cast<Steady::duration>(
                                                         std::chrono::duration<double>(std::max(0.0, timeout_s)));
    for (;;) {
      if (received_count_ > 0) {
        packet = received_[received_first_].bytes;
        size = received_[received_first_].size;
        received_first_ = (received_first_ + 1) % kReceived;
        --received_count_;
        return TransportStatus::ok;
      }
      if (gone_.load(std::memory_order_relaxed)) return TransportStatus::gone;
      if (!incoming_.busy.load() && !listen()) return TransportStatus::gone;
      const auto left = std::chrono::duration_cast<std::chrono::microseconds>(limit - Steady::now()).count();
      timeval wait{static_cast<time_t>(std::max<long>(0, left) / 1000000), std::max<long>(0, left) % 1000000};
      static_cast<void>(libusb_handle_events_timeout_completed(context_.get(), &wait, nullptr));
      if (received_count_ == 0 && !gone_.load(std::memory_order_relaxed) && Steady::now() >= limit)
        return TransportStatus::nothing;
    }
  }

  void urgent(std::span<const std::uint8_t> bytes) noexcept override { static_cast<void>(submit(urgents_, bytes)); }

 private:
  struct Slot {
    libusb_transfer* transfer = nullptr;
    std::array<std::uint8_t, kUsbPacketBytes> bytes{};
    std::atomic<bool> busy{false};
    UsbTransport* owner = nullptr;
  };
  struct Received {
    UsbPacket bytes{};
    std::size_t size = 0;
  };

  void prepare(Slot& slot) {
    slot.transfer = libusb_alloc_transfer(0);
    slot.owner = this;
  }

  TransportStatus status_of(int status) noexcept {
    if (status == LIBUSB_ERROR_TIMEOUT) return TransportStatus::nothing;
    gone_.store(true, std::memory_order_relaxed);
    return TransportStatus::gone;
  }

  template <std::size_t N>
  TransportStatus submit(std::array<Slot, N>& slots, std::span<const std::uint8_t> bytes) noexcept {
    if (gone_.load(std::memory_order_relaxed)) return TransportStatus::gone;
    for (Slot& slot : slots) {
      bool idle = false;
      if (slot.transfer == nullptr || !slot.busy.compare_exchange_strong(idle, true)) continue;
      const std::size_t size = std::min(bytes.size(), slot.bytes.size());
      std::memcpy(slot.bytes.data(), bytes.data(), size);
      libusb_fill_bulk_transfer(slot.transfer, handle_, kOut, slot.bytes.data(), static_cast<int>(size), &sent, &slot,
                                kPostTimeout_ms);
      const int status = libusb_submit_transfer(slot.transfer);
      if (status == 0) return TransportStatus::ok;
      slot.busy.store(false);
      return status == LIBUSB_ERROR_BUSY ? TransportStatus::nothing : status_of(status);
    }
    return TransportStatus::nothing;
  }

  static void LIBUSB_CALL sent(libusb_transfer* transfer) {
    auto& slot = *static_cast<Slot*>(transfer->user_data);
    if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) slot.owner->gone_.store(true, std::memory_order_relaxed);
    slot.busy.store(false);
  }

  bool listen() noexcept {
    libusb_fill_bulk_transfer(incoming_.transfer, handle_, kIn, incoming_.bytes.data(),
                              static_cast<int>(incoming_.bytes.size()), &arrived, this, 0);
    incoming_.busy.store(true);
    if (libusb_submit_transfer(incoming_.transfer) == 0) return true;
    incoming_.busy.store(false);
    gone_.store(true, std::memory_order_relaxed);
    return false;
  }

  static void LIBUSB_CALL arrived(libusb_transfer* transfer) {
    auto& self = *static_cast<UsbTransport*>(transfer->user_data);
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
      const auto size = static_cast<std::size_t>(transfer->actual_length);
      if (size > kModemBytes) {
        if (self.received_count_ == kReceived) {  // nobody listens: the oldest goes
          self.received_first_ = (self.received_first_ + 1) % kReceived;
          --self.received_count_;
        }
        Received& slot = self.received_[(self.received_first_ + self.received_count_++) % kReceived];
        slot.bytes = self.incoming_.bytes;
        slot.size = size;
      }
      if (!self.closing_.load() && libusb_submit_transfer(transfer) == 0) return;
    }
    if (!self.closing_.load()) self.gone_.store(true, std::memory_order_relaxed);
    self.incoming_.busy.store(false);
  }

  Context context_;
  libusb_device_handle* handle_ = nullptr;
  std::array<Slot, kPosts> posts_{};
  std::array<Slot, kUrgent> urgents_{};
  Slot incoming_;
  std::array<Received, kReceived> received_{};
  std::size_t received_first_ = 0;
  std::size_t received_count_ = 0;
  std::atomic<bool> gone_{false};
  std::atomic<bool> closing_{false};
};

}  // namespace

std::unique_ptr<Transport> open_usb_transport() { return std::make_unique<UsbTransport>(); }

std::vector<FoundFalcon> find_falcons() {
  std::vector<FoundFalcon> found;
  const Context context;
  if (context.get() == nullptr) return found;
  each_falcon(context.get(), [&found](libusb_device* device) {
    FoundFalcon falcon;
    falcon.bus = libusb_get_bus_number(device);
    falcon.address = libusb_get_device_address(device);
    libusb_device_handle* handle = nullptr;
    const int status = libusb_open(device, &handle);
    falcon.accessible = status == 0;
    if (status == LIBUSB_ERROR_ACCESS)
      falcon.problem = std::string("this user may not open it; expected ") + kUdevRule;
    else if (status != 0)
      falcon.problem = libusb_error_name(status);
    if (handle != nullptr) libusb_close(handle);
    found.push_back(falcon);
    return false;
  });
  return found;
}

}  // namespace sparsha::haptics::falcon

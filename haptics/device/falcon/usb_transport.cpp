// libusb behind Transport: blocking transfers while opening; then one read always outstanding and writes from a small
// pool.
#include "haptics/device/falcon/usb_transport.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

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
/// A question that the bus has not taken by then is called back. Not by libusb's own time-out, whose timer is set and
/// stopped for every transfer: two calls of the system a tick.
constexpr std::int64_t kPostTimeout_ns = 100'000'000;
constexpr std::int64_t kFailsForGood_ns = 1'000'000'000;
constexpr std::chrono::microseconds kRetryPause{500};
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

/// Where a device is plugged in: bus, then the ports on the way to it. Stays when it is unplugged and plugged in again.
std::vector<int> place_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::vector<int> place{libusb_get_bus_number(device)};
  place.insert(place.end(), ports.begin(), ports.begin() + std::max(0, depth));
  return place;
}

/// Calls `visit` for each Falcon, in the order of their places, until it returns true.
template <typename Visit>
void each_falcon(libusb_context* context, const Visit& visit) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context, &devices);
  std::vector<libusb_device*> falcons;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[i], &descriptor) != 0) continue;
    if (descriptor.idVendor == kVendor && descriptor.idProduct == kProduct) falcons.push_back(devices[i]);
  }
  std::sort(falcons.begin(), falcons.end(),
            [](libusb_device* a, libusb_device* b) { return place_of(a) < place_of(b); });
  for (libusb_device* const falcon : falcons)
    if (visit(falcon)) break;
  if (devices != nullptr) libusb_free_device_list(devices, 1);
}

class UsbTransport final : public Transport {
 public:
  UsbTransport() = default;

  /// The first that is free: another program may hold one of two. Before anything else.
  OpenProblem open() {
    if (context_.get() == nullptr) return OpenProblem::no_usb;
    int status = LIBUSB_ERROR_NO_DEVICE;
    each_falcon(context_.get(), [&](libusb_device* device) {
      status = libusb_open(device, &handle_);
      if (status != 0) return false;
      static_cast<void>(libusb_set_auto_detach_kernel_driver(handle_, 1));
      status = libusb_claim_interface(handle_, kInterface);
      if (status == 0) return true;
      libusb_close(handle_);
      handle_ = nullptr;
      return false;
    });
    if (status == LIBUSB_ERROR_ACCESS) return OpenProblem::not_permitted;
    if (status == LIBUSB_ERROR_BUSY) return OpenProblem::busy;
    if (status != 0) return OpenProblem::absent;
    for (Slot& slot : posts_) prepare(slot);
    for (Slot& slot : urgents_) prepare(slot);
    incoming_.transfer = libusb_alloc_transfer(0);
    return OpenProblem::none;
  }

  ~UsbTransport() override {
    if (handle_ == nullptr) return;
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
      for (Slot& slot : posts_) call_back_late(slot);
      for (Slot& slot : urgents_) call_back_late(slot);
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
    return retried([&] {
      return libusb_control_transfer(handle_, kVendorOut, static_cast<std::uint8_t>(request), value, 0, nullptr, 0,
                                     kControlTimeout_ms);
    });
  }

  TransportStatus write(std::span<const std::uint8_t> bytes, int timeout_ms) noexcept override {
    std::array<std::uint8_t, kUsbPacketBytes> copy{};
    const std::size_t size = std::min(bytes.size(), copy.size());
    std::memcpy(copy.data(), bytes.data(), size);
    int sent = 0;
    const TransportStatus status = retried([&] {
      const int result = libusb_bulk_transfer(handle_, kOut, copy.data(), static_cast<int>(size), &sent,
                                              static_cast<unsigned>(timeout_ms));
      if (result == LIBUSB_ERROR_PIPE) libusb_clear_halt(handle_, kOut);
      return result;
    });
    if (status != TransportStatus::ok) return status;
    return static_cast<std::size_t>(sent) == size ? TransportStatus::ok : TransportStatus::nothing;
  }

  TransportStatus read(UsbPacket& packet, std::size_t& size, int timeout_ms) noexcept override {
    int got = 0;
    bool cut = false;
    const TransportStatus status = retried([&] {
      const int result = libusb_bulk_transfer(handle_, kIn, packet.data(), static_cast<int>(packet.size()), &got,
                                              static_cast<unsigned>(std::max(1, timeout_ms)));
      if (result == LIBUSB_ERROR_PIPE) libusb_clear_halt(handle_, kIn);
      cut = result == LIBUSB_ERROR_TIMEOUT && got > 0;
      return result;
    });
    size = static_cast<std::size_t>(got);
    return cut ? TransportStatus::ok : status;
  }

  TransportStatus post(std::span<const std::uint8_t> bytes) noexcept override {
    // Here alone: on the thread whose events end transfers, so that a slot cannot be filled anew in between.
    for (Slot& slot : posts_) call_back_late(slot);
    for (Slot& slot : urgents_) call_back_late(slot);
    const TransportStatus status = submit(posts_, bytes);
    // Clearing a stall takes longer and is left to receive().
    const bool stalled = in_stalled_.load() || out_stalled_.load();
    if (status == TransportStatus::ok && !incoming_.busy.load() && !stalled) static_cast<void>(listen());
    return status;
  }

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
      if (!incoming_.busy.load() && !listen()) {
        if (gone_.load(std::memory_order_relaxed)) return TransportStatus::gone;
        // It failed: once more on the next call, and not at once again and again.
        std::this_thread::sleep_for(std::min<Steady::duration>(kRetryPause, std::max(limit - Steady::now(), {})));
        return TransportStatus::nothing;
      }
      const auto left = std::chrono::duration_cast<std::chrono::microseconds>(limit - Steady::now()).count();
      timeval wait{static_cast<time_t>(std::max<long>(0, left) / 1000000), std::max<long>(0, left) % 1000000};
      static_cast<void>(libusb_handle_events_timeout_completed(context_.get(), &wait, nullptr));
      if (received_count_ == 0 && !gone_.load(std::memory_order_relaxed) && Steady::now() >= limit)
        return TransportStatus::nothing;
    }
  }

  void urgent(std::span<const std::uint8_t> bytes) noexcept override { static_cast<void>(submit(urgents_, bytes)); }

  [[nodiscard]] UsbAddress address() const noexcept override {
    libusb_device* const device = libusb_get_device(handle_);
    return {libusb_get_bus_number(device), libusb_get_device_address(device)};
  }
  [[nodiscard]] bool present() const noexcept override { return !left_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    libusb_transfer* transfer = nullptr;
    std::array<std::uint8_t, kUsbPacketBytes> bytes{};
    std::atomic<bool> busy{false};
    std::atomic<std::int64_t> posted_ns{0};
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

  /// What fails now may work the next time; what has failed for a second without a break is as good as unplugged.
  TransportStatus status_of(int status) noexcept {
    if (status >= 0) {
      failing_since_ns_.store(0, std::memory_order_relaxed);
      return TransportStatus::ok;
    }
    if (status == LIBUSB_ERROR_TIMEOUT) return TransportStatus::nothing;
    const std::int64_t now_ns = Steady::now().time_since_epoch().count();
    std::int64_t since_ns = 0;
    if (failing_since_ns_.compare_exchange_strong(since_ns, now_ns)) since_ns = now_ns;
    if (status == LIBUSB_ERROR_NO_DEVICE) left_.store(true, std::memory_order_relaxed);
    const bool for_good = status == LIBUSB_ERROR_NO_DEVICE || now_ns - since_ns > kFailsForGood_ns;
    if (for_good) gone_.store(true, std::memory_order_relaxed);
    return for_good ? TransportStatus::gone : TransportStatus::nothing;
  }

  template <typename Call>
  TransportStatus retried(const Call& call) noexcept {
    constexpr int kTries = 3;
    TransportStatus status = TransportStatus::gone;
    for (int i = 0; i < kTries && !gone_.load(std::memory_order_relaxed); ++i) {
      const int result = call();
      status = status_of(result);
      if (status != TransportStatus::nothing || result == LIBUSB_ERROR_TIMEOUT) break;
    }
    return status;
  }

  /// Its end then comes as any other does. A slot that has just been filled anew is not late.
  static void call_back_late(Slot& slot) noexcept {
    const std::int64_t now_ns = Steady::now().time_since_epoch().count();
    std::int64_t posted_ns = slot.posted_ns.load(std::memory_order_relaxed);
    if (slot.transfer == nullptr || posted_ns == 0 || now_ns - posted_ns < kPostTimeout_ns) return;
    if (slot.posted_ns.compare_exchange_strong(posted_ns, now_ns)) libusb_cancel_transfer(slot.transfer);
  }

  template <std::size_t N>
  TransportStatus submit(std::array<Slot, N>& slots, std::span<const std::uint8_t> bytes) noexcept {
    if (gone_.load(std::memory_order_relaxed)) return TransportStatus::gone;
    for (Slot& slot : slots) {
      bool idle = false;
      if (slot.transfer == nullptr || !slot.busy.compare_exchange_strong(idle, true)) continue;
      slot.posted_ns.store(Steady::now().time_since_epoch().count(), std::memory_order_relaxed);
      const std::size_t size = std::min(bytes.size(), slot.bytes.size());
      std::memcpy(slot.bytes.data(), bytes.data(), size);
      libusb_fill_bulk_transfer(slot.transfer, handle_, kOut, slot.bytes.data(), static_cast<int>(size), &sent, &slot,
                                0);
      const int status = libusb_submit_transfer(slot.transfer);
      if (status == 0) return TransportStatus::ok;
      slot.posted_ns.store(0, std::memory_order_relaxed);
      slot.busy.store(false);
      return status == LIBUSB_ERROR_BUSY ? TransportStatus::nothing : status_of(status);
    }
    return TransportStatus::nothing;
  }

  static int error_of(libusb_transfer_status status) noexcept {
    switch (status) {
      case LIBUSB_TRANSFER_COMPLETED:
        return 0;
      case LIBUSB_TRANSFER_NO_DEVICE:
        return LIBUSB_ERROR_NO_DEVICE;
      case LIBUSB_TRANSFER_TIMED_OUT:
      case LIBUSB_TRANSFER_CANCELLED:
        return LIBUSB_ERROR_TIMEOUT;
      case LIBUSB_TRANSFER_STALL:
        return LIBUSB_ERROR_PIPE;
      default:
        return LIBUSB_ERROR_IO;
    }
  }

  static void LIBUSB_CALL sent(libusb_transfer* transfer) {
    auto& slot = *static_cast<Slot*>(transfer->user_data);
    if (!slot.owner->closing_.load()) {
      static_cast<void>(slot.owner->status_of(error_of(transfer->status)));
      if (transfer->status == LIBUSB_TRANSFER_STALL) slot.owner->out_stalled_.store(true);
    }
    slot.posted_ns.store(0, std::memory_order_relaxed);  // before `busy`: what fills the slot next is not late
    slot.busy.store(false);
  }

  /// Has a read outstanding; false when that failed.
  bool listen() noexcept {
    // A stalled endpoint takes nothing until it is cleared.
    if (in_stalled_.exchange(false)) libusb_clear_halt(handle_, kIn);
    if (out_stalled_.exchange(false)) libusb_clear_halt(handle_, kOut);
    libusb_fill_bulk_transfer(incoming_.transfer, handle_, kIn, incoming_.bytes.data(),
                              static_cast<int>(incoming_.bytes.size()), &arrived, this, 0);
    incoming_.busy.store(true);
    const int status = libusb_submit_transfer(incoming_.transfer);
    if (status == 0) return true;
    incoming_.busy.store(false);
    static_cast<void>(status_of(status));
    return false;
  }

  static void LIBUSB_CALL arrived(libusb_transfer* transfer) {
    auto& self = *static_cast<UsbTransport*>(transfer->user_data);
    const bool closing = self.closing_.load();
    if (!closing) static_cast<void>(self.status_of(error_of(transfer->status)));
    if (transfer->status == LIBUSB_TRANSFER_STALL) self.in_stalled_.store(true);
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
      // After an answer the next question goes out first: post() and receive() listen again.
      const bool answer = self.keep(static_cast<std::size_t>(transfer->actual_length));
      if (!closing && !answer && libusb_submit_transfer(transfer) == 0) return;
    }
    self.incoming_.busy.store(false);  // listen() begins anew
  }

  /// False when there are no bytes of the firmware's.
  bool keep(std::size_t size) noexcept {
    if (size <= kModemBytes) return false;
    if (received_count_ == kReceived) {  // nobody listens: the oldest goes
      received_first_ = (received_first_ + 1) % kReceived;
      --received_count_;
    }
    Received& slot = received_[(received_first_ + received_count_++) % kReceived];
    slot.bytes = incoming_.bytes;
    slot.size = size;
    return true;
  }

  Context context_;
  libusb_device_handle* handle_ = nullptr;
  std::array<Slot, kPosts> posts_{};
  std::array<Slot, kUrgent> urgents_{};
  Slot incoming_;
  std::array<Received, kReceived> received_{};
  std::size_t received_first_ = 0;
  std::size_t received_count_ = 0;
  std::atomic<bool> gone_{false};  ///< nothing goes through any more
  std::atomic<bool> left_{false};  ///< because the device has left the bus
  std::atomic<bool> in_stalled_{false}, out_stalled_{false};
  std::atomic<std::int64_t> failing_since_ns_{0};
  std::atomic<bool> closing_{false};
};

}  // namespace

std::unique_ptr<Transport> try_usb_transport(OpenProblem& problem) {
  auto wire = std::make_unique<UsbTransport>();
  problem = wire->open();
  if (problem != OpenProblem::none) return nullptr;
  return wire;
}

std::unique_ptr<Transport> open_usb_transport() {
  constexpr const char* kOthers = "or --device pointer or simulated";
  OpenProblem problem{};
  std::unique_ptr<Transport> wire = try_usb_transport(problem);
  switch (problem) {
    case OpenProblem::none:
      break;
    case OpenProblem::no_usb:
      throw Error(ErrorKind::device, {}, "Falcon: this machine has no USB",
                  std::string("a machine with USB, ") + kOthers);
    case OpenProblem::not_permitted:
      throw Error(ErrorKind::device, {}, "Falcon: this user may not open it", kUdevRule);
    case OpenProblem::busy:
      throw Error(ErrorKind::device, {}, "Falcon: another program holds it", "that program ended");
    case OpenProblem::absent:
      throw Error(ErrorKind::device, {}, "no Falcon is plugged in",
                  std::string("a Novint Falcon (USB 0403:cb48), ") + kOthers);
  }
  return wire;
}

std::vector<FoundFalcon> find_falcons() {
  std::vector<FoundFalcon> found;
  const Context context;
  if (context.get() == nullptr) return found;
  each_falcon(context.get(), [&found](libusb_device* device) {
    FoundFalcon falcon;
    falcon.bus = libusb_get_bus_number(device);
    falcon.address = libusb_get_device_address(device);
    libusb_device_handle* handle = nullptr;
    int status = libusb_open(device, &handle);
    if (status == 0) {
      static_cast<void>(libusb_set_auto_detach_kernel_driver(handle, 1));
      status = libusb_claim_interface(handle, kInterface);
      if (status == 0) libusb_release_interface(handle, kInterface);
    }
    falcon.accessible = status == 0;
    if (status == LIBUSB_ERROR_BUSY)
      falcon.problem = "another program holds it";
    else if (status == LIBUSB_ERROR_ACCESS)
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

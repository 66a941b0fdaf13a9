// One port of the emulated bus: what the kernel's usbfs does for the programs that hold the device's node open.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "emulator/falcon.h"
#include "emulator/umockdev_library.h"
#include "emulator/usb_bus.h"

struct usbdevfs_urb;

namespace sparsha::emulator {

/// Not thread-safe: the bus locks.
class UsbPort {
 public:
  UsbPort(const Umockdev& umockdev, std::shared_ptr<Falcon> falcon, const BusFaults& faults);
  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  /// Answers now, or keeps the client waiting for the end of a transfer; serve() answers it then.
  void handle(UMockdevIoctlClient* client, double now_s);
  /// Ends transfers that are due, and answers clients that wait.
  void serve(double now_s);
  /// When serve() has something to do next.
  [[nodiscard]] double next_s() const;
  /// Ends every transfer and every claim: the device has gone.
  void disconnect();

  [[nodiscard]] Falcon& falcon() { return *falcon_; }
  /// When the motors were told to push for the first time; negative: never.
  [[nodiscard]] double first_force_s() const { return first_force_s_; }
  void count_from_now() { first_force_s_ = -1.0; }
  /// While on, the device takes no writes: they wait, as on a bus whose other end says NAK.
  void hold_writes(bool on, double now_s);
  /// Calls of the system that a program has made here for each command that it sent, since its last control transfer;
  /// negative: too few to tell.
  [[nodiscard]] double requests_per_command() const;

 private:
  /// A request block on its way; a reference of ours.
  struct Block {
    UMockdevIoctlData* data = nullptr;
    [[nodiscard]] usbdevfs_urb& urb() const;
    [[nodiscard]] std::uint8_t* bytes() const;
  };
  struct Client {
    bool claims = false;
    std::list<Block> waiting;  ///< reads without a packet yet
    std::list<Block> held;     ///< writes that the device does not take
    std::deque<Block> finished;
    UMockdevIoctlData* reaping = nullptr;  ///< where the client, which waits, finds what has finished, until
    double reaping_until_s = 0.0;
    int asked_in_vain = 0;  ///< since something was handed back
  };

  /// Clients that umockdev has freed, whose programs have closed the node or ended, not forgotten yet. Freed on any
  /// thread, and with any lock held.
  struct Freed {
    std::mutex mutex;
    std::vector<UMockdevIoctlClient*> clients;
  };

  [[nodiscard]] Client& client_of(UMockdevIoctlClient* handle);
  void forget(UMockdevIoctlClient* client);
  void forget_freed();
  [[nodiscard]] int claim(Client& client, bool steal);
  [[nodiscard]] int submit(Client& client, UMockdevIoctlData* argument, double now_s);
  void control(Client& client, const Block& block, double now_s);
  /// The answer to a control request that reads; empty when the chip does not know it.
  [[nodiscard]] std::vector<std::uint8_t> told_of(std::uint8_t kind, std::uint8_t request, std::uint16_t value) const;
  [[nodiscard]] int bulk(Client& client, UMockdevIoctlData* argument, double now_s);
  [[nodiscard]] int discard(Client& client, UMockdevIoctlData* argument);
  [[nodiscard]] int clear_halt(UMockdevIoctlData* argument);
  void reap(UMockdevIoctlClient* handle, Client& client, double now_s);
  bool hand_back(UMockdevIoctlClient* handle, Client& client);
  /// Ends the waiting of a client: with what has finished, else with an error.
  void let_go(UMockdevIoctlClient* handle, Client& client, int error);
  void write_out(Client& client, const Block& block, double now_s);
  void take_out(std::span<const std::uint8_t> bytes, double now_s);
  [[nodiscard]] bool fails(double now_s);
  void end_all(Client& client, int status);

  const Umockdev& umockdev_;
  std::shared_ptr<Falcon> falcon_;
  BusFaults faults_;
  std::map<UMockdevIoctlClient*, Client> clients_;
  std::shared_ptr<Freed> freed_ = std::make_shared<Freed>();
  bool stalled_ = false, holds_writes_ = false;
  double next_stall_s_ = 0.0;
  double first_force_s_ = -1.0;
  std::uint64_t transfers_ = 0;
  std::uint64_t requests_ = 0, commands_before_ = 0;  // since, and at, the last control transfer
};

}  // namespace sparsha::emulator

#if defined(SPARSHA_HAVE_UMOCKDEV)
#include "emulator/usb_port.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include "emulator/usb_descriptors.h"

namespace sparsha::emulator {
namespace {

constexpr unsigned char kOut = 0x02, kIn = 0x81;
/// A client that asks what has finished waits for so long at most: its other threads wait with it.
constexpr double kPatience_s = 0.5e-3;
constexpr int kAskedInVain = 1;  ///< and is told so many times before that nothing has
constexpr double kNever_s = std::numeric_limits<double>::infinity();

}  // namespace

usbdevfs_urb& UsbPort::Block::urb() const { return *reinterpret_cast<usbdevfs_urb*>(data->data); }
std::uint8_t* UsbPort::Block::bytes() const { return static_cast<std::uint8_t*>(urb().buffer); }

UsbPort::UsbPort(const Umockdev& umockdev, std::shared_ptr<Falcon> falcon, const BusFaults& faults)
    : umockdev_(umockdev), falcon_(std::move(falcon)), faults_(faults) {}

UsbPort::~UsbPort() {
  while (!clients_.empty()) forget(clients_.begin()->first);
}

void UsbPort::forget(UMockdevIoctlClient* client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  for (const Block& block : found->second.waiting) umockdev_.unref(block.data);
  for (const Block& block : found->second.held) umockdev_.unref(block.data);
  for (const Block& block : found->second.finished) umockdev_.unref(block.data);
  if (found->second.reaping != nullptr) umockdev_.unref(found->second.reaping);
  clients_.erase(found);
}

// umockdev declares a signal for this and never gives it.
UsbPort::Client& UsbPort::client_of(UMockdevIoctlClient* handle) {
  forget_freed();  // another may have been at this address
  const auto [found, is_new] = clients_.try_emplace(handle);
  if (is_new) {
    const auto note = [](gpointer data, GObject* client) {
      const std::unique_ptr<std::shared_ptr<Freed>> freed(static_cast<std::shared_ptr<Freed>*>(data));
      const std::lock_guard lock((*freed)->mutex);
      (*freed)->clients.push_back(reinterpret_cast<UMockdevIoctlClient*>(client));
    };
    umockdev_.weak_ref(reinterpret_cast<GObject*>(handle), note, new std::shared_ptr<Freed>(freed_));
  }
  return found->second;
}

void UsbPort::forget_freed() {
  std::vector<UMockdevIoctlClient*> clients;
  {
    const std::lock_guard lock(freed_->mutex);
    clients.swap(freed_->clients);
  }
  for (UMockdevIoctlClient* const client : clients) forget(client);
}

int UsbPort::claim(Client& client, bool steal) {
  for (auto& [handle, other] : clients_) {
    if (&other == &client || !other.claims) continue;
    if (!steal) return EBUSY;
    other.claims = false;
    end_all(other, -ENOENT);
  }
  client.claims = true;
  return 0;
}

void UsbPort::end_all(Client& client, int status) {
  if (status == -ENODEV || status == -ENOENT) client.waiting.splice(client.waiting.end(), client.held);
  for (Block& block : client.waiting) {
    block.urb().status = status;
    block.urb().actual_length = 0;
    client.finished.push_back(block);
  }
  client.waiting.clear();
}

void UsbPort::disconnect() {
  for (auto& [handle, client] : clients_) {
    end_all(client, -ENODEV);
    client.claims = false;
    if (client.reaping != nullptr) let_go(handle, client, ENODEV);
  }
}

bool UsbPort::fails(double now_s) {
  const double in_use_s = first_force_s_ < 0.0 ? 0.0 : now_s - first_force_s_;
  if (faults_.dead_after_s > 0.0 && in_use_s > faults_.dead_after_s &&
      in_use_s < faults_.dead_after_s + faults_.dead_for_s)
    return true;
  return faults_.fail_every > 0 && ++transfers_ % static_cast<std::uint64_t>(faults_.fail_every) == 0;
}

void UsbPort::take_out(std::span<const std::uint8_t> bytes, double now_s) {
  falcon_->write(bytes, now_s);
  if (first_force_s_ < 0.0 && falcon_->motors() != std::array<int, 3>{}) first_force_s_ = now_s;
}

void UsbPort::control(Client& client, const Block& block, double now_s) {
  constexpr std::size_t kSetup = 8;
  requests_ = 0;
  commands_before_ = falcon_->commands();
  std::uint8_t* const setup = block.bytes();
  const auto value = static_cast<std::uint16_t>(setup[2] | (setup[3] << 8U));
  bool known = false;
  std::size_t size = 0;
  if ((setup[0] & 0x80U) != 0) {
    const std::vector<std::uint8_t> answer = told_of(setup[0], setup[1], value);
    const auto asked = std::min<std::size_t>(setup[6] | (setup[7] << 8U),
                                             static_cast<std::size_t>(block.urb().buffer_length) - kSetup);
    known = !answer.empty();
    size = std::min(asked, answer.size());
    std::copy_n(answer.begin(), size, setup + kSetup);
  } else if (setup[0] == 0x40) {
    known = falcon_->control(setup[1], value, now_s);
  }
  block.urb().status = known ? 0 : -EPIPE;
  block.urb().actual_length = static_cast<int>(size);
  client.finished.push_back(block);
}

std::vector<std::uint8_t> UsbPort::told_of(std::uint8_t kind, std::uint8_t request, std::uint16_t value) const {
  constexpr std::uint8_t kStandard = 0x80, kVendor = 0xC0, kGetDescriptor = 6, kPollModem = 5, kGetLatency = 10;
  if (kind == kVendor && request == kGetLatency) return {falcon_->latency_ms()};
  if (kind == kVendor && request == kPollModem) return {0x01, 0x60};
  if (kind != kStandard || request != kGetDescriptor) return {};
  switch (value) {
    case 0x0100:
      return {kDeviceDescriptor.begin(), kDeviceDescriptor.end()};
    case 0x0200:
      return {kConfigurationDescriptor.begin(), kConfigurationDescriptor.end()};
    case 0x0300:
      return {4, 3, 0x09, 0x04};  // English
    case 0x0300 + kProductString: {
      std::vector<std::uint8_t> text{static_cast<std::uint8_t>(2 + 2 * kProduct.size()), 3};
      for (const char letter : kProduct) {
        text.push_back(static_cast<std::uint8_t>(letter));
        text.push_back(0);
      }
      return text;
    }
    default:
      return {};
  }
}

int UsbPort::submit(Client& client, UMockdevIoctlData* argument, double now_s) {
  Block block{umockdev_.resolve(argument, 0, sizeof(usbdevfs_urb), nullptr)};
  if (block.data == nullptr) return EFAULT;
  usbdevfs_urb& urb = block.urb();
  UMockdevIoctlData* buffer = umockdev_.resolve(block.data, offsetof(usbdevfs_urb, buffer),
                                                static_cast<gsize>(std::max(0, urb.buffer_length)), nullptr);
  if (buffer != nullptr) umockdev_.unref(buffer);  // the block keeps it
  if (buffer == nullptr && urb.buffer_length > 0) return EFAULT;
  urb.status = 0;
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    if (buffer == nullptr || urb.buffer_length < 8) return EINVAL;
    control(client, block, now_s);
    return 0;
  }
  // The kernel claims it for a program that has not.
  if (!client.claims && claim(client, false) != 0) {
    umockdev_.unref(block.data);
    return EBUSY;
  }
  if (urb.endpoint == kIn) {
    client.waiting.push_back(block);
    return 0;
  }
  if (urb.endpoint != kOut || buffer == nullptr) return ENOENT;
  if (holds_writes_)
    client.held.push_back(block);
  else
    write_out(client, block, now_s);
  return 0;
}

void UsbPort::write_out(Client& client, const Block& block, double now_s) {
  usbdevfs_urb& urb = block.urb();
  if (fails(now_s)) {
    urb.status = -EPROTO;
    urb.actual_length = 0;
  } else {
    take_out({block.bytes(), static_cast<std::size_t>(urb.buffer_length)}, now_s);
    urb.actual_length = urb.buffer_length;
  }
  client.finished.push_back(block);
}

void UsbPort::hold_writes(bool on, double now_s) {
  holds_writes_ = on;
  for (auto& [handle, client] : clients_)
    for (; !on && !client.held.empty(); client.held.pop_front()) write_out(client, client.held.front(), now_s);
}

int UsbPort::bulk(Client& client, UMockdevIoctlData* argument, double now_s) {
  UMockdevIoctlData* data = umockdev_.resolve(argument, 0, sizeof(usbdevfs_bulktransfer), nullptr);
  if (data == nullptr) return EFAULT;
  auto& transfer = *reinterpret_cast<usbdevfs_bulktransfer*>(data->data);
  UMockdevIoctlData* bytes =
      umockdev_.resolve(data, offsetof(usbdevfs_bulktransfer, data), static_cast<gsize>(transfer.len), nullptr);
  int error = 0;
  if (transfer.ep != kOut || bytes == nullptr)
    error = ENOENT;
  else if (!client.claims)
    error = claim(client, false);
  if (error == 0 && holds_writes_) error = ETIMEDOUT;
  if (error == 0 && fails(now_s)) error = EPROTO;
  if (error == 0) take_out({bytes->data, transfer.len}, now_s);
  if (bytes != nullptr) umockdev_.unref(bytes);
  umockdev_.unref(data);
  return error;
}

int UsbPort::discard(Client& client, UMockdevIoctlData* argument) {
  const gulong address = *reinterpret_cast<gulong*>(argument->data);
  for (std::list<Block>* const list : {&client.waiting, &client.held})
    for (auto block = list->begin(); block != list->end(); ++block) {
      if (block->data->client_addr != address) continue;
      block->urb().status = -ENOENT;
      block->urb().actual_length = 0;
      client.finished.push_back(*block);
      list->erase(block);
      return 0;
    }
  return EINVAL;
}

int UsbPort::clear_halt(UMockdevIoctlData* argument) {
  UMockdevIoctlData* data = umockdev_.resolve(argument, 0, sizeof(unsigned), nullptr);
  if (data == nullptr) return EFAULT;
  if (*reinterpret_cast<unsigned*>(data->data) == kIn) stalled_ = false;
  umockdev_.unref(data);
  return 0;
}

bool UsbPort::hand_back(UMockdevIoctlClient* handle, Client& client) {
  if (client.finished.empty()) return false;
  const Block block = client.finished.front();
  client.finished.pop_front();
  umockdev_.set_ptr(client.reaping, 0, block.data);
  umockdev_.unref(std::exchange(client.reaping, nullptr));
  umockdev_.unref(block.data);
  umockdev_.complete(handle, 0, 0);
  return true;
}

void UsbPort::reap(UMockdevIoctlClient* handle, Client& client, double now_s) {
  // The kernel tells at once that nothing has finished; only who asks once more is made to wait.
  if (client.finished.empty() && ++client.asked_in_vain <= kAskedInVain) {
    umockdev_.complete(handle, -1, EAGAIN);
    return;
  }
  if (!client.finished.empty()) client.asked_in_vain = 0;
  // Asked of the client now, so that nothing needs to be asked when a transfer ends.
  client.reaping = umockdev_.resolve(umockdev_.get_arg(handle), 0, sizeof(void*), nullptr);
  client.reaping_until_s = now_s + kPatience_s;
  if (client.reaping == nullptr) {
    umockdev_.complete(handle, -1, EFAULT);
    return;
  }
  if (!hand_back(handle, client)) umockdev_.object_ref(handle);  // nobody else keeps a client that waits
}

void UsbPort::let_go(UMockdevIoctlClient* handle, Client& client, int error) {
  if (hand_back(handle, client)) {
    client.asked_in_vain = 0;
    umockdev_.object_unref(handle);
    return;
  }
  umockdev_.unref(std::exchange(client.reaping, nullptr));
  umockdev_.complete(handle, -1, error);
  umockdev_.object_unref(handle);
}

void UsbPort::handle(UMockdevIoctlClient* handle, double now_s) {
  Client& client = client_of(handle);
  ++requests_;
  UMockdevIoctlData* argument = umockdev_.get_arg(handle);
  const gulong request = umockdev_.get_request(handle);
  const auto done = [&](int error) { umockdev_.complete(handle, error == 0 ? 0 : -1, error); };
  const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
  if (!falcon_->plugged() && !(reaps && !client.finished.empty())) return done(ENODEV);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* flags = umockdev_.resolve(argument, 0, sizeof(guint32), nullptr);
      if (flags == nullptr) return done(EFAULT);
      *reinterpret_cast<guint32*>(flags->data) = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                                 USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
      umockdev_.unref(flags);
      return done(0);
    }
    case USBDEVFS_CLAIMINTERFACE:
      return done(claim(client, false));
    case USBDEVFS_DISCONNECT_CLAIM: {
      UMockdevIoctlData* data = umockdev_.resolve(argument, 0, sizeof(usbdevfs_disconnect_claim), nullptr);
      if (data == nullptr) return done(EFAULT);
      const auto& asked = *reinterpret_cast<usbdevfs_disconnect_claim*>(data->data);
      const bool spares_usbfs = (asked.flags & USBDEVFS_DISCONNECT_CLAIM_EXCEPT_DRIVER) != 0 &&
                                std::strncmp(asked.driver, "usbfs", sizeof asked.driver) == 0;
      umockdev_.unref(data);
      return done(claim(client, !spares_usbfs));
    }
    case USBDEVFS_RELEASEINTERFACE:
      client.claims = false;
      return done(0);
    case USBDEVFS_CLEAR_HALT:
      return done(clear_halt(argument));
    case USBDEVFS_RESET:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return done(0);
    case USBDEVFS_GETDRIVER:
      return done(ENODATA);
    case USBDEVFS_SUBMITURB:
      return done(submit(client, argument, now_s));
    case USBDEVFS_BULK:
      return done(bulk(client, argument, now_s));
    case USBDEVFS_DISCARDURB:
      return done(discard(client, argument));
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(handle, client, now_s);
    default:
      return done(ENOTTY);
  }
}

void UsbPort::serve(double now_s) {
  forget_freed();
  if (faults_.stall_every_s > 0.0 && now_s > next_stall_s_) {
    stalled_ = next_stall_s_ > 0.0;
    next_stall_s_ = now_s + faults_.stall_every_s;
  }
  for (auto& [handle, client] : clients_) {
    if (stalled_) end_all(client, -EPIPE);
    while (!client.waiting.empty()) {
      if (falcon_->packet_s() > now_s) break;
      Block block = client.waiting.front();
      client.waiting.pop_front();
      block.urb().actual_length = 0;
      if (fails(now_s)) {  // the device keeps what it could not deliver
        block.urb().status = -EPROTO;
      } else if (const auto packet = falcon_->read(now_s)) {
        const std::size_t size = std::min(packet->size(), static_cast<std::size_t>(block.urb().buffer_length));
        std::copy_n(packet->begin(), size, block.bytes());
        block.urb().actual_length = static_cast<int>(size);
      }
      client.finished.push_back(block);
    }
    if (client.reaping != nullptr && (!client.finished.empty() || now_s >= client.reaping_until_s))
      let_go(handle, client, EAGAIN);
  }
}

double UsbPort::requests_per_command() const {
  constexpr std::uint64_t kFew = 100;
  const std::uint64_t commands = falcon_->commands() - commands_before_;
  return commands < kFew ? -1.0 : static_cast<double>(requests_) / static_cast<double>(commands);
}

double UsbPort::next_s() const {
  double next = kNever_s;
  for (const auto& [handle, client] : clients_) {
    if (!client.waiting.empty()) next = std::min(next, falcon_->packet_s());
    if (client.reaping != nullptr) next = std::min(next, client.reaping_until_s);
  }
  return next;
}

}  // namespace sparsha::emulator
#endif

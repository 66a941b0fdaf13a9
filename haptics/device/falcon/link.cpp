// The bridge's settings and the boot loader's dialogue.
#include "haptics/device/falcon/link.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::haptics::falcon {
namespace {

constexpr int kTimeout_ms = 1000;
constexpr std::size_t kSmallestImage = 1024, kLargestImage = 65536;
/// 62 bytes and two of modem status fill one USB packet.
constexpr std::size_t kChunk = 62;
constexpr int kHandshakeTries = 30;  ///< a second, at 16 ms a read
/// Of the bridge's timer: what waits for the last is later than exchange() waits.
constexpr std::uint16_t kShortLatency_ms = 1, kLongLatency_ms = 4, kProbeLatency_ms = 16;
const char* const kPowerRemedy =
    "the Falcon's own power supply plugged in and its logo lit; then unplug and replug USB, directly and not through a "
    "hub";

[[nodiscard]] Error fault(std::string wrong, std::string expected) {
  return Error(ErrorKind::device, {}, "Falcon: " + std::move(wrong), std::move(expected));
}

[[nodiscard]] Error unplugged() { return fault("unplugged while starting", "a Falcon that stays plugged in"); }

void set(Transport& wire, Request request, std::uint16_t value, const char* what) {
  const TransportStatus status = wire.control(request, value);
  if (status == TransportStatus::gone) throw unplugged();
  if (status != TransportStatus::ok)
    throw fault(std::string("the USB bridge refuses to set ") + what, "a Falcon that stays plugged in");
}

void purge(Transport& wire) {
  set(wire, Request::reset, value::kPurgeReceive, "its receive buffer");
  set(wire, Request::reset, value::kPurgeTransmit, "its transmit buffer");
}

void send(Transport& wire, std::span<const std::uint8_t> bytes, const char* step) {
  const TransportStatus status = wire.write(bytes, kTimeout_ms);
  if (status == TransportStatus::gone) throw unplugged();
  if (status != TransportStatus::ok) throw fault(std::string("cannot write during the ") + step, kPowerRemedy);
}

/// Collects at least `wanted` data bytes; fewer when `tries` USB packets do not bring them.
std::vector<std::uint8_t> collect(Transport& wire, std::size_t wanted, int tries) {
  std::vector<std::uint8_t> bytes;
  UsbPacket packet{};
  for (int i = 0; i < tries && bytes.size() < wanted; ++i) {
    std::size_t size = 0;
    const TransportStatus status = wire.read(packet, size, kTimeout_ms);
    if (status == TransportStatus::gone) throw unplugged();
    if (status == TransportStatus::ok && size > kModemBytes)
      bytes.insert(bytes.end(), packet.begin() + kModemBytes, packet.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return bytes;
}

/// Questions that were repeated have answers on their way: they would be taken for those to later questions, and the
/// hand would seem to be seen sooner than it is.
void wait_for_quiet(Transport& wire) {
  constexpr int kQuietReads = 50, kMostReads = 500;  // the bridge gives an empty packet each 1 or 4 ms
  UsbPacket packet{};
  for (int read = 0, quiet = 0; read < kMostReads && quiet < kQuietReads; ++read) {
    std::size_t size = 0;
    const TransportStatus status = wire.read(packet, size, 1);
    if (status == TransportStatus::gone) return;
    quiet = status == TransportStatus::ok && size > kModemBytes ? 0 : quiet + 1;
  }
}

/// True when firmware answers, and no more answers are on their way.
bool runs(Transport& wire) {
  if (!firmware_answers(wire)) return false;
  lengthen_timer(wire);
  wait_for_quiet(wire);
  return true;
}

bool greet(Transport& wire) {
  constexpr std::array<std::uint8_t, 3> kHello{0x0A, 0x43, 0x0D};
  const std::vector<std::uint8_t> reply{0x0A, 0x44, 0x2C, 0x0D};
  for (int i = 0; i < kHandshakeTries; ++i) {
    send(wire, kHello, "handshake");
    std::vector<std::uint8_t> bytes = collect(wire, reply.size(), 2);
    if (!bytes.empty() && bytes.front() == 0x00) bytes.erase(bytes.begin());
    if (bytes == reply) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> read_firmware(const std::filesystem::path& file) {
  std::string bytes;
  try {
    bytes = read_file(file, kLargestImage);
  } catch (const Error& error) {
    throw Error(ErrorKind::device, {file.string()}, "cannot read the Falcon's firmware: " + error.wrong(),
                "the firmware image from Novint's or libnifalcon's distribution");
  }
  if (bytes.size() < kSmallestImage)
    throw Error(ErrorKind::device, {file.string()},
                "not a Falcon firmware image: " + std::to_string(bytes.size()) + " bytes", "7 to 9 kB");
  return {bytes.begin(), bytes.end()};
}

void enter_run_mode(Transport& wire) {
  set(wire, Request::latency, kShortLatency_ms, "its latency timer");
  // An answer's last byte sends what the bridge holds at once. One that does not know this still has its timer.
  if (wire.control(Request::event_character, value::kEventAnswer) == TransportStatus::gone) throw unplugged();
  set(wire, Request::baud, value::kBaudRun, "1.5 Mbaud");
  purge(wire);
}

void lengthen_timer(Transport& wire) {
  constexpr int kQuestions = 16, kMostLate = 2;
  if (wire.control(Request::latency, kProbeLatency_ms) != TransportStatus::ok) {
    set(wire, Request::latency, kShortLatency_ms, "its latency timer");  // it may have taken the other one
    return;
  }
  AnswerStream stream;
  Answer answer;
  int late = 0;
  for (int i = 0; i < kQuestions; ++i)
    if (!exchange(wire, stream, encode({}, 0), answer, 1)) ++late;
  set(wire, Request::latency, late > kMostLate ? kShortLatency_ms : kLongLatency_ms, "its latency timer");
}

bool exchange(Transport& wire, AnswerStream& stream, const Packet& packet, Answer& answer, int tries) {
  UsbPacket bytes{};
  for (int i = 0; i < tries; ++i) {
    if (wire.write(packet, kTimeout_ms) == TransportStatus::gone) return false;
    for (int wait = 0; wait < 5; ++wait) {
      std::size_t size = 0;
      const TransportStatus status = wire.read(bytes, size, 5);
      if (status == TransportStatus::gone) return false;
      if (status == TransportStatus::nothing) break;
      if (size <= kModemBytes) continue;  // the latency timer's empty packets, each 1 or 4 ms
      if (const auto got = stream.feed(std::span(bytes).subspan(kModemBytes, size - kModemBytes))) {
        answer = *got;
        return true;
      }
    }
  }
  return false;
}

std::filesystem::path own_file(const char* name) {
  const char* const configuration = std::getenv("XDG_CONFIG_HOME");
  if (configuration != nullptr && *configuration != '\0')
    return std::filesystem::path(configuration) / "sparsha" / name;
  const char* const home = std::getenv("HOME");
  return home == nullptr || *home == '\0' ? std::filesystem::path()
                                          : std::filesystem::path(home) / ".config" / "sparsha" / name;
}

std::filesystem::path own_firmware() { return own_file("falcon.bin"); }

bool firmware_answers(Transport& wire, int tries) {
  AnswerStream stream;
  Answer answer;
  return exchange(wire, stream, encode({}, 0), answer, tries);
}

std::vector<std::uint8_t> firmware_image(const FalconOptions& options) {
  std::filesystem::path file = options.firmware;
  if (file.empty())
    if (const char* named = std::getenv("SPARSHA_FALCON_FIRMWARE")) file = named;
  std::error_code code;
  // Whatever is there under that name: what cannot be read is said, and not passed over.
  if (file.empty() && std::filesystem::exists(own_firmware(), code)) file = own_firmware();
  return file.empty() ? std::vector<std::uint8_t>{} : read_firmware(file);
}

bool boot_loader_answers(Transport& wire) {
  purge(wire);
  set(wire, Request::latency, 16, "its latency timer");
  static_cast<void>(wire.control(Request::event_character, value::kEventNone));
  set(wire, Request::baud, value::kBaud9600, "9600 baud");
  set(wire, Request::data, value::kData8N1, "8 data bits");
  set(wire, Request::flow, 0, "flow control");
  set(wire, Request::modem, value::kRtsLow, "RTS");
  set(wire, Request::modem, value::kDtrLow, "DTR");
  set(wire, Request::modem, value::kDtrHigh, "DTR");
  return greet(wire);
}

void load_firmware(Transport& wire, std::span<const std::uint8_t> image, const std::function<void(double)>& progress) {
  if (progress) progress(0.0);
  if (!boot_loader_answers(wire)) throw fault("the boot loader does not answer", kPowerRemedy);

  set(wire, Request::modem, value::kDtrLow, "DTR");
  set(wire, Request::baud, value::kBaudUpload, "142857 baud");
  constexpr std::array<std::uint8_t, 1> kBegin{0x41};
  send(wire, kBegin, "handshake");
  if (collect(wire, 1, 8) != std::vector<std::uint8_t>(kBegin.begin(), kBegin.end()))
    throw fault("the boot loader does not begin to load", kPowerRemedy);

  for (std::size_t at = 0; at < image.size(); at += kChunk) {
    const auto chunk = image.subspan(at, std::min(kChunk, image.size() - at));
    send(wire, chunk, "firmware upload");
    const std::vector<std::uint8_t> echo = collect(wire, chunk.size(), 32);
    if (!std::equal(chunk.begin(), chunk.end(), echo.begin(), echo.end()))
      throw fault("the firmware's echo differs near byte " + std::to_string(at) + " of " + std::to_string(image.size()),
                  "another attempt, a direct USB port and a shorter cable");
    if (progress) progress(static_cast<double>(at + chunk.size()) / static_cast<double>(image.size()));
  }
}

std::function<void(double)> loading(const FalconOptions& options) {
  auto told = std::make_shared<bool>(false);
  return [stop = options.stop, say = options.say, told](double) {
    if (stop && stop()) throw Cancelled();
    if (say && !*told) say("loading the Falcon's firmware, which takes some seconds");
    *told = true;
  };
}

void bring_up(Transport& wire, std::span<const std::uint8_t> image, int attempts,
              const std::function<void(double)>& progress) {
  enter_run_mode(wire);
  if (runs(wire)) return;
  if (image.empty())
    throw fault(
        "no firmware runs on it and none was given",
        "a firmware image: --firmware FILE, SPARSHA_FALCON_FIRMWARE or ~/.config/sparsha/falcon.bin; its licence "
        "forbids shipping one here");
  for (int attempt = 1;; ++attempt) {
    try {
      load_firmware(wire, image, progress);
      enter_run_mode(wire);
      if (runs(wire)) return;
      throw fault("the firmware was loaded but does not answer", "an image for the Falcon (7 to 9 kB)");
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      if (!wire.present()) throw;
      if (attempt >= attempts)
        throw Error(ErrorKind::device, {},
                    error.wrong() + (attempts > 1 ? " (" + std::to_string(attempts) + " attempts)" : ""),
                    error.expected());
    }
  }
}

}  // namespace sparsha::haptics::falcon

#include "haptics/device/falcon/firmware.h"

#include <algorithm>
#include <array>
#include <string>

#include "haptics/device/falcon/packet.h"
#include "pipeline/base/error.h"
#include "pipeline/base/files.h"

namespace sparsha::haptics::falcon {
namespace {

// Requests of the FTDI bridge.
constexpr std::uint8_t kReset = 0;
constexpr std::uint8_t kModem = 1;
constexpr std::uint8_t kFlow = 2;
constexpr std::uint8_t kBaud = 3;
constexpr std::uint8_t kData = 4;
constexpr std::uint8_t kLatency = 9;
constexpr std::uint16_t kPurgeReceived = 1;
constexpr std::uint16_t kPurgeSent = 2;
constexpr std::uint16_t kDtrLow = 0x0100;
constexpr std::uint16_t kDtrHigh = 0x0101;
constexpr std::uint16_t kRtsLow = 0x0200;
constexpr std::uint16_t kBaud9600 = 0x4138;
constexpr std::uint16_t kBaud140000 = 0x0015;
constexpr std::uint16_t kBaudRun = 0x0002;
constexpr std::uint16_t kEightBits = 0x0008;

constexpr double kTimeoutS = 1.0;
constexpr double kShortTimeoutS = 0.02;
constexpr int kGreetings = 100;
constexpr int kProbes = 20;
constexpr std::size_t kChunk = 62;  // with the bridge's two status bytes, one full-speed packet

bool all(Port& port, std::initializer_list<std::pair<std::uint8_t, std::uint16_t>> requests) {
  return std::all_of(requests.begin(), requests.end(),
                     [&](const auto& request) { return port.control(request.first, request.second); });
}

/// Reads until so many bytes are there or nothing comes any more.
std::vector<std::uint8_t> read_some(Port& port, std::size_t count, double timeout_s) {
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 64> piece;
  while (bytes.size() < count) {
    const std::size_t size = port.read(piece, timeout_s);
    if (size == 0) break;
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return bytes;
}

bool greet(Port& port) {
  constexpr std::array<std::uint8_t, 3> kHello = {0x0A, 0x43, 0x0D};
  const std::vector<std::uint8_t> expected = {0x0A, 0x44, 0x2C, 0x0D};
  for (int attempt = 0; attempt < kGreetings; ++attempt) {
    if (!port.connected() || port.write(kHello, kTimeoutS) != kHello.size()) return false;
    std::vector<std::uint8_t> answer = read_some(port, expected.size(), kShortTimeoutS);
    if (!answer.empty() && answer.front() == 0x00) {  // some bridges put a stray zero first
      answer.erase(answer.begin());
      if (answer.size() < expected.size()) {
        const std::vector<std::uint8_t> rest = read_some(port, 1, kShortTimeoutS);
        answer.insert(answer.end(), rest.begin(), rest.end());
      }
    }
    if (answer == expected) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> read_firmware(const std::filesystem::path& file) {
  constexpr std::size_t kSmallest = 2048;
  constexpr std::size_t kLargest = 65536;
  std::string bytes;
  try {
    bytes = read_file(file, kLargest);
  } catch (const Error& error) {
    throw Error(ErrorKind::device, {file.string()}, error.wrong(), "a Falcon firmware image, 2 kB to 64 kB");
  }
  if (bytes.size() < kSmallest)
    throw Error(ErrorKind::device, {file.string()}, "only " + std::to_string(bytes.size()) + " bytes",
                "a Falcon firmware image, 2 kB to 64 kB");
  return {bytes.begin(), bytes.end()};
}

bool enter_run_mode(Port& port) {
  return all(port, {{kLatency, 1}, {kBaud, kBaudRun}, {kReset, kPurgeReceived}, {kReset, kPurgeSent}});
}

bool firmware_runs(Port& port) {
  PacketStream stream;
  const Packet nothing = encode(Question{});
  std::array<std::uint8_t, 64> bytes;
  for (int probe = 0; probe < kProbes && port.connected(); ++probe) {
    if (port.write(nothing, kTimeoutS) != nothing.size()) return false;
    const std::size_t size = port.read(bytes, kShortTimeoutS);
    stream.add(std::span(bytes).first(size));
    while (const std::optional<Packet> packet = stream.next())
      if (decode_answer(*packet)) return true;
  }
  return false;
}

std::string load_firmware(Port& port, const std::vector<std::uint8_t>& image) {
  if (!all(port, {{kReset, kPurgeReceived},
                  {kReset, kPurgeSent},
                  {kLatency, 16},
                  {kBaud, kBaud9600},
                  {kData, kEightBits},
                  {kFlow, 0},
                  {kModem, kRtsLow},
                  {kModem, kDtrLow},
                  {kModem, kDtrHigh}}))
    return "the USB bridge refuses its settings";
  if (!greet(port)) return "the loader does not answer; is the power supply on?";
  if (!all(port, {{kModem, kDtrLow}, {kBaud, kBaud140000}})) return "the USB bridge refuses its settings";
  constexpr std::array<std::uint8_t, 1> kBegin = {0x41};
  if (port.write(kBegin, kTimeoutS) != 1 || read_some(port, 1, kTimeoutS) != std::vector<std::uint8_t>{0x41})
    return "the loader does not begin";
  for (std::size_t at = 0; at < image.size(); at += kChunk) {
    const std::span<const std::uint8_t> chunk = std::span(image).subspan(at, std::min(kChunk, image.size() - at));
    if (port.write(chunk, kTimeoutS) != chunk.size()) return "the loader stops at byte " + std::to_string(at);
    const std::vector<std::uint8_t> echo = read_some(port, chunk.size(), kTimeoutS);
    if (!std::equal(echo.begin(), echo.end(), chunk.begin(), chunk.end()))
      return "the loader echoes something else at byte " + std::to_string(at);
  }
  if (!enter_run_mode(port)) return "the USB bridge refuses its settings";
  return firmware_runs(port) ? "" : "the loaded firmware does not answer";
}

}  // namespace sparsha::haptics::falcon

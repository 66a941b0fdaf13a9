// Another program's way to a Falcon: plain libusb by the published facts, with no line of the driver or the emulator.
// Names the device, loads its firmware, homes it, waits for a button; `leave-force` then pushes and ends so. `rate`
// counts answers instead of homing; `turn` does so for four seconds as libnifalcon's loop runs: a write and a read
// without waiting, then the library's events for 100 us a pass.
#include <libusb.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr unsigned kTimeout_ms = 1000;
constexpr unsigned char kOut = 0x02, kIn = 0x81;
constexpr const char* kNoForce = "AAAAAAAAAAAA";
libusb_device_handle* falcon = nullptr;

[[noreturn]] void fail(const char* what, int status) {
  std::printf("failed: %s (%s)\n", what, status < 0 ? libusb_error_name(status) : std::to_string(status).c_str());
  std::exit(1);
}

void set(std::uint8_t request, std::uint16_t value) {
  const int status = libusb_control_transfer(falcon, 0x40, request, value, 0, nullptr, 0, kTimeout_ms);
  if (status != 0) fail("control", status);
}

void send(const void* bytes, int size) {
  std::vector<unsigned char> copy(static_cast<std::size_t>(size));
  std::memcpy(copy.data(), bytes, copy.size());
  int sent = 0;
  const int status = libusb_bulk_transfer(falcon, kOut, copy.data(), size, &sent, kTimeout_ms);
  if (status != 0 || sent != size) fail("write", status);
}

/// At least `size` bytes behind the modem status of each packet, or what has come in 200 packets.
std::string receive(std::size_t size) {
  std::string bytes;
  for (int i = 0; i < 200 && bytes.size() < size; ++i) {
    std::array<unsigned char, 64> packet{};
    int got = 0;
    const int status =
        libusb_bulk_transfer(falcon, kIn, packet.data(), static_cast<int>(packet.size()), &got, kTimeout_ms);
    if (status != 0) fail("read", status);
    if (got > 2) bytes.append(reinterpret_cast<char*>(packet.data()) + 2, static_cast<std::size_t>(got) - 2);
  }
  return bytes;
}

void describe() {
  libusb_device_descriptor device{};
  int status =
      libusb_get_descriptor(falcon, LIBUSB_DT_DEVICE, 0, reinterpret_cast<unsigned char*>(&device), sizeof device);
  if (status != 18 || device.idVendor != 0x0403 || device.idProduct != 0xCB48) fail("device descriptor", status);
  std::array<unsigned char, 256> bytes{};
  status = libusb_get_descriptor(falcon, LIBUSB_DT_CONFIG, 0, bytes.data(), static_cast<int>(bytes.size()));
  if (status != 32 || bytes[2] != 32) fail("configuration descriptor", status);
  status = libusb_get_string_descriptor_ascii(falcon, device.iProduct, bytes.data(), static_cast<int>(bytes.size()));
  if (status < 0) fail("product string", status);
  std::printf("product %.*s\n", status, reinterpret_cast<char*>(bytes.data()));
  if ((status = libusb_set_configuration(falcon, 1)) != 0) fail("set configuration", status);
  if ((status = libusb_claim_interface(falcon, 0)) != 0) fail("claim", status);
  if ((status = libusb_set_interface_alt_setting(falcon, 0, 0)) != 0) fail("set interface", status);
}

int latency_ms() {
  unsigned char latency = 0;
  const int status = libusb_control_transfer(falcon, 0xC0, 0x0A, 0, 0, &latency, 1, kTimeout_ms);
  if (status != 1) fail("latency", status);
  return latency;
}

void load_firmware(const char* file) {
  std::FILE* const in = std::fopen(file, "rb");
  if (in == nullptr) fail("firmware file", 0);
  std::vector<char> image(65536);
  image.resize(std::fread(image.data(), 1, image.size(), in));
  std::fclose(in);
  for (const auto& [request, value] : std::vector<std::pair<int, int>>{
           {0, 1}, {0, 2}, {9, 16}, {3, 0x4138}, {4, 8}, {2, 0}, {1, 0x0200}, {1, 0x0100}, {1, 0x0101}})
    set(static_cast<std::uint8_t>(request), static_cast<std::uint16_t>(value));
  if (latency_ms() != 16) fail("latency as set", latency_ms());
  send("\x0A\x43\x0D", 3);
  if (receive(4) != std::string("\x0A\x44\x2C\x0D")) fail("greeting", 0);
  set(1, 0x0100);
  set(3, 0x0015);
  send("A", 1);
  if (receive(1) != "A") fail("begin", 0);
  for (std::size_t at = 0; at < image.size(); at += 62) {
    const std::size_t size = std::min<std::size_t>(62, image.size() - at);
    send(image.data() + at, static_cast<int>(size));
    if (receive(size) != std::string(image.data() + at, size)) fail("echo", 0);
  }
}

/// One question, and byte 13 of its answer.
unsigned ask(const char* motors, char flags) {
  const std::string question = "<" + std::string(motors) + flags + "A>";
  send(question.data(), static_cast<int>(question.size()));
  const std::string answer = receive(16);
  if (answer.size() != 16 || answer.front() != '<' || answer.back() != '>') fail("answer", 0);
  return static_cast<unsigned>(static_cast<unsigned char>(answer[13]) - 'A');
}

/// Of ten seconds, the one with the most answers to questions that are asked as soon as the last is answered.
int best_rate() {
  using Steady = std::chrono::steady_clock;
  constexpr int kSeconds = 10;
  int best = 0;
  for (int second = 0; second < kSeconds; ++second) {
    const Steady::time_point end = Steady::now() + std::chrono::seconds(1);
    int answers = 0;
    for (; Steady::now() < end; ++answers) ask(kNoForce, 'A');
    best = std::max(best, answers);
  }
  return best;
}

/// What is on its way between two passes.
struct Turn {
  std::array<unsigned char, 64> read{};
  std::array<unsigned char, 16> written{};
  bool reading = false, writing = false, failed = false;
  std::string bytes;
};

void LIBUSB_CALL has_read(libusb_transfer* transfer) {
  Turn& turn = *static_cast<Turn*>(transfer->user_data);
  turn.reading = false;
  if (transfer->status != LIBUSB_TRANSFER_COMPLETED) turn.failed = true;
  if (transfer->actual_length > 2)
    turn.bytes.append(reinterpret_cast<char*>(transfer->buffer) + 2,
                      static_cast<std::size_t>(transfer->actual_length) - 2);
}

void LIBUSB_CALL has_written(libusb_transfer* transfer) {
  Turn& turn = *static_cast<Turn*>(transfer->user_data);
  turn.writing = false;
  if (transfer->status != LIBUSB_TRANSFER_COMPLETED) turn.failed = true;
}

/// Answers a second for four seconds, and the share of a core that they take.
void take_turn(libusb_context* context) {
  using Steady = std::chrono::steady_clock;
  constexpr double kSeconds = 4.0;
  Turn turn;
  libusb_transfer* const in = libusb_alloc_transfer(0);
  libusb_transfer* const out = libusb_alloc_transfer(0);
  libusb_fill_bulk_transfer(in, falcon, kIn, turn.read.data(), 64, has_read, &turn, kTimeout_ms);
  libusb_fill_bulk_transfer(out, falcon, kOut, turn.written.data(), 16, has_written, &turn, 0);
  std::memcpy(turn.written.data(), "<AAAAAAAAAAAAAA>", 16);
  const auto ask_again = [&] {
    turn.writing = libusb_submit_transfer(out) == 0;
    turn.reading = libusb_submit_transfer(in) == 0;
    if (!turn.writing || !turn.reading) fail("submit", 0);
  };
  const std::clock_t processor = std::clock();
  const Steady::time_point began = Steady::now();
  int answers = 0;
  ask_again();
  double passed_s = 0.0;
  while ((passed_s = std::chrono::duration<double>(Steady::now() - began).count()) < kSeconds && !turn.failed) {
    timeval patience{0, 100};
    libusb_handle_events_timeout(context, &patience);
    if (turn.reading || turn.writing) continue;
    if (turn.bytes.size() < 16) {
      turn.reading = libusb_submit_transfer(in) == 0;
      continue;
    }
    turn.bytes.erase(0, 16);
    ++answers;
    ask_again();
  }
  const double busy_s = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  std::printf("turn %.0f answers/s, %.0f %% of a core%s\n", answers / passed_s, 100.0 * busy_s / passed_s,
              turn.failed ? ", and a transfer failed" : "");
}

}  // namespace

int main(int count, char** arguments) {
  constexpr int kMostAnswers = 60000;
  const std::string mode = count > 1 ? arguments[1] : "";
  const char* const firmware = std::getenv("SPARSHA_FALCON_FIRMWARE");
  libusb_context* context = nullptr;
  if (libusb_init(&context) != 0) fail("libusb", 0);
  falcon = libusb_open_device_with_vid_pid(context, 0x0403, 0xCB48);
  if (falcon == nullptr || firmware == nullptr) fail("open", 0);
  describe();
  load_firmware(firmware);
  set(9, 1);
  set(3, 2);
  set(0, 1);
  set(0, 2);
  unsigned char status[2] = {};
  if (libusb_control_transfer(falcon, 0xC0, 0x05, 0, 0, status, 2, kTimeout_ms) != 2) fail("modem status", 0);
  std::printf("latency %d\n", latency_ms());
  if (mode == "turn") {
    take_turn(context);
    return 0;
  }
  if (mode == "rate") {
    std::printf("rate %d\n", best_rate());
    return 0;
  }
  unsigned flags = 0;
  for (int i = 0; i < kMostAnswers && flags >> 4U != 7U; ++i) flags = ask(kNoForce, 'A' + 1 + 8);
  if (flags >> 4U != 7U) fail("homing", 0);
  std::printf("homed\n");
  for (int i = 0; i < kMostAnswers && (flags & 15U) == 0; ++i) flags = ask(kNoForce, 'A' + 1 + 4);
  std::printf("buttons %u\n", flags & 15U);
  if (mode == "leave-force") ask("ABAAABAAABAA", 'A' + 1 + 4);
  libusb_close(falcon);
  libusb_exit(context);
  return (flags & 15U) != 0 ? 0 : 1;
}

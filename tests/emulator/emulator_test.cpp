// The emulated Falcon against the published golden values, byte traces and times, without the driver.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "emulator/codec.h"
#include "emulator/falcon.h"
#include "emulator/geometry.h"
#include "emulator/person.h"

namespace {

using namespace sparsha::emulator;
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::vector<std::uint8_t> bytes(const std::string& text) { return {text.begin(), text.end()}; }

std::string text_of(const std::vector<std::uint8_t>& packet) {
  return packet.size() < 2 ? std::string() : std::string(packet.begin() + 2, packet.end());
}

TEST(FalconEmulatorGeometry, HasThePublishedPlacesOfEncoderCounts) {
  const struct {
    std::array<int, 3> counts;
    Vec3 place_mm;
  } golden[] = {{{0, 0, 0}, {0, 0, 134.60243}},
                {{500, 500, 500}, {0, 0, 156.86047}},
                {{-500, -500, -500}, {0, 0, 110.75450}},
                {{1000, 1000, 1000}, {0, 0, 173.60325}},
                {{-800, -800, -800}, {0, 0, 97.50572}},
                {{300, 0, -300}, {-4.11766, -21.65349, 132.31603}},
                {{-250, 100, 50}, {-5.68761, 12.17320, 132.15669}},
                {{1447, 0, 0}, {21.97878, -73.52398, 128.14347}}};
  for (const auto& [counts, place_mm] : golden) {
    const auto place = grip_place({angle_of(counts[0]), angle_of(counts[1]), angle_of(counts[2])}, {0, 0, 0.11});
    ASSERT_TRUE(place) << counts[0];
    // Published to 1e-5 mm, with the conversion's constant to seven digits.
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR((*place)[axis] * 1e3, place_mm[axis], 2e-4) << counts[0];
  }
  EXPECT_FALSE(grip_place({angle_of(1750), angle_of(1750), angle_of(1750)}, {0, 0, 0.11}));
}

TEST(FalconEmulatorGeometry, HasThePublishedAnglesOfPlaces) {
  const struct {
    Vec3 place_m;
    PerArm degrees;
  } golden[] = {{{0, 0, 0.11}, {16.18796, 16.18796, 16.18796}},
                {{0.03, 0, 0.11}, {26.68847, -1.21729, 33.96612}},
                {{0, 0.03, 0.12}, {8.37036, 32.57685, 41.02729}},
                {{0.03, 0.03, 0.13}, {27.45513, 26.05263, 60.28081}},
                {{-0.05, 0, 0.12}, {26.99312, 60.23775, 12.13494}}};
  for (const auto& [place, degrees] : golden) {
    const auto angles = arm_angles(place);
    ASSERT_TRUE(angles);
    for (std::size_t arm = 0; arm < 3; ++arm) EXPECT_NEAR((*angles)[arm] * kDegrees, degrees[arm], 1e-5);
  }
  EXPECT_FALSE(arm_angles({0.2, 0, 0.1}));
}

TEST(FalconEmulatorGeometry, HasThePublishedRatesAndTorques) {
  const double golden[3][3] = {{3.20162, -10.6993, 13.2812}, {-10.8666, 2.57695, 13.2812}, {7.66503, 8.12232, 13.2812}};
  const auto rates = angle_rates({0, 0, 0.12});
  ASSERT_TRUE(rates);
  for (std::size_t arm = 0; arm < 3; ++arm)
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR((*rates)[arm][axis], golden[arm][axis], 1e-4);
  const Vec3 sideways = force_of({0.0171, -0.0581, 0.0410}, {0, 0, 0.12});
  const Vec3 outwards = force_of({0.0251, 0.0251, 0.0251}, {0, 0, 0.12});
  // Torques are published to 5e-5 N m, of which 13.3 / m three times over make 2 mN.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sideways[axis], axis == 0 ? 1.0 : 0.0, 3 * 13.3 * 5e-5);
    EXPECT_NEAR(outwards[axis], axis == 2 ? 1.0 : 0.0, 3 * 13.3 * 5e-5);
  }
}

TEST(FalconEmulatorCodec, ReadsTheVendorsTracesAndWritesTheirLetters) {
  const struct {
    std::array<int, 3> values;
    std::string letters;
  } golden[] = {{{4095, 3906, 4034}, "<PPPACEPACMPAEA>"},
                {{661, 731, 766}, "<FJCALNCAOPCAEA>"},
                {{-65, 136, -159}, "<PLPPIIAABGPPEA>"},
                {{-679, 2529, -1862}, "<JFNPBOJAKLIPEA>"}};
  CommandParser parser;
  for (const auto& [values, letters] : golden) {
    std::optional<Command> command;
    for (const char letter : "x<JF" + letters) {
      if (auto found = parser.feed(static_cast<std::uint8_t>(letter))) command = found;
    }
    ASSERT_TRUE(command) << letters;
    EXPECT_EQ(command->motors, values);
    EXPECT_EQ(command->flags, 4);
    const Answer answer = answer_bytes(values, 4, 0);
    EXPECT_EQ(std::string(answer.begin(), answer.end()), letters);
  }
}

/// The host's side of the wire, without the driver.
struct Host {
  explicit Host(const FalconOptions& options) : falcon(options) {}
  void run_mode(bool event_character = true) {
    falcon.control(BridgeRequest::kLatency, 1, now_s);
    falcon.control(BridgeRequest::kEventCharacter, event_character ? 0x013E : 0, now_s);
    falcon.control(BridgeRequest::kBaud, 2, now_s);
  }
  std::string ask(const std::string& text, int packets = 40) {
    falcon.write(bytes(text), now_s);
    // A command has an answer of its length, and so has what is echoed; the greeting's has four bytes.
    const std::size_t wanted = std::max<std::size_t>(text.size(), text.size() == 3 ? 4 : 1);
    std::string reply;
    for (int i = 0; i < packets && reply.size() < wanted; ++i) {
      now_s = std::max(now_s, falcon.packet_s());
      if (const auto packet = falcon.read(now_s)) reply += text_of(*packet);
    }
    return reply;
  }
  Falcon falcon;
  double now_s = 0.0;
};

const std::string kAsk = "<AAAAAAAAAAAAIA>", kForce = "<AEAAAEAAAEAAFA>", kHome = "<AAAAAAAAAAAABA>";

TEST(FalconEmulator, BootLoaderGreetsAtItsBaudRatesEchoesAndThenRuns) {
  FalconOptions options;
  options.firmware_loaded = false;
  options.image_bytes = 300;
  Host host(options);
  host.run_mode();
  EXPECT_EQ(host.ask(kAsk), "");
  host.falcon.control(BridgeRequest::kLatency, 16, host.now_s);
  host.falcon.control(BridgeRequest::kBaud, 0x4138, host.now_s);
  host.falcon.control(BridgeRequest::kModem, 0x0100, host.now_s);
  host.falcon.control(BridgeRequest::kModem, 0x0101, host.now_s);
  EXPECT_EQ(host.ask("\x0A\x43\x0D"), "\x0A\x44\x2C\x0D");
  EXPECT_EQ(host.ask("\x41", 4), "") << "not at 9600 baud";
  host.falcon.control(BridgeRequest::kModem, 0x0100, host.now_s);
  host.falcon.control(BridgeRequest::kBaud, 0x0015, host.now_s);
  EXPECT_EQ(host.ask("\x41"), "\x41");
  const double began_s = host.now_s;
  std::string image;
  for (int i = 0; i < 10; ++i) {
    const std::string chunk(62, static_cast<char>('a' + i));
    EXPECT_EQ(host.ask(chunk), chunk);
    image += chunk;
  }
  // Ten bits a byte at 142857 baud; the echo follows each byte.
  EXPECT_GE(host.now_s - began_s, 620 * 10 / 142857.0);
  EXPECT_EQ(host.falcon.uploaded(), bytes(image));
  host.run_mode();
  EXPECT_EQ(host.ask(kAsk), "<AAAAAAAAAAAAAA>");
}

TEST(FalconEmulator, AnAnswerOf18BytesComesWithTheFrameWhenTheEventCharacterIsSet) {
  const auto rate = [](bool event_character, unsigned latency_ms, double host_takes_s) {
    Host host(FalconOptions{});
    host.now_s = 0.1e-3;  // the latency timer does not run with the frames
    host.run_mode(event_character);
    host.falcon.control(BridgeRequest::kLatency, static_cast<std::uint16_t>(latency_ms), host.now_s);
    const double began_s = host.now_s;
    for (int i = 0; i < 500; ++i) {
      EXPECT_EQ(host.ask(kAsk).size(), 16U);
      host.now_s += host_takes_s;
    }
    return 500.0 / (host.now_s - began_s);
  };
  EXPECT_NEAR(rate(true, 1, 0.2e-3), 1000.0, 10.0);
  EXPECT_NEAR(rate(true, 16, 0.2e-3), 1000.0, 10.0);
  EXPECT_LE(rate(false, 1, 0.2e-3), 501.0);
  EXPECT_LT(rate(false, 16, 0.2e-3), 63.0);
}

TEST(FalconEmulator, EncodersAreHomedOneByOneOnlyWhenAskedAndOnlyAfterThePullAndThePush) {
  Host host(FalconOptions{});
  host.run_mode();
  const auto homed = [&](const std::string& ask) { return (static_cast<unsigned char>(host.ask(ask)[13]) - 'A') >> 4; };
  host.falcon.set_place({0, 0, 0.170});
  EXPECT_EQ(homed(kAsk), 0);
  host.falcon.set_place({0, 0, 0.105});
  EXPECT_EQ(homed(kHome), 0) << "the pull was not asked for";
  host.falcon.set_place({0, 0, 0.170});
  EXPECT_EQ(homed(kHome), 0);
  host.falcon.set_place({0, 0.03, 0.115});  // towards the top arm: it alone goes in
  EXPECT_EQ(homed(kHome), 1);
  host.falcon.set_place({0, 0, 0.105});
  EXPECT_EQ(homed(kHome), 7);
  // Counts are absolute from now on: those of the published place.
  host.falcon.set_place({0, 0, 0.11});
  const std::string answer = host.ask(kAsk);
  const Answer published = answer_bytes({-516, -516, -516}, 0, 7);
  EXPECT_EQ(answer, std::string(published.begin(), published.end()));
}

TEST(FalconEmulator, MotorsHoldTheirForceForAsLongAsNothingElseIsSaid) {
  FalconOptions options;
  options.homed = true;
  Host host(options);
  host.run_mode();
  host.falcon.set_place({0, 0, 0.12});
  static_cast<void>(host.ask(kForce));
  EXPECT_EQ(host.falcon.motors(), (std::array<int, 3>{64, 64, 64}));
  // Positive counts push inwards: three torques of -0.0064 N m, of which 0.0251 N m each are a newton.
  EXPECT_NEAR(host.falcon.force_n()[2], -0.0064 * 3 * 13.2812, 1e-4);
  host.now_s += 100.0;
  EXPECT_NE(host.falcon.motors(), (std::array<int, 3>{}));
  static_cast<void>(host.ask(kAsk));
  EXPECT_EQ(host.falcon.motors(), (std::array<int, 3>{}));
}

TEST(FalconEmulator, ForceBeforeHomingIsCounted) {
  Host host(FalconOptions{});
  host.run_mode();
  static_cast<void>(host.ask(kAsk));
  EXPECT_EQ(host.falcon.unsafe_commands(), 0U);
  static_cast<void>(host.ask(kForce));
  EXPECT_EQ(host.falcon.unsafe_commands(), 1U);
}

TEST(FalconEmulator, ThePersonHomesComesForwardAndPressesByTheLights) {
  Host host(FalconOptions{});
  host.falcon.set_hand(make_person());
  host.run_mode();
  const auto light = [](const std::string& ask, int bits) {
    std::string text = ask;
    text[13] = static_cast<char>('A' + bits);
    return text;
  };
  int asked = 0;
  for (; !host.falcon.homed() && asked < 3000; ++asked) static_cast<void>(host.ask(light(kAsk, 1 | 8)));
  EXPECT_TRUE(host.falcon.homed());
  double deepest_m = 1.0;
  std::array<int, 3> counts{};
  for (int i = 0; i < 3000; ++i) {
    const std::string answer = host.ask(light(kAsk, 1 | (i < 1000 ? 2 : 4)));
    // An answer's layout is a command's.
    CommandParser parser;
    for (const char letter : answer)
      if (const auto read = parser.feed(static_cast<std::uint8_t>(letter))) counts = read->motors;
    const auto place = grip_place({angle_of(counts[0]), angle_of(counts[1]), angle_of(counts[2])}, {0, 0, 0.13});
    ASSERT_TRUE(place);
    if (i == 999) {
      EXPECT_GT((*place)[2], 0.160);
    }
    deepest_m = std::min(deepest_m, (*place)[2]);
  }
  EXPECT_LT(deepest_m, 0.120) << "nothing is there to stop it";
}

}  // namespace

// The 16-byte packets: golden traces, round trips, streams cut anywhere, saturation.
#include "haptics/device/falcon/packet.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "emulator/codec.h"

namespace {

using namespace sparsha::haptics::falcon;
using sparsha::emulator::answer_bytes;

Packet text(const std::string& letters) {
  Packet packet{};
  EXPECT_EQ(letters.size(), packet.size());
  std::copy(letters.begin(), letters.end(), packet.begin());
  return packet;
}

TEST(FalconPacket, TracesOfTheVendorsDriverDecodeAndEncodeToTheLetter) {
  // From the public protocol notes of libnifalcon's developers; byte 13 carries the blue light.
  const struct {
    MotorCommand command;
    std::string letters;
  } golden[] = {{{4095, 3906, 4034}, "<PPPACEPACMPAEA>"},
                {{661, 731, 766}, "<FJCALNCAOPCAEA>"},
                {{-65, 136, -159}, "<PLPPIIAABGPPEA>"},
                {{-679, 2529, -1862}, "<JFNPBOJAKLIPEA>"}};
  for (const auto& [command, letters] : golden) {
    EXPECT_EQ(encode(command, kLightBlue), text(letters));
  }
  EXPECT_EQ(encode({}, 0), text("<AAAAAAAAAAAAAA>"));
  EXPECT_EQ(decode_answer(text("<JFKPAAAAAAAAAA>"))->counts, (Counts{-1447, 0, 0}));
}

TEST(FalconPacket, EveryNumberAndFlagRoundTrips) {
  for (int value = -32768; value <= 32767; ++value) {
    const auto answer = decode_answer(answer_bytes({value, -1, 7}, static_cast<std::uint8_t>(value & 15),
                                                   static_cast<std::uint8_t>((value >> 4) & 7)));
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->counts, (Counts{value, -1, 7}));
    EXPECT_EQ(answer->buttons, value & 15);
    EXPECT_EQ(answer->homed, (value >> 4) & 7);
  }
}

TEST(FalconPacket, MalformedPacketsAreRefused) {
  const Packet good = answer_bytes({1, 2, 3}, 5, 7);
  ASSERT_TRUE(decode_answer(good));
  for (std::size_t at = 0; at < kPacketBytes; ++at) {
    if (at == 14) continue;  // its meaning is unknown
    Packet bad = good;
    bad[at] = 0x07;
    EXPECT_FALSE(decode_answer(bad)) << at;
  }
}

TEST(FalconPacket, CommandsNeverLeaveTheAmplifiersRangeAndKeepTheirDirection) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d torque =
        std::pow(10.0, normal(random)) * Eigen::Vector3d(normal(random), normal(random), normal(random));
    const MotorCommand command = motor_command(torque, 10000.0);
    const Eigen::Vector3d counts(command[0], command[1], command[2]);
    EXPECT_LE(counts.cwiseAbs().maxCoeff(), 4095.0);
    const Eigen::Vector3d wanted = -10000.0 * torque;
    const double scale = std::min(1.0, 4095.0 / wanted.cwiseAbs().maxCoeff());
    EXPECT_LE((counts - scale * wanted).cwiseAbs().maxCoeff(), 0.5 + 1e-9);  // rounding to counts
  }
  EXPECT_EQ(motor_command({std::nan(""), 1, 1}, 10000.0), MotorCommand{});
  EXPECT_EQ(motor_command({INFINITY, 1, 1}, 10000.0), MotorCommand{});
  EXPECT_EQ(encode({70000, -70000, 0}, 0), encode({4095, -4095, 0}, 0));
}

TEST(FalconPacket, AStreamCutAnywhereGivesEveryAnswer) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 1000; ++i) {
    const Packet packet = answer_bytes({i, -i, 2 * i}, 0, 7);
    bytes.insert(bytes.end(), packet.begin(), packet.end());
  }
  AnswerStream stream;
  int seen = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(bytes.size() - at, 1 + random() % 15);
    if (const auto answer = stream.feed(std::span(bytes).subspan(at, size))) {
      EXPECT_EQ(answer->counts[0], seen++);
    }
    at += size;
  }
  EXPECT_EQ(seen, 1000);
  EXPECT_EQ(stream.rubbish(), 0U);
}

TEST(FalconPacket, AStreamFindsItsFeetAgainAfterRubbish) {
  std::mt19937 random(6);
  AnswerStream stream;
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> rubbish(random() % 40);
    for (auto& byte : rubbish) byte = random() % 4 == 0 ? '<' : static_cast<std::uint8_t>(random());
    static_cast<void>(stream.feed(rubbish));
    // After rubbish that ends in a false beginning, at most one answer is lost in finding out.
    static_cast<void>(stream.feed(answer_bytes({0, 0, 0}, 0, 0)));
    const auto answer = stream.feed(answer_bytes({i, i, i}, 1, 7));
    if (answer && answer->counts[0] == i) ++found;
  }
  EXPECT_EQ(found, 2000);
}

}  // namespace

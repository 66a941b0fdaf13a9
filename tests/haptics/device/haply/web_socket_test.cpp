// Frames and JSON, byte by byte, against RFC 6455 and 8259.
#include "haptics/device/haply/web_socket.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <string>

#include "emulator/web_socket_server.h"
#include "haptics/device/haply/json_walk.h"
#include "haptics/device/haply/messages.h"
#include "tests/support/allocations.h"

namespace sparsha::haptics::haply {
namespace {

using Found = FrameReader::Found;

void feed(FrameReader& reader, std::string_view bytes) {
  const std::span<char> room = reader.room();
  ASSERT_GE(room.size(), bytes.size());
  std::memcpy(room.data(), bytes.data(), bytes.size());
  reader.add(bytes.size());
}

TEST(HaplyFrames, TheExamplesOfTheStandardAreUnderstood) {
  FrameReader reader;
  std::string_view text;
  feed(reader, std::string_view("\x81\x05Hello", 7));
  EXPECT_EQ(reader.next(text), Found::text);
  EXPECT_EQ(text, "Hello");
  feed(reader, std::string_view("\x01\x03Hel", 5));
  EXPECT_EQ(reader.next(text), Found::nothing);
  feed(reader, std::string_view("\x89\x05Hello\x80\x02lo", 11));  // a ping between the pieces
  EXPECT_EQ(reader.next(text), Found::ping);
  EXPECT_EQ(text, "Hello");
  EXPECT_EQ(reader.next(text), Found::text);
  EXPECT_EQ(text, "Hello");
  feed(reader, std::string_view("\x88\x00", 2));
  EXPECT_EQ(reader.next(text), Found::closed);
  // Of a client, masked with 37 fa 21 3d.
  std::array<char, 32> frame{};
  ASSERT_EQ(write_frame(frame, 1, "Hello", 0x3d21fa37U), 11U);
  EXPECT_EQ(std::string_view(frame.data(), 11), std::string_view("\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58", 11));
  EXPECT_EQ(write_frame(std::span(frame).first(10), 1, "Hello", 1), 0U) << "no room";
}

TEST(HaplyFrames, WhatTheStandardForbidsIsMalformedForEver) {
  for (const std::string& wrong :
       {std::string("\x81\x85xxxxhello"), std::string("\xC1\x01x"), std::string("\x82\x01x"), std::string("\x80\x01x"),
        std::string("\x83\x01x"), std::string("\x09\x01x"), std::string("\x81\x7F\x7F\x00\x00\x00\x00\x00\x00\x00", 10),
        std::string("\x89\x7E\x01\x00", 4)}) {
    FrameReader reader(1024);
    std::string_view text;
    feed(reader, wrong);
    feed(reader, std::string(300, 'x'));
    EXPECT_EQ(reader.next(text), Found::malformed);
    EXPECT_EQ(reader.next(text), Found::malformed);
  }
}

TEST(HaplyFrames, TextThatIsNoUtf8IsMalformedWhereverItIsCut) {
  // A lone continuation, a cut character, a surrogate, more than there is, a longer form than needed.
  for (const std::string wrong : {"\x80", "\xC3", "\xE2\x82", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xC0\xAF", "\xFF"}) {
    for (const int pieces : {1, 3}) {
      FrameReader reader;
      std::string_view text;
      feed(reader, emulator::WebSocketPeer::frames_of("{\"name\":\"" + wrong + "\"}", pieces));
      EXPECT_EQ(reader.next(text), Found::malformed);
    }
  }
  FrameReader reader;
  std::string_view text;
  // A character may be cut by frames.
  feed(reader, std::string_view("\x01\x03\x22\xE2\x82\x80\x02\xAC\x22", 9));
  EXPECT_EQ(reader.next(text), Found::text);
  EXPECT_EQ(text, "\"\xE2\x82\xAC\"");
}

TEST(HaplyFrames, MessagesOfAllSizesInAnyPiecesArriveWhole) {
  std::mt19937 random(5);
  FrameReader reader;
  for (const std::size_t size : {0U, 1U, 125U, 126U, 127U, 4096U, 65535U, 65536U}) {
    std::string message(size, '\0');
    for (char& one : message) one = static_cast<char>('a' + random() % 26);
    for (const int pieces : {1, 3}) {
      const std::string bytes = emulator::WebSocketPeer::frames_of(message, pieces);
      std::size_t at = 0;
      std::string_view text;
      Found found = Found::nothing;
      while (at < bytes.size()) {
        ASSERT_EQ(found, Found::nothing);
        const std::size_t more = std::min<std::size_t>(bytes.size() - at, 1 + random() % 5000);
        feed(reader, std::string_view(bytes).substr(at, more));
        at += more;
        found = reader.next(text);
      }
      EXPECT_EQ(found, Found::text) << size;
      EXPECT_EQ(text, message) << size;
    }
  }
}

TEST(HaplyJson, ValidTextsAreReadAndOthersAreNot) {
  const auto valid = [](std::string_view text) { return walk_json(text, [](const JsonPath&, const JsonValue&) {}); };
  for (const char* text : {"{}", "[]", " {\"a\" : [1, -0.5e-3, true, false, null, \"x\\\"y\", {}]} ", "0", "-0", "1E+2",
                           "\"\\u00e9\"", "[[[[[[[[]]]]]]]]"})
    EXPECT_TRUE(valid(text)) << text;
  for (const char* text : {"",         "{",
                           "}",        "{\"a\"}",
                           "{\"a\":}", "[1,]",
                           "[,1]",     "01",
                           "1.",       ".5",
                           "+1",       "nan",
                           "inf",      "-",
                           "1e",       "1e999",
                           "tru",      "\"x",
                           "\"a\nb\"", "{} {}",
                           "{a:1}",    "[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]"})
    EXPECT_FALSE(valid(text)) << text;
}

TEST(HaplyJson, NoPrefixAndNoChangedByteOfAMessageReadsPastItsEnd) {
  const std::string whole =
      R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":1e-3,"y":-0.1,"z":0.16}}}],"verse_grip":[]})";
  ServiceState state;
  ASSERT_TRUE(read_state(whole, "A", state));
  std::mt19937 random(9);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string part = whole.substr(0, size);
    EXPECT_FALSE(read_state(std::string_view(part.data(), size), "A", state)) << part;
  }
  for (int change = 0; change < 20'000; ++change) {
    std::string changed = whole;
    changed[random() % changed.size()] = static_cast<char>(random() % 256);
    static_cast<void>(read_state(changed, "A", state));
    EXPECT_TRUE(state.position_m.allFinite());
  }
}

TEST(HaplyMessages, StatesOfSeveralServicesAreUnderstoodWithoutAllocation) {
  const std::string text =
      R"({"session_id":3,"unknown":{"deep":[[1,2],{"inverse3":[{}]}]},"inverse3":[{"state":{"cursor_position":)"
      R"({"x":0.5,"y":0.5,"z":0.5}},"device_id":"OTHER"},{"config":{"preset":"arm_front_centered","basis":{"permutation":"XYZ"}},)"
      R"("state":{"cursor_position":{"x":1.1E-2,"y":-0.098,"z":159e-3},"current_cursor_force":{"x":0,"y":0.4,"z":1.25}},)"
      R"("status":{"calibrated":true},"device_id":"0A1B"}],)"
      R"("verse_grip":[{"state":{"buttons":{"a":true,"b":false,"c":true},"orientation":{"w":1,"x":0,"y":0,"z":0}}}]})";
  ServiceState state;
  const std::size_t before = allocations::count();
  const bool read = read_state(text, "0A1B", state);
  EXPECT_EQ(allocations::count(), before);
  ASSERT_TRUE(read);
  EXPECT_TRUE(state.found && state.is_state && state.has_position && state.has_force && state.has_session);
  EXPECT_EQ(state.position_m, Eigen::Vector3d(0.011, -0.098, 0.159));
  EXPECT_EQ(state.force_n, Eigen::Vector3d(0.0, 0.4, 1.25));
  EXPECT_TRUE(state.right_basis && state.right_preset);
  EXPECT_EQ(state.buttons, 5U);
  EXPECT_EQ(state.orientation[0], 1.0);
  EXPECT_EQ(state.inverses, 2);
  ASSERT_TRUE(read_state(text, "", state));
  EXPECT_EQ(state.first.view(), "OTHER");
  EXPECT_EQ(state.position_m, Eigen::Vector3d(0.5, 0.5, 0.5)) << "the first, where none is wanted";
  ASSERT_TRUE(read_state(R"({"inverse3":[]})", "0A1B", state));
  EXPECT_TRUE(state.is_state && !state.found) << "it has gone";
  ASSERT_TRUE(
      read_state(R"({"inverse3":[{"device_id":"0A1B","state":{"cursor_position":{"x":1,"y":2}}}]})", "0A1B", state));
  EXPECT_FALSE(state.has_position) << "two coordinates are no place";
  EXPECT_FALSE(read_state("[1]", "", state));
}

TEST(HaplyMessages, WhoTellsTwiceWhereTheHandIsIsNotBelieved) {
  const auto read = [](const std::string& element) {
    ServiceState state;
    return read_state(R"({"inverse3":[)" + element + "]}", "A", state) && state.has_position;
  };
  const std::string place = R"("cursor_position":{"x":1e-3,"y":-0,"z":0.16})";
  EXPECT_TRUE(read(R"({"device_id":"A","state":{)" + place + "}}"));
  EXPECT_TRUE(read(R"({"state":{"unknown":{"x":1,"x":2},)" + place + R"(},"new":1,"new":2,"device_id":"A"})"))
      << "of what nobody knows anything may be told";
  EXPECT_FALSE(read(R"({"device_id":"A","state":{)" + place + "," + place + "}}"));
  EXPECT_FALSE(read(R"({"device_id":"A","state":{)" + place + R"(},"state":{)" + place + "}}"));
  EXPECT_FALSE(read(R"({"device_id":"A","state":{"cursor_position":{"x":0,"y":0,"z":0,"x":0.1}}})"));
  EXPECT_FALSE(read(R"({"device_id":"A","device_id":"B","state":{)" + place + "}}"));
  EXPECT_FALSE(read(R"({"device_id":"A","state":{"current_cursor_force":{"x":0,"y":0,"z":0,"z":3},)" + place + "}}"));
  EXPECT_TRUE(read(R"({"device_id":"B","state":{)" + place + R"(}},{"device_id":"A","state":{)" + place + "}}"))
      << "two devices are two";
}

TEST(HaplyMessages, EventsSayWhatTheyMeanForTheForce) {
  using Kind = ServiceEvent::Kind;
  const auto kind_of = [](const std::string& name, const std::string& type, const std::string& id) {
    ServiceEvent event;
    EXPECT_TRUE(
        read_event(R"({"name":")" + name + R"(","data":{"device_id":")" + id + R"(","safety_type":")" + type + R"("}})",
                   "A", event));
    return event.about ? event.kind : Kind::other;
  };
  for (const char* type :
       {"ebrake_triggered", "fod_stage_changed", "stall_detected", "stability_ceiling", "of_tomorrow"})
    EXPECT_EQ(kind_of("device-safety-triggered", type, "A"), Kind::safety) << type;
  EXPECT_EQ(kind_of("device-safety-triggered", "ebrake_released", "A"), Kind::released);
  EXPECT_EQ(kind_of("device-safety-triggered", "ebrake_triggered", "B"), Kind::other) << "another's";
  EXPECT_EQ(kind_of("device-disconnected", "", "A"), Kind::disconnected);
  EXPECT_EQ(kind_of("device-busy", "", "A"), Kind::busy);
  EXPECT_EQ(kind_of("device-battery-low", "", "A"), Kind::other);
  ServiceEvent event;
  EXPECT_FALSE(read_event("device-busy", "A", event));
}

TEST(HaplyMessages, ForcesAreWrittenAsEachServiceWantsThemAndNoOthers) {
  std::array<char, 512> text{};
  const auto written = [&](const Eigen::Vector3d& force_n, ForceKey key) {
    return std::string(text.data(), write_force(text, "0A1B", force_n, key));
  };
  EXPECT_EQ(
      written({0.0, 0.4, 1.25}, ForceKey::vector),
      R"({"inverse3":[{"device_id":"0A1B","commands":{"set_cursor_force":{"vector":{"x":0,"y":0.4,"z":1.25}}}}]})");
  EXPECT_NE(written({0.0, 0.4, 1.25}, ForceKey::values).find(R"("values":{"x":0)"), std::string::npos);
  EXPECT_EQ(written({0.0, std::nan(""), 0.0}, ForceKey::vector), "");
  EXPECT_EQ(write_force(std::span(text).first(40), "0A1B", {1.0, 2.0, 3.0}, ForceKey::vector), 0U);
}

TEST(EmulatedWebSocket, HashesAsTheStandardDoes) {
  std::string hex;
  for (const char byte : emulator::sha1("abc")) {
    std::array<char, 3> two{};
    std::snprintf(two.data(), two.size(), "%02x", static_cast<unsigned>(static_cast<unsigned char>(byte)));
    hex += two.data();
  }
  EXPECT_EQ(hex, "a9993e364706816aba3e25717850c26c9cd0d89d");
}

}  // namespace
}  // namespace sparsha::haptics::haply

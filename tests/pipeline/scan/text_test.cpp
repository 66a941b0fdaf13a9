// Numbers and lines: the parser against the C library's, spellings found in files, all line ends.
#include "pipeline/scan/text.h"

#include <cmath>
#include <cstdlib>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sparsha::pipeline {
namespace {

double parse(const std::string& text) {
  double value = -12345.0;
  const char* const stop = parse_number(text.data(), text.data() + text.size(), value);
  EXPECT_EQ(stop, text.data() + text.size()) << text;
  return value;
}

TEST(ParseNumber, AgreesWithTheLibraryToTheLastBitOnRandomSpellings) {
  std::mt19937_64 random(7);
  char buffer[64];
  for (int i = 0; i < 200000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const int digits = static_cast<int>(random() % 20);
    const char* const format = random() % 3 == 0 ? "%.*f" : random() % 2 == 0 ? "%.*e" : "%.*g";
    const double shown =
        format[3] == 'f' ? std::ldexp(value, -std::ilogb(value) + static_cast<int>(random() % 40) - 20) : value;
    std::snprintf(buffer, sizeof buffer, format, digits, shown);
    ASSERT_EQ(parse(buffer), std::strtod(buffer, nullptr)) << buffer;
  }
}

TEST(ParseNumber, KnowsTheSpellingsOfTheWild) {
  EXPECT_EQ(parse("1."), 1.0);
  EXPECT_EQ(parse(".5"), 0.5);
  EXPECT_EQ(parse("+2.e1"), 20.0);
  EXPECT_EQ(parse("-3.1E-2"), -0.031);
  EXPECT_EQ(parse("1d3"), 1000.0);
  EXPECT_EQ(parse("1.25D-2"), 0.0125);
  EXPECT_EQ(parse("00012"), 12.0);
  EXPECT_EQ(parse("123456789012345678901234567890"), 123456789012345678901234567890.0);
  EXPECT_EQ(parse("0.000000000000000000000000000000123"), 1.23e-31);
  EXPECT_EQ(parse("1.23456789012345678901D5"), 123456.789012345678901);
  EXPECT_EQ(parse("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse("-1e400"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse("1e-400"), 0.0);
  EXPECT_TRUE(std::signbit(parse("-0")));
  for (const char* const text : {"inf", "+Inf", "INFINITY", "1.#INF", "1.#INF"})
    EXPECT_TRUE(std::isinf(parse(text))) << text;
  EXPECT_EQ(parse("-1.#INF"), -std::numeric_limits<double>::infinity());
  for (const char* const text : {"nan", "NaN", "-nan", "-NaN", "1.#QNAN", "-1.#IND", "nan(ind)", "-nan(ind)"}) {
    EXPECT_TRUE(std::isnan(parse(text))) << text;
  }
}

TEST(ParseNumber, StopsWhereTheNumberStopsAndFindsNoneInWords) {
  double value = 0.0;
  for (const std::string text : {"", "-", ".", "e5", "x", "+.e1", "#", "--1"}) {
    EXPECT_EQ(parse_number(text.data(), text.data() + text.size(), value), nullptr) << text;
  }
  const std::string text = "12e x";
  EXPECT_EQ(parse_number(text.data(), text.data() + text.size(), value), text.data() + 2);
  EXPECT_EQ(value, 12.0);
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  LineReader reader(text);
  std::string_view line;
  while (reader.next(line)) lines.emplace_back(line);
  return lines;
}

TEST(LineReader, KnowsAllLineEndsAndALastLineWithoutOne) {
  using ::testing::ElementsAre;
  EXPECT_THAT(lines_of("a\nb\n"), ElementsAre("a", "b"));
  EXPECT_THAT(lines_of("a\r\n\r\nb"), ElementsAre("a", "", "b"));
  EXPECT_THAT(lines_of("a\rb\r"), ElementsAre("a", "b"));
  EXPECT_THAT(lines_of(""), ElementsAre());
}

TEST(LineReader, KnowsTheLineEndsOfFilesThatWereJoined) {
  using ::testing::ElementsAre;
  EXPECT_THAT(lines_of("x y z\na\rb\rc\r"), ElementsAre("x y z", "a", "b", "c")) << "a header was put in front";
  EXPECT_THAT(lines_of("a\rb\nc\rd"), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(lines_of("a\rb\r\nc\rd\n"), ElementsAre("a", "b", "c", "d"));
  std::string joined = "a\rb\r";
  for (int k = 0; k < 15; ++k) joined += "c\n";
  EXPECT_EQ(lines_of(joined).size(), 17U);
  // A damaged line among many is one line.
  std::string damaged = "a\rb\n";
  for (int k = 0; k < 15; ++k) damaged += "c\n";
  EXPECT_EQ(lines_of(damaged).size(), 16U);
  EXPECT_EQ(lines_of(damaged).front(), "a\rb");
  EXPECT_THAT(lines_of("a\r\r\nb\r\r\n"), ElementsAre("a", "b")) << "converted twice";
}

TEST(LooksBinary, TellsTextFromBytes) {
  EXPECT_FALSE(looks_binary("x y z\n1\t2\r\n"));
  EXPECT_FALSE(looks_binary("# s\xC3\xA4ule\n"));
  EXPECT_TRUE(looks_binary(std::string_view("1 2\0", 4)));
  EXPECT_TRUE(looks_binary("\x01\x02\x03\x04"));
}

}  // namespace
}  // namespace sparsha::pipeline

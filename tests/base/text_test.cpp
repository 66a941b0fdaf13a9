#include "base/text/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace sparsha {
namespace {

TEST(Text, LengthsHaveTheUnitThatKeepsThemShort) {
  EXPECT_EQ(length_text(0.0), "0 mm");
  EXPECT_EQ(length_text(41e-6), "41 um");
  EXPECT_EQ(length_text(2.1e-4), "0.21 mm");
  EXPECT_EQ(length_text(0.0994), "99.4 mm");
  EXPECT_EQ(length_text(0.36), "36 cm");
  EXPECT_EQ(length_text(-0.36), "-36 cm");
  EXPECT_EQ(length_text(12.345), "12.3 m");
  EXPECT_EQ(length_text(5412000.0), "5412 km");
  EXPECT_EQ(length_text(1e-9), "0.001 um");
  EXPECT_EQ(length_text(std::numeric_limits<double>::infinity()), "unknown");
  EXPECT_EQ(length_text(std::nan("")), "unknown");
}

TEST(Text, PagesHaveTheirOwnSignsAndSpeechItsOwnWords) {
  EXPECT_EQ(length_text(-41e-6, TextStyle::typeset), "\u221241\u202F\u00B5m");
  EXPECT_EQ(length_text(0.0032, TextStyle::spoken), "3.2 millimetres");
  EXPECT_EQ(length_text(0.035, TextStyle::spoken), "3.5 centimetres");
  EXPECT_EQ(length_text(0.12, TextStyle::spoken), "12 centimetres");
  EXPECT_EQ(length_text(0.357, TextStyle::typeset), "35.7\u202Fcm");
  EXPECT_EQ(length_text(0.0009, TextStyle::typeset), "0.9\u202Fmm");
  EXPECT_EQ(length_text(12.5, TextStyle::typeset), "12.5\u202Fm");
  EXPECT_EQ(length_text(0.00008, TextStyle::screen), "80 \u00B5m");
  EXPECT_EQ(length_text(1.5, TextStyle::spoken), "1.5 metres");
}

TEST(Text, ValuesKeepTheirSignificantDigitsWithoutExponents) {
  EXPECT_EQ(value_text(0.0), "0");
  EXPECT_EQ(value_text(1.0), "1");
  EXPECT_EQ(value_text(1234.56), "1235");
  EXPECT_EQ(value_text(0.0012345), "0.00123");
  EXPECT_EQ(value_text(99.96), "100");
}

TEST(Text, ExactNumbersComeBackWithTheSameBits) {
  for (const double value : {0.1, -0.0, 1e-300, 123456789.0, 1.0 / 3.0, 5e-324}) {
    const double back = std::strtod(exact_text(value).c_str(), nullptr);
    EXPECT_EQ(back, value);
    EXPECT_EQ(std::signbit(back), std::signbit(value));
  }
  EXPECT_EQ(exact_text(0.1), "0.1");
}

TEST(Text, RoundNumbersAreOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(round_number(0.7), 0.5);
  EXPECT_DOUBLE_EQ(round_number(0.3), 0.2);
  EXPECT_DOUBLE_EQ(round_number(5.0), 5.0);
  EXPECT_DOUBLE_EQ(round_number(0.049), 0.02);
  EXPECT_DOUBLE_EQ(round_number(130.0), 100.0);
  for (const double none : {0.0, -3.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(round_number(none), 0.0);
  }
}

TEST(Text, CountsAreGroupedByThousands) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(1234567), "1 234 567");
  EXPECT_EQ(count_text(1000, TextStyle::typeset), "1\u202F000");
}

}  // namespace
}  // namespace sparsha

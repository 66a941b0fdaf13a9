// Tables as other programs and people write them, that must not be read as something else: what is refused says why.
#include <string>

#include <gmock/gmock.h>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using testing::expect_refused;

void expect_read(const std::string& text, const std::string& name = "t.csv") {
  const auto error = testing::error_of_bytes(name, text);
  EXPECT_FALSE(error) << error->what();
}

std::string rows(const std::string& header, const std::string& row, int count = 30) {
  std::string text = header;
  for (int k = 0; k < count; ++k) text += row + std::to_string(k) + "\n";
  return text;
}

TEST(Dialects, ThousandsBetweenBlanksAreRefusedWhereOtherSeparatorsPartTheValues) {
  for (const char* row :
       {"1 234.50;2 345.25;1.", "1 234,50;2 345,25;1,", "-12 345 678.5\t2 345.0\t0.", "1.5;2 345;0."}) {
    expect_refused("t.csv", rows("", row), "blanks part the thousands", 1);
  }
  expect_refused("t.csv", rows("X;Y;Z\n", "1 234,50;2 345,25;1,"), "blanks part the thousands", 2);
  expect_refused("t.csv", rows("", "\"1 234.5\",\"2 345.0\",1."), "blanks part the thousands", 1);
}

TEST(Dialects, BlanksBesideSeparatorsAndColoursBetweenBlanksAreNoThousands) {
  expect_read(rows("", "1.5; 2.5; 0."));
  expect_read(rows("", " 1.5 ;\t2.5 ; 0."));
  expect_read(rows("", "234 500 1."));
  expect_read(rows("", "412,5 812,3 12,"));
  expect_read(rows("", "123,456 234,567 345,"));
  expect_read(rows("", "0.5,0.25,0.1,255 128 10"));
}

TEST(Dialects, CharactersThatLookLikeAsciiAreNamed) {
  expect_refused("t.csv", rows("", "\u22120.5 0.25 0."), "<U+2212>0.5");
  expect_refused("t.csv", rows("X;Y;Z\n", "412\u202f345,5;1,5;0,"), "412<U+202F>345,5");
  expect_refused("t.csv", rows("", "0.5\u00a00.25\u00a00."), "<U+00A0>");
}

TEST(Dialects, ZeroBytesBehindTheRowsAreSaidToBeThat) {
  expect_refused("t.csv", rows("", "0.5 0.25 0.", 400) + std::string(512, '\0'), "zero bytes in place of", 401);
}

}  // namespace
}  // namespace sparsha::pipeline

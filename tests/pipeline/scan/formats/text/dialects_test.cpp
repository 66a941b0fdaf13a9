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

TEST(Dialects, LettersOfOtherAlphabetsInNumbersAreNamedToo) {
  const std::string sound = rows("", "0.5 0.25 0.", 20);
  expect_refused("t.csv", sound + "0.5 0.25 \u041e.5\n", "'<U+041E>.5' is not a number", 21);
  expect_refused("t.csv", sound + "\uff11.5 0.25 0.5\n", "<U+FF11>.5", 21);
  for (const char* digits :
       {"1\u043e0", "1\u03bf0", "1\uff100", "\u06f1\u06f0\u06f0", "10\u200b0", "\u2212100", "1\u00a0000"}) {
    SCOPED_TRACE(digits);
    const std::string odd = std::string("0.5 0.25 0.5 255 ") + digits + " 3\n";
    expect_refused("t.csv", "x y z r g b\n0.5 0.25 0.5 255 100 3\n" + odd, "is not a number", 3);
    expect_refused("t.csv", "0.5 0.25 0.5 255 100 3\n" + odd, "is not a number", 2);
  }
}

TEST(Dialects, AFirstRowWithSuchCharactersIsNoTitle) {
  using namespace std::string_literals;
  const std::string others = rows("", "0.5 0.25 0.");
  for (const std::string& row :
       {"\u22120.5 0.25 0.5"s, "\uff10.5 0.25 0.5"s, "\u00a00.5 0.25 0.5"s, "\u041e.5 0.25 0.5"s, "\u03bf.5 0.25 0.5"s,
        "\x96\x30.5 0.25 0.5"s, "0.5\xa0\x30.25\xa0\x30.5"s}) {
    SCOPED_TRACE(row);
    expect_refused("t.csv", row + "\n" + others, "is not a row of numbers", 1);
  }
}

TEST(Dialects, WordsWithSuchCharactersAreWords) {
  for (const char* word :
       {"\u2014", "\u041e", "\u0422\u043e\u0447\u043a\u0430-5", "12\u00b030", "\u21165", "5\u043c"}) {
    SCOPED_TRACE(word);
    expect_read("x y z name\n" + rows("", "0.5 0.25 0.125 ") + "0.5 0.25 0.125 " + word + "\n");
  }
  expect_refused("t.csv", rows("", "0.5 0.25 0.") + "0.5 0.25 \u0437\u043e\u043d\u0430\n",
                 "'\u0437\u043e\u043d\u0430'");
}

TEST(Dialects, AxesInLettersOfOtherAlphabetsAreWhatTheyLookLike) {
  for (const char* header : {"z \u0443 \u0445\n", "\u0396 \u03a5 \u03a7\n", "\uff5a \uff59 \uff58\n", "Z Y \u0425\n"}) {
    const RawScan scan = read_scan_bytes(header + std::string("1.5 2.5 3.5\n4.5 5.5 6.5\n"), "t.txt");
    EXPECT_THAT(scan.points, ::testing::ElementsAre(Eigen::Vector3d(3.5, 2.5, 1.5), Eigen::Vector3d(6.5, 5.5, 4.5)))
        << header;
  }
}

TEST(Dialects, OneDamagedRowMovesNoHeader) {
  // Nine names over twelve values: those behind belong to the last name, whatever is wrong with a row.
  const std::string header = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n";
  const std::string sound = rows(header, "7 0.5 0.25 0.125 1 2 3 0.5 1 2 2 ", 30);
  EXPECT_EQ(read_scan_bytes(sound, "t.txt").points.front(), Eigen::Vector3d(0.5, 0.25, 0.125));
  expect_refused("t.txt", sound + "8 0.5 0.2x5 0.125 1 2 3 0.5 1 2 2 3\n", "'0.2x5' is not a number", 32);
}

TEST(Dialects, ZeroBytesBehindTheRowsAreSaidToBeThat) {
  expect_refused("t.csv", rows("", "0.5 0.25 0.", 400) + std::string(512, '\0'), "zero bytes in place of", 401);
}

}  // namespace
}  // namespace sparsha::pipeline

// Texts of any bytes written into YAML and read back.
#include "base/yaml/yaml_text.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/text/utf8.h"
#include "base/yaml/yaml.h"

namespace sparsha::yaml {
namespace {

std::string back(const std::string& text) {
  return to_text(*parse_text("file: " + yaml::quoted(text) + "  # " + comment(text) + "\n", "a.yaml").find("file"));
}

TEST(YamlText, EveryNameReadsBackAsTheSameBytes) {
  const std::vector<std::string> names{"a.ply",
                                       "-a.ply",
                                       "- a.ply",
                                       "a b #1: \"final\" (2).xyz",
                                       "l'eau & feu \xE2\x80\x93 \xE9\xBB\x9E\xE9\x9B\xB2.xyz",
                                       "two\nlines.xyz",
                                       "tab\tand\rreturn.xyz",
                                       "back\\slash\\n.xyz",
                                       "caf\xE9.xyz",           // Latin-1
                                       "\x93\x5F\x8C\x51.xyz",  // Shift JIS
                                       "\xC0\x80",
                                       "\xED\xA0\x80 surrogate",
                                       "\xFF\xFE",
                                       "cut \xE2\x80",
                                       "\x01\x1F\x7F",
                                       "\xC2\x85 next line",
                                       "\xE2\x80\xA8 line separator",
                                       "\xEF\xBB\xBF mark",
                                       "\xEF\xBF\xBF",
                                       "\xF0\x9F\x97\xBF moai",
                                       "{a: [b, c]}",
                                       "*alias &anchor !tag %percent @at `tick",
                                       "~",
                                       "null",
                                       "true",
                                       "1.5",
                                       " blanks ",
                                       "'single'",
                                       "a: b",
                                       "\xE2\x80\xAEturned"};
  for (const std::string& name : names) EXPECT_EQ(back(name), name);
  for (int first = 1; first < 256; ++first) {
    const std::string one(1, static_cast<char>(first));
    EXPECT_EQ(back(one), one) << first;
    for (const int second : {1, 10, 34, 92, 127, 128, 191, 192, 255}) {
      const std::string two = one + static_cast<char>(second) + "x";
      EXPECT_EQ(back(two), two) << first << " " << second;
    }
  }
}

TEST(YamlText, OrdinaryNamesStayReadable) {
  EXPECT_EQ(yaml::quoted("../scans/a b.ply"), "\"../scans/a b.ply\"");
  EXPECT_EQ(yaml::quoted("\xE9\xBB\x9E.ply"), "\"\xE9\xBB\x9E.ply\"");
  EXPECT_EQ(yaml::quoted("caf\xE9"), "!!binary \"Y2Fm6Q==\"");
}

TEST(YamlText, ACommentIsOneLineOfUtf8) {
  EXPECT_EQ(comment("a\nb\r\x1B[1m caf\xE9 \xE2\x80\xA8\xE9\xBB\x9E"), "a?b??[1m caf? ?\xE9\xBB\x9E");
}

TEST(YamlText, ABinaryValueMustBeBase64) {
  EXPECT_EQ(to_text(*parse_text("a: !!binary |\n  Y2Fm\n  6Q==\n", "a.yaml").find("a")), "caf\xE9");
  EXPECT_EQ(to_text(*parse_text("a: !!binary ''\n", "a.yaml").find("a")), "");
  for (const char* bad : {"Y2F", "Y2Fm6Q=", "====", "Y2*m", "Y===", "Y2=m"}) {
    EXPECT_THROW((void)parse_text(std::string("a: !!binary \"") + bad + "\"\n", "a.yaml"), Error) << bad;
  }
}

TEST(Utf8, IsReadStrictly) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("a\xC3\xA9\xE9\xBB\x9E\xF0\x9F\x97\xBF"));
  for (const char* bad :
       {"\x80", "\xC3", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80"}) {
    EXPECT_FALSE(is_utf8(bad));
  }
}

}  // namespace
}  // namespace sparsha::yaml

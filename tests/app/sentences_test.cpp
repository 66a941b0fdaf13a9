// --plain: every line that the program writes is a sentence that speech can read out.
#include "app/sentences.h"

#include <gtest/gtest.h>

#include <cctype>
#include <regex>
#include <sstream>
#include <string>

#include "tests/app/program.h"

namespace sparsha {
namespace {

/// Begins with a capital or a number, ends with a full stop, holds a verb, no column, no sign that is read out as
/// noise.
void expect_sentences(const std::string& text, int least) {
  const std::regex verb("\\b(is|are|was|were|has|took|went|felt|explored|made|lie|lacks|begins|heard)\\b");
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(line[0])) || std::isdigit(static_cast<unsigned char>(line[0])))
        << line;
    EXPECT_EQ(line.back(), '.') << line;
    EXPECT_TRUE(std::regex_search(line, verb)) << line;
    EXPECT_EQ(line.find("  "), std::string::npos) << "a column: " << line;
    for (const char* noise : {"%", "\x1b", "\r", " mm", " cm", " um", " N ", " ms", "nan", "inf"})
      EXPECT_EQ(line.find(noise), std::string::npos) << noise << " in: " << line;
  }
  EXPECT_GE(count, least) << text;
}

using Plain = Program;

TEST_F(Plain, BuildAndExploreSpeakInSentences) {
  const Outcome build = run("--plain build " + relief_ + " --out scene");
  ASSERT_EQ(build.code, 0) << build.err;
  expect_sentences(build.out, 6);
  EXPECT_NE(build.out.find("scene/report.html"), std::string::npos) << build.out;
  std::istringstream messages(build.err);
  for (std::string line; std::getline(messages, line);)
    if (line.rfind("warning: ", 0) != 0) expect_sentences(line, 1);
  const Outcome explore = run("--plain explore scene --device simulated --headless --duration 3");
  ASSERT_EQ(explore.code, 0) << explore.err;
  expect_sentences(explore.out, 6);
  EXPECT_NE(explore.out.find("seconds"), std::string::npos);
}

TEST(PlainSentences, OneOfAThingIsNotSeveral) {
  haptics::SessionSummary summary;
  summary.contacts = 1;
  summary.missed_ticks = 1;
  summary.ticks = 1;
  summary.faults = 1;
  summary.dropped_records = 1;
  const std::string text = app::summary_sentences(summary, 1);
  expect_sentences(text, 8);
  for (const char* wrong : {"1 contacts", "1 ticks", "1 faults", "1 rows", "1 strikes", "1 were"})
    EXPECT_EQ(text.find(wrong), std::string::npos) << text;
  EXPECT_EQ(app::progress_sentence("read", 0.4, 3.2),
            "The step read is 40 percent done, and about 3 seconds are left.");
  EXPECT_EQ(app::progress_sentence("read", 0.999, 0.1), "The step read is 100 percent done.");
}

}  // namespace
}  // namespace sparsha

// --plain: every line that the program writes is a sentence that speech can read out.
#include "app/words/sentences.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.h"

namespace sparsha {
namespace {

/// Begins with a capital or a number, ends with a full stop, holds a verb, no column, no sign that is read out as
/// noise.
void expect_sentences(const std::string& text, int least) {
  const std::regex verb("\\b(is|are|was|were|has|took|went|felt|explored|made|lie|lacks|begins|heard|falls|stands)\\b");
  const std::regex number_that_is_none("\\b(nan|inf)\\b");
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(line[0])) || std::isdigit(static_cast<unsigned char>(line[0])))
        << line;
    EXPECT_EQ(line.back(), '.') << line;
    EXPECT_TRUE(std::regex_search(line, verb)) << line;
    EXPECT_EQ(line.find("  "), std::string::npos) << "a column: " << line;
    for (const char* noise : {"%", "\x1b", "\r", " mm", " cm", " um", " N ", " ms"})
      EXPECT_EQ(line.find(noise), std::string::npos) << noise << " in: " << line;
    EXPECT_FALSE(std::regex_search(line, number_that_is_none)) << line;
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

/// Of a strike that rings: one mode, 16 bits, one channel.
std::string strike_wav() {
  std::string data;
  for (int i = 0; i < 48000; ++i) {
    const double t = i / 48000.0;
    const auto value = static_cast<std::int16_t>(
        std::lround(16000.0 * std::exp(-6.9078 * t / 0.9) * std::sin(2.0 * std::numbers::pi * 328.5 * t)));
    data += static_cast<char>(value & 0xFF);
    data += static_cast<char>(value >> 8 & 0xFF);
  }
  const auto number = [](std::uint32_t value, int bytes) {
    std::string text;
    for (int k = 0; k < bytes; ++k) text += static_cast<char>(value >> (8 * k) & 0xFFU);
    return text;
  };
  const auto length = static_cast<std::uint32_t>(data.size());
  return "RIFF" + number(36 + length, 4) + "WAVEfmt " + number(16, 4) + number(1, 2) + number(1, 2) + number(48000, 4) +
         number(96000, 4) + number(2, 2) + number(16, 2) + "data" + number(length, 4) + data;
}

TEST_F(Plain, EachCommandSpeaksInSentences) {
  const std::string data = (fs::path(SPARSHA_SOURCE_DIR) / "data" / "relief").string();
  ASSERT_EQ(run("build " + relief_ + " --out scene").code, 0);
  write("strike.wav", strike_wav());
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0.02\n0.001,0.1,0.1,-0.001\n0.002,0.1,0.1,-0.001\n");
  write("stone.yaml",
        "seed: 1\nnodes: 64\nsurface: {form: accuracy, size_m: [0.1, 0.1]}\nsampler: {points_per_node: 2}\n");
  write("two.yaml", "scans:\n  - {file: " + data +
                        "/station-1.ply, units: m, pose: {translate: [-0.55, -1, 0.6], "
                        "quaternion: [0, 0, -0.3100911230304846, 0.9507068398921367]}}\n  - {file: " +
                        data +
                        "/station-2.ply, units: m, pose: {translate: [0.95, -1.052, 0.35], "
                        "quaternion: [0, 0, 0.311122969374084, 0.9503696638297399]}}\n");
  struct Case {
    std::string command;
    int least;  // sentences on standard output
    int code = 0;
  };
  const std::vector<Case> cases = {{"check scene --samples 2000", 2},
                                   {"info scene", 3},
                                   {"info " + data + "/station-1.ply", 4},
                                   {"export scene --to relief.stl", 5},
                                   {"export scene --to relief.ply", 1},
                                   {"simulate stone.yaml --out stone", 1},
                                   {"register two.yaml --out registered.yaml", 0},
                                   {"trace scene --hip path.csv --out trace.csv", 4},
                                   {"sound fit strike.wav", 2},
                                   {"device list", 3},
                                   {"device check --duration 0.1", 1, 4}};
  for (const Case& spoken : cases) {
    SCOPED_TRACE(spoken.command);
    const Outcome outcome = run("--plain " + spoken.command);
    EXPECT_EQ(outcome.code, spoken.code) << outcome.err;
    expect_sentences(outcome.out, spoken.least);
    std::istringstream messages(outcome.err);
    for (std::string line; std::getline(messages, line);)
      if (line.rfind("warning: ", 0) != 0) expect_sentences(line, 1);
  }
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

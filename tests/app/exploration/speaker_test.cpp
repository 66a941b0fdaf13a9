// What visitors can do to speech, judged by what a stand-in for espeak-ng was given.
#include "app/exploration/speaker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "tests/support/test_folder.h"

namespace sparsha::app {
namespace {

using haptics::Announcement;
using Control = Announcement::Control;

class SpeakerTest : public ::testing::Test {
 protected:
  SpeakerTest() : old_path_(std::getenv("PATH")) {
    const std::filesystem::path program = folder_ / "espeak-ng";
    std::ofstream(program) << "#!/bin/sh\nwords=$(cat)\necho \"$* : $words\" >> '" << (folder_ / "log").string()
                           << "'\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    setenv("PATH", (program.parent_path().string() + ":/usr/bin:/bin").c_str(), 1);
  }
  ~SpeakerTest() override { setenv("PATH", old_path_.c_str(), 1); }
  [[nodiscard]] std::string log() const {
    std::ifstream in(folder_ / "log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// What the program was called with for these words; waits for them.
  [[nodiscard]] std::string call_of(const std::string& words) const {
    for (int i = 0; i < 1000; ++i) {
      const std::string all = log();
      if (const std::size_t at = all.find(" : " + words + "\n"); at != std::string::npos) {
        const std::size_t line = all.rfind('\n', at);
        const std::size_t begin = line == std::string::npos ? 0 : line + 1;
        return all.substr(begin, at - begin);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }
  static Announcement words(const std::string& text, Control control = Control::none) {
    return {text, Announcement::Priority::information, 1, control};
  }
  sparsha::test::TestFolder folder_;
  std::string old_path_;
};

TEST_F(SpeakerTest, SpeaksInTheVoiceOfItsLanguageSlowerFasterAndInAnotherVoice) {
  scene::SpeechConfig config;
  config.language = "hi";
  config.words_per_minute = 200;
  Speaker speaker(config, true, {});
  speaker.hear(words("one"));
  EXPECT_EQ(call_of("one"), "--stdin -b 1 -s 200 -v hi");
  speaker.hear(words("two", Control::faster));
  EXPECT_EQ(call_of("two"), "--stdin -b 1 -s 240 -v hi");
  speaker.hear(words("three", Control::slower));
  EXPECT_EQ(call_of("three"), "--stdin -b 1 -s 200 -v hi");
  speaker.hear(words("four", Control::next_voice));
  EXPECT_EQ(call_of("four"), "--stdin -b 1 -s 200 -v hi+f3");
  for (int k = 0; k < 50; ++k) speaker.hear(words("", Control::slower));
  EXPECT_EQ(speaker.words_per_minute(), 80);
  for (int k = 0; k < 50; ++k) speaker.hear(words("", Control::faster));
  EXPECT_EQ(speaker.words_per_minute(), 450);
}

TEST_F(SpeakerTest, IsTurnedOnAndOffAndSaysSoBothTimes) {
  Speaker speaker({}, false, {});
  speaker.hear(words("unheard"));
  speaker.hear(words("on now", Control::toggle));
  EXPECT_NE(call_of("on now"), "");
  speaker.hear(words("heard"));
  EXPECT_NE(call_of("heard"), "");
  speaker.hear(words("off now", Control::toggle));
  EXPECT_NE(call_of("off now"), "");
  speaker.hear(words("unheard too"));
  speaker.hear(words("on again", Control::toggle));
  EXPECT_NE(call_of("on again"), "");
  EXPECT_EQ(log().find("unheard"), std::string::npos) << log();
}

TEST_F(SpeakerTest, SpeaksInTheLanguageOfTheSceneThatIsTouchedNow) {
  Speaker speaker({}, true, {});
  speaker.hear(words("one", Control::faster));
  EXPECT_EQ(call_of("one"), "--stdin -b 1 -s 204 -v en");
  speaker.use({}, true);
  speaker.hear(words("two"));
  EXPECT_EQ(call_of("two"), "--stdin -b 1 -s 204 -v en") << "the visitor's rate stays where nothing else is asked for";
  scene::SpeechConfig hindi;
  hindi.language = "hi";
  hindi.words_per_minute = 150;
  speaker.use(hindi, true);
  speaker.hear(words("three"));
  EXPECT_EQ(call_of("three"), "--stdin -b 1 -s 150 -v hi");
  speaker.hear(words("four", Control::next_voice));
  EXPECT_EQ(call_of("four"), "--stdin -b 1 -s 150 -v hi+f3");
  speaker.use(hindi, false);
  speaker.hear(words("unheard"));
  speaker.use(hindi, true);
  speaker.hear(words("five"));
  EXPECT_NE(call_of("five"), "");
  EXPECT_EQ(log().find("unheard"), std::string::npos) << log();
}

TEST_F(SpeakerTest, IsForTheNextVisitorAsItWasForTheFirst) {
  scene::SpeechConfig config;
  config.words_per_minute = 200;
  Speaker speaker(config, false, {});
  const std::string voice = speaker.voice();
  speaker.hear(words("", Control::reset));
  EXPECT_FALSE(speaker.on()) << "before anybody came";
  speaker.hear(words("on now", Control::toggle));
  speaker.hear(words("faster", Control::faster));
  speaker.hear(words("other", Control::next_voice));
  speaker.hear(words("", Control::reset));
  EXPECT_FALSE(speaker.on());
  EXPECT_EQ(speaker.words_per_minute(), 200);
  EXPECT_EQ(speaker.voice(), voice);
  speaker.hear(words("unheard"));
  speaker.hear(words("on again", Control::toggle));
  EXPECT_EQ(call_of("on again"), "--stdin -b 1 -s 200 -v " + voice);
  EXPECT_EQ(log().find("unheard"), std::string::npos) << log();
}

TEST_F(SpeakerTest, StartsNothingWhileItIsOff) {
  setenv("PATH", "/nowhere", 1);
  Speaker speaker({}, false, {});
  speaker.hear(words("unheard"));
  EXPECT_TRUE(speaker.available()) << "nobody has asked for it";
  speaker.hear(words("on now", Control::toggle));
  EXPECT_FALSE(speaker.available());
}

}  // namespace
}  // namespace sparsha::app

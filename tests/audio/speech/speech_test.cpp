// Speech through a program on PATH: a small stand-in that writes down what it hears.
#include "audio/speech/speech.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <numbers>
#include <thread>

#include "audio/live/voice.h"
#include "audio/speech/child_process.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using haptics::Announcement;
using Priority = Announcement::Priority;

/// PATH holds only this folder's `espeak-ng` (and the shell's own tools for the stand-in).
class SpeechProgram {
 public:
  explicit SpeechProgram(const std::string& script) : old_path_(std::getenv("PATH")) {
    const auto program = folder_ / "espeak-ng";
    std::ofstream(program) << "#!/bin/sh\nlog='" << (folder_ / "log").string() << "'\n" << script;
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    setenv("PATH", ((folder_ / "x").parent_path().string() + ":/usr/bin:/bin").c_str(), 1);
  }
  ~SpeechProgram() { setenv("PATH", old_path_.c_str(), 1); }
  SpeechProgram(const SpeechProgram&) = delete;
  SpeechProgram& operator=(const SpeechProgram&) = delete;

  [[nodiscard]] std::string log() const {
    std::ifstream in(folder_ / "log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Waits until the log holds `text`, 10 s at most.
  [[nodiscard]] bool heard(const std::string& text) const {
    for (int i = 0; i < 1000; ++i) {
      if (log().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  audio_scene::Folder folder_;
  std::string old_path_;
};

constexpr const char* kSpeakAtOnce = "cat >> \"$log\"\necho \"end\" >> \"$log\"\n";
/// Writes the text, then "speaks" for a minute.
constexpr const char* kSpeakLong = "cat >> \"$log\"\necho \"pid $$\" >> \"$log\"\nsleep 60\necho \"end\" >> \"$log\"\n";

TEST(Speech, IsNotAvailableWithoutAProgramAndSayingIsHarmless) {
  SpeechOptions options;
  options.programs = {"no-such-speech-program"};
  Speech speech(options);
  EXPECT_FALSE(speech.available());
  speech.say({"Lotus medallion", Priority::information, 1});
}

TEST(Speech, AvailableStartsNothing) {
  const SpeechProgram program(kSpeakAtOnce);
  {
    const Speech speech;
    EXPECT_TRUE(speech.available());
  }
  EXPECT_EQ(program.log(), "");
}

TEST(Speech, PassesWordsOnStandardInputUntouchedByAnyShell) {
  const SpeechProgram program(kSpeakAtOnce);
  Speech speech;
  speech.say({"Lotus; `touch x` $(reboot) \"medallion\" -v --help \xE0\xA4\xAA", Priority::information, 1});
  EXPECT_TRUE(program.heard("Lotus; `touch x` $(reboot) \"medallion\" -v --help \xE0\xA4\xAA\nend"));
}

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))
TEST(Speech, TheProgramGainsNoRightsTracesNothingAndOursIsAsItWas) {
  const SpeechProgram program("grep -E '^(NoNewPrivs|Seccomp):' /proc/self/status >> \"$log\"\necho end >> \"$log\"\n");
  const auto own = [] {
    std::ifstream status("/proc/self/status");
    return std::string{std::istreambuf_iterator<char>(status), {}};
  };
  const bool confined_already = own().find("Seccomp:\t2") != std::string::npos;
  Speech speech;
  speech.say({"Lotus", Priority::information, 1});
  EXPECT_TRUE(program.heard("NoNewPrivs:\t1\nSeccomp:\t2\nend")) << program.log();
  EXPECT_EQ(own().find("Seccomp:\t2") != std::string::npos, confined_already);
}
#endif

TEST(Speech, NewerWordsInterruptOlderOnes) {
  const SpeechProgram program(kSpeakLong);
  Speech speech;
  speech.say({"first", Priority::information, 1});
  ASSERT_TRUE(program.heard("first\npid"));
  speech.say({"second", Priority::information, 2});
  EXPECT_TRUE(program.heard("second\npid"));
  EXPECT_EQ(program.log().find("end"), std::string::npos);
}

TEST(Speech, OfSeveralWaitingOnlyTheNewestIsSpoken) {
  const SpeechProgram program("cat >> \"$log\"\nsleep 0.3\n");
  Speech speech;
  speech.say({"fault", Priority::fault, 1});
  ASSERT_TRUE(program.heard("fault"));
  speech.say({"older", Priority::information, 2});
  speech.say({"newer", Priority::information, 3});
  EXPECT_TRUE(program.heard("newer"));
  EXPECT_EQ(program.log().find("older"), std::string::npos);
}

TEST(Speech, AFaultComesFirstAndIsNotInterrupted) {
  const SpeechProgram program(
      "read -r line\necho \"$line\" >> \"$log\"\ncase $line in chat*) sleep 60;; *) sleep 0.3;; esac\necho \"end "
      "$line\" >> \"$log\"\n");
  Speech speech;
  speech.say({"chatter", Priority::information, 1});
  ASSERT_TRUE(program.heard("chatter"));
  speech.say({"Device unplugged", Priority::fault, 2});
  ASSERT_TRUE(program.heard("Device unplugged"));
  speech.say({"Lotus", Priority::information, 3});
  ASSERT_TRUE(program.heard("end Lotus"));
  const std::string log = program.log();
  EXPECT_EQ(log.find("end chatter"), std::string::npos);
  EXPECT_LT(log.find("end Device unplugged"), log.find("Lotus"));
}

TEST(Speech, KillsItsChildWhenItGoes) {
  const SpeechProgram program(kSpeakLong);
  {
    Speech speech;
    speech.say({"long story", Priority::information, 1});
    ASSERT_TRUE(program.heard("pid "));
  }
  const std::string log = program.log();
  const int process = std::stoi(log.substr(log.find("pid ") + 4));
  EXPECT_EQ(kill(process, 0), -1) << "still there";
}

TEST(Speech, SayingNeverBlocksTheCaller) {
  const SpeechProgram program(kSpeakLong);
  Speech speech;
  const auto began = std::chrono::steady_clock::now();
  for (std::uint64_t i = 1; i <= 1000; ++i) speech.say({"words " + std::to_string(i), Priority::information, i});
  // 1000 starts of a program would take seconds.
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(500));
  EXPECT_TRUE(program.heard("words 1000\n"));
}

TEST(Speech, AProgramThatClosesItsInputDoesNoHarm) {
  const SpeechProgram program("exec 0<&-\necho done >> \"$log\"\n");
  Speech speech;
  speech.say({std::string(1900, 'a'), Priority::information, 1});
  EXPECT_TRUE(program.heard("done"));
}

/// A stand-in that writes a tenth of a second of a square wave as espeak-ng does: a WAV whose header knows no length.
constexpr const char* kWriteWave =
    "cat >> \"$log\"\ncase \"$*\" in *--stdout*)\n"
    "printf 'RIFF\\377\\377\\377\\177WAVEfmt "
    "\\020\\0\\0\\0\\1\\0\\1\\0\\042\\126\\0\\0\\104\\254\\0\\0\\2\\0\\020\\0data\\377\\377\\377\\177'\n"
    "i=0; while [ $i -lt 1102 ]; do printf '\\0\\100\\0\\300'; i=$((i+1)); done;;\n"
    "*) echo aloud >> \"$log\";; esac\n";

TEST(Speech, WordsAreGivenToTheStreamOfTheOtherSounds) {
  const SpeechProgram program(kWriteWave);
  std::mutex mutex;
  std::vector<float> heard;
  double rate = 0.0;
  SpeechOptions options;
  options.play = [&](std::vector<float> words, double rate_hz) {
    const std::lock_guard lock(mutex);
    heard = std::move(words);
    rate = rate_hz;
    return true;
  };
  Speech speech(options);
  speech.say({"Lotus", Priority::information, 1});
  for (int i = 0; i < 1000; ++i) {
    {
      const std::lock_guard lock(mutex);
      if (!heard.empty()) break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::lock_guard lock(mutex);
  EXPECT_EQ(heard.size(), 2204U);
  EXPECT_EQ(rate, 22050.0);
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard[0], 0.5F);
  EXPECT_EQ(heard[1], -0.5F);
  EXPECT_EQ(program.log().find("aloud"), std::string::npos);
}

TEST(Speech, WithoutAStreamTheProgramSpeaksItself) {
  const SpeechProgram program(kWriteWave);
  SpeechOptions options;
  options.play = [](const std::vector<float>&, double) { return false; };
  Speech speech(options);
  speech.say({"Lotus", Priority::information, 1});
  EXPECT_TRUE(program.heard("aloud"));
}

/// The same, of a program that knows no voice "Nobody".
const std::string kRefuseNobody =
    "case \"$*\" in *Nobody*) cat > /dev/null; echo 'no such voice' >&2; exit 1;; esac\necho \"$*\" >> \"$log\"\n";

TEST(Speech, AVoiceThatTheProgramRefusesIsToldOnceAndTheLanguagesOwnSpeaks) {
  for (const bool stream : {true, false}) {
    const SpeechProgram program(kRefuseNobody + kWriteWave);
    std::atomic<int> played{0};
    SpeechOptions options;
    options.voice = "Nobody";
    options.language = "hi";
    if (stream)
      options.play = [&](const std::vector<float>& words, double) {
        if (!words.empty()) ++played;
        return true;
      };
    Speech speech(options);
    speech.say({"Lotus", Priority::information, 1});
    ASSERT_TRUE(program.heard("-v hi")) << stream;
    ASSERT_TRUE(program.heard("Lotus\n"));
    std::string problem;
    for (int i = 0; i < 1000 && problem.empty(); ++i) {
      problem = speech.take_problem();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_NE(problem.find("'Nobody'"), std::string::npos) << problem;
    EXPECT_NE(problem.find("'hi'"), std::string::npos) << problem;
    EXPECT_NE(problem.find("expected"), std::string::npos) << problem;
    if (stream) {
      EXPECT_EQ(played.load(), 1);
    }
    speech.set_voice("Nobody+f3");
    speech.say({"A leaf", Priority::information, 2});
    EXPECT_TRUE(program.heard("-v hi+f3")) << "another voice is another voice still";
    EXPECT_TRUE(program.heard("A leaf\n"));
    EXPECT_EQ(speech.take_problem(), "");
  }
}

TEST(Speech, AProgramThatFailsInEveryVoiceIsToldOnce) {
  const SpeechProgram program("cat > /dev/null\nexit 7\n");
  SpeechOptions options;
  options.voice = "Nobody";
  options.language = "en";
  Speech speech(options);
  std::string problem;
  for (std::uint64_t i = 1; i <= 1000 && problem.empty(); ++i) {
    speech.say({"Lotus " + std::to_string(i), Priority::information, i});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    problem = speech.take_problem();
  }
  EXPECT_NE(problem.find("code 7"), std::string::npos) << problem;
  EXPECT_NE(problem.find("espeak-ng"), std::string::npos) << problem;
}

TEST(Speech, TheRealProgramSpeaksAlsoWhenAVoicesNameIsTakenFromTheWrongColumn) {
  if (!find_program({"espeak-ng"})) GTEST_SKIP() << "espeak-ng is not installed";
  for (const char* voice : {"English_(America)", "en-us", "en+f3"}) {
    std::atomic<std::size_t> samples{0};
    SpeechOptions options;
    options.voice = voice;  // `espeak-ng --voices` lists the first as a VoiceName
    options.language = "en";
    options.play = [&](const std::vector<float>& words, double) {
      samples += words.size();
      return true;
    };
    Speech speech(options);
    speech.say({"Lotus medallion", Priority::information, 1});
    for (int i = 0; i < 1000 && samples == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_GT(samples.load(), 10000U) << voice;
  }
}

TEST(LiveVoice, SpeechIsHeardOverSoundsThatAre12DecibelsSofterMeanwhile) {
  haptics::ContactQueue contacts(16);
  haptics::Seqlock<haptics::State> state;
  std::atomic<std::uint64_t> strikes{0};
  const auto bank = audio_scene::bank({audio_scene::note("sa", {0, 0, 1, 1}, 240.0, 50.0)});
  const auto play = [&](bool speaks) {
    LiveVoice voice(bank, contacts, state, nullptr, strikes);
    contacts.push(audio_scene::touch(0.0, 0.5, 0.5, 0.5));
    auto words = std::make_shared<Clip>();
    for (int i = 0; i < 24000; ++i) {
      const auto sample = static_cast<float>(0.6 * std::sin(2.0 * std::numbers::pi * 2000.0 * i / 48000.0));
      words->samples.insert(words->samples.end(), {sample, sample});
    }
    std::vector<float> sound;
    std::vector<float> block(256);
    for (int k = 0; k < 750; ++k) {  // 2 s
      if (k == 200 && speaks) voice.speak(words);
      voice.render(block);
      sound.insert(sound.end(), block.begin(), block.end());
    }
    return listening::channel(sound, 0);
  };
  const auto alone = play(false), spoken = play(true);
  const auto note = [](const listening::Samples& sound, double from_s) {
    const auto begin = static_cast<std::size_t>(48000.0 * from_s);
    return listening::amplitude_at(sound, 240.0, 48000.0, begin, begin + 9600);
  };
  EXPECT_NEAR(listening::decibel(note(spoken, 0.2) / note(alone, 0.2)), 0.0, 0.01);
  EXPECT_NEAR(listening::decibel(note(spoken, 0.75) / note(alone, 0.75)), -12.0, 0.3);
  EXPECT_NEAR(listening::decibel(note(spoken, 1.6) / note(alone, 1.6)), 0.0, 0.1);
  EXPECT_NEAR(listening::amplitude_at(spoken, 2000.0, 48000.0, 30000, 45000), 0.6, 0.01);
  EXPECT_LT(listening::peak(spoken), 1.0);
}

TEST(Speech, TheRealProgramTakesWordsFromStandardInput) {
  const auto program = find_program({"espeak-ng"});
  if (!program) GTEST_SKIP() << "espeak-ng is not installed";
  const audio_scene::Folder folder;
  const auto file = folder / "speech.wav";
  const auto child =
      ChildProcess::start(*program, {"--stdin", "-b", "1", "-s", "170", "-w", file.string()}, "Lotus medallion\n");
  ASSERT_NE(child, nullptr);
  while (child->running()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(std::filesystem::exists(file));
  EXPECT_GT(std::filesystem::file_size(file), 20000U);  // about a second at 22 kHz
}

}  // namespace

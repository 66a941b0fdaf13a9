// The live stream against a real sound server (JACK's dummy driver), when one is installed.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <sndfile.h>

#include "audio/engine.h"
#include "audio/live/output.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/live/sound_server.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

/// A run that is heard through a server of its own, and its file.
class LiveRun {
 public:
  LiveRun() : server_(std::make_unique<sound_server::SoundServer>()) {}

  /// False when the server does not run.
  [[nodiscard]] bool begin() {
    if (!server_->running()) return false;
    make_engine();
    for (int i = 0; i < 500 && !engine_->playing(); ++i) tick(false);
    return true;
  }
  void make_engine() {
    EngineOptions options;
    options.wav = folder_ / "run.wav";
    engine_ = std::make_unique<Engine>(audio_scene::scene({audio_scene::note("sa", {0, 0, 1, 1}, 240.0, 0.2)}, 0.5),
                                       queue_, state_, options);
    engine_->start();
  }

  /// 10 ms of servo time, so many times; `touch`: in which of them the stone is struck.
  void ticks(int count, const std::vector<int>& touches) {
    for (int i = 0; i < count; ++i) tick(std::find(touches.begin(), touches.end(), i) != touches.end());
  }
  [[nodiscard]] bool file_is_whole() {
    SF_INFO info{};
    SNDFILE* file = sf_open((folder_ / "run.wav").c_str(), SFM_READ, &info);
    if (file != nullptr) sf_close(file);
    return info.frames >= static_cast<sf_count_t>(now_.tick * 48);
  }
  [[nodiscard]] Engine& engine() { return *engine_; }
  void drop_engine() { engine_.reset(); }
  [[nodiscard]] sound_server::SoundServer& server() { return *server_; }

 private:
  void tick(bool touch) {
    for (int i = 0; i < 10; ++i) {
      ++now_.tick;
      now_.time_s = static_cast<double>(now_.tick) * 1e-3;
      if (touch && i == 5) queue_->push(audio_scene::touch(now_.time_s, 0.5, 0.5, 1.0));
      state_.publish(now_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::unique_ptr<sound_server::SoundServer> server_;
  audio_scene::Folder folder_;
  std::shared_ptr<haptics::ContactQueue> queue_ = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state_;
  haptics::State now_;
  std::unique_ptr<Engine> engine_;
};

TEST(LiveEngine, PlaysStrikesAndWritesTheSameRunAsAFile) {
  LiveRun run;
  if (!run.server().installed()) GTEST_SKIP() << sound_server::kMissing;
  ASSERT_TRUE(run.begin()) << sound_server::kSilent;
  ASSERT_TRUE(run.engine().playing()) << run.engine().warning();
  run.ticks(60, {10, 30, 50});
  run.engine().stop();
  EXPECT_EQ(run.engine().strikes(), 3U);
  EXPECT_EQ(run.engine().warning(), "");
  EXPECT_TRUE(run.file_is_whole());
}

#if __has_include(<jack/jack.h>)
TEST(LiveStream, ADeviceOfOneChannelPlaysBoth) {
  sound_server::SoundServer server(1);
  if (!server.installed()) GTEST_SKIP() << sound_server::kMissing;
  ASSERT_TRUE(server.running()) << sound_server::kSilent;
  for (const std::size_t channel : {0U, 1U}) {
    LiveStream stream;
    stream.start([channel, on = 0](std::span<float> frames) mutable {
      for (std::size_t i = 0; i < frames.size(); ++i)
        frames[i] = i % 2 == channel ? ((on++ / 24) % 2 == 0 ? 0.5F : -0.5F) : 0.0F;
    });
    const sound_server::Listener listener;
    ASSERT_TRUE(listener.connected());
    for (int i = 0; i < 500 && listener.onsets().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_FALSE(listener.onsets().empty()) << "channel " << channel;
    stream.stop();
  }
}
#endif

/// Patience with a server that hangs, and as much again for a machine that is busy.
constexpr double kSoon_s = 2.0 * LiveOutput::kPatience_s;
constexpr int kNoServer = 77;  // installed, but it does not start

/// The checks of a program of its own, since a sound library never forgets a server that it has lost.
class Checks {
 public:
  void expect(bool holds, const std::string& what) {
    if (holds) return;
    std::fprintf(stderr, "not so: %s\n", what.c_str());
    ++failed_;
  }
  template <class Call>
  void expect_soon(const Call& call, const std::string& what) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    expect(took_s < kSoon_s, what + " within " + std::to_string(kSoon_s) + " s, took " + std::to_string(took_s));
  }
  [[nodiscard]] int code() const { return failed_ > 0 ? 1 : 0; }

 private:
  int failed_ = 0;
};

/// Ends as programs do, beside a server in whatever state it is then; that is tidied up as the very last thing.
[[noreturn]] void run_and_exit(int (*body)(LiveRun&)) {
  alarm(60);  // a program that hangs is a failure
  static LiveRun* run = nullptr;
  static_cast<void>(std::atexit([] {
    run->server().freeze(false);
    run->server().end();
  }));
  run = new LiveRun;  // never freed: the server outlives all
  std::exit(run->begin() ? body(*run) : kNoServer);
}

bool ended_well(int status) { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

int loses_its_server(LiveRun& run) {
  Checks checks;
  run.ticks(20, {10});
  run.server().end();
  run.ticks(100, {90});
  checks.expect(!run.engine().playing(), "it no longer plays");
  checks.expect(run.engine().warning().find("went away") != std::string::npos, "it says so: " + run.engine().warning());
  run.engine().stop();
  checks.expect(run.engine().strikes() == 2, "both strikes count");
  checks.expect(run.file_is_whole(), "the file is whole");
  return checks.code();
}

int hangs_in_the_middle(LiveRun& run) {
  Checks checks;
  run.ticks(20, {10});
  run.server().freeze(true);
  run.ticks(100, {90});  // the run goes on, and what is struck is counted
  checks.expect_soon([&] { run.engine().stop(); }, "the end");
  checks.expect(run.engine().strikes() == 2, "both strikes count");
  checks.expect(run.file_is_whole(), "the file is whole");
  checks.expect_soon([&] { run.drop_engine(); }, "the engine's end");
  return checks.code();
}

int hangs_at_the_end(LiveRun& run) {
  Checks checks;
  run.ticks(20, {10});
  run.server().freeze(true);
  checks.expect_soon([&] { run.engine().stop(); }, "the end");
  checks.expect(run.engine().strikes() == 1, "the strike counts");
  checks.expect_soon([&] { run.drop_engine(); }, "the engine's end");
  return checks.code();
}

int hangs_from_the_beginning(LiveRun& run) {
  Checks checks;
  run.engine().stop();
  run.server().freeze(true);
  checks.expect_soon([&] { run.make_engine(); }, "the beginning");
  run.ticks(60, {30});
  checks.expect(!run.engine().playing(), "it does not play");
  checks.expect_soon([&] { run.engine().stop(); }, "the end");
  checks.expect(run.engine().strikes() == 1, "the strike counts all the same");
  checks.expect_soon([&] { run.drop_engine(); }, "the engine's end");
  return checks.code();
}

class LiveEnds : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_program({"jackd"})) GTEST_SKIP() << sound_server::kMissing;
    GTEST_FLAG_SET(death_test_style, "threadsafe");
  }
};

TEST_F(LiveEnds, TheRunGoesOnWhenTheSoundServerEnds) { EXPECT_EXIT(run_and_exit(&loses_its_server), ended_well, ""); }
TEST_F(LiveEnds, AProgramEndsInTimeWithItsFileWhenTheSoundServerHangs) {
  EXPECT_EXIT(run_and_exit(&hangs_in_the_middle), ended_well, "");
}
TEST_F(LiveEnds, AProgramEndsInTimeWhenTheSoundServerHangsAtTheVeryEnd) {
  EXPECT_EXIT(run_and_exit(&hangs_at_the_end), ended_well, "");
}
TEST_F(LiveEnds, AProgramBeginsAndEndsInTimeBesideASoundServerThatHangs) {
  EXPECT_EXIT(run_and_exit(&hangs_from_the_beginning), ended_well, "");
}

}  // namespace

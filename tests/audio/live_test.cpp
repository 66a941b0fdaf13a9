// The live stream against a real sound server (JACK's dummy driver), when one is installed.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include <sndfile.h>

#include "audio/engine.h"
#include "audio/live_stream.h"
#include "audio/speech/child_process.h"
#include "audio_scene.h"
#include "base/error.h"
#include "base/system.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

/// A JACK server of our own, under a name of its own.
class SoundServer {
 public:
  SoundServer() {
    const auto program = find_program({"jackd"});
    if (!program) return;
    const std::string name = "sparsha-test-" + std::to_string(system::process_id());
    setenv("JACK_DEFAULT_SERVER", name.c_str(), 1);
    setenv("JACK_NO_AUDIO_RESERVATION", "1", 1);
    process_ =
        ChildProcess::start(*program, {"--no-realtime", "--name", name, "-d", "dummy", "-r", "48000", "-p", "128"}, "");
    for (int i = 0; i < 40 && !ready_; ++i) {  // a busy machine takes its time to start it
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
      try {
        const LiveStream stream;
        ready_ = true;
      } catch (const Error&) {
      }
    }
  }
  ~SoundServer() {
    end();
    unsetenv("JACK_DEFAULT_SERVER");
  }
  SoundServer(const SoundServer&) = delete;
  SoundServer& operator=(const SoundServer&) = delete;
  [[nodiscard]] bool running() { return ready_ && process_->running(); }
  /// Lets it tidy up its shared memory.
  void end() {
    if (process_) process_->end(3000);
  }

 private:
  std::unique_ptr<ChildProcess> process_;
  bool ready_ = false;
};

class LiveEngine : public testing::Test {
 protected:
  void SetUp() override {
    if (!server_.running()) GTEST_SKIP() << "no sound server: jackd is not installed or does not start";
    EngineOptions options;
    options.wav = folder_ / "run.wav";
    engine_ = std::make_unique<Engine>(audio_scene::scene({audio_scene::note("sa", {0, 0, 1, 1}, 240.0, 0.2)}, 0.5),
                                       queue_, state_, options);
    engine_->start();
    for (int i = 0; i < 500 && !engine_->playing(); ++i) tick(false);
    ASSERT_TRUE(engine_->playing()) << engine_->warning();
  }

  /// 10 ms of servo time.
  void tick(bool touch) {
    for (int i = 0; i < 10; ++i) {
      ++now_.tick;
      now_.time_s = static_cast<double>(now_.tick) * 1e-3;
      if (touch && i == 5) queue_->push(audio_scene::touch(now_.time_s, 0.5, 0.5, 1.0));
      state_.publish(now_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  [[nodiscard]] sf_count_t frames() {
    SF_INFO info{};
    SNDFILE* file = sf_open((folder_ / "run.wav").c_str(), SFM_READ, &info);
    if (file != nullptr) sf_close(file);
    return info.frames;
  }

  SoundServer server_;
  audio_scene::Folder folder_;
  std::shared_ptr<haptics::ContactQueue> queue_ = std::make_shared<haptics::ContactQueue>(256);
  haptics::Seqlock<haptics::State> state_;
  haptics::State now_;
  std::unique_ptr<Engine> engine_;
};

TEST_F(LiveEngine, PlaysStrikesAndWritesTheSameRunAsAFile) {
  for (int i = 0; i < 60; ++i) tick(i == 10 || i == 30 || i == 50);
  engine_->stop();
  EXPECT_EQ(engine_->strikes(), 3U);
  EXPECT_EQ(engine_->warning(), "");
  EXPECT_GE(frames(), static_cast<sf_count_t>(now_.tick * 48));
}

TEST_F(LiveEngine, RunsOnWhenTheSoundServerEnds) {
  for (int i = 0; i < 20; ++i) tick(i == 10);
  server_.end();
  for (int i = 0; i < 100; ++i) tick(i == 90);
  EXPECT_FALSE(engine_->playing());
  EXPECT_NE(engine_->warning().find("went away"), std::string::npos) << engine_->warning();
  engine_->stop();
  EXPECT_EQ(engine_->strikes(), 2U);
  EXPECT_GE(frames(), static_cast<sf_count_t>(now_.tick * 48));
}

}  // namespace

// Contact events have one consumer. Whoever calls tend() hands them to the sound card's thread when a stream is ready,
// and takes them back after that thread is shut out.
#include "audio/live/output.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

#include "audio/clip/clip.h"
#include "audio/live/stream.h"
#include "base/error.h"

namespace sparsha::audio {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kRetryInterval = std::chrono::seconds(3);
/// A sound system that takes longer to start a stream is taken for one that hangs.
constexpr auto kLongestStart = std::chrono::seconds(2);
constexpr std::size_t kKeptWords = 16;
constexpr float kSpoken = 0.6F;  // the loudest sample of spoken words

std::string reason(const std::exception& error) {
  const auto* known = dynamic_cast<const Error*>(&error);
  return known != nullptr ? known->wrong() : error.what();
}

/// Of one channel, at the stream's rate, as loud as words are.
std::shared_ptr<const Clip> spoken_clip(const std::vector<float>& words, double rate_hz, int stream_rate_hz) {
  auto clip = std::make_shared<Clip>();
  float loudest = 0.0F;
  for (const float value : words) loudest = std::max(loudest, std::abs(value));
  if (!(loudest > 0.0F)) return clip;
  for (const float value : resample(words, 1, rate_hz, stream_rate_hz)) {
    const float sample = std::clamp(kSpoken / loudest * value, -kSpoken, kSpoken);
    clip->samples.insert(clip->samples.end(), {sample, sample});
  }
  return clip;
}

}  // namespace

struct LiveOutput::Shared {
  std::string device;
  MakeVoice make_voice;

  enum class Phase { closed, opened, playing };  ///< playing: the events are the sound card's
  std::atomic<Phase> phase{Phase::closed};
  std::atomic<bool> started{false};  ///< the sound system has begun to ask for sound
  std::atomic<bool> failed{false};   ///< it could not
  Clock::time_point begun_at;        ///< of whoever calls tend()

  mutable std::mutex mutex;
  std::condition_variable wake;
  bool begin = false;  ///< the stream may begin
  bool lost = false;   ///< the stream is to be given up
  bool stopping = false;
  bool ended = false;  ///< the thread is done
  std::string warning;
  std::unique_ptr<LiveStream> stream;
  std::unique_ptr<LiveVoice> voice;
  /// A sound card's thread must not be the one that frees them.
  std::deque<std::shared_ptr<const Clip>> spoken;

  Shared(std::string the_device, MakeVoice make) : device(std::move(the_device)), make_voice(std::move(make)) {}

  void warn(const std::string& text) {
    const std::lock_guard lock(mutex);
    if (warning.empty()) warning = text;
  }
  [[nodiscard]] bool ends() {
    const std::lock_guard lock(mutex);
    return stopping;
  }
  void pause() {
    std::unique_lock lock(mutex);
    wake.wait_for(lock, kRetryInterval, [this] { return stopping; });
  }
  bool open();
  void play();
  void give_up();
  void lose(const std::string& why);
};

/// Tries until a stream is there; false when the end is asked for before.
bool LiveOutput::Shared::open() {
  while (!ends()) {
    try {
      auto new_stream = std::make_unique<LiveStream>(device);
      if (ends()) return false;
      auto new_voice = make_voice(new_stream->sample_rate_hz());
      const std::lock_guard lock(mutex);
      if (stopping) return false;
      stream = std::move(new_stream);
      voice = std::move(new_voice);
      phase.store(Phase::opened, std::memory_order_release);
      return true;
    } catch (const std::exception& error) {
      warn(reason(error));
    }
    pause();
  }
  return false;
}

/// Plays until the stream is lost or the end is asked for.
void LiveOutput::Shared::play() {
  std::unique_lock lock(mutex);
  wake.wait(lock, [this] { return begin || stopping; });
  if (!std::exchange(begin, false) || stopping) return;
  lock.unlock();
  try {
    stream->start([voice = voice.get()](std::span<float> out) { voice->render(out); });
    lock.lock();
    if (!lost && !stopping) {  // it may have come too late
      started.store(true, std::memory_order_release);
      warning.clear();
    }
  } catch (const std::exception& error) {
    warn(reason(error));
    failed.store(true, std::memory_order_release);
    lock.lock();
  }
  wake.wait(lock, [this] { return lost || stopping; });
}

/// After the stream was lost.
void LiveOutput::Shared::give_up() {
  std::unique_ptr<LiveStream> old;
  {
    const std::lock_guard lock(mutex);
    lost = false;
    old = std::move(stream);
  }
  old->give_up();
  old.reset();
  if (failed.exchange(false)) pause();
}

/// The events go back to whoever calls tend().
void LiveOutput::Shared::lose(const std::string& why) {
  stream->shut_out();
  phase.store(Phase::closed, std::memory_order_release);
  if (!why.empty()) warn(why);
  {
    const std::lock_guard lock(mutex);
    started.store(false, std::memory_order_release);
    lost = true;
  }
  wake.notify_all();
}

void LiveOutput::run(Shared& shared) {
  while (shared.open()) {
    shared.play();
    if (shared.ends()) {
      shared.stream->stop();
      break;
    }
    shared.give_up();
  }
  std::unique_ptr<LiveStream> old;
  {
    const std::lock_guard lock(shared.mutex);
    old = std::move(shared.stream);
  }
  old.reset();  // which gives the device back, and may take its time
  {
    const std::lock_guard lock(shared.mutex);
    shared.ended = true;
  }
  shared.wake.notify_all();
}

LiveOutput::LiveOutput(std::string device, MakeVoice make_voice)
    : shared_(std::make_shared<Shared>(std::move(device), std::move(make_voice))) {}

LiveOutput::~LiveOutput() { stop(); }

void LiveOutput::start() {
  if (!thread_.joinable()) thread_ = std::thread([shared = shared_] { run(*shared); });
}

bool LiveOutput::tend(const std::shared_ptr<const Profile>& newest) {
  Shared& self = *shared_;
  using Phase = Shared::Phase;
  switch (self.phase.load(std::memory_order_acquire)) {
    case Phase::closed:
      return false;
    case Phase::opened:
      if (newest) self.voice->profile(newest);
      self.begun_at = Clock::now();
      self.phase.store(Phase::playing, std::memory_order_release);
      {
        const std::lock_guard lock(self.mutex);
        self.begin = true;
      }
      self.wake.notify_all();
      return true;
    case Phase::playing:
      break;
  }
  if (self.failed.load(std::memory_order_acquire)) {
    self.lose("");
  } else if (self.started.load(std::memory_order_acquire)) {
    if (!self.stream->playing())
      self.lose("the sound device '" + self.stream->name() + "' went away; the run goes on without live sound");
  } else if (Clock::now() - self.begun_at > kLongestStart) {
    self.lose("the sound device '" + self.stream->name() + "' does not answer; the run goes on without live sound");
  }
  return self.phase.load(std::memory_order_relaxed) == Phase::playing;
}

void LiveOutput::profile(const std::shared_ptr<const Profile>& profile) {
  if (shared_->phase.load(std::memory_order_relaxed) == Shared::Phase::playing) shared_->voice->profile(profile);
}

void LiveOutput::stop() {
  if (!thread_.joinable()) return;
  Shared& self = *shared_;
  if (playing()) self.voice->fade_out();
  std::unique_lock lock(self.mutex);
  self.stopping = true;
  self.wake.notify_all();
  const bool ended = self.wake.wait_for(lock, std::chrono::duration<double>(kPatience_s), [&] { return self.ended; });
  if (!ended && self.stream) self.stream->shut_out();
  self.phase.store(Shared::Phase::closed, std::memory_order_release);
  self.started.store(false, std::memory_order_release);
  lock.unlock();
  if (ended) {
    thread_.join();
    return;
  }
  // What it holds stays with it, should the sound system ever answer.
  thread_.detach();
}

bool LiveOutput::speak(const std::vector<float>& words, double rate_hz) {
  Shared& self = *shared_;
  const auto stream_rate_hz = [&self, this] {  // under the mutex
    return playing() && !self.stopping && self.stream ? self.stream->sample_rate_hz() : 0;
  };
  std::unique_lock lock(self.mutex);
  const int wanted_hz = stream_rate_hz();
  lock.unlock();
  if (wanted_hz == 0) return false;
  const std::shared_ptr<const Clip> clip = spoken_clip(words, rate_hz, wanted_hz);
  lock.lock();
  if (stream_rate_hz() != wanted_hz) return false;  // another device plays now, or none
  self.spoken.push_back(clip);
  if (self.spoken.size() > kKeptWords) self.spoken.pop_front();
  return self.voice->speak(clip);
}

std::string LiveOutput::warning() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->warning;
}

bool LiveOutput::playing() const { return shared_->started.load(std::memory_order_acquire); }

}  // namespace sparsha::audio

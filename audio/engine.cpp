// Who consumes what: contact events go to the sound card's callback while a stream plays (lowest latency) and on from
// there to the WAV worker; without a stream the worker takes them itself. Ownership of the queue changes hands only
// while the stream is stopped.
#include "audio/engine.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "audio/live_stream.h"
#include "audio/live_voice.h"
#include "audio/wav_sink.h"
#include "base/error.h"

namespace sparsha::audio {
namespace {

constexpr int kWavRate_hz = 48000;
constexpr auto kPoll = std::chrono::milliseconds(2);
constexpr auto kRetryInterval = std::chrono::seconds(3);
constexpr std::size_t kForwarded = 4096;
constexpr std::size_t kKeptProfiles = 64;
constexpr std::size_t kKeptWords = 16;
constexpr float kSpoken = 0.6F;  // the loudest sample of spoken words

}  // namespace

struct Engine::Implementation {
  pipeline::ScenePointer scene;
  std::shared_ptr<haptics::ContactQueue> contacts;
  const haptics::Seqlock<haptics::State>& state;
  std::shared_ptr<const SoundBank> bank;
  bool live_wanted = false;
  std::string device;

  std::optional<WavSink> wav;
  std::optional<ProfileReader> profiles;
  pipeline::ScenePointer new_scene;  ///< guarded by the mutex
  /// Those that voices may still use: a sound card's thread must not be the one that frees them.
  std::deque<std::shared_ptr<const Profile>> kept;
  std::deque<std::shared_ptr<const Clip>> spoken;
  haptics::ContactQueue forwarded{kForwarded};  ///< callback to worker
  StrikeGate gate;                              ///< counts when nothing sounds
  std::atomic<std::uint64_t> strikes{0};

  std::unique_ptr<LiveStream> stream;
  std::unique_ptr<LiveVoice> voice;
  std::atomic<bool> opened{false};  ///< stream and voice are ready for the worker to start
  std::atomic<bool> playing{false};
  std::thread opener;

  mutable std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  std::string warning;       ///< what stays true
  std::string live_warning;  ///< why there is no live sound; empty once it plays
  std::exception_ptr failure;
  std::thread worker;

  Implementation(pipeline::ScenePointer the_scene, std::shared_ptr<haptics::ContactQueue> queue,
                 const haptics::Seqlock<haptics::State>& the_state)
      : scene(std::move(the_scene)), contacts(std::move(queue)), state(the_state) {}

  void warn(const std::string& text) {
    const std::lock_guard lock(mutex);
    warning += (warning.empty() ? "" : "; ") + text;
  }

  void warn_live(const std::string& text) {
    const std::lock_guard lock(mutex);
    if (live_warning.empty()) live_warning = text;
  }

  /// Until a device is there: one that is plugged in later is found, as it is tried again every 3 s.
  void open_live() {
    std::unique_lock lock(mutex);
    while (!stopping) {
      lock.unlock();
      try {
        auto new_stream = std::make_unique<LiveStream>(device);
        const int rate = new_stream->sample_rate_hz();
        const auto live_bank = rate == bank->sample_rate_hz ? bank : make_sound_bank(*scene, rate);
        auto new_voice = std::make_unique<LiveVoice>(live_bank, *contacts, state, wav ? &forwarded : nullptr, strikes);
        lock.lock();  // speech may ask for them
        voice = std::move(new_voice);
        stream = std::move(new_stream);
        lock.unlock();
        opened.store(true, std::memory_order_release);
        return;
      } catch (const Error& error) {
        warn_live(error.wrong());
      } catch (const std::exception& error) {
        warn_live(error.what());
      }
      lock.lock();
      wake.wait_for(lock, kRetryInterval, [this] { return stopping; });
    }
  }

  /// After a device went away: gives it back, and waits for it or another one. Worker only.
  void open_again(std::chrono::seconds pause) {
    std::unique_ptr<LiveStream> lost;
    {
      const std::lock_guard lock(mutex);  // speech may be about to use the stream
      playing.store(false, std::memory_order_release);
      lost = std::move(stream);
    }
    if (opener.joinable()) opener.join();
    opener = std::thread([this, pause, given_up = std::move(lost)]() mutable {
      if (!given_up->give_up()) return;
      given_up.reset();
      {
        std::unique_lock lock(mutex);
        wake.wait_for(lock, pause, [this] { return stopping; });
      }
      open_live();
    });
  }

  void start_live() {
    if (!kept.empty()) voice->profile(kept.back());
    playing.store(true, std::memory_order_release);
    try {
      stream->start([this](std::span<float> out) { voice->render(out); });
      const std::lock_guard lock(mutex);
      live_warning.clear();
    } catch (const std::exception& error) {
      const auto* known = dynamic_cast<const Error*>(&error);
      warn_live(known != nullptr ? known->wrong() : error.what());
      open_again(kRetryInterval);
    }
  }

  /// The heights under the hand, when the window has changed.
  void read_profile(const haptics::State& now) {
    if (!profiles || now.tick == 0) return;
    {
      const std::lock_guard lock(mutex);
      if (new_scene) profiles->set_scene(std::exchange(new_scene, nullptr));
    }
    std::shared_ptr<const Profile> profile;
    try {
      profile = profiles->update(now);
    } catch (const Error& error) {
      warn("the friction sound ends: " + error.wrong());
      profiles.reset();
    }
    if (!profile) return;
    kept.push_back(profile);
    // No voice holds a profile of use count 1, and only the newest is given away.
    while (kept.size() > 1 && kept.front().use_count() == 1) kept.pop_front();
    if (kept.size() > kKeptProfiles) kept.pop_front();
    if (wav) wav->profile(profile, now.time_s);
    if (playing.load(std::memory_order_relaxed)) voice->profile(profile);
  }

  /// What has happened since the last call.
  void consume() {
    const haptics::State now = state.read();
    read_profile(now);
    haptics::ContactEvent event;
    const bool owner = !playing.load(std::memory_order_acquire);
    while (forwarded.pop(event))
      if (wav) wav->contact(event);  // counted by the callback
    while (owner && contacts->pop(event)) {
      const bool strikes_now = gate.strike(*bank, event).has_value();
      if (wav) wav->contact(event);
      if (strikes_now) strikes.fetch_add(1, std::memory_order_relaxed);
    }
    const bool slides = wav ? wav->state(now) : gate.slide(*bank, now).has_value();
    if (owner && slides) strikes.fetch_add(1, std::memory_order_relaxed);
  }

  void work() {
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, kPoll, [this] { return stopping; })) {
      lock.unlock();
      if (opened.exchange(false, std::memory_order_acquire)) start_live();
      if (playing.load(std::memory_order_relaxed) && !stream->playing()) {
        const std::string name = stream->name();
        stream->shut_out();
        warn_live("the sound device '" + name + "' went away; the run goes on without live sound");
        open_again(std::chrono::seconds(0));
      }
      try {
        consume();
      } catch (...) {
        const std::lock_guard again(mutex);
        if (!failure) failure = std::current_exception();
        wav.reset();
      }
      lock.lock();
    }
  }

  void join() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    if (worker.joinable()) worker.join();
    if (opener.joinable()) opener.join();
    if (playing.load(std::memory_order_acquire)) {
      voice->fade_out();
      stream->stop();
      playing.store(false, std::memory_order_release);
    }
    stream.reset();
  }
};

Engine::Engine(pipeline::ScenePointer scene, std::shared_ptr<haptics::ContactQueue> contacts,
               const haptics::Seqlock<haptics::State>& state, const EngineOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(scene), std::move(contacts), state)) {
  Implementation& self = *implementation_;
  self.bank = make_sound_bank(*self.scene, kWavRate_hz);
  for (const std::string& text : self.bank->warnings) self.warn(text);
  self.device = options.device;
  self.live_wanted = options.live && self.bank->sounds();
  if (self.bank->scrape_gain > 0.0) self.profiles.emplace(self.scene, self.bank->scrape_grain);
  if (!options.wav.empty()) self.wav.emplace(self.bank, options.wav, options.wav_bits);
}

Engine::~Engine() { implementation_->join(); }

void Engine::start() {
  Implementation& self = *implementation_;
  if (self.worker.joinable()) return;
  self.worker = std::thread([&self] { self.work(); });
  if (self.live_wanted) self.opener = std::thread([&self] { self.open_live(); });
}

void Engine::stop() {
  Implementation& self = *implementation_;
  self.join();
  if (!self.wav && !self.failure) return;
  if (!self.failure) {
    self.consume();
    // One tick more than the last sample, so that the file is never shorter than the run.
    self.wav->finish(self.state.read().time_s + 0.001);
    self.wav.reset();
  }
  if (self.failure) std::rethrow_exception(std::exchange(self.failure, nullptr));
}

bool Engine::speak(const std::vector<float>& words, double rate_hz) {
  Implementation& self = *implementation_;
  const auto stream_rate_hz = [&self] {  // under the mutex
    return self.playing.load(std::memory_order_acquire) && !self.stopping ? self.stream->sample_rate_hz() : 0;
  };
  std::unique_lock lock(self.mutex);
  const int wanted_hz = stream_rate_hz();
  lock.unlock();
  if (wanted_hz == 0) return false;
  auto clip = std::make_shared<Clip>();
  float loudest = 0.0F;
  for (const float value : words) loudest = std::max(loudest, std::abs(value));
  if (loudest > 0.0F) {
    for (const float value : resample(words, 1, rate_hz, wanted_hz)) {
      const float sample = std::clamp(kSpoken / loudest * value, -kSpoken, kSpoken);
      clip->samples.insert(clip->samples.end(), {sample, sample});
    }
  }
  lock.lock();
  if (stream_rate_hz() != wanted_hz) return false;  // another device plays now, or none
  self.spoken.push_back(clip);
  if (self.spoken.size() > kKeptWords) self.spoken.pop_front();
  return self.voice->speak(clip);
}

void Engine::set_scene(pipeline::ScenePointer scene) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->new_scene = std::move(scene);
}

std::string Engine::warning() const {
  const std::lock_guard lock(implementation_->mutex);
  const std::string& lasting = implementation_->warning;
  const std::string& live = implementation_->live_warning;
  return lasting + (lasting.empty() || live.empty() ? "" : "; ") + live;
}

std::uint64_t Engine::strikes() const { return implementation_->strikes.load(std::memory_order_relaxed); }

bool Engine::playing() const { return implementation_->playing.load(std::memory_order_acquire); }

}  // namespace sparsha::audio

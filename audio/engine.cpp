// Who consumes what: contact events go to the sound card's callback while a stream plays (lowest latency) and on from
// there to the WAV worker; without a stream the worker takes them itself.
#include "audio/engine.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "audio/live/output.h"
#include "audio/live/voice.h"
#include "audio/scrape/profile_loader.h"
#include "audio/wav/sink.h"
#include "base/error.h"
#include "scene/scene.h"

namespace sparsha::audio {
namespace {

constexpr int kWavRate_hz = 48000;
constexpr auto kPoll = std::chrono::milliseconds(2);
constexpr std::size_t kForwarded = 4096;
constexpr std::size_t kKeptProfiles = 64;

}  // namespace

struct Engine::Implementation {
  scene::ScenePointer scene;
  std::shared_ptr<haptics::ContactQueue> contacts;
  const haptics::Seqlock<haptics::State>& state;
  std::shared_ptr<const SoundBank> bank;

  std::optional<WavSink> wav;
  std::optional<ProfileLoader> profiles;
  /// Those that voices may still use: a sound card's thread must not be the one that frees them.
  std::deque<std::shared_ptr<const Profile>> kept;
  haptics::ContactQueue forwarded{kForwarded};  ///< callback to worker
  StrikeGate gate;                              ///< counts when nothing sounds
  std::atomic<std::uint64_t> strikes{0};
  std::optional<LiveOutput> live;

  mutable std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  std::string warning;  ///< what stays true
  std::exception_ptr failure;
  std::thread worker;

  Implementation(scene::ScenePointer the_scene, std::shared_ptr<haptics::ContactQueue> queue,
                 const haptics::Seqlock<haptics::State>& the_state)
      : scene(std::move(the_scene)), contacts(std::move(queue)), state(the_state) {}

  void warn(const std::string& text) {
    const std::lock_guard lock(mutex);
    warning += (warning.empty() ? "" : "; ") + text;
  }

  /// What it reads it holds itself: a sound system may answer after this engine's end. The voice only keeps references.
  [[nodiscard]] LiveOutput::MakeVoice make_voice() {
    haptics::ContactQueue* const forward = wav ? &forwarded : nullptr;
    return [scene = scene, bank = bank, contacts = contacts, &state = state, forward, &strikes = strikes](int rate_hz) {
      const auto live_bank = rate_hz == bank->sample_rate_hz ? bank : make_sound_bank(*scene, rate_hz);
      return std::make_unique<LiveVoice>(live_bank, *contacts, state, forward, strikes);
    };
  }

  /// The heights under the hand, when the window has changed.
  void take_profile(const haptics::State& now) {
    if (!profiles || now.tick == 0) return;
    profiles->wish(now);
    ProfileLoader::Loaded loaded;
    try {
      loaded = profiles->take();
    } catch (const Error& error) {
      warn("the friction sound ends: " + error.wrong());
      const std::lock_guard lock(mutex);  // set_scene() may be about to use it
      profiles.reset();
    }
    if (!loaded.profile) return;
    kept.push_back(loaded.profile);
    // No voice holds a profile of use count 1, and only the newest is given away.
    while (kept.size() > 1 && kept.front().use_count() == 1) kept.pop_front();
    if (kept.size() > kKeptProfiles) kept.pop_front();
    if (wav) wav->profile(loaded.profile, loaded.since_s);
    if (live) live->profile(loaded.profile);
  }

  /// What has happened since the last call. `owner`: no sound card takes the events.
  void consume(bool owner) {
    const haptics::State now = state.read();
    take_profile(now);
    haptics::ContactEvent event;
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
      const bool owner = !live || !live->tend(kept.empty() ? nullptr : kept.back());
      try {
        consume(owner);
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
    if (live) live->stop();
  }
};

Engine::Engine(scene::ScenePointer scene, std::shared_ptr<haptics::ContactQueue> contacts,
               const haptics::Seqlock<haptics::State>& state, const EngineOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(scene), std::move(contacts), state)) {
  Implementation& self = *implementation_;
  self.bank = make_sound_bank(*self.scene, kWavRate_hz);
  for (const std::string& text : self.bank->warnings) self.warn(text);
  if (self.bank->scrape_gain > 0.0) self.profiles.emplace(self.scene, self.bank->scrape_grain);
  if (!options.wav.empty()) self.wav.emplace(self.bank, options.wav, options.wav_bits);
  if (options.live && self.bank->sounds()) self.live.emplace(options.device, self.make_voice());
}

Engine::~Engine() { implementation_->join(); }

void Engine::start() {
  Implementation& self = *implementation_;
  if (self.worker.joinable()) return;
  self.worker = std::thread([&self] { self.work(); });
  if (self.live) self.live->start();
}

void Engine::stop() {
  Implementation& self = *implementation_;
  self.join();
  if (!self.wav && !self.failure) return;
  if (!self.failure) {
    self.consume(true);
    // One tick more than the last sample, so that the file is never shorter than the run.
    self.wav->finish(self.state.read().time_s + 0.001);
    self.wav.reset();
  }
  if (self.failure) std::rethrow_exception(std::exchange(self.failure, nullptr));
}

bool Engine::speak(const std::vector<float>& words, double rate_hz) {
  return implementation_->live && implementation_->live->speak(words, rate_hz);
}

void Engine::set_scene(scene::ScenePointer scene) {
  const std::lock_guard lock(implementation_->mutex);
  if (implementation_->profiles) implementation_->profiles->set_scene(std::move(scene));
}

std::string Engine::warning() const {
  const std::string live = implementation_->live ? implementation_->live->warning() : std::string();
  const std::lock_guard lock(implementation_->mutex);
  const std::string& lasting = implementation_->warning;
  return lasting + (lasting.empty() || live.empty() ? "" : "; ") + live;
}

std::uint64_t Engine::strikes() const { return implementation_->strikes.load(std::memory_order_relaxed); }

bool Engine::playing() const { return implementation_->live && implementation_->live->playing(); }

}  // namespace sparsha::audio

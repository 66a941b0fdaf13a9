// One thread that starts, watches and cuts short the speech program.
#include "audio/speech/speech.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "audio/speech/child_process.h"

namespace sparsha::audio {
namespace {

using haptics::Announcement;

constexpr std::size_t kMostFaults = 8;
constexpr int kSlowest = 80;  // words a minute
constexpr int kFastest = 450;
constexpr std::size_t kMostBytes = 8000;
constexpr auto kWatch = std::chrono::milliseconds(10);
/// A program that speaks longer than this hangs.
constexpr auto kLongest = std::chrono::seconds(60);

/// One line without control characters, which speech programs may take for commands.
std::string speakable(const std::string& text) {
  std::size_t end = std::min(text.size(), kMostBytes);
  // Not in the middle of a character (UTF-8).
  while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  std::string result = text.substr(0, end);
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return result + "\n";
}

struct Words {
  std::vector<float> samples;
  double rate_hz = 0.0;
};

/// A WAV file of one channel and 16 bits as speech programs write it into a pipe: its header cannot know its length.
Words words_of(const std::string& wav) {
  Words words;
  constexpr std::size_t kRateAt = 24, kBitsAt = 34;
  const std::size_t data = wav.find("data", 36);
  if (!wav.starts_with("RIFF") || data == std::string::npos || data + 8 > wav.size()) return words;
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k) value |= std::uint32_t{static_cast<unsigned char>(wav[at + k])} << (8 * k);
    return value;
  };
  if (number(22, 2) != 1 || number(kBitsAt, 2) != 16) return words;
  words.rate_hz = number(kRateAt, 4);
  if (!(words.rate_hz >= 4000.0 && words.rate_hz <= 192000.0)) return {};
  for (std::size_t at = data + 8; at + 1 < wav.size(); at += 2)
    words.samples.push_back(static_cast<float>(static_cast<std::int16_t>(number(at, 2))) / 32768.0F);
  return words;
}

/// What is being said, and by whom.
struct Utterance {
  Announcement words;
  std::string voice;
  bool again = false;        // in the language's own voice, since the program refused the one that was asked for
  bool makes_words = false;  // the child's output is to be played
  std::unique_ptr<ChildProcess> child = nullptr;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();

  [[nodiscard]] bool failed() const { return child && child->exit_code() != 0; }
};

}  // namespace

struct Speech::Implementation {
  std::optional<std::filesystem::path> program;
  int words_per_minute = 170;
  std::string voice;
  std::string language;
  std::function<bool(std::vector<float>, double)> play;

  std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  bool silenced = false;  // end what is being said
  std::deque<Announcement> faults;
  std::optional<Announcement> newest;
  std::set<std::string> refused;  // voices
  bool failure_told = false;
  std::string problem;
  std::thread worker;

  [[nodiscard]] std::vector<std::string> arguments(const Utterance& spoken) const {
    std::vector<std::string> words{"--stdin", "-b", "1", "-s", std::to_string(words_per_minute)};
    if (!spoken.voice.empty()) words.insert(words.end(), {"-v", spoken.voice});
    if (spoken.makes_words) words.emplace_back("--stdout");
    return words;
  }

  /// The language's own voice in the same variant.
  [[nodiscard]] std::string other_voice() const {
    const std::size_t variant = voice.find('+');
    return language.empty() || variant == std::string::npos ? language : language + voice.substr(variant);
  }

  void start(Utterance& spoken, const std::vector<std::string>& arguments) const {
    spoken.began = std::chrono::steady_clock::now();
    spoken.child = ChildProcess::start(*program, arguments, speakable(spoken.words.text),
                                       spoken.makes_words ? ChildProcess::Output::keep : ChildProcess::Output::discard);
  }

  /// The program did not take the words: they are said again in the language's own voice, once.
  void say_otherwise(Utterance& spoken) {
    const int code = spoken.child->exit_code();
    spoken.child.reset();
    if (!spoken.again && spoken.voice != other_voice()) {
      spoken.again = true;
      spoken.voice = other_voice();
      return start(spoken, arguments(spoken));
    }
    if (!std::exchange(failure_told, true))
      problem = program->filename().string() + " ends with code " + std::to_string(code) + ": nothing is spoken";
  }

  /// Told once: variants of a voice are refused with it.
  void remember_refused(const Utterance& spoken) {
    if (!spoken.again || spoken.voice != other_voice()) return;  // another voice has been asked for meanwhile
    if (!refused.insert(voice).second || refused.size() > 1) return;
    problem = program->filename().string() + " has no voice '" + voice + "': it speaks with '" + spoken.voice +
              "'; expected a name of the column Language of espeak-ng --voices";
  }

  /// What is to be said next, given what is being said; none = let it speak.
  std::optional<Announcement> take(bool speaking, const Announcement& current) {
    const bool fault_speaks = speaking && current.priority == Announcement::Priority::fault;
    if (fault_speaks) return std::nullopt;
    if (!faults.empty()) {
      Announcement next = std::move(faults.front());
      faults.pop_front();
      return next;
    }
    if (newest && speaking && newest->text == current.text) newest.reset();
    return std::exchange(newest, std::nullopt);
  }

  void work() {
    Utterance spoken;
    auto played_until = spoken.began;
    std::unique_lock lock(mutex);
    while (!stopping) {
      const auto now = std::chrono::steady_clock::now();
      const bool runs = spoken.child && spoken.child->running() && now - spoken.began < kLongest;
      if (!runs && spoken.failed()) {
        say_otherwise(spoken);
        continue;
      }
      if (!runs && spoken.child) remember_refused(spoken);
      if (spoken.child && !runs && std::exchange(spoken.makes_words, false)) {
        const Words words = words_of(spoken.child->output());
        spoken.child.reset();
        if (!words.samples.empty() && play(words.samples, words.rate_hz)) {
          played_until = now + std::chrono::milliseconds(static_cast<std::int64_t>(
                                   1000.0 * static_cast<double>(words.samples.size()) / words.rate_hz));
        } else {
          start(spoken, arguments(spoken));
        }
        continue;
      }
      if (std::exchange(silenced, false)) {
        spoken.child.reset();
        spoken.makes_words = false;
        if (now < played_until) play({}, 0.0);
        played_until = now;
        continue;
      }
      const bool speaking = runs || now < played_until;
      if (!runs) spoken.child.reset();
      if (std::optional<Announcement> next = take(speaking, spoken.words)) {
        const bool known = refused.contains(voice);
        Utterance utterance{std::move(*next), known ? other_voice() : voice, known, play != nullptr};
        const std::vector<std::string> words = arguments(utterance);
        lock.unlock();
        spoken = std::move(utterance);
        if (now < played_until) play({}, 0.0);
        played_until = now;
        start(spoken, words);
        lock.lock();
      } else if (speaking) {
        wake.wait_for(lock, kWatch);
      } else {
        wake.wait(lock, [this] { return stopping || silenced || newest || !faults.empty(); });
      }
    }
  }
};

Speech::Speech(const SpeechOptions& options) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.program = find_program(options.programs);
  self.play = options.play;
  self.words_per_minute = std::clamp(options.words_per_minute, kSlowest, kFastest);
  self.voice = options.voice;
  self.language = options.language;
  if (!self.program) return;
  self.worker = std::thread([&self] { self.work(); });
}

Speech::~Speech() {
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->stopping = true;
  }
  implementation_->wake.notify_all();
  if (implementation_->worker.joinable()) implementation_->worker.join();
}

void Speech::set_words_per_minute(int words_per_minute) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->words_per_minute = std::clamp(words_per_minute, kSlowest, kFastest);
}

void Speech::set_voice(const std::string& voice) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->voice = voice;
}

std::string Speech::take_problem() {
  const std::lock_guard lock(implementation_->mutex);
  return std::exchange(implementation_->problem, {});
}

void Speech::be_silent() {
  {
    const std::lock_guard lock(implementation_->mutex);
    implementation_->faults.clear();
    implementation_->newest.reset();
    implementation_->silenced = true;
  }
  implementation_->wake.notify_all();
}

bool Speech::available() const { return implementation_->program.has_value(); }

void Speech::say(const Announcement& announcement) {
  if (!available() || announcement.text.empty()) return;
  {
    const std::lock_guard lock(implementation_->mutex);
    if (announcement.priority == Announcement::Priority::fault) {
      if (implementation_->faults.size() == kMostFaults) implementation_->faults.pop_front();
      implementation_->faults.push_back(announcement);
    } else {
      implementation_->newest = announcement;
    }
  }
  implementation_->wake.notify_all();
}

}  // namespace sparsha::audio

// One thread that starts, watches and cuts short the speech program.
#include "audio/speech/speech.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "audio/speech/child_process.h"

namespace sparsha::audio {
namespace {

using haptics::Announcement;

constexpr std::size_t kMostFaults = 8;
constexpr std::size_t kMostCharacters = 2000;
constexpr auto kWatch = std::chrono::milliseconds(10);
/// A program that speaks longer than this hangs.
constexpr auto kLongest = std::chrono::seconds(60);

/// One line without control characters, which speech programs may take for commands.
std::string speakable(const std::string& text) {
  std::string result = text.substr(0, kMostCharacters);
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return result + "\n";
}

}  // namespace

struct Speech::Implementation {
  std::optional<std::filesystem::path> program;
  std::vector<std::string> arguments;

  std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  std::deque<Announcement> faults;
  std::optional<Announcement> newest;
  std::thread worker;

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
    std::unique_ptr<ChildProcess> child;
    Announcement current;
    auto began = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex);
    while (!stopping) {
      const bool speaking = child != nullptr && child->running() && std::chrono::steady_clock::now() - began < kLongest;
      if (!speaking) child.reset();
      if (std::optional<Announcement> next = take(speaking, current)) {
        lock.unlock();
        child.reset();
        current = std::move(*next);
        began = std::chrono::steady_clock::now();
        child = ChildProcess::start(*program, arguments, speakable(current.text));
        lock.lock();
      } else if (speaking) {
        wake.wait_for(lock, kWatch);
      } else {
        wake.wait(lock, [this] { return stopping || newest || !faults.empty(); });
      }
    }
  }
};

Speech::Speech(const SpeechOptions& options) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.program = find_program(options.programs);
  if (!self.program) return;
  self.arguments = {"--stdin", "-b", "1", "-s", std::to_string(options.words_per_minute)};
  if (!options.voice.empty()) self.arguments.insert(self.arguments.end(), {"-v", options.voice});
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

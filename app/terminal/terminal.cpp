// The progress bar, the messages and the signals of the terminal.
#include "app/terminal/terminal.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "app/words/progress_line.h"
#include "app/words/sentences.h"
#include "base/error.h"
#include "base/system.h"
#include "base/system/signals.h"
#include "base/system/terminal.h"
#include "base/text/printable.h"

namespace sparsha::app {
namespace {

std::atomic<Progress*> running{nullptr};
std::atomic<bool> stop_asked{false};
std::atomic<bool> other_than_key{false};
std::atomic<unsigned> times_asked{0};
std::atomic<bool> line_open{false};
std::atomic<bool> reader_gone{false};

std::atomic<std::int64_t> asked_ms{0};  // when the program was asked to stop first

static_assert(std::atomic<Progress*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
              std::atomic<std::int64_t>::is_always_lock_free && std::atomic<unsigned>::is_always_lock_free);

/// What was promised is finished however often the program is asked to stop. One that hangs can still be ended.
constexpr std::int64_t kPatience_ms = 10'000;

std::int64_t now_ms() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

void on_ending_signal(int number) {
  ++times_asked;
  if (number != SIGINT) other_than_key.store(true);
  std::int64_t first_ms = 0;
  if (!asked_ms.compare_exchange_strong(first_ms, now_ms()) && now_ms() - first_ms > kPatience_ms) {
    system::restore_terminal();
    std::_Exit(static_cast<int>(ErrorKind::failure));
  }
  stop_asked.store(true);
  if (Progress* progress = running.load()) progress->cancel();
}

}  // namespace

void catch_interrupts() { system::route_ending_signals(on_ending_signal); }

bool interrupted() { return stop_asked.load(); }

std::function<bool()> interruption_from_now() {
  asked_ms.store(0);
  return [before = times_asked.load()] { return times_asked.load() != before; };
}

bool told_to_end() { return other_than_key.load(); }

void end_progress_line() {
  if (line_open.exchange(false)) std::fputc('\n', stderr);
}

void print(std::string_view text) {
  end_progress_line();
  const std::string shown = printable(text, true);
  errno = 0;
  std::fwrite(shown.data(), 1, shown.size(), stdout);
  if (shown.empty() || shown.back() != '\n') std::fputc('\n', stdout);
  if (std::ferror(stdout) != 0 && errno == EPIPE) reader_gone.store(true);
}

void print_error(std::string_view text) {
  end_progress_line();
  std::fprintf(stderr, "%s\n", printable(text).c_str());
}

void flush_output() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    if (errno == EPIPE || reader_gone.load()) throw ReaderGone();
    throw Error(ErrorKind::failure, {}, "standard output could not be written");
  }
}

Terminal::Terminal(const CommonOptions& options)
    : quiet_(options.quiet),
      plain_(options.plain),
      bar_(!options.quiet && !options.plain && system::redraws_lines()),
      progress_([this](const ProgressUpdate& update) { show(update); }) {
  running.store(&progress_);
  if (stop_asked.load()) progress_.cancel();
}

Terminal::~Terminal() {
  running.store(nullptr);
  if (bar_ && line_open.exchange(false)) std::fputs("\r\x1b[K", stderr);
}

void Terminal::message(std::string_view text) const {
  if (!quiet_) print_error(text);
}

void Terminal::show(const ProgressUpdate& update) {
  const auto now = std::chrono::steady_clock::now();
  if (update.kind == ProgressUpdate::Kind::warning) {
    if (bar_ && line_open.exchange(false)) std::fputs("\r\x1b[K", stderr);
    if (!quiet_) print_error("warning: " + std::string(update.text));
    return;
  }
  if (quiet_) return;
  if (update.kind == ProgressUpdate::Kind::stage) {
    stage_ = printable(update.text);
    stage_began_ = now;
    last_drawn_ = now;
    if (bar_) {
      std::fprintf(stderr, "\r\x1b[K%s", stage_line(stage_, system::terminal_columns()).c_str());
      line_open.store(true);
    } else {
      std::fprintf(stderr, plain_ ? "The step %s begins.\n" : "%s\n", stage_.c_str());
    }
    return;
  }
  constexpr std::chrono::milliseconds kRedraw{100};
  constexpr std::chrono::seconds kPlainLine{5};
  if (now - last_drawn_ < (bar_ ? std::chrono::steady_clock::duration(kRedraw) : kPlainLine)) return;
  last_drawn_ = now;
  const double elapsed = std::chrono::duration<double>(now - stage_began_).count();
  const double left = update.fraction > 0.01 ? elapsed * (1.0 - update.fraction) / update.fraction : 0.0;
  const std::string time = left >= 1.0 ? fmt::format(", {:.0f} s left", left) : "";
  if (plain_) {
    std::fprintf(stderr, "%s\n", progress_sentence(stage_, update.fraction, left).c_str());
    return;
  }
  if (!bar_) {
    std::fprintf(stderr, "%s %.0f %%%s\n", stage_.c_str(), update.fraction * 100.0, time.c_str());
    return;
  }
  std::fprintf(stderr, "\r\x1b[K%s", progress_line(stage_, update.fraction, left, system::terminal_columns()).c_str());
  std::fflush(stderr);
  line_open.store(true);
}

}  // namespace sparsha::app

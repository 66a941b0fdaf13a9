#include "haptics/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace sparsha::haptics {

Replay::Replay(RecordedScenes scenes, std::shared_ptr<const Recording> recording, const RendererOptions& options,
               Seqlock<State>& state, std::vector<std::shared_ptr<ContactQueue>> consumers, RecordSink* recorder)
    : recording_(std::move(recording)),
      run_(std::move(scenes), *recording_, options),
      publisher_(state, std::move(consumers), recorder) {}

Replay::~Replay() { stop(); }

void Replay::start() {
  stopping_.store(false);
  thread_ = std::thread([this] { run(); });
}

void Replay::stop() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

void Replay::poll() {
  if (finished() && failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Replay::tick(std::int64_t late_ns) noexcept {
  const std::int64_t begun_ns = clock_.now_ns();
  run_.step();
  const std::int64_t tick_ns = clock_.now_ns() - begun_ns;
  figures_.count(tick_ns, late_ns);
  figures_.faults = run_.renderer().faults();
  State& state = run_.renderer().state();
  state.tick_ns = static_cast<double>(tick_ns);
  state.late_ns = static_cast<double>(late_ns);
  state.share_in_time = figures_.share_in_time;
  publisher_.publish(run_.renderer());
}

void Replay::run() noexcept {
  const std::int64_t period_ns = std::llround(1e9 * recording_->period_s());
  std::int64_t planned_ns = clock_.now_ns();
  try {
    while (!stopping_.load(std::memory_order_relaxed) && !run_.finished()) {
      if (run_.needs_window()) {
        const std::int64_t begun_ns = clock_.now_ns();
        run_.change_window();
        const std::int64_t took_ns = clock_.now_ns() - begun_ns;
        figures_.swap_ns_max = std::max(figures_.swap_ns_max, static_cast<double>(took_ns));
        windows_.fetch_add(1, std::memory_order_relaxed);
        planned_ns = std::max(planned_ns, clock_.now_ns());
      }
      planned_ns += period_ns;
      clock_.sleep_until_ns(planned_ns);
      const std::int64_t late_ns = clock_.now_ns() - planned_ns;
      tick(late_ns);
      if (late_ns > period_ns) planned_ns += late_ns;  // the rest comes later, not in a burst
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  publisher_.publish_rest(run_.renderer());
  finished_.store(true, std::memory_order_release);
}

}  // namespace sparsha::haptics

#include "bench/realtime/bare_loop.h"

#include <algorithm>

#include "haptics/servo/real_time.h"

namespace sparsha::bench {

double Lateness::in_time() const {
  std::uint64_t good = 0;
  for (std::size_t bin = 0; bin < 10; ++bin) good += bins[bin];
  const std::uint64_t planned = ticks + missed;
  return planned == 0 ? 0.0 : static_cast<double>(good) / static_cast<double>(planned);
}

BareLoop::BareLoop() {
  thread_ = std::thread([this] {
    lateness_.real_time = haptics::request_real_time(haptics::kServoPriority - 1);
    std::int64_t plan = haptics::now_ns();
    while (!over_) {
      plan += kLoopPeriod_ns;
      haptics::sleep_until_ns(plan);
      const std::int64_t late = std::max<std::int64_t>(0, haptics::now_ns() - plan);
      ++lateness_.ticks;
      ++lateness_.bins[std::min(kLateBins - 1, static_cast<std::size_t>(late / kLateBin_ns))];
      lateness_.longest_ns = std::max(lateness_.longest_ns, late);
      lateness_.missed += static_cast<std::uint64_t>(late / kLoopPeriod_ns);
      plan += late / kLoopPeriod_ns * kLoopPeriod_ns;
    }
  });
}

BareLoop::~BareLoop() {
  over_ = true;
  if (thread_.joinable()) thread_.join();
}

Lateness BareLoop::stop() {
  over_ = true;
  thread_.join();
  return lateness_;
}

}  // namespace sparsha::bench

// Hands every tick to those who look on: State, recorder and the consumers of contact events.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/servo/record.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// One thread publishes; it neither waits nor allocates.
class Publisher {
 public:
  /// `state`, `consumers` and `recorder` outlive it; `recorder` may be null.
  Publisher(Seqlock<State>& state, std::vector<std::shared_ptr<ContactQueue>> consumers, RecordSink* recorder)
      : state_(state), consumers_(std::move(consumers)), recorder_(recorder) {}

  /// What the renderer's last tick came to.
  void publish(HapticRenderer& renderer) noexcept {
    State& state = renderer.state();
    state.dropped_records = recorder_ != nullptr ? recorder_->dropped() : 0;
    state_.publish(state);
    if (recorder_ != nullptr) static_cast<void>(recorder_->push(renderer.record()));
    if (renderer.event())
      for (const auto& consumer : consumers_) static_cast<void>(consumer->push(*renderer.event()));
  }

  /// The end: the last State once more, without force.
  void publish_rest(HapticRenderer& renderer) noexcept {
    State& state = renderer.state();
    state.commanded_force_n = {};
    state.given_share = 0.0;
    state_.publish(state);
  }

 private:
  Seqlock<State>& state_;
  std::vector<std::shared_ptr<ContactQueue>> consumers_;
  RecordSink* recorder_;
};

}  // namespace sparsha::haptics

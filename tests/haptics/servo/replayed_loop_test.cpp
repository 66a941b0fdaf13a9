// A recorded run of a loop that was slow, scattered or lost ticks is felt again to the last bit.
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/touch_loop.h"

namespace sparsha::test {
namespace {

using haptics::DeviceSample;
using haptics::Record;
using haptics::RecordedTick;

/// As a row of run.csv has it.
RecordedTick recorded(const Record& record) {
  RecordedTick tick;
  tick.centre_m = {record.state.centre_m[0], record.state.centre_m[1], record.state.centre_m[2]};
  tick.stiffness_n_per_m = record.state.stiffness_n_per_m;
  tick.period_s = record.period_s;
  tick.nominal_period_s = record.nominal_period_s;
  tick.command = record.state.command;
  tick.flags = record.state.flags;
  return tick;
}

TEST(ReplayedLoop, SlowScatteredAndLossyLoopsAreReplayedToTheLastBit) {
  const scene::ScenePointer scene = make_ground(Ground::relief);
  struct Loop {
    double rate_hz, configured_hz, jitter_s, lost;
    bool told;
  };
  for (const Loop& loop : {Loop{851, 1000, 0.0, 0.0, false}, Loop{851, 5000, 0.0, 0.0, false},
                           Loop{1000, 1000, 0.003, 0.1, false}, Loop{1000, 1000, 0.001, 0.1, true}})
    for (const double mass : {0.05, 0.15, 0.5})
      for (const bool stroke : {false, true}) {
        TouchCase c;
        c.ground = Ground::relief;
        c.damping_n_s_per_m = 0.3;
        c.mass_kg = mass;
        c.stroke = stroke;
        c.rate_hz = loop.rate_hz;
        c.configured_hz = loop.configured_hz;
        c.jitter_s = loop.jitter_s;
        c.lost = loop.lost;
        c.told_lost = loop.told;
        std::vector<DeviceSample> samples;
        std::vector<Record> records;
        static_cast<void>(touch(c, scene, [&](const DeviceSample& sample, const Record& record) {
          samples.push_back(sample);
          records.push_back(record);
        }));
        haptics::RendererOptions options;
        options.rate_hz = c.configured_hz;
        haptics::HapticRenderer replayed(device_of(c), options, haptics::window_on(scene, 0, 1, false));
        std::size_t differing = 0;
        std::size_t first = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
          replayed.replay(samples[k], recorded(records[k]));
          if (replayed.state().commanded_force_n != records[k].state.commanded_force_n && differing++ == 0) first = k;
        }
        EXPECT_EQ(differing, 0U) << "of " << samples.size() << ", first " << first << "; " << loop.rate_hz << " of "
                                 << loop.configured_hz << " Hz, jitter " << loop.jitter_s << " s, " << mass << " kg"
                                 << (stroke ? ", stroked" : "");
      }
}

}  // namespace
}  // namespace sparsha::test

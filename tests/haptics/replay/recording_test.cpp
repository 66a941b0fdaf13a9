// Runs that are recorded: every tick a row, played back and traced to the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/replay/replay_trace.h"
#include "haptics/replay/trace.h"
#include "haptics/session/session.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/test_folder.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

using Csv = std::vector<std::vector<std::string>>;

Csv read_csv(const std::filesystem::path& file) {
  std::ifstream stream(file);
  Csv rows;
  for (std::string line; std::getline(stream, line);) {
    rows.emplace_back();
    std::stringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

std::size_t column(const Csv& csv, const std::string& name) {
  return static_cast<std::size_t>(std::find(csv[0].begin(), csv[0].end(), name) - csv[0].begin());
}

/// All columns of all rows but the two times of the machine.
void expect_same_ticks(const Csv& first, const Csv& second) {
  ASSERT_EQ(first.size(), second.size());
  ASSERT_EQ(first[0], second[0]);
  std::size_t differing = 0;
  for (std::size_t c = 0; c < first[0].size(); ++c) {
    if (first[0][c] == "tick_ns" || first[0][c] == "late_ns") continue;
    for (std::size_t row = 1; row < first.size(); ++row)
      if (first[row][c] != second[row][c] && ++differing < 5)
        ADD_FAILURE() << "row " << row << ", " << first[0][c] << ": " << first[row][c] << " and " << second[row][c];
  }
  EXPECT_EQ(differing, 0U);
}

/// Three seconds of a simulated hand, with wishes on the way.
SessionSummary record(const scene::ScenePointer& scene, std::uint64_t seed, const SessionOptions& options,
                      const std::vector<Request>& wishes = {}) {
  // One wish every 0.3 s, and time for the last.
  const double duration_s = std::max(3.0, 0.3 * static_cast<double>(wishes.size() + 2));
  Session session(scene, make_simulated_device(seed, duration_s), options);
  return run_to_the_end(session, wishes);
}

TEST(Session, TheSimulatedHandTouchesAndEveryTickIsARow) {
  const test::TestFolder folder;
  SessionOptions options;
  options.record = folder / "run.csv";
  options.longest_gap_s = 1.0;  // pauses of the machine are other tests' matter
  Session session(textured_scene(), make_simulated_device(1, 4.0), options);
  const auto events = session.add_contact_consumer();
  const SessionSummary summary = run_to_the_end(session);
  EXPECT_GT(summary.contacts, 0U);
  EXPECT_GT(summary.contact_s, 0.2 * summary.duration_s);
  EXPECT_GT(summary.peak_force_n, 0.1);
  EXPECT_LE(summary.peak_force_n, 8.0 + 1e-9);
  EXPECT_GT(summary.path_m, 0.03);
  EXPECT_GT(summary.area_m2, 0.0);
  EXPECT_LT(summary.area_m2, 0.01);
  EXPECT_EQ(summary.faults, 0U);
  EXPECT_EQ(summary.dropped_records, 0U);
  EXPECT_EQ(summary.levels, std::vector<int>{2});
  const auto csv = read_csv(options.record);
  EXPECT_EQ(csv.size(), summary.ticks + 1);
  const std::vector<std::string> promised = {"t_s",       "hip_x_m",   "hip_y_m",   "hip_z_m",   "proxy_x_m",
                                             "proxy_y_m", "proxy_z_m", "force_x_n", "force_y_n", "force_z_n",
                                             "contact",   "level",     "tick_ns"};
  ASSERT_GE(csv[0].size(), promised.size());
  EXPECT_TRUE(std::equal(promised.begin(), promised.end(), csv[0].begin()));
  for (const auto& row : csv) ASSERT_EQ(row.size(), csv[0].size());
  ContactEvent event;
  ASSERT_TRUE(events->pop(event));
  EXPECT_EQ(event.kind, ContactEvent::Kind::touch);
  double peak_force_n = event.peak_force_n;
  while (events->pop(event)) peak_force_n = std::max(peak_force_n, event.peak_force_n);
  EXPECT_GT(peak_force_n, 0.0);
  std::uint64_t binned = 0;
  for (const std::uint64_t count : summary.lateness_histogram) binned += count;
  EXPECT_EQ(binned, summary.ticks);
  std::printf("share in time %.4f, tick p50 %.0f ns, p99 %.0f ns, max %.0f ns\n", summary.share_in_time,
              summary.tick_ns_p50, summary.tick_ns_p99, summary.tick_ns_max);
}

TEST(Session, PlaybackOfARecordingGivesIdenticalBitsThroughZoomsAndPans) {
  const test::TestFolder folder;
  const auto scene = textured_scene();
  SessionOptions options;
  options.record = folder / "run.csv";
  const SessionSummary summary = record(scene, 5, options,
                                        {{Request::Kind::zoom_in},
                                         {Request::Kind::set_stiffness, 500.0},
                                         {Request::Kind::pan, 0.2, -0.1},
                                         {Request::Kind::zoom_in},
                                         {Request::Kind::zoom_in},  // nearer than level 0's whole window
                                         {Request::Kind::set_friction, 0.0, 0.0, false},
                                         {Request::Kind::move_to, 2.04, -2.96},
                                         {Request::Kind::drag, 0.0, 0.0, true},
                                         {Request::Kind::zoom_out},
                                         {Request::Kind::drag, 0.0, 0.0, false},
                                         {Request::Kind::zoom_out},
                                         {Request::Kind::set_texture, 0.0, 0.0, false}});
  EXPECT_EQ(summary.levels, (std::vector<int>{0, 1, 2}));
  EXPECT_GE(summary.windows_loaded, 10U);
  SessionOptions again;
  again.record = folder / "again.csv";
  again.haptics.stiffness_n_per_m = 123.0;  // the recording knows better
  again.haptics.creases = scene::HapticsConfig::Creases::sharp;
  const auto session = session_of(scene, options.record, again);
  EXPECT_EQ(run_to_the_end(*session).windows_loaded, summary.windows_loaded);
  expect_same_ticks(read_csv(options.record), read_csv(again.record));
}

TEST(Session, PlaybackOfAWholeObjectThatIsTurnedGivesIdenticalBits) {
  const test::TestFolder folder;
  const auto scene = test::whole_scene(test::ball_charts(), 0.1, [](scene::SceneDescription& d) {
    d.config.friction = scene::FrictionConfig{};
    d.config.levels.window = 51;
  });
  SessionOptions options;
  options.record = folder / "run.csv";
  const SessionSummary summary = record(scene, 5, options,
                                        {{Request::Kind::turn, 0.0, 90.0},
                                         {Request::Kind::zoom_in},
                                         {Request::Kind::turn, 15.0, -45.0, false, 30.0},
                                         {Request::Kind::pan, 0.1, -0.1},
                                         {Request::Kind::set_friction, 0.0, 0.0, false},
                                         {Request::Kind::drag, 0.0, 0.0, true},
                                         {Request::Kind::turn, 0.0, 15.0},
                                         {Request::Kind::drag, 0.0, 0.0, false},
                                         {Request::Kind::whole_scene},
                                         {Request::Kind::turn_back}});
  EXPECT_GT(summary.contact_s, 0.3);
  const Csv run = read_csv(options.record);
  std::size_t turned = 0, placed = 0, around = 0;
  for (std::size_t row = 1; row < run.size(); ++row) {
    turned += std::abs(std::stod(run[row][column(run, "turn_w")])) < 0.99 ? 1U : 0U;
    const auto flags = std::stoull(run[row][column(run, "flags")]);
    placed += (flags & kFlagPlaced) != 0 ? 1U : 0U;
    around += (flags & kFlagAround) != 0 ? 1U : 0U;
  }
  EXPECT_GT(turned, run.size() / 2);
  EXPECT_GE(placed, 7U) << "the start, four turns, a pan, the whole scene and the end of dragging";
  EXPECT_EQ(around, run.size() - 1);
  SessionOptions again;
  again.record = folder / "again.csv";
  run_to_the_end(*session_of(scene, options.record, again));
  expect_same_ticks(run, read_csv(again.record));
  // The front view alone cannot play it.
  EXPECT_THROW((void)session_of(textured_scene(), options.record, {}), Error);
}

/// A hand whose grip turns, on motors that get less than was commanded and tell it now and then; its device measures
/// its delay, which changes, and its encoder's step.
class TurningGrip final : public Device {
 public:
  explicit TurningGrip(std::unique_ptr<Device> hand) : hand_(std::move(hand)) {}
  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info = hand_->info();
    info.limits.encoder_step_m = 65e-6;
    return info;
  }
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    DeviceSample sample = hand_->read(time_s, period_s);
    sample.delay_s = 0.003 + 0.0005 * static_cast<double>(ticks_ % 8);
    const double angle = 0.002 * static_cast<double>(++ticks_);
    sample.orientation = {std::cos(angle), 0.6 * std::sin(angle), 0.0, 0.8 * std::sin(angle)};
    sample.tells_applied = ticks_ % 2 == 0;
    sample.applied_n = {0.0, 0.25, 0.5};
    return sample;
  }
  void write(const Eigen::Vector3d& force_n) noexcept override { hand_->write(force_n); }
  [[nodiscard]] double force_share() const noexcept override { return 0.75; }
  void zero() noexcept override { hand_->zero(); }

 private:
  std::unique_ptr<Device> hand_;
  std::uint64_t ticks_ = 0;
};

TEST(Session, ARecordingKeepsWhatItsDeviceMeasuredAndPlaybackGivesTheSameRows) {
  const test::TestFolder folder;
  const auto scene = textured_scene();
  SessionOptions options;
  options.record = folder / "run.csv";
  Session session(scene, std::make_unique<TurningGrip>(make_simulated_device(4, 1.5)), options);
  run_to_the_end(session);
  const Csv run = read_csv(options.record);
  const auto number = [&](std::size_t row, const char* name) { return std::stod(run[row][column(run, name)]); };
  ASSERT_GT(run.size(), 1000U);
  std::size_t pressed = 0;
  for (std::size_t row = 2; row < run.size(); ++row) {
    const double angle = 0.002 * static_cast<double>(row);
    ASSERT_NEAR(number(row, "orientation_w"), std::cos(angle), 1e-12) << row;
    ASSERT_NEAR(number(row, "orientation_z"), 0.8 * std::sin(angle), 1e-12) << row;
    if (row % 2 == 0) {
      ASSERT_EQ(number(row, "applied_force_y_n"), 0.25) << row;
    } else {
      ASSERT_NEAR(number(row, "applied_force_z_n"), 0.75 * number(row - 1, "commanded_force_z_n"), 1e-12) << row;
      pressed += number(row, "applied_force_z_n") > 0.1 ? 1U : 0U;
    }
  }
  EXPECT_GT(pressed, 20U);
  SessionOptions again;
  again.record = folder / "again.csv";
  const auto played = session_of(scene, options.record, again);
  run_to_the_end(*played);
  const Csv shown = read_csv(again.record);
  ASSERT_EQ(number(run.size() - 1, "measured_delay_s"), 0.003 + 0.0005 * static_cast<double>((run.size() - 2) % 8));
  ASSERT_EQ(number(1, "encoder_step_m"), 65e-6);
  // The delay softens the wall beyond what the limits alone would.
  ASSERT_LT(number(run.size() - 1, "stiffness_n_per_m"), 0.9 * options.haptics.stiffness_n_per_m);
  expect_same_ticks(run, shown);
  EXPECT_NEAR(played->state().read().orientation[0], number(run.size() - 1, "orientation_w"), 1e-12)
      << "for the picture";
}

TEST(Device, OrientationsThatAreNoTurnAreNone) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 4> none{};
  EXPECT_EQ(unit_or_none({}), none);
  EXPECT_EQ(unit_or_none({kNaN, 0.0, 0.0, 1.0}), none);
  EXPECT_EQ(unit_or_none({1e300, 1e300, 0.0, 0.0}), none);
  EXPECT_EQ(unit_or_none({0.1, 0.0, 0.0, 0.0}), none);
  EXPECT_EQ(unit_or_none({0.6, 0.0, 0.8, 0.0}), (std::array<double, 4>{0.6, 0.0, 0.8, 0.0}));
  EXPECT_NEAR(unit_or_none({0.0, 1.1, 0.0, 0.0})[1], 1.0, 1e-15);
}

TEST(Session, TraceOfARecordingEqualsTheLiveRun) {
  const test::TestFolder folder;
  const auto scene = textured_scene(101);  // level 0 is the overview
  SessionOptions options;
  options.record = folder / "run.csv";
  options.haptics.stiffness_n_per_m = 700.0;
  record(scene, 6, options);
  const auto csv = read_csv(options.record);

  const auto path = read_hip_path(options.record);
  const WindowPlan plan = plan_window(scene->description(), 0, middle_of(scene->description().levels[0]), 0.1);
  const HapticWindow window = load_window(*scene, plan, 1);
  const TraceResult result = trace(*window.surface, path, options.haptics, SolverOptions{.shape = CellShape::rounded});
  ASSERT_EQ(result.rows.size() + 1, csv.size());
  std::uint64_t contacts = 0;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const TraceRow& row = result.rows[i];
    const auto live = [&](const char* name) { return std::stod(csv[i + 1][column(csv, name)]); };
    ASSERT_EQ(row.proxy_m.x(), live("proxy_x_m")) << "row " << i << ", flags " << live("flags");
    ASSERT_EQ(row.proxy_m.y(), live("proxy_y_m"));
    ASSERT_EQ(row.proxy_m.z(), live("proxy_z_m")) << "row " << i << ", flags " << live("flags");
    // On a loaded machine the servo renders a softer wall for a while; `trace` knows the wish alone.
    if (live("stiffness_n_per_m") == options.haptics.stiffness_n_per_m) {
      ASSERT_EQ(row.force_n.x(), live("force_x_n"));
      ASSERT_EQ(row.force_n.z(), live("force_z_n"));
    } else {
      ASSERT_NEAR(row.force_n.z() * live("stiffness_n_per_m"), live("force_z_n") * 700.0, 1e-9);
    }
    contacts += row.contact ? 1U : 0U;
  }
  EXPECT_GT(contacts, 500U);
}

TEST(Session, TraceOfARecordingEqualsTheLiveRunThroughZoomsPansAndSwaps) {
  const test::TestFolder folder;
  const auto scene = textured_scene();
  SessionOptions options;
  options.record = folder / "run.csv";
  const SessionSummary summary = record(scene, 7, options,
                                        {{Request::Kind::zoom_in},
                                         {Request::Kind::pan, 0.2, -0.1},
                                         {Request::Kind::set_stiffness, 500.0},
                                         {Request::Kind::zoom_in},
                                         {Request::Kind::move_to, 2.04, -2.96},
                                         {Request::Kind::set_texture, 0.0, 0.0, false},
                                         {Request::Kind::zoom_out},
                                         {Request::Kind::set_friction, 0.0, 0.0, false}});
  EXPECT_EQ(summary.levels, (std::vector<int>{0, 1, 2}));
  const TraceResult result = trace_recording(scene, Recording(options.record), options.haptics, SolverOptions{});
  write_trace(folder / "trace.csv", result);
  const auto live = read_csv(options.record);
  const auto traced = read_csv(folder / "trace.csv");
  ASSERT_EQ(live.size(), traced.size());
  for (std::size_t c = 0; c < traced[0].size(); ++c) {
    ASSERT_EQ(live[0][c], traced[0][c]);
    if (traced[0][c] == "tick_ns") continue;
    for (std::size_t row = 1; row < live.size(); ++row)
      ASSERT_EQ(live[row][c], traced[row][c]) << "row " << row << ", " << live[0][c];
  }
  EXPECT_GT(result.summary.contacts, 500U);
  EXPECT_EQ(result.summary.below_surface, 0U);
  EXPECT_LE(result.summary.residual_cells_p99, 1.1e-9);
}

TEST(Session, TraceOfARecordingCountsRowsOutsideTheSceneAndForcesOfNoDevice) {
  for (const bool around : {false, true}) {
    SCOPED_TRACE(around);
    const test::TestFolder folder;
    const auto scene = around ? test::whole_scene(test::ball_charts()) : textured_scene();
    SessionOptions options;
    options.record = folder / "run.csv";
    // A nearer view: the scene goes on beyond its window.
    record(scene, 5, options, {{Request::Kind::zoom_in}});
    EXPECT_EQ(trace_recording(scene, Recording(options.record), options.haptics, {}).summary.path.outside, 0U);
    Csv rows = read_csv(options.record);
    std::size_t touch = 1;
    while (rows.at(touch)[column(rows, "contact")] == "0") ++touch;
    // A hand that was a metre inside for a tick, and two that were as far beside.
    rows[touch + 5][column(rows, "device_z_m")] = "-1";
    for (const std::size_t row : {std::size_t{2}, std::size_t{7}}) rows[row][column(rows, "device_x_m")] = "-0.95";
    std::ofstream stream(folder / "far.csv");
    for (const auto& row : rows)
      for (std::size_t c = 0; c < row.size(); ++c) stream << row[c] << (c + 1 < row.size() ? ',' : '\n');
    stream.close();
    const PathDoubts doubts = trace_recording(scene, Recording(folder / "far.csv"), options.haptics, {}).summary.path;
    EXPECT_GE(doubts.outside, 2U);
    EXPECT_LE(doubts.outside, around ? 3U : 2U) << "a hand a metre behind one view is below it, not beside";
    EXPECT_EQ(doubts.first_outside, 2U);
    EXPECT_GT(doubts.outside_m, 0.3);
    EXPECT_GE(doubts.impossible_force, around ? 0U : 1U);
    EXPECT_FALSE(sentences(doubts).empty());
  }
}

TEST(Session, NoNumberOfARecordingReachesTheDeviceUnchecked) {
  const test::TestFolder folder;
  const auto scene = textured_scene();
  SessionOptions options;
  options.record = folder / "run.csv";
  record(scene, 8, options);
  // From a tenth of a second before the first touch to a while into it.
  Csv good = read_csv(options.record);
  std::size_t touch = 1;
  while (good.at(touch)[column(good, "contact")] == "0") ++touch;
  ASSERT_GT(touch, 100U);
  good.erase(good.begin() + 1, good.begin() + static_cast<std::ptrdiff_t>(touch - 100));
  good.resize(std::min<std::size_t>(good.size(), 250));
  const auto write = [&](const Csv& csv) {
    std::ofstream stream(folder / "bad.csv");
    for (const auto& row : csv)
      for (std::size_t c = 0; c < row.size(); ++c) stream << row[c] << (c + 1 < row.size() ? ',' : '\n');
  };
  const std::vector<std::string> used = {"t_s",         "centre_x_m",   "centre_y_m",
                                         "centre_z_m",  "scale",        "surface_id",
                                         "command",     "flags",        "level",
                                         "buttons",     "period_s",     "stiffness_n_per_m",
                                         "window_i",    "window_j",     "window_nx",
                                         "window_ny",   "workspace_m",  "nominal_period_s",
                                         "max_force_n", "slew_n_per_s", "least_damping_n_s_per_m",
                                         "delay_ticks"};
  int refused = 0;
  int played = 0;
  for (const std::string& name : used)
    for (const char* value : {"-1", "1e9", "1e308", "-1e308", "nan", "inf", "0.5"}) {
      SCOPED_TRACE(name + " " + value);
      Csv bad = good;
      // In the first row, where the limits are read, and in a row of force.
      for (const std::size_t row : {std::size_t{1}, std::size_t{150}}) bad[row][column(good, name)] = value;
      if (name == "t_s") bad[1] = good[1];  // else time does not increase, which is another error
      write(bad);
      SessionOptions again;
      again.record = folder / "again.csv";
      again.real_time = false;
      try {
        run_to_the_end(*session_of(scene, folder / "bad.csv", again));
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        ++refused;
        continue;
      }
      ++played;
      const Csv rows = read_csv(again.record);
      const std::size_t x = column(rows, "commanded_force_x_n");
      double last[3] = {0.0, 0.0, 0.0};
      for (std::size_t row = 1; row < rows.size(); ++row) {
        double now[3];
        double squared = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          now[axis] = std::stod(rows[row][x + axis]);
          squared += last[axis] * last[axis];
        }
        const double norm = std::hypot(now[0], now[1], now[2]);
        ASSERT_TRUE(std::isfinite(norm));
        ASSERT_LE(norm, 8.0 + 1e-12);
        ASSERT_LE(norm - std::sqrt(squared), 1500.0 * 0.001 + 1e-9) << "row " << row << ": one nominal step";
        std::copy(now, now + 3, last);
      }
    }
  EXPECT_GT(refused, 80);
  EXPECT_GT(played, 5) << "a weaker device, another place or another delay is no error";
}

TEST(Session, ARecordingOfAStrongerDeviceIsPlayedWithinPlaybacksOwnLimitsAndSaysSo) {
  const test::TestFolder folder;
  std::ofstream(folder / "run.csv") << "t_s,device_x_m,device_y_m,device_z_m,max_force_n,slew_n_per_s\n"
                                    << "0,0,0,0.02,30,9000\n0.001,0,0,0.02,30,9000\n";
  const Recording recording(folder / "run.csv");
  EXPECT_EQ(recording.info().limits.max_force_n, DeviceLimits{}.max_force_n);
  EXPECT_EQ(recording.info().limits.slew_n_per_s, DeviceLimits{}.slew_n_per_s);
  const auto session = session_of(textured_scene(), folder / "run.csv", {});
  run_to_the_end(*session);
  const auto all = session->announcements().since(0);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                          [](const Announcement& a) { return a.text.find("stronger device") != std::string::npos; }));
}

TEST(Session, APathWithoutWindowsCannotBeTracedAsALiveRun) {
  const test::TestFolder folder;
  std::ofstream(folder / "path.csv") << "t_s,device_x_m,device_y_m,device_z_m\n0,0,0,0\n";
  EXPECT_THROW((void)trace_recording(textured_scene(), Recording(folder / "path.csv"), {}, {}), Error);
}

TEST(Session, ARecordingThatCannotBeWrittenIsAnErrorBeforeTheRunBegins) {
  SessionOptions options;
  options.record = "/nonexistent-folder/run.csv";
  EXPECT_THROW(Session(sparsha::test::flat_scene(), make_simulated_device(1, 0.1), options), Error);
}

TEST(Session, AnUnfinishedSessionLeavesNoHalfRecording) {
  const test::TestFolder folder;
  SessionOptions options;
  options.record = folder / "run.csv";
  {
    Session session(sparsha::test::flat_scene(), make_simulated_device(1, 0.0), options);
    session.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(std::filesystem::is_empty(options.record.parent_path()));
}

}  // namespace
}  // namespace sparsha::haptics

#include "haptics/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/contact/trace.h"
#include "haptics/device/devices.h"
#include "haptics/session/live_trace.h"
#include "haptics/session/window_loader.h"
#include "pipeline/base/error.h"
#include "tests/haptics/servo/parts.h"
#include "tests/haptics/shared/scenes.h"

namespace sparsha::haptics {
namespace {

/// A folder that goes away with the test.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() / ("sparsha-session-" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

pipeline::ScenePointer textured_scene(int nodes = 401) {
  const auto stone = [](double x, double y) {
    return testing::hills_m(x, y) + 0.0003 * std::sin(900.0 * x) * std::sin(700.0 * y);
  };
  return testing::scene_of(stone, nodes, 0.1, 101, Eigen::Vector3d(2.0, -3.0, 0.5), [](pipeline::SceneDescription& d) {
    d.config.friction = pipeline::FrictionConfig{};
    d.config.friction->law = pipeline::FrictionConfig::Law::constant;
    d.config.parts.push_back({"middle", "The middle of it", {2.0, -3.0, 2.1, -2.9}});
  });
}

SessionOptions default_options() { return {}; }

SessionSummary run_to_the_end(Session& session) {
  session.start();
  while (!session.finished()) {
    session.poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return session.stop();
}

std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(stream, line);) {
    rows.emplace_back();
    std::stringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

std::size_t column(const std::vector<std::vector<std::string>>& csv, const std::string& name) {
  return static_cast<std::size_t>(std::find(csv[0].begin(), csv[0].end(), name) - csv[0].begin());
}

TEST(Session, TheSimulatedHandTouchesAndEveryTickIsARow) {
  const Folder folder;
  SessionOptions options = default_options();
  options.record = folder / "run.csv";
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
  // A machine that stood still for 10 ms trips the watchdog.
  EXPECT_LE(summary.faults, 2 * summary.watchdog_trips);
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
  EXPECT_GT(event.peak_force_n, 0.0);
  std::uint64_t binned = 0;
  for (const std::uint64_t count : summary.lateness_histogram) binned += count;
  EXPECT_EQ(binned, summary.ticks);
  std::printf("share in time %.4f, tick p50 %.0f ns, p99 %.0f ns, max %.0f ns\n", summary.share_in_time,
              summary.tick_ns_p50, summary.tick_ns_p99, summary.tick_ns_max);
}

TEST(Session, PlaybackOfARecordingGivesIdenticalBitsThroughZoomsAndPans) {
  const Folder folder;
  const auto scene = textured_scene();
  SessionOptions options = default_options();
  options.record = folder / "run.csv";
  {
    Session session(scene, make_simulated_device(5, 3.0), options);
    session.start();
    const std::vector<Request> wishes = {{Request::Kind::zoom_in},
                                         {Request::Kind::set_stiffness, 500.0},
                                         {Request::Kind::pan, 0.2, -0.1},
                                         {Request::Kind::zoom_in},
                                         {Request::Kind::set_friction, 0.0, 0.0, false},
                                         {Request::Kind::move_to, 2.04, -2.96},
                                         {Request::Kind::zoom_out},
                                         {Request::Kind::set_texture, 0.0, 0.0, false}};
    std::size_t next = 0;
    while (!session.finished()) {
      session.poll();
      if (session.state().read().time_s > 0.3 * static_cast<double>(next + 1) && next < wishes.size())
        session.requests().post(wishes[next++]);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    const SessionSummary summary = session.stop();
    EXPECT_EQ(summary.levels, (std::vector<int>{0, 1, 2}));
    EXPECT_GE(summary.windows_loaded, 7U);
  }
  SessionOptions again = default_options();
  again.record = folder / "again.csv";
  again.haptics.stiffness_n_per_m = 123.0;  // the recording knows better
  Session session(scene, make_playback_device(options.record), again);
  run_to_the_end(session);
  const auto first = read_csv(options.record);
  const auto second = read_csv(again.record);
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

TEST(Session, TraceOfARecordingEqualsTheLiveRun) {
  const Folder folder;
  const auto scene = textured_scene(101);  // level 0 is the overview
  SessionOptions options = default_options();
  options.record = folder / "run.csv";
  options.haptics.stiffness_n_per_m = 700.0;
  Session session(scene, make_simulated_device(6, 3.0), options);
  run_to_the_end(session);
  const auto csv = read_csv(options.record);

  const auto path = read_hip_path(options.record);
  const WindowPlan plan = plan_window(scene->description(), 0, middle_of(scene->description().levels[0]), 0.1);
  const HapticWindow window = load_window(*scene, plan, 1);
  const TraceResult result = trace(*window.surface, path, options.haptics, SolverOptions{});
  ASSERT_EQ(result.rows.size() + 1, csv.size());
  std::uint64_t contacts = 0;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const TraceRow& row = result.rows[i];
    const auto live = [&](const char* name) { return std::stod(csv[i + 1][column(csv, name)]); };
    ASSERT_EQ(row.proxy_m.x(), live("proxy_x_m")) << "row " << i << ", flags " << live("flags");
    ASSERT_EQ(row.proxy_m.y(), live("proxy_y_m"));
    ASSERT_EQ(row.proxy_m.z(), live("proxy_z_m")) << "row " << i << ", flags " << live("flags");
    ASSERT_EQ(row.force_n.x(), live("force_x_n"));
    ASSERT_EQ(row.force_n.z(), live("force_z_n"));
    contacts += row.contact ? 1U : 0U;
  }
  EXPECT_GT(contacts, 500U);
}

TEST(Session, TraceOfARecordingEqualsTheLiveRunThroughZoomsPansAndSwaps) {
  const Folder folder;
  const auto scene = textured_scene();
  SessionOptions options = default_options();
  options.record = folder / "run.csv";
  {
    Session session(scene, make_simulated_device(7, 3.0), options);
    session.start();
    const std::vector<Request> wishes = {{Request::Kind::zoom_in},
                                         {Request::Kind::pan, 0.2, -0.1},
                                         {Request::Kind::set_stiffness, 500.0},
                                         {Request::Kind::zoom_in},
                                         {Request::Kind::move_to, 2.04, -2.96},
                                         {Request::Kind::set_texture, 0.0, 0.0, false},
                                         {Request::Kind::zoom_out},
                                         {Request::Kind::set_friction, 0.0, 0.0, false}};
    std::size_t next = 0;
    while (!session.finished()) {
      session.poll();
      if (session.state().read().time_s > 0.3 * static_cast<double>(next + 1) && next < wishes.size())
        session.requests().post(wishes[next++]);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(session.stop().levels, (std::vector<int>{0, 1, 2}));
  }
  const TraceResult result = trace_recording(*scene, Recording(options.record), options.haptics, SolverOptions{});
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

TEST(Session, APathWithoutWindowsCannotBeTracedAsALiveRun) {
  const Folder folder;
  std::ofstream(folder / "path.csv") << "t_s,device_x_m,device_y_m,device_z_m\n0,0,0,0\n";
  EXPECT_THROW((void)trace_recording(*textured_scene(), Recording(folder / "path.csv"), {}, {}), Error);
}

TEST(Session, StiffnessIsWhatTheDeviceCanBear) {
  SessionOptions options = default_options();
  options.haptics.stiffness_n_per_m = 1e5;
  Session session(testing::flat_scene(), make_simulated_device(1, 0.05), options);
  const DeviceLimits limits = make_simulated_device(1, 0.0)->info().limits;
  EXPECT_EQ(run_to_the_end(session).stiffness_n_per_m, stiffness_limit(limits, 0.001));
}

TEST(Session, RefusesARateThatNoServoCanKeep) {
  SessionOptions options = default_options();
  options.haptics.rate_hz = 50'000.0;
  EXPECT_THROW(Session(testing::flat_scene(), make_simulated_device(1, 0.1), options), Error);
}

TEST(Session, ARecordingThatCannotBeWrittenIsAnErrorBeforeTheRunBegins) {
  SessionOptions options = default_options();
  options.record = "/nonexistent-folder/run.csv";
  EXPECT_THROW(Session(testing::flat_scene(), make_simulated_device(1, 0.1), options), Error);
}

TEST(Session, AnUnfinishedSessionLeavesNoHalfRecording) {
  const Folder folder;
  SessionOptions options = default_options();
  options.record = folder / "run.csv";
  {
    Session session(testing::flat_scene(), make_simulated_device(1, 0.0), options);
    session.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(std::filesystem::is_empty(options.record.parent_path()));
}

/// A hand at a fixed place, moved by the test.
class Placed {
 public:
  Placed() : place(std::make_shared<Seqlock<PointerSample>>()) { put(0.0, 0.0, 0.02); }
  void put(double x, double y, double z, std::uint64_t buttons = 0) {
    place->publish({{x, y, z}, buttons, ++sequence});
  }
  std::shared_ptr<Seqlock<PointerSample>> place;
  std::uint64_t sequence = 0;
};

bool poll_until(Session& session, const std::function<bool()>& so) {
  return eventually([&] {
    session.poll();
    return so();
  });
}

std::vector<std::string> words(Session& session) {
  std::vector<std::string> result;
  for (const Announcement& a : session.announcements().since(0)) result.push_back(a.text);
  return result;
}

bool said(Session& session, const std::string& text) {
  const auto all = words(session);
  return std::any_of(all.begin(), all.end(), [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

TEST(Session, ZoomsWithTheDevicesButtonsAndSaysTheLevel) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), default_options());
  session.start();
  EXPECT_EQ(session.state().read().level, 0U);  // nothing yet
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  EXPECT_EQ(session.state().read().level, 2U);
  hand.put(0.0, 0.0, 0.02, 1);  // plus
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 1; }));
  hand.put(0.0, 0.0, 0.02, 0);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().buttons == 0; }));
  hand.put(0.0, 0.0, 0.02, 1);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 0; }));
  hand.put(0.0, 0.0, 0.02, 0);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().buttons == 0; }));
  hand.put(0.0, 0.0, 0.02, 1);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Finest level"); }));
  hand.put(0.0, 0.0, 0.02, 2);  // forward: the whole scene
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 2; }));
  EXPECT_TRUE(said(session, "Level 1 of 3"));
  const SessionSummary summary = session.stop();
  EXPECT_EQ(summary.levels, (std::vector<int>{0, 1, 2}));
  std::printf("swap at most %.1f us\n", summary.swap_ns_max * 1e-3);
}

TEST(Session, TheWindowFollowsAHandAtTheWorkspacesRimToTheEdgeOfTheScene) {
  Placed hand;
  Session session(textured_scene(), make_pointer_device(hand.place), default_options());
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.requests().post({Request::Kind::zoom_in});
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().level == 1; }));
  const State before = session.state().read();
  hand.put(0.0495, 0.0, 0.004);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id > before.surface_id; }))
      << "fresh tiles near the border";
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().hip_m[0] > 2.0985; }));
  EXPECT_TRUE(said(session, "Moving right"));
  const State after = session.state().read();
  EXPECT_GT(after.centre_m[0], before.centre_m[0]);
  EXPECT_LE(after.centre_m[0], 2.0755);  // the workspace's edge stops at the scene's
  EXPECT_TRUE((after.flags & kFlagOutside) == 0);
  // Friction lets the proxy lag by 0.4 of the depth.
  hand.put(0.056, 0.0, -0.003);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Edge of the scene"); }));
  session.stop();
}

TEST(Session, AReliefDeeperThanTheWorkspaceComesIntoReachAtItsRim) {
  const auto scene = testing::scene_of([](double x, double) { return 1.5 * x; }, 101, 0.1);  // 15 cm deep
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), default_options());
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  hand.put(-0.04, 0.0, -0.04);  // the surface is at -0.06 there
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[2] < -0.0399; }));
  EXPECT_EQ(session.state().read().contact, 0U);
  hand.put(-0.04, 0.0, -0.048);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().contact == 1; }));
  EXPECT_TRUE(said(session, "Going deeper"));
  session.stop();
}

TEST(Session, SpeaksPartsWhenTouchedAndAreasThatWereNeverMeasured) {
  const auto scene = testing::scene_of([](double x, double) { return x > 0.07 ? std::nan("") : 0.0; }, 101, 0.1, 200,
                                       Eigen::Vector3d::Zero(),
                                       [](pipeline::SceneDescription& d) {
                                         d.config.parts.push_back({"left", "Left half", {0.0, 0.0, 0.045, 0.1}});
                                       });
  Placed hand;
  Session session(scene, make_pointer_device(hand.place), default_options());
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 100; }));
  hand.put(-0.02, 0.0, 0.02);
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().device_m[0] < -0.0199; }));
  EXPECT_FALSE(said(session, "Left half")) << "not touched yet";
  hand.put(-0.02, 0.0, -0.005);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Left half"); }));
  hand.put(0.04, 0.0, -0.005);
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "Not measured here"); }));
  session.requests().post({Request::Kind::describe});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "from the left edge"); }));
  session.requests().post({Request::Kind::quit});
  ASSERT_TRUE(poll_until(session, [&] { return session.finished(); }));
  session.stop();
}

/// Presses into the stone after 100 ms in the air, again and again, and then does what it is told to do wrong.
enum class Trouble { none, not_a_number, unplugged, silent };
std::unique_ptr<Device> troubled_device(const std::shared_ptr<std::atomic<Trouble>>& trouble) {
  return std::make_unique<ScriptedDevice>([trouble](std::uint64_t tick, double time_s) {
    DeviceSample sample = sample_at({0.0, 0.0, tick % 400 < 100 ? 0.02 : -0.002}, time_s);
    const Trouble now = trouble->load();
    if (now == Trouble::not_a_number) sample.position_m.x() = std::nan("");
    if (now == Trouble::unplugged) sample.connected = false;
    if (now == Trouble::silent) std::this_thread::sleep_for(std::chrono::milliseconds(40));
    return sample;
  });
}

TEST(Session, SaysWhatIsWrongWithTheDeviceAndTakesTheForceAway) {
  const std::vector<std::pair<Trouble, std::string>> troubles = {{Trouble::not_a_number, "no usable position"},
                                                                 {Trouble::unplugged, "unplugged"},
                                                                 {Trouble::silent, "fell silent"}};
  for (const auto& [wrong, said_of_it] : troubles) {
    const std::string& words_expected = said_of_it;  // Clang 14 captures no structured binding
    const auto trouble = std::make_shared<std::atomic<Trouble>>(Trouble::none);
    Session session(testing::flat_scene(), troubled_device(trouble), default_options());
    session.start();
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().commanded_force_n[2] > 1.0; }));
    trouble->store(wrong);
    ASSERT_TRUE(poll_until(session, [&] { return said(session, words_expected); })) << words_expected;
    ASSERT_TRUE(poll_until(session, [&] { return session.state().read().commanded_force_n[2] == 0.0; }));
    const auto all = session.announcements().since(0);
    EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                            [](const Announcement& a) { return a.priority == Announcement::Priority::fault; }));
    EXPECT_GT(session.stop().faults, 0U);
  }
}

TEST(Session, SaysWhenRealTimeWasNotGranted) {
  SessionOptions options = default_options();
  Session session(testing::flat_scene(), make_simulated_device(1, 0.0), options);
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 20; }));
  const bool granted = (session.state().read().flags & kFlagRealTime) != 0;
  EXPECT_EQ(said(session, "Real-time scheduling was not granted"), !granted);
  EXPECT_EQ(session.stop().real_time, granted);
}

TEST(Session, LimitsAStiffnessThatIsAskedForLaterAndSaysSo) {
  Session session(testing::flat_scene(), make_simulated_device(1, 0.0), default_options());
  session.start();
  session.requests().post({Request::Kind::set_stiffness, 1e6});
  ASSERT_TRUE(poll_until(session, [&] { return said(session, "all the device can bear"); }));
  const double limit = stiffness_limit(make_simulated_device(1, 0.0)->info().limits, 0.001);
  EXPECT_EQ(session.stop().stiffness_n_per_m, limit);
}

TEST(Session, ANewSceneKeepsTheHandsPlaceAndTheOldSceneIsLetGo) {
  Placed hand;
  auto first = testing::flat_scene(0.0);
  const std::weak_ptr<const pipeline::Scene> watch = first;
  Session session(std::move(first), make_pointer_device(hand.place), default_options());
  session.start();
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().tick > 5; }));
  session.set_scene(testing::flat_scene(7.0, 151, 3.0));
  ASSERT_TRUE(poll_until(session, [&] { return session.state().read().surface_id == 2; }));
  const State state = session.state().read();
  EXPECT_NEAR(state.centre_m[2], 7.0, 1e-5);
  EXPECT_NEAR(state.device_m[2], 0.02, 1e-9);
  EXPECT_NEAR(state.centre_m[0], 1.5, 1e-9);
  session.stop();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace sparsha::haptics

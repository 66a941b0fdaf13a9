// What is set, read back and let through, and that nothing waits for a lock between answer and force.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <string>

#include "haptics/device/haply/force_match.h"
#include "haptics/device/haply/messages.h"
#include "tests/haptics/device/haply/emulated_service.h"
#include "tests/support/sanitized.h"

namespace {
thread_local bool watching = false;
std::atomic<int> locks{0};
}  // namespace

#if !SPARSHA_SANITIZED
extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  if (watching) locks.fetch_add(1);
  using Lock = int (*)(pthread_mutex_t*);
  static const auto real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  return real(mutex);
}
#endif

namespace sparsha::haptics::haply {
namespace {
using Json = nlohmann::json;

TEST(HaplySettings, AreSetInTheFirstMessageAndAskedForAfterwards) {
  Service emulated;
  static_cast<void>(make_haply_device(emulated.client));
  const auto log = emulated.log();
  std::vector<Json> sent;
  for (const emulator::HaplyMessage& message : log)
    if (!message.to_client) sent.push_back(Json::parse(message.text));
  ASSERT_GE(sent.size(), 2U);
  EXPECT_EQ(sent[0]["session"]["configure"]["basis"]["permutation"], "XYZ");
  EXPECT_EQ(sent[0]["inverse3"][0]["configure"]["preset"]["preset"], "arm_front_centered");
  EXPECT_EQ(sent[0]["inverse3"][0]["configure"]["damping"]["scalar"], kServiceDamping);
  EXPECT_FALSE(sent[0]["session"].contains("force_render_full_state")) << "else it may tell of before";
  EXPECT_TRUE(sent[1]["session"]["force_render_full_state"].is_object());
  for (const Json& message : sent)
    EXPECT_EQ(message["inverse3"][0]["commands"]["set_cursor_force"]["vector"]["z"], 0.0) << message;
}

TEST(HaplySettings, AConfigurationWithoutAPresetIsNoForce) {
  emulator::HaplyOptions options;
  options.no_preset = true;
  expect_no_force_from(options);
}

TEST(HaplySettings, AServiceOfOtherWordsIsFeltWithItsGrip) {
  emulator::HaplyOptions options;
  options.other_words = true;
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  EXPECT_TRUE(eventually([&] { return emulated.service->strongest_n() > 0.3; }));
  EXPECT_TRUE(eventually([&] { return run.state.read().contact == 1U; }));
}

TEST(HaplySettings, AWorkspaceThatAnotherProgramMovedTurnedOrScaledIsNoPlaceForForce) {
  const auto read = [](const std::string& transform) {
    ServiceState state;
    EXPECT_TRUE(read_state(R"({"inverse3":[{"device_id":"A","config":{"preset":{"preset":"arm_front_centered"},)"
                           R"("basis":{"permutation":"XYZ"}},"state":{"transform":)" +
                               transform + "}}]}",
                           "A", state));
    return state;
  };
  for (const char* const still : {"{}", R"({"scale":{"x":1.0,"y":1}})", R"({"rotation":{"w":1,"x":0}})",
                                  R"({"position":{"x":0,"y":0,"z":0.00001}})"})
    EXPECT_TRUE(read(still).is_set_up()) << still;
  for (const char* const moved : {R"({"scale":{"x":2.0}})", R"({"position":{"z":0.02}})", R"({"scale":{"y":-1}})",
                                  R"({"rotation":{"w":0.7071,"z":0.7071}})"}) {
    EXPECT_TRUE(read(moved).displaced) << moved;
    EXPECT_FALSE(read(moved).is_set_up()) << moved;
  }
}

TEST(HaplyForceMatch, DiffersAfterFiftyMillisecondsOfMoreThanATenth) {
  const Eigen::Vector3d asked(0.0, 0.0, 2.0);
  const auto after = [&](double share, int ticks) {
    ForceMatch match;
    for (int tick = 0; tick < ticks; ++tick) match.see(asked, asked, share * asked, Eigen::Vector3d::Zero(), 0.001);
    return match;
  };
  EXPECT_FALSE(after(0.91, 1000).differs()) << "9 % is within";
  EXPECT_FALSE(after(0.89, 49).differs()) << "not yet for so long";
  EXPECT_TRUE(after(0.89, 52).differs());
  EXPECT_FALSE(after(1.09, 1000).differs());
  EXPECT_TRUE(after(1.11, 52).differs());
  EXPECT_NEAR(after(0.6, 1).share(), 0.6, 1e-12);
  EXPECT_FALSE(after(1.1, 1000).others()) << "0.2 N are no other program yet";
  EXPECT_TRUE(after(1.2, 12).others());
  ForceMatch match;
  for (int tick = 0; tick < 200; ++tick)
    match.see(asked, asked, (tick % 40 == 0 ? 1.0 : 0.8) * asked, Eigen::Vector3d::Zero(), 0.001);
  EXPECT_FALSE(match.differs()) << "each 40 ms one as commanded";
  ForceMatch steps;
  for (int tick = 0; tick < 200; ++tick)
    steps.see(tick % 2 == 0 ? asked : -asked, tick % 2 == 0 ? -asked : asked, tick % 2 == 0 ? -asked : asked,
              Eigen::Vector3d::Zero(), 0.001);
  EXPECT_FALSE(steps.differs()) << "what arrives may be the command of before";
}

TEST(HaplyForceMatch, TheDampingThatWasAskedForIsNoOtherProgramAndNoDifference) {
  const Eigen::Vector3d asked(0.0, 0.0, 1.0);
  for (const Eigen::Vector3d& drag : {Eigen::Vector3d(0.8, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, -0.5)})
    for (const bool told : {true, false}) {
      ForceMatch match;
      for (int tick = 0; tick < 200; ++tick) match.see(asked, asked, told ? asked + drag : asked, drag, 0.001);
      EXPECT_FALSE(match.differs()) << drag.transpose();
      EXPECT_FALSE(match.others()) << drag.transpose();
      EXPECT_EQ(match.share(), 1.0) << drag.transpose();
    }
  ForceMatch pushed;
  for (int tick = 0; tick < 20; ++tick) pushed.see(asked, asked, 2.0 * asked, Eigen::Vector3d(0.1, 0.0, 0.0), 0.001);
  EXPECT_TRUE(pushed.others());
}

TEST(HaplyRealTime, NothingIsLockedBetweenAnswerAndForceAtOneAndFourKilohertz) {
  if (SPARSHA_SANITIZED) GTEST_SKIP() << "sanitizers lock as they like";
  for (const double period_s : {0.001, 0.00025}) {
    Service emulated;
    const auto device = make_haply_device(emulated.client);
    locks.store(0);
    int fresh = 0;
    for (int tick = 0; tick < 500; ++tick) {
      watching = true;
      device->wait(period_s);
      const DeviceSample sample = device->read(period_s * tick, period_s);
      device->write({0.0, 0.0, 0.1});
      watching = false;
      if (sample.fresh) ++fresh;
    }
    EXPECT_EQ(locks.load(), 0) << period_s;
    EXPECT_GT(fresh, 400) << period_s;
  }
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  watching = true;
  pthread_mutex_lock(&mutex);
  watching = false;
  pthread_mutex_unlock(&mutex);
  EXPECT_EQ(locks.load(), 1) << "the counter would see one";
}

}  // namespace
}  // namespace sparsha::haptics::haply

// Heights read beside the worker: the newest window, once, from the time on at which the hand came to it.
#include "audio/scrape/profile_loader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "tests/audio/stroking.h"

namespace {

using namespace sparsha;
using namespace stroking;

ProfileLoader::Loaded wait_for(ProfileLoader& loader) {
  for (int i = 0; i < 10'000; ++i) {
    if (ProfileLoader::Loaded loaded = loader.take(); loaded.profile) return loaded;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

TEST(ProfileLoader, GivesTheHeightsOfAWindowOnceFromTheTimeOfItsWishOn) {
  const test::SceneOptions options{60, 60, 0.001};
  ProfileLoader loader(stone([](double x, double) { return x; }, options), false);
  haptics::State state = hand(1.25, 0.02, 0.02, options);
  loader.wish(state);
  const ProfileLoader::Loaded loaded = wait_for(loader);
  ASSERT_NE(loaded.profile, nullptr);
  EXPECT_EQ(loaded.since_s, 1.25);
  EXPECT_NEAR(loaded.profile->height_m(0, {0.031, 0.02, 0.0}), 0.031, 1e-6);
  state.time_s = 2.0;
  loader.wish(state);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(loader.take().profile, nullptr) << "the same window";
  loader.set_scene(stone([](double x, double) { return 2.0 * x; }, options));
  loader.wish(state);
  const ProfileLoader::Loaded again = wait_for(loader);
  ASSERT_NE(again.profile, nullptr) << "of another scene";
  EXPECT_NEAR(again.profile->height_m(0, {0.031, 0.02, 0.0}), 0.062, 1e-6);
}

TEST(ProfileLoader, OfManyWishesTheLastOneIsReadInTheEndAndNoWishWaitsForTheReading) {
  // A window of a million nodes takes milliseconds to read, a wish microseconds.
  const test::SceneOptions options{1400, 1400, 0.0001};
  const auto scene =
      stone([](double x, double y) { return 1e-4 * std::sin(900.0 * x) * std::cos(700.0 * y); }, options);
  ProfileLoader loader(scene, true);
  haptics::State state = hand(0.0, 0.02, 0.02, options);
  using Clock = std::chrono::steady_clock;
  std::vector<double> wishes_s;
  const auto begin = Clock::now();
  ProfileReader reader(scene, true);
  ASSERT_NE(reader.update(state), nullptr);
  const double reading_s = std::chrono::duration<double>(Clock::now() - begin).count();
  for (int k = 0; k < 200; ++k) {
    state.time_s = 1e-3 * k;
    state.window = {k, 0, 1200, 1200};
    const auto before = Clock::now();
    loader.wish(state);
    wishes_s.push_back(std::chrono::duration<double>(Clock::now() - before).count());
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  std::sort(wishes_s.begin(), wishes_s.end());
  EXPECT_LT(wishes_s[150], 0.2 * reading_s);
  ProfileLoader::Loaded last;
  for (ProfileLoader::Loaded next = wait_for(loader); next.profile; next = wait_for(loader)) {
    last = next;
    if (last.since_s == state.time_s) break;
  }
  ASSERT_NE(last.profile, nullptr);
  EXPECT_EQ(last.since_s, state.time_s);
  EXPECT_NEAR(last.profile->origin_m().x(), 199 * options.spacing_m, 1e-9);
}

}  // namespace

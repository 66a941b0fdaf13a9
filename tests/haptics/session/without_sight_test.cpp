// A visit without window and without sight: named parts are found by the grip's buttons and by words alone. Who acts
// knows only what is announced; who judges knows only the scene, what was said and the states of the servo.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "haptics/device/pointer/pointer_device.h"
#include "haptics/session/session.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

struct Placed {
  std::string say;
  std::array<double, 4> box_m;
};
const std::vector<Placed> kParts = {{"A leaf", {0.70, 0.80, 0.80, 0.90}},
                                    {"The left edge", {0.05, 0.30, 0.15, 0.60}},
                                    {"A lotus", {0.45, 0.10, 0.60, 0.25}}};

scene::ScenePointer stone() {
  return sparsha::test::scene_of([](double x, double y) { return 10.0 * sparsha::test::hills_m(0.1 * x, 0.1 * y); },
                                 401, 1.0, 101, Eigen::Vector3d::Zero(),
                                 [](scene::SceneDescription& d) {
                                   for (const Placed& part : kParts)
                                     d.config.parts.push_back({part.say, part.say, part.box_m});
                                 });
}

/// What was said, and where the hand was in the stone when it touched.
struct Log {
  std::vector<std::string> words;
  std::vector<State> touches;
};

/// A visitor who presses buttons and lowers the hand, nothing else.
class Visitor {
 public:
  explicit Visitor(Session& session, std::shared_ptr<Seqlock<PointerSample>> hand)
      : session_(session), hand_(std::move(hand)) {}

  void put(double z_m, std::uint64_t buttons = 0) { hand_->publish({{0.0, 0.0, z_m}, buttons, ++sequence_}); }
  bool wait(const std::function<bool()>& so) {
    return eventually([&] {
      session_.poll();
      for (const Announcement& a : session_.announcements().since(heard_)) {
        heard_ = a.sequence;
        log.words.push_back(a.text);
      }
      const State now = session_.state().read();
      if (now.contact != 0 && now.tick > seen_) log.touches.push_back(now);
      seen_ = now.tick;
      return so();
    });
  }
  [[nodiscard]] bool ticks(std::uint64_t count) {
    const std::uint64_t begin = session_.state().read().tick;
    return wait([&] { return session_.state().read().tick > begin + count; });
  }
  /// Holds a button until something is said.
  [[nodiscard]] bool hold(std::uint64_t button) {
    const std::size_t before = log.words.size();
    put(0.02, button);
    const bool spoke = wait([&] { return log.words.size() > before; });
    put(0.02);
    return spoke && wait([&] { return session_.state().read().buttons == 0; }) && ticks(300);
  }
  [[nodiscard]] bool click(std::uint64_t button) {
    const std::size_t before = log.words.size();
    put(hand_z_m_, button);
    const bool down = wait([&] { return session_.state().read().buttons == button; });
    put(hand_z_m_);
    return down && wait([&] { return log.words.size() > before; });
  }
  /// Lowers the hand until the stone is felt.
  [[nodiscard]] bool touch() {
    for (hand_z_m_ = 0.02; hand_z_m_ > -0.05; hand_z_m_ -= 0.001) {
      put(hand_z_m_);
      if (!ticks(8)) return false;
      if (session_.state().read().contact != 0) return ticks(40);
    }
    return false;
  }
  void lift() {
    hand_z_m_ = 0.02;
    put(hand_z_m_);
    static_cast<void>(ticks(1200));  // what was said of a part is said again only after a second
  }

  Log log;

 private:
  Session& session_;
  std::shared_ptr<Seqlock<PointerSample>> hand_;
  std::uint64_t sequence_ = 0;
  std::uint64_t heard_ = 0;
  std::uint64_t seen_ = 0;
  double hand_z_m_ = 0.02;
};

bool inside(const Placed& part, const State& state) {
  return state.place_m[0] >= part.box_m[0] && state.place_m[0] <= part.box_m[2] && state.place_m[1] >= part.box_m[1] &&
         state.place_m[1] <= part.box_m[3];
}

TEST(WithoutSight, ThreeNamedPartsAreFoundByButtonsAndWordsAlone) {
  const auto hand = std::make_shared<Seqlock<PointerSample>>();
  SessionOptions options;
  options.speaks = true;
  options.longest_gap_s = 0.3;
  Session session(stone(), make_pointer_device(hand), options);
  Visitor visitor(session, hand);
  visitor.put(0.02);
  session.start();
  ASSERT_TRUE(visitor.ticks(200));
  ASSERT_FALSE(visitor.log.words.empty());
  EXPECT_NE(visitor.log.words.front().find("For help, hold the middle button"), std::string::npos)
      << "the first words say how to get help";

  constexpr std::uint64_t kRight = 1;
  constexpr std::uint64_t kCentre = 4;
  for (const Placed& part : kParts) {
    const std::size_t words_before = visitor.log.words.size();
    const std::size_t touches_before = visitor.log.touches.size();
    ASSERT_TRUE(visitor.hold(kRight));
    const std::string way = visitor.log.words[words_before];
    EXPECT_EQ(way, part.say + " is under your hand") << "the window brings it to a hand in the device's middle";
    ASSERT_TRUE(visitor.touch()) << part.say;
    // The judge: the stone was touched, on the part that was named, and its name was said again when it was.
    ASSERT_GT(visitor.log.touches.size(), touches_before) << part.say;
    EXPECT_TRUE(inside(part, visitor.log.touches.back())) << part.say;
    EXPECT_GT(std::count(visitor.log.words.begin() + static_cast<std::ptrdiff_t>(words_before) + 1,
                         visitor.log.words.end(), part.say),
              0)
        << ::testing::PrintToString(visitor.log.words);
    ASSERT_TRUE(visitor.click(kCentre));
    EXPECT_EQ(visitor.log.words.back().rfind(part.say + ". ", 0), 0U) << visitor.log.words.back();
    visitor.lift();
  }
  // What the motors were told in touch: something, and never more than the device bears.
  for (const State& touch : visitor.log.touches) {
    const auto& f = touch.commanded_force_n;
    EXPECT_LE(std::hypot(f[0], f[1], f[2]), DeviceLimits{}.max_force_n + 1e-9);
  }
  EXPECT_TRUE(std::any_of(visitor.log.touches.begin(), visitor.log.touches.end(),
                          [](const State& s) { return s.commanded_force_n[2] > 0.0; }));
  for (const std::string& words : visitor.log.words) EXPECT_EQ(words.find('{'), std::string::npos) << words;
  session.stop();
}

}  // namespace
}  // namespace sparsha::haptics

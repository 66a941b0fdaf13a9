// A whole visit without sight: three named parts are found by the grip's buttons, and the outline of the last is
// followed with the guide. Who acts knows only what is announced; who judges knows only the scene, what was said, the
// contacts and what the motors were told.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "haptics/session/session.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Placed {
  std::string say;
  Vector2d middle_m;
};
const std::vector<Placed> kParts = {{"A leaf", {0.75, 0.8}}, {"The left flower", {0.2, 0.4}}, {"A lotus", {0.6, 0.3}}};
constexpr double kRadiusM = 0.04;
constexpr double kForceN = 1.2;
constexpr std::uint64_t kRight = 1;

/// A stone of 1 m with a disc 8 mm high in the middle of each part.
pipeline::ScenePointer stone() {
  const auto height_m = [](double x, double y) {
    return std::any_of(kParts.begin(), kParts.end(),
                       [&](const Placed& part) { return (Vector2d(x, y) - part.middle_m).norm() < kRadiusM; })
               ? 0.008
               : 0.0;
  };
  return sparsha::test::scene_of(height_m, 401, 1.0, 101, Vector3d::Zero(), [](pipeline::SceneDescription& d) {
    for (const Placed& part : kParts) {
      const Vector2d& m = part.middle_m;
      d.config.parts.push_back({part.say, part.say, {m.x() - 0.05, m.y() - 0.05, m.x() + 0.05, m.y() + 0.05}});
    }
    d.config.guide = pipeline::GuideConfig{};
    d.config.guide->force_n = kForceN;
    d.config.guide->speed_m_per_s = 0.1;
  });
}

/// A relaxed hand of 0.15 kg on a device: the servo's force moves it across the stone, the visitor raises and lowers
/// it, pushes it and presses buttons.
class Hand final : public Device {
 public:
  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "hand";
    return info;
  }
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    constexpr double kMassKg = 0.15;
    constexpr double kDamping = 3.0;  // N s/m
    const Vector2d wish(wish_x_.load(), wish_y_.load());
    const Vector2d pull = force_n_ + kDamping * (wish - velocity_);
    velocity_ += pull * (period_s / kMassKg);
    place_ += velocity_ * period_s;
    place_ = place_.cwiseMax(-0.05).cwiseMin(0.05);
    DeviceSample sample = sample_at({place_.x(), place_.y(), z_m_.load()}, time_s);
    sample.buttons = buttons_.load();
    return sample;
  }
  void write(const Vector3d& force_n) noexcept override {
    force_n_ = force_n.head<2>();
    if (force_n.norm() > strongest_n_.load()) strongest_n_.store(force_n.norm());
  }
  void zero() noexcept override { force_n_.setZero(); }

  void press(std::uint64_t buttons) { buttons_.store(buttons); }
  void lower(double z_m) { z_m_.store(z_m); }
  void push(const Vector2d& wish_m_per_s) {
    wish_x_.store(wish_m_per_s.x());
    wish_y_.store(wish_m_per_s.y());
  }
  [[nodiscard]] double strongest_n() const { return strongest_n_.load(); }

 private:
  std::atomic<double> z_m_{0.02}, wish_x_{0.0}, wish_y_{0.0}, strongest_n_{0.0};
  std::atomic<std::uint64_t> buttons_{0};
  Vector2d place_ = Vector2d::Zero();  // servo thread
  Vector2d velocity_ = Vector2d::Zero();
  Vector2d force_n_ = Vector2d::Zero();
};

class Visitor {
 public:
  Visitor() {
    auto hand = std::make_unique<Hand>();
    hand_ = hand.get();
    SessionOptions options;
    options.speaks = true;
    options.real_time = false;
    options.longest_gap_s = 0.5;
    session_ = std::make_unique<Session>(stone(), std::move(hand), options);
    session_->start();
  }
  ~Visitor() { session_->stop(); }

  /// Looks and listens until something is so; every state that it sees is kept.
  [[nodiscard]] bool wait(const std::function<bool()>& so) {
    return eventually([&] {
      session_->poll();
      for (const Announcement& a : session_->announcements().since(heard_)) {
        heard_ = a.sequence;
        words.push_back(a.text);
      }
      const State now = session_->state().read();
      if (states.empty() || now.tick > states.back().tick) states.push_back(now);
      return so();
    });
  }
  [[nodiscard]] bool ticks(std::uint64_t count) {
    const std::uint64_t begin = session_->state().read().tick;
    return wait([&] { return states.back().tick > begin + count; });
  }
  [[nodiscard]] bool hears(const std::string& what, std::size_t from) {
    return wait([&] { return said(what, from); });
  }
  [[nodiscard]] bool said(const std::string& what, std::size_t from) const {
    return std::any_of(words.begin() + static_cast<std::ptrdiff_t>(std::min(from, words.size())), words.end(),
                       [&](const std::string& text) { return text.find(what) != std::string::npos; });
  }
  /// Lowers the hand until the stone is felt.
  [[nodiscard]] bool touch() {
    for (double z_m = 0.02; z_m > -0.05; z_m -= 0.0005) {
      hand_->lower(z_m);
      if (!ticks(8)) return false;
      if (states.back().contact != 0) return ticks(60);
    }
    return false;
  }
  [[nodiscard]] bool lift() {
    hand_->lower(0.02);
    return ticks(1200);  // a part is spoken of again only after a second
  }
  [[nodiscard]] Hand& hand() { return *hand_; }

  std::vector<std::string> words;
  std::vector<State> states;

 private:
  Hand* hand_ = nullptr;
  std::unique_ptr<Session> session_;
  std::uint64_t heard_ = 0;
};

/// The direction of an hour that is said, from "... two o'clock".
Vector2d direction_of(const std::string& words) {
  constexpr std::array<const char*, 12> kHours{"twelve", "one",   "two",   "three", "four", "five",
                                               "six",    "seven", "eight", "nine",  "ten",  "eleven"};
  for (std::size_t hour = 0; hour < kHours.size(); ++hour)
    if (words.find(std::string(kHours[hour]) + " o'clock") != std::string::npos) {
      const double angle = 2.0 * 3.14159265358979 * static_cast<double>(hour) / 12.0;
      return {std::sin(angle), std::cos(angle)};
    }
  return Vector2d::Zero();
}

TEST(WithoutSight, AVisitorFindsThreePartsByButtonsAndFollowsTheOutlineOfOneWithTheGuide) {
  Visitor visitor;
  ASSERT_TRUE(visitor.ticks(200));
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    const Placed& part = kParts[k];
    const std::size_t before = visitor.words.size();
    const std::size_t touches = visitor.states.size();
    const bool last = k + 1 == kParts.size();
    visitor.hand().press(kRight);
    ASSERT_TRUE(visitor.hears(part.say + ", ", before)) << "its way: distance and hour";
    if (last) {
      ASSERT_TRUE(visitor.hears("Guide on", before)) << "held on, the guide";
    }
    visitor.hand().press(0);
    ASSERT_TRUE(visitor.ticks(300));
    ASSERT_TRUE(visitor.touch()) << part.say;
    ASSERT_TRUE(visitor.hears(part.say, before + 1));
    // The judge: the stone was touched inside the part.
    const bool felt = std::any_of(
        visitor.states.begin() + static_cast<std::ptrdiff_t>(touches), visitor.states.end(), [&](const State& s) {
          const Vector2d off = Vector2d(s.place_m[0], s.place_m[1]) - part.middle_m;
          return s.contact != 0 && s.commanded_force_n[2] > 0.0 && off.cwiseAbs().maxCoeff() < 0.05;
        });
    EXPECT_TRUE(felt) << part.say;
    if (!last) {
      ASSERT_TRUE(visitor.lift());
    }
  }

  // Towards the hour that the guide has named, until it has the hand.
  const auto guide_words = std::find_if(visitor.words.begin(), visitor.words.end(), [](const std::string& text) {
    return text.find("Guide on") != std::string::npos;
  });
  ASSERT_NE(guide_words, visitor.words.end());
  visitor.hand().push(0.03 * direction_of(*guide_words));
  ASSERT_TRUE(visitor.hears("The guide leads your hand", 0)) << ::testing::PrintToString(visitor.words);
  visitor.hand().push(Vector2d::Zero());
  const std::size_t begin = visitor.states.size();
  ASSERT_TRUE(visitor.hears("Once around", 0)) << ::testing::PrintToString(visitor.words);

  // The judge: nearly all of the outline was felt, and the guide was never stronger than it may be.
  int covered = 0;
  for (int degree = 0; degree < 360; ++degree) {
    const double angle = degree * 3.14159265358979 / 180.0;
    const Vector2d place = kParts.back().middle_m + kRadiusM * Vector2d(std::cos(angle), std::sin(angle));
    covered += std::any_of(visitor.states.begin() + static_cast<std::ptrdiff_t>(begin), visitor.states.end(),
                           [&](const State& s) {
                             const Vector2d hand(s.hip_m[0], s.hip_m[1]);
                             return s.scale * (hand - place).norm() < 0.0035;  // states are seen every few milliseconds
                           })
                   ? 1
                   : 0;
  }
  EXPECT_GE(covered, 342) << "95 %";
  for (const State& s : visitor.states) ASSERT_LE(std::hypot(s.guide_n[0], s.guide_n[1]), kForceN + 1e-9);
  EXPECT_LE(visitor.hand().strongest_n(), DeviceLimits{}.max_force_n + 1e-9);
  for (const std::string& words : visitor.words) EXPECT_EQ(words.find('{'), std::string::npos) << words;
  const std::size_t before = visitor.words.size();
  visitor.hand().press(kRight);
  ASSERT_TRUE(visitor.hears("Guide off", before)) << "the same button ends it";
  visitor.hand().press(0);
}

}  // namespace
}  // namespace sparsha::haptics

// A visitor without sight, simulated: a relaxed hand that buttons and words lead over a stone.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptics/session/session.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics::test {

using Eigen::Vector2d;
using Eigen::Vector3d;

inline constexpr std::uint64_t kRight = 1;  ///< of the grip's buttons

/// A relaxed hand of 0.15 kg on a device: the servo's force moves it across the stone, the visitor raises and lowers
/// it, pushes it and presses buttons.
class RelaxedHand final : public Device {
 public:
  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "hand";
    info.planned_time = true;
    return info;
  }
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    constexpr double kMass_kg = 0.15;
    constexpr double kDamping = 3.0;  // N s/m
    const Vector2d wish(wish_x_.load(), wish_y_.load());
    const Vector2d pull = force_n_ + kDamping * (wish - velocity_);
    velocity_ += pull * (period_s / kMass_kg);
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

/// One who knows only what is announced, and presses buttons.
class Visitor {
 public:
  /// `record`: the motors' log, run.csv; empty: none.
  explicit Visitor(const scene::ScenePointer& scene, const std::string& record = {}) {
    auto hand = std::make_unique<RelaxedHand>();
    hand_ = hand.get();
    SessionOptions options;
    options.speaks = true;
    options.real_time = false;
    options.longest_gap_s = 0.5;
    options.record = record;
    session_ = std::make_unique<Session>(scene, std::move(hand), options);
    touches_ = session_->add_contact_consumer();
    session_->start();
  }
  ~Visitor() { session_->stop(); }
  /// Lets go, and closes the motors' log.
  SessionSummary leave() { return session_->stop(); }

  /// Looks and listens until something is so; every state that it sees is kept.
  [[nodiscard]] bool wait(const std::function<bool()>& so) {
    return eventually([&] {
      session_->poll();
      for (const Announcement& a : session_->announcements().since(heard_)) {
        heard_ = a.sequence;
        words.push_back(a.text);
        if (hears_words) hears_words(a);
      }
      ContactEvent event;
      while (touches_->pop(event)) contacts.push_back(event);
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
  [[nodiscard]] RelaxedHand& hand() { return *hand_; }

  std::vector<std::string> words;
  std::vector<State> states;
  std::vector<ContactEvent> contacts;
  std::function<void(const Announcement&)> hears_words;  ///< whoever speaks them; may be empty

 private:
  RelaxedHand* hand_ = nullptr;
  std::unique_ptr<Session> session_;
  std::shared_ptr<ContactQueue> touches_;
  std::uint64_t heard_ = 0;
};

/// The direction of an hour that is said, from "... two o'clock".
inline Vector2d direction_of(const std::string& words) {
  constexpr std::array<const char*, 12> kHours{"twelve", "one",   "two",   "three", "four", "five",
                                               "six",    "seven", "eight", "nine",  "ten",  "eleven"};
  for (std::size_t hour = 0; hour < kHours.size(); ++hour)
    if (words.find(std::string(kHours[hour]) + " o'clock") != std::string::npos) {
      const double angle = 2.0 * 3.14159265358979 * static_cast<double>(hour) / 12.0;
      return {std::sin(angle), std::cos(angle)};
    }
  return Vector2d::Zero();
}

}  // namespace sparsha::haptics::test

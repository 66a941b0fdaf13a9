// The sound of a hand that strokes stone: the surface's own profile, read along the hand's path as a needle reads a
// groove, drives the modes of the material.
//
// The path comes as places at the servo's ticks. Between them the needle moves smoothly (two low-passes of 4 ms, so
// that neither ticks nor encoder steps are heard), and its height is read at every sample: waves of length l passed at
// speed v sound at v / l. How steep the path rises, times the root of the speed, is what drives the modes: power then
// grows with speed, as what friction dissipates does (van den Doel et al. 2001, FoleyAutomatic).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "audio/scrape/profile.h"
#include "audio/sound_bank.h"

namespace sparsha::audio {

/// The modes of a material under a finger, which damps them, driven by a signal. One channel; no allocation.
class ScrapeBank {
 public:
  ScrapeBank() = default;
  ScrapeBank(const Modes& modes, double sample_rate_hz);
  [[nodiscard]] double next(double in) noexcept;
  /// Lets what rings below -140 dB end. True while something rings.
  bool settle() noexcept;

 private:
  struct Band {  // trapezoidal state-variable band-pass (Zavalishin 2012)
    double warped = 0.0, damping = 0.0, normalise = 0.0, gain = 0.0;
    double state_1 = 0.0, state_2 = 0.0;
  };
  std::array<Band, kMaxPartials> bands_{};
  std::size_t count_ = 0;
};

/// One channel. After construction nothing allocates, locks or throws. One thread.
class Needle {
 public:
  /// A place of the hand on the stone.
  struct Point {
    std::uint64_t frame = 0;  ///< when it is there
    bool touching = false;
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  ///< of the proxy, grid frame; of one view with z = 0
    double press_n = 0.0;
    double press_level = 0.0;  ///< set by Needle::move
    double scale = 1.0;        ///< device metres per grid metre
    std::size_t sound = 0;     ///< index into SoundBank::scrapes
  };

  explicit Needle(const SoundBank& bank);

  /// From `frame` on. Whoever gives it keeps a share of it, so that none is freed here.
  void set_profile(std::shared_ptr<const Profile> profile, std::uint64_t frame) noexcept;
  /// In order of frames; the oldest is lost when kMostPoints wait.
  void move(const Point& point) noexcept;
  [[nodiscard]] bool sounding() const noexcept { return awake_; }
  /// Adds `count` samples from `frame` on.
  void render(double* out, std::size_t count, std::uint64_t frame) noexcept;

 private:
  static constexpr std::size_t kMostPoints = 1024;
  static constexpr std::size_t kMostProfiles = 16;
  struct Change {
    std::shared_ptr<const Profile> profile;
    std::uint64_t frame = 0;
  };

  void advance(std::uint64_t frame) noexcept;
  void seat(const Point& point) noexcept;
  void lift(std::uint64_t frame) noexcept;
  [[nodiscard]] double share_of_way(std::uint64_t frame) const noexcept;
  [[nodiscard]] Eigen::Vector3d target(double share) const noexcept;
  [[nodiscard]] double press_level(double share) const noexcept;
  [[nodiscard]] double slope(double share) noexcept;
  [[nodiscard]] double height_m(double per_sample_m) const noexcept;
  [[nodiscard]] double leaning_rise_m() const noexcept;
  [[nodiscard]] double drive_of(double rise_m, double speed) const noexcept;
  [[nodiscard]] Eigen::Vector3d on_profile_m(const Eigen::Vector3d& place_m) const noexcept;
  void find_sheet(const Eigen::Vector3d& place_m) noexcept;
  [[nodiscard]] double ring(double drive) noexcept;
  void settle() noexcept;

  const SoundBank& bank_;
  /// Never above kStrokeLevel times the press, however rough the stone: a strike is heard over every stroke.
  const double level_;
  double rate_hz_;
  double path_share_, speed_share_, press_share_, high_share_, attack_share_, release_share_;

  std::array<Point, kMostPoints> points_{};  ///< a ring
  std::size_t first_ = 0, waiting_ = 0;
  Point reached_;
  Eigen::Vector3d anchor_m_ = Eigen::Vector3d::Zero();  ///< of the last point given
  bool anchored_ = false;

  std::array<Change, kMostProfiles> changes_{};  ///< a ring; the oldest is in use
  std::size_t change_ = 0, changes_waiting_ = 0;
  std::shared_ptr<const Profile> profile_;

  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();  ///< grid frame; places below are relative to it
  bool has_origin_ = false;
  bool seated_ = false;
  bool lifted_ = false;  ///< fades out
  bool moves_ = false;
  bool awake_ = false;
  Eigen::Vector3d half_way_m_ = Eigen::Vector3d::Zero();  ///< after the first low-pass
  Eigen::Vector3d at_m_ = Eigen::Vector3d::Zero();        ///< the needle
  Eigen::Vector3d before_m_ = Eigen::Vector3d::Zero();    ///< where it was a sample before
  std::size_t sheet_ = 0;                                 ///< of the profile
  double last_height_m_ = 0.0;
  double speed_m_per_s_ = 0.0;  ///< device frame
  double press_ = 0.0;          ///< loudness of the press
  double grain_gain_ = 1.0;
  double high_1_ = 0.0, high_2_ = 0.0;  ///< what the high-pass takes away
  double power_ = 0.0;                  ///< of what comes out, before it is levelled
  std::vector<ScrapeBank> banks_;
  std::vector<double> weights_;  ///< of the drive, per bank
  std::vector<bool> ringing_;
};

}  // namespace sparsha::audio

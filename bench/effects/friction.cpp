#include "bench/effects/friction.h"

#include <algorithm>
#include <cmath>

#include "haptics/proxy/proxy.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A proxy of ours on a level plane.
class Own : public FrictionLaw {
 public:
  Own(const FrictionSetting& setting, bool paper) : setting_(setting), paper_(paper) {
    constexpr int kNodes = 41;
    surface_.lattice.nx = surface_.lattice.ny = kNodes;
    surface_.lattice.spacing_m = 0.025;
    surface_.height_m.assign(surface_.lattice.count(), 0.0F);
    surface_.mu_dynamic.assign(surface_.lattice.count(), static_cast<float>(setting.mu_dynamic));
    surface_.mu_static.assign(surface_.lattice.count(), static_cast<float>(setting.mu_static));
    surface_.highest_m = 0.0;
    middle_ = Vector2d::Constant(0.5 * surface_.width_m());
  }
  void place(const Vector2d& hand_m) override {
    state_ = haptics::start_proxy(surface_, {middle_.x() + hand_m.x(), middle_.y() + hand_m.y(), 0.0});
  }
  Vector2d update(const Vector2d& hand_m, double press_n) override {
    const Vector3d hand(middle_.x() + hand_m.x(), middle_.y() + hand_m.y(), -press_n / setting_.stiffness_n_per_m);
    const haptics::ProxyUpdate found =
        paper_ ? update_paper(surface_, hand, state_, {}) : update_exact(surface_, hand, state_, {});
    anchor_ = found.position.head<2>() - middle_;
    return setting_.stiffness_n_per_m * (anchor_ - hand_m);
  }
  Vector2d anchor() const override { return anchor_; }

 private:
  FrictionSetting setting_;
  bool paper_;
  haptics::MongeSurface surface_;
  Vector2d middle_;
  haptics::ProxyState state_;
  Vector2d anchor_ = Vector2d::Zero();
};

/// The proxy is drawn to the edge of the cone about the hand whenever it is outside. With two coefficients (`two`) the
/// static cone holds it until it is left, and the dynamic one while it slides, which ends when the proxy lies inside.
class Cone : public FrictionLaw {
 public:
  Cone(const FrictionSetting& setting, bool two) : setting_(setting), two_(two) {}
  void place(const Vector2d& hand_m) override {
    anchor_ = hand_m;
    slides_ = false;
  }
  Vector2d update(const Vector2d& hand_m, double press_n) override {
    const double depth = press_n / setting_.stiffness_n_per_m;
    const Vector2d apart = anchor_ - hand_m;
    const double length = apart.norm();
    const double dynamic = setting_.mu_dynamic * depth;
    if (two_ && !slides_) slides_ = length > setting_.mu_static * depth;
    if (!two_) slides_ = true;
    if (slides_ && length > dynamic)
      anchor_ = hand_m + apart * (dynamic / length);
    else if (slides_ && two_)
      slides_ = false;
    return setting_.stiffness_n_per_m * (anchor_ - hand_m);
  }
  Vector2d anchor() const override { return anchor_; }

 private:
  FrictionSetting setting_;
  bool two_;
  bool slides_ = false;
  Vector2d anchor_ = Vector2d::Zero();
};

/// Slides against the velocity; below `kStill_m_per_s` it is held by a spring until that pulls harder than static
/// friction. The spring starts with the force that sliding had, so that being caught is no jump.
class Karnopp : public FrictionLaw {
 public:
  explicit Karnopp(const FrictionSetting& setting) : setting_(setting) {}
  void place(const Vector2d& hand_m) override {
    anchor_ = before_ = hand_m;
    velocity_.setZero();
    holds_ = true;
  }
  Vector2d update(const Vector2d& hand_m, double press_n) override {
    velocity_ += (setting_.tick_s / kFilter_s) * ((hand_m - before_) / setting_.tick_s - velocity_);
    before_ = hand_m;
    const double k = setting_.stiffness_n_per_m;
    if (holds_) {
      const Vector2d force = k * (anchor_ - hand_m);
      if (force.norm() <= setting_.mu_static * press_n) return force;
      holds_ = false;
      slide_ = force.normalized();
    }
    if (velocity_.norm() > kStill_m_per_s) slide_ = -velocity_.normalized();
    const Vector2d force = setting_.mu_dynamic * press_n * slide_;
    anchor_ = hand_m + force / k;
    if (velocity_.norm() <= kStill_m_per_s) holds_ = true;
    return force;
  }
  Vector2d anchor() const override { return anchor_; }

 private:
  static constexpr double kFilter_s = 0.005;
  static constexpr double kStill_m_per_s = 0.005;
  FrictionSetting setting_;
  bool holds_ = true;
  Vector2d anchor_ = Vector2d::Zero();
  Vector2d before_ = Vector2d::Zero();
  Vector2d velocity_ = Vector2d::Zero();
  Vector2d slide_ = Vector2d::Zero();
};

/// Integrates over distance and not over time: z = x - w, w' = |x'| alpha(z) z, alpha 0 while stuck, 1 / z_max while
/// sliding, which never leaves z above z_max. Sliding begins beyond z_stick and ends when z has come back below
/// z_max, as it does on reversal.
class HaywardArmstrong : public FrictionLaw {
 public:
  explicit HaywardArmstrong(const FrictionSetting& setting) : setting_(setting) {}
  void place(const Vector2d& hand_m) override {
    anchor_ = before_ = hand_m;
    slides_ = false;
  }
  Vector2d update(const Vector2d& hand_m, double press_n) override {
    constexpr double kStickAgain =
        0.98;  // of z_max; at 0.9 a mass that rebounds less stays in sliding and misses a slip
    const double z_max = setting_.mu_dynamic * press_n / setting_.stiffness_n_per_m;
    const double z_stick = setting_.mu_static * press_n / setting_.stiffness_n_per_m;
    const double moved = (hand_m - before_).norm();
    before_ = hand_m;
    const Vector2d z = hand_m - anchor_;
    if (!slides_)
      slides_ = z.norm() > z_stick;
    else if (z.norm() < kStickAgain * z_max)
      slides_ = false;
    if (slides_ && z.norm() >= z_max)
      anchor_ = hand_m - z * (z_max / z.norm());
    else if (slides_)
      anchor_ += std::min(1.0, moved / z_max) * z;
    return setting_.stiffness_n_per_m * (anchor_ - hand_m);
  }
  Vector2d anchor() const override { return anchor_; }

 private:
  FrictionSetting setting_;
  bool slides_ = false;
  Vector2d anchor_ = Vector2d::Zero();
  Vector2d before_ = Vector2d::Zero();
};

/// Impedance form: Coulomb friction behind a spring and a damper, by implicit Euler, in closed form.
class Kikuuwe : public FrictionLaw {
 public:
  explicit Kikuuwe(const FrictionSetting& setting) : setting_(setting) {}
  void place(const Vector2d& hand_m) override {
    anchor_ = hand_m;
    stretch_.setZero();
  }
  Vector2d update(const Vector2d& hand_m, double press_n) override {
    const double damper = kDamping_n_s_per_m / setting_.tick_s;
    const double both = setting_.stiffness_n_per_m + damper;
    const Vector2d wanted = both * (anchor_ - hand_m) - damper * stretch_;  // as if the anchor stood still
    const double most = setting_.mu_dynamic * press_n;
    const Vector2d force = wanted.norm() > most ? Vector2d(wanted * (most / wanted.norm())) : wanted;
    stretch_ = (force + damper * stretch_) / both;
    anchor_ = hand_m + stretch_;
    return force;
  }
  Vector2d anchor() const override { return anchor_; }

 private:
  static constexpr double kDamping_n_s_per_m = 0.2;
  FrictionSetting setting_;
  Vector2d anchor_ = Vector2d::Zero();
  Vector2d stretch_ = Vector2d::Zero();  ///< anchor less hand, of the tick before
};

}  // namespace

std::vector<FrictionEntrant> all_friction_laws() {
  using Setting = FrictionSetting;
  return {
      {"ours", "docs/touch.md", true, [](const Setting& s) { return std::make_unique<Own>(s, false); }},
      {"paper", "Aniyath et al. 2014, eq. 1 to 6", true,
       [](const Setting& s) { return std::make_unique<Own>(s, true); }},
      {"cone", "Melder and Harwin, Haptics Symposium 2004", false,
       [](const Setting& s) { return std::make_unique<Cone>(s, false); }},
      {"harwin", "Harwin and Melder, Eurohaptics 2002", true,
       [](const Setting& s) { return std::make_unique<Cone>(s, true); }},
      {"karnopp", "Karnopp, J. Dyn. Syst. Meas. Control 107, 1985", true,
       [](const Setting& s) { return std::make_unique<Karnopp>(s); }},
      {"hayward-armstrong", "Hayward and Armstrong, Experimental Robotics VI, 2000", true,
       [](const Setting& s) { return std::make_unique<HaywardArmstrong>(s); }},
      {"kikuuwe", "Kikuuwe et al., IEEE Trans. Robotics 22(6), 2006", false,
       [](const Setting& s) { return std::make_unique<Kikuuwe>(s); }},
  };
}

}  // namespace sparsha::bench

// Laws of friction as an impedance device renders them: the hand's place along a plane and the press on it in, the
// force along the plane out, once a tick. Ours beside other people's.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::bench {

struct FrictionSetting {
  double stiffness_n_per_m = 800.0;
  double mu_static = 0.5;
  double mu_dynamic = 0.4;
  double tick_s = 0.001;
};

class FrictionLaw {
 public:
  FrictionLaw() = default;
  FrictionLaw(const FrictionLaw&) = delete;
  FrictionLaw& operator=(const FrictionLaw&) = delete;
  virtual ~FrictionLaw() = default;
  /// Contact begins here, without force.
  virtual void place(const Eigen::Vector2d& hand_m) = 0;
  /// Force on the hand, newtons; `press_n` > 0.
  [[nodiscard]] virtual Eigen::Vector2d update(const Eigen::Vector2d& hand_m, double press_n) = 0;
  /// Where the law holds the hand to: what must not creep.
  [[nodiscard]] virtual Eigen::Vector2d anchor() const = 0;
};

struct FrictionEntrant {
  std::string law;
  std::string source;     ///< publication
  bool two_coefficients;  ///< static above dynamic; else one, the dynamic
  std::function<std::unique_ptr<FrictionLaw>(const FrictionSetting&)> make;
};

/// ours, paper, cone (Melder and Harwin 2004), harwin (Harwin and Melder 2002), karnopp, hayward-armstrong, kikuuwe.
[[nodiscard]] std::vector<FrictionEntrant> all_friction_laws();

}  // namespace sparsha::bench

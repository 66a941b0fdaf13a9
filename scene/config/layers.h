// The configuration's blocks of what is made from the heights: `fill`, `texture`, `friction`, `levels` and `check`.
#pragma once

#include <cstdint>
#include <optional>

namespace sparsha::scene {

struct FillConfig {
  double max_gap_m = 0.005;
};

struct TextureConfig {
  enum class Method { direct, opencv };
  double sigma_space_m = 0.002;
  double sigma_range_m = 0.0005;
  Method method = Method::direct;
};

struct FrictionConfig {
  enum class Law { curvature, paper, constant };
  Law law = Law::curvature;
  double mu_static = 0.4;
  double mu_0 = 0.2;
  double mu_max = 0.9;
  double scale_m = 0.0;       ///< 0 = max(3 spacings, sigma_space)
  std::optional<double> c_m;  ///< slope of law: curvature, metres (mu per 1/m); absent = from the 95th percentile
};

struct LevelsConfig {
  int window = 200;  ///< nodes per side of the haptic window
};

struct CheckConfig {
  std::int64_t samples = 50000;  ///< 0 = all
};

}  // namespace sparsha::scene

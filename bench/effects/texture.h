// Ways to render the texture of a stone, ours and other people's: the force along a stroke and its spectrum beside that
// of the true profile.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::bench {

/// Height along x, metres: waves of 1 to 30 mm with the amplitudes of a rough stone, 0.05 mm RMS; seeded.
class Profile {
 public:
  Profile();
  [[nodiscard]] double height(double x) const;
  [[nodiscard]] double slope(double x) const;

 private:
  struct Wave {
    double k;
    double phase;
    double amplitude;
  };
  std::vector<Wave> waves_;
};

/// What is rendered: the hand `depth_m` below the mean of the profile, along x, once per tick.
struct TextureStroke {
  double depth_m = 0.0005;
  double speed_m_per_s = 0.1;
  double tick_s = 0.001;
  int ticks = 4096;

  [[nodiscard]] double length_m() const { return speed_m_per_s * tick_s * ticks; }
  [[nodiscard]] Eigen::Vector2d hand(int tick) const { return {speed_m_per_s * tick_s * tick, -depth_m}; }
};

/// Force over stiffness at the hand (x, z), metres.
class TextureMethod {
 public:
  TextureMethod() = default;
  TextureMethod(const TextureMethod&) = delete;
  TextureMethod& operator=(const TextureMethod&) = delete;
  virtual ~TextureMethod() = default;
  [[nodiscard]] virtual Eigen::Vector2d force_m(const Eigen::Vector2d& hand) = 0;
  [[nodiscard]] virtual std::size_t numbers() const = 0;  ///< stored per stroke
};

struct TextureEntrant {
  std::string method;  ///< geometry, sinusoid, fourier, wavelet
  std::string setting;
  std::string source;  ///< publication
  std::unique_ptr<TextureMethod> rendered;
};

[[nodiscard]] std::vector<TextureEntrant> all_textures(const Profile& profile, const TextureStroke& stroke);

/// Spring to the nearest point of the profile itself, by Newton's method.
[[nodiscard]] Eigen::Vector2d true_force_m(const Profile& profile, const Eigen::Vector2d& hand);

inline constexpr double kTextureBands[] = {3.0, 10.0, 30.0, 110.0};  // Hz: 33 to 10, 10 to 3.3, 3.3 to 0.9 mm

struct TextureRow {
  std::string method;
  std::string setting;
  std::string source;
  double gain[3] = {};          ///< per band: amplitude over the true one
  double coherence[3] = {};     ///< per band: share of the amplitude that is in phase with the truth, 0 to 1
  double spectrum_error = 0.0;  ///< RMS difference of amplitudes over the RMS of the true ones, all bands
  double lateral = 0.0;         ///< RMS of the force along the stroke over the true one
  double force_error = 0.0;     ///< RMS error of the force vector over the RMS of the true force's variation
  std::size_t numbers = 0;
  double tick_p50_ns = 0.0;  ///< of ticks, each the mean of sixteen in a row, best of the rounds
  double tick_p99_ns = 0.0;
  double ratio = 1.0;  ///< median over the rounds of the mean time of a tick over that of the first way
  double ratio_low = 1.0, ratio_high = 1.0;  ///< least and greatest of these
};

/// Compares two signals of one length; fills gain, coherence and spectrum_error.
void compare_spectra(const std::vector<double>& rendered, const std::vector<double>& truth, double tick_s,
                     TextureRow& row);

/// All ways; their times are taken in turns.
[[nodiscard]] std::vector<TextureRow> texture_rows();

}  // namespace sparsha::bench

// Known surfaces: a height z = f(x, y) that can be evaluated anywhere, and the back of the solid behind it.
// Local frame: x right, y up, z towards the viewer, metres; the surface covers [0, width] x [0, height].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

namespace sparsha::pipeline {

/// z = slope_x x + slope_y y.
struct PlaneForm {
  double slope_x = 0.0;  ///< 1.4826 is 56 degrees
  double slope_y = 0.0;
};
/// z = amplitude sin(2 pi x / wavelength) sin(2 pi y / wavelength).
struct SinusoidForm {
  double amplitude_m = 0.05;
  double wavelength_m = 1.0;
};
/// Smooth forms of some centimetres, V grooves and one straight step that is not aligned with any lattice.
struct AccuracyForm {
  double step_m = 0.010;
  double groove_m = 0.004;        ///< depth of the V grooves
  double groove_width_m = 0.016;  ///< from rim to rim
};
/// Rectangular bars along y on the plane z = 0, one in the middle of each pitch; when `slanted` they lean 0.3 m in x
/// per metre in y.
struct BarsForm {
  double bar_m = 0.006;  ///< height
  double width_m = 0.004;
  double pitch_m = 0.05;
  bool slanted = false;
};
/// The sandstone relief: lotus medallion, inscription, mouldings and grain; drawn for 0.36 m x 0.44 m.
struct ReliefForm {
  std::uint64_t seed = 7;
  double grain_m = 0.00012;  ///< standard deviation of the stone's grain, about
  std::string inscription = "SPARSHA";
};
/// A wall with windows, sills and string courses.
struct FacadeForm {
  double window_m = 0.16;  ///< depth of the reveals
};
/// A row of round pillars on bases before a wall: one major pillar in the middle, the minor ones evenly to both sides.
struct HallForm {
  int minor = 7;          ///< how many; the larger half stands to the left
  double major_m = 0.15;  ///< radii
  double minor_m = 0.06;
  double gap_m = 0.10;      ///< from the wall to the axis of each pillar
  double grain_m = 0.0004;  ///< standard deviation of the stone's grain, about
};
/// A figure on a plinth (statue.h), which stations scan from all sides; its height field is the front view.
struct StatueForm {};
using Form =
    std::variant<PlaneForm, SinusoidForm, AccuracyForm, BarsForm, ReliefForm, FacadeForm, HallForm, StatueForm>;

struct BackConfig {
  enum class Kind { none, rough, parallel };
  Kind kind = Kind::none;
  double depth_m = 0.06;       ///< rough: mean depth below z = 0; parallel: below the front everywhere
  double roughness_m = 0.003;  ///< rough: amplitude
  double density = 0.1;        ///< back points per front point
};

struct SurfaceConfig {
  double width_m = 1.0;
  double height_m = 1.0;
  Form form = AccuracyForm{};
  BackConfig back;
};

/// Immutable, thread-safe, cheap to copy. Heights are bit-identical on every machine.
class Surface {
 public:
  /// Throws Error{usage} for impossible values, e.g. a rough back that would come out of the front.
  explicit Surface(const SurfaceConfig& config);

  [[nodiscard]] const SurfaceConfig& config() const { return config_; }
  [[nodiscard]] double width_m() const { return config_.width_m; }
  [[nodiscard]] double height_m() const { return config_.height_m; }
  /// Whether the truth is a body with a back of its own, and no height field.
  [[nodiscard]] bool is_body() const { return std::holds_alternative<StatueForm>(config_.form); }
  /// The truth. Defined beyond the borders too.
  [[nodiscard]] double z(double x, double y) const;
  /// The back; below z(x, y). Meaningless without a back.
  [[nodiscard]] double back_z(double x, double y) const;
  /// Distance in the plane to the nearest vertical step, metres; infinite when there is none.
  [[nodiscard]] double step_distance_m(double x, double y) const;
  /// Distance in the plane to the nearest crease or step: where a smooth fit must fail; infinite when there is none.
  [[nodiscard]] double crease_distance_m(double x, double y) const;
  /// Bounds of z over the domain, not tight: {low, high}.
  [[nodiscard]] std::array<double, 2> z_range() const;
  /// Grain of the stone as reflectance, 0 to 1.
  [[nodiscard]] double reflectance(double x, double y) const;

 private:
  SurfaceConfig config_;
  std::shared_ptr<const struct ReliefDrawing> relief_;
};

}  // namespace sparsha::pipeline

#include "bench/peers/implicit.h"

#include <algorithm>
#include <cmath>

#include "bench/peers/point_tree.h"
#include "bench/peers/tracker.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

/// sum (1 - r^2 / R^2)^3 over points of a plane lattice, at `height` above the place (s, t) of a cell; in spacings.
double density_over_plane(double radius, double s, double t, double height) {
  const int reach = static_cast<int>(std::ceil(radius)) + 1;
  double sum = 0.0;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const double rest = 1.0 - ((i - s) * (i - s) + (j - t) * (j - t) + height * height) / (radius * radius);
      if (rest > 0.0) sum += rest * rest * rest;
    }
  return sum;
}

class DensityField {
 public:
  DensityField(const haptics::MongeSurface& surface, double radius_spacings)
      : tree_(surface),
        radius_m_(radius_spacings * surface.lattice.spacing_m),
        above_m_(kAbove * radius_m_),
        level_(0.5 * (density_over_plane(radius_spacings, 0.0, 0.0, kAbove * radius_spacings) +
                      density_over_plane(radius_spacings, 0.5, 0.5, kAbove * radius_spacings))) {}
  FieldValue operator()(const Vector3d& x) const {
    const double per_square = 1.0 / (radius_m_ * radius_m_);
    double density = 0.0;
    Vector3d gradient = Vector3d::Zero();  // towards more density
    tree_.visit_cube(x, radius_m_, [&](std::size_t index) {
      const Vector3d to = tree_.point(index) - x;
      const double rest = 1.0 - to.squaredNorm() * per_square;
      if (rest <= 0.0) return;
      density += rest * rest * rest;
      gradient += (6.0 * rest * rest * per_square) * to;
    });
    FieldValue value;
    const double steep = gradient.norm();
    value.near = steep > 1e-6 / radius_m_;
    if (!value.near) return value;
    value.normal = -gradient / steep;
    value.distance_m = std::clamp((level_ - density) / steep, -0.3 * radius_m_, 0.3 * radius_m_);
    return value;
  }
  [[nodiscard]] double reach_m() const { return 0.4 * radius_m_; }
  [[nodiscard]] double above_m() const { return above_m_; }
  [[nodiscard]] const PointTree& tree() const { return tree_; }

 private:
  static constexpr double kAbove = 0.4;  // of the radius: where the density is steep
  PointTree tree_;
  double radius_m_;
  double above_m_;
  double level_;
};

class Implicit : public Peer {
 public:
  Implicit(const haptics::MongeSurface& surface, const ImplicitOptions& options)
      : field_(surface, options.radius_spacings), options_{options.iterations, 1e-3} {}
  void place(const Vector3d& hand) override { tracker_.place(hand); }
  Touched update(const Vector3d& hand) override {
    tracker_.update(field_, hand, options_, field_.tree().spacing_m());
    Touched touched;
    touched.proxy = tracker_.proxy;
    const Vector3d spring = tracker_.proxy - hand;
    const double length = spring.norm();
    touched.contact = tracker_.contact && length > field_.above_m();
    if (touched.contact) {
      touched.force_m = spring * ((length - field_.above_m()) / length);
      touched.proxy = hand + touched.force_m;
    }
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return field_.tree().bytes(); }

 private:
  DensityField field_;
  TrackerOptions options_;
  Tracker<DensityField> tracker_;
};

}  // namespace

PeerPointer make_implicit(const haptics::MongeSurface& surface, const ImplicitOptions& options) {
  return std::make_unique<Implicit>(surface, options);
}

}  // namespace sparsha::bench

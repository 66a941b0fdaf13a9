#include "bench/peers/mls.h"

#include <cmath>

#include "bench/peers/point_tree.h"
#include "bench/peers/tracker.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

class MlsField {
 public:
  MlsField(const haptics::MongeSurface& surface, double width_spacings)
      : tree_(surface), width_m_(width_spacings * surface.lattice.spacing_m) {
    tree_.make_normals(kNormals * surface.lattice.spacing_m);
  }
  FieldValue operator()(const Vector3d& x) const {
    const double cut = kCut * width_m_;
    const double per_square = 1.0 / (width_m_ * width_m_);
    double weights = 0.0;
    Vector3d mean = Vector3d::Zero();
    Vector3d normal = Vector3d::Zero();
    tree_.visit_cube(x, cut, [&](std::size_t index) {
      const Vector3d out = tree_.point(index) - x;
      const double squared = out.squaredNorm();
      if (squared > cut * cut) return;
      const double weight = std::exp(-squared * per_square);
      weights += weight;
      mean += weight * out;
      normal += weight * tree_.normal(index);
    });
    FieldValue value;
    value.near = weights > 0.0;
    if (!value.near) return value;
    value.normal = normal.normalized();
    value.distance_m = -value.normal.dot(mean) / weights;
    return value;
  }
  [[nodiscard]] double reach_m() const { return 0.5 * kCut * width_m_; }
  [[nodiscard]] const PointTree& tree() const { return tree_; }

 private:
  static constexpr double kCut = 3.0;      // of the width: exp(-9)
  static constexpr double kNormals = 1.5;  // of the spacing: eight neighbours on a grid
  PointTree tree_;
  double width_m_;
};

class Mls : public Peer {
 public:
  Mls(const haptics::MongeSurface& surface, const MlsOptions& options)
      : field_(surface, options.width_spacings), options_{options.iterations, 1e-3} {}
  void place(const Vector3d& hand) override { tracker_.place(hand); }
  Touched update(const Vector3d& hand) override {
    tracker_.update(field_, hand, options_, field_.tree().spacing_m());
    Touched touched;
    touched.proxy = tracker_.proxy;
    touched.contact = tracker_.contact;
    if (touched.contact) touched.force_m = touched.proxy - hand;
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return field_.tree().bytes(); }

 private:
  MlsField field_;
  TrackerOptions options_;
  Tracker<MlsField> tracker_;
};

}  // namespace

PeerPointer make_mls(const haptics::MongeSurface& surface, const MlsOptions& options) {
  return std::make_unique<Mls>(surface, options);
}

}  // namespace sparsha::bench

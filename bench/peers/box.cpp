#include "bench/peers/box.h"

#include <algorithm>

#include "bench/peers/point_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

class Box : public Peer {
 public:
  Box(const haptics::MongeSurface& surface, const BoxOptions& options)
      : tree_(surface), half_m_(options.half_side_spacings * surface.lattice.spacing_m) {
    tree_.make_normals(1.5 * surface.lattice.spacing_m);
  }
  void place(const Vector3d&) override {}
  Touched update(const Vector3d& hand) override {
    double weights = 0.0;
    double depth = 0.0;
    Vector3d normal = Vector3d::Zero();
    tree_.visit_cube(hand, half_m_, [&](std::size_t index) {
      const Vector3d out = hand - tree_.point(index);
      const double inside = half_m_ - out.cwiseAbs().maxCoeff();
      if (inside <= 0.0) return;
      // A box counts by how far the hand is from its axis along the normal, so that a hand passing from box to box
      // feels no step.
      const Vector3d n = tree_.normal(index);
      const double below = -n.dot(out);
      const double aside = (out + below * n).squaredNorm() / (half_m_ * half_m_);
      if (aside >= 1.0) return;
      const double weight = (1.0 - aside) * (1.0 - aside) * inside;
      weights += weight;
      depth += weight * below;
      normal += weight * n;
    });
    Touched touched;
    touched.proxy = hand;
    touched.contact = weights > 0.0 && depth > 0.0;
    if (touched.contact) {
      touched.force_m = normal.normalized() * (depth / weights);
      touched.proxy += touched.force_m;
    }
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_.bytes(); }

 private:
  PointTree tree_;
  double half_m_;
};

}  // namespace

PeerPointer make_box(const haptics::MongeSurface& surface, const BoxOptions& options) {
  return std::make_unique<Box>(surface, options);
}

}  // namespace sparsha::bench

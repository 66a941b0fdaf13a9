#include "bench/peers/god_object.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "bench/peers/triangle_tree.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

/// Planes through the proxy that it may not go below.
class Constraints {
 public:
  void add(const Vector3d& normal) {
    if (count_ < kMost) normals_[count_++] = normal;
  }
  [[nodiscard]] bool full() const { return count_ == kMost; }
  /// The part of `pull` that all planes leave: its projection on the cone, by one, two or three active planes.
  [[nodiscard]] Vector3d leave(const Vector3d& pull) const {
    if (allows(pull)) return pull;
    for (int a = 0; a < count_; ++a) {
      const Vector3d slide = pull - normals_[a] * std::min(0.0, normals_[a].dot(pull));
      if (allows(slide)) return slide;
    }
    Vector3d best = Vector3d::Zero();
    for (int a = 0; a < count_; ++a)
      for (int b = 0; b < a; ++b) {
        const Vector3d line = normals_[a].cross(normals_[b]);
        if (line.squaredNorm() < 1e-20) continue;
        const Vector3d slide = line * (line.dot(pull) / line.squaredNorm());
        if (slide.dot(pull) > best.dot(pull) && allows(slide)) best = slide;
      }
    return best;
  }

 private:
  [[nodiscard]] bool allows(const Vector3d& way) const {
    return std::all_of(normals_, normals_ + count_,
                       [&way](const Vector3d& n) { return n.dot(way) >= -1e-9 * way.norm(); });
  }
  static constexpr int kMost = 8;
  Vector3d normals_[kMost];
  int count_ = 0;
};

class GodObject : public Peer {
 public:
  GodObject(const haptics::MongeSurface& surface, const GodObjectOptions& options)
      : tree_(surface),
        options_(options),
        above_m_(1e-6 * surface.lattice.spacing_m),
        still_m_(1e-4 * surface.lattice.spacing_m) {}

  void place(const Vector3d& hand) override {
    proxy_ = hand;
    last_ = {};
  }
  Touched update(const Vector3d& hand) override {
    bool contact = false;
    for (int move = 0; move < options_.moves; ++move) {
      const Vector3d start = proxy_;
      contact = slide(hand);
      if (!contact || (proxy_ - start).norm() < still_m_ || rests_) break;
    }
    Touched touched;
    touched.proxy = proxy_;
    touched.contact = contact;
    if (contact) touched.force_m = proxy_ - hand;
    return touched;
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_.bytes(); }

 private:
  /// To the first place where the constraints met so far hold the proxy. False when nothing is in its way to the hand.
  bool slide(const Vector3d& hand) {
    Constraints constraints;
    bool contact = false;
    int held_by = 0;
    rests_ = false;
    // Over the triangle of the tick before, the first hit on the way to the hand is known.
    if (last_.triangle >= 0 && last_.normal.dot(hand - proxy_) < 0.0 && is_over_last()) {
      constraints.add(last_.normal);
      contact = true;
      held_by = 1;
    }
    while (!constraints.full()) {
      const Vector3d way = constraints.leave(hand - proxy_);
      if (!(way.norm() > above_m_)) return contact;
      const TriangleTree::Hit hit = tree_.first_hit(proxy_, proxy_ + way);
      if (hit.share > 1.0) {
        proxy_ += way;
        // Slid on one triangle to the point of its plane nearest to the hand, and still on it: nothing is nearer.
        rests_ = held_by == 1 && is_over_last();
        return contact;
      }
      contact = true;
      ++held_by;
      last_ = hit;
      // Kept a little above what it touches, so that the next segment starts outside.
      proxy_ += way * hit.share + hit.normal * above_m_;
      constraints.add(hit.normal);
    }
    return contact;
  }

  [[nodiscard]] bool is_over_last() const { return tree_.is_over(last_.triangle, proxy_, 8.0 * above_m_); }

  TriangleTree tree_;
  GodObjectOptions options_;
  double above_m_;
  double still_m_;
  TriangleTree::Hit last_;
  bool rests_ = false;
  Vector3d proxy_ = Vector3d::Zero();
};

}  // namespace

PeerPointer make_god_object(const haptics::MongeSurface& surface, const GodObjectOptions& options) {
  return std::make_unique<GodObject>(surface, options);
}

}  // namespace sparsha::bench

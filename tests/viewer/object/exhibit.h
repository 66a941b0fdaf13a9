// One whole object in pictures of one size, without a window.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <epoxy/gl.h>

#include "tests/viewer/object/whole_objects.h"
#include "tests/viewer/studio.h"
#include "viewer/object/view.h"

namespace sparsha::viewer::test {

inline constexpr int kSide = 300;  // pixels of a judged picture

/// One object on the graphics card, drawn from any side.
class Exhibit {
 public:
  explicit Exhibit(const scene::Charts& charts) : target_(kSide, kSide, true, gl::Filter::nearest) {
    ThreadPool pool(2);
    const ObjectBox bounds = bounds_of(charts);
    stage_.anchor_m = 0.5 * (bounds.low_m + bounds.high_m);
    stage_.unit_m = (bounds.high_m - bounds.low_m).maxCoeff();
    view_.emplace(make_object_meshes(charts, pool), charts.origin_m, charts.spacing_m);
    spacing_m_ = charts.spacing_m;
  }

  void draw(const Camera& camera, double node_pixels, Look look = Look::sky) {
    seen_ = make_view(camera, kSide, kSide);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer());
    glViewport(0, 0, kSide, kSide);
    glDisable(GL_BLEND);
    glClearColor(0.0F, 0.0F, 1.0F, 1.0F);
    glDepthMask(GL_TRUE);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    ReliefStyle style;
    style.look = look;
    style.node_pixels = node_pixels;
    view_->draw(seen_, stage_, style, {});
    depth_.resize(kSide * kSide);
    glReadPixels(0, 0, kSide, kSide, GL_DEPTH_COMPONENT, GL_FLOAT, depth_.data());
    rgba_ = target_.read_pixels();
    glDisable(GL_DEPTH_TEST);
  }

  /// Of the ray through the pixel's middle, from its origin, metres; nothing where nothing is drawn.
  [[nodiscard]] std::optional<double> away_m(int x, int y) const {
    const float depth = depth_[static_cast<std::size_t>((kSide - 1 - y) * kSide + x)];
    if (depth >= 1.0F) return std::nullopt;
    const Eigen::Vector4d clip(2.0 * (x + 0.5) / kSide - 1.0, 1.0 - 2.0 * (y + 0.5) / kSide,
                               2.0 * static_cast<double>(depth) - 1.0, 1.0);
    const Eigen::Vector4d world = seen_.inverse * clip;
    return (stage_.to_grid_m(world.head<3>() / world.w()) - from_m(x, y)).norm();
  }
  [[nodiscard]] View::Ray ray(int x, int y) const { return seen_.ray(x + 0.5, y + 0.5); }
  [[nodiscard]] Eigen::Vector3d from_m(int x, int y) const { return stage_.to_grid_m(ray(x, y).origin); }
  [[nodiscard]] Eigen::Vector3d direction(int x, int y) const { return stage_.turn.transpose() * ray(x, y).direction; }
  [[nodiscard]] double brightness(int x, int y) const {
    const std::size_t k = 4 * static_cast<std::size_t>(y * kSide + x);
    return 0.2126 * rgba_[k] + 0.7152 * rgba_[k + 1] + 0.0722 * rgba_[k + 2];
  }
  [[nodiscard]] double pixel_m() const { return stage_.unit_m / seen_.pixels_per_unit(seen_.focus); }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }
  [[nodiscard]] Stage& stage() { return stage_; }
  [[nodiscard]] ObjectView& view() { return *view_; }

 private:
  gl::Target target_;
  Stage stage_;
  std::optional<ObjectView> view_;
  double spacing_m_ = 0.0;
  View seen_;
  std::vector<float> depth_;
  std::vector<unsigned char> rgba_;
};

}  // namespace sparsha::viewer::test

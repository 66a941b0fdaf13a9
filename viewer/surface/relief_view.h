// A piece of relief on the graphics card.
#pragma once

#include <Eigen/Core>

#include "viewer/camera.h"
#include "viewer/gl/objects.h"
#include "viewer/surface/paint.h"
#include "viewer/surface/relief_data.h"

namespace sparsha::viewer {

/// x, y of two corners: xmin ymin xmax ymax.
using Box = Eigen::Vector4d;

/// How the stone is shown.
struct ReliefStyle {
  KeyLight light;
  bool painted = false;
  bool high_contrast = false;
  bool mark_filled = false;
  bool walls = true;                ///< the slab's sides
  std::optional<Box> window_world;  ///< framed; what is outside is dimmed
  std::optional<Box> hole_world;    ///< left out, as a finer piece is drawn there
  double floor_z = 0.0;             ///< world
  int supersampling = 1;            ///< framebuffer pixels per pixel of the picture
  double node_pixels = 3.0;         ///< least framebuffer pixels between mesh vertices
};

/// Owns the textures of one piece. Needs a current context.
class ReliefView {
 public:
  ReliefView(ReliefData data, const Stage& stage);

  /// Bakes the key light's shadows again.
  void set_light(const KeyLight& light, ThreadPool& pool);
  void set_paint(const Paint& paint);
  /// Draws into the bound framebuffer and viewport; depth test and clearing are the caller's.
  void draw(const gl::Program& program, const View& view, const ReliefStyle& style) const;

  [[nodiscard]] const ReliefData& data() const { return data_; }
  [[nodiscard]] Box box_world() const { return box_; }
  [[nodiscard]] double low_world() const;
  [[nodiscard]] double high_world() const;

 private:
  void draw_chunks(const gl::Program& program, const View& view, int stride) const;

  ReliefData data_;
  Stage stage_;
  Box box_;
  double reach_low_ = 0.0;  ///< world z of all drawn nodes, continued ones included
  double reach_high_ = 0.0;
  gl::Texture heights_;
  gl::Texture slopes_;
  gl::Texture tones_;
  gl::Texture shadows_;
  gl::Texture paint_;
  gl::Name vertex_array_;
  gl::Name indices_;
};

}  // namespace sparsha::viewer

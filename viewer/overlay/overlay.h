// What moves over the stone: the proxy ball, the hand's shadow, the glow of contact, the force arrow, the stylus.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "viewer/camera/camera.h"
#include "viewer/gl/objects.h"

namespace sparsha::viewer {

/// Encoded sRGB and opacity, 0 to 1.
using Colour = Eigen::Vector4f;

/// Smooth-edged flat shapes in pixels from the viewport's top left, drawn in the order of the calls.
class Ink {
 public:
  Ink();
  /// Convex, corners in either order, a colour for each; edges fade over one pixel.
  void polygon(const std::vector<Eigen::Vector2d>& corners, const std::vector<Colour>& colours);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, const Colour& colour);
  void ring(const Eigen::Vector2d& middle, double radius, double width, const Colour& colour);
  /// Draws and forgets all shapes.
  void flush(int width, int height);

 private:
  struct Vertex {
    std::array<float, 2> position;
    std::array<float, 4> colour;
  };
  void triangle(const Vertex& a, const Vertex& b, const Vertex& c);

  std::vector<Vertex> vertices_;
  gl::Program program_;
  gl::Name vertex_array_;
  gl::Name buffer_;
};

/// The hand as the picture needs it, world coordinates.
struct Hand {
  Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit; straight up when free
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    ///< world length of the arrow
  double radius = 0.01;                               ///< of the ball
  double strength = 0.0;                              ///< of the force, 0 to 1
  bool contact = false;
  /// Of a grip whose orientation is measured: along the stylus from its tip, and to its side; zero without one.
  Eigen::Vector3d stylus = Eigen::Vector3d::Zero(), stylus_side = Eigen::Vector3d::Zero();
  Eigen::Vector3d ground = Eigen::Vector3d::Zero();  ///< of the drawn surface, straight below the ball
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     ///< from there to the ball: out of the stone

  /// The ball rests on the proxy, a point, and does not cut into the stone.
  [[nodiscard]] Eigen::Vector3d ball() const { return proxy + radius * normal; }
};

/// Draws the hand over a finished surface picture.
class HandPainter {
 public:
  HandPainter();
  /// Into the bound framebuffer, whose viewport starts at `left`, `bottom`. `depths` is the surface's depth texture,
  /// `depth_scale` times as wide as the view.
  void draw(const Hand& hand, const View& view, const gl::Texture& depths, int depth_scale, int left, int bottom,
            const Eigen::Vector3f& light, double scale);

 private:
  void arrow(const Hand& hand, const View& view, double scale);
  void stylus(const Hand& hand, const View& view, double scale);

  gl::Program decal_;
  gl::Program ball_;
  gl::Name vertex_array_;
  Ink ink_;
};

}  // namespace sparsha::viewer

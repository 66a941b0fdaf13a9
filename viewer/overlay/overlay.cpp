// The hand over the stone. Shapes are drawn in small rectangles around it, so that a frame costs little without a
// graphics card.
#include "viewer/overlay/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <epoxy/gl.h>

#include "viewer/gl/shaders.h"

namespace sparsha::viewer {
namespace {

Colour faded(const Colour& colour) { return {colour.x(), colour.y(), colour.z(), 0.0F}; }

/// Pixels from the top left to a rectangle for kRectVertex, cut to the viewport; zero size when off screen.
Eigen::Vector4f around(const Eigen::Vector2d& middle, double reach_x, double reach_y, const View& view) {
  const double x0 = std::clamp(std::floor(middle.x() - reach_x), 0.0, static_cast<double>(view.width));
  const double x1 = std::clamp(std::ceil(middle.x() + reach_x), 0.0, static_cast<double>(view.width));
  const double y0 = std::clamp(std::floor(middle.y() - reach_y), 0.0, static_cast<double>(view.height));
  const double y1 = std::clamp(std::ceil(middle.y() + reach_y), 0.0, static_cast<double>(view.height));
  return Eigen::Vector4d(x0, view.height - y1, x1 - x0, y1 - y0).cast<float>();
}

}  // namespace

Ink::Ink()
    : program_(gl::kInkVertex, gl::kInkFragment), vertex_array_(gl::make_vertex_array()), buffer_(gl::make_buffer()) {
  glBindVertexArray(vertex_array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
  // OpenGL passes the offset inside a vertex as a pointer.
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  const void* colour = reinterpret_cast<const void*>(offsetof(Vertex, colour));
  glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(Vertex), colour);
  glBindVertexArray(0);
}

void Ink::triangle(const Vertex& a, const Vertex& b, const Vertex& c) {
  vertices_.push_back(a);
  vertices_.push_back(b);
  vertices_.push_back(c);
}

void Ink::polygon(const std::vector<Eigen::Vector2d>& corners, const std::vector<Colour>& colours) {
  const std::size_t count = corners.size();
  if (count < 3 || colours.size() != count) return;
  double area = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d& p = corners[k];
    const Eigen::Vector2d& q = corners[(k + 1) % count];
    area += p.x() * q.y() - p.y() * q.x();
  }
  const double sign = area < 0.0 ? -1.0 : 1.0;
  const auto make = [](const Eigen::Vector2d& p, const Colour& c) {
    return Vertex{{static_cast<float>(p.x()), static_cast<float>(p.y())}, {c.x(), c.y(), c.z(), c.w()}};
  };
  std::vector<Vertex> inner, outer;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d before = (corners[k] - corners[(k + count - 1) % count]).normalized();
    const Eigen::Vector2d after = (corners[(k + 1) % count] - corners[k]).normalized();
    Eigen::Vector2d out = sign * Eigen::Vector2d(before.y() + after.y(), -before.x() - after.x());
    if (out.norm() > 1e-9) out.normalize();
    inner.push_back(make(corners[k] - 0.5 * out, colours[k]));
    outer.push_back(make(corners[k] + 0.5 * out, faded(colours[k])));
  }
  for (std::size_t k = 1; k + 1 < count; ++k) triangle(inner[0], inner[k], inner[k + 1]);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t n = (k + 1) % count;
    triangle(inner[k], inner[n], outer[n]);
    triangle(inner[k], outer[n], outer[k]);
  }
}

void Ink::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, const Colour& colour) {
  const Eigen::Vector2d along = to - from;
  if (along.norm() < 1e-6) return;
  const Eigen::Vector2d across = 0.5 * width * Eigen::Vector2d(-along.y(), along.x()).normalized();
  polygon({from - across, to - across, to + across, from + across}, std::vector<Colour>(4, colour));
}

void Ink::ring(const Eigen::Vector2d& middle, double radius, double width, const Colour& colour) {
  constexpr int kPieces = 40;
  const auto at = [&](int k) {
    const double angle = 2.0 * std::numbers::pi * k / kPieces;
    return Eigen::Vector2d(middle.x() + radius * std::cos(angle), middle.y() + radius * std::sin(angle));
  };
  for (int k = 0; k < kPieces; ++k) line(at(k), at(k + 1), width, colour);
}

void Ink::flush(int width, int height) {
  if (vertices_.empty()) return;
  program_.use();
  program_.set("size", Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)));
  glBindVertexArray(vertex_array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(Vertex)), vertices_.data(),
               GL_STREAM_DRAW);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
  glDisable(GL_BLEND);
  glBindVertexArray(0);
  vertices_.clear();
}

HandPainter::HandPainter()
    : decal_(gl::kRectVertex, gl::kDecalFragment),
      ball_(gl::kRectVertex, gl::kBallFragment),
      vertex_array_(gl::make_vertex_array()) {}

void HandPainter::draw(const Hand& hand, const View& view, const gl::Texture& depths, int depth_scale, int left,
                       int bottom, const Eigen::Vector3f& light, double scale) {
  const Eigen::Vector3d ball = hand.ball();
  const auto middle = view.to_pixel(ball);
  if (!middle || !ball.allFinite()) return;
  const Eigen::Vector2f origin(static_cast<float>(left), static_cast<float>(bottom));
  const Eigen::Vector2f size(static_cast<float>(view.width), static_cast<float>(view.height));
  const double pixels = view.pixels_per_unit(ball);

  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(vertex_array_.get());
  depths.bind(0);

  const auto draw_rect = [&](const gl::Program& program, const Eigen::Vector4f& rect) {
    if (rect.z() <= 0.0F || rect.w() <= 0.0F) return;
    program.set("rect", rect);
    program.set("size", size);
    program.set("origin", origin);
    program.set("depths", 0);
    program.set("depth_scale", depth_scale);
    program.set("projection", Eigen::Matrix4f(view.projection.cast<float>()));
    program.set("inverse_projection", Eigen::Matrix4f(view.inverse.cast<float>()));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  };
  decal_.use();
  decal_.set("hand", Eigen::Vector3f(ball.cast<float>()));
  decal_.set("touch", Eigen::Vector3f(hand.proxy.cast<float>()));
  decal_.set("up", Eigen::Vector3f(hand.up.cast<float>()));
  decal_.set("radius", static_cast<float>(hand.radius));
  // Stone that gives no force does not glow.
  const bool pressed = hand.contact && hand.strength > 0.0;
  decal_.set("press", pressed ? static_cast<float>(0.45 + 0.55 * hand.strength) : 0.0F);
  // The shadow falls straight down: it shows where the hand would touch. Beyond these reaches both have faded.
  const double above = std::max((ball - hand.ground).dot(hand.up) - hand.radius, 0.0);
  const double shade = 1.6 * (1.05 * hand.radius + 0.12 * above);
  const double reach = hand.contact ? std::max(3.9 * hand.radius, shade) : shade;
  if (const auto at = view.to_pixel(hand.contact ? hand.proxy : hand.ground))
    draw_rect(decal_, around(*at, pixels * reach, pixels * reach, view));

  if (hand.contact) {
    // Where the hand really is, inside the stone.
    glDisable(GL_BLEND);
    if (const auto inside = view.to_pixel(hand.hip)) {
      ink_.line(*middle, *inside, 2.0 * scale, {1.0F, 1.0F, 1.0F, 0.55F});
      ink_.ring(*inside, 4.5 * scale, 2.0 * scale, {1.0F, 1.0F, 1.0F, 0.85F});
    }
    ink_.flush(view.width, view.height);
    glEnable(GL_BLEND);
    glBindVertexArray(vertex_array_.get());
    depths.bind(0);
  }
  ball_.use();
  ball_.set("centre", Eigen::Vector3f(ball.cast<float>()));
  ball_.set("radius", static_cast<float>(hand.radius));
  ball_.set("solid", 1.0F);
  ball_.set("light", light);
  ball_.set("tint", hand.contact ? Eigen::Vector3f(0.02F, 0.30F, 0.85F) : Eigen::Vector3f(0.03F, 0.13F, 0.36F));
  draw_rect(ball_, around(*middle, 1.6 * pixels * hand.radius + 2.0, 1.6 * pixels * hand.radius + 2.0, view));
  glDisable(GL_BLEND);
  glBindVertexArray(0);
  // Seen on every colour.
  const double rim = pixels * hand.radius;
  ink_.ring(*middle, rim + 1.2 * scale, 2.4 * scale, {0.0F, 0.0F, 0.0F, 0.55F});
  ink_.ring(*middle, rim + 0.4 * scale, 1.3 * scale, {1.0F, 1.0F, 1.0F, 0.95F});

  stylus(hand, view, scale);
  arrow(hand, view, scale);
  ink_.flush(view.width, view.height);
}

// A pen that grows from the tip, and a button on its side by which its roll is seen.
void HandPainter::stylus(const Hand& hand, const View& view, double scale) {
  if (!(hand.stylus.norm() > 0.5)) return;
  constexpr double kPoint = 3.5, kLength = 16.0, kThick = 0.62, kButton = 6.0;  // ball radii
  const double pixels = view.pixels_per_unit(hand.ball()) * hand.radius;
  const auto at = [&](double along, double aside) {
    return view.to_pixel(hand.ball() + hand.radius * (along * hand.stylus + aside * hand.stylus_side));
  };
  const auto tip = at(1.0, 0.0), neck = at(kPoint, 0.0), end = at(kLength, 0.0), button = at(kButton, kThick);
  if (!tip || !neck || !end || !button) return;
  const double half = kThick * pixels;
  const Colour dark(0.03F, 0.07F, 0.14F, 0.85F), light(0.93F, 0.94F, 0.95F, 1.0F), shade(0.52F, 0.56F, 0.62F, 1.0F);
  const Eigen::Vector2d along = *end - *tip;
  if (along.norm() > 0.5) {  // else it is seen from its end
    const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
    const auto body = [&](double grow, const Colour& a, const Colour& b) {
      const Eigen::Vector2d wide = (half + grow) * across, fine = (0.25 * half + grow) * across;
      ink_.polygon({*tip - fine, *neck - wide, *neck + wide, *tip + fine}, {a, a, b, b});
      ink_.polygon({*neck - wide, *end - wide, *end + wide, *neck + wide}, {a, a, b, b});
    };
    body(1.6 * scale, dark, dark);
    body(0.0, light, shade);
  }
  ink_.ring(*end, half, 2.0 * scale, dark);
  // A button on the far side is hidden by the pen.
  if (hand.stylus_side.dot(view.eye - hand.ball()) > 0.0)
    ink_.ring(*button, std::max(0.35 * half, 1.5 * scale), 2.4 * scale, {0.85F, 0.33F, 0.10F, 1.0F});
}

void HandPainter::arrow(const Hand& hand, const View& view, double scale) {
  const double length = hand.force.norm();
  if (!hand.contact || length < 0.5 * hand.radius) return;
  const Eigen::Vector3d direction = hand.force / length;
  const auto from = view.to_pixel(hand.ball() + 1.1 * hand.radius * direction);
  const auto to = view.to_pixel(hand.ball() + (1.1 * hand.radius + length) * direction);
  if (!from || !to) return;
  const Eigen::Vector2d along = *to - *from;
  const double pixels = along.norm();
  if (pixels < 4.0 * scale) return;
  const Eigen::Vector2d forwards = along / pixels;
  const Eigen::Vector2d across(-forwards.y(), forwards.x());
  const double half = 2.6 * scale, head = std::min(15.0 * scale, 0.55 * pixels),
               wide = std::min(8.0 * scale, 0.4 * pixels);
  const Eigen::Vector2d neck = *to - head * forwards;
  const Colour dark(0.03F, 0.07F, 0.14F, 0.85F), light(1.0F, 1.0F, 1.0F, 1.0F), cool(0.70F, 0.90F, 1.0F, 1.0F);
  const auto body = [&](double grow, const Colour& a, const Colour& b) {
    const double h = half + grow, w = wide + 1.6 * grow;
    const Eigen::Vector2d start = *from - grow * forwards, back = neck - grow * forwards,
                          tip = *to + 2.2 * grow * forwards;
    ink_.polygon({start - h * across, back - h * across, back + h * across, start + h * across}, {a, a, b, b});
    ink_.polygon({back - w * across, tip, back + w * across}, {a, a, b});
  };
  body(1.6 * scale, dark, dark);
  body(0.0, light, cool);
}

}  // namespace sparsha::viewer

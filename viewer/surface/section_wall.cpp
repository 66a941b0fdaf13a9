// The line in which the plane meets the lattice, sampled; one strip for each stretch of known surface.
#include "viewer/surface/section_wall.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "viewer/gl/shaders.h"

namespace sparsha::viewer {
namespace {

constexpr int kSamples = 1024;
constexpr double kUpright = 0.05;  // largest z of the normal

/// Parameters between which point + t * along lies in the box; first > second: nowhere.
std::pair<double, double> clip(const Eigen::Vector2d& point, const Eigen::Vector2d& along, const Eigen::Vector4d& box) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    if (std::abs(along[axis]) < 1e-12) {
      if (point[axis] < box[axis] || point[axis] > box[axis + 2]) return {1.0, 0.0};
      continue;
    }
    const double a = (box[axis] - point[axis]) / along[axis], b = (box[axis + 2] - point[axis]) / along[axis];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return {low, high};
}

}  // namespace

SectionWall::SectionWall()
    : program_(gl::kSectionVertex, gl::kSectionFragment),
      vertex_array_(gl::make_vertex_array()),
      buffer_(gl::make_buffer()) {
  glBindVertexArray(vertex_array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 4 * sizeof(float), nullptr);
  glBindVertexArray(0);
}

void SectionWall::draw(const CutPlane& plane, const Eigen::Vector4d& box, double floor_z, const Height& height,
                       const View& view, bool plain, int pixel) {
  if (std::abs(plane.normal.z()) > kUpright) return;
  const Eigen::Vector2d across = plane.normal.head<2>() / plane.normal.head<2>().squaredNorm();
  const Eigen::Vector2d point = plane.offset * across;
  const Eigen::Vector2d along = Eigen::Vector2d(-across.y(), across.x()).normalized();
  const auto [first, last] = clip(point, along, box);
  if (!(first < last)) return;

  std::vector<float> vertices;              // x y z, and the height of the surface above
  std::vector<std::pair<int, int>> strips;  // first vertex and count
  int begin = 0;
  const auto finish = [&] {
    const int end = static_cast<int>(vertices.size() / 4);
    if (end - begin >= 4) strips.emplace_back(begin, end - begin);
    begin = end;
  };
  for (int k = 0; k <= kSamples; ++k) {
    const Eigen::Vector2d p = point + (first + (last - first) * k / kSamples) * along;
    const double z = height(p.x(), p.y());
    if (!std::isfinite(z)) {
      finish();
      continue;
    }
    for (const double end : {z, std::min(floor_z, z)})
      for (const double value : {p.x(), p.y(), end, z}) vertices.push_back(static_cast<float>(value));
  }
  finish();
  if (strips.empty()) return;

  program_.use();
  program_.set("projection", Eigen::Matrix4f(view.projection.cast<float>()));
  program_.set("pixel", static_cast<float>(pixel));
  program_.set("plain", plain ? 1 : 0);
  glBindVertexArray(vertex_array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.get());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(float)), vertices.data(),
               GL_STREAM_DRAW);
  for (const auto& [start, count] : strips) glDrawArrays(GL_TRIANGLE_STRIP, start, count);
  glBindVertexArray(0);
}

}  // namespace sparsha::viewer

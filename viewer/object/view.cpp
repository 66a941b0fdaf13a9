// Vertices go to the graphics card once; a picture draws the level that its pixels can show, block by block.
#include "viewer/object/view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include <epoxy/gl.h>

#include <Eigen/LU>

#include "base/numbers/statistics.h"
#include "viewer/gl/shaders.h"

namespace sparsha::viewer {
namespace {

/// As the graphics card reads it.
struct Vertex {
  std::array<float, 3> place;
  std::array<std::int16_t, 4> normal;  ///< of 32767; the last one pads
  std::array<std::uint8_t, 4> tone;    ///< sky light, curvature (128 flat); two pad
};

std::uint8_t to_byte(float share) { return static_cast<std::uint8_t>(255.0F * std::clamp(share, 0.0F, 1.0F) + 0.5F); }

void fill(unsigned target, const gl::Name& buffer, const void* data, std::size_t bytes) {
  glBindBuffer(target, buffer.get());
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
}

/// OpenGL passes the offset inside a buffer as a pointer.
const void* offset(std::size_t bytes) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

ObjectView::ObjectView(std::vector<ObjectMesh> meshes, const Eigen::Vector3d& origin_m, double spacing_m)
    : meshes_(std::move(meshes)), origin_m_(origin_m), spacing_m_(spacing_m) {
  // Ridges and grooves are told from what is usual on this object; what noise makes of a flat one is not drawn.
  constexpr float kLeastCurvature = 0.04F;  // per spacing
  constexpr double kMost = 0.85;
  const std::vector<float>& all = finest().curvature;
  std::vector<float> some;
  const std::size_t stride = std::max<std::size_t>(1, all.size() / 16384);
  for (std::size_t k = 0; k < all.size(); k += stride) some.push_back(all[k]);
  middle_curvature_ = median(some);
  for (float& c : some) c = std::abs(c - middle_curvature_);
  typical_curvature_ = std::max(quantile(some, kMost), kLeastCurvature);
  buffers_.resize(meshes_.size());
  for (std::size_t level = 0; level < meshes_.size(); ++level) upload(level);
}

void ObjectView::upload(std::size_t level) {
  const ObjectMesh& mesh = meshes_[level];
  std::vector<Vertex> vertices(mesh.place.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    Vertex& vertex = vertices[v];
    for (int axis = 0; axis < 3; ++axis) {
      vertex.place[static_cast<std::size_t>(axis)] = mesh.place[v][axis];
      vertex.normal[static_cast<std::size_t>(axis)] =
          static_cast<std::int16_t>(std::lround(32767.0F * std::clamp(mesh.normal[v][axis], -1.0F, 1.0F)));
    }
    const float bend = (mesh.curvature[v] - middle_curvature_) / typical_curvature_;
    vertex.tone = {to_byte(mesh.sky[v]), to_byte(0.5F + 0.5F * bend / std::sqrt(1.0F + bend * bend)), 0, 0};
  }
  Buffers& buffers = buffers_[level];
  buffers.vertex_array = gl::make_vertex_array();
  buffers.vertices = gl::make_buffer();
  buffers.paint = gl::make_buffer();
  buffers.indices = gl::make_buffer();
  glBindVertexArray(buffers.vertex_array.get());
  fill(GL_ARRAY_BUFFER, buffers.vertices, vertices.data(), vertices.size() * sizeof(Vertex));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glEnableVertexAttribArray(2);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, place)));
  glVertexAttribPointer(1, 3, GL_SHORT, GL_TRUE, sizeof(Vertex), offset(offsetof(Vertex, normal)));
  glVertexAttribPointer(2, 2, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Vertex), offset(offsetof(Vertex, tone)));
  fill(GL_ELEMENT_ARRAY_BUFFER, buffers.indices, mesh.indices.data(), mesh.indices.size() * sizeof(mesh.indices[0]));
  glBindVertexArray(0);
}

void ObjectView::set_paint(const Paint& paint) {
  painted_ = !paint.rgba.empty();
  if (!painted_) return;
  std::vector<std::uint8_t> rgba = paint.rgba;
  for (std::size_t level = 0; level < meshes_.size(); ++level) {
    glBindVertexArray(buffers_[level].vertex_array.get());
    fill(GL_ARRAY_BUFFER, buffers_[level].paint, rgba.data(), rgba.size());
    glEnableVertexAttribArray(3);
    glVertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, nullptr);
    if (level + 1 == meshes_.size()) break;
    // Means of what has a colour.
    const std::vector<std::uint32_t>& coarser = meshes_[level].coarser;
    std::vector<std::array<float, 5>> sum(meshes_[level + 1].place.size(), {0, 0, 0, 0, 0});
    for (std::size_t v = 0; v < coarser.size(); ++v) {
      std::array<float, 5>& to = sum[coarser[v]];
      const float weight = rgba[4 * v + 3];
      for (std::size_t c = 0; c < 3; ++c) to[c] += weight * rgba[4 * v + c];
      to[3] += weight;
      to[4] += 1.0F;
    }
    rgba.assign(4 * sum.size(), 0);
    for (std::size_t w = 0; w < sum.size(); ++w) {
      const std::array<float, 5>& from = sum[w];
      for (std::size_t c = 0; c < 3; ++c)
        rgba[4 * w + c] = static_cast<std::uint8_t>(from[c] / std::max(from[3], 1.0F) + 0.5F);
      rgba[4 * w + 3] = static_cast<std::uint8_t>(from[3] / std::max(from[4], 1.0F) + 0.5F);
    }
  }
  glBindVertexArray(0);
}

const gl::Program& ObjectView::program(const ReliefStyle& style) {
  const bool clay = style.look == Look::clay, contour = style.contour_m > 0.0, section = style.section.has_value();
  const unsigned features = (clay ? 1U : 0U) | (contour ? 2U : 0U) | (section ? 4U : 0U);
  const auto [found, added] = programs_.try_emplace(features);
  if (added) {
    std::string head = gl::kVersion;
    if (clay) head += "#define WITH_CLAY\n";
    if (contour) head += "#define WITH_CONTOUR\n";
    if (section) head += "#define WITH_SECTION\n";
    found->second = gl::Program(head + gl::kObjectVertex, head + gl::kStoneLight + gl::kObjectFragment);
  }
  return found->second;
}

void ObjectView::set_up(const gl::Program& program, const View& view, const Stage& stage, const ReliefStyle& style,
                        const KeyLight& light) const {
  program.use();
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  world.topLeftCorner<3, 3>() = spacing_m_ / stage.unit_m * stage.turn;
  world.topRightCorner<3, 1>() = stage.to_world(origin_m_);
  const auto set = [&](const char* name, const Eigen::Vector3d& vector) {
    program.set(name, Eigen::Vector3f(vector.cast<float>()));
  };
  program.set("object", Eigen::Matrix4f(world.cast<float>()));
  program.set("projection", Eigen::Matrix4f(view.projection.cast<float>()));
  set("eye", view.parallel ? Eigen::Vector3d(view.axes.col(2)) : view.eye);
  set("light", view.axes * light.direction());
  set("right", view.axes.col(0));
  set("up", view.axes.col(1));
  set("back", view.axes.col(2));
  program.set("parallel", view.parallel ? 1 : 0);
  program.set("painted", painted_ ? 1 : 0);
  program.set("plain", style.high_contrast ? 1 : 0);
  program.set("look", static_cast<int>(style.look));
  program.set("pixel", static_cast<float>(style.supersampling));
  if (style.section)
    program.set("section", Eigen::Vector4f(Eigen::Vector4d(style.section->normal.x(), style.section->normal.y(),
                                                           style.section->normal.z(), style.section->offset)
                                               .cast<float>()));
  if (style.contour_m > 0.0) {
    // Along the grid frame's z, however the object is turned.
    const Eigen::Vector3d z = stage.turn.col(2);
    program.set("contour", Eigen::Vector4f(Eigen::Vector4d(z.x(), z.y(), z.z(), style.datum_z).cast<float>()));
    program.set("contour_step", static_cast<float>(style.contour_m / stage.unit_m));
  }
}

void ObjectView::draw_chunks(const ObjectMesh& mesh, const View& view, const Stage& stage) {
  const Eigen::Matrix3d spread = (spacing_m_ / stage.unit_m * stage.turn).cwiseAbs();
  // Neighbours in the list are drawn together.
  std::size_t first = 0;
  std::size_t count = 0;
  const auto flush = [&] {
    if (count > 0)
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, offset(first * sizeof(std::uint32_t)));
    drawn_triangles_ += count / 3;
    count = 0;
  };
  for (const ObjectMesh::Chunk& chunk : mesh.chunks) {
    const Eigen::Vector3d middle = (0.5F * (chunk.low + chunk.high)).cast<double>();
    const Eigen::Vector3d half = spread * (0.5F * (chunk.high - chunk.low)).cast<double>();
    const Eigen::Vector3d world = stage.to_world(origin_m_ + spacing_m_ * middle);
    if (view.misses(world - half, world + half)) {
      flush();
      continue;
    }
    if (count == 0) first = chunk.first;
    count += chunk.count;
  }
  flush();
}

void ObjectView::draw(const View& view, const Stage& stage, const ReliefStyle& style, const KeyLight& light) {
  // A vertex every few pixels at the middle of the picture is enough.
  const double pixels = std::max(view.pixels_per_unit(view.focus) * spacing_m_ / stage.unit_m, 1e-9);
  const int level = std::clamp(static_cast<int>(std::lround(std::log2(std::max(style.node_pixels / pixels, 1e-9)))), 0,
                               static_cast<int>(meshes_.size()) - 1);
  drawn_triangles_ = 0;
  set_up(program(style), view, stage, style, light);
  glBindVertexArray(buffers_[static_cast<std::size_t>(level)].vertex_array.get());
  draw_chunks(meshes_[static_cast<std::size_t>(level)], view, stage);
  glBindVertexArray(0);
}

ObjectView::Nearest ObjectView::nearest(const Eigen::Vector3d& place_m) const {
  const ObjectMesh& mesh = meshes_.back();
  const Eigen::Vector3f place = ((place_m - origin_m_) / spacing_m_).cast<float>();
  std::size_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t v = 0; v < mesh.place.size(); ++v) {
    const float distance = (mesh.place[v] - place).squaredNorm();
    if (distance < least) least = distance, best = v;
  }
  const Eigen::Vector3f normal = mesh.normal[best];
  const Eigen::Vector3f on = place - normal * normal.dot(place - mesh.place[best]);
  return {origin_m_ + spacing_m_ * on.cast<double>(), normal.cast<double>()};
}

}  // namespace sparsha::viewer

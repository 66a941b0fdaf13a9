// Indices name nodes; their positions come from a texture.
#include "viewer/surface/relief_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include "viewer/gl/shaders.h"

namespace sparsha::viewer {
namespace {

constexpr double kSlabShare = 0.95;   // of the border's nodes are known
constexpr double kSlabHeight = 0.35;  // of the longer side: deeper forms are no slabs

/// What of a rectangle lies outside a hole in it, as at most four rectangles: left and right of it, below and above it.
std::array<Box, 4> around_hole(const Box& box, const Box& hole) {
  const double x0 = std::clamp(hole[0], box[0], box[2]), x1 = std::clamp(hole[2], box[0], box[2]);
  const double y0 = std::clamp(hole[1], box[1], box[3]), y1 = std::clamp(hole[3], box[1], box[3]);
  return {Box(box[0], box[1], x0, box[3]), Box(x1, box[1], box[2], box[3]), Box(x0, box[1], x1, y0),
          Box(x0, y1, x1, box[3])};
}

}  // namespace

const gl::Program& ReliefPrograms::with(unsigned features) {
  const auto [found, added] = programs_.try_emplace(features);
  if (added) {
    std::string head = gl::kVersion;
    constexpr std::array kNames{"WALL",         "WITH_UNKNOWN", "WITH_FILLED",  "WITH_WINDOW", "WITH_HOLE",
                                "WITH_OUTLINE", "WITH_CLAY",    "WITH_CONTOUR", "WITH_SECTION"};
    for (std::size_t k = 0; k < kNames.size(); ++k)
      if ((features >> k & 1U) != 0) head += std::string("#define ") + kNames[k] + "\n";
    const bool clay = (features & kClay) != 0;
    found->second = gl::Program(head + gl::kReliefVertex, head + (clay ? gl::kStoneLight : "") + gl::kReliefFragment);
  }
  return found->second;
}

ReliefView::ReliefView(ReliefData data, const Stage& stage)
    : data_(std::move(data)), stage_(stage), cells_(data_.joints) {
  const scene::Lattice& lattice = data_.lattice;
  const Eigen::Vector3d low = stage_.to_world(lattice.origin_m);
  const double spacing = lattice.spacing_m / stage_.unit_m;
  box_ = Box(low.x(), low.y(), low.x() + (lattice.nx - 1) * spacing, low.y() + (lattice.ny - 1) * spacing);
  const auto [least, most] = std::ranges::minmax(data_.height_m);
  reach_low_ = low.z() + least / stage_.unit_m;
  reach_high_ = low.z() + most / stage_.unit_m;

  using gl::Filter, gl::Format;
  std::vector<float> both(2 * lattice.count());
  for (std::size_t k = 0; k < lattice.count(); ++k) {
    both[2 * k] = data_.height_m[k];
    both[2 * k + 1] = data_.joints.far_m[k];
  }
  heights_ = gl::Texture(lattice.nx, lattice.ny, Format::rg32f, Filter::nearest, both.data());
  slopes_ = gl::Texture(lattice.nx, lattice.ny, Format::rg16f, Filter::linear, data_.slope.data());
  tones_ = gl::Texture(lattice.nx, lattice.ny, Format::rgba8, Filter::linear, data_.tone.data());
  const std::vector<std::uint8_t> lit(lattice.count(), 255);
  shadows_ = gl::Texture(lattice.nx, lattice.ny, Format::r8, Filter::linear, lit.data());
  const std::array<std::uint8_t, 4> none{};
  paint_ = gl::Texture(1, 1, Format::srgb8, Filter::linear, none.data());

  vertex_array_ = gl::make_vertex_array();
}

const ReliefView::Triangles& ReliefView::mesh(int level) const {
  const auto [found, added] = meshes_.try_emplace(level);
  Triangles& triangles = found->second;
  if (!added) return triangles;
  Mesh mesh = cells_.mesh(level, data_.joints, data_.height_m);
  triangles.chunks = std::move(mesh.chunks);
  triangles.indices = gl::make_buffer();
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, triangles.indices.get());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(mesh.indices[0])),
               mesh.indices.data(), GL_STATIC_DRAW);
  return triangles;
}

void ReliefView::set_light(const KeyLight& light, ThreadPool& pool, bool fine) {
  light_ = light;
  shadows_.upload(bake_shadow(data_, light, pool, fine).data());
}

void ReliefView::set_paint(const Paint& paint) {
  painted_ = !paint.rgba.empty();
  if (!painted_) return;
  if (paint_.width() != data_.lattice.nx || paint_.height() != data_.lattice.ny)
    paint_ = gl::Texture(data_.lattice.nx, data_.lattice.ny, gl::Format::srgb8, gl::Filter::linear, paint.rgba.data());
  else
    paint_.upload(paint.rgba.data());
}

void ReliefView::light_stone(const gl::Program& program, bool high_contrast, Look look) {
  const scene::Lattice& lattice = data_.lattice;
  if (!stone_) {
    // Small pieces are magnified: between nodes, light follows the interpolated slope.
    const int factor = lattice.count() <= (std::size_t{1} << 19) || !gl::is_software() ? 2 : 1;
    const int limit = gl::max_texture_size();
    const bool fits = factor * lattice.nx <= limit && factor * lattice.ny <= limit;
    stone_ = gl::Target(lattice.nx * (fits ? factor : 1), lattice.ny * (fits ? factor : 1), false, gl::Filter::mipmap);
  }
  program.use();
  slopes_.bind(1);
  tones_.bind(2);
  shadows_.bind(3);
  paint_.bind(4);
  program.set("slopes", 1);
  program.set("tones", 2);
  program.set("shadows", 3);
  program.set("paint", 4);
  program.set("painted", painted_ ? 1 : 0);
  program.set("plain", high_contrast ? 1 : 0);
  program.set("light", Eigen::Vector3f(light_.direction().cast<float>()));
  program.set("relief_gain", relief_gain());
  program.set("look", static_cast<int>(look));
  glBindFramebuffer(GL_FRAMEBUFFER, stone_.framebuffer());
  glViewport(0, 0, stone_.width(), stone_.height());
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(vertex_array_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  stone_.colour().make_mipmaps();
}

float ReliefView::relief_gain() const {
  return static_cast<float>(std::clamp(0.22 / std::max(data_.rms_slope, 1e-9), 1.0, 3.0));
}

double ReliefView::low_world() const { return (data_.height_min_m - stage_.anchor_m.z()) / stage_.unit_m; }
double ReliefView::high_world() const { return (data_.height_max_m - stage_.anchor_m.z()) / stage_.unit_m; }

bool ReliefView::is_slab() const {
  return data_.border_known >= kSlabShare && high_world() - low_world() <= kSlabHeight;
}

void ReliefView::draw_chunks(const Triangles& mesh, const View& view, const ReliefStyle& style) const {
  const double spacing = data_.lattice.spacing_m / stage_.unit_m;
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.get());
  // Neighbours in the list are drawn together.
  std::uintptr_t first = 0;
  std::uint32_t count = 0;
  const auto flush = [&] {
    if (count == 0) return;
    // OpenGL passes the offset inside a buffer as a pointer.
    // NOLINTNEXTLINE(performance-no-int-to-ptr)
    const void* offset = reinterpret_cast<const void*>(first * sizeof(std::uint32_t));
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, offset);
    count = 0;
  };
  for (const Mesh::Chunk& chunk : mesh.chunks) {
    const double x0 = box_[0] + chunk.nodes[0] * spacing, y0 = box_[1] + chunk.nodes[1] * spacing;
    const double x1 = box_[0] + chunk.nodes[2] * spacing, y1 = box_[1] + chunk.nodes[3] * spacing;
    // What is left out inside the hole would be discarded pixel by pixel.
    const auto unseen = [&](const Box& box) {
      return view.misses({box[0], box[1], reach_low_}, {box[2], box[3], reach_high_});
    };
    const auto nothing = [&](const Box& box) { return !(box[0] < box[2] && box[1] < box[3]) || unseen(box); };
    const Box box(x0, y0, x1, y1);
    if (unseen(box) || (style.hole_world && std::ranges::all_of(around_hole(box, *style.hole_world), nothing))) {
      flush();
      continue;
    }
    if (count == 0) first = chunk.first;
    count = chunk.first + chunk.count - static_cast<std::uint32_t>(first);
  }
  flush();
}

void ReliefView::set_up(const gl::Program& program, const View& view, const ReliefStyle& style, int stride) const {
  const scene::Lattice& lattice = data_.lattice;
  const double spacing = lattice.spacing_m / stage_.unit_m;
  const Eigen::Vector3d low = stage_.to_world(lattice.origin_m);
  program.use();
  stone_.colour().mix_levels(!style.moving);
  heights_.bind(0);
  stone_.colour().bind(1);
  tones_.bind(2);
  program.set("heights", 0);
  program.set("stone", 1);
  program.set("tones", 2);
  program.set_pair("nodes", lattice.nx, lattice.ny);
  program.set("corner", Eigen::Vector2f(static_cast<float>(low.x()), static_cast<float>(low.y())));
  program.set("spacing", static_cast<float>(spacing));
  program.set("rise", Eigen::Vector2f(static_cast<float>(low.z()), static_cast<float>(1.0 / stage_.unit_m)));
  program.set("floor_z", static_cast<float>(style.floor_z));
  program.set("projection", Eigen::Matrix4f(view.projection.cast<float>()));
  program.set("plain", style.high_contrast ? 1 : 0);
  program.set("pixel", static_cast<float>(style.supersampling));
  program.set("light", Eigen::Vector3f(light_.direction().cast<float>()));
  const Box none = Box::Zero();
  program.set("window", Eigen::Vector4f(style.window_world.value_or(none).cast<float>()));
  program.set("hole", Eigen::Vector4f(style.hole_world.value_or(none).cast<float>()));

  program.set("stride", stride);
  if (style.section)
    program.set("section", Eigen::Vector4f(Eigen::Vector4d(style.section->normal.x(), style.section->normal.y(),
                                                           style.section->normal.z(), style.section->offset)
                                               .cast<float>()));
  if (style.contour_m > 0.0) {
    // Steps above the lowest known height of the scene, so that pieces of one scene agree.
    const double datum_m = stage_.to_grid_m({0.0, 0.0, style.datum_z}).z() - lattice.origin_m.z();
    program.set("contour", Eigen::Vector2f(static_cast<float>(datum_m), static_cast<float>(1.0 / style.contour_m)));
  }
  if (style.look == Look::clay) {
    slopes_.bind(3);
    paint_.bind(4);
    program.set("slopes", 3);
    program.set("paint", 4);
    program.set("painted", painted_ ? 1 : 0);
    program.set("relief_gain", relief_gain());
    program.set("right", Eigen::Vector3f(view.axes.col(0).cast<float>()));
    program.set("up", Eigen::Vector3f(view.axes.col(1).cast<float>()));
    program.set("back", Eigen::Vector3f(view.axes.col(2).cast<float>()));
  }
}

void ReliefView::draw(ReliefPrograms& programs, const View& view, const ReliefStyle& style) const {
  const scene::Lattice& lattice = data_.lattice;
  // A vertex every few pixels at the middle of the picture is enough: forms between them are in the stone's colour.
  const double pixels = std::max(view.pixels_per_unit(view.focus) * lattice.spacing_m / stage_.unit_m, 1e-9);
  const int level = std::clamp(static_cast<int>(std::lround(std::log2(std::max(style.node_pixels / pixels, 1e-9)))), 0,
                               cells_.levels() - 1);

  glBindVertexArray(vertex_array_.get());
  const unsigned base = (data_.any_unknown ? ReliefPrograms::kUnknown : 0U) |
                        (style.hole_world ? ReliefPrograms::kHole : 0U) |
                        (style.section ? ReliefPrograms::kSection : 0U);
  const gl::Program& top = programs.with(base | (style.mark_filled && data_.any_filled ? ReliefPrograms::kFilled : 0U) |
                                         (style.window_world ? ReliefPrograms::kWindow : 0U) |
                                         (style.outline && data_.any_unknown ? ReliefPrograms::kOutline : 0U) |
                                         (style.look == Look::clay ? ReliefPrograms::kClay : 0U) |
                                         (style.contour_m > 0.0 ? ReliefPrograms::kContour : 0U));
  set_up(top, view, style, 1);
  draw_chunks(mesh(level), view, style);
  if (style.walls && is_slab()) {
    const int stride = 1 << level;
    set_up(programs.with(base | ReliefPrograms::kWall), view, style, stride);
    const int cells_x = (lattice.nx - 1 + stride - 1) / stride, cells_y = (lattice.ny - 1 + stride - 1) / stride;
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 2 * (2 * (cells_x + cells_y) + 4));
  }
  glBindVertexArray(0);
}

}  // namespace sparsha::viewer

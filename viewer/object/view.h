// A whole object on the graphics card.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "viewer/camera/camera.h"
#include "viewer/gl/objects.h"
#include "viewer/object/mesh.h"
#include "viewer/surface/paint.h"
#include "viewer/surface/relief_view.h"

namespace sparsha::viewer {

/// Owns the buffers of all levels. Needs a current context.
class ObjectView {
 public:
  /// `meshes` as make_object_meshes() gives them, not empty; `origin_m`: the charts', grid frame.
  ObjectView(std::vector<ObjectMesh> meshes, const Eigen::Vector3d& origin_m, double spacing_m);

  /// One colour for each vertex of the finest level; an empty paint: bare stone.
  void set_paint(const Paint& paint);
  /// Draws into the bound framebuffer and viewport; depth test and clearing are the caller's. `light`: relative to the
  /// picture, as if that were the grid frame's x and y.
  void draw(const View& view, const Stage& stage, const ReliefStyle& style, const KeyLight& light);

  [[nodiscard]] const ObjectMesh& finest() const { return meshes_.front(); }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }  ///< of the charts
  /// Of a vertex of the finest level.
  [[nodiscard]] Eigen::Vector3d place_m(std::size_t vertex) const {
    return origin_m_ + spacing_m_ * finest().place[vertex].cast<double>();
  }

  /// The nearest place of the surface, nearly: of a level with few thousand vertices, on the plane of the nearest one.
  struct Nearest {
    Eigen::Vector3d place_m;  ///< grid frame
    Eigen::Vector3d normal;
  };
  [[nodiscard]] Nearest nearest(const Eigen::Vector3d& place_m) const;
  /// Triangles that the last draw() has given to the graphics card.
  [[nodiscard]] std::size_t drawn_triangles() const { return drawn_triangles_; }

 private:
  /// One level on the graphics card.
  struct Buffers {
    gl::Name vertex_array, vertices, paint, indices;
  };
  void upload(std::size_t level);
  [[nodiscard]] const gl::Program& program(const ReliefStyle& style);
  void set_up(const gl::Program& program, const View& view, const Stage& stage, const ReliefStyle& style,
              const KeyLight& light) const;
  void draw_chunks(const ObjectMesh& mesh, const View& view, const Stage& stage);

  std::vector<ObjectMesh> meshes_;
  Eigen::Vector3d origin_m_;
  double spacing_m_;
  float middle_curvature_ = 0.0F, typical_curvature_ = 1.0F;
  std::vector<Buffers> buffers_;
  bool painted_ = false;
  std::size_t drawn_triangles_ = 0;
  std::unordered_map<unsigned, gl::Program> programs_;
};

}  // namespace sparsha::viewer

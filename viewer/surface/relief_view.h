// A piece of relief on the graphics card.
#pragma once

#include <optional>
#include <unordered_map>

#include <Eigen/Core>

#include "viewer/camera/camera.h"
#include "viewer/gl/objects.h"
#include "viewer/surface/look.h"
#include "viewer/surface/mesh.h"
#include "viewer/surface/paint.h"
#include "viewer/surface/relief_data.h"
#include "viewer/surface/section_wall.h"

namespace sparsha::viewer {

/// x, y of two corners: xmin ymin xmax ymax.
using Box = Eigen::Vector4d;

/// How the stone is shown.
struct ReliefStyle {
  bool high_contrast = false;
  bool mark_filled = false;
  bool outline = false;  ///< a faint line around what was measured
  Look look = Look::stone;
  double contour_m = 0.0;           ///< step of contour lines above the lowest known height; 0: none
  std::optional<CutPlane> section;  ///< what lies before it is left out
  bool walls = true;                ///< the slab's sides
  std::optional<Box> window_world;  ///< framed; what is outside is dimmed
  std::optional<Box> hole_world;    ///< left out, as a finer piece is drawn there
  double floor_z = 0.0;             ///< world
  double datum_z = 0.0;             ///< world: where contour lines count from
  int supersampling = 1;            ///< framebuffer pixels per pixel of the picture
  double node_pixels = 3.0;         ///< least framebuffer pixels between mesh vertices
  bool moving = false;              ///< colours from one level of detail, not from two: quicker without a graphics card
};

/// The relief's program in the variants that pictures have needed so far.
class ReliefPrograms {
 public:
  enum Feature : unsigned {
    kWall = 1,
    kUnknown = 2,
    kFilled = 4,
    kWindow = 8,
    kHole = 16,
    kOutline = 32,
    kClay = 64,
    kContour = 128,
    kSection = 256
  };
  /// Compiles on first use.
  [[nodiscard]] const gl::Program& with(unsigned features);

 private:
  std::unordered_map<unsigned, gl::Program> programs_;
};

/// Owns the textures of one piece. Needs a current context.
class ReliefView {
 public:
  ReliefView(ReliefData data, const Stage& stage);

  /// Bakes the key light's shadows again; not `fine`: with hard edges, at a fifth of the cost.
  void set_light(const KeyLight& light, ThreadPool& pool, bool fine = true);
  /// An empty paint: bare stone.
  void set_paint(const Paint& paint);
  /// Computes the stone's colour, to be called after changes of light, paint or contrast; `program` is made of
  /// kWholeVertex and kStoneFragment. Leaves another framebuffer and viewport bound.
  void light_stone(const gl::Program& program, bool high_contrast, Look look);
  /// Draws into the bound framebuffer and viewport; depth test and clearing are the caller's.
  void draw(ReliefPrograms& programs, const View& view, const ReliefStyle& style) const;

  [[nodiscard]] const ReliefData& data() const { return data_; }
  [[nodiscard]] Box box_world() const { return box_; }
  /// True for a slab of stone whose sides may be drawn: a relief that fills its rectangle.
  [[nodiscard]] bool is_slab() const;
  [[nodiscard]] double low_world() const;
  [[nodiscard]] double high_world() const;

 private:
  /// A mesh on the graphics card.
  struct Triangles {
    std::vector<Mesh::Chunk> chunks;
    gl::Name indices;
  };
  void set_up(const gl::Program& program, const View& view, const ReliefStyle& style, int stride) const;
  void draw_chunks(const Triangles& mesh, const View& view, const ReliefStyle& style) const;
  [[nodiscard]] const Triangles& mesh(int level) const;
  [[nodiscard]] float relief_gain() const;  ///< slopes are lit as if this much steeper

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
  gl::Target stone_;  ///< encoded colour, alpha: known
  KeyLight light_;
  bool painted_ = false;
  gl::Name vertex_array_;
  CellTree cells_;
  mutable std::unordered_map<int, Triangles> meshes_;  ///< by level of the cell tree, made when first drawn
};

}  // namespace sparsha::viewer

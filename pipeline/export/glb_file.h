// The container of a GLB, and the JSON that describes one mesh in it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pipeline/export/glb_maps.h"
#include "pipeline/export/node_rows.h"

namespace sparsha::pipeline {

class Output;

/// Parts of the binary chunk in their order, each a bufferView that begins at a multiple of four.
class GlbViews {
 public:
  std::size_t add(std::uint64_t size, std::string_view more = {});
  static std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }
  [[nodiscard]] std::uint64_t bytes() const { return at_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::uint64_t at_ = 0;
  std::size_t count_ = 0;
};

/// Of the float32 values, written with all their digits.
struct GlbBox {
  std::array<double, 3> low{}, high{};
  bool empty = true;

  void add(const Eigen::Vector3f& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = static_cast<double>(p[static_cast<Eigen::Index>(k)]);
      low[k] = empty ? x : std::min(low[k], x);
      high[k] = empty ? x : std::max(high[k], x);
    }
    empty = false;
  }
};

/// The file's JSON: what lies where in the binary chunk, in this order: places (3 float32), colours (4 uint16), places
/// in pictures (2 float32), triangles (3 uint32), pictures.
class GlbDescription {
 public:
  /// Places are float32 relative to `middle` of the scan frame; `turn` is viewer_from_scan().
  GlbDescription(const MeshCounts& counts, const GlbBox& box, const Eigen::Vector3d& middle,
                 const Eigen::Matrix3d& turn, bool colour, const std::vector<HapticMap>& maps);

  [[nodiscard]] const GlbViews& views() const { return views_; }
  [[nodiscard]] std::string json() const;

 private:
  void add(const HapticMap& map);

  GlbViews views_;
  std::string accessors_, attributes_, images_, textures_, materials_, last_, place_, turn_;
  int indices_ = 0, count_ = 0;
};

/// Viewers have y upwards and look along -z, whichever of the scan's axes is up: quarter turns, exact in any number, so
/// that the surface stands before them as before us. The rows are the scan's axes that become x, y and z.
[[nodiscard]] Eigen::Matrix3d viewer_from_scan(const scene::Scene& scene);

/// Writes all that is before the binary chunk's own bytes. Throws Error{failure} for more than 4 GB.
void begin_glb(const GlbDescription& description, Output& output, const std::string& shown);
/// `bytes`, and zeros up to a multiple of four.
void put_padded(Output& output, std::string_view bytes);

}  // namespace sparsha::pipeline

// GLB, the binary form of glTF 2.0.
#include "pipeline/export/glb_file.h"

#include <limits>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "pipeline/export/output.hpp"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

/// The scan's axis, forwards or backwards, that is nearest to a direction.
Eigen::Vector3d nearest_axis(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  (void)direction.cwiseAbs().maxCoeff(&axis);
  return (direction[axis] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
}

/// Column by column, as glTF has matrices.
template <typename Matrix>
std::string columns_of(const Matrix& matrix) {
  const Matrix positive = (matrix.array() + 0.0).matrix();  // no "-0"
  return fmt::format("{}", fmt::join(positive.data(), positive.data() + positive.size(), ","));
}

}  // namespace

Eigen::Matrix3d viewer_from_scan(const scene::Scene& scene) {
  const Eigen::Matrix4d& grid = scene.description().scan_from_grid;
  Eigen::Matrix3d rows;
  rows.row(1) = nearest_axis(grid.col(1).head<3>());
  const Eigen::Vector3d up = rows.row(1);
  const Eigen::Vector3d front = grid.col(2).head<3>();
  rows.row(2) = nearest_axis(front - front.dot(up) * up);
  rows.row(0) = up.cross(Eigen::Vector3d(rows.row(2)));
  return rows;
}

std::size_t GlbViews::add(std::uint64_t size, std::string_view more) {
  text_ +=
      fmt::format("{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}", count_ == 0 ? "" : ",", at_, size, more);
  at_ += padded(size);
  return count_++;
}

GlbDescription::GlbDescription(const MeshCounts& counts, const GlbBox& box, const Eigen::Vector3d& middle,
                               const Eigen::Matrix3d& turn, bool colour, const std::vector<HapticMap>& maps) {
  const auto accessor = [&](std::size_t view, int type, std::uint64_t count, const char* shape,
                            std::string_view more = {}) {
    accessors_ += fmt::format("{}{{\"bufferView\":{},\"componentType\":{},\"count\":{},\"type\":\"{}\"{}}}",
                              accessors_.empty() ? "" : ",", view, type, count, shape, more);
  };
  constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
  constexpr std::string_view kVertices = ",\"target\":34962", kIndices = ",\"target\":34963";
  accessor(views_.add(12 * counts.vertices, kVertices), kFloat, counts.vertices, "VEC3",
           fmt::format(",\"min\":[{}],\"max\":[{}]", fmt::join(box.low, ","), fmt::join(box.high, ",")));
  attributes_ = "\"POSITION\":0";
  int next = 1;
  if (colour) {
    accessor(views_.add(8 * counts.vertices, kVertices), kUnsignedShort, counts.vertices, "VEC4",
             ",\"normalized\":true");
    attributes_ += fmt::format(",\"COLOR_0\":{}", next++);
  }
  if (!maps.empty()) {
    accessor(views_.add(8 * counts.vertices, kVertices), kFloat, counts.vertices, "VEC2");
    attributes_ += fmt::format(",\"TEXCOORD_0\":{}", next++);
  }
  accessor(views_.add(12 * counts.triangles, kIndices), kUnsignedInt, 3 * counts.triangles, "SCALAR");
  indices_ = next;
  Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
  place.topLeftCorner<3, 3>() = turn;
  place.topRightCorner<3, 1>() = turn * middle;
  place_ = columns_of(place);
  turn_ = columns_of(turn);
  for (const HapticMap& map : maps) add(map);
}

std::string GlbDescription::json() const {
  std::string text = fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"Sparsha","extras":{{"viewer_from_scan":[{}]}}}},"scene":0,)", turn_);
  text += fmt::format(R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"matrix":[{}]}}],)", place_);
  text += fmt::format(R"("meshes":[{{"primitives":[{{"attributes":{{{}}},"indices":{},"material":0,"mode":4}}]{}}}],)",
                      attributes_, indices_,
                      count_ > 0 ? R"(,"extensions":{"MPEG_haptic_material":{"hapticMaterialIndex":0}})" : "");
  text += R"("materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.9},"doubleSided":true}],)";
  if (count_ > 0) {
    text += fmt::format(
        R"("extensionsUsed":["MPEG_haptic_material"],"extensions":{{"MPEG_haptic_material":{{"materials":[{{{}]}}]}}}},)",
        materials_);
    text += fmt::format(R"("images":[{}],"textures":[{}],"samplers":[{{"wrapS":33071,"wrapT":33071}}],)", images_,
                        textures_);
  }
  text += fmt::format(R"("accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}})", accessors_,
                      views_.text(), views_.bytes());
  text.resize(GlbViews::padded(text.size()), ' ');
  return text;
}

void GlbDescription::add(const HapticMap& map) {
  const char* const comma = count_ == 0 ? "" : ",";
  images_ += fmt::format(R"({}{{"bufferView":{},"mimeType":"image/png"}})", comma, views_.add(map.png.size()));
  textures_ += fmt::format(R"({}{{"source":{},"sampler":0}})", comma, count_);
  const bool same = last_ == map.property;
  materials_ += same ? "," : fmt::format(R"({}"{}":[)", count_ == 0 ? "" : "],", map.property);
  materials_ += fmt::format(
      R"({{"texture":{{"index":{}}},"type":"High_Resolution","extras":{{"coefficient":"{}","unit":"{}","least":{},"most":{}}}}})",
      count_, map.coefficient, map.unit, map.least, map.most);
  last_ = map.property;
  ++count_;
}

void begin_glb(const GlbDescription& description, Output& output, const std::string& shown) {
  const std::string json = description.json();
  const std::uint64_t size = 12 + 8 + json.size() + 8 + description.views().bytes();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorKind::failure, {shown, 0, 0}, fmt::format("a GLB of {} bytes", size),
                "expected at most 4 GB: a coarser grid, or .ply");
  }
  constexpr std::uint32_t kGltf = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  for (const std::uint32_t word :
       {kGltf, kVersion, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(json.size()), kJson})
    output.put(word);
  put_padded(output, json);
  output.put(static_cast<std::uint32_t>(description.views().bytes()));
  output.put(kBinary);
}

void put_padded(Output& output, std::string_view bytes) {
  for (const char c : bytes) output.put(c);
  for (std::uint64_t k = bytes.size(); k < GlbViews::padded(bytes.size()); ++k) output.put('\0');
}

}  // namespace sparsha::pipeline

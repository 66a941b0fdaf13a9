// GLB, the binary form of glTF 2.0: one mesh, its colours at the vertices, and what is felt as pictures.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/glb_maps.h"
#include "pipeline/export/node_rows.h"
#include "pipeline/export/output.hpp"

namespace sparsha::pipeline {
namespace {

/// Parts of the binary chunk in their order, each a bufferView that begins at a multiple of four.
class Views {
 public:
  std::size_t add(std::uint64_t size, std::string_view more = {}) {
    text_ += fmt::format("{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}", count_ == 0 ? "" : ",", at_, size,
                         more);
    at_ += padded(size);
    return count_++;
  }
  static std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }
  [[nodiscard]] std::uint64_t bytes() const { return at_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::uint64_t at_ = 0;
  std::size_t count_ = 0;
};

/// Vertices are float32 relative to this place, which the node's matrix moves and turns to the viewer's axes.
Eigen::Vector3d middle_of(const scene::Scene& scene) {
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice& lattice = description.levels.at(0);
  const Eigen::Vector4d grid(0.5 * (lattice.x_m(0) + lattice.x_m(lattice.nx - 1)),
                             0.5 * (lattice.y_m(0) + lattice.y_m(lattice.ny - 1)),
                             0.5 * (description.height_min_m + description.height_max_m), 1.0);
  return (description.scan_from_grid * grid).head<3>().array().round();
}

/// The scan's axis, forwards or backwards, that is nearest to a direction.
Eigen::Vector3d nearest_axis(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  (void)direction.cwiseAbs().maxCoeff(&axis);
  return (direction[axis] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
}

/// Viewers have y upwards and look along -z, whichever of the scan's axes is up: quarter turns, exact in any number, so
/// that the surface stands before them as before us. The rows are the scan's axes that become x, y and z.
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

/// Column by column, as glTF has matrices.
template <typename Matrix>
std::string columns_of(const Matrix& matrix) {
  const Matrix positive = (matrix.array() + 0.0).matrix();  // no "-0"
  return fmt::format("{}", fmt::join(positive.data(), positive.data() + positive.size(), ","));
}

/// Of the float32 values, written with all their digits.
struct Box {
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

/// glTF's colours of vertices are light, not sRGB (IEC 61966-2-1).
std::uint16_t light_of(std::uint32_t byte) {
  const double stored = byte / 255.0;
  const double light = stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535.0 * light));
}

/// The file's JSON: what lies where in the binary chunk, in the order in which export_glb() writes it.
class Description {
 public:
  Description(const MeshCounts& counts, const Box& box, const Eigen::Vector3d& middle, const Eigen::Matrix3d& turn,
              bool colour, const std::vector<HapticMap>& maps) {
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

  [[nodiscard]] const Views& views() const { return views_; }
  [[nodiscard]] std::string json() const {
    std::string text = fmt::format(
        R"({{"asset":{{"version":"2.0","generator":"Sparsha","extras":{{"viewer_from_scan":[{}]}}}},"scene":0,)",
        turn_);
    text += fmt::format(R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"matrix":[{}]}}],)", place_);
    text += fmt::format(
        R"("meshes":[{{"primitives":[{{"attributes":{{{}}},"indices":{},"material":0,"mode":4}}]{}}}],)", attributes_,
        indices_, count_ > 0 ? R"(,"extensions":{"MPEG_haptic_material":{"hapticMaterialIndex":0}})" : "");
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
    text.resize(Views::padded(text.size()), ' ');
    return text;
  }

 private:
  void add(const HapticMap& map) {
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

  Views views_;
  std::string accessors_, attributes_, images_, textures_, materials_, last_, place_, turn_;
  int indices_ = 0, count_ = 0;
};

void put_padded(Output& output, std::string_view bytes) {
  for (const char c : bytes) output.put(c);
  for (std::uint64_t k = bytes.size(); k < Views::padded(bytes.size()); ++k) output.put('\0');
}

void put_places_in_pictures(const scene::Scene& scene, Output& output) {
  NodeRows rows(scene, false);
  const scene::Lattice& lattice = rows.lattice();
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      if (!rows.known(i, j)) continue;
      output.put(static_cast<float>((i + 0.5) / lattice.nx));
      output.put(static_cast<float>((lattice.ny - 1 - j + 0.5) / lattice.ny));
    }
  }
}

}  // namespace

void export_glb(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool haptics,
                Progress& progress) {
  const Eigen::Vector3d middle = middle_of(scene);
  const auto local = [&](const Eigen::Vector3d& p) { return Eigen::Vector3f((p - middle).cast<float>()); };
  const bool colour = scene.description().has_colour;
  const MeshCounts counts = count_mesh(scene, false, progress);
  if (counts.triangles == 0) {
    throw Error(ErrorKind::input, {shown, 0, 0},
                "no cell of the scene is known at its four corners, so there is no mesh",
                "expected a scene with more of its surface measured, or .ply or .xyz for its points");
  }
  Box box;
  for_each_vertex(scene, false, progress, [&](const Eigen::Vector3d& p, std::uint32_t) { box.add(local(p)); });
  const std::vector<HapticMap> maps = haptics ? haptic_maps(scene, progress) : std::vector<HapticMap>();
  const Description description(counts, box, middle, viewer_from_scan(scene), colour, maps);
  const std::string json = description.json();
  const std::uint64_t size = 12 + 8 + json.size() + 8 + description.views().bytes();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorKind::failure, {shown, 0, 0}, fmt::format("a GLB of {} bytes", size),
                "expected at most 4 GB: a coarser grid, or .ply");
  }
  constexpr std::uint32_t kGltf = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  Output output(file, shown);
  for (const std::uint32_t word :
       {kGltf, kVersion, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(json.size()), kJson})
    output.put(word);
  put_padded(output, json);
  output.put(static_cast<std::uint32_t>(description.views().bytes()));
  output.put(kBinary);
  for_each_vertex(scene, false, progress, [&](const Eigen::Vector3d& p, std::uint32_t) {
    const Eigen::Vector3f q = local(p);
    for (int axis = 0; axis < 3; ++axis) output.put(q[axis]);
  });
  if (colour) {
    for_each_vertex(scene, false, progress, [&](const Eigen::Vector3d&, std::uint32_t rgba) {
      if (rgba == 0) rgba = 0xFFFFFFFFU;  // white where the scene knows no colour
      for (const unsigned shift : {0U, 8U, 16U}) output.put(light_of(rgba >> shift & 255U));
      output.put(std::uint16_t{0xFFFF});
    });
  }
  if (!maps.empty()) put_places_in_pictures(scene, output);
  for_each_triangle(scene, progress, [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    for (const std::uint64_t corner : {a, b, c}) output.put(static_cast<std::uint32_t>(corner));
  });
  for (const HapticMap& map : maps) put_padded(output, map.png);
  output.close();
}

}  // namespace sparsha::pipeline

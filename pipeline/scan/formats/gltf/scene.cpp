// Section 3.5 of the specification. Without recursion: a chain of nodes may be as long as the file.
#include "pipeline/scan/formats/gltf/scene.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

namespace sparsha::pipeline::gltf {
namespace {

template <std::size_t Size>
bool read_numbers(const Document& document, const Json& node, const char* key, const Place& place,
                  std::array<double, Size>& values) {
  const auto found = node.find(key);
  if (found == node.end()) return false;
  const bool fits = found->is_array() && found->size() == Size &&
                    std::all_of(found->begin(), found->end(), [](const Json& value) { return value.is_number(); });
  if (!fits) throw document.error(place, fmt::format("'{}' is not {} numbers", key, Size));
  for (std::size_t k = 0; k < Size; ++k) values[k] = (*found)[k].template get<double>();
  return true;
}

/// Other matrices must not be there (3.5.3).
void require_affine(const Document& document, const Eigen::Matrix4d& matrix, const Place& place) {
  constexpr double kRounding = 1e-6;  // of float32 in text
  const auto is_last = [&](const Eigen::Vector4d& row) {
    return (row - Eigen::Vector4d::UnitW()).cwiseAbs().maxCoeff() <= kRounding;
  };
  if (is_last(matrix.row(3))) return;
  const bool by_rows = is_last(matrix.col(3));
  throw document.error(place,
                       by_rows ? "'matrix' is written row by row: its numbers 4, 8 and 12 hold the translation"
                               : "'matrix' has numbers 4, 8, 12 and 16 that are not 0, 0, 0 and 1",
                       "a matrix column by column, with the translation in its numbers 13 to 15");
}

Eigen::Matrix4d local_place(const Document& document, const Json& node, const Place& place) {
  std::array<double, 16> matrix{};
  if (read_numbers(document, node, "matrix", place, matrix)) {
    Eigen::Matrix4d by_columns = Eigen::Map<Eigen::Matrix4d>(matrix.data());
    require_affine(document, by_columns, place);
    return by_columns;
  }
  std::array<double, 3> move{0.0, 0.0, 0.0};
  std::array<double, 4> turn{0.0, 0.0, 0.0, 1.0};
  std::array<double, 3> scale{1.0, 1.0, 1.0};
  (void)read_numbers(document, node, "translation", place, move);
  (void)read_numbers(document, node, "rotation", place, turn);
  (void)read_numbers(document, node, "scale", place, scale);
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  if (!(rotation.norm() > 1e-6)) throw document.error(place, "'rotation' is no quaternion", "[x, y, z, w] of length 1");
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() =
      rotation.normalized().toRotationMatrix() * Eigen::Map<Eigen::Vector3d>(scale.data()).asDiagonal();
  result.topRightCorner<3, 1>() = Eigen::Map<Eigen::Vector3d>(move.data());
  return result;
}

std::vector<std::uint64_t> indices(const Document& document, const Json& object, const char* key, const Place& place) {
  std::vector<std::uint64_t> result;
  const auto found = object.find(key);
  if (found == object.end()) return result;
  if (!found->is_array()) throw document.error(place, fmt::format("'{}' is no list", key));
  const std::uint64_t nodes = document.size_of("nodes");
  for (const Json& value : *found) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= nodes)
      throw document.error(place, fmt::format("'{}' names a node that is not there", key),
                           fmt::format("below {}", nodes));
    result.push_back(value.get<std::uint64_t>());
  }
  return result;
}

std::vector<std::uint64_t> root_nodes(const Document& document, Shown& shown) {
  const std::uint64_t scenes = document.size_of("scenes");
  if (scenes > 0) {
    const std::uint64_t scene = document.whole(document.root(), "scene", 0, "scene");
    const Json& object = document.item("scenes", scene, "scene");
    shown.other_scenes = scenes - 1;
    return indices(document, object, "nodes", fmt::format("scenes[{}]", scene));
  }
  const std::uint64_t nodes = document.size_of("nodes");
  std::vector<bool> child(static_cast<std::size_t>(nodes));
  for (std::uint64_t n = 0; n < nodes; ++n) {
    const Place place = fmt::format("nodes[{}]", n);
    for (const std::uint64_t c : indices(document, document.item("nodes", n, place), "children", place))
      child[static_cast<std::size_t>(c)] = true;
  }
  std::vector<std::uint64_t> roots;
  for (std::uint64_t n = 0; n < nodes; ++n)
    if (!child[static_cast<std::size_t>(n)]) roots.push_back(n);
  return roots;
}

/// Our own export turns the scan's axes to those of viewers by quarter turns and says so; anything else is not undone.
Eigen::Matrix4d scan_from_scene(const Document& document) {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  const Json& asset = document.root().at("asset");
  if (asset.find("generator") == asset.end() || asset["generator"] != "Sparsha") return result;
  const auto extras = asset.find("extras");
  std::array<double, 9> numbers{};
  if (extras == asset.end() || !extras->is_object() ||
      !read_numbers(document, *extras, "viewer_from_scan", "asset.extras", numbers))
    return result;
  const Eigen::Matrix3d turn = Eigen::Map<Eigen::Matrix3d>(numbers.data());
  const bool quarters = (turn.array() == 0.0 || turn.array().abs() == 1.0).all() &&
                        turn * turn.transpose() == Eigen::Matrix3d::Identity();
  if (!quarters) throw document.error("asset.extras", "'viewer_from_scan' is no turn by quarters", "nine of -1, 0, 1");
  result.topLeftCorner<3, 3>() = turn.transpose();
  return result;
}

/// KHR_node_visibility; its children are hidden with it.
bool is_hidden(const Json& node) {
  static const Json::json_pointer visible("/extensions/KHR_node_visibility/visible");
  return node.contains(visible) && node[visible] == false;
}

}  // namespace

Shown shown_meshes(const Document& document) {
  struct Open {
    std::uint64_t node;
    Eigen::Matrix4d parent;
    bool hidden;
  };
  Shown shown;
  std::vector<Open> open;
  const std::vector<std::uint64_t> roots = root_nodes(document, shown);
  const Eigen::Matrix4d scene = scan_from_scene(document);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, scene, false});
  std::vector<bool> seen(static_cast<std::size_t>(document.size_of("nodes")));
  while (!open.empty()) {
    const Open next = open.back();
    open.pop_back();
    const Place place = fmt::format("nodes[{}]", next.node);
    if (seen[static_cast<std::size_t>(next.node)])
      throw document.error(place, "is there twice in the tree of nodes", "one parent for each node");
    seen[static_cast<std::size_t>(next.node)] = true;
    const Json& node = document.item("nodes", next.node, place);
    const Eigen::Matrix4d here = next.parent * local_place(document, node, place);
    const bool hidden = next.hidden || is_hidden(node);
    const bool parts = node.contains("translation") || node.contains("rotation") || node.contains("scale");
    shown.placed_twice += node.contains("matrix") && parts ? 1 : 0;
    const std::optional<std::uint64_t> mesh = document.whole(node, "mesh", place);
    if (mesh && hidden) {
      ++shown.hidden;
    } else if (mesh) {
      shown.instances.push_back({*mesh, next.node, here});
      shown.skinned += node.contains("skin") ? 1 : 0;
      const auto extensions = node.find("extensions");
      const bool many =
          extensions != node.end() && extensions->is_object() && extensions->contains("EXT_mesh_gpu_instancing");
      shown.many += many ? 1 : 0;
    }
    const std::vector<std::uint64_t> children = indices(document, node, "children", place);
    for (auto child = children.rbegin(); child != children.rend(); ++child) open.push_back({*child, here, hidden});
  }
  return shown;
}

bool is_morphed(const Document& document, const Instance& instance) {
  const Json& node = document.item("nodes", instance.node, "nodes");
  const Json& mesh = document.item("meshes", instance.mesh, "nodes");
  const Json& owner = node.contains("weights") ? node : mesh;
  const auto weights = owner.find("weights");
  return weights != owner.end() && weights->is_array() &&
         std::any_of(weights->begin(), weights->end(), [](const Json& weight) { return weight != 0; });
}

}  // namespace sparsha::pipeline::gltf

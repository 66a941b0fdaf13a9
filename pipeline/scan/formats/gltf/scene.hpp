// Which meshes a glTF scene shows, and where.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/formats/gltf/document.hpp"

namespace sparsha::pipeline::gltf {

struct Instance {
  std::uint64_t mesh = 0;
  std::uint64_t node = 0;
  Eigen::Matrix4d place =
      Eigen::Matrix4d::Identity();  ///< scan = place * mesh; the scan's axes are the scene's but in our own exports
};

struct Shown {
  std::vector<Instance> instances;  ///< in the order of the nodes
  std::uint64_t other_scenes = 0;   ///< that are not shown
  std::uint64_t skinned = 0;        ///< nodes whose skin is not applied
  std::uint64_t many = 0;           ///< nodes with EXT_mesh_gpu_instancing, shown once
  std::uint64_t hidden = 0;         ///< nodes with a mesh that KHR_node_visibility hides, with a parent or alone
  std::uint64_t placed_twice = 0;   ///< nodes with a matrix and what a matrix is made of
};

/// Of the default scene, or of the first, or where there is none of all nodes that are nobody's child. Throws
/// Error{input} for nodes that are their own descendants, and for trees that show a node twice.
[[nodiscard]] Shown shown_meshes(const Document& document);

/// Whether weights of the node, else of its mesh, would move vertices (3.7.2.2).
[[nodiscard]] bool is_morphed(const Document& document, const Instance& instance);

}  // namespace sparsha::pipeline::gltf

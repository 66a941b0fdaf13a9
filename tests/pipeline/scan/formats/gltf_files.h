// glTF files of tests, built byte by byte.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <Eigen/Core>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing::gltf {

using nlohmann::json;

inline constexpr int kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

/// A file in the making; numbers go into one buffer.
struct Maker {
  json root = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", json::array({{{"nodes", {0}}}})},
               {"nodes", json::array({{{"mesh", 0}}})},
               {"meshes", json::array()},
               {"accessors", json::array()},
               {"bufferViews", json::array()}};
  std::string bytes;

  std::size_t view(const std::string& data, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    json one = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}};
    if (stride > 0) one["byteStride"] = stride;
    root["bufferViews"].push_back(one);
    bytes += data;
    return root["bufferViews"].size() - 1;
  }
  std::size_t accessor(std::size_t view, int type, std::size_t count, const char* shape, bool normalised = false) {
    json one = {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}};
    if (normalised) one["normalized"] = true;
    root["accessors"].push_back(one);
    return root["accessors"].size() - 1;
  }
  template <typename T>
  std::size_t numbers(const std::vector<T>& values, int type, int components, bool normalised = false) {
    std::string data;
    for (const T value : values) put(data, value);
    const char* const shape = components == 1 ? "SCALAR" : components == 2 ? "VEC2" : components == 3 ? "VEC3" : "VEC4";
    return accessor(view(data), type, values.size() / static_cast<std::size_t>(components), shape, normalised);
  }
  void mesh(const json& primitive) { root["meshes"].push_back({{"primitives", json::array({primitive})}}); }

  [[nodiscard]] std::string glb(std::uint32_t version = 2) const {
    json whole = root;
    whole["buffers"] = json::array({{{"byteLength", bytes.size()}}});
    std::string text = whole.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::string body = bytes;
    while (body.size() % 4 != 0) body += '\0';
    std::string file = "glTF";
    put(file, version);
    put(file, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + body.size()));
    put(file, static_cast<std::uint32_t>(text.size()));
    file += "JSON" + text;
    put(file, static_cast<std::uint32_t>(body.size()));
    return file + std::string("BIN\0", 4) + body;
  }
};

inline const std::vector<float> kSquare{0, 0, 0, 1, 0, 0.5F, 1, 2, 0.25F, 0, 2, -1};
inline const std::vector<Eigen::Vector3d> kCorners{{0, 0, 0}, {1, 0, 0.5}, {1, 2, 0.25}, {0, 2, -1}};

inline Maker square() {
  Maker maker;
  const std::size_t positions = maker.numbers(kSquare, kFloat, 3);
  const std::size_t indices = maker.numbers<std::uint16_t>({0, 1, 2, 0, 2, 3}, kUnsignedShort, 1);
  maker.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return maker;
}

}  // namespace sparsha::pipeline::testing::gltf

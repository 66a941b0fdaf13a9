// Meshes that are compressed by Draco (KHR_draco_mesh_compression).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "pipeline/scan/formats/gltf/document.hpp"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline::gltf {

class DracoMesh {
 public:
  /// Null for a primitive that is not compressed, or that has its numbers beside. Throws Error{input} for what is
  /// damaged or holds more than its accessors, and everywhere where the library was not there when the program was
  /// built.
  [[nodiscard]] static std::unique_ptr<const DracoMesh> of(const Document& document, const Json& primitive,
                                                           const Place& place);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  /// Whether the attribute ("POSITION") is compressed; others are read as ever.
  [[nodiscard]] bool has(const std::string& attribute) const;
  /// All values in this type, one vertex after the other. Throws Error{input} where these are not `count`.
  [[nodiscard]] std::shared_ptr<const std::string> values(const std::string& attribute, ScalarType type,
                                                          std::size_t components, std::uint64_t count,
                                                          const Place& place) const;
  /// Three 32-bit numbers a triangle.
  [[nodiscard]] std::shared_ptr<const std::string> corners() const;

 private:
  struct Implementation;
  explicit DracoMesh(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::pipeline::gltf

// Numbers of a glTF file: any component type, normalised or not, interleaved, sparse.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/scan/formats/gltf/document.hpp"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline::gltf {

class DracoMesh;

class Accessor {
 public:
  /// Throws Error{input} when any element lies beyond its bytes.
  Accessor(const Document& document, std::uint64_t index, const Place& asked_by);
  /// The same of a compressed mesh: its `attribute`, or its corners, whose numbers have 32 bits, when that is empty.
  Accessor(const Document& document, std::uint64_t index, const Place& asked_by, const DracoMesh& mesh,
           const std::string& attribute);

  /// Without bytes, whose numbers are elsewhere: its form alone is known, and elements are zero.
  struct FormOnly {};
  static constexpr FormOnly kFormOnly{};
  Accessor(const Document& document, std::uint64_t index, const Place& asked_by, FormOnly form);

  [[nodiscard]] std::uint64_t size() const { return count_; }
  /// Numbers of an element: 1 to 4.
  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] ScalarType type() const { return type_; }
  [[nodiscard]] bool normalised() const { return normalised_; }
  /// From now on; true when it was not.
  bool normalise() { return !std::exchange(normalised_, true); }
  [[nodiscard]] const Place& place() const { return place_; }

  /// Element n < size(): whole types that are normalised are from -1 or 0 to 1.
  [[nodiscard]] std::array<double, 4> operator()(std::uint64_t n) const;
  /// The first number of element n as it is stored, for indices.
  [[nodiscard]] std::uint32_t index(std::uint64_t n) const;

 private:
  /// What the JSON says of it but where its bytes are, and that.
  const Json& read_form(const Document& document, std::uint64_t index, const Place& asked_by);
  void read_sparse(const Document& document, const Json& sparse);
  [[nodiscard]] const char* element(std::uint64_t n) const;

  Place place_;
  std::uint64_t count_ = 0;
  std::size_t components_ = 1;
  ScalarType type_ = ScalarType::f32;
  bool normalised_ = false;
  std::shared_ptr<const std::string> unpacked_;  ///< of a compressed mesh
  std::string_view bytes_;                       ///< from the first element on; empty: all are zero but the sparse ones
  std::uint64_t stride_ = 0;
  std::vector<std::pair<std::uint64_t, const char*>> sparse_;  ///< ascending
};

}  // namespace sparsha::pipeline::gltf

// The points of one E57 scan: a compressed vector of packets, one stream of bits a field.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/scan/formats/e57/pages.h"

namespace sparsha::pipeline::e57 {

/// A field of the records, as the prototype in the XML describes it.
struct Field {
  enum class Kind : std::uint8_t { single, real, integer, other };
  std::string name;
  Kind kind = Kind::real;
  std::int64_t minimum = 0;  ///< of integers, before scaling
  std::int64_t maximum = 0;
  double scale = 1.0;
  double offset = 0.0;

  /// Bits of one value in its stream; 0 for integers that can have one value only.
  [[nodiscard]] unsigned bits() const;
};

/// One field's stream, fed packet by packet: values may be cut by the ends of packets.
class FieldStream {
 public:
  explicit FieldStream(const Field& field) : field_(&field), bits_(field.bits()) {}

  void feed(std::span<const char> bytes);
  /// Whole values that can be taken.
  [[nodiscard]] std::uint64_t available() const;
  [[nodiscard]] double take();

 private:
  const Field* field_;
  unsigned bits_;
  std::vector<char> bytes_;
  std::size_t bit_ = 0;  ///< of bytes_, taken so far
};

/// Decodes `records` records whose section begins at a physical offset. `take` gets the streams of the fields in
/// `wanted` (by index into `fields`), each with at least one value, once a record, until it gives false.
void read_points(const ScanFile& file, const Pages& pages, std::uint64_t section, std::uint64_t records,
                 const std::vector<Field>& fields, const std::vector<std::size_t>& wanted,
                 const std::function<bool(std::vector<FieldStream>&)>& take);

}  // namespace sparsha::pipeline::e57

// Numbers within a record, and models by the dozen.
#pragma once

#include <cstring>
#include <vector>

#include "pipeline/scan/formats/las/laz/arithmetic.h"

namespace sparsha::pipeline::laz {

template <class T>
[[nodiscard]] T get(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}
template <class T>
void put(std::uint8_t* at, T value) {
  std::memcpy(at, &value, sizeof value);
}

/// `count` models of `symbols` symbols.
[[nodiscard]] inline std::vector<SymbolModel> models(std::size_t count, std::uint32_t symbols) {
  std::vector<SymbolModel> made;
  made.reserve(count);
  for (std::size_t i = 0; i < count; ++i) made.emplace_back(symbols);
  return made;
}

[[nodiscard]] inline std::uint8_t low_byte(std::int64_t value) { return static_cast<std::uint8_t>(value & 255); }

/// Context from the bits of a difference: even, at most `most`.
[[nodiscard]] inline std::uint32_t even_context(std::uint32_t bits, std::uint32_t most) {
  return bits < most ? bits & ~1U : most;
}

}  // namespace sparsha::pipeline::laz

// Number types of binary scan files, and colours in whatever range a file has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "pipeline/scan/file.h"

namespace sparsha::pipeline {

enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

[[nodiscard]] constexpr std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::i8:
    case ScalarType::u8:
      return 1;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    case ScalarType::i32:
    case ScalarType::u32:
    case ScalarType::f32:
      return 4;
    default:
      return 8;
  }
}
[[nodiscard]] constexpr bool is_floating(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }

template <bool big_endian = false>
[[nodiscard]] double load_scalar(const char* bytes, ScalarType type) {
  switch (type) {
    case ScalarType::i8:
      return load<std::int8_t, big_endian>(bytes);
    case ScalarType::u8:
      return load<std::uint8_t, big_endian>(bytes);
    case ScalarType::i16:
      return load<std::int16_t, big_endian>(bytes);
    case ScalarType::u16:
      return load<std::uint16_t, big_endian>(bytes);
    case ScalarType::i32:
      return load<std::int32_t, big_endian>(bytes);
    case ScalarType::u32:
      return load<std::uint32_t, big_endian>(bytes);
    case ScalarType::i64:
      return static_cast<double>(load<std::int64_t, big_endian>(bytes));
    case ScalarType::u64:
      return static_cast<double>(load<std::uint64_t, big_endian>(bytes));
    case ScalarType::f32:
      return static_cast<double>(load<float, big_endian>(bytes));
    default:
      return load<double, big_endian>(bytes);
  }
}

/// What the largest colour value means: 1, 255 or 65535.
enum class ColourScale : std::uint8_t { unit, byte, word };

/// Channels with fractions may lie so far beyond their scale: interpolation between pixels overshoots.
inline constexpr double kColourOvershoot = 1.1;

/// Guesses the scale from the largest channel value seen; only numbers with fractions can be of unit scale.
[[nodiscard]] constexpr ColourScale colour_scale(double largest, bool fractions) {
  const double overshoot = fractions ? kColourOvershoot : 1.0;
  if (largest > 255.0 * overshoot) return ColourScale::word;
  return fractions && largest <= overshoot ? ColourScale::unit : ColourScale::byte;
}

[[nodiscard]] constexpr std::uint32_t colour_byte(double value, ColourScale scale) {
  const double factor = scale == ColourScale::unit ? 255.0 : scale == ColourScale::word ? 255.0 / 65535.0 : 1.0;
  const double scaled = value * factor + 0.5;
  if (!(scaled > 0.0)) return 0;
  return scaled >= 255.0 ? 255 : static_cast<std::uint32_t>(scaled);
}

}  // namespace sparsha::pipeline

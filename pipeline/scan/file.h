// What a format's reader gets to see of a file, and values in it whatever their byte order.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/scan/empty_scan.h"

namespace sparsha::pipeline {

/// A mapped scan file. `name` is the path as the user gave it, `extension` its lower-case ending without the dot.
struct ScanFile {
  std::string name;
  std::string extension;
  std::string_view bytes;
  const MappedFile* map = nullptr;     ///< null in tests that read from memory
  const Progress* progress = nullptr;  ///< null when nobody can cancel
  std::vector<std::string> columns{};  ///< of a text table, as the configuration names them; empty: the file's own

  /// Bytes before `offset` were read for the last time: the system may have their memory back. Throws Cancelled.
  void done_before(std::size_t offset) const {
    throw_if_cancelled();
    if (map != nullptr) map->release_before(offset);
  }
  void throw_if_cancelled() const {
    if (progress != nullptr) progress->throw_if_cancelled();
  }
  [[nodiscard]] Error error(std::string wrong, std::string expected = {}) const {
    return input_error(name, std::move(wrong), std::move(expected));
  }
  /// Of a sound file that has no points.
  [[nodiscard]] EmptyScan empty(std::string wrong, std::string expected) const {
    return {name, std::move(wrong), std::move(expected)};
  }
  [[nodiscard]] Error error_at(int line, std::string wrong, std::string expected = {}) const {
    return input_error_at(name, line, std::move(wrong), std::move(expected));
  }
};

template <typename T>
[[nodiscard]] T byte_swapped(T value) {
  if constexpr (sizeof(T) == 1) return value;
  if constexpr (sizeof(T) == 2) return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  if constexpr (sizeof(T) == 4) return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  if constexpr (sizeof(T) == 8) return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
}

/// The value stored at `bytes`, least significant byte first (or last). The caller has checked that it is there.
template <typename T, bool big_endian = false>
[[nodiscard]] T load(const char* bytes) {
  static_assert(std::is_arithmetic_v<T>);
  T value;
  std::memcpy(&value, bytes, sizeof value);
  constexpr bool kHostIsBig = std::endian::native == std::endian::big;
  if constexpr (big_endian != kHostIsBig) value = byte_swapped(value);
  return value;
}

}  // namespace sparsha::pipeline

// LAS files that tests write themselves.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace sparsha::pipeline::testing {

/// Fewest bytes of a point, by format.
constexpr std::array<std::size_t, 11> kLasPointSizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Overwrites bytes.
template <typename T>
void set(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// A file of one variable length record (may be empty) and the given points, each of `format`'s size.
struct LasFile {
  int minor = 2;
  int format = 0;
  double scale = 0.01;
  double offset = 100.0;
  std::uint16_t record_id = 0;
  std::string record_user = "LASF_Projection";
  std::string record;
  std::vector<std::string> points;

  [[nodiscard]] std::string bytes() const {
    const std::size_t head = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
    std::string out(head, '\0');
    set(out, 0, std::array<char, 4>{'L', 'A', 'S', 'F'});
    out[24] = 1;
    out[25] = static_cast<char>(minor);
    const std::size_t records = record_id != 0 ? 54 + record.size() : 0;
    set(out, 94, static_cast<std::uint16_t>(head));
    set(out, 96, static_cast<std::uint32_t>(head + records));
    set(out, 100, std::uint32_t{record_id != 0 ? 1U : 0U});
    out[104] = static_cast<char>(format);
    set(out, 105, static_cast<std::uint16_t>(kLasPointSizes[static_cast<std::size_t>(format)]));
    set(out, 107, static_cast<std::uint32_t>(points.size()));
    for (std::size_t k = 0; k < 3; ++k) {
      set(out, 131 + 8 * k, scale);
      set(out, 155 + 8 * k, offset);
    }
    if (minor >= 4) {
      set(out, 247, static_cast<std::uint64_t>(points.size()));
      if (format >= 6) set(out, 107, std::uint32_t{0});
    }
    if (record_id != 0) {
      std::string lead(54, '\0');
      std::memcpy(lead.data() + 2, record_user.data(), record_user.size());
      set(lead, 18, record_id);
      set(lead, 20, static_cast<std::uint16_t>(record.size()));
      out += lead + record;
    }
    for (const std::string& point : points) out += point;
    return out;
  }
};

inline std::string las_point(int format, std::int32_t x, std::int32_t y, std::int32_t z, std::uint16_t intensity = 0) {
  std::string bytes(kLasPointSizes[static_cast<std::size_t>(format)], '\0');
  set(bytes, 0, x);
  set(bytes, 4, y);
  set(bytes, 8, z);
  set(bytes, 12, intensity);
  return bytes;
}

}  // namespace sparsha::pipeline::testing

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

/// A variable length record.
struct LasRecord {
  std::uint16_t id = 0;
  std::string data;
  std::string user = "LASF_Projection";

  [[nodiscard]] std::string bytes() const {
    std::string out(54, '\0');
    std::memcpy(out.data() + 2, user.data(), user.size());
    set(out, 18, id);
    set(out, 20, static_cast<std::uint16_t>(data.size()));
    return out + data;
  }
};

/// A file of one variable length record (may be empty), more of them and the given points, each of `format`'s size.
struct LasFile {
  int minor = 2;
  int format = 0;
  double scale = 0.01;
  double offset = 100.0;
  std::uint16_t record_id = 0;
  std::string record_user = "LASF_Projection";
  std::string record;
  std::vector<LasRecord> more_records;
  std::uint16_t encoding = 0;
  std::vector<std::string> points;

  [[nodiscard]] std::string bytes() const {
    const std::size_t head = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
    std::string out(head, '\0');
    set(out, 0, std::array<char, 4>{'L', 'A', 'S', 'F'});
    out[24] = 1;
    out[25] = static_cast<char>(minor);
    std::string records = record_id != 0 ? LasRecord{record_id, record, record_user}.bytes() : std::string();
    for (const LasRecord& more : more_records) records += more.bytes();
    set(out, 6, encoding);
    set(out, 94, static_cast<std::uint16_t>(head));
    set(out, 96, static_cast<std::uint32_t>(head + records.size()));
    set(out, 100, static_cast<std::uint32_t>((record_id != 0 ? 1 : 0) + more_records.size()));
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
    out += records;
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

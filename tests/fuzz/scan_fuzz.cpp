// Any bytes as a scan of any format: points or an Error, never a crash, a hang or a huge allocation.
#include <array>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "pipeline/scan/formats/e57/pages.h"
#include "pipeline/scan/read_bytes.h"

namespace {

/// Puts right checksums under the pages, or no damage would get past them.
void mend_checksums(std::string& bytes) {
  constexpr std::size_t kPage = 1024;
  for (std::size_t at = 0; at + kPage <= bytes.size(); at += kPage) {
    const std::uint32_t crc = sparsha::pipeline::e57::crc32c(std::string_view(bytes).substr(at, kPage - 4));
    for (std::size_t k = 0; k < 4; ++k) bytes[at + kPage - 1 - k] = static_cast<char>(crc >> (8 * k) & 255);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr std::array<const char*, 20> kNames{"s.ply", "s.pcd", "s.obj",   "s.off", "s.stl", "s.xyz", "s.csv",
                                                      "s.pts", "s.ptx", "s.las",   "s.e57", "s.asc", "s.glb", "s.gltf",
                                                      "s.laz", "s.grd", "s.splat", "s.spz", "s.bin", "s.3mf"};
  if (size == 0) return 0;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.rfind("ASTM-E57", 0) == 0) mend_checksums(bytes);
  // One time in four each: columns that a configuration names, some levels or whole chunks only, and a region.
  sparsha::pipeline::ReadOptions options;
  const int choice = data[size - 1] >> 6;
  if (choice == 1) options.columns = {"skip", "x", "y", "z", "skip", "red", "green", "blue"};
  if (choice == 2) {
    options.enough = size % 2 == 0 ? 30 : 0;
    options.whole_chunks_only = size % 2 == 1;
  }
  if (choice == 3) options.region = [](const auto& low, const auto&, const auto&) { return low.x() < 4.0; };
  try {
    const auto scan = sparsha::pipeline::read_scan_bytes(bytes, kNames[data[size - 1] % kNames.size()], options);
    if (scan.points.size() + scan.invalid != scan.records) __builtin_trap();
    if (!scan.rgba.empty() && scan.rgba.size() != scan.points.size()) __builtin_trap();
    if (!scan.intensity.empty() && scan.intensity.size() != scan.points.size()) __builtin_trap();
    for (const auto& face : scan.faces) {
      for (const auto corner : face) {
        if (corner >= scan.points.size()) __builtin_trap();
      }
    }
  } catch (const sparsha::Error&) {
  }
  return 0;
}

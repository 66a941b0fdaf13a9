// Names for scans of the fuzzer: one ending of each format. The last byte of an input chooses among them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sparsha::fuzz {

inline constexpr std::array<std::string_view, 21> kScanNames{
    "s.ply", "s.pcd", "s.obj",  "s.off", "s.stl", "s.xyz",   "s.csv", "s.pts", "s.ptx", "s.las", "s.e57",
    "s.asc", "s.glb", "s.gltf", "s.laz", "s.grd", "s.splat", "s.spz", "s.bin", "s.3mf", "s.txt"};
/// The two upper bits choose how it is read.
inline constexpr std::uint8_t kNameMask = 63;
static_assert(kScanNames.size() <= kNameMask + 1U);

}  // namespace sparsha::fuzz

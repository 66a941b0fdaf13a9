// Any bytes as a scan of any format: points or an Error, never a crash, a hang or a huge allocation.
#include <array>

#include "pipeline/base/error.h"
#include "pipeline/scan/reader.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr std::array<const char*, 9> kNames{"s.ply", "s.pcd", "s.obj", "s.stl", "s.xyz",
                                                     "s.pts", "s.ptx", "s.las", "s.e57"};
  if (size == 0) return 0;
  try {
    const auto file = sparsha::fuzz::as_file(data, size, kNames[data[size - 1] % kNames.size()]);
    const auto scan = sparsha::pipeline::read_scan(file);
    if (scan.points.size() + scan.invalid != scan.records) __builtin_trap();
    for (const auto& face : scan.faces)
      for (const auto corner : face)
        if (corner >= scan.points.size()) __builtin_trap();
  } catch (const sparsha::Error&) {
  }
  return 0;
}

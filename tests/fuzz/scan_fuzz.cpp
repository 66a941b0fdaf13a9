// Any bytes as a scan of any format, with right checksums and packing around them: points or an Error, never a crash, a
// hang or a huge allocation.
#include <cstdint>
#include <string>

#include "base/error.h"
#include "pipeline/scan/read_bytes.h"
#include "tests/fuzz/scan_names.h"
#include "tests/support/mended.h"

using sparsha::fuzz::kNameMask, sparsha::fuzz::kScanNames;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::uint8_t last = data[size - 1];
  const std::string name(kScanNames[(last & kNameMask) % kScanNames.size()]);
  const std::string bytes = sparsha::pipeline::testing::mended({reinterpret_cast<const char*>(data), size - 1}, name);
  // One time in four each: columns that a configuration names, some levels or whole chunks only, and a region.
  sparsha::pipeline::ReadOptions options;
  const int choice = last >> 6;
  if (choice == 1) options.columns = {"skip", "x", "y", "z", "skip", "red", "green", "blue"};
  if (choice == 2) {
    options.enough = size % 2 == 0 ? 30 : 0;
    options.whole_chunks_only = size % 2 == 1;
  }
  if (choice == 3) options.region = [](const auto& low, const auto&, const auto&) { return low.x() < 4.0; };
  try {
    const auto scan = sparsha::pipeline::read_scan_bytes(bytes, name, options);
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

// Any bytes as path.csv or run.csv.
#include "base/error.h"
#include "haptics/replay/trace.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    (void)sparsha::haptics::read_hip_path(sparsha::fuzz::as_file(data, size, "path.csv"));
  } catch (const sparsha::Error&) {
  }
  return 0;
}

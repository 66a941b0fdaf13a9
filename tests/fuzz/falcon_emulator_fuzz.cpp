// Any requests and bytes to the emulated Falcon: no crash, no packet longer than USB allows, no motor beyond 16 bits.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "emulator/falcon.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sparsha::emulator;
  FalconOptions options;
  options.firmware_loaded = size > 0 && data[0] % 2 == 0;
  options.image_bytes = 16;
  options.split_answers = size > 0 && data[0] % 3 == 0;
  options.garbage = size > 0 && data[0] % 5 == 0;
  Falcon falcon(options);
  double time_s = 0.0;
  for (std::size_t at = 1; at + 4 < size;) {
    const std::uint8_t kind = data[at] % 4;
    if (kind == 0) {
      const auto value = static_cast<std::uint16_t>(data[at + 2] | (data[at + 3] << 8U));
      static_cast<void>(falcon.control(data[at + 1], value, time_s));
      at += 4;
    } else if (kind == 1) {
      const std::size_t count = std::min<std::size_t>(data[at + 1] % 64U, size - at - 2);
      falcon.write({data + at + 2, count}, time_s);
      at += 2 + count;
    } else {
      time_s += data[at + 1] * 1e-4;
      const auto packet = falcon.read(time_s);
      if (packet && (packet->size() < 2 || packet->size() > 64)) std::abort();
      at += 2;
    }
    for (const int motor : falcon.motors())
      if (motor < -32768 || motor > 32767) std::abort();
  }
  return 0;
}

// Any bytes as packed points: the first ones choose the format, so that no header stands before the decoder.
#include <cstdint>
#include <string>

#include "pipeline/scan/formats/las/laz/points.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sparsha::pipeline::laz;
  if (size < 40) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t items = data[32] % 5U;
  const std::size_t head = 34 + 6 * items;
  if (size < head + 4) return 0;
  std::size_t record_size = 0;
  for (std::size_t i = 0; i < items; ++i) record_size += data[36 + 6 * i] | data[37 + 6 * i] << 8U;
  try {
    const Source source{bytes, head, static_cast<std::uint64_t>(data[4]) << 8U | data[5],
                        parse_packing(std::string_view(bytes).substr(0, head), 0, record_size)};
    sparsha::ThreadPool pool(1);
    std::uint64_t records = 0;
    (void)read_points(source, kAllLayers, pool,
                      [&](std::string_view block, std::size_t) { records += block.size() / record_size; });
    if (records != source.points) __builtin_trap();
  } catch (const Damage& damage) {
    if (damage.byte > size) __builtin_trap();
  }
  return 0;
}

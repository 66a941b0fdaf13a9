// A record: x y z and three axes as float, then bytes for red, green, blue, opacity and a quaternion. The axes are
// lengths and the colours are as they are seen.
#include "pipeline/scan/formats/splat/splat.h"

#include <algorithm>

#include "pipeline/scan/formats/splat/splats.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kRecord = 32;  // bytes

double longest_axis(const char* record) {
  return longer_axis(load<float>(record + 12), longer_axis(load<float>(record + 16), load<float>(record + 20)));
}
double opacity_of(const char* record) { return load<std::uint8_t>(record + 27) / 255.0; }

}  // namespace

bool is_splat(const ScanFile& file) { return file.extension == "splat" && looks_binary(file.bytes); }

void read_splat(const ScanFile& file, ScanWriter& out) {
  const std::size_t count = file.bytes.size() / kRecord;
  if (file.bytes.size() % kRecord != 0) {
    throw file.error(std::to_string(file.bytes.size()) + " bytes are no whole number of splats",
                     "32 bytes for each; the file may be cut short");
  }
  RawScan& scan = out.scan();
  scan.format = "splat";
  scan.fields = {"x", "y", "z", "red", "green", "blue", "opacity"};
  const int opacity = out.want("opacity");
  const char* const begin = file.bytes.data();
  SplatSieve sieve;
  const std::size_t every = std::max<std::size_t>(1, count / SplatSieve::kSample);
  for (std::size_t i = 0; i < count; i += every) {
    sieve.look_at(opacity_of(begin + i * kRecord), longest_axis(begin + i * kRecord));
  }
  sieve.decide();
  out.begin(count, true, false);
  for (std::size_t i = 0; i < count; ++i) {
    const char* const p = begin + i * kRecord;
    if ((i & 0xFFFF) == 0) file.done_before(i * kRecord);
    if (!sieve.keeps(opacity_of(p), longest_axis(p))) {
      out.add_invalid();
      continue;
    }
    if (opacity != ScanWriter::kUnwanted) out.set_field(opacity, opacity_of(p));
    const auto byte = [&](std::size_t at) { return load<std::uint8_t>(p + at); };
    out.add(load<float>(p), load<float>(p + 4), load<float>(p + 8), pack_rgba(byte(24), byte(25), byte(26)));
  }
  sieve.warn(scan);
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/inflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace sparsha::pipeline {

struct Inflater::Stream {
  z_stream z{};
  std::string_view left;
  bool ended = false, damaged = false;

  /// zlib counts in 32 bits.
  void feed() {
    if (z.avail_in > 0 || left.empty()) return;
    const std::size_t some = std::min<std::size_t>(left.size(), std::numeric_limits<uInt>::max());
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left.data()));
    z.avail_in = static_cast<uInt>(some);
    left.remove_prefix(some);
  }
  std::size_t inflate_to(char* out, std::size_t size) {
    z.next_out = reinterpret_cast<Bytef*>(out);
    z.avail_out = static_cast<uInt>(size);
    while (z.avail_out > 0 && !ended && !damaged) {
      feed();
      const int code = ::inflate(&z, Z_NO_FLUSH);
      ended = code == Z_STREAM_END;
      damaged = code != Z_OK && code != Z_STREAM_END;  // also where no byte is left
    }
    return size - z.avail_out;
  }
};

Inflater::Inflater(std::string_view packed, Wrapping wrapping) : stream_(std::make_unique<Stream>()) {
  stream_->left = packed;
  constexpr int kGzipOnly = 16 + MAX_WBITS, kRaw = -MAX_WBITS;
  if (inflateInit2(&stream_->z, wrapping == Wrapping::gzip ? kGzipOnly : kRaw) != Z_OK)
    throw std::runtime_error("zlib cannot be used");
}

Inflater::~Inflater() { inflateEnd(&stream_->z); }

std::string Inflater::read(std::size_t size) {
  std::string bytes;
  std::array<char, 1 << 16> block;
  while (bytes.size() < size) {
    const std::size_t got = stream_->inflate_to(block.data(), std::min(block.size(), size - bytes.size()));
    bytes.append(block.data(), got);
    if (got == 0) break;
  }
  return bytes;
}

bool Inflater::whole() {
  char more = 0;
  return stream_->inflate_to(&more, 1) == 0 && stream_->ended;
}

}  // namespace sparsha::pipeline

#include "tests/support/deflated.h"

#include <zlib.h>

#include <cstdint>
#include <stdexcept>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {

std::string deflated(std::string_view bytes, int window_bits) {
  z_stream z{};
  if (deflateInit2(&z, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::logic_error("zlib refuses to begin");
  std::string packed(deflateBound(&z, bytes.size()) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  const int end = deflate(&z, Z_FINISH);
  packed.resize(z.total_out);
  deflateEnd(&z);
  if (end != Z_STREAM_END) throw std::logic_error("zlib does not end");
  return packed;
}

std::string zipped(const std::vector<std::pair<std::string, std::string>>& parts, bool packs) {
  std::string bytes, directory;
  for (const auto& [name, text] : parts) {
    const std::string packed = packs ? deflated(text, -MAX_WBITS) : text;
    std::string head;  // what local and central headers share
    put(head, std::uint16_t{0});
    put(head, static_cast<std::uint16_t>(packs ? 8 : 0));
    put(head, std::uint32_t{0});
    put(head, static_cast<std::uint32_t>(
                  crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()))));
    put(head, static_cast<std::uint32_t>(packed.size()));
    put(head, static_cast<std::uint32_t>(text.size()));
    put(head, static_cast<std::uint16_t>(name.size()));
    put(head, std::uint16_t{0});
    directory += std::string("PK\x01\x02\x14\0\x14\0", 8) + head + std::string(10, '\0');
    put(directory, static_cast<std::uint32_t>(bytes.size()));
    directory += name;
    bytes += std::string("PK\x03\x04\x14\0", 6) + head + name + packed;
  }
  const std::size_t begin = bytes.size();
  bytes += directory + std::string("PK\x05\x06\0\0\0\0", 8);
  for (int k = 0; k < 2; ++k) put(bytes, static_cast<std::uint16_t>(parts.size()));
  put(bytes, static_cast<std::uint32_t>(directory.size()));
  put(bytes, static_cast<std::uint32_t>(begin));
  put(bytes, std::uint16_t{0});
  return bytes;
}

}  // namespace sparsha::pipeline::testing

#include "pipeline/scan/formats/e57/pages.h"

#include <algorithm>
#include <array>

namespace sparsha::pipeline::e57 {
namespace {

constexpr std::size_t kHeader = 48;
constexpr std::size_t kChecksum = 4;

using Table = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Table make_table() {
  constexpr std::uint32_t kPolynomial = 0x82F63B78U;  // 0x1EDC6F41 with its bits reversed
  Table table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? kPolynomial : 0);
    table[0][i] = crc;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t i = 0; i < 256; ++i) table[k][i] = table[k - 1][i] >> 8 ^ table[0][table[k - 1][i] & 255];
  }
  return table;
}

constexpr Table kTable = make_table();

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  std::uint32_t crc = ~std::uint32_t{0};
  const char* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, p += 8) {  // eight bytes a step (Kounavis & Berry 2005)
    const std::uint32_t low = load<std::uint32_t>(p) ^ crc;
    const std::uint32_t high = load<std::uint32_t>(p + 4);
    crc = kTable[7][low & 255] ^ kTable[6][low >> 8 & 255] ^ kTable[5][low >> 16 & 255] ^ kTable[4][low >> 24] ^
          kTable[3][high & 255] ^ kTable[2][high >> 8 & 255] ^ kTable[1][high >> 16 & 255] ^ kTable[0][high >> 24];
  }
  for (; left > 0; --left, ++p) crc = crc >> 8 ^ kTable[0][(crc ^ load<std::uint8_t>(p)) & 255];
  return ~crc;
}

Pages::Pages(const ScanFile& file) : file_(file) {
  const std::string_view bytes = file.bytes;
  if (bytes.size() < kHeader) throw file.error("the E57 header breaks off", "48 bytes and more");
  const auto major = load<std::uint32_t>(bytes.data() + 8);
  if (major != 1) throw file.error("E57 version " + std::to_string(major), "version 1");
  const auto length = load<std::uint64_t>(bytes.data() + 16);
  page_ = load<std::uint64_t>(bytes.data() + 40);
  if (page_ != 1024) throw file.error("E57 pages of " + std::to_string(page_) + " bytes", "1024");
  if (length != bytes.size() || length % page_ != 0) {
    throw file.error(
        "the E57 header promises " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()),
        "a complete file of whole pages");
  }
  const std::size_t data = static_cast<std::size_t>(page_) - kChecksum;
  for (std::size_t at = 0; at < bytes.size(); at += static_cast<std::size_t>(page_)) {
    const std::uint32_t stored = load<std::uint32_t, true>(bytes.data() + at + data);
    if (crc32c(bytes.substr(at, data)) != stored) {
      throw file.error("the checksum of page " + std::to_string(at / page_ + 1) + " of " +
                           std::to_string(length / page_) + " is wrong",
                       "an undamaged E57 file");
    }
    if ((at & 0x3FFFFF) == 0) file.done_before(at);
  }
  logical_size_ = length / page_ * data;
}

std::string Pages::xml() const {
  const std::uint64_t offset = logical(load<std::uint64_t>(file_.bytes.data() + 24), "XML section");
  const auto length = load<std::uint64_t>(file_.bytes.data() + 32);
  if (length > logical_size_ - offset) throw file_.error("the XML section runs beyond the file", "a complete file");
  std::string text(static_cast<std::size_t>(length), '\0');
  read(offset, text.data(), text.size());
  return text;
}

std::uint64_t Pages::logical(std::uint64_t physical, const char* what) const {
  const std::uint64_t data = page_ - kChecksum;
  if (physical >= file_.bytes.size() || physical % page_ >= data) {
    throw file_.error(
        std::string("the ") + what + " should begin at byte " + std::to_string(physical) + ", which holds no data",
        "an undamaged E57 file");
  }
  return physical / page_ * data + physical % page_;
}

void Pages::read(std::uint64_t offset, char* target, std::size_t count) const {
  if (offset > logical_size_ || count > logical_size_ - offset) {
    throw file_.error("data of the E57 file run beyond its end", "an undamaged E57 file");
  }
  const std::uint64_t data = page_ - kChecksum;
  while (count > 0) {
    const std::uint64_t within = offset % data;
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(count, data - within));
    std::memcpy(target, file_.bytes.data() + offset / data * page_ + within, piece);
    offset += piece;
    target += piece;
    count -= piece;
  }
}

void Pages::done_before(std::uint64_t offset) const {
  file_.done_before(static_cast<std::size_t>(offset / (page_ - kChecksum) * page_));
}

}  // namespace sparsha::pipeline::e57

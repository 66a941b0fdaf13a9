#include "pipeline/scan/formats/e57/points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace sparsha::pipeline::e57 {
namespace {

constexpr std::size_t kSectionHeader = 32;
constexpr unsigned kIndexPacket = 0;
constexpr unsigned kDataPacket = 1;
constexpr unsigned kEmptyPacket = 2;

}  // namespace

unsigned Field::bits() const {
  switch (kind) {
    case Kind::single:
      return 32;
    case Kind::real:
      return 64;
    case Kind::integer:
      return static_cast<unsigned>(
          std::bit_width(static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum)));
    default:
      return 0;
  }
}

void FieldStream::feed(std::span<const char> bytes) {
  const std::size_t used = bit_ / 8;
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(used));
  bit_ -= used * 8;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::uint64_t FieldStream::available() const {
  return bits_ == 0 ? std::numeric_limits<std::uint64_t>::max() : (bytes_.size() * 8 - bit_) / bits_;
}

double FieldStream::take() {
  // Least significant bit first; a value of up to 64 bits touches at most nine bytes.
  std::uint64_t raw = 0;
  if (bits_ > 0) {
    const std::size_t first = bit_ / 8;
    const auto shift = static_cast<unsigned>(bit_ % 8);
    std::array<char, 16> window{};
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(first), std::min<std::size_t>(9, bytes_.size() - first),
                window.begin());
    raw = load<std::uint64_t>(window.data()) >> shift;
    if (shift > 0) raw |= static_cast<std::uint64_t>(load<std::uint8_t>(window.data() + 8)) << (64 - shift);
    if (bits_ < 64) raw &= (std::uint64_t{1} << bits_) - 1;
    bit_ += bits_;
  }
  switch (field_->kind) {
    case Field::Kind::single:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    case Field::Kind::real:
      return std::bit_cast<double>(raw);
    default:
      return static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(field_->minimum) + raw)) *
                 field_->scale +
             field_->offset;
  }
}

void read_points(const ScanFile& file, const Pages& pages, std::uint64_t section, std::uint64_t records,
                 const std::vector<Field>& fields, const std::vector<std::size_t>& wanted,
                 const std::function<bool(std::vector<FieldStream>&)>& take) {
  if (records == 0) return;
  std::array<char, kSectionHeader> head{};
  const std::uint64_t begin = pages.logical(section, "points");
  pages.read(begin, head.data(), head.size());
  if (head[0] != 1) throw file.error("no points where the XML section says", "an undamaged E57 file");
  const std::uint64_t length = load<std::uint64_t>(head.data() + 8);
  if (length > pages.size() - begin) throw file.error("the points run beyond the file", "a complete file");
  const std::uint64_t end = begin + length;
  std::uint64_t at = pages.logical(load<std::uint64_t>(head.data() + 16), "first packet");

  std::vector<FieldStream> streams;
  unsigned bits = 0;
  for (const std::size_t i : wanted) {
    streams.emplace_back(fields[i]);
    bits += fields[i].bits();
  }
  // Without bits a packet tells nothing; with them the file's size bounds the records.
  if (records > (bits > 0 ? length * 8 / bits : 1)) {
    throw file.error(std::to_string(records) + " points cannot be in " + std::to_string(length) + " bytes",
                     "a record count that fits the data");
  }
  std::vector<char> packet;
  std::uint64_t done = 0;
  while (done < records) {
    if (at > end || end - at < 4) {
      throw file.error("the packets end after " + std::to_string(done) + " of " + std::to_string(records) + " points",
                       "a complete file");
    }
    std::array<char, 4> lead{};
    pages.read(at, lead.data(), lead.size());
    const unsigned kind = load<std::uint8_t>(lead.data());
    const std::size_t size = std::size_t{load<std::uint16_t>(lead.data() + 2)} + 1;
    if (size < 4 || size % 4 != 0 || size > end - at || kind > kEmptyPacket) {
      throw file.error("a packet of kind " + std::to_string(kind) + " and " + std::to_string(size) + " bytes",
                       "an undamaged E57 file");
    }
    if (kind == kIndexPacket || kind == kEmptyPacket) {
      at += size;
      continue;
    }
    static_assert(kDataPacket == 1);
    packet.resize(size);
    pages.read(at, packet.data(), size);
    at += size;
    const std::size_t count = size >= 6 ? load<std::uint16_t>(packet.data() + 4) : 0;
    std::size_t place = 6 + 2 * count;
    if (count != fields.size() || place > size) {
      throw file.error("a packet of " + std::to_string(count) + " streams", std::to_string(fields.size()) + " streams");
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t bytes = load<std::uint16_t>(packet.data() + 6 + 2 * i);
      if (bytes > size - place) throw file.error("a stream runs beyond its packet", "an undamaged E57 file");
      const auto stream = std::find(wanted.begin(), wanted.end(), i);
      if (stream != wanted.end()) {
        streams[static_cast<std::size_t>(stream - wanted.begin())].feed({packet.data() + place, bytes});
      }
      place += bytes;
    }
    std::uint64_t ready = records - done;
    for (const FieldStream& stream : streams) ready = std::min(ready, stream.available());
    for (std::uint64_t i = 0; i < ready; ++i) {
      if (!take(streams)) return;
    }
    done += ready;
    pages.done_before(at);
  }
}

}  // namespace sparsha::pipeline::e57

#include "pipeline/scan/formats/splat/spz.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "pipeline/scan/formats/splat/splats.h"
#include "pipeline/scan/inflate.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline {
namespace {

constexpr std::string_view kMagic = "NGSP";
constexpr std::size_t kHeader = 16;
constexpr std::size_t kMostRatio = 1032;  // deflate packs no tighter

struct Header {
  std::uint32_t version = 0;
  std::uint64_t splats = 0;
  int degree = 0;         ///< of the harmonics
  int fraction_bits = 0;  ///< of coordinates
};

Header parse_header(const ScanFile& file, const std::string& bytes) {
  Header header;
  header.version = load<std::uint32_t>(bytes.data() + 4);
  header.splats = load<std::uint32_t>(bytes.data() + 8);
  header.degree = load<std::uint8_t>(bytes.data() + 12);
  header.fraction_bits = load<std::uint8_t>(bytes.data() + 13);
  if (header.version < 1 || header.version > 3) {
    throw file.error(fmt::format("SPZ version {}", header.version), "1 to 3");
  }
  if (header.degree > 4) throw file.error(fmt::format("SPZ harmonics of degree {}", header.degree), "0 to 4");
  if (header.version > 1 && header.fraction_bits > 23) {
    throw file.error(fmt::format("SPZ coordinates with {} fractional bits", header.fraction_bits), "0 to 23");
  }
  return header;
}

/// IEEE 754 binary16.
double half_float(std::uint16_t bits) {
  const int exponent = bits >> 10U & 31U;
  const int fraction = bits & 1023U;
  const double size = exponent == 0    ? std::ldexp(fraction, -24)
                      : exponent == 31 ? (fraction == 0 ? HUGE_VAL : std::nan(""))
                                       : std::ldexp(1024 + fraction, exponent - 25);
  return (bits & 0x8000U) != 0 ? -size : size;
}

/// The logarithm of a length is kept in sixteenths from -10 on.
double axis(std::uint8_t stored) { return std::exp(stored / 16.0 - 10.0); }

std::uint8_t byte(const std::string& bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }

/// What the file keeps of f_dc, in steps of its own.
std::uint8_t channel(std::uint8_t stored) {
  constexpr double kRange = 0.15;
  return static_cast<std::uint8_t>(colour_byte(colour_of_splat((stored / 255.0 - 0.5) / kRange), ColourScale::unit));
}

}  // namespace

bool is_spz(const ScanFile& file) {
  if (file.bytes.starts_with(kMagic) && file.bytes.find('\0') < kHeader) return true;
  return file.bytes.starts_with("\x1F\x8B") &&
         Inflater(file.bytes, Inflater::Wrapping::gzip).read(kMagic.size()) == kMagic;
}

SpzSplats::SpzSplats(const ScanFile& file) {
  if (file.bytes.starts_with(kMagic)) {
    throw file.error("SPZ of version 4 or without its gzip stream", "SPZ of version 1 to 3, or the splats as PLY");
  }
  Inflater in(file.bytes, Inflater::Wrapping::gzip);
  const auto next = [&](std::size_t size, const char* what) {
    std::string bytes = in.read(size);
    if (bytes.size() < size) {
      throw file.error(fmt::format("the SPZ stream ends within its {}: {} of {} bytes", what, bytes.size(), size),
                       "a complete, undamaged file");
    }
    file.throw_if_cancelled();
    return bytes;
  };
  const Header header = parse_header(file, next(kHeader, "header"));
  const std::size_t place = header.version == 1 ? 6 : 9;
  if (header.splats * (place + 10) > file.bytes.size() * kMostRatio) {
    throw file.error(fmt::format("{} splats cannot be in {} packed bytes", header.splats, file.bytes.size()),
                     "a header that fits the file");
  }
  version_ = header.version;
  fraction_bits_ = header.fraction_bits;
  const auto count = static_cast<std::size_t>(header.splats);
  places_ = next(count * place, "positions");
  opacities_ = next(count, "opacities");
  colours_ = next(count * 3, "colours");
  axes_ = next(count * 3, "axes");
  // Turns and harmonics are not needed, but a stream that is whole has its checksum behind them.
  constexpr std::array<std::size_t, 5> kHarmonics = {0, 9, 24, 45, 72};
  for (std::size_t left = count * ((header.version == 3 ? 4 : 3) + kHarmonics[static_cast<std::size_t>(header.degree)]);
       left > 0;) {
    constexpr std::size_t kBlock = 1 << 20;
    const std::size_t now = std::min(left, kBlock);
    (void)next(now, "turns and harmonics");
    left -= now;
  }
  while (!in.read(1 << 20).empty()) file.throw_if_cancelled();  // extensions
  if (!in.whole()) throw file.error("the SPZ stream does not end whole, with its checksum", "an undamaged file");
}

double SpzSplats::coordinate(std::size_t i, std::size_t k) const {
  if (version_ == 1) return half_float(load<std::uint16_t>(places_.data() + 6 * i + 2 * k));
  const char* const at = places_.data() + 9 * i + 3 * k;
  const std::int32_t value =
      load<std::uint8_t>(at) | load<std::uint8_t>(at + 1) << 8 | load<std::int8_t>(at + 2) * 65536;
  return std::ldexp(value, -fraction_bits_);
}

double SpzSplats::longest(std::size_t i) const {
  return axis(std::max({byte(axes_, 3 * i), byte(axes_, 3 * i + 1), byte(axes_, 3 * i + 2)}));
}

double SpzSplats::opacity(std::size_t i) const { return byte(opacities_, i) / 255.0; }

std::uint32_t SpzSplats::colour(std::size_t i) const {
  return pack_rgba(channel(byte(colours_, 3 * i)), channel(byte(colours_, 3 * i + 1)),
                   channel(byte(colours_, 3 * i + 2)));
}

void read_spz(const ScanFile& file, ScanWriter& out) {
  const SpzSplats splats(file);
  RawScan& scan = out.scan();
  scan.format = fmt::format("SPZ {}", splats.version());
  scan.fields = {"x", "y", "z", "red", "green", "blue", "opacity"};
  const int slot = out.want("opacity");
  SplatSieve sieve;
  const std::size_t every = std::max<std::size_t>(1, splats.size() / SplatSieve::kSample);
  for (std::size_t i = 0; i < splats.size(); i += every) sieve.look_at(splats.opacity(i), splats.longest(i));
  sieve.decide();
  out.begin(splats.size(), true, false);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (!sieve.keeps(splats.opacity(i), splats.longest(i))) {
      out.add_invalid();
      continue;
    }
    if (slot != ScanWriter::kUnwanted) out.set_field(slot, splats.opacity(i));
    out.add(splats.coordinate(i, 0), splats.coordinate(i, 1), splats.coordinate(i, 2), splats.colour(i));
  }
  sieve.warn(scan);
}

}  // namespace sparsha::pipeline

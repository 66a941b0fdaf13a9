#include "pipeline/scan/formats/las/laz/arithmetic.h"

namespace sparsha::pipeline::laz {
namespace {

constexpr std::uint32_t kMostTotal = 1U << 15U;
constexpr std::uint32_t kMostBits = 1U << 13U;

}  // namespace

void SymbolModel::start() {
  std::uint32_t table_bits = 0;
  if (symbols_ > 16) {
    table_bits = 3;
    while (symbols_ > 1U << (table_bits + 2)) ++table_bits;
    shift_ = 15 - table_bits;
  }
  const std::size_t table = table_bits == 0 ? 0 : (std::size_t{1} << table_bits) + 2;
  memory_ = std::make_unique<std::uint16_t[]>(2 * std::size_t{symbols_} + table);
  below_ = memory_.get();
  count_ = below_ + symbols_;
  table_ = count_ + symbols_;
  std::fill_n(count_, symbols_, std::uint16_t{1});
  cycle_ = symbols_;
  update();
  left_ = cycle_ = (symbols_ + 6) / 2;
}

void SymbolModel::update() {
  total_ += cycle_;
  if (total_ > kMostTotal) {
    total_ = 0;
    for (std::uint32_t k = 0; k < symbols_; ++k) {
      count_[k] = static_cast<std::uint16_t>((count_[k] + 1U) / 2);
      total_ += count_[k];
    }
  }
  const std::uint32_t scale = 0x80000000U / total_;
  std::uint32_t sum = 0;
  std::uint32_t filled = 0;
  for (std::uint32_t k = 0; k < symbols_; ++k) {
    below_[k] = static_cast<std::uint16_t>((scale * sum) >> 16U);
    sum += count_[k];
    if (shift_ == 0) continue;
    for (const std::uint32_t cell = below_[k] >> shift_; filled < cell;) {
      table_[++filled] = static_cast<std::uint16_t>(k - 1);
    }
  }
  if (shift_ != 0) {
    table_[0] = 0;
    for (const std::uint32_t cells = 1U << (15U - shift_); filled <= cells;) {
      table_[++filled] = static_cast<std::uint16_t>(symbols_ - 1);
    }
  }
  cycle_ = std::min((5 * cycle_) / 4, (symbols_ + 6) * 8);
  left_ = cycle_;
}

void BitModel::update() {
  count_ += cycle_;
  if (count_ > kMostBits) {
    count_ = (count_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == count_) ++count_;
  }
  probability_ = (zeros_ * (0x80000000U / count_)) >> 18U;
  cycle_ = std::min((5 * cycle_) / 4, 64U);
  left_ = cycle_;
}

Decoder::Decoder(std::string_view bytes, std::size_t place)
    : begin_(reinterpret_cast<const std::uint8_t*>(bytes.data())),
      at_(begin_),
      end_(begin_ + bytes.size()),
      place_(place) {
  for (int i = 0; i < 4; ++i) value_ = value_ << 8U | next();
  if (value_ >= length_) fail("a stream that no packing begins with");
}

std::uint32_t Decoder::raw(std::uint32_t bits) {
  if (bits > 19) {
    const std::uint32_t low = raw(16);
    return raw(bits - 16) << 16U | low;
  }
  length_ >>= bits;
  const std::uint32_t symbol = value_ / length_;
  if (symbol >> bits != 0) fail("bits that no packing makes");
  value_ -= symbol * length_;
  if (length_ < kLeastLength) renormalise();
  return symbol;
}

std::uint32_t Decoder::past_end() {
  // Packing may leave out the zeros at a stream's end, of which reading is at most a few bytes ahead.
  constexpr std::uint32_t kMostPast = 4;
  if (++past_ > kMostPast) fail("the stream ends before its points do");
  return 0;
}

void Decoder::fail(const char* what) const { throw Damage{what, place_ + static_cast<std::size_t>(at_ - begin_)}; }

}  // namespace sparsha::pipeline::laz

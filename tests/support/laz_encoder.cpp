#include "tests/support/laz_encoder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"
#include "tests/support/las_files.h"

namespace sparsha::pipeline::testing {
namespace {

constexpr std::uint32_t kLeast = 1U << 24U;

/// A chunk whose points are single returns: their map's context is 0, their level 0.
std::string pack_chunk(const std::vector<std::string>& points) {
  std::string packed = points.front();
  if (points.size() == 1) return packed;
  Encoder out;
  EncoderModel changed(64);
  std::vector<EncoderModel> user(256, EncoderModel(256));
  IntegerEncoder dx(32, 2), dy(32, 22), dz(32, 20), intensity(16, 4);
  laz::RunningMedian median_x, median_y;
  std::int32_t last_z = 0;
  std::uint16_t last_intensity = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto number = [&]<class T>(std::size_t point, std::size_t at, T) {
      return laz::get<T>(reinterpret_cast<const std::uint8_t*>(points[point].data()) + at);
    };
    const auto step = [&](std::size_t at) {
      return static_cast<std::int32_t>(number(i, at, std::uint32_t{}) - number(i - 1, at, std::uint32_t{}));
    };
    const std::uint16_t bright = number(i, 12, std::uint16_t{});
    const auto note = number(i, 17, std::uint8_t{});
    const auto old_note = number(i - 1, 17, std::uint8_t{});
    // All intensities are told, so that no rule for those that are not is needed.
    const std::uint32_t bits = 16U | (note != old_note ? 2U : 0U);
    out.symbol(changed, bits);
    intensity.put(out, last_intensity, bright, 0);
    last_intensity = bright;
    if (note != old_note) out.symbol(user[old_note], note);
    dx.put(out, median_x.get(), step(0), 1);
    median_x.add(step(0));
    dy.put(out, median_y.get(), step(4), 1 + laz::even_context(dx.size(), 20));
    median_y.add(step(4));
    const std::int32_t z = number(i, 8, std::int32_t{});
    dz.put(out, last_z, z, 1 + laz::even_context((dx.size() + dy.size()) / 2, 18));
    last_z = z;
  }
  return packed + out.finish();
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

EncoderModel::EncoderModel(std::uint32_t symbols) : count_(symbols, 1), below_(symbols), cycle_(symbols) {
  update();
  left_ = cycle_ = (symbols + 6) / 2;
}

void EncoderModel::update() {
  total_ += cycle_;
  if (total_ > 32768) {
    total_ = 0;
    for (std::uint32_t& count : count_) total_ += count = (count + 1) / 2;
  }
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < count_.size(); ++k) {
    below_[k] = (0x80000000U / total_ * sum) >> 16U;
    sum += count_[k];
  }
  left_ = cycle_ = std::min(5 * cycle_ / 4, 8 * (static_cast<std::uint32_t>(count_.size()) + 6));
}

void EncoderModel::seen(std::uint32_t symbol) {
  ++count_[symbol];
  if (--left_ == 0) update();
}

void Encoder::add(std::uint32_t step) {
  base_ += step;
  if (base_ >= step) return;
  std::size_t at = out_.size();  // carry
  while (out_[--at] == '\xFF') out_[at] = '\0';
  out_[at] = static_cast<char>(static_cast<std::uint8_t>(out_[at]) + 1);
}

void Encoder::renormalise() {
  for (; length_ < kLeast; length_ <<= 8U, base_ <<= 8U) out_ += static_cast<char>(base_ >> 24U);
}

void Encoder::symbol(EncoderModel& model, std::uint32_t symbol) {
  const std::uint32_t unit = length_ >> 15U;
  const std::uint32_t low = model.below(symbol) * unit;
  length_ = (model.is_last(symbol) ? length_ : model.below(symbol + 1) * unit) - low;
  add(low);
  renormalise();
  model.seen(symbol);
}

void Encoder::raw(std::uint32_t bits, std::uint32_t value) {
  if (bits > 19) {
    raw(16, value & 0xFFFFU);
    raw(bits - 16, value >> 16U);
    return;
  }
  length_ >>= bits;
  add(value * length_);
  renormalise();
}

void Encoder::bit(Bit& model, std::uint32_t bit) {
  const std::uint32_t split = model.probability * (length_ >> 13U);
  if (bit == 0) {
    length_ = split;
    ++model.zeros;
  } else {
    length_ -= split;
    add(split);
  }
  renormalise();
  if (--model.left != 0) return;
  model.count += model.cycle;
  if (model.count > 8192) {
    model.count = (model.count + 1) / 2;
    model.zeros = (model.zeros + 1) / 2;
    if (model.zeros == model.count) ++model.count;
  }
  model.probability = model.zeros * (0x80000000U / model.count) >> 18U;
  model.left = model.cycle = std::min(5 * model.cycle / 4, 64U);
}

std::string Encoder::finish() {
  // Four bytes more than the interval needs are read ahead.
  const bool wide = length_ > 2 * kLeast;
  add(wide ? kLeast : kLeast / 2);
  length_ = wide ? kLeast / 2 : kLeast / 512;
  renormalise();
  return out_ + std::string(wide ? 3 : 2, '\0');
}

IntegerEncoder::IntegerEncoder(std::uint32_t bits, std::uint32_t contexts)
    : bits_(bits), sizes_(contexts, EncoderModel(bits + 1)) {
  for (std::uint32_t i = 1; i <= bits; ++i) differences_.emplace_back(1U << std::min(i, 8U));
}

void IntegerEncoder::put(Encoder& out, std::int32_t prediction, std::int32_t value, std::uint32_t context) {
  std::int64_t c = std::int64_t{value} - prediction;
  const std::int64_t range = std::int64_t{1} << bits_;
  if (c < -range / 2) c += range;
  if (c >= range / 2) c -= range;
  size_ = 0;
  while (c < 1 - (std::int64_t{1} << size_) || c > std::int64_t{1} << size_) ++size_;
  out.symbol(sizes_[context], size_);
  if (size_ == 0) {
    out.bit(small_, static_cast<std::uint32_t>(c));
  } else if (size_ < 32) {
    const auto u = static_cast<std::uint32_t>(c > 0 ? c - 1 : c + (std::int64_t{1} << size_) - 1);
    const std::uint32_t raw = size_ > 8 ? size_ - 8 : 0;
    out.symbol(differences_[size_ - 1], u >> raw);
    if (raw > 0) out.raw(raw, u & ((1U << raw) - 1));
  }
}

std::string pack_las(const std::vector<std::vector<std::string>>& points, std::uint32_t each) {
  LasFile file;
  file.record_user = "laszip encoded";
  file.record_id = 22204;
  append(file.record, std::uint16_t{2});
  file.record += std::string(10, '\0');
  append(file.record, each == 0 ? 0xFFFFFFFFU : each);
  file.record += std::string(16, '\0');
  for (const int number : {1, 6, 20, 2}) append(file.record, static_cast<std::uint16_t>(number));
  std::string packed = file.bytes();
  packed[104] = static_cast<char>(128);
  const std::size_t first = packed.size();
  append(packed, std::int64_t{0});
  Encoder table;
  IntegerEncoder numbers(32, 2);
  std::int32_t last_count = 0, last_size = 0;
  std::uint32_t count = 0;
  for (const std::vector<std::string>& chunk : points) {
    const std::string bytes = pack_chunk(chunk);
    packed += bytes;
    const auto held = static_cast<std::int32_t>(chunk.size());
    const auto size = static_cast<std::int32_t>(bytes.size());
    if (each == 0) numbers.put(table, last_count, held, 0);
    numbers.put(table, last_size, size, 1);
    last_count = held;
    last_size = size;
    count += static_cast<std::uint32_t>(chunk.size());
  }
  set(packed, 107, count);
  set(packed, first, static_cast<std::int64_t>(packed.size()));
  append(packed, std::uint32_t{0});
  append(packed, static_cast<std::uint32_t>(points.size()));
  return packed + table.finish();
}

}  // namespace sparsha::pipeline::testing

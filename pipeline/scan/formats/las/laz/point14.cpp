#include "pipeline/scan/formats/las/laz/point14.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace sparsha::pipeline::laz {
namespace {

// Where things are in the item.
constexpr std::size_t kX = 0, kY = 4, kZ = 8, kIntensity = 12, kReturns = 14, kFlags = 15, kClass = 16, kUser = 17,
                      kAngle = 18, kSource = 20, kTime = 22;
// Places of the streams: those of the layers.
enum Stream : std::size_t { xy, z, class_of, flags, intensity, angle, user, source, time };

/// Context from the number of returns (row) and the return.
constexpr char kReturnMap[16][17] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455",
};

void add_to(std::uint8_t* at, std::int32_t difference) {
  put(at, get<std::uint32_t>(at) + static_cast<std::uint32_t>(difference));
}
/// First and last return: bit 1 and bit 0.
std::uint32_t place_of(std::uint32_t r, std::uint32_t n) { return (r == 1 ? 2U : 0U) | (r >= n ? 1U : 0U); }

}  // namespace

Point14::Context::Context(const std::uint8_t* last) {
  std::memcpy(point.data(), last, kPoint14Size);
  last_z.fill(get<std::int32_t>(last + kZ));
  last_intensity.fill(get<std::uint16_t>(last + kIntensity));
  time.start(last + kTime);
}

Point14::Point14(const std::uint8_t* first) : present_(first[kFlags] >> 4U & 3U) {
  contexts_[present_] = std::make_unique<Context>(first);
}

std::uint32_t Point14::next_return(Decoder& in, Context& context, std::uint32_t kind, bool time_changed,
                                   std::uint32_t last) {
  if (kind == 0) return last;
  if (kind == 1) return (last + 1) & 15U;
  if (kind == 2) return (last + 15) & 15U;
  if (time_changed) return in.symbol(context.returns[last]);
  return (last + in.symbol(context.number_same_time) + 2) & 15U;
}

Channel Point14::next(std::array<LayerStream, kPoint14Layers>& streams, std::uint8_t* item) {
  Decoder& in = streams[xy].in;
  Context* context = contexts_[present_].get();
  const auto last_return = [&] { return context->point[kReturns] & 15U; };
  const auto last_number = [&] { return static_cast<std::uint32_t>(context->point[kReturns]) >> 4U; };
  const std::uint32_t first_bit = last_return() == 1 ? 1 : 0;
  const std::uint32_t last_bit = last_return() >= last_number() ? 2 : 0;
  const std::uint32_t changed = in.symbol(context->changed[first_bit | last_bit | (context->time_changed ? 4U : 0U)]);
  if (changed & 64U) {
    const std::uint32_t channel = (present_ + in.symbol(context->channel) + 1) & 3U;
    if (!contexts_[channel]) contexts_[channel] = std::make_unique<Context>(context->point.data());
    present_ = channel;
    context = contexts_[channel].get();
    context->point[kFlags] = static_cast<std::uint8_t>((context->point[kFlags] & ~0x30U) | channel << 4U);
  }
  const bool time_changed = (changed & 16U) != 0;
  std::uint32_t n = last_number();
  if (changed & 4U) n = in.symbol(context->number[n]);
  const std::uint32_t r = next_return(in, *context, changed & 3U, time_changed, last_return());
  std::uint8_t* const point = context->point.data();
  point[kReturns] = static_cast<std::uint8_t>(r | n << 4U);

  const std::uint32_t m = 2 * static_cast<std::uint32_t>(kReturnMap[n][r] - '0') + (time_changed ? 1U : 0U);
  const std::uint32_t single = n == 1 ? 1 : 0;
  const std::int32_t dx = context->dx.get(in, context->median_x[m].get(), single);
  add_to(point + kX, dx);
  context->median_x[m].add(dx);
  const std::int32_t dy =
      context->dy.get(in, context->median_y[m].get(), single + even_context(context->dx.size(), 20));
  add_to(point + kY, dy);
  context->median_y[m].add(dy);
  if (streams[z].present) {
    std::int32_t& last = context->last_z[std::min(7U, n > r ? n - r : r - n)];
    const std::uint32_t size = (context->dx.size() + context->dy.size()) / 2;
    last = context->z.get(streams[z].in, last, single + even_context(size, 18));
    put(point + kZ, last);
  }
  next_rest(streams, *context, changed, place_of(r, n));
  context->time_changed = time_changed;
  std::memcpy(item, point, kPoint14Size);
  return {present_, (changed & 64U) != 0};
}

void Point14::next_rest(std::array<LayerStream, kPoint14Layers>& streams, Context& context, std::uint32_t changed,
                        std::uint32_t place) {
  std::uint8_t* const point = context.point.data();
  const bool time_changed = (changed & 16U) != 0;
  if (streams[class_of].present) {
    SymbolModel& model = context.class_of[(point[kClass] & 31U) * 2 + (place == 3 ? 1 : 0)];
    point[kClass] = static_cast<std::uint8_t>(streams[class_of].in.symbol(model));
  }
  if (streams[flags].present) {
    const std::uint32_t last = (point[kFlags] & 15U) | (point[kFlags] & 0xC0U) >> 2U;
    const std::uint32_t now = streams[flags].in.symbol(context.flags[last]);
    point[kFlags] = static_cast<std::uint8_t>((now & 15U) | (point[kFlags] & 0x30U) | (now & 0x30U) << 2U);
  }
  if (streams[intensity].present) {
    std::uint16_t& last = context.last_intensity[2 * place + (time_changed ? 1 : 0)];
    last = static_cast<std::uint16_t>(context.intensity.get(streams[intensity].in, last, place));
    put(point + kIntensity, last);
  }
  if (streams[angle].present && (changed & 8U) != 0) {
    const std::int32_t last = get<std::int16_t>(point + kAngle);
    put(point + kAngle, static_cast<std::uint16_t>(context.angle.get(streams[angle].in, last, time_changed ? 1 : 0)));
  }
  if (streams[user].present) {
    point[kUser] = static_cast<std::uint8_t>(streams[user].in.symbol(context.user[point[kUser] / 4U]));
  }
  if (streams[source].present && (changed & 32U) != 0) {
    const std::int32_t last = get<std::uint16_t>(point + kSource);
    put(point + kSource, static_cast<std::uint16_t>(context.source.get(streams[source].in, last)));
  }
  if (streams[time].present && time_changed) context.time.next(streams[time].in, point + kTime);
}

}  // namespace sparsha::pipeline::laz

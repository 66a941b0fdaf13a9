#include "pipeline/scan/formats/las/laz/gps_time.h"

namespace sparsha::pipeline::laz {
namespace {

/// Products wrap.
std::int32_t times(std::int32_t factor, std::int32_t difference) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(factor) * static_cast<std::uint32_t>(difference));
}

}  // namespace

void GpsTime::note_extreme(std::int32_t difference) {
  if (++extremes_[last_] <= 3) return;
  difference_[last_] = difference;
  extremes_[last_] = 0;
}

void GpsTime::begin_sequence(Decoder& in) {
  newest_ = (newest_ + 1) & 3U;
  const std::int32_t high = integers_.get(in, static_cast<std::int32_t>(time_[last_] >> 32U), 8);
  time_[newest_] = std::uint64_t{static_cast<std::uint32_t>(high)} << 32U | in.raw(32);
  last_ = newest_;
  difference_[last_] = 0;
  extremes_[last_] = 0;
}

/// False: another sequence was chosen, whose step follows.
bool GpsTime::step(Decoder& in) {
  if (difference_[last_] != 0) return step_by_multiple(in);
  const std::uint32_t symbol = in.symbol(zero_) + zero_shift_;
  if (symbol == 1) {
    difference_[last_] = integers_.get(in, 0, 0);
    advance(difference_[last_]);
    extremes_[last_] = 0;
  } else if (symbol == 2) {
    begin_sequence(in);
  } else if (symbol > 2) {
    last_ = (last_ + symbol - 2) & 3U;
    return false;
  }
  return true;
}

bool GpsTime::step_by_multiple(Decoder& in) {
  std::uint32_t symbol = in.symbol(multi_);
  if (layered_ && symbol >= 511) ++symbol;
  const std::int32_t difference = difference_[last_];
  const auto multiple = static_cast<std::int32_t>(symbol);
  if (symbol == 511) return true;
  if (symbol == 512) {
    begin_sequence(in);
    return true;
  }
  if (symbol > 512) {
    last_ = (last_ + symbol - 512) & 3U;
    return false;
  }
  std::int32_t step = 0;
  if (symbol == 1) {
    step = integers_.get(in, difference, 1);
    extremes_[last_] = 0;
  } else if (symbol == 0) {
    step = integers_.get(in, 0, 7);
    note_extreme(step);
  } else if (symbol < 500) {
    step = integers_.get(in, times(multiple, difference), symbol < 10 ? 2 : 3);
  } else if (symbol == 500) {
    step = integers_.get(in, times(500, difference), 4);
    note_extreme(step);
  } else {
    step = integers_.get(in, times(500 - multiple, difference), symbol < 510 ? 5 : 6);
    if (symbol == 510) note_extreme(step);
  }
  advance(step);
  return true;
}

void GpsTime::next(Decoder& in, std::uint8_t* item) {
  constexpr int kMostSwitches = 8;
  int switches = 0;
  while (!step(in)) {
    if (++switches > kMostSwitches) in.fail("times that change their sequence for ever");
  }
  put(item, time_[last_]);
}

void GpsTimeFirst::next(Decoder& in, std::uint8_t* item) {
  auto time = get<std::uint64_t>(item);
  const auto advance = [&](std::int32_t step) { time += static_cast<std::uint64_t>(std::int64_t{step}); };
  const auto note_extreme = [&](std::int32_t step) {
    if (++extremes_ <= 3) return;
    difference_ = step;
    extremes_ = 0;
  };
  if (difference_ == 0) {
    const std::uint32_t symbol = in.symbol(zero_);
    if (symbol == 1) {
      difference_ = integers_.get(in, 0, 0);
      advance(difference_);
    } else if (symbol == 2) {
      time = in.raw64();
    }
    put(item, time);
    return;
  }
  const std::uint32_t symbol = in.symbol(multi_);
  const std::int32_t product = times(static_cast<std::int32_t>(symbol), difference_);
  if (symbol == 1) {
    difference_ = integers_.get(in, difference_, 1);
    extremes_ = 0;
    advance(difference_);
  } else if (symbol == 0) {
    const std::int32_t step = integers_.get(in, difference_ / 4, 2);
    note_extreme(step);
    advance(step);
  } else if (symbol < 510) {
    const std::int32_t step = integers_.get(in, product, symbol < 10 ? 3 : symbol < 50 ? 4 : 5);
    if (symbol == 509) note_extreme(step);
    advance(step);
  } else if (symbol == 510) {
    time = in.raw64();
  }
  put(item, time);
}

}  // namespace sparsha::pipeline::laz

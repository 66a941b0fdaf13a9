// The kept points of a bin are a bottom-k sketch of its set of points (Cohen & Kaplan 2007).
#include "pipeline/projection/crowded.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "base/numbers/hash.h"

namespace sparsha::pipeline {
namespace {

// + 0: the two zeros are one place.
std::uint64_t place_hash(float x, float y, float z) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value + 0.0F)}; };
  return hash_word(hash_word(bits(x) | (bits(y) << 32U)) ^ bits(z));
}

// Moves the kept points of bin [begin, end) to its front; how many they are.
std::uint32_t keep_some(Bins& bins, std::uint32_t begin, std::uint32_t end,
                        std::vector<std::pair<std::uint64_t, std::uint32_t>>& ranked) {
  if (end - begin <= kMostInBin) return end - begin;
  ranked.clear();
  for (std::uint32_t p = begin; p < end; ++p) ranked.emplace_back(place_hash(bins.x[p], bins.y[p], bins.z[p]), p);
  const auto kept_end = ranked.begin() + kMostInBin;
  std::nth_element(ranked.begin(), kept_end, ranked.end());
  std::sort(ranked.begin(), kept_end, [](const auto& a, const auto& b) { return a.second < b.second; });
  std::uint32_t to = begin;
  for (auto kept = ranked.begin(); kept != kept_end; ++kept, ++to) {
    bins.x[to] = bins.x[kept->second];
    bins.y[to] = bins.y[kept->second];
    bins.z[to] = bins.z[kept->second];
  }
  return to - begin;
}

}  // namespace

void leave_out_crowd(Bins& bins, const BinWindow& window, ThreadPool& pool) {
  const auto columns = static_cast<std::size_t>(bins.lattice.bins_x());
  const std::size_t first = static_cast<std::size_t>(window.first_row) * columns;
  const std::size_t last = static_cast<std::size_t>(window.last_row) * columns;
  constexpr std::size_t kBins = 1U << 14U;
  std::atomic<bool> crowded = false;
  pool.for_ranges(last - first, kBins, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = first + begin; b < first + end; ++b)
      if (bins.start[b + 1] - bins.start[b] > kMostInBin) crowded = true;
  });
  if (!crowded) return;
  std::vector<std::uint32_t> kept(last - first);
  pool.for_ranges(last - first, 16, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> ranked;
    for (std::size_t b = begin; b < end; ++b)
      kept[b] = keep_some(bins, bins.start[first + b], bins.start[first + b + 1], ranked);
  });
  std::uint32_t to = bins.start[first];
  for (std::size_t b = first; b < last; ++b) {
    const std::uint32_t from = std::exchange(bins.start[b], to);
    for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z})
      std::copy_n(array->get() + from, kept[b - first], array->get() + to);
    to += kept[b - first];
  }
  bins.points = to;
  for (Buffer<float>* array : {&bins.x, &bins.y, &bins.z}) std::fill_n(array->get() + to, Bins::kReadAhead, 0.0F);
  std::fill_n(bins.start.get() + last, 1 + Bins::kReadAhead, to);
}

void CrowdedBin::add(float x, float y, float z) {
  if (entries_.empty()) entries_.reserve(2 * kMostInBin);
  if (entries_.size() == 2 * kMostInBin) leave_out();
  entries_.push_back({place_hash(x, y, z), {x, y, z}});
}

void CrowdedBin::leave_out() {
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.hash != b.hash ? a.hash < b.hash : a.point < b.point; });
  const auto end =
      std::unique(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.point == b.point; });
  entries_.resize(std::min(static_cast<std::size_t>(end - entries_.begin()), kMostInBin));
}

std::vector<std::array<float, 3>> CrowdedBin::take() {
  leave_out();
  std::vector<std::array<float, 3>> points;
  points.reserve(entries_.size());
  for (const Entry& entry : entries_) points.push_back(entry.point);
  entries_ = {};
  return points;
}

}  // namespace sparsha::pipeline

// The points of a cube with the smallest hashes stay.
#include "pipeline/filter/thin.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

#include "base/numbers/hash.h"
#include "pipeline/filter/cells.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kCellsATime = 4096;
constexpr double kReachPerSide = 1.7320508075688772;

struct Ranked {
  std::uint64_t hash;
  float x, y, z;
  std::uint32_t rgba;
  std::uint32_t intensity;  ///< its bits
  std::uint32_t index;
};

bool before(const Ranked& a, const Ranked& b) {
  return std::tie(a.hash, a.x, a.y, a.z, a.rgba, a.intensity, a.index) <
         std::tie(b.hash, b.x, b.y, b.z, b.rgba, b.intensity, b.index);
}

Ranked ranked(const Cloud& cloud, const CellOrder::Point& p) {
  const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0F)}; };
  const std::array<std::uint64_t, 3> words{bits(p.x), bits(p.y), bits(p.z)};
  return {hash_word(hash_words(words)),
          p.x,
          p.y,
          p.z,
          cloud.rgba.empty() ? 0U : cloud.rgba[p.index],
          cloud.intensity.empty() ? 0U : std::bit_cast<std::uint32_t>(cloud.intensity[p.index]),
          p.index};
}

}  // namespace

std::vector<std::uint8_t> thinned(const Cloud& cloud, double side_m, int points, const Context& context) {
  std::vector<std::uint8_t> keep(cloud.size(), 1);
  const CellOrder order(cloud, side_m * kReachPerSide, context);
  const auto most = static_cast<std::ptrdiff_t>(points);
  context.pool.for_ranges(order.cells(), kCellsATime, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    std::vector<Ranked> here;
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto in_cell = order.points(cell);
      if (std::ssize(in_cell) <= most) continue;
      here.clear();
      for (const CellOrder::Point& p : in_cell) here.push_back(ranked(cloud, p));
      std::nth_element(here.begin(), here.begin() + most, here.end(), before);
      for (auto gone = here.begin() + most; gone != here.end(); ++gone) keep[gone->index] = 0;
    }
  });
  return keep;
}

}  // namespace sparsha::pipeline

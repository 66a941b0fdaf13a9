// A counting sort by bands, in two passes over pieces of the input.
#include "pipeline/check/points.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLeastItemsPerPiece = 1U << 14;
constexpr std::size_t kMostPieces = 512;  // each has a counter a band

}  // namespace

BandedPoints::BandedPoints(const scene::Lattice& lattice, std::size_t items, const Source& source, ThreadPool& pool)
    : start_(static_cast<std::size_t>(std::max(1, (lattice.ny + kRows - 1) / kRows)) + 1) {
  const std::size_t items_per_piece = std::max(kLeastItemsPerPiece, (items + kMostPieces - 1) / kMostPieces);
  const std::size_t bands = start_.size() - 1, pieces = (items + items_per_piece - 1) / items_per_piece;
  const auto per_band = static_cast<float>(1 / (lattice.spacing_m * kRows));
  const auto last = static_cast<float>(bands - 1);
  const auto band_of = [&](const float* p) {
    return static_cast<std::size_t>(std::clamp(p[1] * per_band, 0.0F, last));
  };

  // place[piece * bands + band]: first how many, then where the piece's points of the band go.
  std::vector<std::size_t> place(pieces * bands);
  const auto each_point = [&](std::size_t begin, std::size_t end, const auto& use) {
    const auto buffer = std::make_unique_for_overwrite<float[]>(3 * (end - begin));
    const std::size_t count = source(begin, end, buffer.get());
    for (std::size_t k = 0; k < count; ++k)
      use(buffer.get() + 3 * k, place[begin / items_per_piece * bands + band_of(buffer.get() + 3 * k)]);
  };
  pool.for_ranges(items, items_per_piece, [&](std::size_t begin, std::size_t end) {
    each_point(begin, end, [](const float*, std::size_t& count) { ++count; });
  });
  std::size_t total = 0;
  for (std::size_t band = 0; band < bands; ++band) {
    start_[band] = total;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t count = place[piece * bands + band];
      place[piece * bands + band] = total;
      total += count;
    }
  }
  start_[bands] = total;
  xyz_ = std::make_unique_for_overwrite<float[]>(3 * total);
  pool.for_ranges(items, items_per_piece, [&](std::size_t begin, std::size_t end) {
    each_point(begin, end, [&](const float* p, std::size_t& to) { std::copy_n(p, 3, xyz_.get() + 3 * to++); });
  });
}

CountedPoints BandedPoints::counted() const {
  CountedPoints points;
  points.size = size();
  points.each = [this](const CountedPoints::Use& use) { use(xyz()); };
  points.in_rows = [this](double first_row, double last_row, const CountedPoints::Use& use) {
    const auto band = [&](double row) {
      return static_cast<std::size_t>(std::clamp(std::floor(row / kRows), 0.0, static_cast<double>(bands() - 1)));
    };
    const std::size_t from = first(band(first_row)), to = first(band(last_row) + 1);
    use(xyz().subspan(3 * from, 3 * (to - from)));
  };
  return points;
}

}  // namespace sparsha::pipeline

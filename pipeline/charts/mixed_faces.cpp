// Of points of one face, distances from the planes of the discs about them are noise: cut in two where that separates
// most (Otsu 1979), the two heaps explain 2/pi of their variance. Two faces of a wall of 0.4 to 0.8 spacings explain
// 0.75 to 0.85. Of thicker walls planes take one face, and the points of the other have none.
#include "pipeline/charts/mixed_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "pipeline/projection/bins.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kSamples = 5000;    // discs: shares are known to half a percent
constexpr float kAbout = 2.3F;            // spacings from a disc: walls that are thinner mix
constexpr float kAcross = 2.5F;           // spacings along the surface: some twenty points of one face
constexpr float kBehind = 1.0F;           // spacings across it
constexpr float kSameSurface = 0.8F;      // cosine of the normals, whatever their sides
constexpr std::size_t kFewDistances = 8;  // of which no two heaps are told
constexpr double kLeastHeap = 0.2;        // of the distances
constexpr double kExcess = 0.1;           // of the explained variance, in the mean of the discs about one
constexpr double kLeastGap = 0.12;        // spacings from a heap to the middle: less is the form of few points
constexpr double kLack = 0.2;             // of the points about a disc, without a disc of their own
constexpr std::size_t kPiece = 1U << 14U;

/// Of distances from a plane.
struct Heaps {
  bool known = false;
  double excess = 0.0;  ///< of the variance that two heaps explain over what they do of noise
  double gap = 0.0;     ///< from a heap's middle to that of both
};

Heaps heaps_of(std::vector<float>& distances) {
  const std::size_t count = distances.size();
  if (count < kFewDistances) return {};
  std::sort(distances.begin(), distances.end());
  const double n = static_cast<double>(count);
  const double sum = std::accumulate(distances.begin(), distances.end(), 0.0);
  const double squares = std::inner_product(distances.begin(), distances.end(), distances.begin(), 0.0);
  const double variance = squares / n - sum / n * (sum / n);
  if (!(variance > 0.0)) return {};
  double lower = 0.0, best = 0.0;
  Heaps result{true};
  for (std::size_t k = 1; k < count; ++k) {
    lower += static_cast<double>(distances[k - 1]);
    const double share = static_cast<double>(k) / n;
    if (std::min(share, 1.0 - share) < kLeastHeap) continue;
    const double apart = (sum - lower) / (n - static_cast<double>(k)) - lower / static_cast<double>(k);
    const double between = share * (1.0 - share) * apart * apart;
    if (between <= best) continue;
    best = between;
    result.gap = 0.5 * apart;
  }
  // Of n values the best cut explains about 1/n more.
  result.excess = best / variance - 2.0 / std::numbers::pi - 1.0 / n;
  return result;
}

class Neighbourhoods {
 public:
  Neighbourhoods(const TangentDiscs& discs, double spacing_m)
      : discs_(discs),
        spacing_m_(static_cast<float>(spacing_m)),
        columns_(static_cast<std::size_t>(discs.columns.bins_x())),
        rows_(static_cast<std::size_t>(discs.columns.bins_y())) {}

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const float* record(std::uint32_t disc) const { return discs_.records.get() + kDiscRecord * disc; }
  [[nodiscard]] Vector3f foot(std::uint32_t disc) const {
    const float* r = record(disc);
    return {r[0], r[1], r[2]};
  }
  [[nodiscard]] Vector3f normal(std::uint32_t disc) const {
    const float* r = record(disc);
    return Vector3f(-r[3], -r[4], 1.0F) / std::sqrt(1.0F + r[3] * r[3] + r[4] * r[4]);
  }
  [[nodiscard]] const std::uint32_t* row(std::size_t row) const { return discs_.start.get() + row * (columns_ + 1); }

  /// Discs in the columns about one.
  template <typename Use>
  void each_near(std::size_t row, std::size_t column, const Use& use) const {
    for (std::size_t j = row > 0 ? row - 1 : 0; j <= std::min(rows_ - 1, row + 1); ++j) {
      const std::uint32_t* start = this->row(j);
      const std::uint32_t last = start[std::min(columns_ - 1, column + 1) + 1];
      for (std::uint32_t d = start[column > 0 ? column - 1 : 0]; d < last; ++d) use(d, j);
    }
  }

  /// Distances of the points about a disc in this column from the planes of their own discs.
  [[nodiscard]] Heaps heaps(std::uint32_t disc, std::size_t row, std::size_t column,
                            std::vector<float>& distances) const {
    const Vector3f place = foot(disc), upright = normal(disc);
    distances.clear();
    each_near(row, column, [&](std::uint32_t other, std::size_t) {
      const Vector3f here = normal(other);
      const float cosine = upright.dot(here);
      if (std::abs(cosine) < kSameSurface) return;
      const Vector3f apart = foot(other) - place;
      const float across = upright.dot(apart);
      if (std::abs(across) >= kBehind * spacing_m_) return;
      if ((apart - across * upright).squaredNorm() >= kAcross * kAcross * spacing_m_ * spacing_m_) return;
      distances.push_back(std::copysign(1.0F, cosine) * record(other)[5] * here.z());
    });
    return heaps_of(distances);
  }

  /// Whether two heaps lie about a disc: in the mean of the discs about it.
  [[nodiscard]] bool two_heaps(std::uint32_t disc, std::size_t row, std::size_t column) const {
    const Vector3f place = foot(disc);
    std::vector<float> distances;
    double excess = 0.0, gap = 0.0;
    int count = 0;
    each_near(row, column, [&](std::uint32_t other, std::size_t other_row) {
      const Vector3f there = foot(other);
      if ((there - place).squaredNorm() >= kAbout * kAbout * spacing_m_ * spacing_m_) return;
      const std::uint32_t* start = this->row(other_row);
      const auto other_column =
          static_cast<std::size_t>(std::upper_bound(start, start + columns_ + 1, other) - start) - 1;
      const Heaps found = heaps(other, other_row, other_column, distances);
      if (!found.known) return;
      excess += found.excess;
      gap += found.gap;
      ++count;
    });
    return count > 0 && excess > kExcess * count && gap > kLeastGap * count * static_cast<double>(spacing_m_);
  }

  [[nodiscard]] std::size_t discs_about(std::uint32_t disc, std::size_t row, std::size_t column) const {
    const Vector3f place = foot(disc);
    std::size_t count = 0;
    each_near(row, column, [&](std::uint32_t other, std::size_t) {
      count += (foot(other) - place).squaredNorm() < kAbout * kAbout * spacing_m_ * spacing_m_ ? 1 : 0;
    });
    return count;
  }

 private:
  const TangentDiscs& discs_;
  float spacing_m_;
  std::size_t columns_, rows_;
};

/// A disc and its column.
struct Sample {
  std::uint32_t disc;
  std::uint32_t row, column;
};

std::vector<Sample> samples_of(const Neighbourhoods& near) {
  std::size_t all = 0;
  for (std::size_t row = 0; row < near.rows(); ++row) all += near.row(row)[near.columns()] - near.row(row)[0];
  const std::size_t step = all / kSamples + 1;
  std::vector<Sample> samples;
  std::size_t number = 0;
  for (std::size_t row = 0; row < near.rows(); ++row) {
    const std::uint32_t* start = near.row(row);
    for (std::size_t column = 0; column < near.columns(); ++column) {
      for (std::uint32_t d = start[column]; d < start[column + 1]; ++d) {
        if (number++ % step == 0)
          samples.push_back({d, static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)});
      }
    }
  }
  return samples;
}

/// How many different points lie about each sample; they are in the order of their columns.
std::vector<std::size_t> points_about(const Neighbourhoods& near, const std::vector<Sample>& samples,
                                      const TangentDiscs& discs, const OrientedPoints& points, float reach_m,
                                      ThreadPool& pool) {
  std::vector<std::size_t> first(near.rows() * near.columns() + 1, 0);
  for (const Sample& sample : samples) ++first[sample.row * near.columns() + sample.column + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  using Found = std::tuple<std::size_t, float, float, float>;
  std::vector<Found> found;
  std::mutex mutex;
  const BinLocator locator(discs.columns);
  pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<Found> mine;
    for (std::size_t k = begin; k < end; ++k) {
      int i = 0, j = 0;
      if (!locator.locate(points.x[k], points.y[k], i, j)) continue;
      const auto column = static_cast<std::size_t>(i), row = static_cast<std::size_t>(j);
      const Vector3f place(points.x[k], points.y[k], points.z[k]);
      for (std::size_t b = row > 0 ? row - 1 : 0; b <= std::min(near.rows() - 1, row + 1); ++b) {
        const std::size_t from = first[b * near.columns() + (column > 0 ? column - 1 : 0)];
        const std::size_t to = first[b * near.columns() + std::min(near.columns() - 1, column + 1) + 1];
        for (std::size_t s = from; s < to; ++s) {
          if ((near.foot(samples[s].disc) - place).squaredNorm() < reach_m * reach_m)
            mine.emplace_back(s, place.x(), place.y(), place.z());
        }
      }
    }
    const std::lock_guard lock(mutex);
    found.insert(found.end(), mine.begin(), mine.end());
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<std::size_t> counts(samples.size(), 0);
  for (const Found& point : found) ++counts[std::get<0>(point)];
  return counts;
}

}  // namespace

MixedFaces find_mixed_faces(const TangentDiscs& discs, const OrientedPoints& points, double spacing_m,
                            ThreadPool& pool) {
  const Neighbourhoods near(discs, spacing_m);
  const std::vector<Sample> samples = samples_of(near);
  if (samples.empty()) return {};
  const std::vector<std::size_t> about =
      points_about(near, samples, discs, points, kAbout * static_cast<float>(spacing_m), pool);
  std::vector<std::uint8_t> together(samples.size(), 0), apart(samples.size(), 0);
  pool.for_ranges(samples.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Sample& sample = samples[s];
      const auto with_disc = static_cast<double>(near.discs_about(sample.disc, sample.row, sample.column));
      apart[s] = with_disc < (1.0 - kLack) * static_cast<double>(about[s]) ? 1 : 0;
      together[s] = apart[s] == 0 && near.two_heaps(sample.disc, sample.row, sample.column) ? 1 : 0;
    }
  });
  const auto share_of = [&](const std::vector<std::uint8_t>& flags) {
    return static_cast<double>(std::accumulate(flags.begin(), flags.end(), std::size_t{0})) /
           static_cast<double>(flags.size());
  };
  return {share_of(together), share_of(apart)};
}

}  // namespace sparsha::pipeline

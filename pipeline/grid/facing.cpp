// Votes by depth maps of the sample: a point that is seen from a direction faces it.
#include "pipeline/grid/facing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "pipeline/base/hash.h"

namespace sparsha::pipeline {
namespace {

constexpr double kMost = 40000.0;      // points of the sample
constexpr int kNeighbours = 10;        // of a sample's plane
constexpr double kCellSpacings = 3.0;  // of a depth map: an empty cell is one in 8000
constexpr float kOblique = 0.25F;      // cosine under which a direction says nothing about a point
constexpr double kSheet = 0.7;         // spacings across a surface that are still the same
constexpr float kAligned = 0.6F;       // cosine of normals that belong to one surface
constexpr int kRounds = 4;             // of votes handed to neighbours
constexpr float kSure = 0.5F;          // mean vote, in directions seen from
constexpr float kLowest = -std::numeric_limits<float>::infinity();
constexpr double kAgreement = 0.9;  // of a connected surface's votes, by weight
constexpr std::size_t kGrain = 512;
constexpr std::size_t kPiece = 1U << 14U;

std::uint64_t hash_of(float x, float y, float z) {
  return hash_words(std::array<std::uint64_t, 3>{std::bit_cast<std::uint32_t>(x), std::bit_cast<std::uint32_t>(y),
                                                 std::bit_cast<std::uint32_t>(z)});
}

OrientedPoints draw_sample(const OrientedPieces& pieces, std::uint64_t count, ThreadPool& pool) {
  const double share = std::min(1.0, kMost / std::max(1.0, static_cast<double>(count)));
  const auto limit = static_cast<std::uint32_t>(share * 4294967295.0);
  std::vector<std::array<float, 3>> drawn;
  std::mutex mutex;
  pieces([&](const OrientedPoints& points) {
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::vector<std::array<float, 3>> mine;
      for (std::size_t k = begin; k < end; ++k) {
        if (static_cast<std::uint32_t>(mix_bits(hash_of(points.x[k], points.y[k], points.z[k]))) > limit) continue;
        if (points.x[k] < OrientedPoints::kFarAway) mine.push_back({points.x[k], points.y[k], points.z[k]});
      }
      const std::lock_guard lock(mutex);
      drawn.insert(drawn.end(), mine.begin(), mine.end());
    });
  });
  OrientedPoints sample;
  sample.count = drawn.size();
  sample.x = make_buffer<float>(sample.count);
  sample.y = make_buffer<float>(sample.count);
  sample.z = make_buffer<float>(sample.count);
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    sample.x[k] = drawn[k][0];
    sample.y[k] = drawn[k][1];
    sample.z[k] = drawn[k][2];
  }
  return sample;
}

/// The directions from the middle of a cube to its faces, edges and corners.
std::vector<Eigen::Vector3f> all_directions() {
  std::vector<Eigen::Vector3f> directions;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        directions.push_back(
            Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)).normalized());
      }
    }
  }
  return directions;
}

/// Samples that are connected, and which of them have opposed normals: a forest with a sign on every branch.
class SurfaceParts {
 public:
  struct Place {
    std::uint32_t root;
    bool opposed;  // to the root
  };
  explicit SurfaceParts(std::size_t samples) : up_(samples), opposed_(samples, 0), size_(samples, 1) {
    std::iota(up_.begin(), up_.end(), 0U);
  }

  [[nodiscard]] Place find(std::uint32_t sample) const {
    bool opposed = false;
    while (up_[sample] != sample) {
      opposed = opposed != (opposed_[sample] != 0);
      sample = up_[sample];
    }
    return {sample, opposed};
  }
  void join(std::uint32_t a, std::uint32_t b, bool opposed) {
    Place of_a = find(a);
    Place of_b = find(b);
    if (of_a.root == of_b.root) return;
    if (size_[of_a.root] < size_[of_b.root]) std::swap(of_a, of_b);
    up_[of_b.root] = of_a.root;  // the smaller below the larger keeps branches short
    size_[of_a.root] += size_[of_b.root];
    opposed_[of_b.root] = (of_a.opposed != of_b.opposed) != opposed ? 1 : 0;
  }

 private:
  std::vector<std::uint32_t> up_;
  std::vector<std::uint8_t> opposed_;
  std::vector<std::uint32_t> size_;
};

/// What is seen of points from one direction: square cells across it, the nearest depth in each.
struct DepthMap {
  Eigen::Vector3f right, up, towards;
  float cell_m, u0 = 0.0F, v0 = 0.0F;
  int nu = 1, nv = 1;
  std::vector<std::uint32_t> nearest;  // sample, or kNone
  static constexpr std::uint32_t kNone = 0xffffffffU;

  DepthMap(const Eigen::Vector3f& direction, float cell)
      : right(direction.unitOrthogonal()), up(direction.cross(right)), towards(direction), cell_m(cell) {}

  [[nodiscard]] std::size_t cell_of(const Eigen::Vector3f& p) const {
    const int i = std::clamp(static_cast<int>((p.dot(right) - u0) / cell_m), 0, nu - 1);
    const int j = std::clamp(static_cast<int>((p.dot(up) - v0) / cell_m), 0, nv - 1);
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(i);
  }
};

}  // namespace

FacingField::FacingField(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                         double spacing_m, ThreadPool& pool) {
  const OrientedPoints sample = draw_sample(pieces, totals.count, pool);
  const double thinned = static_cast<double>(totals.count) / std::max<double>(1.0, static_cast<double>(sample.count));
  spacing_m_ = spacing_m * std::sqrt(std::max(1.0, thinned));
  DiscRule rule;
  rule.spacing_m = spacing_m_;
  rule.neighbours = kNeighbours;
  rule.least_nz = 0.01;
  BinLattice columns;
  columns.spacing_m = disc_column_m(rule);
  columns.x0_m = extent.xmin_m;
  columns.y0_m = extent.ymin_m;
  columns.nx = static_cast<int>(extent.width_m() / columns.spacing_m) + 2;
  columns.ny = static_cast<int>(extent.height_m() / columns.spacing_m) + 2;
  samples_ = find_discs(sample, {}, columns, BinWindow::all(columns), rule, true, pool);

  const auto row_length = static_cast<std::size_t>(columns.bins_x());
  for (std::size_t row = 0; row < static_cast<std::size_t>(columns.bins_y()); ++row) {
    const std::uint32_t* start = samples_.start.get() + row * (row_length + 1);
    for (std::uint32_t d = start[0]; d < start[row_length]; ++d) of_slot_.push_back(d);
  }
  const std::size_t size = of_slot_.empty() ? 0 : of_slot_.back() + 1;
  for (std::vector<float>* values : {&normal_x_, &normal_y_, &normal_z_, &votes_}) values->assign(size, 0.0F);
  for (const std::uint32_t d : of_slot_) {
    const float a = samples_.slope_x[d];
    const float b = samples_.slope_y[d];
    normal_z_[d] = 1.0F / std::sqrt(1.0F + a * a + b * b);
    normal_x_[d] = -a * normal_z_[d];
    normal_y_[d] = -b * normal_z_[d];
  }
  vote(pool);
  find_neighbours(pool);
  spread_votes(pool);
  overrule_by_surface();
  near_.clear();
  near_counts_.clear();

  // Most discs lie where no sample near may face away, which needs no closer look.
  const auto nx = row_length;
  const auto ny = static_cast<std::size_t>(columns.bins_y());
  std::vector<float> own(nx * ny, kLowest);
  std::vector<std::uint8_t> empty(own.size(), 0);
  for (std::size_t c = 0; c < own.size(); ++c) {
    const std::uint32_t* start = samples_.start.get() + c / nx * (nx + 1) + c % nx;
    empty[c] = start[0] == start[1] ? 1 : 0;
    for (std::uint32_t d = start[0]; d < start[1]; ++d) {
      if (votes_[d] <= 0.0F) own[c] = std::max(own[c], samples_.height(d));
    }
  }
  away_top_m_.assign(own.size(), kLowest);
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      for (std::size_t b = j > 0 ? j - 1 : 0; b <= std::min(ny - 1, j + 1); ++b) {
        for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(nx - 1, i + 1); ++a) {
          away_top_m_[j * nx + i] = std::max(away_top_m_[j * nx + i], own[b * nx + a]);
        }
      }
      if (empty[j * nx + i] != 0) away_top_m_[j * nx + i] = -kLowest;  // nothing known: always look
      away_top_m_[j * nx + i] += static_cast<float>(2.5 * spacing_m_);
    }
  }
}

double FacingField::share_turned_away() const {
  std::size_t seen = 0;
  std::size_t turned = 0;
  for (const std::uint32_t d : of_slot_) {
    if (seen_[d] == 0) continue;
    ++seen;
    turned += votes_[d] < -kSure ? 1 : 0;
  }
  return seen == 0 ? 0.0 : static_cast<double>(turned) / static_cast<double>(seen);
}

void FacingField::vote(ThreadPool& pool) {
  const std::vector<Eigen::Vector3f> directions = all_directions();
  std::vector<std::vector<float>> votes(directions.size());
  const auto place = [&](std::uint32_t d) { return Eigen::Vector3f(samples_.x[d], samples_.y[d], samples_.height(d)); };
  pool.for_ranges(directions.size(), 1, [&](std::size_t number, std::size_t) {
    DepthMap map(directions[number], static_cast<float>(kCellSpacings * spacing_m_));
    float u1 = kLowest;
    float v1 = kLowest;
    map.u0 = map.v0 = -kLowest;
    for (const std::uint32_t d : of_slot_) {
      const float u = place(d).dot(map.right);
      const float v = place(d).dot(map.up);
      map.u0 = std::min(map.u0, u);
      map.v0 = std::min(map.v0, v);
      u1 = std::max(u1, u);
      v1 = std::max(v1, v);
    }
    if (of_slot_.empty()) return;
    map.nu = static_cast<int>((u1 - map.u0) / map.cell_m) + 1;
    map.nv = static_cast<int>((v1 - map.v0) / map.cell_m) + 1;
    map.nearest.assign(static_cast<std::size_t>(map.nu) * static_cast<std::size_t>(map.nv), DepthMap::kNone);
    for (const std::uint32_t d : of_slot_) {
      std::uint32_t& nearest = map.nearest[map.cell_of(place(d))];
      if (nearest == DepthMap::kNone || place(d).dot(map.towards) > place(nearest).dot(map.towards)) nearest = d;
    }
    std::vector<float>& mine = votes[number];
    mine.assign(votes_.size(), 0.0F);
    for (const std::uint32_t d : of_slot_) {
      const Eigen::Vector3f normal(normal_x_[d], normal_y_[d], normal_z_[d]);
      const float cosine = normal.dot(map.towards);
      if (std::abs(cosine) < kOblique) continue;
      // What is seen lies on the nearest point's surface; another sheet before it, however close, hides it.
      const Eigen::Vector3f before = place(map.nearest[map.cell_of(place(d))]) - place(d);
      if (std::abs(normal.dot(before)) <= static_cast<float>(kSheet * spacing_m_)) mine[d] = cosine;
    }
  });
  seen_.assign(votes_.size(), 0);
  for (std::size_t number = 0; number < directions.size(); ++number) {
    const std::vector<float>& mine = votes[number];
    const bool viewer = directions[number].z() > 0.99F;
    for (std::size_t d = 0; d < mine.size(); ++d) {
      votes_[d] += mine[d];
      if (viewer) seen_[d] = mine[d] != 0.0F ? 1 : 0;
    }
  }
}

template <typename Use>
bool FacingField::for_near(float x, float y, const Use& use) const {
  const BinRuler ruler(samples_.columns);
  int column = 0;
  int row = 0;
  if (!ruler.locate(x, y, column, row)) return false;
  const int nx = samples_.columns.bins_x();
  const int ny = samples_.columns.bins_y();
  for (int j = std::max(0, row - 1); j <= std::min(ny - 1, row + 1); ++j) {
    const std::uint32_t* start = samples_.start.get() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx + 1);
    for (std::uint32_t d = start[std::max(0, column - 1)]; d < start[std::min(nx - 1, column + 1) + 1]; ++d) use(d);
  }
  return true;
}

// Neighbours on the same surface: near, with a normal that is nearly parallel, and not before or behind.
void FacingField::find_neighbours(ThreadPool& pool) {
  const auto reach2 = static_cast<float>(4.0 * spacing_m_ * spacing_m_);
  const auto sheet = static_cast<float>(kSheet * spacing_m_);
  near_.resize((of_slot_.size() + kGrain - 1) / kGrain);
  near_counts_.resize(of_slot_.size());
  pool.for_ranges(of_slot_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbour>& mine = near_[begin / kGrain];
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t d = of_slot_[k];
      const std::size_t before = mine.size();
      for_near(samples_.x[d], samples_.y[d], [&](std::uint32_t e) {
        const float dx = samples_.x[e] - samples_.x[d];
        const float dy = samples_.y[e] - samples_.y[d];
        const float dz = samples_.height(e) - samples_.height(d);
        const float across = normal_x_[d] * dx + normal_y_[d] * dy + normal_z_[d] * dz;
        if (dx * dx + dy * dy + dz * dz > reach2 || std::abs(across) > sheet) return;
        const float cosine = normal_x_[d] * normal_x_[e] + normal_y_[d] * normal_y_[e] + normal_z_[d] * normal_z_[e];
        if (std::abs(cosine) >= kAligned) mine.push_back({e, cosine});
      });
      near_counts_[k] = static_cast<std::uint32_t>(mine.size() - before);
    }
  });
}

// Half of a sample's vote becomes, several times over, the mean of its neighbours'.
void FacingField::spread_votes(ThreadPool& pool) {
  std::vector<float> spread(votes_.size(), 0.0F);
  for (int round = 0; round < kRounds; ++round) {
    pool.for_ranges(of_slot_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      const Neighbour* neighbour = near_[begin / kGrain].data();
      for (std::size_t k = begin; k < end; ++k) {
        float sum = 0.0F;
        for (std::uint32_t n = 0; n < near_counts_[k]; ++n, ++neighbour) {
          sum += neighbour->cosine * std::abs(neighbour->cosine) * votes_[neighbour->sample];
        }
        const std::uint32_t d = of_slot_[k];
        spread[d] = 0.5F * votes_[d] + 0.5F * sum / static_cast<float>(near_counts_[k] + 1);
      }
    });
    votes_.swap(spread);
  }
}

// The inside of a wall is seen through a hole as well as its outside around it: only the surface that connects the two,
// around the wall's rim, tells. So normals are aligned along the flattest connections (Hoppe et al. 1992, section 3.3),
// and where the votes of a connected surface agree well, those that do not are overruled.
void FacingField::overrule_by_surface() {
  struct Edge {
    std::uint32_t a, b;
    bool opposed;
  };
  constexpr std::size_t kBuckets = 256;
  std::vector<std::vector<Edge>> edges(kBuckets);
  const Neighbour* cursor = nullptr;
  for (std::size_t k = 0; k < of_slot_.size(); ++k) {
    if (k % kGrain == 0) cursor = near_[k / kGrain].data();
    for (std::uint32_t n = 0; n < near_counts_[k]; ++n, ++cursor) {
      if (cursor->sample <= of_slot_[k]) continue;
      const float bent = (1.0F - std::min(1.0F, std::abs(cursor->cosine))) / (1.0F - kAligned);
      const auto bucket = std::min(kBuckets - 1, static_cast<std::size_t>(bent * static_cast<float>(kBuckets)));
      edges[bucket].push_back({of_slot_[k], cursor->sample, cursor->cosine < 0.0F});
    }
  }
  SurfaceParts parts(votes_.size());
  for (const std::vector<Edge>& bucket : edges) {
    for (const Edge& edge : bucket) parts.join(edge.a, edge.b, edge.opposed);
  }
  std::vector<double> sum(votes_.size(), 0.0);
  std::vector<double> size(votes_.size(), 0.0);
  for (const std::uint32_t d : of_slot_) {
    const SurfaceParts::Place place = parts.find(d);
    sum[place.root] += static_cast<double>(place.opposed ? -votes_[d] : votes_[d]);
    size[place.root] += static_cast<double>(std::abs(votes_[d]));
  }
  for (const std::uint32_t d : of_slot_) {
    const SurfaceParts::Place place = parts.find(d);
    if (!(std::abs(sum[place.root]) >= kAgreement * size[place.root])) continue;
    const bool outwards = (sum[place.root] > 0.0) != place.opposed;
    votes_[d] = std::max(std::abs(votes_[d]), 2.0F * kSure) * (outwards ? 1.0F : -1.0F);
  }
}

float FacingField::facing(float x, float y, float z, float slope_x, float slope_y) const {
  const float nz = 1.0F / std::sqrt(1.0F + slope_x * slope_x + slope_y * slope_y);
  const float nx = -slope_x * nz;
  const float ny = -slope_y * nz;
  const auto reach2 = static_cast<float>(4.0 * spacing_m_ * spacing_m_);
  const auto sheet = static_cast<float>(kSheet * spacing_m_);
  float sum = 0.0F;
  float total = 0.0F;
  for_near(x, y, [&](std::uint32_t d) {
    const float dx = samples_.x[d] - x;
    const float dy = samples_.y[d] - y;
    const float dz = samples_.height(d) - z;
    const float distance2 = dx * dx + dy * dy + dz * dz;
    if (distance2 > reach2 || std::abs(nx * dx + ny * dy + nz * dz) > sheet) return;
    const float cosine = normal_x_[d] * nx + normal_y_[d] * ny + normal_z_[d] * nz;
    if (std::abs(cosine) < kAligned) return;
    const float weight = 1.0F - distance2 / reach2;
    sum += weight * cosine * votes_[d];
    total += weight * std::abs(cosine);
  });
  if (!(total > 0.0F)) return 0.0F;
  return sum > kSure * total ? 1.0F : sum < -kSure * total ? -1.0F : 0.0F;
}

void FacingField::set_facing(TangentDiscs& discs, ThreadPool& pool) const {
  const BinRuler ruler(samples_.columns);
  const auto row_length = static_cast<std::size_t>(discs.columns.bins_x());
  const auto first = static_cast<std::size_t>(discs.window.first_row);
  pool.for_ranges(static_cast<std::size_t>(discs.window.last_row) - first, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = first + begin; row < first + end; ++row) {
      const std::uint32_t* start = discs.start.get() + row * (row_length + 1);
      for (std::uint32_t d = start[0]; d < start[row_length]; ++d) {
        int column = 0;
        int sample_row = 0;
        if (!ruler.locate(discs.x[d], discs.y[d], column, sample_row)) continue;
        const std::size_t c =
            static_cast<std::size_t>(sample_row) * static_cast<std::size_t>(samples_.columns.bins_x()) +
            static_cast<std::size_t>(column);
        const float z = discs.height(d);
        discs.facing(d) =
            z > away_top_m_[c] ? 1.0F : facing(discs.x[d], discs.y[d], z, discs.slope_x[d], discs.slope_y[d]);
      }
    }
  });
}

}  // namespace sparsha::pipeline

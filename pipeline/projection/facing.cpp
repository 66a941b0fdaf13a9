// Votes by depth maps of the sample: a point that is seen from a direction faces it.
#include "pipeline/projection/facing.h"
#include "pipeline/projection/facing_rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "base/numbers/hash.h"
#include "pipeline/projection/steady.h"

namespace sparsha::pipeline {
namespace {

constexpr int kNeighbours = 10;        // of a sample's plane
constexpr double kCellSpacings = 3.0;  // of a depth map: an empty cell is one in 8000
constexpr double kMostCells = 4e6;     // of a depth map; an object alone needs thousands
constexpr float kOblique = 0.25F;      // cosine under which a direction says nothing about a point
constexpr float kLowest = -std::numeric_limits<float>::infinity();
constexpr double kAgreement = 0.9;        // of a connected surface's votes, by weight,
constexpr double kWholeAgreement = 0.55;  // and where a surface is known to have one outer side
// A part agrees on its side when it has so many samples, whose votes agree by kAgreement. It is sure of it when its
// mean vote, in directions seen from, is so great. A face that nothing hides has 5 to 6, one of a notch 4.5, a ball on
// a plinth beside another one 3.6; the inside of a shell that is seen through its foot had between 1.5 and 3.
constexpr std::uint32_t kAgreeingSamples = 20;
constexpr double kSureMean = 3.0;
// Of a closed surface's area as the viewer sees it a half faces away; of one whose foot was not scanned, less.
constexpr double kOtherSide = 0.15;
constexpr std::size_t kPiece = 1U << 14U;

/// Names the cells, a part of a point spacing wide, that points lie in. They begin where the points do, so that the
/// cells of a cloud that is moved by less than its points are apart hold the same points: a hash of the coordinates
/// themselves would choose other points and, where votes are close, another side.
class SampleCells {
 public:
  SampleCells(const PointTotals& totals, const Extent& extent, double spacing_m)
      : x0_m_(extent.xmin_m),
        y0_m_(extent.ymin_m),
        z0_m_(static_cast<double>(totals.min_m.z())),
        per_m_(1.0 / (kSide * steady(spacing_m))) {}

  [[nodiscard]] std::uint64_t hash_of(float x, float y, float z) const {
    return hash_words(std::array<std::uint64_t, 3>{cell(x, x0_m_), cell(y, y0_m_), cell(z, z0_m_)});
  }

 private:
  static constexpr double kSide = 0.25;  // spacings
  static constexpr double kMost = 1e15;  // cells; a point so far away is no part of the surface

  [[nodiscard]] std::uint64_t cell(float value, double from) const {
    const double cells = std::floor((static_cast<double>(value) - from) * per_m_);
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::clamp(cells, -kMost, kMost)));
  }

  double x0_m_, y0_m_, z0_m_, per_m_;
};

OrientedPoints draw_sample(const OrientedPieces& pieces, const SampleCells& cells, double wanted, std::uint64_t count,
                           ThreadPool& pool) {
  const double share = std::min(1.0, wanted / std::max(1.0, static_cast<double>(count)));
  const auto limit = static_cast<std::uint32_t>(share * 4294967295.0);
  std::vector<std::array<float, 3>> drawn;
  std::mutex mutex;
  pieces([&](const OrientedPoints& points) {
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::vector<std::array<float, 3>> mine;
      for (std::size_t k = begin; k < end; ++k) {
        if (!(points.x[k] < OrientedPoints::kFarAway)) continue;
        const std::uint64_t hash = cells.hash_of(points.x[k], points.y[k], points.z[k]);
        if (static_cast<std::uint32_t>(mix_bits(hash)) > limit) continue;
        mine.push_back({points.x[k], points.y[k], points.z[k]});
      }
      const std::lock_guard lock(mutex);
      drawn.insert(drawn.end(), mine.begin(), mine.end());
    });
  });
  pieces.join(drawn);
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

/// Samples that are connected, and which of them have opposed normals: a forest with a sign on every branch. Roots know
/// the votes of their part.
class SurfaceParts {
 public:
  struct Place {
    std::uint32_t root;
    bool opposed;  // to the root
  };
  explicit SurfaceParts(const std::vector<float>& votes)
      : up_(votes.size()), opposed_(votes.size(), 0), size_(votes.size(), 1), sum_(votes.begin(), votes.end()) {
    std::iota(up_.begin(), up_.end(), 0U);
    weight_.reserve(votes.size());
    for (const float vote : votes) weight_.push_back(std::abs(static_cast<double>(vote)));
  }

  [[nodiscard]] Place find(std::uint32_t sample) const {
    bool opposed = false;
    while (up_[sample] != sample) {
      opposed = opposed != (opposed_[sample] != 0);
      sample = up_[sample];
    }
    return {sample, opposed};
  }
  /// Of a root's part, as the root's normal points: the sum of its votes, and that of their magnitudes.
  [[nodiscard]] double sum(std::uint32_t root) const { return sum_[root]; }
  [[nodiscard]] double weight(std::uint32_t root) const { return weight_[root]; }

  /// Joins the parts of two samples. False, and nothing is joined, where both have a mean vote of `least_mean` or more
  /// and agree on sides that the join would make contradict each other.
  bool join(std::uint32_t a, std::uint32_t b, bool opposed, double least_mean) {
    Place of_a = find(a);
    Place of_b = find(b);
    if (of_a.root == of_b.root) return true;
    const bool roots_opposed = (of_a.opposed != of_b.opposed) != opposed;
    const bool contradict = ((sum_[of_a.root] > 0.0) != (sum_[of_b.root] > 0.0)) != roots_opposed;
    if (contradict && agrees(of_a.root, least_mean) && agrees(of_b.root, least_mean)) return false;
    if (size_[of_a.root] < size_[of_b.root]) std::swap(of_a, of_b);
    up_[of_b.root] = of_a.root;  // the smaller below the larger keeps branches short
    size_[of_a.root] += size_[of_b.root];
    sum_[of_a.root] += roots_opposed ? -sum_[of_b.root] : sum_[of_b.root];
    weight_[of_a.root] += weight_[of_b.root];
    opposed_[of_b.root] = roots_opposed ? 1 : 0;
    return true;
  }

 private:
  [[nodiscard]] bool agrees(std::uint32_t root, double least_mean) const {
    return size_[root] >= kAgreeingSamples && std::abs(sum_[root]) >= least_mean * static_cast<double>(size_[root]) &&
           std::abs(sum_[root]) >= kAgreement * weight_[root];
  }

  std::vector<std::uint32_t> up_;
  std::vector<std::uint8_t> opposed_;
  std::vector<std::uint32_t> size_;
  std::vector<double> sum_, weight_;
};

/// What is seen of points from one direction: square cells across it, the nearest depth in each.
struct DepthMap {
  Eigen::Vector3f right, up, towards;
  std::vector<float> u, v, depth;      // of each point; larger depths are nearer
  std::vector<std::uint32_t> cell;     // of each point
  std::vector<std::uint32_t> nearest;  // point of each cell, or kNone
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit DepthMap(const Eigen::Vector3f& direction)
      : right(direction.unitOrthogonal()), up(direction.cross(right)), towards(direction) {}

  /// Requires points, `count` of them.
  void draw(std::size_t count, const float* x, const float* y, const float* z, float cell_m) {
    u.resize(count);
    v.resize(count);
    depth.resize(count);
    cell.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      u[k] = x[k] * right.x() + y[k] * right.y() + z[k] * right.z();
      v[k] = x[k] * up.x() + y[k] * up.y() + z[k] * up.z();
      depth[k] = x[k] * towards.x() + y[k] * towards.y() + z[k] * towards.z();
    }
    const auto [u0, u1] = std::minmax_element(u.begin(), u.end());
    const auto [v0, v1] = std::minmax_element(v.begin(), v.end());
    // Points far behind the others must not cost memory: cells that are too many become larger, which hides more.
    const auto across = [&](float range) {
      return std::floor(static_cast<double>(range) / static_cast<double>(cell_m)) + 1.0;
    };
    while (across(*u1 - *u0) * across(*v1 - *v0) > kMostCells) cell_m *= 2.0F;
    const int nu = static_cast<int>(across(*u1 - *u0));
    const int nv = static_cast<int>(across(*v1 - *v0));
    nearest.assign(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv), kNone);
    for (std::size_t k = 0; k < count; ++k) {
      const int i = std::clamp(static_cast<int>((u[k] - *u0) / cell_m), 0, nu - 1);
      const int j = std::clamp(static_cast<int>((v[k] - *v0) / cell_m), 0, nv - 1);
      cell[k] = static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(nu) + static_cast<std::uint32_t>(i);
      std::uint32_t& here = nearest[cell[k]];
      if (here == kNone || depth[k] > depth[here]) here = static_cast<std::uint32_t>(k);
    }
  }
};

}  // namespace

FacingField::FacingField(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                         double spacing_m, double samples, const std::vector<StationView>& stations,
                         SideEvidence evidence, ThreadPool& pool) {
  const OrientedPoints sample =
      draw_sample(pieces, SampleCells(totals, extent, spacing_m), samples, totals.count, pool);
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
    const std::uint32_t first = row_begin(row);
    for (std::uint32_t d = first; d < first + row_size(row); ++d) of_slot_.push_back(d);
  }
  const std::size_t size = of_slot_.empty() ? 0 : of_slot_.back() + 1;
  for (std::vector<float>* values : {&height_, &normal_x_, &normal_y_, &normal_z_, &votes_}) {
    values->assign(size + FacingKernel::kReadAhead, 0.0F);
  }
  for (const std::uint32_t d : of_slot_) {
    const float a = samples_.slope_x[d];
    const float b = samples_.slope_y[d];
    height_[d] = samples_.height(d);
    normal_z_[d] = 1.0F / std::sqrt(1.0F + a * a + b * b);
    normal_x_[d] = -a * normal_z_[d];
    normal_y_[d] = -b * normal_z_[d];
  }
  vote(pool);
  find_neighbours(pool);
  spread_votes(pool);
  overrule_by_surface(evidence);
  told_.assign(votes_.size(), 0);
  if (!stations.empty()) ask_stations(stations);
  if (evidence == SideEvidence::certain) forget_views();
  told_votes_.assign(votes_.size(), 0.0F);
  closed_votes_.assign(votes_.size(), 0.0F);
  for (const std::uint32_t d : of_slot_) {
    if (told_[d] != 0) told_votes_[d] = votes_[d];
    if (closed_[d] != 0) closed_votes_[d] = votes_[d];
  }
  near_.clear();
  near_counts_.clear();
  part_ = {};
  part_side_ = {};

  // Most discs lie where no sample near may face away, which needs no closer look.
  const auto nx = row_length;
  const auto ny = static_cast<std::size_t>(columns.bins_y());
  std::vector<float> own(nx * ny, kLowest);
  std::vector<std::uint8_t> empty(own.size(), 0);
  for (std::size_t c = 0; c < own.size(); ++c) {
    const std::uint32_t* start = samples_.start.get() + c / nx * (nx + 1) + c % nx;
    empty[c] = start[0] == start[1] ? 1 : 0;
    for (std::uint32_t d = start[0]; d < start[1]; ++d) {
      if (votes_[d] <= 0.0F) own[c] = std::max(own[c], height_[d]);
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

void FacingField::vote(ThreadPool& pool) {
  const std::vector<Eigen::Vector3f> directions = all_directions();
  std::vector<std::vector<float>> votes(directions.size());
  if (of_slot_.empty()) return;
  const std::size_t count = of_slot_.size();
  std::vector<float> x(count), y(count), z(count);
  for (std::size_t k = 0; k < count; ++k) {
    x[k] = samples_.x[of_slot_[k]];
    y[k] = samples_.y[of_slot_[k]];
    z[k] = height_[of_slot_[k]];
  }
  pool.for_ranges(directions.size(), 1, [&](std::size_t number, std::size_t) {
    DepthMap map(directions[number]);
    map.draw(count, x.data(), y.data(), z.data(), static_cast<float>(kCellSpacings * spacing_m_));
    std::vector<float>& mine = votes[number];
    mine.assign(votes_.size(), 0.0F);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t d = of_slot_[k];
      const Eigen::Vector3f normal(normal_x_[d], normal_y_[d], normal_z_[d]);
      const float cosine = normal.dot(map.towards);
      if (std::abs(cosine) < kOblique) continue;
      // What is seen lies on the nearest point's surface; another sheet before it, however close, hides it.
      const std::uint32_t nearest = map.nearest[map.cell[k]];
      const Eigen::Vector3f before(x[nearest] - x[k], y[nearest] - y[k], z[nearest] - z[k]);
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

// Neighbours on the same surface: near, with a normal that is nearly parallel, and not before or behind.
void FacingField::find_neighbours(ThreadPool& pool) {
  const FacingKernel shared = kernel();
  near_.resize(shared.rows);
  near_counts_.assign(votes_.size(), 0);
  pool.for_ranges(shared.rows, 1, [&](std::size_t row, std::size_t) {
    std::vector<std::uint32_t> aligned;
    std::vector<float> cosine;
    std::vector<Neighbour> all;  // of the row: kept without what a growing array has to spare
    for (std::size_t column = 0; column < shared.columns; ++column) {
      const std::uint32_t* start = shared.start + row * (shared.columns + 1) + column;
      if (start[0] == start[1]) continue;
      std::size_t most = FacingKernel::kReadAhead;
      for (std::size_t j = row > 0 ? row - 1 : 0; j <= std::min(shared.rows - 1, row + 1); ++j) most += row_size(j);
      aligned.resize(std::max(aligned.size(), most));
      cosine.resize(aligned.size());
      for (std::uint32_t d = start[0]; d < start[1]; ++d) {
        const std::size_t count = fastest_kernels().list_aligned(shared, row, column, d, aligned.data(), cosine.data());
        for (std::size_t n = 0; n < count; ++n) all.push_back({aligned[n], cosine[n]});
        near_counts_[d] = static_cast<std::uint32_t>(count);
      }
    }
    near_[row].assign(all.begin(), all.end());
  });
}

// Half of a sample's vote becomes, several times over, the mean of its neighbours'.
void FacingField::spread_votes(ThreadPool& pool) {
  std::vector<float> spread(votes_.size(), 0.0F);
  for (int round = 0; round < kRounds; ++round) {
    pool.for_ranges(near_.size(), 1, [&](std::size_t row, std::size_t) {
      const Neighbour* neighbour = near_[row].data();
      const std::uint32_t first = row_begin(row);
      for (std::uint32_t d = first; d < first + row_size(row); ++d) {
        float sum = 0.0F;
        for (std::uint32_t n = 0; n < near_counts_[d]; ++n, ++neighbour) {
          sum += neighbour->cosine * std::abs(neighbour->cosine) * votes_[neighbour->sample];
        }
        spread[d] = 0.5F * votes_[d] + 0.5F * sum / static_cast<float>(near_counts_[d] + 1);
      }
    });
    votes_.swap(spread);
  }
}

// The inside of a wall is seen through a hole as well as its outside around it: only the surface that connects the two,
// around the wall's rim, tells. So normals are aligned along the flattest connections (Hoppe et al. 1992, section 3.3),
// and where the votes of a connected surface agree well, those that do not are overruled. Beyond an edge that is
// sharper than 90 degrees the flattest connections are wrong: planes through points of both faces lie along the edge's
// bisector, so they turn from one face to the other through the inside. One such connection would turn a whole face of
// an object that is known to have one outer side. Where it contradicts what both parts are sure of, it waits until all
// others, around the faces' other rims, have joined them.
void FacingField::overrule_by_surface(SideEvidence evidence) {
  constexpr std::size_t kBuckets = 256;
  constexpr std::uint32_t kOpposed = 0x80000000U;  // samples are far fewer
  struct Edge {
    std::uint32_t a, b;  // b with kOpposed where normals are opposed
  };
  const auto each = [&](const auto& use) {
    for (std::size_t row = 0; row < near_.size(); ++row) {
      const Neighbour* cursor = near_[row].data();
      const std::uint32_t first = row_begin(row);
      for (std::uint32_t d = first; d < first + row_size(row); ++d) {
        for (std::uint32_t n = 0; n < near_counts_[d]; ++n, ++cursor) {
          if (cursor->sample <= d) continue;
          const float bent = (1.0F - std::min(1.0F, std::abs(cursor->cosine))) / (1.0F - kAligned);
          const auto bucket = std::min(kBuckets - 1, static_cast<std::size_t>(bent * static_cast<float>(kBuckets)));
          use(bucket, Edge{d, cursor->sample | (cursor->cosine < 0.0F ? kOpposed : 0U)});
        }
      }
    }
  };
  // Counted first: there are many times as many edges as samples.
  std::vector<std::size_t> next(kBuckets + 1, 0);
  each([&](std::size_t bucket, const Edge&) { ++next[bucket + 1]; });
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) next[bucket + 1] += next[bucket];
  std::vector<Edge> edges(next.back());
  each([&](std::size_t bucket, const Edge& edge) { edges[next[bucket]++] = edge; });
  SurfaceParts parts(votes_);
  const auto join = [&](const Edge& edge, double least_mean) {
    return parts.join(edge.a, edge.b & ~kOpposed, (edge.b & kOpposed) != 0, least_mean);
  };
  const bool whole = evidence == SideEvidence::whole;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  edges.erase(
      std::remove_if(edges.begin(), edges.end(), [&](const Edge& edge) { return join(edge, whole ? 0.0 : kAny); }),
      edges.end());
  for (const Edge& edge : edges) join(edge, kSureMean);
  part_.assign(votes_.size(), 0);
  part_side_.assign(votes_.size(), 0.0F);
  outside_.assign(votes_.size(), 0.0F);
  closed_.assign(votes_.size(), 0);
  std::vector<std::array<double, 2>> area(votes_.size());  // of either side, across the view
  for (const std::uint32_t d : of_slot_) {
    const SurfaceParts::Place place = parts.find(d);
    area[place.root][place.opposed ? 1 : 0] += static_cast<double>(normal_z_[d]);
    part_[d] = place.root;
    part_side_[d] = place.opposed ? -1.0F : 1.0F;
  }
  const double least = whole ? kWholeAgreement : kAgreement;
  for (const std::uint32_t d : of_slot_) {
    const SurfaceParts::Place place = parts.find(d);
    const double sum = parts.sum(place.root);
    if (!(std::abs(sum) >= least * parts.weight(place.root))) continue;
    const auto [one, other] = area[place.root];
    closed_[d] = std::min(one, other) >= kOtherSide * (one + other) ? 1 : 0;
    if (evidence == SideEvidence::certain && closed_[d] == 0) continue;
    const bool outwards = (sum > 0.0) != place.opposed;
    outside_[d] = outwards ? 1.0F : -1.0F;
    votes_[d] = std::max(std::abs(votes_[d]), 2.0F * kSure) * outside_[d];
  }
}

// Leaves the sides of closed surfaces and those that stations tell.
void FacingField::forget_views() {
  for (const std::uint32_t d : of_slot_) {
    if (outside_[d] == 0.0F && told_[d] == 0) votes_[d] = 0.0F;
  }
}

}  // namespace sparsha::pipeline

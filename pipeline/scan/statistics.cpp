// Distances to neighbours: of few points through a tree; of many from the points about some places, which a first look
// has chosen.
#include "pipeline/scan/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "base/numbers/hash.h"
#include "base/numbers/statistics.h"
#include "pipeline/scan/doubts.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/pcl_trees.hpp"
#include "pipeline/scan/read_bytes.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kSample = 100'000;
constexpr double kReach = 4.0;  // mean spacings, about a place
constexpr std::size_t kMostNeighbours = 64;

double middle_of(std::vector<float>& values) { return values.empty() ? 0.0 : static_cast<double>(median(values)); }

/// Gathers what lies within `reach` of each of some places, or a little more: cubes of that size that touch it.
class Neighbourhoods {
 public:
  Neighbourhoods(std::vector<Eigen::Vector3d> places, double reach) : places_(std::move(places)), reach_(reach) {
    nearest_.assign(places_.size(), std::numeric_limits<float>::infinity());
    for (std::uint32_t n = 0; n < places_.size(); ++n) {
      const Cell home = cell_of(places_[n]);
      for (std::int64_t x = -1; x <= 1; ++x)
        for (std::int64_t y = -1; y <= 1; ++y)
          for (std::int64_t z = -1; z <= 1; ++z) near_[{home[0] + x, home[1] + y, home[2] + z}].push_back(n);
    }
  }
  void add(const Eigen::Vector3d& point) {
    const auto found = near_.find(cell_of(point));
    if (found == near_.end()) return;
    for (const std::uint32_t n : found->second) {
      const auto distance = static_cast<float>((point - places_[n]).norm());
      if (distance > 0.0F && distance < nearest_[n]) nearest_[n] = distance;
    }
  }
  [[nodiscard]] double median() const {
    std::vector<float> distances;
    for (const float d : nearest_)
      if (std::isfinite(d)) distances.push_back(d);
    return middle_of(distances);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const { return static_cast<std::size_t>(hash_cell(cell)); }
  };
  [[nodiscard]] Cell cell_of(const Eigen::Vector3d& p) const {
    const auto whole = [&](double v) {
      return static_cast<std::int64_t>(std::floor(std::clamp(v / reach_, -1e15, 1e15)));
    };
    return {whole(p.x()), whole(p.y()), whole(p.z())};
  }

  std::vector<Eigen::Vector3d> places_;
  double reach_;
  std::vector<float> nearest_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> near_;
};

/// Nothing when a point is repeated so often that the search for another one would take the whole cloud, each time.
std::optional<double> spacing_by_tree(const pcl::PointCloud<pcl::PointXYZ>::Ptr& cloud) {
  constexpr std::size_t kQueries = 2000;
  if (cloud->size() < 2) return 0.0;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setSortedResults(true);
  tree.setInputCloud(cloud);
  std::vector<float> distances;
  pcl::Indices found;
  std::vector<float> squared;
  const std::size_t step = std::max<std::size_t>(1, cloud->size() / kQueries);
  for (std::size_t i = 0; i < cloud->size(); i += step) {
    for (std::size_t k = 2;; k *= 4) {
      k = std::min({k, kMostNeighbours, cloud->size()});
      tree.nearestKSearch((*cloud)[i], static_cast<unsigned>(k), found, squared);
      const auto other = std::find_if(squared.begin(), squared.end(), [](float d) { return d > 0.0F; });
      if (other != squared.end()) {
        distances.push_back(std::sqrt(*other));
        break;
      }
      if (k == kMostNeighbours) return std::nullopt;
      if (k == cloud->size()) break;
    }
  }
  return middle_of(distances);
}

/// Leaves one of equal points and puts them into an order of their own.
void leave_out_duplicates(pcl::PointCloud<pcl::PointXYZ>& cloud) {
  const auto key = [](const pcl::PointXYZ& p) { return std::tie(p.x, p.y, p.z); };
  std::sort(cloud.begin(), cloud.end(),
            [&](const pcl::PointXYZ& a, const pcl::PointXYZ& b) { return key(a) < key(b); });
  const auto end = std::unique(cloud.begin(), cloud.end(),
                               [&](const pcl::PointXYZ& a, const pcl::PointXYZ& b) { return key(a) == key(b); });
  cloud.resize(static_cast<std::size_t>(end - cloud.begin()));
}

}  // namespace

double median_spacing(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 2) return 0.0;
  PointSample sample;
  for (const Eigen::Vector3d& p : points) sample.add(p);
  const std::vector<Eigen::Vector3d> some = sample.points();
  const Eigen::Vector3d centre(coordinate_quantile(some, 0, 0.5), coordinate_quantile(some, 1, 0.5),
                               coordinate_quantile(some, 2, 0.5));
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f q = (p - centre).cast<float>();
    if (q.allFinite() && q.squaredNorm() < 1e30F) cloud->push_back({q.x(), q.y(), q.z()});
  }
  if (cloud->size() < 2) return 0.0;
  std::optional<double> spacing = spacing_by_tree(cloud);
  if (!spacing) {
    leave_out_duplicates(*cloud);
    spacing = spacing_by_tree(cloud);
  }
  return spacing.value_or(0.0);
}

namespace {

/// The points of a scan, block by block and as often as they are asked for: from memory when there are few, else from
/// the file.
class PointsAgain {
 public:
  PointsAgain(const std::filesystem::path& file, Progress& progress, const ReadOptions& options, std::uint64_t most)
      : file_(file), progress_(progress), options_(options), most_(most) {}

  template <typename Use>
  RawScan first(const Use& use) {
    return stream_scan(
        file_,
        [&](const PointBlock& block) {
          progress_.throw_if_cancelled();
          keep(block);
          use(block);
        },
        &progress_, options_);
  }
  template <typename Use>
  void again(const Use& use) {
    if (kept_ <= most_) {
      for (const Block& block : blocks_) {
        progress_.throw_if_cancelled();
        const std::vector<std::span<const float>> fields(block.fields.begin(), block.fields.end());
        use({block.points, {}, {}, block.station, {}, fields});
      }
      return;
    }
    options_.tally = ReadOptions::Tally::none;
    (void)stream_scan(
        file_,
        [&](const PointBlock& block) {
          progress_.throw_if_cancelled();
          use(block);
        },
        &progress_, options_);
  }

 private:
  struct Block {
    std::vector<Eigen::Vector3d> points;
    std::optional<Eigen::Vector3d> station;
    std::vector<std::vector<float>> fields;
  };
  void keep(const PointBlock& block) {
    kept_ += block.points.size();
    if (kept_ > most_) {
      blocks_ = {};
      return;
    }
    Block& copy = blocks_.emplace_back();
    copy.points.assign(block.points.begin(), block.points.end());
    copy.station = block.station;
    for (const std::span<const float> values : block.fields) copy.fields.emplace_back(values.begin(), values.end());
  }

  const std::filesystem::path& file_;
  Progress& progress_;
  ReadOptions options_;
  std::uint64_t most_;
  std::uint64_t kept_ = 0;
  std::vector<Block> blocks_;
};

/// The mean of unit normals, in whole numbers, so that their order does not matter.
class Facing {
 public:
  void add(std::span<const Eigen::Vector3f> normals) {
    for (const Eigen::Vector3f& normal : normals) {
      const float length = normal.norm();
      if (!(length > 0.0F) || !std::isfinite(length)) continue;
      for (Eigen::Index a = 0; a < 3; ++a) sum_[a] += std::llround(kUnit * static_cast<double>(normal[a] / length));
      ++count_;
    }
  }
  [[nodiscard]] Eigen::Vector3d mean() const {
    if (count_ == 0) return Eigen::Vector3d::Zero();
    return sum_.cast<double>() / (kUnit * static_cast<double>(count_));
  }

 private:
  static constexpr double kUnit = 4096.0;
  Eigen::Matrix<std::int64_t, 3, 1> sum_ = Eigen::Matrix<std::int64_t, 3, 1>::Zero();
  std::int64_t count_ = 0;
};

/// Whether there is more than one colour: files whose points are all black or white show nothing.
class Colours {
 public:
  void add(std::span<const std::uint32_t> colours) {
    for (const std::uint32_t rgba : colours) {
      if (several_ || rgba == kNoColour) continue;
      several_ = first_ && *first_ != rgba;
      first_ = rgba;
    }
  }
  [[nodiscard]] bool several() const { return several_; }

 private:
  std::optional<std::uint32_t> first_;
  bool several_ = false;
};

/// In an order of their own.
std::vector<Eigen::Vector3d> in_order(std::vector<Eigen::Vector3d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return points;
}

const std::vector<std::string>& fields_of_worth() {
  static const std::vector<std::string> names = {PointField::kClass, "confidence", "opacity"};
  return names;
}

void judge(ScanStatistics& statistics) {
  statistics.worth = worth_of(statistics.scan.tallies);
  for (Worth& worth : statistics.worth) {
    if (worth.filter && !leaves_enough(worth)) worth.filter.reset();
  }
}

void keep_proved(std::vector<SeenStation>& stations) {
  std::erase_if(stations, [](const SeenStation& station) { return !station.steps.are_even(); });
}

/// Of a mesh, or of few points.
ScanStatistics statistics_of_whole(const std::filesystem::path& file, Progress& progress, const ReadOptions& options) {
  ScanStatistics statistics;
  statistics.scan = read_scan(file, &progress, options);
  add_to_stations(statistics.scan, statistics.stations);
  keep_proved(statistics.stations);
  const std::size_t read = statistics.scan.points.size();
  drop_what_is_no_surface(statistics.scan);
  statistics.empty_returns = read - statistics.scan.points.size();
  judge(statistics);
  const std::size_t points = statistics.scan.points.size();
  leave_out_worthless(statistics.scan, options.fields, statistics.worth);
  statistics.scan.records -= points - statistics.scan.points.size();
  add_doubts(statistics.scan);
  const std::optional<Eigen::Vector2d>& cell = statistics.scan.cell;
  statistics.spacing = cell ? cell->minCoeff() : median_spacing(statistics.scan.points);
  statistics.runs = runs_of(statistics.scan.points);
  Colours colours;
  colours.add(statistics.scan.rgba);
  statistics.has_colours = colours.several();
  if (statistics.scan.faces.empty()) {
    Facing facing;
    facing.add(statistics.scan.normals);
    statistics.stated_facing = facing.mean();
  }
  return statistics;
}

}  // namespace

ScanStatistics scan_statistics(const std::filesystem::path& file, Progress& progress, std::uint64_t kept_points,
                               const MeshRefusal& mesh_refusal, bool whole_chunks_only) {
  constexpr std::uint64_t kLarge = 256'000'000;
  ReadOptions options;
  options.fields = fields_of_worth();
  options.mesh_refusal = mesh_refusal;
  options.whole_chunks_only = whole_chunks_only;
  std::error_code code;
  if (!mesh_refusal && may_hold_faces(file) && std::filesystem::file_size(file, code) <= kLarge && !code) {
    ScanStatistics statistics = statistics_of_whole(file, progress, options);
    if (!statistics.scan.faces.empty() || statistics.scan.points.size() <= kSample) return statistics;
  }

  ScanStatistics statistics;
  PointsAgain points(file, progress, options, kept_points);
  PointSample few;
  std::uint64_t count = 0;
  std::uint64_t at_scanner = 0;
  Facing facing;
  Colours colours;
  statistics.scan = points.first([&](const PointBlock& block) {
    count += block.points.size();
    facing.add(block.normals);
    colours.add(block.rgba);
    add_to_stations(block, statistics.stations);
    for (const Eigen::Vector3d& p : block.points) {
      const bool empty = is_at_scanner(p, block.station);
      at_scanner += empty ? 1 : 0;
      if (!empty) few.add(p);
    }
  });
  if (count <= kSample || !statistics.scan.faces.empty()) {
    statistics = {};
    return statistics_of_whole(file, progress, options);
  }
  statistics.stated_facing = facing.mean();
  statistics.has_colours = colours.several();
  keep_proved(statistics.stations);
  judge(statistics);
  const bool empty_returns = are_empty_returns(at_scanner, count);
  if (empty_returns) {
    statistics.scan.warnings.push_back(empty_returns_warning(at_scanner, count));
    statistics.scan.invalid += at_scanner;
    statistics.empty_returns = at_scanner;
    count -= at_scanner;
  }
  const auto each_point = [&](const auto& use) {
    std::vector<Eigen::Vector3d> seen;
    points.again([&](const PointBlock& block) {
      seen.clear();
      for (std::size_t k = 0; k < block.points.size(); ++k) {
        if (empty_returns && is_at_scanner(block.points[k], block.station)) continue;
        if (!is_worthless(block.fields, k, options.fields, statistics.worth)) seen.push_back(block.points[k]);
      }
      use(std::span<const Eigen::Vector3d>(seen));
    });
  };
  if (std::any_of(statistics.worth.begin(), statistics.worth.end(), [](const Worth& w) { return w.filter; })) {
    few = PointSample();
    count = 0;
    each_point([&](std::span<const Eigen::Vector3d> block) {
      count += block.size();
      for (const Eigen::Vector3d& p : block) few.add(p);
    });
    statistics.scan.records = count + statistics.scan.invalid;
  }
  add_doubts(statistics.scan, few, count, each_point);
  std::vector<Eigen::Vector3d> places = few.points();
  const double reach = places.empty() ? 0.0 : kReach * distance_by_extent(places, count);
  Neighbourhoods neighbours(std::move(places), std::max(reach, 1e-12));
  PointSample sample(kSample);
  statistics.runs = PointRuns(count);
  each_point([&](std::span<const Eigen::Vector3d> block) {
    for (const Eigen::Vector3d& p : block) {
      sample.add(p);
      neighbours.add(p);
      statistics.runs.add(p);
    }
  });
  statistics.scan.points = in_order(sample.points());
  const std::optional<Eigen::Vector2d>& cell = statistics.scan.cell;
  statistics.spacing = cell ? cell->minCoeff() : neighbours.median();
  return statistics;
}

}  // namespace sparsha::pipeline

// Which side of a surface its scanners stood on, where the scans say so.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/facing.h"
#include "pipeline/projection/facing_rules.h"

namespace sparsha::pipeline {
namespace {

constexpr double kTruthful = 0.75;  // share of a station's points that are known to face it
constexpr std::size_t kFewPoints = 50;
constexpr double kRoom = 0.2;      // of the surface, whose sides proved stations turn
constexpr float kParallel = 0.9F;  // cosine of normals of neighbours that share a side
constexpr float kGlancing = 0.1F;  // cosine of a ray that does not tell which side it met
constexpr float kOnSide = 0.05F;   // cosine of the way to a scanner that stood on a side

}  // namespace

// Which side of each sample a station saw: 1 the normal's, -1 the other, 0 where it saw nothing near.
std::vector<float> FacingField::seen_from(const StationView& station) const {
  const BinLocator ruler(samples_.columns);
  const int nx = samples_.columns.bins_x();
  const int ny = samples_.columns.bins_y();
  const auto reach2 = static_cast<float>(4.0 * spacing_m_ * spacing_m_);
  const auto sheet = static_cast<float>(kSheet * spacing_m_);
  // A normal belongs to the surface that is along it, and not to the other flank of an edge.
  const float least = station.normals ? kParallel : kGlancing;
  std::vector<float> sides(votes_.size(), 0.0F);
  for (std::size_t k = 0; k < station.seen.size(); ++k) {
    const Eigen::Vector3f& p = station.seen[k];
    int column = 0;
    int row = 0;
    if (!ruler.locate(p.x(), p.y(), column, row)) continue;
    const Eigen::Vector3f& ray = station.towards[k];
    for (int j = std::max(0, row - 1); j <= std::min(ny - 1, row + 1); ++j) {
      const std::uint32_t* start = row_start(static_cast<std::size_t>(j));
      for (std::uint32_t d = start[std::max(0, column - 1)]; d < start[std::min(nx - 1, column + 1) + 1]; ++d) {
        const Eigen::Vector3f normal(normal_x_[d], normal_y_[d], normal_z_[d]);
        const Eigen::Vector3f apart = p - Eigen::Vector3f(samples_.x[d], samples_.y[d], height_[d]);
        if (apart.squaredNorm() > reach2 || std::abs(normal.dot(apart)) > sheet) continue;
        const float cosine = normal.dot(ray);
        if (std::abs(cosine) >= least) sides[d] += cosine > 0.0F ? 1.0F : -1.0F;
      }
    }
  }
  for (float& side : sides) side = side > 0.0F ? 1.0F : side < 0.0F ? -1.0F : 0.0F;
  return sides;
}

// Samples between those that a station saw are on the sides of their neighbours.
void FacingField::spread_sides(std::vector<float>& sides) const {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<float> known = sides;
    for (std::size_t row = 0; row < near_.size(); ++row) {
      const Neighbour* neighbour = near_[row].data();
      const std::uint32_t first = row_begin(row);
      for (std::uint32_t d = first; d < first + row_size(row); ++d) {
        float sum = 0.0F;
        for (std::uint32_t n = 0; n < near_counts_[d]; ++n, ++neighbour) {
          if (std::abs(neighbour->cosine) >= kParallel) sum += neighbour->cosine * known[neighbour->sample];
        }
        if (known[d] == 0.0F) sides[d] = sum > kAligned ? 1.0F : sum < -kAligned ? -1.0F : 0.0F;
      }
    }
  }
}

// Connected parts of the surface of which proved stations saw one side and views from outside the other are those of a
// room: what no station saw of them is turned with the rest.
void FacingField::turn_rooms(const std::vector<float>& sides) {
  struct Part {
    std::size_t known = 0;  // samples that stations saw,
    double told = 0.0;      // on which side, the sum,
    double seen = 0.0;      // and what the views say of all samples
  };
  std::vector<Part> parts(votes_.size());
  for (const std::uint32_t d : of_slot_) {
    Part& part = parts[part_[d]];
    part.seen += static_cast<double>(part_side_[d] * votes_[d]);
    if (sides[d] == 0.0F) continue;
    ++part.known;
    part.told += sides[d] > 0.0F ? static_cast<double>(part_side_[d]) : -static_cast<double>(part_side_[d]);
  }
  proved_.assign(votes_.size(), 0);
  std::size_t turned = 0;
  for (const std::uint32_t d : of_slot_) {
    const Part& part = parts[part_[d]];
    const bool agreed =
        part.known >= kFewPoints && std::abs(part.told) >= (2.0 * kTruthful - 1.0) * static_cast<double>(part.known);
    const bool room = agreed && part.told * part.seen < 0.0;
    proved_[d] = room || sides[d] != 0.0F ? 1 : 0;
    if (!room) continue;
    outside_[d] = part.told > 0.0 ? part_side_[d] : -part_side_[d];
    votes_[d] = std::max(std::abs(votes_[d]), 2.0F * kSure) * outside_[d];
    ++turned;
  }
  // A hollow that the views took for something's outside is no room.
  sees_through_ = static_cast<double>(turned) > kRoom * static_cast<double>(of_slot_.size());
}

// A surface was seen by one of the scanners. Where all of them stood on one side of it, that is its side, however few
// its points are: the ends of a tunnel, and the floor under a tripod as the other stations saw it.
float FacingField::side_of_stations(const Eigen::Vector3f& place, const Eigen::Vector3f& normal) const {
  std::size_t before = 0, behind = 0;
  for (const Eigen::Vector3f& stood : stood_) {
    const float cosine = normal.dot((stood - place).normalized());
    before += cosine > kOnSide ? 1 : 0;
    behind += cosine < -kOnSide ? 1 : 0;
  }
  return before == stood_.size() ? 1.0F : behind == stood_.size() ? -1.0F : 0.0F;
}

void FacingField::ask_where_scanners_stood(const float* x, const float* y, float* records, std::size_t begin,
                                           std::size_t end) const {
  if (stood_.empty()) return;
  for (std::size_t d = begin; d < end; ++d) {
    float* record = records + kDiscRecord * d;
    if (record[7] != 0.0F) continue;
    const Eigen::Vector3f towards_viewer(-record[3], -record[4], 1.0F);
    record[7] = side_of_stations({x[d], y[d], record[2]}, towards_viewer.normalized());
  }
}

// A station cannot see the far side of what it scanned. But programs write stations that nobody stood at: of surfaces
// that are closed enough for their votes to agree, a station has to be on the outer side of most, unless it is proved.
// Sheets that are seen on both sides say nothing.
void FacingField::ask_stations(const std::vector<StationView>& stations) {
  std::vector<float> sides(votes_.size(), 0.0F);
  const auto add = [&](const std::vector<float>& mine) {
    for (const std::uint32_t d : of_slot_) sides[d] += mine[d];
  };
  bool any_proved = false;
  const bool all_proved = std::all_of(stations.begin(), stations.end(),
                                      [](const StationView& station) { return station.proved && !station.normals; });
  for (const StationView& station : stations) {
    if (!station.proved) continue;
    add(seen_from(station));
    any_proved = true;
  }
  if (any_proved) turn_rooms(sides);
  for (std::size_t s = 0; s < stations.size(); ++s) {
    if (stations[s].proved) continue;
    const std::vector<float> mine = seen_from(stations[s]);
    std::size_t known = 0;
    std::size_t agreed = 0;
    for (const std::uint32_t d : of_slot_) {
      if (mine[d] == 0.0F || outside_[d] == 0.0F) continue;
      ++known;
      agreed += outside_[d] == mine[d] ? 1 : 0;
    }
    if (known >= kFewPoints && static_cast<double>(agreed) < kTruthful * static_cast<double>(known)) {
      lying_stations_.push_back(s);
    } else {
      add(mine);
    }
  }
  spread_sides(sides);
  if (sees_through_ && all_proved)
    for (const StationView& station : stations) stood_.push_back(station.stood);
  for (const std::uint32_t d : of_slot_) {
    if (sides[d] == 0.0F && !stood_.empty() && proved_[d] == 0) {
      sides[d] =
          side_of_stations({samples_.x[d], samples_.y[d], height_[d]}, {normal_x_[d], normal_y_[d], normal_z_[d]});
      proved_[d] = sides[d] != 0.0F ? 1 : 0;
    }
    if (sides[d] == 0.0F) continue;
    votes_[d] = sides[d] > 0.0F ? 2.0F * kSure : -2.0F * kSure;
    told_[d] = 1;
  }
}

}  // namespace sparsha::pipeline

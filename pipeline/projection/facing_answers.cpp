// What a FacingField answers once its votes are counted.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "pipeline/projection/bins.h"
#include "pipeline/projection/facing.h"
#include "pipeline/projection/facing_rules.h"

namespace sparsha::pipeline {

double FacingField::share_turned_away() const {
  std::size_t seen = 0;
  std::size_t turned = 0;
  for (const std::uint32_t d : of_slot_) {
    if (seen_[d] == 0) continue;
    ++seen;
    turned += votes_[d] < -kSure && (proved_.empty() || proved_[d] == 0) ? 1 : 0;
  }
  return seen == 0 ? 0.0 : static_cast<double>(turned) / static_cast<double>(seen);
}

bool FacingField::sees_through() const { return sees_through_; }

bool FacingField::is_wall_from_behind(float x, float y, float z) const {
  if (!sees_through_) return false;
  int column = 0;
  int row = 0;
  if (!BinLocator(samples_.columns).locate(x, y, column, row)) return false;
  const int nx = samples_.columns.bins_x();
  const int ny = samples_.columns.bins_y();
  auto nearest2 = static_cast<float>(4.0 * spacing_m_ * spacing_m_);
  // What lies nearer to the viewer than every scanner was seen from behind.
  bool away = !stood_.empty() &&
              std::all_of(stood_.begin(), stood_.end(), [z](const Eigen::Vector3f& stood) { return stood.z() < z; });
  for (int j = std::max(0, row - 1); j <= std::min(ny - 1, row + 1); ++j) {
    const std::uint32_t* start = row_start(static_cast<std::size_t>(j));
    for (std::uint32_t d = start[std::max(0, column - 1)]; d < start[std::min(nx - 1, column + 1) + 1]; ++d) {
      const Eigen::Vector3f apart(x - samples_.x[d], y - samples_.y[d], z - height_[d]);
      if (!(apart.squaredNorm() < nearest2)) continue;
      nearest2 = apart.squaredNorm();
      away = proved_[d] != 0 && votes_[d] < 0.0F;
    }
  }
  return away;
}

FacingKernel FacingField::kernel() const {
  const BinLocator locator(samples_.columns);
  FacingKernel kernel;
  kernel.start = samples_.start.get();
  kernel.columns = static_cast<std::size_t>(samples_.columns.bins_x());
  kernel.rows = static_cast<std::size_t>(samples_.columns.bins_y());
  kernel.x_shift_m = locator.x_shift_m;
  kernel.y_shift_m = locator.y_shift_m;
  kernel.per_m = locator.per_m;
  kernel.x = samples_.x.get();
  kernel.y = samples_.y.get();
  kernel.z = height_.data();
  kernel.normal_x = normal_x_.data();
  kernel.normal_y = normal_y_.data();
  kernel.normal_z = normal_z_.data();
  kernel.votes = votes_.data();
  kernel.away_top_m = away_top_m_.data();
  kernel.reach2 = static_cast<float>(4.0 * spacing_m_ * spacing_m_);
  kernel.sheet_m = static_cast<float>(kSheet * spacing_m_);
  kernel.aligned = kAligned;
  kernel.sure = kSure;
  return kernel;
}

bool FacingField::has(Word word) const {
  const std::vector<float>& votes = word == Word::of_all        ? votes_
                                    : word == Word::of_stations ? told_votes_
                                                                : closed_votes_;
  return std::any_of(of_slot_.begin(), of_slot_.end(), [&](std::uint32_t d) { return votes[d] != 0.0F; });
}

void FacingField::set_facing(Word word, const float* x, const float* y, float* records, std::size_t count) const {
  FacingKernel asked = kernel();
  if (word != Word::of_all) asked.votes = (word == Word::of_stations ? told_votes_ : closed_votes_).data();
  fastest_kernels().find_facing(asked, x, y, records, 0, count);
  if (word != Word::of_closed_surfaces) ask_where_scanners_stood(x, y, records, 0, count);
}

void FacingField::set_facing(TangentDiscs& discs, ThreadPool& pool) const {
  const FacingKernel shared = kernel();
  const auto row_length = static_cast<std::size_t>(discs.columns.bins_x());
  const auto first = static_cast<std::size_t>(discs.window.first_row);
  pool.for_ranges(static_cast<std::size_t>(discs.window.last_row) - first, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = first + begin; row < first + end; ++row) {
      const std::uint32_t* start = discs.start.get() + row * (row_length + 1);
      fastest_kernels().find_facing(shared, discs.x.get(), discs.y.get(), discs.records.get(), start[0],
                                    start[row_length]);
      ask_where_scanners_stood(discs.x.get(), discs.y.get(), discs.records.get(), start[0], start[row_length]);
    }
  });
}

}  // namespace sparsha::pipeline

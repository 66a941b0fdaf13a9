// Rays go from cell to cell (Amanatides & Woo 1987); a cell lists every ball that reaches into it.
#include "pipeline/check/obstacles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sparsha::pipeline {
namespace {

constexpr std::int32_t kMost = (1 << 20) - 1;  // of a cell's number, so that three make a key

std::uint64_t key_of(const std::array<std::int32_t, 3>& cell) {
  std::uint64_t key = 0;
  for (const std::int32_t x : cell) key = key << 21U | static_cast<std::uint64_t>(x);
  return key;
}

}  // namespace

Obstacles::Obstacles(std::vector<Eigen::Vector3f> centres, float radius, const Eigen::Vector3f& low,
                     const Eigen::Vector3f& high)
    : centres_(std::move(centres)), radius_(radius), side_(2.0F * radius), low_(low) {
  std::erase_if(centres_, [&](const Eigen::Vector3f& c) {
    return !((c.array() >= low.array()).all() && (c.array() <= high.array()).all());
  });
  last_ = cell_of(high);
  std::uint32_t entries = 0;
  for (const Eigen::Vector3f& centre : centres_) {
    each_cell_of(centre, [&](const Cell& cell) { ++cells_[cells_.number(key_of(cell))].count; });
  }
  for (std::uint32_t n = 0; n < cells_.size(); ++n) {
    cells_[n].begin = entries;
    entries += std::exchange(cells_[n].count, 0U);
  }
  entries_.resize(entries);
  for (std::uint32_t c = 0; c < centres_.size(); ++c) {
    each_cell_of(centres_[c], [&](const Cell& cell) {
      Content& content = cells_[cells_.number(key_of(cell))];
      entries_[content.begin + content.count++] = c;
    });
  }
}

Obstacles::Cell Obstacles::cell_of(const Eigen::Vector3f& place) const {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const float at = std::floor((place[axis] - low_[axis]) / side_);
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(std::clamp(at, 0.0F, static_cast<float>(kMost)));
  }
  return cell;
}

template <typename Use>
void Obstacles::each_cell_of(const Eigen::Vector3f& centre, const Use& use) const {
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(radius_);
  const Cell from = cell_of(centre - reach), to = cell_of(centre + reach);
  Cell cell{};
  for (cell[0] = from[0]; cell[0] <= to[0]; ++cell[0]) {
    for (cell[1] = from[1]; cell[1] <= to[1]; ++cell[1]) {
      for (cell[2] = from[2]; cell[2] <= to[2]; ++cell[2]) use(cell);
    }
  }
}

bool Obstacles::met(const Content& content, const Eigen::Vector3f& start, const Eigen::Vector3f& direction) const {
  for (std::uint32_t k = content.begin; k < content.begin + content.count; ++k) {
    const Eigen::Vector3f to = centres_[entries_[k]] - start;
    const float along = std::max(0.0F, to.dot(direction));
    if ((to - along * direction).squaredNorm() < radius_ * radius_) return true;
  }
  return false;
}

bool Obstacles::free(const Eigen::Vector3f& start, const Eigen::Vector3f& direction) const {
  Cell cell = cell_of(start);
  Cell step{};
  std::array<float, 3> next{}, each{};  // ways along the ray to the next cell of an axis, and through one
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    step[axis] = direction[at] > 0.0F ? 1 : -1;
    const float border = low_[at] + side_ * static_cast<float>(cell[axis] + (step[axis] > 0 ? 1 : 0));
    const bool across = std::abs(direction[at]) < 1e-6F;
    next[axis] = across ? std::numeric_limits<float>::infinity() : (border - start[at]) / direction[at];
    each[axis] = across ? std::numeric_limits<float>::infinity() : side_ / std::abs(direction[at]);
  }
  while (true) {
    const std::uint32_t number = cells_.find(key_of(cell));
    if (number < cells_.size() && met(cells_[number], start, direction)) return false;
    const auto axis = static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] > last_[axis]) return true;
    next[axis] += each[axis];
  }
}

}  // namespace sparsha::pipeline

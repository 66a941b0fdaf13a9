// Sheets grow from their first node. A sheet has one layer at a node.
#include "pipeline/charts/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kNone = 0xffffffffU;
// Between neighbours the height changes as one of their slopes says, or as both do where an edge lies between them;
// what is left is less than the noise and so many spacings.
constexpr double kLeft = 0.5;
constexpr float kLeastCosine = 0.3F;  // of their normals

struct Step {
  int u, v;
};
constexpr std::array<Step, 4> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

class Grower {
 public:
  Grower(const SideLayers& layers, double spacing_m, double noise_m)
      : layers_(layers),
        spacing_m_(static_cast<float>(spacing_m)),
        left_m_(static_cast<float>(noise_m + kLeft * spacing_m)),
        sheet_(layers.layers.size(), kNone),
        claimed_(static_cast<std::size_t>(layers.nx) * static_cast<std::size_t>(layers.ny), kNone) {}

  struct Member {
    std::uint32_t node, layer;
  };

  [[nodiscard]] bool taken(std::uint32_t layer) const { return sheet_[layer] != kNone; }

  /// The layers that are connected with one, in the order in which they are found.
  const std::vector<Member>& grow(std::uint32_t node, std::uint32_t layer) {
    members_.clear();
    claim(node, layer);
    for (std::size_t next = 0; next < members_.size(); ++next) {
      const Member here = members_[next];
      for (const Step& step : kSteps) {
        const std::uint32_t beside = neighbour(here.node, step);
        if (beside == kNone || claimed_[beside] == number_) continue;
        const std::uint32_t found = continued(here.layer, beside, step);
        if (found == kNone || taken(found)) continue;
        const Step back{-step.u, -step.v};
        if (continued(found, here.node, back) == here.layer) claim(beside, found);
      }
    }
    ++number_;
    return members_;
  }

  /// Whether a layer goes on into one of a neighbouring node.
  [[nodiscard]] bool connected(std::uint32_t from, std::uint32_t to, const Step& step) const {
    return mismatch(layers_.layers[from], layers_.layers[to], step) < std::numeric_limits<float>::infinity();
  }

 private:
  void claim(std::uint32_t node, std::uint32_t layer) {
    sheet_[layer] = number_;
    claimed_[node] = number_;
    members_.push_back({node, layer});
  }

  [[nodiscard]] std::uint32_t neighbour(std::uint32_t node, const Step& step) const {
    const auto nx = static_cast<std::uint32_t>(layers_.nx);
    const int i = static_cast<int>(node % nx) + step.u;
    const int j = static_cast<int>(node / nx) + step.v;
    if (i < 0 || j < 0 || i >= layers_.nx || j >= layers_.ny) return kNone;
    return static_cast<std::uint32_t>(j) * nx + static_cast<std::uint32_t>(i);
  }

  // How far the next layer lies from where the first goes on to; infinite where the two are not connected.
  [[nodiscard]] float mismatch(const DiscLayer& from, const DiscLayer& to, const Step& step) const {
    constexpr float kNever = std::numeric_limits<float>::infinity();
    const float cosine = (1.0F + from.slope_x * to.slope_x + from.slope_y * to.slope_y) /
                         std::sqrt((1.0F + from.slope_x * from.slope_x + from.slope_y * from.slope_y) *
                                   (1.0F + to.slope_x * to.slope_x + to.slope_y * to.slope_y));
    if (cosine < kLeastCosine) return kNever;
    const float a =
        (step.u != 0 ? from.slope_x * static_cast<float>(step.u) : from.slope_y * static_cast<float>(step.v));
    const float b = (step.u != 0 ? to.slope_x * static_cast<float>(step.u) : to.slope_y * static_cast<float>(step.v));
    const float rise = to.height - from.height;
    if (rise < std::min(a, b) * spacing_m_ - left_m_ || rise > std::max(a, b) * spacing_m_ + left_m_) return kNever;
    return std::abs(rise - 0.5F * (a + b) * spacing_m_);
  }

  // The layer of a neighbouring node that one goes on into best.
  [[nodiscard]] std::uint32_t continued(std::uint32_t layer, std::uint32_t node, const Step& step) const {
    std::uint32_t best = kNone;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t k = layers_.start[node]; k < layers_.start[node + 1]; ++k) {
      const float here = mismatch(layers_.layers[layer], layers_.layers[k], step);
      if (here < least) {
        least = here;
        best = k;
      }
    }
    return best;
  }

  const SideLayers& layers_;
  float spacing_m_, left_m_;
  std::uint32_t number_ = 0;            // of the sheet that grows
  std::vector<std::uint32_t> sheet_;    // of each layer
  std::vector<std::uint32_t> claimed_;  // of each node, the last sheet that has a layer of it
  std::vector<Member> members_;
};

scene::Sheet sheet_of(const SideLayers& layers, const std::vector<Grower::Member>& members, const Grower& grower) {
  const auto nx = static_cast<std::uint32_t>(layers.nx);
  int left = layers.nx, right = -1, low = layers.ny, high = -1;
  for (const Grower::Member& m : members) {
    left = std::min(left, static_cast<int>(m.node % nx));
    right = std::max(right, static_cast<int>(m.node % nx));
    low = std::min(low, static_cast<int>(m.node / nx));
    high = std::max(high, static_cast<int>(m.node / nx));
  }
  scene::Sheet sheet;
  sheet.side = layers.side;
  sheet.first_u = layers.first_u + left;
  sheet.first_v = layers.first_v + low;
  sheet.nx = right - left + 1;
  sheet.ny = high - low + 1;
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  for (std::vector<float>* values : {&sheet.height_m, &sheet.slope_u, &sheet.slope_v}) {
    values->assign(sheet.count(), kUnknown);
  }
  sheet.mask.assign(sheet.count(), 0);
  std::vector<std::uint32_t> layer(sheet.count(), kNone);
  for (const Grower::Member& m : members) {
    const std::size_t node = sheet.index(static_cast<int>(m.node % nx) - left, static_cast<int>(m.node / nx) - low);
    const DiscLayer& found = layers.layers[m.layer];
    sheet.height_m[node] = found.height;
    sheet.slope_u[node] = found.slope_x;
    sheet.slope_v[node] = found.slope_y;
    sheet.mask[node] = scene::Sheet::kMeasured;
    layer[node] = m.layer;
  }
  for (int j = 0; j + 1 < sheet.ny; ++j) {
    for (int i = 0; i + 1 < sheet.nx; ++i) {
      const std::size_t node = sheet.index(i, j);
      const std::array<std::uint32_t, 4> at{layer[node], layer[node + 1], layer[sheet.index(i, j + 1)],
                                            layer[sheet.index(i, j + 1) + 1]};
      if (std::find(at.begin(), at.end(), kNone) != at.end()) continue;
      if (grower.connected(at[0], at[1], kSteps[0]) && grower.connected(at[2], at[3], kSteps[0]) &&
          grower.connected(at[0], at[2], kSteps[1]) && grower.connected(at[1], at[3], kSteps[1])) {
        sheet.mask[node] |= scene::Sheet::kCell;
      }
    }
  }
  return sheet;
}

}  // namespace

SideSheets link_sheets(const SideLayers& layers, double spacing_m, double noise_m, const ChartRule& rule) {
  Grower grower(layers, spacing_m, noise_m);
  SideSheets result;
  const auto nodes = static_cast<std::uint32_t>(layers.nx) * static_cast<std::uint32_t>(layers.ny);
  for (std::uint32_t node = 0; node < nodes; ++node) {
    for (std::uint32_t layer = layers.start[node]; layer < layers.start[node + 1]; ++layer) {
      if (grower.taken(layer)) continue;
      const std::vector<Grower::Member>& members = grower.grow(node, layer);
      if (members.size() < rule.least_nodes) {
        ++result.small;
        result.small_nodes += members.size();
      } else {
        result.sheets.push_back(sheet_of(layers, members, grower));
      }
    }
  }
  return result;
}

}  // namespace sparsha::pipeline

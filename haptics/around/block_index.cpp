#include "haptics/around/block_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sparsha::haptics {
namespace {

constexpr int kFarthestBlock = (1 << 20) - 1;

/// Fibonacci hashing (Knuth 1973) of a key whose parts have been mixed.
std::uint64_t slot_of(std::uint64_t key) noexcept {
  key ^= key >> 31U;
  return (key * 0x9e3779b97f4a7c15ULL) >> 20U;
}

}  // namespace

BlockIndex::BlockIndex(double block_m, std::vector<Entry> entries) : block_m_(block_m), blocks_per_m_(1.0 / block_m) {
  const auto before = [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.sheet < b.sheet; };
  const auto same = [](const Entry& a, const Entry& b) { return a.key == b.key && a.sheet == b.sheet; };
  std::sort(entries.begin(), entries.end(), before);
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
  std::vector<std::uint64_t> keys;
  for (const Entry& entry : entries) {
    if (keys.empty() || keys.back() != entry.key) {
      keys.push_back(entry.key);
      begins_.push_back(static_cast<std::uint32_t>(sheets_.size()));
    }
    sheets_.push_back({entry.sheet});
  }
  begins_.push_back(static_cast<std::uint32_t>(sheets_.size()));
  slots_.assign(std::bit_ceil(2 * keys.size() + 1), Slot{0, kEmpty});
  mask_ = slots_.size() - 1;
  for (std::size_t block = 0; block < keys.size(); ++block) {
    std::uint64_t slot = slot_of(keys[block]) & mask_;
    while (slots_[slot].block != kEmpty) slot = (slot + 1) & mask_;
    slots_[slot] = {keys[block], static_cast<std::uint32_t>(block)};
  }
}

BlockPlace BlockIndex::block_of(const Eigen::Vector3d& place_m) const noexcept {
  BlockPlace block;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::floor(place_m[axis] * blocks_per_m_);
    block[axis] = static_cast<int>(std::clamp(at, -static_cast<double>(kFarthestBlock), double{kFarthestBlock}));
  }
  return block;
}

std::uint64_t BlockIndex::key_of(const BlockPlace& block) noexcept {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key = (key << 21U) | (static_cast<std::uint64_t>(block[axis] + (1 << 20)) & 0x1fffffU);
  return key;
}

std::uint32_t BlockIndex::number_of(const BlockPlace& block) const noexcept {
  if (slots_.empty()) return kEmpty;
  const std::uint64_t key = key_of(block);
  for (std::uint64_t slot = slot_of(key) & mask_; slots_[slot].block != kEmpty; slot = (slot + 1) & mask_)
    if (slots_[slot].key == key) return slots_[slot].block;
  return kEmpty;
}

std::span<const Passing> BlockIndex::sheets(const BlockPlace& block) const noexcept {
  const std::uint32_t number = number_of(block);
  if (number == kEmpty) return {};
  return {sheets_.data() + begins_[number], sheets_.data() + begins_[number + 1]};
}

Passing* BlockIndex::find(const BlockPlace& block, std::uint32_t sheet) noexcept {
  const std::uint32_t number = number_of(block);
  if (number == kEmpty) return nullptr;
  for (std::uint32_t k = begins_[number]; k < begins_[number + 1]; ++k)
    if (sheets_[k].sheet == sheet) return &sheets_[k];
  return nullptr;
}

}  // namespace sparsha::haptics

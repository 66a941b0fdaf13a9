// Blocks of space, hashed, each with the sheets that pass through it: what lies near a place is found without looking
// at what does not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A block's place, in blocks from zero.
using BlockPlace = Eigen::Vector3i;

class BlockIndex {
 public:
  BlockIndex() = default;
  /// `entries`: blocks with the number of a sheet in each, in any order and with repetitions.
  struct Entry {
    std::uint64_t key;
    std::uint32_t sheet;
  };
  BlockIndex(double block_m, std::vector<Entry> entries);

  [[nodiscard]] double block_m() const noexcept { return block_m_; }
  [[nodiscard]] std::size_t blocks() const noexcept { return begins_.empty() ? 0 : begins_.size() - 1; }

  /// Places further than 2^20 blocks from zero are in the outermost block.
  [[nodiscard]] BlockPlace block_of(const Eigen::Vector3d& place_m) const noexcept;
  [[nodiscard]] static std::uint64_t key_of(const BlockPlace& block) noexcept;

  /// Ascending numbers of sheets; empty for a block without any.
  [[nodiscard]] std::span<const std::uint32_t> sheets(const BlockPlace& block) const noexcept;
  [[nodiscard]] std::span<const std::uint32_t> sheets_at(const Eigen::Vector3d& place_m) const noexcept {
    return sheets(block_of(place_m));
  }

 private:
  struct Slot {
    std::uint64_t key;
    std::uint32_t block;
  };
  static constexpr std::uint32_t kEmpty = 0xffffffffU;

  double block_m_ = 1.0;
  std::uint64_t mask_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> begins_;  // of each block's sheets, and their end
  std::vector<std::uint32_t> sheets_;
};

}  // namespace sparsha::haptics

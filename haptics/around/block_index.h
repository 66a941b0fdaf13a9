// Blocks of space, hashed, each with the sheets that pass through it: what lies near a place is found without looking
// at what does not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A block's place, in blocks from zero.
using BlockPlace = Eigen::Vector3i;

inline constexpr double kPassingReach = 1.0;  ///< cells about a block

/// A sheet that passes through a block or near to it, and the two parallel planes between which its cells lie that are
/// in the block or no further than kPassingReach from it. Without such a cell every way is apart from it.
struct Passing {
  std::uint32_t sheet = 0;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, outwards of the sheet
  float low_m = std::numeric_limits<float>::infinity();
  float high_m = -std::numeric_limits<float>::infinity();  ///< of the planes, along the normal

  /// Along the normal from the planes' zero.
  [[nodiscard]] double height_m(const Eigen::Vector3d& place_m) const noexcept {
    return normal.cast<double>().dot(place_m);
  }
  /// Is the way from one place in the block to another wholly before the planes, or wholly behind them, by so much?
  [[nodiscard]] bool is_apart(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                              double margin_m) const noexcept {
    const double from = height_m(from_m), to = height_m(to_m);
    return (from < to ? from : to) > high_m + margin_m || (from < to ? to : from) < low_m - margin_m;
  }
};

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

  /// By ascending numbers of sheets; empty for a block without any.
  [[nodiscard]] std::span<const Passing> sheets(const BlockPlace& block) const noexcept;
  [[nodiscard]] std::span<const Passing> sheets_at(const Eigen::Vector3d& place_m) const noexcept {
    return sheets(block_of(place_m));
  }
  /// Whoever makes the index sets the planes; nullptr without such an entry.
  [[nodiscard]] Passing* find(const BlockPlace& block, std::uint32_t sheet) noexcept;

 private:
  struct Slot {
    std::uint64_t key;
    std::uint32_t block;
  };
  static constexpr std::uint32_t kEmpty = 0xffffffffU;

  [[nodiscard]] std::uint32_t number_of(const BlockPlace& block) const noexcept;

  double block_m_ = 1.0;
  double blocks_per_m_ = 1.0;
  std::uint64_t mask_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> begins_;  // of each block's sheets, and their end
  std::vector<Passing> sheets_;
};

}  // namespace sparsha::haptics

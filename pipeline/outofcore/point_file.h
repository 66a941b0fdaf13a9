// Points on disk in numbered buckets, written once through bounded buffers and read piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/system.h"

namespace sparsha::pipeline {

/// A record is x, y, z (float32 metres, relative to an origin kept elsewhere), then the bits of rgba, then intensity.
struct PointLayout {
  bool colour = false;
  bool intensity = false;

  [[nodiscard]] std::size_t words() const { return 3U + (colour ? 1U : 0U) + (intensity ? 1U : 0U); }
  [[nodiscard]] std::size_t bytes() const { return words() * sizeof(float); }
};

/// Some consecutive records of a bucket.
struct PointRecords {
  const float* words = nullptr;
  PointLayout layout;
  std::size_t count = 0;
  std::uint64_t first = 0;  ///< number of the first within its bucket

  [[nodiscard]] const float* xyz(std::size_t k) const { return words + k * layout.words(); }
  [[nodiscard]] std::uint32_t rgba(std::size_t k) const;
  [[nodiscard]] float intensity(std::size_t k) const { return xyz(k)[layout.words() - 1]; }
};

class PointFile {
 public:
  static constexpr std::size_t kBlockBytes = 1U << 16U;   ///< of a bucket's buffer
  static constexpr std::uint64_t kPartBytes = 1U << 28U;  ///< of the file; many would be many open files
  static constexpr std::size_t kPiece = 1U << 17U;        ///< records that read() hands over at once

  /// The file has no name and goes with this object; it is kept in parts of so many bytes, a block's at least. Throws
  /// Error{failure}.
  PointFile(const std::filesystem::path& folder, const PointLayout& layout, std::size_t buckets,
            std::uint64_t part_bytes = kPartBytes);

  [[nodiscard]] const PointLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t buckets() const { return buckets_.size(); }
  [[nodiscard]] std::uint64_t size(std::size_t bucket) const { return buckets_[bucket].records; }

  /// One writer at a time. Throws Error{failure} when the disk is full.
  void add(std::size_t bucket, const float* record) {
    Bucket& b = buckets_[bucket];
    if (b.buffer.empty()) b.buffer.reserve(block_words_);
    b.buffer.insert(b.buffer.end(), record, record + layout_.words());
    ++b.records;
    if (b.buffer.size() == block_words_) flush(b);
  }
  /// Writes what is left and frees the buffers; no more add().
  void finish();

  /// All records of a bucket in the order of add(), at most `piece` at once; the next piece is read meanwhile. Several
  /// threads may read.
  void read(std::size_t bucket, std::size_t piece, const std::function<void(const PointRecords&)>& use) const;
  /// As read() of a file of one bucket, once: records that have been used are gone from the disk, part by part where
  /// the system can do no better.
  void drain(std::size_t bucket, std::size_t piece, const std::function<void(const PointRecords&)>& use);

 private:
  struct Bucket {
    std::vector<float> buffer;
    std::vector<std::uint64_t> blocks;  ///< where they lie in the file; all but the last are full
    std::uint64_t records = 0;
  };
  void flush(Bucket& bucket);

  PointLayout layout_;
  std::size_t block_words_;
  std::vector<Bucket> buckets_;
  std::uint64_t end_ = 0;
  std::filesystem::path folder_;
  std::uint64_t part_bytes_;
  std::vector<std::unique_ptr<system::ScratchFile>> parts_;
  std::uint64_t drained_ = 0;
};

}  // namespace sparsha::pipeline

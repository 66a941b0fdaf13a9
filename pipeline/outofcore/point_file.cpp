// All buckets share one file: each full buffer is a block at its end, so that writing is sequential whatever the
// points' order. The file is cut into parts, whose room on the disk is free as soon as they are closed.
#include "pipeline/outofcore/point_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <future>
#include <span>

#include "base/threads/background.h"

namespace sparsha::pipeline {

std::uint32_t PointRecords::rgba(std::size_t k) const { return std::bit_cast<std::uint32_t>(xyz(k)[3]); }

PointFile::PointFile(const std::filesystem::path& folder, const PointLayout& layout, std::size_t buckets,
                     std::uint64_t part_bytes)
    : layout_(layout),
      block_words_(kBlockBytes / layout.bytes() * layout.words()),
      buckets_(buckets),
      folder_(folder),
      part_bytes_(part_bytes) {
  parts_.push_back(std::make_unique<system::ScratchFile>(folder_));
}

void PointFile::flush(Bucket& bucket) {
  if (bucket.buffer.empty()) return;
  const std::size_t bytes = bucket.buffer.size() * sizeof(float);
  if (end_ % part_bytes_ + bytes > part_bytes_) end_ += part_bytes_ - end_ % part_bytes_;
  while (parts_.size() <= end_ / part_bytes_) parts_.push_back(std::make_unique<system::ScratchFile>(folder_));
  parts_.back()->write(end_ % part_bytes_, std::as_bytes(std::span(bucket.buffer)));
  bucket.blocks.push_back(end_);
  end_ += bytes;
  bucket.buffer.clear();
}

void PointFile::finish() {
  for (Bucket& bucket : buckets_) {
    flush(bucket);
    bucket.buffer = {};
  }
}

void PointFile::read(std::size_t bucket, std::size_t piece, const std::function<void(const PointRecords&)>& use) const {
  const Bucket& b = buckets_[bucket];
  const std::size_t block_records = block_words_ / layout_.words();
  const std::size_t blocks_at_once = std::max<std::size_t>(1, piece / block_records);
  const std::size_t words_at_once = std::min(blocks_at_once, b.blocks.size()) * block_words_;
  const auto load = [&](std::size_t block, std::vector<float>& words) {
    words.resize(words_at_once);
    PointRecords records{words.data(), layout_, 0, block * block_records};
    const std::size_t last = std::min(b.blocks.size(), block + blocks_at_once);
    for (std::size_t k = block; k < last; ++k) {
      const auto here = static_cast<std::size_t>(std::min<std::uint64_t>(block_records, b.records - k * block_records));
      const std::span<float> part(words.data() + records.count * layout_.words(), here * layout_.words());
      parts_[static_cast<std::size_t>(b.blocks[k] / part_bytes_)]->read(b.blocks[k] % part_bytes_,
                                                                        std::as_writable_bytes(part));
      records.count += here;
    }
    return records;
  };
  // While a piece is used, the next one is read.
  std::array<std::vector<float>, 2> words;
  std::future<PointRecords> next;
  for (std::size_t block = 0; block < b.blocks.size(); block += blocks_at_once) {
    const std::size_t number = block / blocks_at_once;
    const PointRecords records = next.valid() ? next.get() : load(block, words[number % 2]);
    if (const std::size_t after = block + blocks_at_once; after < b.blocks.size()) {
      next = in_background([&load, after, &to = words[(number + 1) % 2]] { return load(after, to); });
    }
    use(records);
  }
}

void PointFile::drain(std::size_t bucket, std::size_t piece, const std::function<void(const PointRecords&)>& use) {
  std::uint64_t released = 0;
  read(bucket, piece, [&](const PointRecords& records) {
    use(records);
    // The next piece is being read: what lies behind this one, block by block in one bucket, is asked for no more.
    const std::size_t block_records = block_words_ / layout_.words();
    const Bucket& b = buckets_[bucket];
    const auto next = static_cast<std::size_t>((records.first + records.count + block_records - 1) / block_records);
    const std::uint64_t here = next < b.blocks.size() ? b.blocks[next] : parts_.size() * part_bytes_;
    for (; drained_ < here / part_bytes_; ++drained_) parts_[static_cast<std::size_t>(drained_)].reset();
    released = std::max(released, drained_ * part_bytes_);
    if (here == released) return;
    parts_[static_cast<std::size_t>(drained_)]->release(released % part_bytes_, here - released);
    released = here;
  });
}

}  // namespace sparsha::pipeline

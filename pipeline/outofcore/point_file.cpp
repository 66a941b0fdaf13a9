// All buckets share one file: each full buffer is a block at its end, so that writing is sequential whatever the
// points' order.
#include "pipeline/outofcore/point_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <future>
#include <span>

namespace sparsha::pipeline {

std::uint32_t PointRecords::rgba(std::size_t k) const { return std::bit_cast<std::uint32_t>(xyz(k)[3]); }

PointFile::PointFile(const std::filesystem::path& folder, const PointLayout& layout, std::size_t buckets)
    : layout_(layout), block_words_(kBlockBytes / layout.bytes() * layout.words()), buckets_(buckets), file_(folder) {}

void PointFile::flush(Bucket& bucket) {
  if (bucket.buffer.empty()) return;
  file_.write(end_, std::as_bytes(std::span(bucket.buffer)));
  bucket.blocks.push_back(end_);
  end_ += bucket.buffer.size() * sizeof(float);
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
      file_.read(b.blocks[k], std::as_writable_bytes(part));
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
      next = std::async(std::launch::async, load, after, std::ref(words[(number + 1) % 2]));
    }
    use(records);
  }
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/formats/las/laz/points.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "pipeline/scan/formats/las/laz/layered.h"
#include "pipeline/scan/formats/las/laz/pointwise.h"

namespace sparsha::pipeline::laz {
namespace {

constexpr std::uint64_t kMostBuffered = 1U << 18U;  // points of a chunk, or of small ones together
constexpr std::size_t kChunksAhead = 8;             // for each thread
constexpr std::size_t kBlock = 4096;                // records

/// Decodes the next `count` records behind those of `out`, in memory that grows with what is there. `record` is the
/// last one, on which decoders build.
template <class ChunkOfPoints>
void decode(ChunkOfPoints& chunk, std::uint64_t count, std::vector<std::uint8_t>& record, std::string& out) {
  for (std::uint64_t left = count; left > 0;) {
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(left, kBlock));
    out.resize(out.size() + now * record.size());
    char* at = out.data() + out.size() - now * record.size();
    for (std::size_t i = 0; i < now; ++i, at += record.size()) {
      chunk.next(record.data());
      std::memcpy(at, record.data(), record.size());
    }
    left -= now;
  }
}

template <class ChunkOfPoints>
void stream(ChunkOfPoints& chunk, std::uint64_t count, std::size_t record_size, std::size_t place,
            const RecordSink& sink) {
  std::vector<std::uint8_t> record(record_size);
  std::string block;
  for (std::uint64_t left = count; left > 0;) {
    const std::uint64_t now = std::min<std::uint64_t>(left, kBlock);
    block.clear();
    decode(chunk, now, record, block);
    sink(block, place);
    left -= now;
  }
}

void check_end(const PointwiseChunk& decoder, const Chunk& chunk) {
  if (chunk.points == 1) return;  // such a chunk may have a stream, of nothing
  if (decoder.used() < chunk.size) {
    throw Damage{"the points end after " + std::to_string(decoder.used()) + " of the chunk's " +
                     std::to_string(chunk.size) + " bytes",
                 chunk.begin};
  }
}

LayeredChunk layered(const Source& source, std::string_view bytes, const Chunk& chunk, Layers wanted) {
  LayeredChunk decoder(source.packing, bytes, chunk.begin, wanted);
  if (decoder.points() != chunk.points) {
    throw Damage{"the chunk has " + std::to_string(decoder.points()) + " points, the file's header and table give it " +
                     std::to_string(chunk.points),
                 chunk.begin + source.packing.record_size};
  }
  return decoder;
}

/// Calls `use` with a decoder of the chunk, then checks that the chunk held just its points.
template <class Use>
void with_decoder(const Source& source, const Chunk& chunk, Layers wanted, const Use& use) {
  const std::string_view bytes = source.file.substr(chunk.begin, chunk.size);
  if (source.packing.compressor == Compressor::layered) {
    LayeredChunk decoder = layered(source, bytes, chunk, wanted);
    if (decoder.size() != chunk.size) {
      throw Damage{"the layers end after " + std::to_string(decoder.size()) + " of the chunk's " +
                       std::to_string(chunk.size) + " bytes",
                   chunk.begin};
    }
    use(decoder);
  } else {
    PointwiseChunk decoder(source.packing, bytes, chunk.begin);
    use(decoder);
    check_end(decoder, chunk);
  }
}

/// Runs `work`; damage gets the number of its chunk.
template <class Work>
void in_chunk(std::size_t number, std::uint64_t of, const Work& work) {
  try {
    work();
  } catch (const Damage& damage) {
    throw Damage{
        "LAZ chunk " + std::to_string(number + 1) + (of != 0 ? " of " + std::to_string(of) : "") + ": " + damage.what,
        damage.byte};
  }
}

/// What damaged chunks took with them.
class Losses {
 public:
  explicit Losses(Damaged damaged) : damaged_(damaged) {}

  /// Whether work that may be damaged has to be whole before any of it is handed over.
  [[nodiscard]] bool leaves_out() const { return damaged_ == Damaged::left_out; }
  /// Throws it, or counts a chunk of so many points.
  void add(const Damage& damage, std::uint64_t points) {
    if (!leaves_out()) throw Damage(damage);
    if (chunks_ == 0) first_ = damage;
    ++chunks_;
    points_ += points;
  }
  void whole_chunk() { ++whole_; }
  /// Throws when nothing is whole.
  void warn(std::vector<std::string>& warnings) const {
    if (chunks_ == 0) return;
    if (whole_ == 0) throw Damage(first_);
    warnings.push_back(std::to_string(chunks_) + " damaged LAZ chunks are left out with " + std::to_string(points_) +
                       " points, " + std::to_string(whole_) + " whole ones are kept; the first damage: " + first_.what +
                       ", at byte " + std::to_string(first_.byte));
  }

 private:
  Damaged damaged_;
  Damage first_;
  std::uint64_t chunks_ = 0, points_ = 0, whole_ = 0;
};

/// Chunks one after the other to the sink, on the caller's thread, while all threads decode those that follow. Results
/// do not depend on who was first.
class SideBySide {
 public:
  SideBySide(const Source& source, const std::vector<Chunk>& chunks, Layers wanted, ThreadPool& pool, Losses& losses,
             const RecordSink& sink)
      : source_(source),
        chunks_(chunks),
        wanted_(wanted),
        pool_(pool),
        losses_(losses),
        sink_(sink),
        buffers_(kChunksAhead * pool.threads()) {}

  /// Chunks `begin` to `end`, each small enough for memory.
  void read(std::size_t begin, std::size_t end) {
    next_ = taken_ = begin;
    ahead_ = 0;
    end_ = end;
    stop_ = false;
    const std::thread::id caller = std::this_thread::get_id();
    pool_.for_ranges(pool_.threads(), 1, [&](std::size_t, std::size_t) {
      if (std::this_thread::get_id() == caller) {
        hand_over();
      } else {
        help();
      }
    });
    hand_over();  // when others were done before the caller began
  }

 private:
  struct Buffer {
    std::string records;
    std::optional<Damage> damage;
    bool full = false;
  };

  Buffer& buffer_of(std::size_t chunk) { return buffers_[chunk % buffers_.size()]; }
  /// Small chunks may be decoded farther ahead, so that no thread waits for another's large one.
  [[nodiscard]] bool may_decode() const {
    if (next_ >= end_ || next_ >= taken_ + buffers_.size()) return false;
    return next_ <= taken_ + pool_.threads() || ahead_ + chunks_[next_].points <= kMostBuffered;
  }

  /// Decodes the next chunk, without the lock.
  void decode_one(std::unique_lock<std::mutex>& lock) {
    const std::size_t number = next_++;
    ahead_ += chunks_[number].points;
    Buffer& buffer = buffer_of(number);
    if (!spare_.empty()) {
      buffer.records.swap(spare_.back());
      spare_.pop_back();
    }
    lock.unlock();
    buffer.records.clear();
    buffer.damage.reset();
    std::vector<std::uint8_t> record(source_.packing.record_size);
    try {
      in_chunk(number, chunks_.size(), [&] {
        with_decoder(source_, chunks_[number], wanted_,
                     [&](auto& decoder) { decode(decoder, chunks_[number].points, record, buffer.records); });
      });
    } catch (const Damage& damage) {
      buffer.damage = damage;
    } catch (...) {
      halt();
      throw;
    }
    lock.lock();
    buffer.full = true;
    changed_.notify_all();
  }

  void help() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return stop_ || next_ >= end_ || may_decode(); });
      if (stop_ || next_ >= end_) return;
      decode_one(lock);
    }
  }

  void hand_over() {
    std::unique_lock lock(mutex_);
    while (taken_ < end_ && !stop_) {
      Buffer& buffer = buffer_of(taken_);
      if (!buffer.full) {
        if (may_decode()) {
          decode_one(lock);
        } else {
          changed_.wait(lock, [&] { return stop_ || buffer.full; });
        }
        continue;
      }
      lock.unlock();
      try {
        sink_chunk(buffer, chunks_[taken_]);
      } catch (...) {
        halt();
        throw;
      }
      lock.lock();
      buffer.full = false;
      ahead_ -= chunks_[taken_].points;
      ++taken_;
      // Memory of as many chunks as may be large is kept for those to come.
      if (spare_.size() + next_ - taken_ <= pool_.threads()) spare_.push_back(std::move(buffer.records));
      buffer.records = {};
      changed_.notify_all();
    }
  }

  void sink_chunk(const Buffer& buffer, const Chunk& chunk) {
    if (buffer.damage) {
      losses_.add(*buffer.damage, chunk.points);
      return;
    }
    losses_.whole_chunk();
    const std::string_view records = buffer.records;
    const std::size_t step = kBlock * source_.packing.record_size;
    for (std::size_t at = 0; at < records.size(); at += step) sink_(records.substr(at, step), chunk.begin);
  }

  void halt() {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }

  const Source& source_;
  const std::vector<Chunk>& chunks_;
  Layers wanted_;
  ThreadPool& pool_;
  Losses& losses_;
  const RecordSink& sink_;
  std::vector<Buffer> buffers_;     ///< of chunk n at n modulo their number
  std::vector<std::string> spare_;  ///< memory of chunks that were handed over
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0, taken_ = 0, end_ = 0;  ///< to be decoded, to be handed over, behind the last
  std::uint64_t ahead_ = 0;                     ///< points of the chunks from taken_ to next_
  bool stop_ = false;
};

/// Runs `work` with the sink; where damage is left out, first without, so that none of a damaged chunk is handed over.
template <class Work>
bool hand_over_whole(Losses& losses, std::uint64_t points, const RecordSink& sink, const Work& work) {
  if (losses.leaves_out()) {
    try {
      work([](std::string_view, std::size_t) {});
    } catch (const Damage& damage) {
      losses.add(damage, points);
      return false;
    }
    losses.whole_chunk();
  }
  work(sink);
  return true;
}

std::size_t read_untabled(const Source& source, std::size_t begin, Layers wanted, Losses& losses,
                          const RecordSink& sink) {
  const std::size_t record_size = source.packing.record_size;
  std::size_t number = 0;
  for (std::uint64_t left = source.points; left > 0; ++number) {
    const Chunk chunk{begin, source.file.size() - begin, std::min<std::uint64_t>(left, source.packing.chunk_points)};
    std::size_t size = 0;
    const bool whole = hand_over_whole(losses, left, sink, [&](const RecordSink& use) {
      in_chunk(number, 0, [&] {
        const std::string_view bytes = source.file.substr(begin);
        if (source.packing.compressor == Compressor::layered) {
          LayeredChunk decoder = layered(source, bytes, chunk, wanted);
          stream(decoder, chunk.points, record_size, begin, use);
          size = decoder.size();
        } else {
          PointwiseChunk decoder(source.packing, bytes, begin);
          stream(decoder, chunk.points, record_size, begin, use);
          decoder.check_not_cut();
          size = decoder.used();
        }
      });
    });
    if (!whole) return begin;  // nobody knows where the next one begins
    begin += size;
    left -= chunk.points;
  }
  return begin;
}

void read_tabled(const Source& source, const std::vector<Chunk>& chunks, Layers wanted, ThreadPool& pool,
                 Losses& losses, const RecordSink& sink) {
  SideBySide side_by_side(source, chunks, wanted, pool, losses, sink);
  for (std::size_t i = 0; i < chunks.size();) {
    if (chunks[i].points > kMostBuffered) {
      hand_over_whole(losses, chunks[i].points, sink, [&](const RecordSink& use) {
        in_chunk(i, chunks.size(), [&] {
          with_decoder(source, chunks[i], wanted, [&](auto& decoder) {
            stream(decoder, chunks[i].points, source.packing.record_size, chunks[i].begin, use);
          });
        });
      });
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < chunks.size() && chunks[end].points <= kMostBuffered) ++end;
    side_by_side.read(i, end);
    i = end;
  }
}

/// The table; where damage is left out and chunks have one number of points, they need none.
ChunkTable find_chunks(const Source& source, const Losses& losses) {
  try {
    return read_chunk_table(source.file, source.first_point, source.points, source.packing);
  } catch (const Damage& damage) {
    constexpr std::size_t kPlaceOfTable = 8;
    const std::size_t begin = source.first_point + kPlaceOfTable;
    if (!losses.leaves_out() || source.packing.chunk_points == 0 || begin > source.file.size()) throw;
    return {{}, begin, damage.what + ", at byte " + std::to_string(damage.byte)};
  }
}

}  // namespace

Outcome read_points(const Source& source, Layers wanted, ThreadPool& pool, const RecordSink& sink, Damaged damaged) {
  Outcome outcome;
  if (source.points == 0) return outcome;
  if (source.packing.compressor == Compressor::pointwise) {
    PointwiseChunk decoder(source.packing, source.file.substr(source.first_point), source.first_point);
    stream(decoder, source.points, source.packing.record_size, source.first_point, sink);
    decoder.check_not_cut();
    outcome.end = source.first_point + decoder.used();
    return outcome;
  }
  Losses losses(damaged);
  const ChunkTable table = find_chunks(source, losses);
  if (table.untabled) {
    outcome.warnings.push_back(table.why + "; the chunks were read one after another");
    outcome.end = read_untabled(source, *table.untabled, wanted, losses, sink);
  } else {
    outcome.chunks = table.chunks.size();
    read_tabled(source, table.chunks, wanted, pool, losses, sink);
  }
  losses.warn(outcome.warnings);
  return outcome;
}

void read_chunks(const Source& source, const std::vector<Chunk>& chunks, Layers wanted, ThreadPool& pool,
                 const RecordSink& sink) {
  Losses losses(Damaged::refused);
  read_tabled(source, chunks, wanted, pool, losses, sink);
}

Layers layers_at(const Packing& packing, std::size_t begin, std::size_t end) {
  // The bytes of POINT14 and the layers that tell them; byte 14, the returns, is told with x and y.
  struct Part {
    std::size_t begin, end;
    Layers layers;
  };
  constexpr Part kPoint14[] = {{0, 8, kXyLayer},     {8, 12, kZLayer},      {12, 14, kIntensityLayer},
                               {14, 15, kXyLayer},   {15, 16, kFlagsLayer}, {16, 17, kClassLayer},
                               {17, 18, kUserLayer}, {18, 20, kAngleLayer}, {20, 22, kSourceLayer},
                               {22, 30, kTimeLayer}};
  Layers layers = 0;
  const auto add = [&](std::size_t offset, const Part& part) {
    if (begin < offset + part.end && end > offset + part.begin) layers |= part.layers;
  };
  for (const Item& item : packing.items) {
    switch (item.type) {
      case ItemType::point14:
        for (const Part& part : kPoint14) add(item.offset, part);
        break;
      case ItemType::rgb14:
      case ItemType::rgb_nir14:
        add(item.offset, {0, 6, kColourLayer});
        add(item.offset, {6, item.size, kInfraredLayer});
        break;
      case ItemType::wave_packet14:
        add(item.offset, {0, item.size, kWaveLayer});
        break;
      case ItemType::byte14:
        add(item.offset, {0, item.size, kBytesLayers});
        break;
      default:
        break;  // one stream for all
    }
  }
  return layers;
}

}  // namespace sparsha::pipeline::laz

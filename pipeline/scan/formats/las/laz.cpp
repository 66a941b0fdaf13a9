#include "pipeline/scan/formats/las/laz.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pipeline/scan/formats/las/copc.h"

namespace sparsha::pipeline::las {
namespace {

constexpr std::uint64_t kWorthThreads = 100'000;  // points

/// Hands records to the reader, which finds the range of the colours in the first ones, and in chunks behind them where
/// these are known.
class Arrivals {
 public:
  /// `chunks`: all of the file, or none.
  Arrivals(const ScanFile& file, const Header& header, const laz::Source& source, std::vector<laz::Chunk> chunks,
           PointReader& reader, ScanWriter& out)
      : file_(file),
        source_(source),
        chunks_(std::move(chunks)),
        size_(header.record_size),
        colour_(header.colour_offset() != 0),
        sample_(!colour_          ? 0
                : chunks_.empty() ? std::min(header.points, kColourSample)
                                  : std::min(chunks_.front().points, kColourRun)),
        reader_(reader),
        out_(out) {}

  void take(std::string_view records) {
    if (begun_) {
      add(records);
      return;
    }
    first_ += records;
    if (first_.size() / size_ >= sample_) begin();
  }
  /// Behind the last record: fewer may have come than were promised.
  void finish() {
    if (!begun_) begin();
  }

 private:
  void begin() {
    for (std::size_t i = 0; i < std::min<std::size_t>(sample_, first_.size() / size_); ++i) {
      reader_.look(first_.data() + i * size_);
    }
    if (colour_ && !reader_.colours().is_decided()) look_at_colours(file_, source_, chunks_, reader_);
    out_.begin(0, colour_, true);  // the number of points cannot be checked against the file's size
    begun_ = true;
    add(first_);
    first_.clear();
  }
  void add(std::string_view records) {
    for (std::size_t at = 0; at < records.size(); at += size_) reader_.add(records.data() + at);
  }

  const ScanFile& file_;
  const laz::Source& source_;
  std::vector<laz::Chunk> chunks_;
  std::size_t size_;
  bool colour_;
  std::uint64_t sample_;
  PointReader& reader_;
  ScanWriter& out_;
  bool begun_ = false;
  std::string first_;
};

/// The range of colours of points that stand one after the other: up to the first that decides.
void look_at_stream(const ScanFile& file, const laz::Source& source, PointReader& reader) {
  struct Decided {};
  const std::size_t size = source.packing.record_size;
  ThreadPool pool(1);
  try {
    laz::read_points(source, wanted_layers(source.packing, reader), pool, [&](std::string_view records, std::size_t) {
      for (std::size_t at = 0; at < records.size(); at += size) reader.look(records.data() + at);
      file.throw_if_cancelled();
      if (reader.colours().is_decided()) throw Decided{};
    });
  } catch (const Decided&) {
    return;
  } catch (const laz::Damage&) {
    return;  // said by those who read the points
  }
}

/// The file's octree, and what is to be said of it. A damaged one does no harm to the points.
std::optional<Octree> find_octree(const ScanFile& file, const Header& header, const laz::Packing& packing,
                                  RawScan& scan) {
  try {
    std::optional<Octree> octree = read_octree(file, header, packing);
    if (!octree) return octree;
    scan.format += " COPC";
    scan.notes.push_back(fmt::format("COPC: {} levels in {} chunks, points {:.4g} to {:.4g} apart in file units",
                                     octree->levels(), octree->nodes.size(), octree->spacing,
                                     std::ldexp(octree->spacing, 1 - octree->levels())));
    return octree;
  } catch (const laz::Damage& damage) {
    scan.warnings.push_back(fmt::format("{}, at byte {}; all of it is read as LAZ", damage.what, damage.byte));
    return std::nullopt;
  }
}

/// The nodes that are wanted, by their numbers among those with points.
std::vector<std::size_t> wanted_nodes(const Octree& octree, double z_factor, const RawScan& scan,
                                      const ScanWriter& out) {
  const int deepest = out.enough() > 0 ? octree.level_of_points(out.enough()) : octree.levels();
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    if (octree.nodes[i].level > deepest) continue;
    const Octree::Box box = octree.box_of(octree.nodes[i], z_factor);
    if (!out.region() || out.region()(box.low, box.high, scan.unit)) wanted.push_back(i);
  }
  return wanted;
}

/// Counts points that their node's cube does not hold, which a query may miss.
class StrayPoints {
 public:
  StrayPoints(const Header& header, const Octree& octree) : header_(header), octree_(octree) {}

  void look(std::string_view records, std::size_t place) {
    const auto node = std::lower_bound(octree_.nodes.begin(), octree_.nodes.end(), place,
                                       [](const Octree::Node& n, std::size_t at) { return n.chunk.begin < at; });
    const Octree::Box box = octree_.box_of(*node);
    for (std::size_t at = 0; at < records.size(); at += header_.record_size) {
      bool outside = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        const double x = load<std::int32_t>(records.data() + at + 4 * k) * header_.scale[k] + header_.offset[k];
        outside = outside || x < box.low[axis] || x > box.high[axis];
      }
      count_ += outside ? 1 : 0;
    }
  }
  void warn(RawScan& scan) const {
    if (count_ == 0) return;
    scan.warnings.push_back(
        fmt::format("{} points lie outside the cubes that its COPC hierarchy gives them; a crop may "
                    "miss such points, unless the file is written as plain LAZ",
                    count_));
  }

 private:
  const Header& header_;
  const Octree& octree_;
  std::uint64_t count_ = 0;
};

/// The chunks of a file that has a table of them; else none.
std::vector<laz::Chunk> chunks_of(const laz::Source& source, const std::optional<Octree>& octree) {
  if (octree) return octree->chunks();
  if (source.packing.compressor == laz::Compressor::pointwise || source.points == 0) return {};
  try {
    std::vector<laz::Chunk> chunks =
        laz::read_chunk_table(source.file, source.first_point, source.points, source.packing).chunks;
    std::erase_if(chunks, [](const laz::Chunk& chunk) { return chunk.points == 0; });
    return chunks;
  } catch (const laz::Damage&) {
    return {};  // said by those who read the points
  }
}

/// Reads the wanted nodes of a COPC file and no byte of the others, but of some for the range of colours.
void unpack_nodes(const ScanFile& file, const Header& header, const laz::Source& source, const Octree& octree,
                  const std::vector<std::size_t>& wanted, PointReader& reader, ScanWriter& out) {
  std::vector<laz::Chunk> chunks;
  std::uint64_t points = 0;
  for (const std::size_t i : wanted) {
    chunks.push_back(octree.nodes[i].chunk);
    points += chunks.back().points;
  }
  out.scan().unread = header.points - points;
  const bool colour = header.colour_offset() != 0;
  if (colour) look_at_colours(file, source, octree.chunks(), reader);
  ThreadPool pool(points < kWorthThreads ? 1 : 0);
  const laz::Layers layers = wanted_layers(source.packing, reader);
  out.begin(0, colour, true);
  StrayPoints strays(header, octree);
  laz::read_chunks(source, chunks, layers, pool, [&](std::string_view records, std::size_t place) {
    strays.look(records, place);
    for (std::size_t at = 0; at < records.size(); at += header.record_size) reader.add(records.data() + at);
    file.throw_if_cancelled();
  });
  strays.warn(out.scan());
}

void unpack(const ScanFile& file, const Header& header, const Units& units, PointReader& reader, ScanWriter& out) {
  laz::Source source{file.bytes, header.first_point, header.points, find_packing(file, header)};
  if (source.packing.as_older_points) {
    out.scan().warnings.push_back(
        fmt::format("its points were made as LAS 1.4 points and are kept as points of format {}: classes above 31 and "
                    "what else is new in them lie in the extra bytes",
                    header.format));
  }
  const std::optional<Octree> octree = find_octree(file, header, source.packing, out.scan());
  if (octree && !out.whole_chunks_only() && (out.region() || out.enough() > 0)) {
    const std::vector<std::size_t> wanted = wanted_nodes(*octree, units.z_factor, out.scan(), out);
    if (wanted.size() < octree->nodes.size()) {
      unpack_nodes(file, header, source, *octree, wanted, reader, out);
      return;
    }
  }
  Arrivals arrivals(file, header, source, chunks_of(source, octree), reader, out);
  ThreadPool pool(header.points < kWorthThreads ? 1 : 0);
  const laz::Outcome outcome = laz::read_points(
      source, wanted_layers(source.packing, reader), pool,
      [&](std::string_view records, std::size_t place) {
        arrivals.take(records);
        file.done_before(place);
      },
      out.whole_chunks_only() ? laz::Damaged::left_out : laz::Damaged::refused);
  arrivals.finish();
  if (outcome.chunks > 0 && !octree) out.scan().notes.push_back(fmt::format("LAZ: {} chunks", outcome.chunks));
  std::vector<std::string>& warnings = out.scan().warnings;
  warnings.insert(warnings.end(), outcome.warnings.begin(), outcome.warnings.end());
  // From LAS 1.3 on, other things may follow the points.
  if (source.packing.compressor == laz::Compressor::pointwise && header.minor < 3 && header.points > 0 &&
      outcome.end < file.bytes.size()) {
    warnings.push_back(fmt::format("{} bytes follow the {} points that the header promises; they are left out",
                                   file.bytes.size() - outcome.end, header.points));
  }
}

}  // namespace

laz::Packing find_packing(const ScanFile& file, const Header& header) {
  for (const Record& record : header.records) {
    if (record.user != "laszip encoded" || record.id != 22204) continue;
    return laz::parse_packing(record.data, static_cast<std::size_t>(record.data.data() - file.bytes.data()),
                              header.record_size);
  }
  throw file.error("compressed points without a LASzip record", "the record 22204 of 'laszip encoded'");
}

laz::Layers wanted_layers(const laz::Packing& packing, const PointReader& reader) {
  laz::Layers layers = 0;
  for (const auto& [begin, end] : reader.used_bytes()) layers |= laz::layers_at(packing, begin, end);
  return layers;
}

std::uint64_t look_at_colours(const ScanFile& file, const laz::Source& source, const std::vector<laz::Chunk>& chunks,
                              PointReader& reader) {
  if (chunks.empty()) {
    look_at_stream(file, source, reader);
    return 0;
  }
  constexpr std::uint64_t kFewest = 16;
  const std::uint64_t n = chunks.size();
  const std::uint64_t usual = std::max<std::uint64_t>(source.points / std::max<std::uint64_t>(n, 1), 1);
  const std::uint64_t wanted = std::min(n, std::max(kFewest, kColourSample / usual + 1));
  const laz::Layers layers = wanted_layers(source.packing, reader);
  const std::size_t size = source.packing.record_size;
  ThreadPool pool(1);
  std::uint64_t bytes = 0;
  for (std::uint64_t k = 0; k < wanted && !reader.colours().is_decided(); ++k) {
    const laz::Chunk& chunk = chunks[static_cast<std::size_t>(wanted < 2 ? 0 : k * (n - 1) / (wanted - 1))];
    bytes += chunk.size;
    try {
      laz::read_chunks(source, {chunk}, layers, pool, [&](std::string_view records, std::size_t) {
        for (std::size_t at = 0; at < records.size(); at += size) reader.look(records.data() + at);
        file.throw_if_cancelled();
      });
    } catch (const laz::Damage&) {
      continue;  // said by those who read its points
    }
  }
  return bytes;
}

void read_compressed(const ScanFile& file, const Header& header, const Units& units, PointReader& reader,
                     ScanWriter& out) {
  try {
    unpack(file, header, units, reader, out);
  } catch (const laz::Damage& damage) {
    throw file.error(fmt::format("{}, at byte {}", damage.what, damage.byte),
                     "an undamaged LAZ file; it may be cut short ('build --force' keeps its whole chunks)");
  }
}

}  // namespace sparsha::pipeline::las

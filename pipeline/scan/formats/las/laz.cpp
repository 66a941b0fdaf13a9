#include "pipeline/scan/formats/las/laz.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/scan/formats/las/laz/points.h"

namespace sparsha::pipeline::las {
namespace {

/// How the points are packed is described in a record of its own; without it there is nothing to read.
laz::Packing find_packing(const ScanFile& file, const Header& header) {
  for (const Record& record : header.records) {
    if (record.user != "laszip encoded" || record.id != 22204) continue;
    return laz::parse_packing(record.data, static_cast<std::size_t>(record.data.data() - file.bytes.data()),
                              header.record_size);
  }
  throw file.error("compressed points without a LASzip record", "the record 22204 of 'laszip encoded'");
}

/// Of the record's bytes that the reader looks at.
laz::Layers wanted_layers(const laz::Packing& packing, const PointReader& reader) {
  laz::Layers layers = 0;
  for (const auto& [begin, end] : reader.used_bytes()) layers |= laz::layers_at(packing, begin, end);
  return layers;
}

/// Hands records to the reader, which finds the range of the colours in the first ones.
class Arrivals {
 public:
  Arrivals(const Header& header, PointReader& reader, ScanWriter& out)
      : size_(header.record_size),
        colour_(header.colour_offset() != 0),
        sample_(std::min<std::uint64_t>(header.points, 1000)),
        reader_(reader),
        out_(out) {}

  void take(std::string_view records) {
    if (begun_) {
      add(records);
      return;
    }
    first_ += records;
    if (first_.size() / size_ < sample_) return;
    for (std::size_t i = 0; i < sample_; ++i) reader_.look(first_.data() + i * size_);
    out_.begin(0, colour_, true);  // the number of points cannot be checked against the file's size
    begun_ = true;
    add(first_);
    first_.clear();
  }

 private:
  void add(std::string_view records) {
    for (std::size_t at = 0; at < records.size(); at += size_) reader_.add(records.data() + at);
  }

  std::size_t size_;
  bool colour_;
  std::uint64_t sample_;
  PointReader& reader_;
  ScanWriter& out_;
  bool begun_ = false;
  std::string first_;
};

void unpack(const ScanFile& file, const Header& header, PointReader& reader, ScanWriter& out) {
  laz::Source source{file.bytes, header.first_point, header.points, find_packing(file, header)};
  if (source.packing.as_older_points) {
    out.scan().warnings.push_back(
        fmt::format("its points were made as LAS 1.4 points and are kept as points of format {}: classes above 31 and "
                    "what else is new in them lie in the extra bytes",
                    header.format));
  }
  Arrivals arrivals(header, reader, out);
  if (header.points == 0) arrivals.take({});
  constexpr std::uint64_t kWorthThreads = 100'000;
  ThreadPool pool(header.points < kWorthThreads ? 1 : 0);
  const laz::Outcome outcome = laz::read_points(source, wanted_layers(source.packing, reader), pool,
                                                [&](std::string_view records, std::size_t place) {
                                                  arrivals.take(records);
                                                  file.done_before(place);
                                                });
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

void read_compressed(const ScanFile& file, const Header& header, PointReader& reader, ScanWriter& out) {
  try {
    unpack(file, header, reader, out);
  } catch (const laz::Damage& damage) {
    throw file.error(fmt::format("{}, at byte {}", damage.what, damage.byte),
                     "an undamaged LAZ file; it may be cut short");
  }
}

}  // namespace sparsha::pipeline::las

#include "pipeline/scan/formats/las/laz.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "base/system.h"

#if SPARSHA_HAVE_LASZIP
#include <laszip/laszip_api.h>
#endif

namespace sparsha::pipeline::las {
namespace {

/// The table of chunks stands behind the points, and LASzip does not check that it is there: a file that was cut short
/// has lost it. Its place is told by the first 8 bytes of the points, or by the last 8 of a file that was written as a
/// stream.
void check_chunks(const ScanFile& file, const Header& header, std::uint32_t chunk_size) {
  constexpr std::size_t kPlace = 8;
  constexpr std::size_t kTable = 8;  // version and number of chunks; their packed sizes follow
  const std::string_view bytes = file.bytes;
  const auto damaged = [&](const std::string& wrong) {
    return file.error(wrong, "a complete LAZ file; it may be cut short");
  };
  if (bytes.size() - header.first_point < kPlace) throw damaged("the file ends before its LAZ points");
  auto table = load<std::int64_t>(bytes.data() + header.first_point);
  if (table == -1) table = load<std::int64_t>(bytes.data() + bytes.size() - kPlace);
  const auto first = static_cast<std::int64_t>(header.first_point + kPlace);
  if (table < first || table > static_cast<std::int64_t>(bytes.size() - kTable)) {
    throw damaged("the table of LAZ chunks should be at byte " + std::to_string(table) + ", the file has " +
                  std::to_string(bytes.size()));
  }
  const std::uint64_t chunks = load<std::uint32_t>(bytes.data() + table + 4);
  if (load<std::uint32_t>(bytes.data() + table) != 0)
    throw damaged("there is no table of LAZ chunks where it should be");
  constexpr std::uint32_t kOfAnySize = 0xFFFFFFFFU;
  const std::uint64_t packed = static_cast<std::uint64_t>(table - first);
  if (chunks > packed || (header.points > 0 && chunks == 0)) {
    throw damaged(std::to_string(chunks) + " LAZ chunks cannot be in " + std::to_string(packed) + " bytes");
  }
  if (chunk_size == kOfAnySize) return;
  if (chunk_size == 0 || (header.points + chunk_size - 1) / chunk_size != chunks) {
    throw damaged(std::to_string(header.points) + " points are not in " + std::to_string(chunks) + " LAZ chunks of " +
                  std::to_string(chunk_size));
  }
}

/// The packing is described in a record of its own; without it, or with a coder nobody knows, there is nothing to read.
void check_packing(const ScanFile& file, const Header& header) {
  for (const Record& record : header.records) {
    if (record.user != "laszip encoded" || record.id != 22204 || record.data.size() < 34) continue;
    const int compressor = load<std::uint16_t>(record.data.data());
    const int coder = load<std::uint16_t>(record.data.data() + 2);
    if (compressor < 1 || compressor > 4) {
      throw file.error("the LAZ points are packed by compressor " + std::to_string(compressor),
                       "1 to 4; it may be damaged");
    }
    if (coder != 0) {
      throw file.error("the LAZ points are packed by coder " + std::to_string(coder), "coder 0; it may be damaged");
    }
    if (compressor > 1) check_chunks(file, header, load<std::uint32_t>(record.data.data() + 12));
    return;
  }
  throw file.error("compressed points without a LASzip record", "the record 22204 of 'laszip encoded'");
}

#if SPARSHA_HAVE_LASZIP

/// What LASzip says when it fails.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Closes before it destroys, as LASzip wants it; else a reader keeps its file.
struct CloseUnpacker {
  bool open = false;

  void operator()(laszip_POINTER laszip) const {
    if (open) laszip_close_reader(laszip);
    laszip_destroy(laszip);
  }
};

/// A LASzip reader that is closed and destroyed whatever happens. Throws Failure.
class Unpacker {
 public:
  Unpacker() {
    laszip_POINTER laszip = nullptr;
    if (laszip_create(&laszip) != 0) throw Failure("it could not start");
    laszip_.reset(laszip);
  }

  void open(const std::string& file) {
    laszip_BOOL compressed = 0;
    check(laszip_open_reader(laszip_.get(), file.c_str(), &compressed));
    laszip_.get_deleter().open = true;
    check(laszip_get_point_pointer(laszip_.get(), &point_));
  }

  /// Appends the next point in the layout of the file's format, as far as PointReader looks at it.
  void next(const Header& header, std::string& out) {
    check(laszip_read_point(laszip_.get()));
    const std::array<std::int32_t, 3> xyz = {point_->X, point_->Y, point_->Z};
    std::copy_n(reinterpret_cast<const char*>(xyz.data()), sizeof xyz, bytes_.begin());
    std::copy_n(reinterpret_cast<const char*>(&point_->intensity), 2, bytes_.begin() + 12);
    // Formats 6 and up have flags of their own; LASzip need not copy them to the older place.
    bytes_[15] = static_cast<char>(header.format >= 6 ? point_->extended_classification_flags
                                                      : (point_->withheld_flag != 0 ? 128 : 0));
    const std::size_t colour = header.colour_offset();
    if (colour != 0) {
      std::copy_n(reinterpret_cast<const char*>(point_->rgb), 6, bytes_.begin() + static_cast<std::ptrdiff_t>(colour));
    }
    out.append(bytes_.data(), record_bytes(header));
  }

  /// Bytes that next() appends.
  static std::size_t record_bytes(const Header& header) {
    const std::size_t colour = header.colour_offset();
    return colour != 0 ? colour + 6 : 16;
  }

 private:
  void check(laszip_I32 failed) {
    if (failed == 0) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(laszip_.get(), &message);
    const bool told = message != nullptr && *message != '\0';
    throw Failure(told ? message : "unknown failure");
  }

  std::unique_ptr<void, CloseUnpacker> laszip_;
  laszip_point_struct* point_ = nullptr;
  std::array<char, 64> bytes_{};
};

// What the child sends begins with one of these; points or the text of a failure follow.
constexpr char kPoints = 'p';
constexpr char kFailure = 'f';

/// In the child: sends the points in blocks, the number of the present one as the step.
void unpack(const ScanFile& file, const Header& header, const system::ChildOutput& out) {
  const auto send = [&](const std::string& piece) { out.send(std::as_bytes(std::span(piece.data(), piece.size()))); };
  constexpr std::size_t kBlock = std::size_t{1} << 16U;
  try {
    Unpacker unpacker;
    try {
      unpacker.open(file.name);
      std::string block(1, kPoints);
      for (std::uint64_t i = 0; i < header.points; ++i) {
        out.step.store(i + 1, std::memory_order_relaxed);
        unpacker.next(header, block);
        if (block.size() < kBlock) continue;
        send(block);
        block.resize(1);
      }
      send(block);
    } catch (const Failure& failure) {
      send(kFailure + std::string(failure.what()));  // before the reader is closed, which may be too much for it
    }
  } catch (const Failure& failure) {
    send(kFailure + std::string(failure.what()));
  }
}

/// In this process: takes what the child sends. The range of the colours is found in the first points.
class Arrivals {
 public:
  Arrivals(const Header& header, PointReader& reader, ScanWriter& out)
      : header_(header),
        reader_(reader),
        out_(out),
        size_(Unpacker::record_bytes(header)),
        sample_(std::min<std::uint64_t>(header.points, 1000)) {}

  void take(std::string_view piece) {
    const char kind = piece.empty() ? '\0' : piece.front();
    piece.remove_prefix(std::min<std::size_t>(piece.size(), 1));
    if (kind == kFailure) {
      failure = piece.substr(0, 1000);
    } else if (kind == kPoints && piece.size() % size_ == 0 && piece.size() / size_ <= header_.points - count_) {
      take_points(piece);
    } else {
      failure = "points that make no sense";
    }
  }
  /// Throws when points are missing.
  void finish(const ScanFile& file) const {
    if (count_ != header_.points) {
      throw file.error("LASzip gave " + std::to_string(count_) + " of " + std::to_string(header_.points) + " points",
                       "an undamaged LAZ file");
    }
  }

  std::string failure;

 private:
  void take_points(std::string_view points) {
    count_ += points.size() / size_;
    if (!begun_) {
      first_ += points;
      if (count_ < sample_) return;
      for (std::size_t i = 0; i < sample_; ++i) reader_.look(first_.data() + i * size_);
      out_.begin(0, header_.colour_offset() != 0, true);  // the number of points cannot be checked against the size
      begun_ = true;
      points = first_;
    }
    for (std::size_t at = 0; at < points.size(); at += size_) reader_.add(points.data() + at);
  }

  const Header& header_;
  PointReader& reader_;
  ScanWriter& out_;
  std::size_t size_;
  std::uint64_t sample_, count_ = 0;
  bool begun_ = false;
  std::string first_;
};

/// LASzip does not check what it unpacks: damaged points make it write where it must not, or run for ever. So it gets a
/// process of its own. A copy of this one, for the library must not depend on where a program of its own may lie;
/// LASzip needs none of this program's locks (docs/architecture.md, "LASzip in a child process").
void unpack_in_child(const ScanFile& file, const Header& header, PointReader& reader, ScanWriter& out) {
  system::ChildLimits limits;
  limits.memory_bytes += 2 * file.bytes.size();
  Arrivals arrivals(header, reader, out);
  const system::ChildEnd end =
      system::run_in_child([&](const system::ChildOutput& output) { unpack(file, header, output); },
                           [&](std::span<const std::byte> piece) {
                             arrivals.take({reinterpret_cast<const char*>(piece.data()), piece.size()});
                           },
                           [&] { file.throw_if_cancelled(); }, limits);
  const std::string place =
      end.step == 0 ? "" : " at point " + std::to_string(end.step) + " of " + std::to_string(header.points);
  if (!arrivals.failure.empty()) throw file.error("LASzip: " + arrivals.failure + place, "an undamaged LAZ file");
  if (!end.failure.empty()) throw file.error("LASzip " + end.failure + place, "an undamaged LAZ file");
  arrivals.finish(file);
}

#endif

}  // namespace

void read_compressed(const ScanFile& file, const Header& header, PointReader& reader, ScanWriter& out) {
  check_packing(file, header);
  if (!header.warnings.empty()) throw file.error(header.warnings.front(), "an undamaged LAZ file");
#if SPARSHA_HAVE_LASZIP
  unpack_in_child(file, header, reader, out);
#else
  (void)reader;
  (void)out;
  throw file.error(
      "the points are compressed (LAZ) and this build of sparsha has no LASzip",
      "an uncompressed file: convert it with 'laszip -i IN.laz -o OUT.las', or install LASzip with its headers "
      "and configure sparsha again");
#endif
}

}  // namespace sparsha::pipeline::las

#include "pipeline/scan/laz.h"

#include <algorithm>
#include <memory>

#if SPARSHA_HAVE_LASZIP
#include <laszip/laszip_api.h>
#endif

namespace sparsha::pipeline::las {
namespace {

/// The table of chunks stands behind the points, and LASzip goes wild without it: a file that was cut short has lost
/// it. Its place is told by the first 8 bytes of the points, or by the last 8 of a file that was written as a stream.
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

/// Closes before it destroys, as LASzip wants it; else a reader keeps its file.
struct CloseUnpacker {
  bool open = false;

  void operator()(laszip_POINTER laszip) const {
    if (open) laszip_close_reader(laszip);
    laszip_destroy(laszip);
  }
};

/// A LASzip reader that is closed and destroyed whatever happens.
class Unpacker {
 public:
  explicit Unpacker(const ScanFile& file) : file_(file) {
    laszip_POINTER laszip = nullptr;
    if (laszip_create(&laszip) != 0) throw file_.error("LASzip could not start", "a working LASzip library");
    laszip_.reset(laszip);
    laszip_BOOL compressed = 0;
    check(laszip_open_reader(laszip, file_.name.c_str(), &compressed));
    laszip_.get_deleter().open = true;
    check(laszip_get_point_pointer(laszip, &point_));
  }

  void rewind() { check(laszip_seek_point(laszip_.get(), 0)); }

  /// The next point in the layout of the file's format, as far as PointReader looks at it.
  const char* next(const Header& header) {
    check(laszip_read_point(laszip_.get()));
    const std::array<std::int32_t, 3> xyz = {point_->X, point_->Y, point_->Z};
    std::copy_n(reinterpret_cast<const char*>(xyz.data()), sizeof xyz, bytes_.begin());
    std::copy_n(reinterpret_cast<const char*>(&point_->intensity), 2, bytes_.begin() + 12);
    // Formats 6 and up have flags of their own; LASzip's copies of them in the older place are a courtesy.
    bytes_[15] = static_cast<char>(header.format >= 6 ? point_->extended_classification_flags
                                                      : (point_->withheld_flag != 0 ? 128 : 0));
    const std::size_t colour = header.colour_offset();
    if (colour != 0) {
      std::copy_n(reinterpret_cast<const char*>(point_->rgb), 6, bytes_.begin() + static_cast<std::ptrdiff_t>(colour));
    }
    return bytes_.data();
  }

 private:
  void check(laszip_I32 failed) {
    if (failed == 0) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(laszip_.get(), &message);
    const bool told = message != nullptr && *message != '\0';
    throw file_.error(std::string("LASzip: ") + (told ? message : "unknown failure"), "an undamaged LAZ file");
  }

  const ScanFile& file_;
  std::unique_ptr<void, CloseUnpacker> laszip_;
  laszip_point_struct* point_ = nullptr;
  std::array<char, 64> bytes_{};
};

#endif

}  // namespace

void read_compressed(const ScanFile& file, const Header& header, PointReader& reader, ScanWriter& out) {
  check_packing(file, header);
  if (!header.warnings.empty()) throw file.error(header.warnings.front(), "an undamaged LAZ file");
#if SPARSHA_HAVE_LASZIP
  Unpacker unpacker(file);
  const std::uint64_t sample = std::min<std::uint64_t>(header.points, 1000);
  for (std::uint64_t i = 0; i < sample; ++i) reader.look(unpacker.next(header));
  if (sample > 0) unpacker.rewind();
  out.begin(0, header.colour_offset() != 0, true);  // the number of points cannot be checked against the file's size
  for (std::uint64_t i = 0; i < header.points; ++i) reader.add(unpacker.next(header));
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

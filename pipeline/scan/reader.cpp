// Tells a scan's format, by its content first and its ending second, and hands it to that format's reader.
#include "pipeline/scan/reader.h"

#include <algorithm>
#include <array>

#include "base/lower_case.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/e57/e57.h"
#include "pipeline/scan/formats/las/las.h"
#include "pipeline/scan/formats/obj.h"
#include "pipeline/scan/formats/pcd/pcd.h"
#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/formats/ptx.h"
#include "pipeline/scan/formats/stl.h"
#include "pipeline/scan/formats/text/xyz.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {
namespace {

constexpr const char* kKnown = "PLY, PCD, OBJ, STL, XYZ, TXT, ASC, CSV, PTS, PTX, LAS, LAZ or E57";

bool is_utf16(std::string_view bytes) {
  const std::string_view mark = bytes.substr(0, 2);
  return mark == "\xFE\xFF" || mark == "\xFF\xFE";
}

/// A file whose ending names a format, but which does not begin with that format's mark.
void refuse_missing_header(const ScanFile& file) {
  if (file.extension == "ply") throw file.error("no PLY header", "a first line 'ply'");
  if (file.extension == "pcd") {
    throw file.error("no PCD header", "lines such as 'FIELDS x y z'; plain columns of numbers should end in .xyz");
  }
  if (file.extension == "las" || file.extension == "laz") throw file.error("no LAS header", "the signature 'LASF'");
  if (file.extension == "gltf") throw file.error("the file is a glTF model", kKnown);
  if (file.extension == "e57") throw file.error("no E57 header", "the signature 'ASTM-E57'");
}

/// Refuses what is well known and no scan, whatever its ending says.
void refuse_strangers(const ScanFile& file) {
  struct Stranger {
    std::string_view mark;
    const char* what;
    const char* remedy;
  };
  using namespace std::string_view_literals;
  static constexpr Stranger kStrangers[] = {
      {"\x1F\x8B"sv, "a gzip archive", "the scan in it; unpack it first"},
      {"PK\x03\x04"sv, "a zip archive", "the scan in it; unpack it first"},
      {"7z\xBC\xAF"sv, "a 7z archive", "the scan in it; unpack it first"},
      {"\xFD"
       "7zXZ\0"sv,
       "an xz archive", "the scan in it; unpack it first"},
      {"BZh"sv, "a bzip2 archive", "the scan in it; unpack it first"},
      {"\x28\xB5\x2F\xFD"sv, "a zstd archive", "the scan in it; unpack it first"},
      {"\x89PNG"sv, "a PNG picture", kKnown},
      {"\xFF\xD8\xFF"sv, "a JPEG picture", kKnown},
      {"II*\0"sv, "a TIFF picture", kKnown},
      {"%PDF"sv, "a PDF document", kKnown},
      {"glTF"sv, "a binary glTF model", kKnown},
  };
  for (const Stranger& stranger : kStrangers) {
    if (file.bytes.starts_with(stranger.mark)) {
      throw file.error(std::string("the file is ") + stranger.what, stranger.remedy);
    }
  }
}

void read_any(const ScanFile& file, ScanWriter& out) {
  const std::string_view bytes = file.bytes;
  if (bytes.empty()) throw file.error("the file is empty", "a scan");
  if (is_ply(file)) return read_ply(file, out);
  if (is_las(file)) return read_las(file, out);
  if (is_e57(file)) return read_e57(file, out);
  if (is_binary_stl(file)) return read_stl(file, out);
  if (is_ascii_stl(file)) return read_stl(file, out);
  if (is_pcd(file)) return read_pcd(file, out);
  refuse_strangers(file);
  refuse_missing_header(file);
  if (is_utf16(bytes)) throw file.error("the text is UTF-16", "ASCII or UTF-8; convert the file first");
  if (looks_binary(bytes)) {
    if (file.extension == "stl") return read_stl(file, out);
    throw file.error("binary data of no known format", kKnown);
  }
  if (is_obj(file) || file.extension == "obj") return read_obj(file, out);
  if (is_ptx(file) || file.extension == "ptx") return read_ptx(file, out);
  if (file.extension == "stl")
    throw file.error("neither ASCII nor binary STL", "'solid' and facets, or 84 bytes and more");
  read_xyz(file, out);
}

RawScan read_into(const std::string& name, std::string_view bytes, const MappedFile* map, const PointSink& sink,
                  const Progress* progress, const ReadOptions& options) {
  ScanFile file;
  file.name = name;
  file.extension = ending_of(name);
  if (!file.extension.empty()) file.extension.erase(0, 1);
  file.bytes = bytes;
  file.map = map;
  file.progress = progress;
  file.columns = options.columns;
  RawScan scan;
  ScanWriter out(scan, sink);
  read_any(file, out);
  out.finish();
  if (!file.columns.empty() && !scan.table) {
    throw file.error("the configuration names its columns, but the file is no text table: " + scan.format,
                     "a scan without 'columns', or a file of XYZ, TXT, ASC, CSV or PTS rows");
  }
  return scan;
}

}  // namespace

RawScan read_scan(const std::filesystem::path& file, const Progress* progress, const ReadOptions& options) {
  const MappedFile map(file);
  return map.whole([&] { return read_into(file.string(), map.text(), nullptr, {}, progress, options); });
}

RawScan stream_scan(const std::filesystem::path& file, const PointSink& sink, const Progress* progress,
                    const ReadOptions& options) {
  const MappedFile map(file);
  return map.whole([&] { return read_into(file.string(), map.text(), &map, sink, progress, options); });
}

bool is_quick_to_stream(const std::filesystem::path& file) {
  const MappedFile map(file);
  ScanFile scan;
  scan.bytes = map.text();
  const std::string_view head = scan.bytes.substr(0, 4096);
  const auto says = [&](std::string_view word) { return head.find(word) != std::string_view::npos; };
  if (is_ply(scan)) {
    return says("format binary") && says("end_header") && !says("element face") && !says("element tristrip") &&
           !says("property list");
  }
  if (is_las(scan)) return scan.bytes.size() > 104 && (static_cast<unsigned char>(scan.bytes[104]) & 0xC0) == 0;
  return is_pcd(scan) && (says("DATA binary\n") || says("DATA binary\r\n"));
}

RawScan read_scan_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options) {
  return read_into(name, bytes, nullptr, {}, nullptr, options);
}

bool is_z_up(const std::string& format) {
  constexpr std::array kNames = {"LAS", "LAZ", "E57", "PTX", "PTS", "STL"};
  return std::any_of(kNames.begin(), kNames.end(), [&](const char* name) { return format.starts_with(name); });
}

}  // namespace sparsha::pipeline

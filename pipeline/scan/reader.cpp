// Tells a scan's format, by its content first and its ending second, and hands it to that format's reader.
#include "pipeline/scan/reader.h"

#include <algorithm>
#include <array>

#include "base/lower_case.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/foreign.h"
#include "pipeline/scan/formats/e57/e57.h"
#include "pipeline/scan/formats/gltf/gltf.h"
#include "pipeline/scan/formats/grid/esri.h"
#include "pipeline/scan/formats/grid/surfer.h"
#include "pipeline/scan/formats/las/las.h"
#include "pipeline/scan/formats/obj.h"
#include "pipeline/scan/formats/off.h"
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

/// A file whose ending names a format, but which does not begin with that format's mark.
void refuse_missing_header(const ScanFile& file) {
  if (file.extension == "ply") throw file.error("no PLY header", "a first line 'ply'");
  if (file.extension == "pcd") {
    throw file.error("no PCD header", "lines such as 'FIELDS x y z'; plain columns of numbers should end in .xyz");
  }
  if (file.extension == "las" || file.extension == "laz") throw file.error("no LAS header", "the signature 'LASF'");
  if (file.extension == "glb") throw file.error("no GLB header", "the signature 'glTF'");
  if (file.extension == "e57") throw file.error("no E57 header", "the signature 'ASTM-E57'");
}

void read_any(const ScanFile& file, ScanWriter& out) {
  if (file.bytes.empty()) throw file.error("the file is empty", "a scan");
  if (is_binary_stl(file)) return read_stl(file, out);  // whose first 80 bytes may be anything
  if (is_gltf(file)) return read_gltf(file, out);
  refuse_foreign(file);
  if (is_ply(file)) return read_ply(file, out);
  if (is_las(file)) return read_las(file, out);
  if (is_e57(file)) return read_e57(file, out);
  if (is_ascii_stl(file)) return read_stl(file, out);
  if (is_pcd(file)) return read_pcd(file, out);
  refuse_missing_header(file);
  if (looks_binary(file.bytes)) {
    if (file.extension == "stl") return read_stl(file, out);
    throw file.error("binary data of no known format", kKnownFormats);
  }
  if (is_esri_grid(file)) return read_esri_grid(file, out);
  if (is_surfer_grid(file)) return read_surfer_grid(file, out);
  if (is_off(file)) return read_off(file, out);
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
  file.bytes = bytes.substr(byte_order_mark(bytes));  // some editors write it before any text, a PLY header too
  file.map = map;
  file.progress = progress;
  file.columns = options.columns;
  RawScan scan;
  ScanWriter out(scan, sink, options);
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
  scan.bytes = map.text().substr(byte_order_mark(map.text()));
  const std::string_view head = scan.bytes.substr(0, 4096);
  const auto says = [&](std::string_view word) { return head.find(word) != std::string_view::npos; };
  if (is_ply(scan)) {
    return says("format binary") && says("end_header") && !says("element face") && !says("element tristrip") &&
           !says("property list");
  }
  if (is_las(scan)) return scan.bytes.size() > 104 && (static_cast<unsigned char>(scan.bytes[104]) & 0xC0) == 0;
  return is_pcd(scan) && (says("DATA binary\n") || says("DATA binary\r\n"));
}

bool may_hold_faces(const std::filesystem::path& file) {
  const MappedFile map(file);
  ScanFile scan;
  scan.extension = ending_of(file.string());
  if (!scan.extension.empty()) scan.extension.erase(0, 1);
  scan.bytes = map.text().substr(byte_order_mark(map.text()));
  if (is_binary_stl(scan) || is_gltf(scan) || is_ascii_stl(scan)) return true;
  if (is_ply(scan)) {
    const std::string_view header = scan.bytes.substr(0, std::min(scan.bytes.find("end_header"), scan.bytes.size()));
    // Any element beside the vertices.
    return header.find("element ", header.find("element ") + 1) != std::string_view::npos;
  }
  if (looks_binary(scan.bytes)) return scan.extension == "stl";
  return is_off(scan) || is_obj(scan) || scan.extension == "obj" || scan.extension == "stl";
}

RawScan read_scan_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options) {
  return read_into(name, bytes, nullptr, {}, nullptr, options);
}

bool is_z_up(const std::string& format) {
  constexpr std::array kNames = {"LAS", "LAZ", "E57", "PTX", "PTS", "STL", "ESRI", "Surfer"};
  return std::any_of(kNames.begin(), kNames.end(), [&](const char* name) { return format.starts_with(name); });
}

}  // namespace sparsha::pipeline

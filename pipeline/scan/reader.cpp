// Tells a scan's format, by its content first and its ending second, and hands it to that format's reader.
#include "pipeline/scan/reader.h"

#include "pipeline/scan/ply.h"
#include "pipeline/scan/scan_file.h"
#include "pipeline/scan/scan_writer.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

void read_any(const ScanFile& file, ScanWriter& out) {
  if (file.bytes.empty()) throw file.error("the file is empty", "a scan");
  if (is_ply(file)) return read_ply(file, out);
  throw file.error("no known scan format", "PLY");
}

RawScan read_into(const std::filesystem::path& path, const PointSink& sink) {
  const MappedFile map(path);
  ScanFile file;
  file.name = path.string();
  file.extension = lower_case(path.extension().string());
  if (!file.extension.empty()) file.extension.erase(0, 1);
  file.bytes = map.text();
  if (sink) file.map = &map;
  RawScan scan;
  ScanWriter out(scan, sink);
  read_any(file, out);
  out.finish();
  return scan;
}

}  // namespace

RawScan read_scan(const std::filesystem::path& file) { return read_into(file, {}); }

RawScan stream_scan(const std::filesystem::path& file, const PointSink& sink) { return read_into(file, sink); }

}  // namespace sparsha::pipeline

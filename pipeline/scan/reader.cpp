// Tells a scan's format, by its content first and its ending second, and hands it to that format's reader.
#include "pipeline/scan/reader.h"

#include <algorithm>
#include <string>

#include "base/text/lower_case.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/foreign.h"
#include "pipeline/scan/formats/formats.h"
#include "pipeline/scan/named_file.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {
namespace {

bool has_ending(const Format& format, const ScanFile& file) {
  return !file.extension.empty() &&
         std::find(format.endings.begin(), format.endings.end(), file.extension) != format.endings.end();
}

/// The first that the file is told to be; null when none.
const Format* find_format(const ScanFile& file, Format::Told told) {
  for (const Format& format : formats()) {
    if (format.told != told) continue;
    if (format.is != nullptr && format.is(file)) return &format;
    if (told == Format::Told::by_writing && format.by_ending && has_ending(format, file)) return &format;
  }
  return nullptr;
}

/// A file whose ending names a format, but which does not begin with that format's mark.
void refuse_missing_header(const ScanFile& file) {
  for (const Format& format : formats()) {
    if (!format.missing.empty() && has_ending(format, file))
      throw file.error("no " + std::string(format.name) + " header", std::string(format.missing));
  }
}

void read_by(const Format& format, const ScanFile& file, ScanWriter& out) {
  if (format.points_only || (format.quick_to_stream != nullptr && format.quick_to_stream(file))) out.expect_no_faces();
  format.read(file, out);
}

void read_binary_by_ending(const ScanFile& file, ScanWriter& out) {
  for (const Format& format : formats()) {
    if (format.told != Format::Told::by_writing && format.by_ending && has_ending(format, file))
      return read_by(format, file, out);
  }
  throw file.error("binary data of no known format", kKnownFormats);
}

void read_any(const ScanFile& file, ScanWriter& out) {
  if (file.bytes.empty()) throw file.empty("the file is empty", "a scan");
  if (const Format* format = find_format(file, Format::Told::by_signature)) return read_by(*format, file, out);
  refuse_foreign(file);
  if (const Format* format = find_format(file, Format::Told::by_mark)) return read_by(*format, file, out);
  refuse_missing_header(file);
  if (looks_binary(file.bytes)) return read_binary_by_ending(file, out);
  if (const Format* format = find_format(file, Format::Told::by_writing)) return read_by(*format, file, out);
  read_by(formats().back(), file, out);  // rows of numbers, whatever the file is called
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
  require_file_name(file);
  const MappedFile map(file);
  return map.whole([&] { return read_into(file.string(), map.text(), &map, {}, progress, options); });
}

RawScan stream_scan(const std::filesystem::path& file, const PointSink& sink, const Progress* progress,
                    const ReadOptions& options) {
  require_file_name(file);
  const MappedFile map(file);
  return map.whole([&] { return read_into(file.string(), map.text(), &map, sink, progress, options); });
}

bool is_quick_to_stream(const std::filesystem::path& file) {
  require_file_name(file);
  const MappedFile map(file);
  ScanFile scan;
  scan.bytes = map.text().substr(byte_order_mark(map.text()));
  return std::any_of(formats().begin(), formats().end(), [&](const Format& format) {
    return format.quick_to_stream != nullptr && format.is(scan) && format.quick_to_stream(scan);
  });
}

bool may_hold_faces(const std::filesystem::path& file) {
  require_file_name(file);
  const MappedFile map(file);
  ScanFile scan;
  scan.extension = ending_of(file.string());
  if (!scan.extension.empty()) scan.extension.erase(0, 1);
  scan.bytes = map.text().substr(byte_order_mark(map.text()));
  const bool binary = looks_binary(scan.bytes);
  return std::any_of(formats().begin(), formats().end(), [&](const Format& format) {
    if (format.may_hold_faces == nullptr || (binary && format.told == Format::Told::by_writing)) return false;
    const bool told = (format.is != nullptr && format.is(scan)) || (format.by_ending && has_ending(format, scan));
    return told && format.may_hold_faces(scan);
  });
}

RawScan read_scan_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options) {
  return read_into(name, bytes, nullptr, {}, nullptr, options);
}

bool has_ending_of_scan(const std::filesystem::path& file) {
  ScanFile scan;
  scan.extension = ending_of(file);
  if (!scan.extension.empty()) scan.extension.erase(0, 1);
  return std::any_of(formats().begin(), formats().end(),
                     [&](const Format& format) { return has_ending(format, scan); });
}

bool is_z_up(const std::string& name) {
  return std::any_of(formats().begin(), formats().end(),
                     [&](const Format& format) { return format.z_up && name.starts_with(format.name); });
}

bool is_y_up(const std::string& name) {
  return std::any_of(formats().begin(), formats().end(),
                     [&](const Format& format) { return format.y_up && name.starts_with(format.name); });
}

}  // namespace sparsha::pipeline

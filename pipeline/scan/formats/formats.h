// The formats of scans: a line a format says how a file of it is told and what reads it. A new format is a folder (or a
// pair of files) beside this one, its line in formats.cpp, a row in docs/formats.md, a name in tests/fuzz/scan_names.h
// and a file in tests/support/wave_files.cpp, of which hostile files, seeds of the fuzzer and the bench are made. A
// test names what is missing.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

struct Format {
  /// In which order files are told: signatures that no other kind of file has; then files that are no scans are refused
  /// by their names; then marks at the beginning; then, of what is text, the way that it is written.
  enum class Told { by_signature, by_mark, by_writing };
  std::string_view name;                    ///< as messages have it, "PLY"; RawScan::format begins with it
  std::array<std::string_view, 2> endings;  ///< of file names, lower case, without the dot
  Told told = Told::by_mark;
  bool (*is)(const ScanFile&) = nullptr;  ///< by what is in the file; null: by its ending alone
  void (*read)(const ScanFile&, ScanWriter&) = nullptr;
  bool z_up = false;           ///< its third coordinate is height by custom or rule
  bool by_ending = false;      ///< a file of its ending is read as it although nothing in it tells
  bool y_up = false;           ///< its second coordinate is height by rule
  std::string_view missing{};  ///< a file of its ending that is not told is an error: what it must begin with
  bool (*may_hold_faces)(const ScanFile&) = nullptr;  ///< null: never
  bool points_only = false;                           ///< none of its files has faces
  /// Its records have one length and no faces follow them, so that they are read again as fast as from memory, and in
  /// parts; null: never.
  bool (*quick_to_stream)(const ScanFile&) = nullptr;
};

/// In the order in which they are asked.
[[nodiscard]] std::span<const Format> formats();

}  // namespace sparsha::pipeline

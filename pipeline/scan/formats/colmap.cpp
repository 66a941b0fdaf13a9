#include "pipeline/scan/formats/colmap.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kCount = 8;
constexpr std::size_t kRecord = 51;  // bytes: number, three doubles, three bytes, error, length of the track
constexpr std::size_t kSeen = 8;     // bytes for each picture of the track

std::uint64_t track_of(const char* record) { return load<std::uint64_t>(record + 43); }

/// Behind the record at `at`; nothing when the file ends first.
std::optional<std::size_t> next_record(std::string_view bytes, std::size_t at) {
  if (bytes.size() - at < kRecord) return std::nullopt;
  const std::uint64_t track = track_of(bytes.data() + at);
  if (track > (bytes.size() - at - kRecord) / kSeen) return std::nullopt;
  return at + kRecord + static_cast<std::size_t>(track) * kSeen;
}

/// A point that COLMAP may have made.
bool is_likely(const char* record) {
  const auto error = load<double>(record + 35);
  constexpr double kFar = 1e12;
  for (const std::size_t at : {8U, 16U, 24U}) {
    if (!(std::fabs(load<double>(record + at)) < kFar)) return false;
  }
  return error >= -1.0 && error < 1e6 && track_of(record) < 1'000'000;
}

}  // namespace

bool is_colmap(const ScanFile& file) {
  if (file.bytes.size() < kCount + kRecord) return false;
  const auto count = load<std::uint64_t>(file.bytes.data());
  if (count == 0 || count > (file.bytes.size() - kCount) / kRecord) return false;
  constexpr std::uint64_t kLooked = 1000;
  std::size_t at = kCount;
  for (std::uint64_t i = 0; i < std::min(count, kLooked); ++i) {
    const std::optional<std::size_t> next = next_record(file.bytes, at);
    if (!next) return i > 0 && file.extension == "bin";  // cut short: said when it is read
    if (!is_likely(file.bytes.data() + at)) return false;
    at = *next;
  }
  return count > kLooked || at == file.bytes.size() || file.extension == "bin";
}

void read_colmap(const ScanFile& file, ScanWriter& out) {
  const auto count = load<std::uint64_t>(file.bytes.data());
  RawScan& scan = out.scan();
  scan.format = "COLMAP points3D";
  scan.notes.emplace_back(kColmapNote);
  scan.fields = {"x", "y", "z", "red", "green", "blue", "error", "track_length"};
  const int error = out.want("error");
  const int track = out.want("track_length");
  out.begin(count, true, false);
  std::size_t at = kCount;
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* const p = file.bytes.data() + at;
    const std::optional<std::size_t> next = next_record(file.bytes, at);
    if (!next) {
      throw file.error(fmt::format("the file ends within point {} of {}, at byte {}", i + 1, count, at),
                       "a complete points3D.bin");
    }
    if (error != ScanWriter::kUnwanted) out.set_field(error, load<double>(p + 35));
    if (track != ScanWriter::kUnwanted) out.set_field(track, static_cast<double>(track_of(p)));
    const auto byte = [&](std::size_t offset) { return load<std::uint8_t>(p + offset); };
    out.add(load<double>(p + 8), load<double>(p + 16), load<double>(p + 24), pack_rgba(byte(32), byte(33), byte(34)));
    at = *next;
    if ((i & 0xFFFF) == 0) file.done_before(at);
  }
  if (at < file.bytes.size()) {
    scan.warnings.push_back(fmt::format("{} bytes behind the last point are left out", file.bytes.size() - at));
  }
}

}  // namespace sparsha::pipeline

// Sizes are compared first, then both ends of the files, and whole files only when these agree.
#include "pipeline/scan/repeated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

// Whatever must agree besides the bytes, as text.
std::string placement_of(const scene::ScanConfig& scan) {
  std::string text = fmt::format("{} {}", static_cast<int>(scan.units.unit), scan.units.longest_side_m);
  for (const double value : scan.pose.reshaped()) text += fmt::format(" {}", value);
  for (const std::string& column : scan.columns) text += " " + column;
  return text;
}

// SHA-256 of both ends of a file, or of all of it.
std::string digest_of(const fs::path& file, bool whole) {
  constexpr std::size_t kEnd = 65536;
  const MappedFile mapped(file);
  return mapped.whole([&] {
    const std::span<const std::byte> bytes = mapped.bytes();
    if (whole || bytes.size() <= 2 * kEnd) return sha256(bytes);
    return sha256(bytes.first(kEnd)) + sha256(bytes.last(kEnd));
  });
}

// The scans by a key; those alone with theirs, or that cannot be read, are not looked at again.
template <typename Key>
std::vector<std::vector<std::size_t>> groups_of(const std::vector<std::size_t>& candidates, const Key& key_of) {
  std::map<std::string, std::vector<std::size_t>> by_key;
  for (const std::size_t i : candidates) {
    try {
      by_key[key_of(i)].push_back(i);
    } catch (const Error&) {
      continue;
    }
  }
  std::vector<std::vector<std::size_t>> groups;
  for (auto& [key, members] : by_key) {
    if (members.size() > 1) groups.push_back(std::move(members));
  }
  return groups;
}

}  // namespace

std::string digest_of_ends(const fs::path& file) { return digest_of(file, false); }

std::string digest_of_places(const fs::path& file) {
  constexpr std::uint64_t kPiece = 65536, kPieces = 64;
  const std::uint64_t size = fs::file_size(file);
  const bool whole = size <= kPiece * kPieces;
  // Each piece by one call, which makes the system read nothing ahead; of a mapping it would read megabytes around it.
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> bytes(static_cast<std::size_t>(kPiece));
  Sha256 digest;
  for (std::uint64_t k = 0; k < kPieces; ++k) {
    const std::uint64_t begin = whole             ? std::min(size, k * kPiece)
                                : k + 1 < kPieces ? (size - kPiece) / (kPieces - 1) * k
                                                  : size - kPiece;
    const auto count = static_cast<std::streamsize>(std::min(kPiece, size - begin));
    stream.seekg(static_cast<std::streamoff>(begin));
    if (!stream.read(bytes.data(), count))
      throw input_error(file.string(), "the file cannot be read", "a readable file");
    digest.add(std::as_bytes(std::span(bytes.data(), static_cast<std::size_t>(count))));
  }
  return digest.finish();
}

std::vector<scene::ScanConfig> without_repeats(const std::vector<scene::ScanConfig>& scans, Progress& progress) {
  std::vector<std::size_t> all;
  std::error_code code;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (fs::is_regular_file(scans[i].file, code)) all.push_back(i);
  }
  const auto size_of = [&](std::size_t i) {
    return fmt::format("{} {}", fs::file_size(scans[i].file, code), placement_of(scans[i]));
  };
  std::vector<bool> repeated(scans.size(), false);
  for (const auto& sizes : groups_of(all, size_of)) {
    for (const auto& ends : groups_of(sizes, [&](std::size_t i) { return digest_of_ends(scans[i].file); })) {
      for (const auto& same : groups_of(ends, [&](std::size_t i) { return digest_of(scans[i].file, true); })) {
        progress.throw_if_cancelled();
        for (std::size_t k = 1; k < same.size(); ++k) repeated[same[k]] = true;
        progress.warn(fmt::format("{}: the same scan is listed {} times in the same place; it is taken once",
                                  scans[same.front()].file.string(), same.size()));
      }
    }
  }
  std::vector<scene::ScanConfig> kept;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!repeated[i]) kept.push_back(scans[i]);
  }
  return kept;
}

}  // namespace sparsha::pipeline

// Atomic outputs, whole-file reads, SHA-256 by OpenSSL.
#include "base/files/files.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <random>
#include <system_error>
#include <utility>

#include "base/files/paths.h"

namespace sparsha {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark = ".part-";

Error output_error(const fs::path& target, const std::string& why) {
  return {ErrorKind::failure, {target.string(), 0, 0}, "cannot write: " + why, "a folder that can be written to"};
}

Error target_error(const fs::path& target, std::string wrong, std::string expected) {
  return {ErrorKind::usage, {target.string(), 0, 0}, std::move(wrong), std::move(expected)};
}

/// What this program was started with: opening such a pipe again does not wait for another end.
bool is_own_stream(const fs::path& target) {
  const std::string name = target.lexically_normal().generic_string();
  return name == "/dev/stdout" || name == "/dev/stderr" || name.starts_with("/dev/fd/") ||
         name.starts_with("/proc/self/fd/");
}

/// A character device is where bytes go to, not a file that a whole one could replace.
bool is_a_stream(const fs::path& target) {
  std::error_code code;
  const fs::file_status status = fs::status(target, code);
  if (!fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)) return false;
  if (fs::is_character_file(status) || is_own_stream(target)) return true;
  const char* const what = fs::is_fifo(status)         ? "a named pipe"
                           : fs::is_socket(status)     ? "a socket"
                           : fs::is_block_file(status) ? "a block device"
                                                       : "neither a file nor a folder";
  throw target_error(target, std::string("the output is ") + what, "a new file or an old one");
}

void check_target(const fs::path& target, AtomicPath::Kind kind) {
  std::error_code code;
  const bool folder = kind == AtomicPath::Kind::folder;
  const bool link = fs::is_symlink(fs::symlink_status(target, code));
  if (folder && link) throw target_error(target, "the output is a symbolic link", "the folder itself");
  if (link || !fs::exists(target, code)) return;
  if (fs::is_directory(target, code) != folder) {
    throw output_error(target, folder ? "a file of that name is in the way" : "a folder of that name is in the way");
  }
  if (!system::is_writable(target)) throw output_error(target, "it is there already and write-protected");
}

bool is_all(std::string_view text, std::string_view characters) {
  return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

/// What versions before random names left: PROCESS-NUMBER.
bool is_of_ended_process(std::string_view name, const fs::path& path) {
  const std::size_t dash = name.find('-');
  if (dash == std::string_view::npos || dash > 9) return false;
  constexpr std::string_view kDigits = "0123456789";
  if (!is_all(name.substr(0, dash), kDigits) || !is_all(name.substr(dash + 1), kDigits)) return false;
  std::error_code code;
  const auto written = fs::last_write_time(path, code);
  return !code && fs::file_time_type::clock::now() - written > std::chrono::hours(24) &&
         !system::process_exists(std::stoull(std::string(name.substr(0, dash))));
}

/// Removes what programs that were killed have left of `prefix` + random name.
void remove_leftovers(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> left;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const std::string_view rest = std::string_view(name).substr(prefix.size());
    const bool ours = rest.size() == 16 && is_all(rest, "0123456789abcdef");
    if (ours || is_of_ended_process(rest, entry->path())) left.push_back(entry->path());
  }
  for (const fs::path& path : left) system::remove_abandoned(path);
}

std::string random_name() {
  std::random_device random;
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name;
  for (int word = 0; word < 2; ++word) {
    const auto bits = static_cast<std::uint32_t>(random());
    for (unsigned shift = 0; shift < 32; shift += 4) name += kDigits[bits >> shift & 15U];
  }
  return name;
}

/// The same text for all names of one file, also of one that is not there yet.
fs::path resolved(const fs::path& path) {
  std::error_code code;
  fs::path result = fs::weakly_canonical(fs::absolute(path, code), code);
  return code ? fs::absolute(path, code).lexically_normal() : result;
}

}  // namespace

AtomicPath::AtomicPath(fs::path target, Kind kind) : target_(std::move(target)), kind_(kind) {
  while (target_.has_relative_path() && target_.filename().empty()) target_ = target_.parent_path();
  const fs::path folder = target_.parent_path().empty() ? fs::path(".") : target_.parent_path();
  std::error_code code;
  if (!fs::is_directory(folder, code)) throw output_error(target_, "the folder " + folder.string() + " does not exist");
  if (is_a_stream(target_)) {
    temporary_ = target_;
    return;
  }
  require_possible_name(target_);
  check_target(target_, kind_);
  constexpr std::size_t kLongestName = 200;  // of 255 bytes, with mark and random name
  const std::string prefix = "." + target_.filename().string().substr(0, kLongestName) + std::string(kMark);
  remove_leftovers(folder, prefix);
  for (int attempt = 0; attempt < 100 && handle_ < 0; ++attempt) {
    temporary_ = folder / (prefix + random_name());
    try {
      handle_ = system::create_exclusively(temporary_, kind_ == Kind::folder);
    } catch (const Error& error) {
      throw output_error(target_, error.wrong());
    }
  }
  if (handle_ < 0) throw output_error(target_, "no name is free beside it");
}

AtomicPath::~AtomicPath() {
  if (temporary_ == target_) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  system::release(handle_);
}

void AtomicPath::rethrow_naming_target() const {
  const auto renamed = [this](std::string text) {
    const std::string from = temporary_.string();
    const std::string to = target_.string();
    for (std::size_t at = 0; from != to && (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
    return text;
  };
  try {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    const Place& place = error.place();
    throw Error(error.kind(), {renamed(place.file), place.line, place.column}, renamed(error.wrong()),
                renamed(error.expected()));
  } catch (const fs::filesystem_error& error) {
    throw output_error(renamed(error.path1().empty() ? target_.string() : error.path1().string()),
                       error.code().message());
  }
}

void AtomicPath::commit() {
  if (temporary_ == target_) return;
  std::error_code code;
  check_target(target_, kind_);
  if (kind_ == Kind::folder && fs::exists(target_, code)) {
    // Exchange as one step; what is then at the temporary path is the old folder, removed by the destructor.
    if (system::exchange_paths(temporary_, target_)) return;
    const fs::path old = temporary_.string() + ".old";
    fs::rename(target_, old, code);
    if (code) throw output_error(target_, code.message());
    fs::rename(temporary_, target_, code);
    if (code) {
      std::error_code ignored;
      fs::rename(old, target_, ignored);
      throw output_error(target_, code.message());
    }
    fs::remove_all(old, code);
    return;
  }
  fs::rename(temporary_, target_, code);
  if (code) throw output_error(target_, code.message());
}

void require_writable(const fs::path& target, AtomicPath::Kind kind) { const AtomicPath probe(target, kind); }

void require_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  struct Seen {
    const NamedPath* path;
    fs::path place;
  };
  std::vector<Seen> seen;
  for (const NamedPath& input : inputs) {
    if (!input.path.empty()) seen.push_back({&input, resolved(input.path)});
  }
  for (const NamedPath& output : outputs) {
    std::error_code code;
    if (output.path.empty() || fs::is_character_file(output.path, code) || is_own_stream(output.path)) continue;
    const fs::path place = resolved(output.path);
    const bool is_there = fs::is_regular_file(place, code);
    for (const Seen& other : seen) {
      // The second question is of hard links, and of systems that do not tell A from a.
      if (place != other.place && !(is_there && fs::equivalent(place, other.place, code))) continue;
      throw usage_error(output.name + " and " + other.path->name + " are the same file, " + output.path.string(),
                        "different names: one would take the other's place");
    }
    seen.push_back({&output, place});
  }
}

bool lies_within(const fs::path& path, const fs::path& folder) {
  const fs::path inner = resolved(path);
  const fs::path outer = resolved(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

void write_file(const fs::path& target, std::string_view bytes) {
  AtomicPath path(target);
  {
    std::ofstream stream(path.temporary(), std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) throw output_error(target, "the disk may be full or the folder read-only");
  }
  path.commit();
}

std::string read_file(const fs::path& file, std::size_t limit) {
  const MappedFile mapped(file);
  if (mapped.bytes().size() > limit) {
    throw input_error(file.string(), "the file has " + std::to_string(mapped.bytes().size()) + " bytes",
                      "at most " + std::to_string(limit));
  }
  return mapped.whole([&] { return std::string(mapped.text()); });
}

void remove_own_file(const fs::path& file, std::string_view begin) {
  std::error_code code;
  if (!fs::is_regular_file(fs::symlink_status(file, code))) return;
  std::string first(begin.size(), '\0');
  std::ifstream(file, std::ios::binary).read(first.data(), static_cast<std::streamsize>(first.size()));
  if (first == begin) fs::remove(file, code);
}

MappedFile::MappedFile(const fs::path& file) : file_(file), mapping_(system::map_file(file)) {}

MappedFile::~MappedFile() { system::unmap_file(mapping_); }

void MappedFile::release_before(std::size_t offset) const { system::release_pages(mapping_, 0, offset); }

void MappedFile::require_whole() const {
  if (system::is_whole(mapping_)) return;
  throw input_error(file_.string(), "the file became shorter while it was read", "a file that nobody writes to");
}

struct Sha256::Implementation {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), EVP_MD_CTX_free};

  static void check(int result) {
    if (result != 1) throw Error(ErrorKind::failure, {}, "SHA-256 is not available");
  }
};

Sha256::Sha256() : implementation_(std::make_unique<Implementation>()) {
  Implementation::check(EVP_DigestInit_ex(implementation_->context.get(), EVP_sha256(), nullptr));
}

Sha256::~Sha256() = default;

void Sha256::add(std::span<const std::byte> bytes) {
  Implementation::check(EVP_DigestUpdate(implementation_->context.get(), bytes.data(), bytes.size()));
}

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  Implementation::check(EVP_DigestFinal_ex(implementation_->context.get(), digest.data(), &size));
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += kDigits[digest[i] >> 4U];
    text += kDigits[digest[i] & 15U];
  }
  return text;
}

std::string sha256(std::span<const std::byte> bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.finish();
}

}  // namespace sparsha

// Atomic outputs, whole-file reads, SHA-256 by OpenSSL.
#include "pipeline/base/files.h"

#include <openssl/evp.h>

#include <array>
#include <atomic>
#include <fstream>
#include <system_error>
#include <utility>

#include "pipeline/base/error.h"
#include "pipeline/base/system.h"

namespace sparsha {
namespace fs = std::filesystem;

namespace {

Error output_error(const fs::path& target, const std::string& why) {
  return {ErrorKind::failure, {target.string(), 0, 0}, "cannot write: " + why, "a folder that can be written to"};
}

/// A device, a pipe or a socket is where bytes go to, not a file that a whole one could replace.
bool is_a_stream(const fs::path& target) {
  std::error_code code;
  const fs::file_status status = fs::status(target, code);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

}  // namespace

AtomicPath::AtomicPath(fs::path target) : target_(std::move(target)) {
  static std::atomic<unsigned> counter{0};
  while (target_.has_relative_path() && target_.filename().empty()) target_ = target_.parent_path();
  const fs::path folder = target_.parent_path().empty() ? fs::path(".") : target_.parent_path();
  std::error_code code;
  if (!fs::is_directory(folder, code)) throw output_error(target_, "the folder " + folder.string() + " does not exist");
  if (is_a_stream(target_)) {
    temporary_ = target_;
    return;
  }
  temporary_ = folder / ("." + target_.filename().string() + ".part-" + std::to_string(system::process_id()) + "-" +
                         std::to_string(counter++));
}

AtomicPath::~AtomicPath() {
  if (temporary_ == target_) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void AtomicPath::commit() {
  if (temporary_ == target_) return;
  std::error_code code;
  const bool folder = fs::is_directory(temporary_, code);
  if (!fs::exists(temporary_, code)) throw output_error(target_, "nothing was written");
  if (fs::exists(target_, code) && (folder || fs::is_directory(target_, code))) {
    if (fs::is_directory(target_, code) != folder) {
      throw output_error(target_, folder ? "a file of that name is in the way" : "a folder of that name is in the way");
    }
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
  return std::string(mapped.text());
}

MappedFile::MappedFile(const fs::path& file) {
  const system::Mapping mapping = system::map_file(file);
  data_ = mapping.data;
  size_ = mapping.size;
}

MappedFile::~MappedFile() { system::unmap_file({data_, size_}); }

void MappedFile::release_before(std::size_t offset) const { system::release_pages({data_, size_}, 0, offset); }

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

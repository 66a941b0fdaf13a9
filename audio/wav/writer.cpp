// WAV through libsndfile.
#include "audio/wav/writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <sndfile.h>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::audio {
namespace {

/// Of a file that is no RF64 the chunk fmt as every program reads it: libsndfile's is WAVE_FORMAT_EXTENSIBLE, which
/// some refuse. What is left of its room becomes a chunk that readers skip. False when the file cannot be written.
bool make_plain(const std::filesystem::path& path, int bits) {
  constexpr std::size_t kExtensible = 40, kPlain = 16, kHeader = 8;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::array<char, 256> head{};
  file.read(head.data(), head.size());
  file.clear();  // a short file ends here
  const std::string_view text(head.data(), head.size());
  const std::size_t at = text.find("fmt ");
  if (!text.starts_with("RIFF") || at == std::string_view::npos || at + kHeader + kExtensible > text.size() ||
      static_cast<unsigned char>(text[at + 4]) != kExtensible)
    return file.good();
  std::array<char, kHeader + kExtensible> chunk{};
  std::copy_n(head.begin() + static_cast<std::ptrdiff_t>(at), kHeader + kPlain, chunk.begin());
  chunk[4] = static_cast<char>(kPlain);
  chunk[kHeader] = 1;  // WAVE_FORMAT_PCM
  chunk[kHeader + 1] = 0;
  chunk[kHeader + 14] = static_cast<char>(bits);
  std::copy_n("JUNK", 4, chunk.begin() + kHeader + kPlain);
  chunk[kHeader + kPlain + 4] = static_cast<char>(kExtensible - kPlain - kHeader);
  file.seekp(static_cast<std::streamoff>(at));
  file.write(chunk.data(), chunk.size());
  file.flush();
  return file.good();
}

}  // namespace

struct WavWriter::Implementation {
  std::filesystem::path target;
  AtomicPath path;
  SNDFILE* sound = nullptr;
  int bits = 16;
  std::uint64_t frames = 0;
  std::uint64_t random = 0x2545F4914F6CDD1DU;
  std::vector<int> integers;

  explicit Implementation(const std::filesystem::path& file) : target(file), path(file) {}
  ~Implementation() {
    if (sound != nullptr) sf_close(sound);
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(ErrorKind::failure, {target.string()}, "cannot write the sound: " + reason,
                "a writable place for a WAV file");
  }
  double uniform() {  // xorshift64, 0 to 1
    random ^= random << 13U;
    random ^= random >> 7U;
    random ^= random << 17U;
    return static_cast<double>(random >> 11U) * 0x1p-53;
  }
};

WavWriter::WavWriter(const std::filesystem::path& target, int sample_rate_hz, int bits)
    : implementation_(std::make_unique<Implementation>(target)) {
  Implementation& self = *implementation_;
  self.bits = bits;
  SF_INFO info{};
  info.samplerate = sample_rate_hz;
  info.channels = 2;
  info.format = SF_FORMAT_RF64 | (bits == 24 ? SF_FORMAT_PCM_24 : SF_FORMAT_PCM_16);
  self.sound = sf_open(self.path.temporary().c_str(), SFM_WRITE, &info);
  if (self.sound == nullptr) self.fail(sf_strerror(nullptr));
  sf_command(self.sound, SFC_RF64_AUTO_DOWNGRADE, nullptr, SF_TRUE);
}

WavWriter::~WavWriter() = default;

void WavWriter::write(std::span<const float> interleaved) {
  Implementation& self = *implementation_;
  const double steps = self.bits == 24 ? 8388607.0 : 32767.0;
  const int shift = self.bits == 24 ? 8 : 16;
  self.integers.clear();
  for (const float sample : interleaved) {
    double value = static_cast<double>(sample) * steps;
    if (self.bits == 16 && value != 0.0) value += self.uniform() - self.uniform();
    self.integers.push_back(static_cast<int>(std::lround(value)) * (1 << shift));
  }
  const auto frames = static_cast<sf_count_t>(interleaved.size() / 2);
  if (sf_writef_int(self.sound, self.integers.data(), frames) != frames) self.fail(sf_strerror(self.sound));
  self.frames += static_cast<std::uint64_t>(frames);
}

std::uint64_t WavWriter::frames() const { return implementation_->frames; }

void WavWriter::commit() {
  Implementation& self = *implementation_;
  sf_write_sync(self.sound);
  const int status = sf_close(self.sound);
  self.sound = nullptr;
  if (status != 0) self.fail(sf_error_number(status));
  if (!make_plain(self.path.temporary(), self.bits)) self.fail("its header cannot be written");
  self.path.commit();
}

}  // namespace sparsha::audio

// A WAV file that is either whole or not there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace sparsha::audio {

/// A WAV file, which from 4 GB on (6.2 hours of 16 bits at 48 kHz) is an RF64 one. Stereo, 16 bits with triangular
/// dither (seeded: same sound, same bytes), or 24 bits. Digital silence stays exact zeros.
class WavWriter {
 public:
  /// Opens a file beside `target`. Throws Error{failure}.
  WavWriter(const std::filesystem::path& target, int sample_rate_hz, int bits = 16);
  ~WavWriter();
  WavWriter(const WavWriter&) = delete;
  WavWriter& operator=(const WavWriter&) = delete;

  /// Interleaved stereo within [-1, 1]. Throws Error{failure}.
  void write(std::span<const float> interleaved);
  [[nodiscard]] std::uint64_t frames() const;
  /// Finishes the file and renames it over the target. Throws Error{failure}.
  void commit();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio

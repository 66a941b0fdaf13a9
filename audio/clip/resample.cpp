// Clips at the stream's rate, through libsoxr; used once when a clip is loaded.
#include <soxr.h>

#include <cmath>
#include <string>

#include "audio/clip/clip.h"
#include "base/error.h"

namespace sparsha::audio {

std::vector<float> resample(const std::vector<float>& samples, int channels, double from_hz, double to_hz) {
  if (from_hz == to_hz || samples.empty()) return samples;
  const auto width = static_cast<std::size_t>(channels);
  const std::size_t frames = samples.size() / width;
  const auto wanted = static_cast<std::size_t>(std::ceil(static_cast<double>(frames) * to_hz / from_hz));
  std::vector<float> out(wanted * width, 0.0F);
  const soxr_io_spec_t io = soxr_io_spec(SOXR_FLOAT32_I, SOXR_FLOAT32_I);
  const soxr_quality_spec_t quality = soxr_quality_spec(SOXR_VHQ, 0);
  std::size_t used = 0;
  std::size_t made = 0;
  const soxr_error_t error = soxr_oneshot(from_hz, to_hz, static_cast<unsigned>(channels), samples.data(), frames,
                                          &used, out.data(), wanted, &made, &io, &quality, nullptr);
  if (error != nullptr) throw Error(ErrorKind::failure, {}, std::string("cannot resample a clip: ") + error);
  return out;
}

}  // namespace sparsha::audio

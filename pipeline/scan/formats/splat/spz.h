// Gaussian splats as SPZ files have them (versions 1 to 3): gzip over a header of 16 bytes, then all splats' positions,
// opacities, colours, axes, turns and harmonics.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/scan/file.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// All splats of an SPZ stream but their turns and harmonics, which are only read through.
class SpzSplats {
 public:
  /// `file.bytes`: the stream. Throws Error{input} for what is damaged, cut or of another version, before memory is
  /// taken for splats that cannot be there.
  explicit SpzSplats(const ScanFile& file);

  [[nodiscard]] std::size_t size() const { return opacities_.size(); }
  [[nodiscard]] std::uint32_t version() const { return version_; }
  /// Coordinate k of splat i, file units: right, up, back.
  [[nodiscard]] double coordinate(std::size_t i, std::size_t k) const;
  /// Standard deviation along the longest axis, file units.
  [[nodiscard]] double longest(std::size_t i) const;
  /// 0 to 1.
  [[nodiscard]] double opacity(std::size_t i) const;
  /// 0xAABBGGRR, sRGB.
  [[nodiscard]] std::uint32_t colour(std::size_t i) const;

 private:
  std::uint32_t version_ = 0;
  int fraction_bits_ = 0;  ///< of coordinates
  std::string places_, opacities_, colours_, axes_;
};

/// By the first bytes within the gzip stream.
[[nodiscard]] bool is_spz(const ScanFile& file);
void read_spz(const ScanFile& file, ScanWriter& out);

}  // namespace sparsha::pipeline

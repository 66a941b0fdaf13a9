// Puts right what stands before a reader's own work, so that damage gets past it: checksums of pages, packed streams.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/e57/pages.h"
#include "pipeline/scan/formats/threemf/zip.h"
#include "pipeline/scan/inflate.h"
#include "tests/support/deflated.h"

namespace sparsha::pipeline::testing {

/// The file of this name whose damaged contents these are: E57 pages get right checksums, the stream of an SPZ file and
/// the model of a 3MF file are packed when they are bare.
inline std::string mended(std::string bytes, std::string_view name) {
  if (bytes.starts_with("ASTM-E57")) {
    constexpr std::size_t kPage = 1024;
    for (std::size_t at = 0; at + kPage <= bytes.size(); at += kPage) {
      const std::uint32_t crc = e57::crc32c(std::string_view(bytes).substr(at, kPage - 4));
      for (std::size_t k = 0; k < 4; ++k) bytes[at + kPage - 1 - k] = static_cast<char>(crc >> (8 * k) & 255);
    }
  }
  if (name.ends_with(".spz") && bytes.starts_with("NGSP")) return deflated(bytes, 16 + 15);
  if (name.ends_with(".3mf") && bytes.starts_with("<")) return zipped({{"3D/3dmodel.model", bytes}});
  return bytes;
}

/// The contents of a sound file of this name, which mended() packs again.
inline std::string bare(const std::string& bytes, std::string_view name) {
  constexpr std::size_t kMost = std::size_t{1} << 24U;
  if (name.ends_with(".spz")) return Inflater(bytes, Inflater::Wrapping::gzip).read(kMost);
  if (!name.ends_with(".3mf")) return bytes;
  ScanFile file;
  file.name = name;
  file.bytes = bytes;
  return ZipArchive(file).read("3D/3dmodel.model");
}

}  // namespace sparsha::pipeline::testing

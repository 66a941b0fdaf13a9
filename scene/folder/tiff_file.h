// Tiled TIFF files through libtiff, whose messages are kept per file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace sparsha::scene {

/// What a file is made of. Tiles are square; rows are stored from the top down.
struct TiffLayout {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t tile = 0;     ///< nodes per side; 0: the file is not tiled, or not square
  std::uint16_t bits = 32;    ///< of a sample
  std::uint16_t samples = 1;  ///< 4: red, green, blue, alpha
  bool floating = true;       ///< IEEE numbers, of which NaN is declared to be "no data"; else unsigned integers
  bool packed = false;        ///< compressed; only files that are read

  [[nodiscard]] std::size_t pixel_bytes() const { return std::size_t{bits} / 8 * samples; }
};

/// One file, one thread. No call throws: what went wrong is in message().
class TiffFile {
 public:
  /// For writing; as BigTIFF when it would outgrow the offsets of a classic one.
  static TiffFile create(const std::filesystem::path& file, const TiffLayout& layout);
  /// For reading; not mapped, so that a file that is cut short meanwhile is an error and no signal.
  static TiffFile open(const std::filesystem::path& file);
  ~TiffFile();
  TiffFile(TiffFile&&) noexcept;
  TiffFile& operator=(TiffFile&&) noexcept;

  [[nodiscard]] bool is_open() const;
  [[nodiscard]] TiffLayout layout() const;
  /// tile * tile pixels whose upper left one is (left, top), a multiple of the tile's side.
  [[nodiscard]] bool write_tile(std::uint32_t left, std::uint32_t top, const void* pixels);
  [[nodiscard]] bool read_tile(std::uint32_t left, std::uint32_t top, void* pixels);
  /// What is not flushed is not whole.
  [[nodiscard]] bool flush();
  /// libtiff's last complaint; empty when there was none.
  [[nodiscard]] const std::string& message() const;

 private:
  struct Implementation;
  explicit TiffFile(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::scene

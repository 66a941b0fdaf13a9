// libjpeg leaves by a long jump, as libpng does: what it calls has no objects with destructors in between.
#include <cstdio>  // jpeglib.h names FILE without it

#include <jpeglib.h>

#include <csetjmp>

#include "base/error.h"
#include "pipeline/scan/formats/texture/picture.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline::pictures {
namespace {

/// A progressive picture refines itself in some ten passes over all of its pixels. Files that mean harm have thousands.
constexpr int kMostPasses = 200;

class Reader {
 public:
  explicit Reader(std::string_view bytes) {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_.client_data = this;
    errors_.error_exit = &on_error;
    errors_.emit_message = &on_warning;
    progress_.progress_monitor = &on_progress;
    if (setjmp(out_) != 0) return;
    jpeg_create_decompress(&jpeg_);
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    ready_ = true;
  }
  ~Reader() { jpeg_destroy_decompress(&jpeg_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// False when libjpeg refused; then message() says why.
  bool read_header() {
    if (!ready_ || setjmp(out_) != 0) return false;
    jpeg_read_header(&jpeg_, TRUE);
    four_inks_ = jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK;
    jpeg_.out_color_space = four_inks_ ? JCS_CMYK : JCS_EXT_RGBA;
    return true;
  }
  bool read_rows(std::uint32_t* pixels, std::size_t width) {
    if (setjmp(out_) != 0) return false;
    jpeg_start_decompress(&jpeg_);
    while (jpeg_.output_scanline < jpeg_.output_height) {
      auto* row = reinterpret_cast<JSAMPROW>(pixels + jpeg_.output_scanline * width);
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    return true;
  }
  [[nodiscard]] bool four_inks() const { return four_inks_; }
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] std::size_t width() const { return jpeg_.image_width; }
  [[nodiscard]] std::size_t height() const { return jpeg_.image_height; }

 private:
  static Reader& self(j_common_ptr jpeg) { return *static_cast<Reader*>(jpeg->client_data); }
  [[noreturn]] static void leave(j_common_ptr jpeg) {
    char text[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, text);
    self(jpeg).message_ = text;
    std::longjmp(self(jpeg).out_, 1);
  }
  static void on_error(j_common_ptr jpeg) { leave(jpeg); }
  /// Warnings (level -1) are of damaged data, for which libjpeg would put grey.
  static void on_warning(j_common_ptr jpeg, int level) {
    if (level < 0) leave(jpeg);
  }
  static void on_progress(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostPasses) return;
    self(jpeg).message_ = "it has too many passes";
    std::longjmp(self(jpeg).out_, 1);
  }

  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf out_{};
  bool ready_ = false, four_inks_ = false;
  std::string message_;
};

/// Adobe's programs write inks inverted: 255 is none of it.
void mix_inks(ColourPicture& picture) {
  for (std::uint32_t& pixel : picture.rgba) {
    const std::uint32_t black = pixel >> 24U;
    const auto mixed = [&](unsigned shift) { return (pixel >> shift & 255U) * black / 255U; };
    pixel = pack_rgba(mixed(0), mixed(8), mixed(16));
  }
}

}  // namespace

ColourPicture decode_jpeg(std::string_view bytes, const std::string& name) {
  Reader reader(bytes);
  const auto damaged = [&] {
    return input_error(name, "a JPEG that cannot be read: " + reader.message(), "a whole picture");
  };
  if (!reader.read_header()) throw damaged();
  ColourPicture picture{reader.width(), reader.height(), {}};
  require_size(picture.width, picture.height, bytes.size(), name);
  picture.rgba.resize(picture.width * picture.height);
  if (!reader.read_rows(picture.rgba.data(), picture.width)) throw damaged();
  if (reader.four_inks()) mix_inks(picture);
  return picture;
}

}  // namespace sparsha::pipeline::pictures

// libpng leaves by a long jump: what it calls has no objects with destructors in between.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "base/error.h"
#include "pipeline/scan/formats/texture/picture.h"

namespace sparsha::pipeline::pictures {
namespace {

static_assert(std::endian::native == std::endian::little, "rows of libpng are bytes: red, green, blue, alpha");

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &on_error, &on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ != nullptr) png_set_read_fn(png_, this, &read);
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// False when libpng refused; then message() says why.
  bool read_header() {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  bool read_rows(std::uint32_t* pixels, std::size_t width, std::size_t height) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    for (int pass = 0; pass < passes_; ++pass) {
      for (std::size_t row = 0; row < height; ++row)
        png_read_row(png_, reinterpret_cast<png_bytep>(pixels + row * width), nullptr);
    }
    return true;
  }
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] std::uint32_t width() const { return png_get_image_width(png_, info_); }
  [[nodiscard]] std::uint32_t height() const { return png_get_image_height(png_, info_); }
  [[nodiscard]] std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }

 private:
  static void on_error(png_structp png, png_const_charp text) {
    static_cast<Reader*>(png_get_error_ptr(png))->message_ = text;
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void read(png_structp png, png_bytep out, std::size_t count) {
    auto& self = *static_cast<Reader*>(png_get_io_ptr(png));
    if (count > self.bytes_.size() - self.at_) png_error(png, "the file ends too early");
    std::memcpy(out, self.bytes_.data() + self.at_, count);
    self.at_ += count;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::string message_;
  int passes_ = 1;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

ColourPicture decode_png(std::string_view bytes, const std::string& name) {
  Reader reader(bytes);
  const auto damaged = [&] {
    return input_error(name, "a PNG that cannot be read: " + reader.message(), "a whole picture");
  };
  if (!reader.read_header()) throw damaged();
  ColourPicture picture{reader.width(), reader.height(), {}};
  require_size(picture.width, picture.height, bytes.size(), name);
  if (reader.row_bytes() != picture.width * sizeof(std::uint32_t)) throw damaged();
  picture.rgba.resize(picture.width * picture.height);
  if (!reader.read_rows(picture.rgba.data(), picture.width, picture.height)) throw damaged();
  return picture;
}

}  // namespace sparsha::pipeline::pictures

// As in png.cpp, libpng leaves by a long jump: what it calls has no objects with destructors in between.
#include "base/png/png_reader.h"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30U;
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28U;
constexpr const char* kExpected = "a PNG whose pixels are grey values or palette numbers";

static_assert(std::endian::native == std::endian::little, "rows of libpng are bytes: red, green, blue, alpha");

enum class Pixels { numbers, colours };

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
  bool read_header(Pixels pixels) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    if (pixels == Pixels::numbers) {
      png_set_packing(png_);
    } else {
      png_set_expand(png_);
      png_set_strip_16(png_);
      png_set_gray_to_rgb(png_);
      png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    }
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }
  bool read_rows(png_byte** rows, Pixels pixels) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    if (pixels == Pixels::numbers)
      png_read_end(png_, nullptr);  // a colour after which nothing follows is one all the same
    return true;
  }
  [[nodiscard]] const std::string& message() const { return message_; }
  [[nodiscard]] std::uint32_t width() const { return png_get_image_width(png_, info_); }
  [[nodiscard]] std::uint32_t height() const { return png_get_image_height(png_, info_); }
  [[nodiscard]] int depth() const { return png_get_bit_depth(png_, info_); }
  [[nodiscard]] std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  [[nodiscard]] bool numbers() const {
    const int type = png_get_color_type(png_, info_);
    return type == PNG_COLOR_TYPE_GRAY || type == PNG_COLOR_TYPE_PALETTE;
  }

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
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

NumberImage read_number_png(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, kMostBytes);
  Reader reader(bytes);
  const auto damaged = [&] {
    return input_error(file.string(), "cannot read the picture: " + reader.message(), kExpected);
  };
  if (!reader.read_header(Pixels::numbers)) throw damaged();
  if (!reader.numbers()) throw input_error(file.string(), "the picture has colours, not numbers", kExpected);
  if (std::uint64_t{reader.width()} * reader.height() > kMostPixels)
    throw input_error(file.string(), "the picture has more than 2^28 pixels", "a smaller picture");
  NumberImage image;
  image.width = static_cast<int>(reader.width());
  image.height = static_cast<int>(reader.height());
  std::vector<png_byte> pixels(reader.row_bytes() * reader.height());
  std::vector<png_byte*> rows;
  for (std::size_t row = 0; row < reader.height(); ++row) rows.push_back(pixels.data() + row * reader.row_bytes());
  if (!reader.read_rows(rows.data(), Pixels::numbers)) throw damaged();
  const bool wide = reader.depth() == 16;
  image.values.reserve(static_cast<std::size_t>(image.width) * rows.size());
  for (const png_byte* row : rows)
    for (std::size_t i = 0; i < static_cast<std::size_t>(image.width); ++i)
      image.values.push_back(wide ? static_cast<std::uint16_t>(row[2 * i] << 8U | row[2 * i + 1])
                                  : std::uint16_t{row[i]});
  return image;
}

ColourImage read_colour_png(std::string_view bytes, const std::string& name,
                            const std::function<void(std::size_t, std::size_t)>& allow) {
  Reader reader(bytes);
  const auto damaged = [&] {
    return input_error(name, "a PNG that cannot be read: " + reader.message(), "a whole picture");
  };
  if (!reader.read_header(Pixels::colours)) throw damaged();
  ColourImage image{reader.width(), reader.height(), {}};
  allow(image.width, image.height);
  if (reader.row_bytes() != image.width * sizeof(std::uint32_t)) throw damaged();
  image.rgba.resize(image.width * image.height);
  std::vector<png_byte*> rows;
  for (std::size_t row = 0; row < image.height; ++row)
    rows.push_back(reinterpret_cast<png_byte*>(image.rgba.data() + row * image.width));
  if (!reader.read_rows(rows.data(), Pixels::colours)) throw damaged();
  return image;
}

}  // namespace sparsha

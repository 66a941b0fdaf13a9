// Pictures of numbers: read back as they were written, refused when they are none.
#include "base/png/png_reader.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "base/error.h"
#include "base/png/png.h"
#include "tests/support/test_folder.h"

namespace sparsha {
namespace {

PngFormat format_of(PngFormat::Pixel pixel, int width, int height) {
  PngFormat format;
  format.width = width;
  format.height = height;
  format.pixel = pixel;
  return format;
}

TEST(PngReader, GreyValuesAndPaletteNumbersComeBackAsTheyWereWritten) {
  const test::TestFolder folder;
  const PngFormat grey = format_of(PngFormat::Pixel::grey16, 3, 1);
  write_png(folder / "grey.png", grey, std::vector<std::uint8_t>{0x12, 0x34, 0, 7, 0xFF, 0xFF});
  const NumberImage values = read_number_png(folder / "grey.png");
  EXPECT_EQ(values.width, 3);
  EXPECT_EQ(values.height, 1);
  EXPECT_EQ(values.values, (std::vector<std::uint16_t>{0x1234, 7, 0xFFFF}));
  PngFormat palette = format_of(PngFormat::Pixel::palette8, 3, 1);
  palette.palette = {{0, 0, 0}, {255, 0, 0}, {0, 255, 0}};
  write_png(folder / "palette.png", palette, std::vector<std::uint8_t>{2, 0, 1});
  EXPECT_EQ(read_number_png(folder / "palette.png").values, (std::vector<std::uint16_t>{2, 0, 1}));
}

TEST(PngReader, ColoursAndFilesThatAreCutShortAreInputErrors) {
  const test::TestFolder folder;
  const PngFormat colours = format_of(PngFormat::Pixel::rgb8, 40, 40);
  write_png(folder / "colours.png", colours, std::vector<std::uint8_t>(4800, 9));
  const PngFormat grey = format_of(PngFormat::Pixel::grey16, 40, 40);
  std::vector<std::uint8_t> pixels(3200);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i);
  const std::string whole = encode_png(grey, pixels);
  std::ofstream(folder / "empty.png").close();
  for (std::size_t length = 1; length + 12 < whole.size(); length += 37) {
    std::ofstream(folder / "cut.png", std::ios::binary) << whole.substr(0, length);
    EXPECT_THROW((void)read_number_png(folder / "cut.png"), Error) << length;
  }
  for (const char* name : {"colours.png", "empty.png", "missing.png"})
    EXPECT_THROW((void)read_number_png(folder / name), Error) << name;
}

}  // namespace
}  // namespace sparsha

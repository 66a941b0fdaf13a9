#include "base/png/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "tests/support/test_folder.h"

namespace sparsha {
namespace {

std::vector<std::uint8_t> ramp(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t n = 0; n < count; ++n) bytes[n] = static_cast<std::uint8_t>(n * 7);
  return bytes;
}

/// libpng's own simple reader, which the writer does not use.
std::vector<std::uint8_t> decode(const std::string& bytes, png_uint_32 format, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(static_cast<int>(image.width), width);
  EXPECT_EQ(static_cast<int>(image.height), height);
  image.format = format;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  return pixels;
}

PngFormat format_of(PngFormat::Pixel pixel, int width, int height) {
  PngFormat format;
  format.pixel = pixel;
  format.width = width;
  format.height = height;
  return format;
}

TEST(Png, PicturesOfColoursReadBackAsTheyWere) {
  const auto pixels = ramp(3 * 37 * 23);
  EXPECT_EQ(decode(encode_png(format_of(PngFormat::Pixel::rgb8, 37, 23), pixels), PNG_FORMAT_RGB, 37, 23), pixels);
}

TEST(Png, PalettesReadBackAsTheirColours) {
  const auto pixels = ramp(37 * 23);
  PngFormat format = format_of(PngFormat::Pixel::palette8, 37, 23);
  for (int k = 0; k < 256; ++k) {
    const auto level = static_cast<std::uint8_t>(k);
    format.palette.push_back({level, static_cast<std::uint8_t>(255 - k), static_cast<std::uint8_t>(k / 2)});
  }
  for (const bool detailed : {false, true}) {
    format.detailed = detailed;
    const auto rgb = decode(encode_png(format, pixels), PNG_FORMAT_RGB, 37, 23);
    for (std::size_t n = 0; n < pixels.size(); ++n) {
      for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(rgb[3 * n + c], format.palette[pixels[n]][c]);
    }
  }
}

TEST(Png, TheSamePixelsGiveTheSameBytes) {
  const auto pixels = ramp(2 * 50 * 40);
  const PngFormat format = format_of(PngFormat::Pixel::grey16, 50, 40);
  EXPECT_EQ(encode_png(format, pixels), encode_png(format, pixels));
}

TEST(Png, WhatTheSinkThrowsPassesThrough) {
  const auto pixels = ramp(3 * 64);
  std::size_t taken = 0;
  const auto write = [&] {
    PngWriter writer(format_of(PngFormat::Pixel::rgb8, 64, 1000), [&](std::span<const std::byte> bytes) {
      taken += bytes.size();
      if (taken > 500) throw std::length_error("full");
    });
    for (int row = 0; row < 1000; ++row) writer.write_row(pixels);
    writer.finish();
  };
  EXPECT_THROW(write(), std::length_error);
}

TEST(Png, RowsThatAreNotARowAndPicturesThatAreNoneAreErrors) {
  PngWriter writer(format_of(PngFormat::Pixel::rgb8, 4, 4), [](std::span<const std::byte>) {});
  EXPECT_THROW(writer.write_row(ramp(11)), Error);
  EXPECT_THROW((void)encode_png(format_of(PngFormat::Pixel::rgb8, 0, 4), {}), Error);
  EXPECT_THROW(writer.finish(), Error) << "rows are missing";
}

TEST(Png, AFileIsWholeOrNotThere) {
  const test::TestFolder folder;
  write_png(folder / "a.png", format_of(PngFormat::Pixel::rgb8, 8, 8), ramp(3 * 64));
  EXPECT_TRUE(std::filesystem::exists(folder / "a.png"));
  EXPECT_THROW(write_png(folder / "none" / "a.png", format_of(PngFormat::Pixel::rgb8, 8, 8), ramp(3 * 64)), Error);
}

}  // namespace
}  // namespace sparsha

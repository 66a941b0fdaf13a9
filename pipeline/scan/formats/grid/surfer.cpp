#include "pipeline/scan/formats/grid/surfer.h"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/grid/heights.h"

namespace sparsha::pipeline {
namespace {

std::string first_word(std::string_view text) {
  text = text.substr(0, 64);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return lower_case(text.substr(begin, text.find_first_of(" \t\r\n", begin) - begin));
}

}  // namespace

bool is_surfer_grid(const ScanFile& file) { return first_word(file.bytes) == "dsaa"; }

void read_surfer_grid(const ScanFile& file, ScanWriter& out) {
  constexpr const char* kExpected = "'DSAA', columns and rows, then the least and the greatest x, y and z";
  LineReader lines(file.bytes);
  std::string_view line;
  const auto word = [&] {
    std::string_view found = take_word(line);
    while (found.empty()) {
      if (!lines.next(line)) throw file.error_at(lines.number(), "the file ends within the grid's header", kExpected);
      found = take_word(line);
    }
    return found;
  };
  (void)word();  // DSAA
  bool comma = false, point = false;
  std::array<double, 8> header{};  // columns, rows, x, y and z from and to
  for (std::size_t k = 0; k < header.size(); ++k) {
    const std::string_view text = word();
    const bool good = grid::parse_value(text, header[k], comma, point) && std::isfinite(header[k]);
    if (!good || (k < 2 && (header[k] < 1.0 || header[k] >= 4294967296.0 || header[k] != std::floor(header[k])))) {
      throw file.error_at(lines.number(), in_quotes(text) + " in the grid's header", kExpected);
    }
  }
  grid::Raster raster;
  raster.columns = static_cast<std::uint64_t>(header[0]);
  raster.rows = static_cast<std::uint64_t>(header[1]);
  raster.x = header[2];
  raster.y = header[4];
  const auto step = [&](double from, double to, std::uint64_t count, char axis) {
    if (count == 1) return 1.0;
    const double size = (to - from) / static_cast<double>(count - 1);
    if (size == 0.0) {
      throw file.error_at(lines.number(), fmt::format("{} goes from {:g} to {:g}", axis, from, to),
                          "limits that differ");
    }
    return size;
  };
  raster.dx = step(header[2], header[3], raster.columns, 'x');
  raster.dy = step(header[4], header[5], raster.rows, 'y');
  grid::require_plausible(file, lines.number(), raster, file.bytes.size() - lines.offset() + line.size() + 1);
  RawScan& scan = out.scan();
  scan.format = "Surfer ASCII grid";
  scan.fields = {"x", "y", "z"};
  grid::HeightReader(file, out, raster, std::numeric_limits<double>::quiet_NaN()).read(lines, line);
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/formats/grid/esri.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/grid/heights.h"

namespace sparsha::pipeline {
namespace {

constexpr std::array<std::string_view, 12> kKeys = {"ncols",     "nrows",        "xllcorner", "xllcenter",
                                                    "yllcorner", "yllcenter",    "cellsize",  "dx",
                                                    "dy",        "nodata_value", "xllcentre", "yllcentre"};
constexpr const char* kExpected =
    "ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, NODATA_value";

struct Entry {
  double value = 0.0;
  int line = 0;
};

std::optional<std::size_t> key_of(std::string_view word) {
  std::string key = lower_case(word);
  while (!key.empty() && (key.back() == ':' || key.back() == '=')) key.pop_back();
  if (key == "nodata") key = "nodata_value";
  for (std::size_t k = 0; k < kKeys.size(); ++k) {
    if (kKeys[k] == key) return k;
  }
  return std::nullopt;
}

class Header {
 public:
  explicit Header(const ScanFile& file) : file_(file) {}

  /// Reads up to the first line of values, which is left in `line`.
  void read(LineReader& lines, std::string_view& line) {
    bool comma = false, point = false;
    while (lines.next(line)) {
      std::string_view rest = line;
      for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
        const auto key = key_of(word);
        double number = 0.0;
        const bool numeric = word.find_first_of("+-.0123456789") == 0;
        if (!key && (numeric || grid::parse_value(word, number, comma, point))) return;
        if (!key)
          throw file_.error_at(lines.number(), "unknown key " + in_quotes(word) + " of an ESRI grid", kExpected);
        if (entries_[*key]) throw file_.error_at(lines.number(), in_quotes(word) + " is there twice", "each key once");
        std::string_view value = take_word(rest);
        if (value == "=" || value == ":") value = take_word(rest);
        if (!grid::parse_value(value, number, comma, point)) {
          throw file_.error_at(lines.number(), in_quotes(value) + " is no value of " + in_quotes(word), "a number");
        }
        entries_[*key] = Entry{number, lines.number()};
        last_line_ = lines.number();
      }
    }
    line = {};
  }

  [[nodiscard]] const std::optional<Entry>& find(std::string_view key) const { return entries_[*key_of(key)]; }
  [[nodiscard]] int last_line() const { return last_line_; }

  [[nodiscard]] std::uint64_t count(std::string_view key) const {
    const std::optional<Entry>& entry = find(key);
    if (!entry) throw file_.error_at(last_line_, "the header of the grid has no " + in_quotes(key), kExpected);
    if (!(entry->value >= 1.0 && entry->value < 4294967296.0) || entry->value != std::floor(entry->value)) {
      throw file_.error_at(entry->line, fmt::format("{} is {:g}", key, entry->value), "a whole number from 1");
    }
    return static_cast<std::uint64_t>(entry->value);
  }

  [[nodiscard]] double cell(std::string_view key) const {
    const std::optional<Entry>& own = find(key);
    const std::optional<Entry>& entry = own ? own : find("cellsize");
    if (!entry) throw file_.error_at(last_line_, "the header of the grid has no 'cellsize'", kExpected);
    if (!(entry->value > 0.0) || !std::isfinite(entry->value)) {
      throw file_.error_at(entry->line, fmt::format("a cell of {:g}", entry->value), "a size above zero");
    }
    return entry->value;
  }

  /// Where the centre of the first cell lies along an axis, which the header gives itself or by the cell's corner.
  double first(char axis, double cell, std::vector<std::string>& warnings) const {
    const std::string name = fmt::format("{}ll", axis);
    const std::optional<Entry>& corner = find(name + "corner");
    const std::optional<Entry>& centre = find(name + "center") ? find(name + "center") : find(name + "centre");
    if (corner && centre) {
      throw file_.error_at(centre->line, fmt::format("both {}corner and {}center", name, name), "one of them");
    }
    if (!corner && !centre) {
      warnings.push_back(fmt::format("the header of the grid has no {}corner; 0 is taken", name));
      return 0.5 * cell;
    }
    const double place = corner ? corner->value + 0.5 * cell : centre->value;
    if (!std::isfinite(place))
      throw file_.error_at((corner ? corner : centre)->line, "a corner that is not finite", "a number");
    return place;
  }

 private:
  const ScanFile& file_;
  std::array<std::optional<Entry>, kKeys.size()> entries_{};
  int last_line_ = 1;
};

}  // namespace

bool is_esri_grid(const ScanFile& file) {
  LineReader lines(file.bytes.substr(0, 4096));
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view word = take_word(line);
    if (word.empty()) continue;
    const auto key = key_of(word);
    double number = 0.0;
    bool comma = false, point = false;
    std::string_view value = take_word(line);
    if (value == "=" || value == ":") value = take_word(line);
    // A name of a column may be "dx", but no number follows it.
    return key && grid::parse_value(value, number, comma, point);
  }
  return false;
}

void read_esri_grid(const ScanFile& file, ScanWriter& out) {
  LineReader lines(file.bytes);
  std::string_view line;
  Header header(file);
  header.read(lines, line);
  RawScan& scan = out.scan();
  scan.format = "ESRI ASCII grid";
  scan.fields = {"x", "y", "z"};
  grid::Raster raster;
  raster.columns = header.count("ncols");
  raster.rows = header.count("nrows");
  raster.dx = header.cell("dx");
  raster.dy = header.cell("dy");
  raster.x = header.first('x', raster.dx, scan.warnings);
  // The first row is the northernmost.
  raster.y = header.first('y', raster.dy, scan.warnings) + raster.dy * static_cast<double>(raster.rows - 1);
  raster.dy = -raster.dy;
  grid::require_plausible(file, header.last_line(), raster, file.bytes.size() - lines.offset() + line.size() + 1);
  constexpr double kCustomary = -9999.0;
  const auto& no_data = header.find("nodata_value");
  grid::HeightReader heights(file, out, raster, no_data ? no_data->value : kCustomary);
  heights.read(lines, line);
  if (!no_data && heights.no_data_count() > 0) {
    scan.warnings.push_back(
        fmt::format("the header of the grid has no NODATA_value; {} values of {:g} are taken as unknown",
                    heights.no_data_count(), kCustomary));
  }
}

}  // namespace sparsha::pipeline

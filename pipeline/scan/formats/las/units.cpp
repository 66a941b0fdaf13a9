// Length units of LAS files: GeoTIFF keys (OGC 19-008r4) and WKT.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/las/epsg.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/units.h"

namespace sparsha::pipeline::las {
namespace {

/// Whether two units are not one. The two feet differ by 2e-6 of their length; WKT gives at least seven digits.
bool differ(double a_m, double b_m) { return std::fabs(a_m / b_m - 1.0) > 5e-7; }

std::optional<scene::LengthUnit> unit_of_metres(double metres) {
  for (const scene::LengthUnit unit : {scene::LengthUnit::m, scene::LengthUnit::cm, scene::LengthUnit::mm,
                                       scene::LengthUnit::ft, scene::LengthUnit::us_ft}) {
    if (!differ(metres, scene::metres_in(unit))) return unit;
  }
  return std::nullopt;
}

/// Of one way to say the reference; metres in one unit, 0 where it says nothing.
struct Found {
  bool geographic = false;
  double horizontal_m = 0.0;
  double vertical_m = 0.0;
  int projection = 0;  ///< EPSG code, where it has one
  int heights = 0;     ///< EPSG code of a system of heights whose unit is not known here
  bool down = false;   ///< heights are depths
  std::vector<std::string> warnings;

  [[nodiscard]] bool tells() const { return geographic || horizontal_m > 0.0; }
  [[nodiscard]] double heights_m() const { return vertical_m > 0.0 ? vertical_m : horizontal_m; }
};

/// What the codes of heights and of a projection that has some say, beside the unit that may be there.
void read_heights(int heights, int projection, Found& found) {
  constexpr int kOwnSystem = 32767;
  if (heights == 0 && is_with_heights(projection)) heights = projection;
  if (heights == 0 || heights == kOwnSystem) return;
  found.down = counts_down(heights);
  const double metres = metres_of_heights(heights);
  if (found.vertical_m > 0.0) {
    if (metres > 0.0 && differ(metres, found.vertical_m)) {
      found.warnings.push_back(fmt::format(
          "its key 4099 says heights in units of {:.9g} m, EPSG {} has units of {:.9g} m; the former is taken",
          found.vertical_m, heights, metres));
    }
  } else if (metres > 0.0) {
    found.vertical_m = metres;
  } else {
    found.heights = heights;
  }
}

Found from_geo_keys(const Header& header, const Record& keys) {
  std::map<int, int> values;
  std::map<int, std::string_view> texts;
  std::map<int, double> numbers;
  std::string_view text, doubles;
  for (const Record& record : header.records) {
    if (record.is_reference(kGeoText)) text = record.data;
    if (record.is_reference(kGeoNumbers)) doubles = record.data;
  }
  for (std::size_t at = 8; at + 8 <= keys.data.size(); at += 8) {
    const char* const p = keys.data.data() + at;
    const int key = load<std::uint16_t>(p);
    const int place = load<std::uint16_t>(p + 2);
    const std::size_t count = load<std::uint16_t>(p + 4);
    const std::size_t value = load<std::uint16_t>(p + 6);
    if (place == 0) values[key] = static_cast<int>(value);
    if (place == kGeoNumbers && 8 * (value + 1) <= doubles.size())
      numbers[key] = load<double>(doubles.data() + 8 * value);
    if (place == kGeoText && value < text.size()) texts[key] = text.substr(value, count);
  }
  Found found;
  const auto value_of = [&](int key) { return values.count(key) != 0 ? values[key] : 0; };
  constexpr int kModelType = 1024;
  constexpr int kProjectedType = 3072;
  constexpr int kGeneralCitation = 1026;
  constexpr int kCitation = 3073;
  constexpr int kLinearUnits = 3076;
  constexpr int kLinearUnitSize = 3077;
  constexpr int kOwnUnit = 32767;
  constexpr int kVerticalType = 4096;
  constexpr int kVerticalUnits = 4099;
  found.geographic = value_of(kModelType) == 2;
  found.horizontal_m = metres_of_unit(value_of(kLinearUnits));
  found.vertical_m = metres_of_unit(value_of(kVerticalUnits));
  const int projection = value_of(kProjectedType);
  const double size_m = numbers[kLinearUnitSize];
  if (value_of(kLinearUnits) == kOwnUnit && size_m > 0.0 && std::isfinite(size_m)) found.horizontal_m = size_m;
  if (found.horizontal_m == 0.0 && value_of(kLinearUnits) == 0) {
    const std::string citation = lower_case(fmt::format("{} {}", texts[kCitation], texts[kGeneralCitation]));
    if (citation.find("ftus") != std::string::npos || citation.find("us survey f") != std::string::npos) {
      found.horizontal_m = scene::metres_in(scene::LengthUnit::us_ft);
    } else if (const double metres = metres_of_projection(projection); metres > 0.0) {
      found.horizontal_m = metres;
    } else if (value_of(kModelType) == 3) {
      found.horizontal_m = 1.0;
    }
  }
  found.projection = projection;
  read_heights(value_of(kVerticalType), projection, found);
  return found;
}

/// What WKT says, and GeoTIFF keys: the first record of each that tells something.
Found from_wkt(const Header& header) {
  for (const Record& record : header.records) {
    if (!record.is_reference(kWkt)) continue;
    const WktUnits wkt = parse_wkt_units(record.data);
    Found found{wkt.geographic, wkt.horizontal_m, wkt.vertical_m, 0, 0, wkt.down, {}};
    if (found.tells()) return found;
  }
  return {};
}

Found from_keys(const Header& header) {
  for (const Record& record : header.records) {
    if (record.is_reference(kGeoKeys)) return from_geo_keys(header, record);
  }
  return {};
}

std::string words_of(const Found& found) {
  if (found.geographic) return "degrees";
  if (found.down) return fmt::format("units of {:.9g} m and depths of {:.9g} m", found.horizontal_m, found.heights_m());
  if (!differ(found.horizontal_m, found.heights_m())) return fmt::format("units of {:.9g} m", found.horizontal_m);
  return fmt::format("units of {:.9g} m and heights of {:.9g} m", found.horizontal_m, found.heights_m());
}

/// Where both WKT and GeoTIFF keys tell units, the header says which of them holds.
Found chosen(const Header& header) {
  Found wkt = from_wkt(header), keys = from_keys(header);
  if (!wkt.tells()) return keys;
  if (!keys.tells()) return wkt;
  const bool same =
      wkt.geographic == keys.geographic && wkt.down == keys.down &&
      (wkt.geographic || (!differ(wkt.horizontal_m, keys.horizontal_m) && !differ(wkt.heights_m(), keys.heights_m())));
  Found found = header.says_wkt ? wkt : keys;
  if (!same) {
    found.warnings.push_back(
        fmt::format("its WKT says {}, its GeoTIFF keys {}; its header says that {}, so {} are taken", words_of(wkt),
                    words_of(keys), header.says_wkt ? "WKT holds" : "the keys hold", words_of(found)));
  }
  return found;
}

void set_lengths(const Found& found, Units& units) {
  if (found.horizontal_m == 0.0) {
    if (found.vertical_m > 0.0 && (found.vertical_m != 1.0 || found.projection != 0)) {
      units.warnings.push_back(fmt::format(
          "its heights are said to be in units of {:.9g} m, but no unit of x and y is; all three are taken as one unit",
          found.vertical_m));
    }
    return;
  }
  units.unit = unit_of_metres(found.horizontal_m);
  if (!units.unit) {
    units.warnings.push_back(fmt::format("its unit of {} m has no name here; set 'units'", found.horizontal_m));
  } else if (found.vertical_m > 0.0 && differ(found.vertical_m, found.horizontal_m)) {
    units.z_factor = found.vertical_m / found.horizontal_m;
    units.warnings.push_back(
        fmt::format("heights have another unit than x and y; they are multiplied by {:.9g}", units.z_factor));
  } else if (found.heights != 0 && found.horizontal_m != 1.0) {
    units.warnings.push_back(
        fmt::format("its heights are those of EPSG {}, whose unit is not known here; they are taken in the unit of x "
                    "and y, {:.9g} m",
                    found.heights, found.horizontal_m));
  }
}

/// Depths count downwards, heights upwards: as they are, they would show the object upside down and mirrored.
void set_upwards(const Header& header, Units& units) {
  if (header.box_side > 0.0 && header.box_high[2] <= 0.0) {
    units.warnings.push_back(
        "its reference says that z is a depth, which counts downwards, but none is above zero: they are taken for "
        "heights as they are");
    return;
  }
  units.z_factor = -units.z_factor;
  units.warnings.push_back(
      "its reference says that z is a depth, which counts downwards: z is multiplied by -1, so that up is up");
}

}  // namespace

Units find_units(const Header& header) {
  Units units;
  const Found found = chosen(header);
  units.warnings = found.warnings;
  if (found.geographic) {
    units.degrees = true;
    return units;
  }
  set_lengths(found, units);
  if (found.down) set_upwards(header, units);
  return units;
}

}  // namespace sparsha::pipeline::las

// Length units of LAS files: GeoTIFF keys (OGC 19-008r4) and WKT.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/text.h"
#include "pipeline/scan/units.h"

namespace sparsha::pipeline::las {
namespace {

constexpr std::uint16_t kGeoKeys = 34735;
constexpr std::uint16_t kGeoNumbers = 34736;
constexpr std::uint16_t kGeoText = 34737;
constexpr std::uint16_t kWkt = 2112;

/// EPSG codes of length units to metres; 0 for others.
double metres_of_epsg(int code) {
  switch (code) {
    case 9001:
      return 1.0;
    case 9002:
      return 0.3048;
    case 9003:
      return 1200.0 / 3937.0;
    case 1025:
      return 0.001;
    case 1033:
      return 0.01;
    default:
      return 0.0;
  }
}

/// Whether an EPSG code names a projection in metres: national grids and the zones of UTM.
bool is_in_metres(int projection) {
  struct Codes {
    int first, last;
  };
  static constexpr std::array<Codes, 33> kCodes{
      {{2056, 2056},   {2154, 2154},   {2157, 2157},   {2180, 2180},   {2193, 2193},   {3003, 3004},   {3006, 3018},
       {3034, 3035},   {3067, 3067},   {3395, 3395},   {3763, 3763},   {3812, 3812},   {3857, 3857},   {3942, 3950},
       {4647, 4647},   {5221, 5221},   {5513, 5514},   {5972, 5976},   {6328, 6348},   {6870, 6870},   {7415, 7415},
       {7846, 7859},   {21781, 21781}, {23028, 23038}, {25828, 25838}, {26701, 26722}, {26901, 26923}, {27700, 27700},
       {28348, 28358}, {28992, 28992}, {31254, 31287}, {31370, 31370}, {31466, 31469}}};
  if (projection > 32600 && projection <= 32760) return true;
  return std::any_of(kCodes.begin(), kCodes.end(),
                     [&](const Codes& codes) { return projection >= codes.first && projection <= codes.last; });
}

std::optional<scene::LengthUnit> unit_of_metres(double metres) {
  for (const scene::LengthUnit unit : {scene::LengthUnit::m, scene::LengthUnit::cm, scene::LengthUnit::mm,
                                       scene::LengthUnit::ft, scene::LengthUnit::us_ft}) {
    // The two feet differ by 2e-6 of their length; WKT gives at least eight digits.
    if (std::fabs(metres / scene::metres_in(unit) - 1.0) < 5e-7) return unit;
  }
  return std::nullopt;
}

struct Found {
  bool geographic = false;
  double horizontal_m = 0.0;
  double vertical_m = 0.0;
};

Found from_geo_keys(const Header& header, const Record& keys) {
  std::map<int, int> values;
  std::map<int, std::string_view> texts;
  std::map<int, double> numbers;
  std::string_view text, doubles;
  for (const Record& record : header.records) {
    if (record.id == kGeoText) text = record.data;
    if (record.id == kGeoNumbers) doubles = record.data;
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
  constexpr int kVerticalUnits = 4099;
  found.geographic = value_of(kModelType) == 2;
  found.horizontal_m = metres_of_epsg(value_of(kLinearUnits));
  found.vertical_m = metres_of_epsg(value_of(kVerticalUnits));
  const int projection = value_of(kProjectedType);
  const double size_m = numbers[kLinearUnitSize];
  if (value_of(kLinearUnits) == kOwnUnit && size_m > 0.0 && std::isfinite(size_m)) found.horizontal_m = size_m;
  if (found.horizontal_m == 0.0 && value_of(kLinearUnits) == 0) {
    const std::string citation = lower_case(fmt::format("{} {}", texts[kCitation], texts[kGeneralCitation]));
    if (citation.find("ftus") != std::string::npos || citation.find("us survey f") != std::string::npos) {
      found.horizontal_m = scene::metres_in(scene::LengthUnit::us_ft);
    } else if (is_in_metres(projection) || value_of(kModelType) == 3) {
      found.horizontal_m = 1.0;
    }
  }
  return found;
}

}  // namespace

Units find_units(const Header& header) {
  Units units;
  Found found;
  bool told = false;
  for (const Record& record : header.records) {
    if (record.id == kWkt && !told) {
      const WktUnits wkt = parse_wkt_units(record.data);
      found = {wkt.geographic, wkt.horizontal_m, wkt.vertical_m};
      told = wkt.geographic || wkt.horizontal_m > 0.0;
    }
  }
  for (const Record& record : header.records) {
    if (record.id == kGeoKeys && record.user == "LASF_Projection" && !told) {
      found = from_geo_keys(header, record);
      told = true;
    }
  }
  if (found.geographic) {
    units.degrees = true;
    return units;
  }
  if (found.horizontal_m == 0.0) {
    if (found.vertical_m > 0.0 && found.vertical_m != 1.0) {
      units.warnings.push_back(fmt::format(
          "its heights are said to be in units of {:.9g} m, but no unit of x and y is; all three are taken as one unit",
          found.vertical_m));
    }
    return units;
  }
  units.unit = unit_of_metres(found.horizontal_m);
  if (!units.unit) {
    units.warnings.push_back(fmt::format("its unit of {} m has no name here; set 'units'", found.horizontal_m));
  } else if (found.vertical_m > 0.0 && std::fabs(found.vertical_m / found.horizontal_m - 1.0) > 1e-9) {
    units.z_factor = found.vertical_m / found.horizontal_m;
    units.warnings.push_back(
        fmt::format("heights have another unit than x and y; they are multiplied by {:.9g}", units.z_factor));
  }
  return units;
}

}  // namespace sparsha::pipeline::las

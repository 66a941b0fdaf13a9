#include "base/text/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace sparsha {
namespace {

constexpr std::string_view kNarrowSpace = "\u202F";

/// The unit of lengths below `limit_m`.
struct Unit {
  double limit_m;
  double per_m;
  std::string_view plain;
  std::string_view symbol;
  int digits;
};

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr Unit kWritten[] = {{1e-4, 1e6, "um", "\u00B5m", 3},
                             {0.1, 1e3, "mm", "mm", 3},
                             {2.0, 1e2, "cm", "cm", 3},
                             {1e3, 1.0, "m", "m", 3},
                             {kEndless, 1e-3, "km", "km", 4}};
// Nobody says "0.035 metres".
constexpr Unit kSpoken[] = {
    {0.01, 1e3, "millimetres", "", 2}, {1.0, 1e2, "centimetres", "", 2}, {kEndless, 1.0, "metres", "", 3}};

const Unit& unit_of(double size_m, std::span<const Unit> units) {
  constexpr double kZero = 0.001;  // a length of nothing has no unit of its own
  const double size = size_m > 0.0 ? size_m : kZero;
  return *std::find_if(units.begin(), units.end() - 1, [size](const Unit& unit) { return size < unit.limit_m; });
}

}  // namespace

std::string value_text(double value, int digits, TextStyle style) {
  if (!std::isfinite(value)) return "unknown";
  if (value == 0.0) return "0";
  const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value))));
  std::string text = fmt::format("{:.{}f}", value, std::clamp(digits - 1 - magnitude, 0, 9));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  if (style == TextStyle::typeset && text.front() == '-') text.replace(0, 1, "\u2212");
  return text;
}

std::string exact_text(double value) { return fmt::format("{}", value); }

std::string length_text(double metres, TextStyle style) {
  if (!std::isfinite(metres)) return "unknown";
  const bool spoken = style == TextStyle::spoken;
  const Unit& unit = spoken ? unit_of(std::abs(metres), kSpoken) : unit_of(std::abs(metres), kWritten);
  const std::string value = value_text(metres * unit.per_m, unit.digits, style);
  if (style == TextStyle::typeset) return fmt::format("{}{}{}", value, kNarrowSpace, unit.symbol);
  return fmt::format("{} {}", value, style == TextStyle::screen ? unit.symbol : unit.plain);
}

double round_number(double limit) {
  if (!(limit > 0.0) || !std::isfinite(limit)) return 0.0;
  const double power = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= limit * (1.0 + 1e-12)) return step * power;
  }
  return power;
}

std::string count_text(std::uint64_t count, TextStyle style) {
  const std::string_view space = style == TextStyle::typeset ? kNarrowSpace : std::string_view(" ");
  std::string digits = std::to_string(count);
  for (auto place = static_cast<std::ptrdiff_t>(digits.size()) - 3; place > 0; place -= 3) {
    digits.insert(static_cast<std::size_t>(place), space);
  }
  return digits;
}

}  // namespace sparsha

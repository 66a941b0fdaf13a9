// Plain SVG; text in it is real text, so that it scales and can be read aloud.
#include "pipeline/report/svg.h"
#include "base/text/html.h"
#include "base/text/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace sparsha::pipeline {
namespace {

constexpr int kRampStops = 24;

/// A value with three significant digits and no exponent for what appears in legends.
std::string ramp_legend(const Picture& picture) {
  std::string stops;
  for (int k = 0; k <= kRampStops; ++k) {
    const double t = static_cast<double>(k) / kRampStops;
    stops += fmt::format("<stop offset='{:.4f}' stop-color='{}'/>", t, css(colour_at(picture.map, t)));
  }
  // Ticks stand at round values; the ends are named when values beyond them are shown in the ends' colours.
  const double step = round_number((picture.high - picture.low) / 3);
  std::string ticks;
  for (double k = std::ceil(picture.low / step - 1e-9); k * step <= picture.high * (1 + 1e-9) && step > 0; k += 1) {
    const double x = 10 + 300 * (k * step - picture.low) / (picture.high - picture.low);
    ticks += fmt::format("<line x1='{0:.1f}' x2='{0:.1f}' y1='22' y2='28'/><text x='{0:.1f}' y='42'>{1}</text>", x,
                         value_text(k * step, 3, TextStyle::typeset));
  }
  return fmt::format(
      "<svg class='legend' viewBox='0 0 320 64' role='img' aria-label='Legend: colours from {} to {} {}{}'>"
      "<defs><linearGradient id='ramp-{}'>{}</linearGradient></defs>"
      "<rect x='10' y='6' width='300' height='16' fill='url(#ramp-{})' class='frame'/>{}<text x='160' "
      "y='60'>{}{}</text></svg>",
      value_text(picture.low, 3, TextStyle::typeset), value_text(picture.high, 3, TextStyle::typeset),
      picture.unit.empty() ? "" : escape_html(picture.unit),
      picture.clipped ? "; values beyond share the end colours" : "", picture.name, stops, picture.name, ticks,
      picture.unit.empty() ? "coefficient of friction" : escape_html(picture.unit), "");
}

std::string states_legend() {
  const auto entry = [](int x, const std::string& fill, const char* label) {
    return fmt::format(
        "<rect x='{}' y='8' width='22' height='16' fill='{}' class='frame'/><text x='{}' y='21' "
        "class='start'>{}</text>",
        x, fill, x + 30, label);
  };
  return fmt::format(
      "<svg class='legend' viewBox='0 0 320 34' role='img' aria-label='Legend: measured is dark blue, filled is "
      "orange, unknown is striped grey'><defs><pattern id='hatch' width='8' height='8' patternUnits='userSpaceOnUse' "
      "patternTransform='rotate(45)'><rect width='8' height='8' fill='{}'/><rect width='4' height='8' "
      "fill='{}'/></pattern>"
      "</defs>{}{}{}</svg>",
      css(kHatchLight), css(kHatchDark), entry(4, css(kMeasuredColour), "measured"),
      entry(120, css(kFilledColour), "filled"), entry(212, "url(#hatch)", "unknown"));
}

std::string entries_legend(const Picture& picture) {
  constexpr int kRow = 26;
  std::string rows;
  std::string label = "Legend:";
  int y = 8;
  for (const Picture::Entry& entry : picture.entries) {
    rows += fmt::format(
        "<rect x='4' y='{}' width='22' height='16' fill='{}' class='frame'/><text x='34' y='{}' "
        "class='start'>{}</text>",
        y, css(entry.colour), y + 13, escape_html(entry.label));
    label += (label.back() == ':' ? " " : ", ") + entry.label;
    y += kRow;
  }
  return fmt::format("<svg class='legend' viewBox='0 0 320 {}' role='img' aria-label='{}'>{}</svg>", y + 2,
                     escape_html(label), rows);
}

}  // namespace

std::string legend_svg(const Picture& picture) {
  if (picture.legend == Picture::Legend::states) return states_legend();
  if (picture.legend == Picture::Legend::entries) return entries_legend(picture);
  return picture.legend == Picture::Legend::ramp && picture.high > picture.low ? ramp_legend(picture) : std::string();
}

std::string scale_bar_html(double picture_width_m) {
  const double length = round_number(picture_width_m * 0.3);
  if (!(length > 0)) return {};
  return fmt::format("<div class='bar' style='width:{:.3f}%'><span>{}</span></div>", 100 * length / picture_width_m,
                     length_text(length, TextStyle::typeset));
}

std::string histogram_svg(const std::vector<std::uint64_t>& counts, double bin_m,
                          const std::vector<HistogramMark>& marks, const std::string& alternative) {
  const std::uint64_t most = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  if (most == 0 || !(bin_m > 0)) return {};
  constexpr double kLeft = 12, kWidth = 456, kTop = 34, kHeight = 150, kBase = kTop + kHeight;
  const double extent = bin_m * static_cast<double>(counts.size());
  std::string bars;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double width = kWidth / static_cast<double>(counts.size());
    const double tall = kHeight * static_cast<double>(counts[k]) / static_cast<double>(most);
    bars += fmt::format("<rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{:.2f}'/>",
                        kLeft + width * static_cast<double>(k) + 0.5, kBase - tall, width - 1, tall);
  }
  std::string axis = fmt::format("<line x1='{0}' x2='{1}' y1='{2}' y2='{2}'/>", kLeft, kLeft + kWidth, kBase);
  const double step = round_number(extent / 4);
  constexpr double kRoom = 24;  // half of a label, which must not leave the picture
  for (double k = 0; k * step <= extent; k += 1) {
    const double x = kLeft + kWidth * k * step / extent;
    axis += fmt::format("<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}'/>", x, kBase, kBase + 5);
    if (x > kLeft + kWidth - kRoom) continue;
    axis += fmt::format("<text x='{:.1f}' y='{}'{}>{}</text>", k == 0 ? kLeft : x, kBase + 20,
                        k == 0 ? " class='start'" : "", k == 0 ? "0" : length_text(k * step, TextStyle::typeset));
  }
  std::string lines;
  double label_y = 12;
  for (const HistogramMark& mark : marks) {
    if (!(mark.value_m <= extent)) continue;
    const double x = kLeft + kWidth * mark.value_m / extent;
    lines += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}'/><text x='{0:.1f}' y='{3}' dx='4' "
        "class='start'>{4}</text>",
        x, label_y - 8, kBase, label_y, escape_html(mark.label));
    label_y += 14;
  }
  return fmt::format(
      "<svg class='histogram' viewBox='0 0 480 214' role='img' aria-label='{}'><g class='bars'>{}</g>"
      "<g class='axis'>{}</g><g class='marks'>{}</g></svg>",
      escape_html(alternative), bars, axis, lines);
}

}  // namespace sparsha::pipeline

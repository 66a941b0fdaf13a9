#include "bench/haptics/lines.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "bench/report/figure_text.h"

namespace sparsha::bench {
namespace {

constexpr double kWidth = 760.0;
constexpr double kPanel = 250.0;  // height of one panel, its axis included
constexpr double kTop = 60.0;
constexpr double kLeft = 80.0;
constexpr double kRight = 20.0;
constexpr double kAxis = 45.0;  // below a panel's frame

struct Range {
  double low;
  double high;
  double from;
  double to;
  [[nodiscard]] double at(double value) const { return from + (to - from) * (value - low) / (high - low); }
};

std::string number(double value) { return text_of("%.1f", value); }

/// 1, 2 or 5 times a power of ten, some five steps to the range.
double step_of(double low, double high) {
  const double raw = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10.0 * power;
}

Range y_range(const Panel& panel, double from, double to) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Curve& curve : panel.curves)
    for (std::size_t k = 0; k < curve.x.size(); ++k)
      if (curve.x[k] >= panel.x_from && curve.x[k] <= panel.x_to)
        low = std::min(low, curve.y[k]), high = std::max(high, curve.y[k]);
  if (!(high > low)) low -= 1.0, high += 1.0;
  const double margin = 0.06 * (high - low);
  return {low - margin, high + margin, from, to};
}

void draw_grid(std::ofstream& svg, const Range& x, const Range& y) {
  const auto ticks = [](const Range& range, const auto& draw) {
    const double step = step_of(range.low, range.high);
    for (double k = std::ceil(range.low / step - 1e-9); k * step <= range.high + 1e-9 * step; ++k) draw(k * step);
  };
  const auto text = [](double value) { return text_of("%g", std::abs(value) < 1e-12 ? 0.0 : value); };
  ticks(x, [&](double value) {
    const std::string at = number(x.at(value));
    svg << "<path d=\"M" << at << ' ' << number(y.to) << 'V' << number(y.from) << "\" stroke=\"#ddd\"/><text x=\"" << at
        << "\" y=\"" << number(y.from + 18) << "\" text-anchor=\"middle\">" << text(value) << "</text>\n";
  });
  ticks(y, [&](double value) {
    const std::string at = number(y.at(value));
    svg << "<path d=\"M" << number(x.from) << ' ' << at << 'H' << number(x.to) << "\" stroke=\"#ddd\"/><text x=\""
        << number(x.from - 8) << "\" y=\"" << number(y.at(value) + 5) << "\" text-anchor=\"end\">" << text(value)
        << "</text>\n";
  });
}

/// Points within a pixel of the one before say nothing.
void draw_curve(std::ofstream& svg, const Curve& curve, const Range& x, const Range& y) {
  svg << "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"" << curve.colour << '"';
  if (!curve.dashes.empty()) svg << " stroke-dasharray=\"" << curve.dashes << '"';
  svg << " points=\"";
  double last_x = -1e9;
  double last_y = -1e9;
  for (std::size_t k = 0; k < curve.x.size(); ++k) {
    if (curve.x[k] < x.low || curve.x[k] > x.high) continue;
    const double px = x.at(curve.x[k]);
    const double py = y.at(curve.y[k]);
    if (std::hypot(px - last_x, py - last_y) < 1.0) continue;
    svg << number(px) << ',' << number(py) << ' ';
    last_x = px;
    last_y = py;
  }
  svg << "\"/>\n";
}

struct LegendPlace {
  double at = 0.0;
  double down = 0.0;  ///< below the first line
};

/// One place per curve; what would end beyond the drawing begins a new line.
std::vector<LegendPlace> legend_of(const std::vector<Curve>& curves) {
  constexpr double kLetter = 7.2, kDash = 32.0, kBetween = 28.0, kLine = 20.0;
  std::vector<LegendPlace> places;
  LegendPlace next{kLeft, 0.0};
  for (const Curve& curve : curves) {
    const double width = kDash + kLetter * static_cast<double>(curve.name.size());
    if (next.at > kLeft && next.at + width > kWidth) next = {kLeft, next.down + kLine};
    places.push_back(next);
    next.at += width + kBetween;
  }
  return places;
}

}  // namespace

bool write_lines(const std::filesystem::path& file, const std::string& title, const std::string& x_label,
                 const std::vector<Panel>& panels) {
  if (panels.empty()) return false;
  const std::vector<LegendPlace> legend = legend_of(panels.front().curves);
  const double first = kTop + (legend.empty() ? 0.0 : legend.back().down);
  const double height = first + kPanel * static_cast<double>(panels.size());
  std::ofstream svg(file);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << ' ' << height
      << "\" font-family=\"sans-serif\" font-size=\"14\" role=\"img\">\n<title>" << title
      << "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"" << kLeft
      << "\" y=\"22\" font-weight=\"bold\">" << title << "</text>\n";
  for (std::size_t k = 0; k < legend.size(); ++k) {
    const Curve& curve = panels.front().curves[k];
    svg << "<path d=\"M" << number(legend[k].at) << ' ' << number(42.0 + legend[k].down)
        << "h26\" stroke-width=\"2.5\" stroke=\"" << curve.colour << '"';
    if (!curve.dashes.empty()) svg << " stroke-dasharray=\"" << curve.dashes << '"';
    svg << "/><text x=\"" << number(legend[k].at + 32) << "\" y=\"" << number(47.0 + legend[k].down) << "\">"
        << curve.name << "</text>\n";
  }
  double top = first;
  for (const Panel& panel : panels) {
    const Range x{panel.x_from, panel.x_to, kLeft, kWidth - kRight};
    const Range y = y_range(panel, top + kPanel - kAxis, top);
    if (panel.mark_to > panel.mark_from)
      svg << "<rect x=\"" << number(x.at(panel.mark_from)) << "\" y=\"" << number(y.to) << "\" width=\""
          << number(x.at(panel.mark_to) - x.at(panel.mark_from)) << "\" height=\"" << number(y.from - y.to)
          << "\" fill=\"#f0e8c8\"/>\n";
    draw_grid(svg, x, y);
    for (const Curve& curve : panel.curves) draw_curve(svg, curve, x, y);
    svg << "<text transform=\"translate(20 " << number(0.5 * (y.from + y.to))
        << ") rotate(-90)\" text-anchor=\"middle\">" << panel.y_label << "</text>\n";
    top += kPanel;
  }
  svg << "<text x=\"" << number(0.5 * (kLeft + kWidth - kRight)) << "\" y=\"" << number(height - 6)
      << "\" text-anchor=\"middle\">" << x_label << "</text>\n</svg>\n";
  return static_cast<bool>(svg.flush());
}

}  // namespace sparsha::bench

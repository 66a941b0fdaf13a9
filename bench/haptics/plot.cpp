#include "bench/haptics/plot.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

namespace sparsha::bench {
namespace {

constexpr double kWidth = 760.0;
constexpr double kHeight = 520.0;
constexpr double kMargin = 70.0;
constexpr double kLegend = 130.0;

struct Axis {
  int low;  ///< decades
  int high;
  double from;
  double to;
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * (std::log10(value) - low) / std::max(1, high - low);
  }
};

struct Style {
  const char* method;
  const char* colour;
  char shape;  ///< square, diamond, circle, up and down triangle, cross, plus, hollow square or hollow circle
};

/// Colour-blind-safe (Okabe & Ito), and a shape for each method.
constexpr Style kStyles[] = {{"exact", "#0072B2", 's'}, {"rounded", "#CC79A7", 's'},    {"c1", "#009E73", 'd'},
                             {"paper", "#D55E00", 'c'}, {"god-object", "#000000", 'u'}, {"sphere", "#E69F00", 'o'},
                             {"mls", "#56B4E9", 'v'},   {"implicit", "#D55E00", 'x'},   {"box", "#000000", 'h'},
                             {"voxel", "#009E73", '+'}, {"embree", "#56B4E9", 'h'}};

const Style& style_of(const std::string& method) {
  static constexpr Style kOther{"", "#000000", 'c'};
  const auto* found =
      std::find_if(std::begin(kStyles), std::end(kStyles), [&](const Style& s) { return method == s.method; });
  return found == std::end(kStyles) ? kOther : *found;
}

void draw_mark(std::ofstream& svg, const Style& style, double x, double y) {
  svg << "<g transform=\"translate(" << x << ' ' << y << ")\" fill=\"" << style.colour << "\" stroke=\"" << style.colour
      << "\">";
  switch (style.shape) {
    case 's':
      svg << "<path d=\"M-5-5h10v10h-10z\"/>";
      break;
    case 'd':
      svg << "<path d=\"M0-6l6 6-6 6-6-6z\"/>";
      break;
    case 'u':
      svg << "<path d=\"M0-6l6 11h-12z\"/>";
      break;
    case 'v':
      svg << "<path d=\"M0 6l6-11h-12z\"/>";
      break;
    case 'x':
      svg << "<path d=\"M-5-5l10 10M-5 5l10-10\" stroke-width=\"2.5\"/>";
      break;
    case '+':
      svg << "<path d=\"M-6 0h12M0-6v12\" stroke-width=\"2.5\"/>";
      break;
    case 'h':
      svg << "<path d=\"M-5-5h10v10h-10z\" fill=\"none\" stroke-width=\"2\"/>";
      break;
    case 'o':
      svg << "<circle r=\"5\" fill=\"none\" stroke-width=\"2.5\"/>";
      break;
    default:
      svg << "<circle r=\"5\"/>";
  }
  svg << "</g>\n";
}

void draw_grid(std::ofstream& svg, const Axis& x, const Axis& y) {
  for (int d = x.low; d <= x.high; ++d) {
    const double at = x.at(std::pow(10.0, d));
    svg << "<line x1=\"" << at << "\" x2=\"" << at << "\" y1=\"" << y.to << "\" y2=\"" << y.from
        << "\" stroke=\"#ddd\"/><text x=\"" << at << "\" y=\"" << y.from + 20 << "\" text-anchor=\"middle\">1e" << d
        << "</text>\n";
  }
  for (int d = y.low; d <= y.high; ++d) {
    const double at = y.at(std::pow(10.0, d));
    svg << "<line x1=\"" << x.from << "\" x2=\"" << x.to << "\" y1=\"" << at << "\" y2=\"" << at
        << "\" stroke=\"#ddd\"/><text x=\"" << x.from - 8 << "\" y=\"" << at + 5 << "\" text-anchor=\"end\">1e" << d
        << "</text>\n";
  }
}

void draw_marks(std::ofstream& svg, const Axis& x, const Axis& y, const PlotMarks& marks) {
  if (marks.felt_to > marks.felt_from && marks.felt_from > 0.0)
    svg << "<rect x=\"" << x.from << "\" width=\"" << x.to - x.from << "\" y=\"" << y.at(marks.felt_to)
        << "\" height=\"" << y.at(marks.felt_from) - y.at(marks.felt_to) << "\" fill=\"#f0e8c8\"/><text x=\""
        << x.from + 6 << "\" y=\"" << y.at(marks.felt_to) - 4 << "\">touch begins to feel it ("
        << 100.0 * marks.felt_from << " to " << 100.0 * marks.felt_to << " %)</text>\n";
  if (marks.budget_ns > 0.0)
    svg << "<line x1=\"" << x.at(marks.budget_ns) << "\" x2=\"" << x.at(marks.budget_ns) << "\" y1=\"" << y.to
        << "\" y2=\"" << y.from << "\" stroke=\"#444\" stroke-width=\"2\" stroke-dasharray=\"6 4\"/><text x=\""
        << x.at(marks.budget_ns) - 6 << "\" y=\"" << y.from - 8 << "\" text-anchor=\"end\">budget of 1 ms</text>\n";
}

}  // namespace

std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points) {
  std::sort(points.begin(), points.end(),
            [](const PlotPoint& a, const PlotPoint& b) { return a.ns != b.ns ? a.ns < b.ns : a.error < b.error; });
  std::vector<PlotPoint> front;
  for (const PlotPoint& p : points)
    if (front.empty() || p.error < front.back().error) front.push_back(p);
  return front;
}

bool write_plot(const std::filesystem::path& file, const std::vector<PlotPoint>& points, const PlotMarks& marks) {
  if (points.empty()) return false;
  const auto decades = [&](double PlotPoint::*value, double least, double from, double to) {
    double low = 1e300;
    double high = least;
    for (const PlotPoint& p : points) low = std::min(low, p.*value), high = std::max(high, p.*value);
    return Axis{static_cast<int>(std::floor(std::log10(low))), static_cast<int>(std::ceil(std::log10(high))), from, to};
  };
  const Axis x = decades(&PlotPoint::ns, marks.budget_ns, kMargin, kWidth - kLegend);
  const Axis y = decades(&PlotPoint::error, marks.felt_to, kHeight - kMargin, 20.0);
  std::ofstream svg(file);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << ' ' << kHeight
      << "\" font-family=\"sans-serif\" font-size=\"14\" role=\"img\">\n<title>" << marks.title
      << "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  draw_grid(svg, x, y);
  draw_marks(svg, x, y, marks);
  svg << "<text x=\"" << 0.5 * (x.from + x.to) << "\" y=\"" << kHeight - 20
      << "\" text-anchor=\"middle\">time of an update, ns</text>\n<text transform=\"translate(20 " << kHeight / 2
      << ") rotate(-90)\" text-anchor=\"middle\">" << marks.y_label << "</text>\n";
  if (marks.front) {
    svg << "<polyline fill=\"none\" stroke=\"#888\" stroke-width=\"2\" points=\"";
    for (const PlotPoint& p : pareto_front(points)) svg << x.at(p.ns) << ',' << y.at(p.error) << ' ';
    svg << "\"/>\n<path d=\"M" << kWidth - kLegend + 8 << " 27h20\" stroke=\"#888\" stroke-width=\"2\"/><text x=\""
        << kWidth - kLegend + 32 << "\" y=\"32\">Pareto front</text>\n";
  }
  std::set<std::string> methods;
  for (const PlotPoint& p : points) {
    draw_mark(svg, style_of(p.method), x.at(p.ns), y.at(p.error));
    methods.insert(p.method);
  }
  double row = 56.0;
  for (const Style& style : kStyles) {
    if (methods.count(style.method) == 0) continue;
    draw_mark(svg, style, kWidth - kLegend + 18, row - 5);
    svg << "<text x=\"" << kWidth - kLegend + 32 << "\" y=\"" << row << "\">" << style.method << "</text>\n";
    row += 22.0;
  }
  svg << "</svg>\n";
  return static_cast<bool>(svg.flush());
}

}  // namespace sparsha::bench

#include "plot.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

namespace sparsha::bench {
namespace {

constexpr double kWidth = 720.0;
constexpr double kHeight = 480.0;
constexpr double kMargin = 70.0;

struct Axis {
  int low;  ///< decades
  int high;
  double from;
  double to;
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * (std::log10(value) - low) / std::max(1, high - low);
  }
};

}  // namespace

bool write_plot(const std::filesystem::path& file, const std::vector<PlotPoint>& points) {
  if (points.empty()) return false;
  const auto decades = [&](double PlotPoint::*value, double from, double to) {
    double low = 1e300;
    double high = 0.0;
    for (const PlotPoint& p : points) low = std::min(low, p.*value), high = std::max(high, p.*value);
    return Axis{static_cast<int>(std::floor(std::log10(low))), static_cast<int>(std::ceil(std::log10(high))), from, to};
  };
  const Axis x = decades(&PlotPoint::ns, kMargin, kWidth - 20.0);
  const Axis y = decades(&PlotPoint::error, kHeight - kMargin, 20.0);
  // Colour-blind-safe (Okabe & Ito), and a shape for each method.
  const std::map<std::string, std::string> colours = {
      {"exact", "#0072B2"}, {"rounded", "#CC79A7"}, {"c1", "#009E73"}, {"paper", "#D55E00"}};
  std::ofstream svg(file);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << ' ' << kHeight
      << "\" font-family=\"sans-serif\" font-size=\"14\" role=\"img\">\n<title>Time of a proxy update against the "
         "force's "
         "mean relative error</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
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
  svg << "<text x=\"" << kWidth / 2 << "\" y=\"" << kHeight - 20
      << "\" text-anchor=\"middle\">time of an update, ns</text>\n<text transform=\"translate(20 " << kHeight / 2
      << ") rotate(-90)\" text-anchor=\"middle\">mean relative force error</text>\n";
  const auto mark = [&svg](const std::string& method, const std::string& colour, double px, double py) {
    if (method == "paper")
      svg << "<circle cx=\"" << px << "\" cy=\"" << py << "\" r=\"5\" fill=\"" << colour << "\"/>\n";
    else
      svg << "<rect x=\"" << px - 5 << "\" y=\"" << py - 5 << "\" width=\"10\" height=\"10\" fill=\"" << colour << "\""
          << (method == "c1" ? " transform=\"rotate(45 " + std::to_string(px) + ' ' + std::to_string(py) + ")\"" : "")
          << "/>\n";
  };
  for (const PlotPoint& p : points) {
    const auto found = colours.find(p.method);
    const std::string colour = found == colours.end() ? "#000" : found->second;
    mark(p.method, colour, x.at(p.ns), y.at(p.error));
  }
  double row = 40.0;
  for (const auto& [name, colour] : colours) {
    mark(name, colour, kWidth - 114, row - 5);
    svg << "<text x=\"" << kWidth - 100 << "\" y=\"" << row << "\">" << name << "</text>\n";
    row += 22.0;
  }
  svg << "</svg>\n";
  return static_cast<bool>(svg.flush());
}

}  // namespace sparsha::bench

// Skeletons in units of the cap height, drawn for this project after the proportions of Roman capitals.
#include "pipeline/simulate/glyphs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

/// `path`: M x y begins a stroke, L x y goes on straight, Q cx cy x y along a parabola.
struct Glyph {
  char letter;
  double width;
  const char* path;
};

constexpr std::array<Glyph, 26> kGlyphs{{
    {'A', 0.80, "M 0 0 L 0.40 1 L 0.80 0 M 0.15 0.37 L 0.65 0.37"},
    {'B', 0.56,
     "M 0 0 L 0 1 L 0.26 1 Q 0.50 1 0.50 0.77 Q 0.50 0.54 0.26 0.54 L 0 0.54 M 0.26 0.54 Q 0.56 0.54 0.56 "
     "0.27 Q 0.56 0 0.26 0 L 0 0"},
    {'C', 0.78, "M 0.76 0.86 Q 0.64 1 0.46 1 Q 0 1 0 0.5 Q 0 0 0.46 0 Q 0.64 0 0.76 0.14"},
    {'D', 0.76, "M 0 0 L 0 1 L 0.26 1 Q 0.76 1 0.76 0.5 Q 0.76 0 0.26 0 L 0 0"},
    {'E', 0.48, "M 0.48 1 L 0 1 L 0 0 L 0.48 0 M 0 0.52 L 0.40 0.52"},
    {'F', 0.48, "M 0.48 1 L 0 1 L 0 0 M 0 0.52 L 0.40 0.52"},
    {'G', 0.80, "M 0.76 0.86 Q 0.64 1 0.46 1 Q 0 1 0 0.5 Q 0 0 0.46 0 Q 0.68 0 0.78 0.12 L 0.78 0.46"},
    {'H', 0.70, "M 0 0 L 0 1 M 0.70 0 L 0.70 1 M 0 0.52 L 0.70 0.52"},
    {'I', 0.00, "M 0 0 L 0 1"},
    {'J', 0.26, "M 0.26 1 L 0.26 0.12 Q 0.26 -0.12 0 -0.12"},
    {'K', 0.62, "M 0 0 L 0 1 M 0.56 1 L 0 0.48 M 0.12 0.59 L 0.62 0"},
    {'L', 0.48, "M 0 1 L 0 0 L 0.48 0"},
    {'M', 0.92, "M 0 0 L 0.12 1 L 0.46 0.18 L 0.80 1 L 0.92 0"},
    {'N', 0.74, "M 0 0 L 0 1 L 0.74 0 L 0.74 1"},
    {'O', 0.92, "M 0.46 1 Q 0 1 0 0.5 Q 0 0 0.46 0 Q 0.92 0 0.92 0.5 Q 0.92 1 0.46 1"},
    {'P', 0.54, "M 0 0 L 0 1 L 0.25 1 Q 0.54 1 0.54 0.74 Q 0.54 0.47 0.25 0.47 L 0 0.47"},
    {'Q', 0.96, "M 0.46 1 Q 0 1 0 0.5 Q 0 0 0.46 0 Q 0.92 0 0.92 0.5 Q 0.92 1 0.46 1 M 0.54 0.18 L 0.96 -0.14"},
    {'R', 0.62, "M 0 0 L 0 1 L 0.25 1 Q 0.53 1 0.53 0.75 Q 0.53 0.50 0.25 0.50 L 0 0.50 M 0.25 0.50 L 0.62 0"},
    {'S', 0.52,
     "M 0.49 0.88 Q 0.40 1 0.27 1 Q 0.04 1 0.04 0.77 Q 0.04 0.60 0.27 0.52 Q 0.52 0.43 0.52 0.25 Q 0.52 0 "
     "0.25 0 Q 0.10 0 0 0.13"},
    {'T', 0.72, "M 0 1 L 0.72 1 M 0.36 1 L 0.36 0"},
    {'U', 0.70, "M 0 1 L 0 0.34 Q 0 0 0.35 0 Q 0.70 0 0.70 0.34 L 0.70 1"},
    {'V', 0.78, "M 0 1 L 0.39 0 L 0.78 1"},
    {'W', 1.16, "M 0 1 L 0.29 0 L 0.58 0.90 L 0.87 0 L 1.16 1"},
    {'X', 0.68, "M 0 0 L 0.68 1 M 0 1 L 0.68 0"},
    {'Y', 0.70, "M 0 1 L 0.35 0.48 L 0.70 1 M 0.35 0.48 L 0.35 0"},
    {'Z', 0.66, "M 0 1 L 0.66 1 L 0 0 L 0.66 0"},
}};

constexpr double kHalfWidth = 0.068;  // of a stroke's middle
constexpr double kFlare = 0.018;      // wider at a free end, where the chisel turns
constexpr double kFlareLength = 0.22;
constexpr double kGap = 0.27;  // between letters
constexpr double kBlank = 0.55;
constexpr int kPiecesPerCurve = 8;

struct Point {
  double x, y;
};

/// The strokes of a path as runs of points.
std::vector<std::vector<Point>> runs_of(const char* path) {
  std::vector<std::vector<Point>> runs;
  std::istringstream words(path);
  char command = 0;
  while (words >> command) {
    Point p{};
    if (command == 'Q') {
      Point control{};
      words >> control.x >> control.y >> p.x >> p.y;
      const Point from = runs.back().back();
      for (int k = 1; k <= kPiecesPerCurve; ++k) {
        const double t = static_cast<double>(k) / kPiecesPerCurve;
        const double a = (1.0 - t) * (1.0 - t), b = 2.0 * t * (1.0 - t), c = t * t;
        runs.back().push_back({a * from.x + b * control.x + c * p.x, a * from.y + b * control.y + c * p.y});
      }
      continue;
    }
    words >> p.x >> p.y;
    if (command == 'M') runs.emplace_back();
    runs.back().push_back(p);
  }
  return runs;
}

double distance(const Point& a, const Point& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

/// Cuts long straight pieces, so that the flare at their ends has pieces of its own.
std::vector<Point> with_flare_points(const std::vector<Point>& run) {
  std::vector<Point> points{run.front()};
  for (std::size_t k = 1; k < run.size(); ++k) {
    const double length = distance(run[k - 1], run[k]);
    if (length > 2.0 * kFlareLength) {
      for (const double share : {kFlareLength / length, 1.0 - kFlareLength / length}) {
        points.push_back(
            {run[k - 1].x + share * (run[k].x - run[k - 1].x), run[k - 1].y + share * (run[k].y - run[k - 1].y)});
      }
    }
    points.push_back(run[k]);
  }
  return points;
}

Lettering::Letter cut_letter(const Glyph& glyph, double x, double y, double cap) {
  Lettering::Letter letter{1e300, 1e300, -1e300, -1e300, {}};
  for (const auto& run : runs_of(glyph.path)) {
    const std::vector<Point> points = with_flare_points(run);
    double total = 0.0;
    for (std::size_t k = 1; k < points.size(); ++k) total += distance(points[k - 1], points[k]);
    const auto half = [&](double along) {
      const double from_end = std::min(along, total - along);
      return cap * (kHalfWidth + kFlare * std::max(0.0, 1.0 - from_end / kFlareLength));
    };
    double along = 0.0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double next = along + distance(points[k - 1], points[k]);
      const Stroke stroke{x + cap * points[k - 1].x,
                          y + cap * points[k - 1].y,
                          x + cap * points[k].x,
                          y + cap * points[k].y,
                          half(along),
                          half(next)};
      along = next;
      letter.strokes.push_back(stroke);
      const double reach = std::max(stroke.half0, stroke.half1);
      letter.x0 = std::min({letter.x0, stroke.x0 - reach, stroke.x1 - reach});
      letter.x1 = std::max({letter.x1, stroke.x0 + reach, stroke.x1 + reach});
      letter.y0 = std::min({letter.y0, stroke.y0 - reach, stroke.y1 - reach});
      letter.y1 = std::max({letter.y1, stroke.y0 + reach, stroke.y1 + reach});
    }
  }
  return letter;
}

}  // namespace

double Lettering::depth(double x, double y) const {
  double depth = 0.0;
  for (const Letter& letter : letters) {
    if (x < letter.x0 || x > letter.x1 || y < letter.y0 || y > letter.y1) continue;
    for (const Stroke& s : letter.strokes) {
      const double ux = s.x1 - s.x0, uy = s.y1 - s.y0;
      const double vx = x - s.x0, vy = y - s.y0;
      const double t = std::clamp((vx * ux + vy * uy) / (ux * ux + uy * uy), 0.0, 1.0);
      const double dx = vx - t * ux, dy = vy - t * uy;
      depth = std::max(depth, s.half0 + t * (s.half1 - s.half0) - std::sqrt(dx * dx + dy * dy));
    }
  }
  return depth;
}

Lettering set_letters(const std::string& text, double x0, double y0, double x1, double y1) {
  std::vector<const Glyph*> glyphs;  // null: a blank
  double width = 0.0;
  for (const char c : text) {
    const auto glyph = std::find_if(kGlyphs.begin(), kGlyphs.end(), [&](const Glyph& g) { return g.letter == c; });
    if (glyph == kGlyphs.end() && c != ' ') {
      throw usage_error("the inscription has a character that cannot be cut", "expected A to Z and blanks");
    }
    glyphs.push_back(c == ' ' ? nullptr : &*glyph);
    width += c == ' ' ? kBlank : glyph->width + kGap;
  }
  Lettering lettering;
  if (glyphs.empty()) return lettering;
  width -= kGap;
  const double cap = std::min(y1 - y0, (x1 - x0) / std::max(width, 0.1));
  double x = 0.5 * (x0 + x1) - 0.5 * width * cap;
  const double y = 0.5 * (y0 + y1) - 0.5 * cap;
  for (const Glyph* glyph : glyphs) {
    if (glyph == nullptr) {
      x += kBlank * cap;
      continue;
    }
    lettering.letters.push_back(cut_letter(*glyph, x, y, cap));
    x += (glyph->width + kGap) * cap;
  }
  return lettering;
}

}  // namespace sparsha::pipeline

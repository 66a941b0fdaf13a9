// Capital letters as strokes, and the V-shaped cut that a chisel leaves along them.
#pragma once

#include <string>
#include <vector>

namespace sparsha::pipeline {

/// A straight piece of a stroke with the half width of the cut at its ends, metres.
struct Stroke {
  double x0, y0, x1, y1;
  double half0, half1;
};

/// One line of text, laid out.
struct Lettering {
  struct Letter {
    double x0, y0, x1, y1;  ///< box of the cut
    std::vector<Stroke> strokes;
  };
  std::vector<Letter> letters;

  /// Distance to the rim of the cut, inside the cut; 0 outside: the depth of a V of 45 degrees.
  [[nodiscard]] double depth(double x, double y) const;
};

/// Centres `text` (A to Z and blanks) in the box, as large as fits. Throws Error{usage} for other characters.
[[nodiscard]] Lettering set_letters(const std::string& text, double x0, double y0, double x1, double y1);

}  // namespace sparsha::pipeline

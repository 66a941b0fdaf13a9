// The view and the spacing of a first configuration: such that its surface passes its own cross-check.
#pragma once

#include <string>

#include "base/threads/progress.h"
#include "pipeline/suggest/inner_box.h"
#include "pipeline/suggest/trial.h"
#include "pipeline/suggest/view.h"

namespace sparsha::pipeline {

struct Choice {
  Trial trial;             ///< the one that was chosen; of the guess where none passes
  double spacing_m = 0.0;  ///< for all points, of which trials may have had a sample
  std::string spacing_reason;
  bool exact_spacing = false;  ///< the scan's own: all of its digits count
  bool no_surface = false;     ///< from any side
  std::string rejected;        ///< the guess and what was wrong with it, when another view was chosen
  bool open = false;           ///< another side may as well be the front
};

/// A spacing as the configuration gives it: in millimetres, of three digits.
[[nodiscard]] std::string written_mm(double spacing_m);

/// Tries the likeliest view first, then coarser grids where the points' form tells that view, then the other views,
/// then coarser grids for all. Takes the points.
[[nodiscard]] Choice find_view_and_spacing(TrialCloud& points, const Sides& sides, const InnerBox& box,
                                           Progress& progress);

}  // namespace sparsha::pipeline

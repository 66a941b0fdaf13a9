#include "pipeline/register/lost_scan.h"

#include <fmt/format.h>

#include "base/text/text.h"

namespace sparsha::pipeline {

Error refusal_of(const LostScan& lost) {
  const AlignedPair& pair = lost.pair;
  const bool held = pair.fit.use == PairFit::Use::weak || pair.fit.use == PairFit::Use::rejected;
  if (pair.fit.use == PairFit::Use::weak && !pair.unsure)
    return input_error(lost.name,
                       "what this scan and " + lost.other +
                           " have in common can slide (a plane, a cylinder or a sphere), so its pose is not determined",
                       "scans that share corners, edges or carving, or a part of another scan that holds both");
  if (pair.fit.use == PairFit::Use::rejected && lost.too_far_m)
    return input_error(lost.name,
                       fmt::format("aligning this scan with {} moves it by {}, farther than a rough pose may be wrong",
                                   lost.other, length_text(*lost.too_far_m)),
                       "poses within 10 degrees and 5 % of the object's size" + lost.hint);
  if (held)
    return input_error(
        lost.name,
        pair.fit.use == PairFit::Use::weak ? "this scan holds nearly as well in more than one place on " + lost.other
                                           : "where this scan lies best on " + lost.other +
                                                 ", too little of what could tell its place agrees within the noise",
        "denser points, scans from places between the two, or rough poses nearer to the truth" + lost.hint);
  if (!pair.candidate)
    return input_error(
        lost.name,
        fmt::format("with the poses as given, {:.1f} % of its points have their place within {} on another scan (most "
                    "on {})",
                    100.0 * pair.fit.before.overlap, length_text(lost.reach_m), lost.other),
        fmt::format("at least {:.3g} %: better poses or a larger register.max_distance_mm", 100.0 * lost.min_overlap) +
            lost.hint);
  return input_error(
      lost.name,
      fmt::format("{:.1f} % of its points have their place on {}, the scan with which it has most in common",
                  100.0 * pair.agreement.overlap, lost.other),
      fmt::format("at least {:.3g} % and {} of the thinned points: more overlap, better poses or a smaller "
                  "register.min_overlap",
                  100.0 * lost.min_overlap, kLeastMatches) +
          lost.hint);
}

}  // namespace sparsha::pipeline

// How time grows: seconds = a count^exponent, fitted by least squares in the logarithms.
#pragma once

#include <cstddef>
#include <vector>

namespace sparsha::bench {

struct Exponent {
  double value = 0.0;
  double error = 0.0;  ///< half width of the 95 % interval (Student's t of the fit's residuals); 0 for two counts
  std::size_t counts = 0;
};

/// Of the pairs whose seconds are at least `floor_s`, because shorter ones are start-up and the clock. `counts` is
/// below 2 where nothing can be fitted. Requires equal sizes and positive counts.
[[nodiscard]] Exponent fit_exponent(const std::vector<double>& counts, const std::vector<double>& seconds,
                                    double floor_s);

}  // namespace sparsha::bench

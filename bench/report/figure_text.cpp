#include "bench/report/figure_text.h"

#include <cmath>
#include <cstdio>

namespace sparsha::bench {

std::string text_of(const char* format, double value) {
  char line[64];
  std::snprintf(line, sizeof line, format, value);
  return line;
}

std::string field_of(const char* format, double value) { return std::isnan(value) ? "" : text_of(format, value); }

std::string time_text(double ns) {
  if (ns < 1e3) return text_of("%.0f ns", ns);
  return ns < 1e6 ? text_of("%.2f µs", 1e-3 * ns) : text_of("%.2f ms", 1e-6 * ns);
}

std::string share_text(double share) { return text_of("%.3g %%", 100.0 * share); }

}  // namespace sparsha::bench

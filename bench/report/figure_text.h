// Figures as the benchmarks' tables, drawings and CSV files have them.
#pragma once

#include <string>

namespace sparsha::bench {

/// A value in printf's format, e.g. "%.3g"; shorter than 64 characters.
[[nodiscard]] std::string text_of(const char* format, double value);
/// The same for a CSV file: empty where the value is not a number.
[[nodiscard]] std::string field_of(const char* format, double value);
/// Nanoseconds as "89 ns", "1.25 µs" or "2.10 ms".
[[nodiscard]] std::string time_text(double ns);
/// 0.031 as "3.1 %".
[[nodiscard]] std::string share_text(double share);

}  // namespace sparsha::bench

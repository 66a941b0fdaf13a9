// The line of a terminal that tells how far a step is; never wider than the terminal, where it could not be drawn anew.
#pragma once

#include <string>

namespace sparsha::app {

/// "read         [####......]  40 %, 3 s left" for a terminal of so many columns. Where there is no room, first the
/// time is left out, then the bar, of 5 to 30 characters, then the end of the stage's name.
[[nodiscard]] std::string progress_line(const std::string& stage, double fraction, double left_s, int columns);
/// "read ..." for the same.
[[nodiscard]] std::string stage_line(const std::string& stage, int columns);

}  // namespace sparsha::app

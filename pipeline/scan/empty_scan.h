// A scan file without a point, told apart from one that cannot be read: beside other scans it is left out.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "base/error.h"

namespace sparsha::pipeline {

/// Thrown by readers of a sound file, or one of no bytes, in which there is no point. Error{input}.
class EmptyScan : public Error {
 public:
  EmptyScan(std::string file, std::string wrong, std::string expected)
      : Error(ErrorKind::input, {std::move(file), 0, 0}, std::move(wrong), std::move(expected)) {}
};

/// Of a scan whose points all stand at 0 0 0.
[[nodiscard]] inline EmptyScan all_empty_returns(std::string file, std::uint64_t points) {
  return {std::move(file),
          "all of its " + std::to_string(points) +
              " points stand at 0 0 0, which depth cameras write where they saw nothing",
          "a scan with at least one point elsewhere"};
}

/// What is said of an empty scan that is left out of several.
[[nodiscard]] inline std::string left_out_warning(const EmptyScan& empty) {
  return empty.place().file + ": " + empty.wrong() + "; the scan is left out";
}

}  // namespace sparsha::pipeline

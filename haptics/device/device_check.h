// What `sparsha device check` tells.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace sparsha::haptics {

struct CheckStep {
  enum class Result { passed, failed, skipped };
  std::string name;  ///< USB, permission, power, ...
  Result result = Result::skipped;
  std::string detail;  ///< what was found
  std::string remedy;  ///< what to do, when it failed
};

/// How well questions are answered.
struct LinkQuality {
  std::uint64_t asked = 0;
  std::uint64_t answered = 0;                       ///< within 4 ms
  double rate_hz = 0.0;                             ///< answers a second
  double p50_ms = 0.0, p99_ms = 0.0, max_ms = 0.0;  ///< from question to answer
  bool unplugged = false;                           ///< while it was measured
  [[nodiscard]] double share() const {
    return asked == 0 ? 0.0 : static_cast<double>(answered) / static_cast<double>(asked);
  }
};

/// What such a link is worth for touch. Marginal: it can be touched with, softer or less calmly than it could be.
struct LinkVerdict {
  enum class Grade { good, marginal, insufficient };
  Grade grade = Grade::insufficient;
  std::string reason;  ///< what keeps it from being good
  std::string remedy;
};
[[nodiscard]] inline const char* name_of(LinkVerdict::Grade grade) {
  static constexpr const char* kNames[] = {"good", "marginal", "insufficient"};
  return kNames[static_cast<std::size_t>(grade)];
}

struct CheckReport {
  std::vector<CheckStep> steps;  ///< in order; those after a failed one that they need are skipped
  LinkQuality link;
  LinkVerdict verdict;  ///< of the link; means nothing where that was skipped
  [[nodiscard]] bool passed() const {
    return std::ranges::none_of(steps, [](const CheckStep& step) { return step.result == CheckStep::Result::failed; });
  }
};

}  // namespace sparsha::haptics

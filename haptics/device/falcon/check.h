// What `sparsha device check|monitor|home` do: each step of starting a Falcon with its remedy, live readings,
// homing.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/link.h"

namespace sparsha::haptics::falcon {

struct CheckStep {
  enum class Result { passed, failed, skipped };
  std::string name;  ///< USB, permission, power, firmware, homing, link
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
[[nodiscard]] LinkVerdict judge(const LinkQuality& link);
[[nodiscard]] const char* name_of(LinkVerdict::Grade grade);

struct CheckReport {
  std::vector<CheckStep> steps;  ///< in order; those after a failed one that they need are skipped
  LinkQuality link;
  LinkVerdict verdict;  ///< of the link; means nothing where that was skipped
  [[nodiscard]] bool passed() const;
};

/// Walks all steps on the first Falcon on USB. Forces stay zero. Never throws for what is wrong with the device; throws
/// Cancelled when options.stop ends the loading of firmware. Ended while the link is measured, it judges what it has.
[[nodiscard]] CheckReport check_falcon(const FalconOptions& options = {}, double link_s = 10.0);
/// The steps from power on, over any wire. `link_s`: how long the link is measured.
[[nodiscard]] CheckReport check_wire(Transport& wire, const FalconOptions& options, double link_s = 1.0);

/// One answer, understood.
struct Reading {
  double time_s = 0.0;  ///< since the first question
  double round_trip_s = 0.0;
  Answer answer;
  bool homed = false;
  bool reachable = false;  ///< position_m is that of the counts (true only when homed does it mean anything)
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< Falcon frame
};

/// Asks with zero force until `each` returns false. Throws Error{device} when unplugged or silent for a second.
void monitor(Transport& wire, const std::function<bool(const Reading&)>& each);

/// Asks for homing, red light, until all three encoders are homed (then green) or `timeout_s` is over; true when homed.
/// `each` may show the way (homing_advice()), and ends it by false.
[[nodiscard]] bool home(Transport& wire, double timeout_s, const std::function<bool(const Reading&)>& each = {});

}  // namespace sparsha::haptics::falcon

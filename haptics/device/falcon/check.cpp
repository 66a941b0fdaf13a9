// The check's steps.
#include "haptics/device/falcon/check.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "haptics/device/falcon/usb_transport.h"

namespace sparsha::haptics::falcon {
namespace {

using Steady = std::chrono::steady_clock;
using Result = CheckStep::Result;
constexpr double kAnswerTime_s = 0.004;

/// What a link must keep for a grade. A servo of 1 kHz needs an answer almost every millisecond; with half of them and
/// a few milliseconds of delay the governor halves the stiffness.
struct Limits {
  double rate_hz, share, p99_ms;
};
constexpr Limits kGood{900.0, 0.999, 2.0};
constexpr Limits kMarginal{450.0, 0.99, 4.0};
/// Without its latency timer at 1 ms the bridge waits 16 ms with a short answer.
constexpr double kWaitsForTimer_hz = 100.0;

double since(Steady::time_point then) { return std::chrono::duration<double>(Steady::now() - then).count(); }

/// One question and its answer. `gone` when unplugged.
TransportStatus ask(Transport& wire, AnswerStream& stream, std::uint8_t flags, Answer& answer, double& round_trip_s) {
  const Steady::time_point began = Steady::now();
  TransportStatus status = wire.post(encode({}, flags));
  if (status == TransportStatus::gone) return status;
  UsbPacket bytes{};
  double waited = 0.0;
  while (waited < kAnswerTime_s) {
    std::size_t size = 0;
    status = wire.receive(bytes, size, kAnswerTime_s - waited);
    if (status != TransportStatus::ok) return status;
    round_trip_s = since(began);
    if (size > kModemBytes)
      if (const auto got = stream.feed(std::span(bytes).subspan(kModemBytes, size - kModemBytes))) {
        answer = *got;
        return TransportStatus::ok;
      }
    waited = since(began);
  }
  return TransportStatus::nothing;
}

/// A late answer would be taken for the next question's, and all that follow would seem to come at once.
void forget_late_answers(Transport& wire) {
  constexpr double kQuiet_s = 0.008;
  constexpr int kMostPackets = 64;
  UsbPacket bytes{};
  std::size_t size = 0;
  for (int i = 0; i < kMostPackets && wire.receive(bytes, size, kQuiet_s) == TransportStatus::ok; ++i) {
  }
}

LinkQuality measure(Transport& wire, double seconds, const std::function<bool()>& stop, Answer& last) {
  LinkQuality link;
  AnswerStream stream;
  std::vector<double> times;
  const Steady::time_point began = Steady::now();
  // A wire in virtual time must end too: no more questions than a kilohertz has.
  const auto most = static_cast<std::uint64_t>(2000.0 * seconds) + 1;
  while (since(began) < seconds && link.asked < most && !(stop && stop())) {
    double round_trip = 0.0;
    ++link.asked;
    const TransportStatus status = ask(wire, stream, kHomingRequest | kLightRed, last, round_trip);
    link.unplugged = status == TransportStatus::gone;
    if (link.unplugged) break;
    if (status == TransportStatus::ok) {
      ++link.answered;
      times.push_back(round_trip * 1e3);
    } else {
      forget_late_answers(wire);
    }
  }
  link.rate_hz = static_cast<double>(link.answered) / std::max(1e-9, since(began));
  if (times.empty()) return link;
  std::sort(times.begin(), times.end());
  const auto quantile = [&times](double q) {
    return times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))];
  };
  link.p50_ms = quantile(0.5);
  link.p99_ms = quantile(0.99);
  link.max_ms = times.back();
  return link;
}

void skip(CheckReport& report, std::initializer_list<const char*> names) {
  for (const char* name : names) report.steps.push_back({name, Result::skipped, "not reached", ""});
}

}  // namespace

LinkVerdict judge(const LinkQuality& link) {
  using Grade = LinkVerdict::Grade;
  const auto keeps = [&link](const Limits& limits) {
    return link.rate_hz >= limits.rate_hz && link.share() >= limits.share && link.p99_ms <= limits.p99_ms;
  };
  if (link.unplugged)
    return {Grade::insufficient, "unplugged while it was measured",
            "use a cable and a port that hold, and check again"};
  if (keeps(kGood)) return {Grade::good, "", ""};
  LinkVerdict verdict{keeps(kMarginal) ? Grade::marginal : Grade::insufficient, "", ""};
  const std::uint64_t missed = link.asked - link.answered;
  if (link.answered == 0) {
    verdict.reason = "nothing was answered";
    verdict.remedy = "plug in the Falcon's own power supply, then unplug and replug USB";
  } else if (link.share() < kGood.share) {
    verdict.reason =
        fmt::format("{} of {} questions without an answer in {:.0f} ms", missed, link.asked, 1e3 * kAnswerTime_s);
    verdict.remedy = "use a shorter cable and a direct USB port or a hub with its own supply; check the power supply";
  } else if (link.rate_hz < kWaitsForTimer_hz) {
    verdict.reason = fmt::format("{:.0f} answers a second", link.rate_hz);
    verdict.remedy =
        "the bridge still waits for its latency timer: unplug and replug USB, and let no other program use it";
  } else if (link.p99_ms > kGood.p99_ms) {
    verdict.reason = fmt::format("one answer in a hundred takes more than {:.1f} ms", link.p99_ms);
    verdict.remedy = "end other programs and allow real-time priority (docs/use/hardware.md)";
  } else {
    verdict.reason = fmt::format("{:.0f} answers a second", link.rate_hz);
    verdict.remedy = "use a direct USB port without other devices on it, and end other programs";
  }
  return verdict;
}

namespace {

/// The steps power and firmware; false when none runs in the end. What is wrong with an image is no fault of the power.
bool check_firmware(Transport& wire, const FalconOptions& options, CheckReport& report) {
  const auto passed = [&report](const char* power, std::string firmware) {
    report.steps.push_back({"power", Result::passed, power, ""});
    report.steps.push_back({"firmware", Result::passed, std::move(firmware), ""});
    return true;
  };
  const auto no_power = [&report](std::string detail, std::string remedy) {
    report.steps.push_back({"power", Result::failed, std::move(detail), std::move(remedy)});
    skip(report, {"firmware"});
    return false;
  };
  std::string detail = "none runs, and none was given";
  std::string remedy =
      "name an image: --firmware FILE, SPARSHA_FALCON_FIRMWARE or ~/.config/sparsha/falcon.bin; its licence forbids "
      "shipping one";
  try {
    enter_run_mode(wire);
    if (firmware_answers(wire)) {
      lengthen_timer(wire);
      return passed("the firmware answers", "already running");
    }
    try {
      const std::vector<std::uint8_t> image = firmware_image(options);
      if (!image.empty()) {
        bring_up(wire, image, 10, loading(options));
        return passed("the boot loader answers", fmt::format("loaded, {} bytes", image.size()));
      }
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& error) {
      const std::string place = to_string(error.place());
      detail = place.empty() ? error.wrong() : place + ": " + error.wrong();
      remedy = error.expected();
    }
    if (!boot_loader_answers(wire))
      return no_power("neither firmware nor boot loader answers",
                      "plug in the Falcon's own power supply, then unplug and replug USB");
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    return no_power(error.wrong(), error.expected());
  }
  report.steps.push_back({"power", Result::passed, "the boot loader answers", ""});
  report.steps.push_back({"firmware", Result::failed, detail, remedy});
  return false;
}

}  // namespace

CheckReport check_wire(Transport& wire, const FalconOptions& options, double link_s) {
  CheckReport report;
  if (!check_firmware(wire, options, report)) {
    skip(report, {"homing", "link"});
    return report;
  }
  Answer last;
  forget_late_answers(wire);
  report.link = measure(wire, link_s, options.stop, last);
  const bool homed = last.homed == 7;
  if (report.link.unplugged && !homed)
    skip(report, {"homing"});
  else
    report.steps.push_back(
        {"homing", homed ? Result::passed : Result::failed,
         homed ? "all three encoders know their position"
               : fmt::format("encoders homed: {}{}{}", last.homed & 1, (last.homed >> 1U) & 1, last.homed >> 2U),
         homed ? "" : "pull the grip fully out, then push it fully in (sparsha device home)"});
  report.verdict = judge(report.link);
  const bool usable = report.verdict.grade != LinkVerdict::Grade::insufficient;
  std::string detail = fmt::format("{}: {:.0f} answers a second, {:.2f} % in time, p50 {:.2f} ms, p99 {:.2f} ms",
                                   name_of(report.verdict.grade), report.link.rate_hz, 100.0 * report.link.share(),
                                   report.link.p50_ms, report.link.p99_ms);
  if (!report.verdict.reason.empty()) detail += "; " + report.verdict.reason;
  report.steps.push_back({"link", usable ? Result::passed : Result::failed, detail, report.verdict.remedy});
  return report;
}

CheckReport check_falcon(const FalconOptions& options, double link_s) {
  CheckReport report;
  const std::vector<FoundFalcon> found = find_falcons();
  if (found.empty()) {
    report.steps.push_back(
        {"USB", Result::failed, "no Falcon (0403:cb48) is plugged in", "plug it in, directly and not through a hub"});
    skip(report, {"permission", "power", "firmware", "homing", "link"});
    return report;
  }
  report.steps.push_back(
      {"USB", Result::passed, fmt::format("bus {} device {}", found.front().bus, found.front().address), ""});
  std::unique_ptr<Transport> wire;
  try {
    wire = open_usb_transport();
  } catch (const Error& error) {
    report.steps.push_back({"permission", Result::failed, error.wrong(), error.expected()});
    skip(report, {"power", "firmware", "homing", "link"});
    return report;
  }
  // Of two, another program may hold the first.
  const UsbAddress at = wire->address();
  report.steps.back().detail = fmt::format("bus {} device {}", at.bus, at.address);
  if (found.size() > 1) report.steps.back().detail += fmt::format(", one of {}", found.size());
  report.steps.push_back({"permission", Result::passed, "this user may use it", ""});
  CheckReport rest = check_wire(*wire, options, link_s);
  report.steps.insert(report.steps.end(), rest.steps.begin(), rest.steps.end());
  report.link = rest.link;
  report.verdict = rest.verdict;
  return report;
}

}  // namespace sparsha::haptics::falcon

#include "bench/race/hard.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "protocol/course.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

constexpr int kNodes = 201;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kLostShare = 0.01;    // of the ticks
constexpr double kEnergyShare = 0.01;  // of the spring's largest energy, each time round
constexpr double kStepShare = 0.5;     // of the largest force, while the hand moves a tenth of its depth or less

struct HardCase {
  std::string name;
  std::string text;
  std::function<double(double, double)> height;
  std::vector<Vector3d> hands;
  std::size_t first = 0;  ///< ticks judged: from here to the end
  bool closed = false;    ///< the judged ticks are a closed way
  bool slow = false;      ///< the hand moves little, so that the force should too
};

double flat(double, double) { return 0.0; }

/// From 10 mm above the first hand.
void come_down(HardCase& c) {
  std::vector<Vector3d> hands;
  for (int k = 0; k < 100; ++k) {
    const double share = (k + 1) / 100.0;
    const double top = c.height(c.hands[0].x(), c.hands[0].y()) + 0.01;
    hands.emplace_back(c.hands[0].x(), c.hands[0].y(), top + share * (c.hands[0].z() - top));
  }
  c.first = hands.size();
  hands.insert(hands.end(), c.hands.begin(), c.hands.end());
  c.hands = std::move(hands);
}

HardCase rounds(std::string name, std::string text, std::function<double(double, double)> height, double depth,
                double radius) {
  HardCase c{std::move(name), std::move(text), std::move(height), {}, 0, true, true};
  constexpr int kRound = 2000;
  for (int k = 0; k <= 3 * kRound; ++k) {
    const double x = 0.5 + radius * std::cos(kTurn * k / kRound);
    const double y = 0.5 + radius * std::sin(kTurn * k / kRound);
    c.hands.emplace_back(x, y, c.height(x, y) - depth);
  }
  come_down(c);
  return c;
}

HardCase across(std::string name, std::string text, std::function<double(double, double)> height, double z,
                double step) {
  HardCase c{std::move(name), std::move(text), std::move(height), {}, 0, false, false};
  for (double x = 0.3; x <= 0.7; x += step) c.hands.emplace_back(x, 0.47 + 0.1 * x, z);
  come_down(c);
  return c;
}

std::vector<HardCase> all_cases() {
  const auto wave = [](double x, double y) { return 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y); };
  std::vector<HardCase> all;
  HardCase rest{"rest", "the hand at rest for 2000 ticks, 5 mm deep", wave, {}, 0, false, true};
  rest.hands.assign(2000, Vector3d(0.33, 0.61, wave(0.33, 0.61) - 0.005));
  come_down(rest);
  all.push_back(rest);
  all.push_back(rounds("closed way", "three times round a circle under the sinusoid, 5 mm deep", wave, 0.005, 0.2));
  all.push_back(rounds(
      "rough", "the same on unconnected heights of up to half a cell",
      [](double x, double y) {
        const double noise = std::sin(1e4 * x + 2.3e4 * y) * 43758.5453;
        return 0.0025 * (noise - std::floor(noise));
      },
      0.005, 0.2));
  HardCase deep{"deep", "pressed 100 mm into a plane and drawn along it", flat, {}, 0, false, true};
  for (int k = 0; k < 1000; ++k) deep.hands.emplace_back(0.5, 0.5, -0.0001 * k);
  for (int k = 0; k < 1000; ++k) deep.hands.emplace_back(0.5 + 0.0001 * k, 0.5, -0.1);
  come_down(deep);
  all.push_back(deep);
  all.push_back(across(
      "thin wall", "through a wall one node wide and 40 mm high, the hand 10 mm under the floor",
      [](double x, double) { return std::abs(x - 0.5) < 0.0025 ? 0.04 : 0.0; }, -0.01, 0.0005));
  all.push_back(across(
      "cliff", "from a floor into a step of 100 mm over one cell, until the hand is 105 mm deep",
      [](double x, double) { return x > 0.5025 ? 0.1 : 0.0; }, -0.005, 0.0005));
  all.push_back(across(
      "needle", "over a single node 1 m high",
      [](double x, double y) { return std::hypot(x - 0.5, y - 0.52) < 0.0025 ? 1.0 : 0.0; }, -0.005, 0.0005));
  all.push_back(across(
      "sharp groove",
      "across a groove 40 mm deep with walls of 58 degrees, oblique to the grid; up to 45 mm under its shoulders",
      [](double x, double y) { return 0.04 * std::min(1.0, 40.0 * std::abs(0.9 * (x - 0.5) + 0.4 * (y - 0.5))); },
      -0.005, 0.0002));
  HardCase fast{"leap", "half a metre in a tick while in contact, there and back", wave, {}, 0, false, false};
  for (int k = 0; k < 200; ++k) {
    const double x = k % 2 == 0 ? 0.25 : 0.75;
    fast.hands.emplace_back(x, 0.3, wave(x, 0.3) - 0.003);
  }
  come_down(fast);
  all.push_back(fast);
  HardCase blind{
      "not a number", "a hand that is not a number for one tick in contact, then as before", wave, {}, 0, false, false};
  for (int k = 0; k < 200; ++k) blind.hands.emplace_back(0.4, 0.4, wave(0.4, 0.4) - 0.005);
  come_down(blind);
  blind.hands[blind.first] = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  ++blind.first;
  all.push_back(blind);
  HardCase far{"far away", "a kilometre away for one tick, then as before", wave, {}, 0, false, false};
  far.hands.assign(100, Vector3d(0.4, 0.4, wave(0.4, 0.4) - 0.005));
  come_down(far);
  far.hands[far.first] = Vector3d(0.4, 0.4, 1000.0);
  ++far.first;
  all.push_back(far);
  return all;
}

HardResult judge(const HardCase& c, const Entrant& entrant, const haptics::MongeSurface& surface) {
  HardResult result;
  result.hard_case = c.name;
  result.method = entrant.method;
  const PeerPointer peer = entrant.make(surface);
  peer->place(c.hands.front());
  double most = 0.0;
  double work = 0.0;  // of the force on the hand, by trapezes
  int without = 0;
  Vector3d before = Vector3d::Zero();
  std::vector<double> steps;
  for (std::size_t tick = 0; tick < c.hands.size(); ++tick) {
    const Touched touched = peer->update(c.hands[tick]);
    if (!touched.force_m.allFinite() || !touched.proxy.allFinite()) ++result.not_finite;
    const Vector3d force = touched.force_m.allFinite() ? touched.force_m : Vector3d::Zero();
    if (tick >= c.first) {
      const double height = surface.height(c.hands[tick].x(), c.hands[tick].y());
      if (!touched.contact && c.hands[tick].z() < height) ++without;
      most = std::max(most, force.norm());
      if (tick > c.first) {
        work += 0.5 * (force + before).dot(c.hands[tick] - c.hands[tick - 1]);
        steps.push_back((force - before).norm());
      }
    }
    before = force;
  }
  result.lost = static_cast<double>(without) / static_cast<double>(c.hands.size() - c.first);
  if (most > 0.0 && c.slow) result.worst_step = *std::max_element(steps.begin(), steps.end()) / most;
  if (most > 0.0 && c.closed) result.gained = work / (0.5 * most * most) / 3.0;
  const auto fault = [&result](bool found, const char* name) {
    if (found) result.verdict += (result.verdict.empty() ? "" : ", ") + std::string(name);
  };
  fault(result.not_finite > 0, "NaN");
  fault(result.lost > kLostShare, "lost");
  fault(result.gained > kEnergyShare, "energy");
  fault(result.worst_step > kStepShare, "step");
  if (result.verdict.empty()) result.verdict = "pass";
  return result;
}

}  // namespace

std::vector<HardResult> hard_cases(const std::vector<Entrant>& entrants) {
  std::vector<HardResult> results;
  for (const HardCase& c : all_cases()) {
    protocol::Ground ground;
    ground.height = c.height;
    const haptics::MongeSurface surface = sample(ground, kNodes);
    for (const Entrant& entrant : entrants)
      if (entrant.standard) results.push_back(judge(c, entrant, surface));
  }
  return results;
}

std::vector<std::pair<std::string, std::string>> hard_case_texts() {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const HardCase& c : all_cases()) texts.emplace_back(c.name, c.text);
  return texts;
}

}  // namespace sparsha::bench

// Several starts, each refined on the fine surfaces, judged by what meets in every direction.
#include "pipeline/register/pair_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/register/match.h"
#include "pipeline/register/pairwise.h"
#include "pipeline/register/relaxation.h"

namespace sparsha::pipeline {
namespace {

constexpr double kShrink = 0.6;  // of the distance from round to round of an alignment
constexpr int kIterations = 8;   // of PCL in a round
constexpr int kLastIterations = 30;
constexpr double kNearer = 0.2;          // of a start's reach: that of the next start
constexpr double kRough = 3.0;           // roughnesses within which two elements lie on one another
constexpr std::size_t kLookedAt = 8000;  // elements of a scan when poses are judged
// Below this information, a pair is looked at along the motion that is told worst. Scans of a hall have 0.01 to 0.03.
constexpr double kMaySlide = 0.04;
constexpr double kSlide = 0.4;  // reaches to both sides
constexpr int kMostSteps = 40;
constexpr std::size_t kLookedAtSliding = 3000;
constexpr std::size_t kPeaks = 4;
constexpr double kNearlyAsWell = 0.5;  // of the support of the best place

double touch_m(const PosedScan& first, const PosedScan& second, std::unique_ptr<StationSurface> PosedScan::*level) {
  return kTouch * std::max((first.*level)->spacing_m(), (second.*level)->spacing_m());
}

class PairAligner {
 public:
  PairAligner(const PosedScan& first, const PosedScan& second, const PairSearch& search, const Context& context)
      : first_(first), second_(second), search_(search), context_(context) {
    coarse_touch_m_ = touch_m(first, second, &PosedScan::coarse);
    medium_touch_m_ = touch_m(first, second, &PosedScan::medium);
    fine_touch_m_ = touch_m(first, second, &PosedScan::fine);
    near_m_ = kRough * std::hypot(first.fine->roughness_m(), second.fine->roughness_m());
  }

  [[nodiscard]] PairAlignment run(const Eigen::Isometry3d& guess) const {
    std::vector<Judged> candidates;
    for (double reach_m = search_.reach_m;; reach_m *= kNearer) {
      candidates.push_back(judged(refined(approach(guess, reach_m))));
      if (reach_m <= medium_touch_m_) break;
    }
    const PairAlignment best = best_of(candidates);
    if (best.hold.matches > 0 && best.hold.least_information < kMaySlide) {
      for (const Eigen::Isometry3d& start : slid(best)) candidates.push_back(judged(refined(start)));
    }
    return best_of(candidates);
  }

 private:
  struct Judged {
    PairAlignment found;
    double score = -1.0;

    [[nodiscard]] auto rank() const {
      const Hold& hold = found.hold;
      return std::tuple(hold.holds(), hold.holds() ? support(hold) : 0.0, score);
    }
  };

  // The best of several; unsure where another place is told nearly as well.
  [[nodiscard]] PairAlignment best_of(const std::vector<Judged>& candidates) const {
    const Judged& best =
        *std::ranges::max_element(candidates, std::less(), [](const Judged& judged) { return judged.rank(); });
    PairAlignment result = best.found;
    for (const Judged& other : candidates) {
      if (!other.found.hold.holds() || support(other.found.hold) < kNearlyAsWell * support(best.found.hold)) continue;
      const Eigen::Vector3d apart =
          (other.found.second_to_first * second_.middle_m) - (best.found.second_to_first * second_.middle_m);
      if (apart.norm() > fine_touch_m_) result.unsure = true;
    }
    return result;
  }

  // How much tells the motion that is told worst.
  [[nodiscard]] static double support(const Hold& hold) {
    return static_cast<double>(hold.matches) * std::max(0.0, hold.least_information);
  }

  [[nodiscard]] Judged judged(const Eigen::Isometry3d& pose) const {
    const std::vector<Match> met = meeting(pose, kLookedAt);
    return {{pose, hold_of(met, near_m_), false}, score(met, near_m_)};
  }

  // Along the motion that is told worst, the places at which more meets than at the places beside them, best first.
  [[nodiscard]] std::vector<Eigen::Isometry3d> slid(const PairAlignment& found) const {
    const double step_m = 0.5 * fine_touch_m_;
    const int steps = std::min(kMostSteps, static_cast<int>(kSlide * search_.reach_m / step_m));
    std::vector<double> scores;
    for (int k = -steps; k <= steps; ++k) {
      context_.progress.throw_if_cancelled();
      const auto met = meeting(found.hold.moved(k * step_m) * found.second_to_first, kLookedAtSliding);
      scores.push_back(score(met, std::max(near_m_, 0.5 * step_m)));
    }
    std::vector<int> peaks;
    for (int k = 0; k < static_cast<int>(scores.size()); ++k) {
      const auto at = [&](int n) {
        return n < 0 || n >= static_cast<int>(scores.size()) ? -1.0 : scores[static_cast<std::size_t>(n)];
      };
      if (at(k) > at(k - 1) && at(k) >= at(k + 1) && k != steps) peaks.push_back(k);
    }
    std::ranges::stable_sort(peaks, std::greater(), [&](int k) { return scores[static_cast<std::size_t>(k)]; });
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t n = 0; n < std::min(peaks.size(), kPeaks); ++n)
      poses.push_back(found.hold.moved((peaks[n] - steps) * step_m) * found.second_to_first);
    return poses;
  }

  // By PCL on the thinned surfaces, with distances that shrink from `reach_m` on.
  [[nodiscard]] Eigen::Isometry3d approach(Eigen::Isometry3d pose, double reach_m) const {
    for (double distance_m = reach_m; distance_m > medium_touch_m_; distance_m *= kShrink) {
      context_.progress.throw_if_cancelled();
      const bool coarse = distance_m > coarse_touch_m_;
      const StationSurface& source = coarse ? *second_.coarse : *second_.medium;
      const StationSurface& target = coarse ? *first_.coarse : *first_.medium;
      pose = align_pair(source, target, pose, search_.method, distance_m, kIterations, search_.any_sign);
    }
    return align_pair(*second_.medium, *first_.medium, pose, search_.method, std::min(reach_m, medium_touch_m_),
                      kLastIterations, search_.any_sign);
  }

  // On the fine surfaces, which tell in halls and corridors what the thinned ones let slide.
  [[nodiscard]] Eigen::Isometry3d refined(const Eigen::Isometry3d& pose) const {
    std::vector<PosedSurface> surfaces{{first_.fine.get(), Eigen::Isometry3d::Identity()}, {second_.fine.get(), pose}};
    ThreadPool alone(1);  // the caller is one of several threads
    relax_jointly(surfaces, {{0, 1, search_.any_sign}}, medium_touch_m_, fine_touch_m_, {alone, context_.progress});
    return surfaces[1].pose;
  }

  [[nodiscard]] std::vector<Match> meeting(const Eigen::Isometry3d& pose, std::size_t most) const {
    MatchLimits limits;
    limits.distance_m = fine_touch_m_;
    limits.most = most;
    limits.any_sign = search_.any_sign;
    const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
    std::vector<Match> there = match(*second_.fine, pose, *first_.fine, here, limits).pairs;
    const std::vector<Match> back = match(*first_.fine, here, *second_.fine, pose, limits).pairs;
    there.insert(there.end(), back.begin(), back.end());
    return there;
  }

  // How much lies on one another as exactly as the surfaces allow. The square root of each direction's count: of a
  // corridor, floor and walls are most, and only the rest tells how far along it a scan belongs.
  [[nodiscard]] static double score(const std::vector<Match>& met, double near_m) {
    std::array<double, 27> counts{};
    for (const Match& pair : met)
      if (std::fabs(pair.distance_m) <= near_m) counts.at(direction_of(pair.normal())) += 1.0;
    double sum = 0.0;
    for (const double count : counts) sum += std::sqrt(count);
    return sum;
  }

  // One of the 26 directions to the neighbours of a cube.
  [[nodiscard]] static std::size_t direction_of(const Eigen::Vector3d& normal) {
    constexpr double kBetween = 0.38268343236508977;  // sine of 22.5 degrees
    std::size_t index = 0;
    for (int axis = 0; axis < 3; ++axis)
      index = 3 * index + (normal[axis] < -kBetween ? 0U : normal[axis] > kBetween ? 2U : 1U);
    return index;
  }

  const PosedScan& first_;
  const PosedScan& second_;
  const PairSearch& search_;
  const Context& context_;
  double coarse_touch_m_ = 0.0;
  double medium_touch_m_ = 0.0;
  double fine_touch_m_ = 0.0;
  double near_m_ = 0.0;
};

}  // namespace

PairAlignment align_scans(const PosedScan& first, const PosedScan& second, const Eigen::Isometry3d& guess,
                          const PairSearch& search, const Context& context) {
  return PairAligner(first, second, search, context).run(guess);
}

}  // namespace sparsha::pipeline

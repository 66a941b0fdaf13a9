// Features of each scan, guesses of each pair, then scans are placed one by one, the surest first, where all that are
// placed already agree.
#include "pipeline/register/first_guess.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/numbers/hash.h"
#include "pipeline/register/aligned_pair.h"
#include "pipeline/register/features.h"
#include "pipeline/register/finished_pairs.h"
#include "pipeline/register/graph.h"
#include "pipeline/register/line_of_sight.h"
#include "pipeline/register/match.h"
#include "pipeline/register/pairwise.h"
#include "pipeline/register/prerejective.h"

namespace sparsha::pipeline {
namespace {

constexpr double kRadius = 0.10;         // of features, longest sides
constexpr std::size_t kFeatures = 1500;  // a scan
constexpr double kLeastEdge = 0.10;      // of a sample, longest sides
constexpr double kApart = 0.12;          // guesses that differ by less are one, longest sides
constexpr double kSamePlace = 0.02;      // the same after their alignment
constexpr std::size_t kGuesses = 12;     // a pair
constexpr int kSamples = 40000;          // that are drawn for a pair
constexpr std::size_t kAllPairsOf = 8;   // scans, of which all pairs are tried
constexpr std::size_t kPartners = 5;     // of each scan, when there are more
constexpr double kTouch = 1.5;           // medium point distances within which placed surfaces are one
constexpr double kClearance = 2.0;       // medium point distances that tell what stands in the way from what is seen
constexpr double kMostInTheWay = 0.01;   // share of a scan
constexpr double kLeastOverlap =
    0.12;  // share of a scan, of a guess that is accepted where both were made from one place
constexpr double kLeastUnseen = 0.5;  // and where that place is unknown, so that nothing tells what stands in the way
constexpr double kSure = 0.75;        // of the best place's matches: another one that has more makes it unsure
constexpr double kCloser = 1.4;       // times smaller residual that tells a place from others with as many matches
constexpr int kIterations = 10;       // of PCL in a round
constexpr std::size_t kLookedAt = 1500;  // elements of a scan when places are compared

/// A place of one scan on another.
struct Candidate {
  std::size_t first = 0;
  std::size_t second = 0;
  Eigen::Isometry3d second_to_first = Eigen::Isometry3d::Identity();
  double overlap = 0.0;
  bool slides = false;
};

/// A candidate for a scan that is not yet placed, against all that are.
struct Place {
  std::size_t scan = 0;
  std::size_t on = 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double overlap = 0.0;  ///< on that one scan
  bool slides = false;
  double matches = 0.0;     ///< with all placed scans
  double squares_m2 = 0.0;  ///< of their distances, summed
  double in_the_way = 0.0;  ///< the worst of them
  std::size_t asked = 0;    ///< how many of them

  [[nodiscard]] double variance_m2() const { return matches > 0.0 ? squares_m2 / matches : 0.0; }
};

class Guesser {
 public:
  Guesser(PosedScans& scans, const scene::RegisterConfig& config, const Context& context, FinishedPairs* finished)
      : posed_(scans), scans_(scans.scans), config_(config), context_(context), finished_(finished) {
    longest_m_ = posed_.longest_m();
    spacing_m_ = posed_.spacing_m(&PosedScan::medium);
    if (finished_ == nullptr) return;
    for (const PosedScan& scan : scans_) digests_.push_back(digest_of(scan));
  }

  std::vector<FirstGuess> run() {
    context_.progress.begin("features");
    describe();
    const std::vector<Edge> pairs = pairs_to_try();
    context_.progress.begin("guess pairs");
    guess(pairs);
    return place_all();
  }

 private:
  template <typename Work>
  void for_all(std::size_t count, const Work& work) {
    std::atomic<std::size_t> done{0};
    context_.pool.for_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        context_.progress.throw_if_cancelled();
        work(k);
        context_.progress.at(static_cast<double>(++done) / static_cast<double>(count));
      }
    });
  }

  void describe() {
    features_.resize(scans_.size());
    sights_.resize(scans_.size());
    for_all(scans_.size(), [&](std::size_t s) {
      features_[s] = features_of(*scans_[s].medium, kFeatures, kRadius * longest_m_);
      if (scans_[s].place) sights_[s].emplace(*scans_[s].medium, *scans_[s].place, scans_[s].middle_m);
    });
  }

  // All pairs of a few scans; of many those with most descriptors in common: each scan's best, and a tree.
  [[nodiscard]] std::vector<Edge> pairs_to_try() {
    std::vector<WeighedEdge> all;
    for (std::size_t a = 0; a < scans_.size(); ++a)
      for (std::size_t b = a + 1; b < scans_.size(); ++b) all.push_back({{a, b, false}, 0.0});
    std::vector<bool> tried(all.size(), scans_.size() <= kAllPairsOf);
    if (scans_.size() > kAllPairsOf) {
      for_all(all.size(), [&](std::size_t k) {
        const ScanFeatures& a = features_[all[k].edge.a];
        const ScanFeatures& b = features_[all[k].edge.b];
        std::size_t matches = mutual_matches(a, b);
        if (a.any_side || b.any_side) matches = std::max(matches, mutual_matches(a, turned(b)));
        all[k].weight = static_cast<double>(matches);
      });
      for (const std::size_t k : heaviest_tree(scans_.size(), all).edges) tried[k] = true;
      for (std::size_t s = 0; s < scans_.size(); ++s) {
        std::vector<std::size_t> own;
        for (std::size_t k = 0; k < all.size(); ++k)
          if (all[k].edge.a == s || all[k].edge.b == s) own.push_back(k);
        std::stable_sort(own.begin(), own.end(),
                         [&](std::size_t x, std::size_t y) { return all[x].weight > all[y].weight; });
        for (std::size_t k = 0; k < std::min(own.size(), kPartners); ++k) tried[own[k]] = true;
      }
    }
    std::vector<Edge> result;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (tried[k]) result.push_back(all[k].edge);
    return result;
  }

  void guess(const std::vector<Edge>& pairs) {
    std::vector<std::vector<Candidate>> found(pairs.size());
    for_all(pairs.size(),
            [&](std::size_t k) { found[k] = finished_ != nullptr ? kept(pairs[k]) : guesses_of(pairs[k]); });
    for (const std::vector<Candidate>& some : found) candidates_.insert(candidates_.end(), some.begin(), some.end());
  }

  // The same as guesses_of(), which is asked once in all runs.
  [[nodiscard]] std::vector<Candidate> kept(const Edge& edge) const {
    constexpr std::size_t kNumbers = 14;  // of a candidate
    const std::array decisive{static_cast<double>(edge.a), static_cast<double>(edge.b), longest_m_, spacing_m_,
                              static_cast<double>(config_.method)};
    const std::array digests{digests_[edge.a], digests_[edge.b]};
    const std::string key = finished_->key_of("guessed", digests, decisive);
    std::vector<double> numbers;
    if (finished_->find(key, numbers) && numbers.size() % kNumbers == 0) {
      std::vector<Candidate> found;
      for (auto next = numbers.data(); found.size() < numbers.size() / kNumbers; next += kNumbers)
        found.push_back({edge.a, edge.b, motion_of(next + 2), next[0], next[1] != 0.0});
      return found;
    }
    numbers.clear();
    std::vector<Candidate> found = guesses_of(edge);
    for (const Candidate& candidate : found) {
      numbers.insert(numbers.end(), {candidate.overlap, candidate.slides ? 1.0 : 0.0});
      add_numbers(candidate.second_to_first, numbers);
    }
    finished_->add(key, numbers);
    return found;
  }

  [[nodiscard]] std::vector<Candidate> guesses_of(const Edge& edge) const {
    GuessLimits limits;
    limits.touch_m = kRadius * longest_m_ / 3.0;
    limits.least_m = kLeastEdge * longest_m_;
    limits.apart_m = kApart * longest_m_;
    limits.most = kGuesses;
    limits.samples = kSamples;
    limits.seed = edge.a * kGoldenStep + edge.b;
    const ScanFeatures& target = features_[edge.a];
    const ScanFeatures& source = features_[edge.b];
    std::vector<Candidate> result;
    const auto add = [&](const ScanFeatures& from) {
      for (const PoseGuess& guess : guess_pair(from, target, limits, context_.progress)) {
        context_.progress.throw_if_cancelled();
        result.push_back(refined(edge, guess));
      }
    };
    add(source);
    if (source.any_side || target.any_side) add(turned(source));
    std::stable_sort(result.begin(), result.end(),
                     [](const Candidate& a, const Candidate& b) { return a.overlap > b.overlap; });
    return without_repeats(result);
  }

  // Guesses that alignment brought to the same place are one.
  [[nodiscard]] std::vector<Candidate> without_repeats(const std::vector<Candidate>& all) const {
    std::vector<Candidate> result;
    for (const Candidate& candidate : all) {
      const bool repeat = std::any_of(result.begin(), result.end(), [&](const Candidate& other) {
        return nearly_same(other.second_to_first, candidate.second_to_first, scans_[candidate.second].middle_m,
                           kSamePlace * longest_m_);
      });
      if (!repeat) result.push_back(candidate);
    }
    return result;
  }

  [[nodiscard]] MatchLimits within(double distance_m, bool any_sign) const {
    MatchLimits limits;
    limits.distance_m = distance_m;
    limits.most = kLookedAt;
    limits.any_sign = any_sign;
    return limits;
  }

  [[nodiscard]] Candidate refined(const Edge& edge, const PoseGuess& guess) const {
    const PosedScan& first = scans_[edge.a];
    const PosedScan& second = scans_[edge.b];
    Candidate candidate;
    candidate.first = edge.a;
    candidate.second = edge.b;
    Eigen::Isometry3d pose = guess.pose;
    const double coarse_m = 2.0 * std::max(first.coarse->spacing_m(), second.coarse->spacing_m());
    for (const double distance_m : {2.0 * coarse_m, coarse_m})
      pose = align_pair(*second.coarse, *first.coarse, pose, config_.method, distance_m, kIterations, false);
    pose =
        align_pair(*second.medium, *first.medium, pose, config_.method, 2.0 * kTouch * spacing_m_, kIterations, false);
    candidate.second_to_first = pose;
    const Agreement agreed = agreement(*first.medium, Eigen::Isometry3d::Identity(), *second.medium, pose,
                                       within(kTouch * spacing_m_, false));
    candidate.overlap = agreed.overlap;
    candidate.slides = agreed.least_information < kLeastInformation;
    return candidate;
  }

  [[nodiscard]] double in_the_way(std::size_t a, std::size_t b, const Eigen::Isometry3d& b_to_a) const {
    double share = 0.0;
    if (sights_[a]) share = sights_[a]->in_the_way(*scans_[b].coarse, b_to_a, kClearance * spacing_m_);
    if (sights_[b])
      share = std::max(share, sights_[b]->in_the_way(*scans_[a].coarse, b_to_a.inverse(), kClearance * spacing_m_));
    return share;
  }

  // The surest scan first; every other one is then looked at again beside it.
  std::vector<FirstGuess> place_all() {
    context_.progress.begin("place scans");
    placed_.assign(scans_.size(), false);
    std::vector<FirstGuess> result;
    for (std::size_t next = 0;;) {
      add(next);
      if (result.size() + 1 == scans_.size()) return result;
      const Place* best = nullptr;
      for (std::size_t s = 0; s < scans_.size(); ++s) {
        const Verdict verdict = judge(s);
        if (!verdict.sure()) continue;
        if (best == nullptr || verdict.best->matches > best->matches) best = verdict.best;
      }
      if (best == nullptr) throw unplaced();
      next = best->scan;
      scans_[next].pose = best->pose;
      result.push_back({next, best->on, best->overlap});
      context_.progress.at(static_cast<double>(result.size()) / static_cast<double>(scans_.size()));
    }
  }

  // A scan has got its pose: it gives places to try for others, and the places found before are compared with it.
  void add(std::size_t placed) {
    placed_[placed] = true;
    std::erase_if(places_, [&](const Place& place) { return place.scan == placed; });
    for (const Candidate& candidate : candidates_) {
      if (candidate.first != placed && candidate.second != placed) continue;
      Place place;
      place.scan = candidate.first == placed ? candidate.second : candidate.first;
      if (placed_[place.scan]) continue;
      place.on = placed;
      place.pose = scans_[placed].pose *
                   (candidate.first == placed ? candidate.second_to_first : candidate.second_to_first.inverse());
      place.overlap = candidate.overlap;
      place.slides = candidate.slides;
      places_.push_back(place);
    }
    for_all(places_.size(), [&](std::size_t k) {
      Place& place = places_[k];
      for (; place.asked < order_.size() + 1; ++place.asked) {
        look(place, place.asked < order_.size() ? order_[place.asked] : placed);
      }
    });
    order_.push_back(placed);
  }

  void look(Place& place, std::size_t other) const {
    const PosedScan& there = scans_[other];
    const PosedScan& scan = scans_[place.scan];
    const Agreement agreed =
        agreement(*there.medium, there.pose, *scan.medium, place.pose, within(kTouch * spacing_m_, false));
    const auto matches = static_cast<double>(agreed.matches);
    place.matches += matches;
    place.squares_m2 += matches * agreed.residual_m * agreed.residual_m;
    place.in_the_way = std::max(place.in_the_way, in_the_way(other, place.scan, there.pose.inverse() * place.pose));
  }

  /// What is known of where a scan lies.
  struct Verdict {
    const Place* best = nullptr;
    const Place* rival = nullptr;  ///< one somewhere else that fits nearly as well
    [[nodiscard]] bool sure() const { return best != nullptr && rival == nullptr; }
  };
  [[nodiscard]] double least_overlap(const Place& place) const {
    const bool seen = sights_[place.scan].has_value() && sights_[place.on].has_value();
    return std::max(seen ? kLeastOverlap : kLeastUnseen, config_.min_overlap);
  }
  [[nodiscard]] bool believed(const Place& place) const {
    return !place.slides && place.in_the_way <= kMostInTheWay && place.overlap >= least_overlap(place);
  }
  // The place with most matches, or one with nearly as many that lie closer: so is the right one told from others on a
  // shape that nearly repeats.
  [[nodiscard]] Verdict judge(std::size_t scan) const {
    Verdict verdict;
    double most = 0.0;
    std::vector<const Place*> believable;
    for (const Place& place : places_) {
      if (place.scan != scan || !believed(place)) continue;
      believable.push_back(&place);
      most = std::max(most, place.matches);
    }
    for (const Place* place : believable) {
      if (place->matches < kSure * most) continue;
      if (verdict.best == nullptr || place->variance_m2() < verdict.best->variance_m2()) verdict.best = place;
    }
    if (verdict.best == nullptr) return verdict;
    for (const Place* place : believable) {
      if (place->matches < kSure * verdict.best->matches) continue;
      if (place->variance_m2() > kCloser * kCloser * verdict.best->variance_m2()) continue;
      if (nearly_same(place->pose, verdict.best->pose, scans_[scan].middle_m, kApart * longest_m_)) continue;
      if (verdict.rival == nullptr || place->matches > verdict.rival->matches) verdict.rival = place;
    }
    return verdict;
  }

  [[nodiscard]] Error unplaced() const {
    std::size_t lost = 0;
    while (placed_[lost]) ++lost;
    for (std::size_t s = lost; s < scans_.size(); ++s) {
      if (!placed_[s] && judge(s).best != nullptr) lost = s;
    }
    const std::string& name = scans_[lost].name;
    const Verdict verdict = judge(lost);
    if (verdict.best != nullptr) {
      return input_error(
          name,
          fmt::format("by its features this scan fits in more than one way: {:.0f} % of it on {}, or {:.0f} % "
                      "on {} elsewhere, so its first guess is not sure",
                      100.0 * verdict.best->overlap, scans_[verdict.best->on].name, 100.0 * verdict.rival->overlap,
                      scans_[verdict.rival->on].name),
          "a shape without symmetries, more overlap, or rough poses and register.guess: poses");
    }
    const Place* nearest = nullptr;
    std::size_t tried = 0;
    for (const Place& place : places_) {
      if (place.scan != lost) continue;
      ++tried;
      if (nearest == nullptr || place.overlap > nearest->overlap) nearest = &place;
    }
    const std::string remedy = "more overlap, or rough poses and register.guess: poses";
    if (nearest == nullptr) {
      return input_error(name, "no first guess was found for this scan: its features resemble no other scan's", remedy);
    }
    const std::string& other = scans_[nearest->on].name;
    if (nearest->slides) {
      return input_error(
          name,
          fmt::format("what this scan and {} have in common can slide (a plane, a cylinder or a sphere), so "
                      "features give no first guess",
                      other),
          "scans that share corners, edges or carving, or rough poses and register.guess: poses");
    }
    return input_error(
        name,
        fmt::format("none of {} guesses from features is believed for this scan: the best puts {:.0f} % of its thinned "
                    "points on {}, and {:.0f} % of them where a scanner saw through",
                    tried, 100.0 * nearest->overlap, other, 100.0 * nearest->in_the_way),
        fmt::format("at least {:.0f} % and at most {:.0f} %: {}", 100.0 * least_overlap(*nearest),
                    100.0 * kMostInTheWay, remedy));
  }

  PosedScans& posed_;
  std::vector<PosedScan>& scans_;
  const scene::RegisterConfig& config_;
  const Context& context_;
  FinishedPairs* finished_;           ///< null where nothing is kept
  std::vector<std::string> digests_;  ///< of each scan, where results are kept
  double longest_m_ = 0.0;
  double spacing_m_ = 0.0;
  std::vector<ScanFeatures> features_;
  std::vector<std::optional<LineOfSight>> sights_;
  std::vector<Candidate> candidates_;
  std::vector<Place> places_;
  std::vector<std::size_t> order_;  ///< in which scans were placed
  std::vector<bool> placed_;
};

}  // namespace

std::vector<FirstGuess> guess_poses(PosedScans& scans, const scene::RegisterConfig& config, const Context& context,
                                    FinishedPairs* finished) {
  return Guesser(scans, config, context, finished).run();
}

}  // namespace sparsha::pipeline

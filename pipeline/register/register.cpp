// Read and thin, align pairs that meet, link them to the first scan, relax all poses together, measure again.
#include "pipeline/register/register.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/register/aligned_pair.h"
#include "pipeline/register/finished_pairs.h"
#include "pipeline/register/first_guess.h"
#include "pipeline/register/graph.h"
#include "pipeline/register/lost_scan.h"
#include "pipeline/register/match.h"
#include "pipeline/register/pair_alignment.h"
#include "pipeline/register/posed_scan.h"
#include "pipeline/register/relaxation.h"
#include "pipeline/register/shared_cells.h"

namespace sparsha::pipeline {
namespace {

constexpr double kAutomaticReach = 0.15;  // longest sides: 10 degrees at the rim of an object, and 5 % of its size
constexpr double kGuessedReach = 0.03;    // first guesses from features have been aligned already
constexpr double kMostTurn = 35.0 * 3.14159265358979323846 / 180.0;  // rough poses are not worse than that
constexpr double kMostShift = 0.35;                                  // longest sides
constexpr double kRelaxedShare = 0.5;  // of min_overlap: pairs that have less in common still help to place scans
constexpr int kRelaxations = 3;        // at most, until the same pairs meet as before
constexpr double kByChance = 0.2;  // residual over the distance within which points are in common: evenly spread, 0.58
// Roughness of one scan that the residual of two may reach: right links have 0.4 to 1.4, rings one place aside 2.2 and
// more.
constexpr double kRough = 1.7;
constexpr double kRigid = 1e-9;          // moves a point by no more than that part of the scan's size
constexpr double kOtherUnit = 50.0;      // ratio of longest sides beyond which units may be wrong: m, cm and mm
constexpr std::size_t kPairsOfScan = 3;  // that are aligned, for each scan of a set
constexpr double kCell = 0.5;            // reaches: the grid that tells which scans may have something in common

bool is_rigid(const Eigen::Matrix4d& pose) {
  const Eigen::Matrix3d turn = pose.topLeftCorner<3, 3>();
  return (turn * turn.transpose()).isIdentity(kRigid);
}

PairFit::Fit fit_of(const Agreement& agreement, double within_m) {
  return {within_m, agreement.overlap, agreement.residual_m, agreement.matches};
}

class Registrar {
 public:
  Registrar(const std::vector<scene::ScanConfig>& scans, const scene::RegisterConfig& config,
            scene::RegisterConfig::Guess guess, const Context& context, FinishedPairs* finished)
      : given_(scans), config_(config), context_(context), finished_(finished) {
    if (scans.size() < 2) {
      throw usage_error("one scan alone cannot be registered", "a configuration with two or more scans");
    }
    context.progress.begin("read");
    posed_ = read_posed_scans(scans, config.voxel_m, guess == scene::RegisterConfig::Guess::poses, context);
    for (const std::size_t place : posed_.places) configs_.push_back(scans[place]);
    if (guess == scene::RegisterConfig::Guess::features && configs_.size() > 1) {
      guesses_ = guess_poses(posed_, config, context, finished);
      turn_views(posed_.scans);
    }
    for (const PosedScan& scan : posed_.scans) rough_.push_back(scan.pose);
    const double automatic = guesses_.empty() ? kAutomaticReach : kGuessedReach;
    reach_m_ = config.max_distance_m > 0.0 ? config.max_distance_m : automatic * posed_.longest_m();
    medium_touch_m_ = kTouch * posed_.spacing_m(&PosedScan::medium);
    fine_touch_m_ = kTouch * posed_.spacing_m(&PosedScan::fine);
    for (std::size_t a = 0; a < configs_.size(); ++a)
      for (std::size_t b = a + 1; b < configs_.size(); ++b) {
        pairs_.emplace_back();
        pairs_.back().fit.first = a;
        pairs_.back().fit.second = b;
      }
  }

  Registration run() {
    if (configs_.size() < 2) {
      throw input_error({}, configs_.empty() ? "none of the scans has points" : "only one of the scans has points",
                        "two or more scans with points");
    }
    context_.progress.begin("align pairs");
    if (finished_ != nullptr)
      for (const PosedScan& scan : posed_.scans) digests_.push_back(digest_of(scan));
    align_pairs();
    link();
    context_.progress.begin("relax");
    relax();
    measure_all_after();
    reject_what_does_not_fit();
    Registration result;
    for (const scene::ScanConfig& scan : given_) result.poses.push_back(scan.pose);
    for (std::size_t s = 0; s < configs_.size(); ++s) {
      if (s > 0 || !is_rigid(configs_.front().pose))
        result.poses[posed_.places[s]] = posed_.pose_of(s, posed_.scans[s].pose);
    }
    for (const FirstGuess& guess : guesses_)
      result.guesses.push_back({posed_.places[guess.scan], posed_.places[guess.on], guess.overlap});
    result.pairs = found();
    return result;
  }

  std::vector<PairFit> measure() {
    context_.progress.begin("measure pairs");
    for_pairs(pairs_within(fine_touch_m_), [this](AlignedPair& pair) {
      measure_after(pair);
      pair.fit.before = pair.fit.after;
      if (pair.fit.after.overlap >= config_.min_overlap) pair.fit.use = PairFit::Use::used;
    });
    return found();
  }

 private:
  template <typename Work>
  void for_pairs(const std::vector<AlignedPair*>& pairs, const Work& work) {
    std::atomic<std::size_t> done{0};
    context_.pool.for_ranges(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        context_.progress.throw_if_cancelled();
        work(*pairs[k]);
        context_.progress.at(static_cast<double>(++done) / static_cast<double>(pairs.size()));
      }
    });
  }

  // Pairs that may have something within a distance in common, with the present poses.
  [[nodiscard]] std::vector<AlignedPair*> pairs_within(double distance_m) {
    const SharedCells cells(posed_.scans, distance_m);
    std::vector<AlignedPair*> result;
    for (AlignedPair& pair : pairs_)
      if (cells.share(pair.fit.first, pair.fit.second) > 0.0) result.push_back(&pair);
    return result;
  }

  // The best few of each scan; where they do not link all scans, more of those that could.
  void align_pairs() {
    const SharedCells cells(posed_.scans, kCell * reach_m_);
    std::vector<AlignedPair*> now;
    for (const Edge& edge : cells.best_pairs(kPairsOfScan * posed_.scans.size())) now.push_back(&pair_of(edge));
    while (!now.empty()) {
      for_pairs(now, [this](AlignedPair& pair) { align(pair); });
      now = untried_links(cells);
    }
  }

  [[nodiscard]] AlignedPair& pair_of(const Edge& edge) {
    const std::size_t before = edge.a * (2 * posed_.scans.size() - edge.a - 1) / 2;  // pairs of scans before edge.a
    return pairs_[before + edge.b - edge.a - 1];
  }

  // Of the pairs that would link scans that are not linked yet, the best ones that were not tried.
  [[nodiscard]] std::vector<AlignedPair*> untried_links(const SharedCells& cells) {
    std::vector<bool> reached(posed_.scans.size(), true);
    for (const std::size_t scan : heaviest_tree(posed_.scans.size(), used_edges()).unreached) reached[scan] = false;
    std::vector<AlignedPair*> left;
    for (AlignedPair& pair : pairs_)
      if (!pair.tried && reached[pair.fit.first] != reached[pair.fit.second]) left.push_back(&pair);
    std::ranges::stable_sort(left, std::greater(),
                             [&](const AlignedPair* pair) { return cells.share(pair->fit.first, pair->fit.second); });
    left.resize(std::min(left.size(), posed_.scans.size()));
    return left;
  }

  [[nodiscard]] const PosedScan& first(const AlignedPair& pair) const { return posed_.scans[pair.fit.first]; }
  [[nodiscard]] const PosedScan& second(const AlignedPair& pair) const { return posed_.scans[pair.fit.second]; }

  [[nodiscard]] Agreement agree(const AlignedPair& pair, std::unique_ptr<StationSurface> PosedScan::*level,
                                double within_m, const Eigen::Isometry3d& second_to_first) const {
    MatchLimits limits;
    limits.distance_m = within_m;
    limits.most = kMediumPoints;
    limits.any_sign = pair.any_sign;
    return agreement(*(first(pair).*level), Eigen::Isometry3d::Identity(), *(second(pair).*level), second_to_first,
                     limits);
  }

  [[nodiscard]] Eigen::Isometry3d relative(const AlignedPair& pair, const std::vector<Eigen::Isometry3d>& poses) const {
    return poses[pair.fit.first].inverse() * poses[pair.fit.second];
  }

  void measure_before(AlignedPair& pair) const {
    const Eigen::Isometry3d guess = relative(pair, rough_);
    doubt_signs(pair, guess);
    pair.fit.before = fit_of(agree(pair, &PosedScan::medium, reach_m_, guess), reach_m_);
  }

  void align(AlignedPair& pair) const {
    pair.tried = true;
    const std::string key = finished_ != nullptr ? key_of(pair) : std::string();
    std::vector<double> numbers;
    if (finished_ == nullptr || !finished_->find(key, numbers) || !take_numbers(numbers, pair)) {
      find_place(pair);
      if (finished_ != nullptr) finished_->add(key, numbers_of(pair));
    }
    if (pair.candidate) judge(pair);
  }

  // Of all that find_place() depends on.
  [[nodiscard]] std::string key_of(const AlignedPair& pair) const {
    std::vector<double> numbers = {reach_m_, config_.min_overlap, static_cast<double>(config_.method)};
    add_numbers(relative(pair, rough_), numbers);
    const std::array digests{digests_[pair.fit.first], digests_[pair.fit.second]};
    return finished_->key_of("aligned", digests, numbers);
  }

  void find_place(AlignedPair& pair) const {
    measure_before(pair);
    const Eigen::Isometry3d guess = relative(pair, rough_);
    pair.candidate = pair.fit.before.overlap >= 0.5 * config_.min_overlap;
    if (!pair.candidate) return;
    const double medium_touch_m = kTouch * std::max(first(pair).medium->spacing_m(), second(pair).medium->spacing_m());
    const PairAlignment found =
        align_scans(first(pair), second(pair), guess, {reach_m_, config_.method, pair.any_sign}, context_);
    pair.aligned = found.second_to_first;
    pair.hold = found.hold;
    pair.unsure = found.unsure;
    pair.agreement = agree(pair, &PosedScan::medium, medium_touch_m, pair.aligned);
  }

  // Where the place of a scanner is guessed, its normals may all face the wrong side.
  void doubt_signs(AlignedPair& pair, const Eigen::Isometry3d& guess) const {
    const double with_sign = agree(pair, &PosedScan::coarse, reach_m_, guess).overlap;
    pair.any_sign = true;
    const double without = agree(pair, &PosedScan::coarse, reach_m_, guess).overlap;
    pair.any_sign = with_sign < 0.3 * without;
  }

  void judge(AlignedPair& pair) const {
    if (pair.agreement.overlap < config_.min_overlap || pair.agreement.matches < kLeastMatches) return;
    const bool slides = pair.unsure || pair.agreement.least_information < kLeastInformation ||
                        (pair.hold.matches >= kLeastMatches && pair.hold.least_information < kLeastInformation);
    pair.fit.use = slides ? PairFit::Use::weak : PairFit::Use::used;
    if (pair.fit.use == PairFit::Use::used && !(pair.hold.holds() && pair.hold.matches >= kLeastMatches))
      pair.fit.use = PairFit::Use::rejected;
    if (moved_too_far(pair)) pair.fit.use = PairFit::Use::rejected;
  }

  // Farther than rough poses may be wrong.
  [[nodiscard]] bool moved_too_far(const AlignedPair& pair) const {
    const Eigen::Isometry3d guess = relative(pair, rough_);
    const double turn = Eigen::AngleAxisd(Eigen::Matrix3d(guess.linear().transpose() * pair.aligned.linear())).angle();
    return turn > kMostTurn || moved_m(pair, guess) > kMostShift * posed_.longest_m();
  }

  // How far the pair's own result lies from another relative pose: RMS over the second scan.
  [[nodiscard]] double moved_m(const AlignedPair& pair, const Eigen::Isometry3d& other) const {
    double sum = 0.0;
    const auto& elements = second(pair).coarse->elements();
    for (const StationSurface::Element& element : elements)
      sum += (pair.aligned * element.point - other * element.point).squaredNorm();
    return std::sqrt(sum / static_cast<double>(elements.size()));
  }

  [[nodiscard]] std::vector<WeighedEdge> used_edges(std::vector<const AlignedPair*>* of_edges = nullptr) const {
    std::vector<WeighedEdge> edges;
    for (const AlignedPair& pair : pairs_) {
      if (pair.fit.use != PairFit::Use::used) continue;
      edges.push_back({{pair.fit.first, pair.fit.second, pair.any_sign},
                       std::sqrt(static_cast<double>(pair.hold.matches) * pair.hold.least_information)});
      if (of_edges != nullptr) of_edges->push_back(&pair);
    }
    return edges;
  }

  // Poses along the tree of used pairs, from the first scan, with which the most of the other pairs agree; an error
  // names a scan that it does not reach.
  void link() {
    std::vector<const AlignedPair*> of_edge;
    const std::vector<WeighedEdge> edges = used_edges(&of_edge);
    std::vector<Eigen::Isometry3d> aligned;
    for (const AlignedPair* pair : of_edge) aligned.push_back(pair->aligned);
    const Tree tree =
        agreed_tree(posed_.scans.size(), edges, aligned, [&](std::size_t edge, const Eigen::Isometry3d& b_to_a) {
          return moved_m(*of_edge[edge], b_to_a) <= fine_touch_m_;
        });
    if (!tree.unreached.empty()) throw unlinked(tree);
    const std::vector<Eigen::Isometry3d> poses =
        poses_along(tree, posed_.scans.size(), edges, aligned, posed_.scans.front().pose);
    for (std::size_t s = 0; s < poses.size(); ++s) posed_.scans[s].pose = poses[s];
  }

  [[nodiscard]] Error unlinked(const Tree& tree) const {
    const auto reached = [&](std::size_t scan) {
      return std::find(tree.unreached.begin(), tree.unreached.end(), scan) == tree.unreached.end();
    };
    // The pair that comes nearest to linking a scan that is left.
    const AlignedPair* best = nullptr;
    for (const AlignedPair& pair : pairs_) {
      if (reached(pair.fit.first) == reached(pair.fit.second)) continue;
      const auto rank = [](const AlignedPair& p) {
        return std::pair(p.fit.use == PairFit::Use::none ? 0 : 1,
                         p.candidate ? p.agreement.overlap : p.fit.before.overlap - 1.0);
      };
      if (best == nullptr || rank(pair) > rank(*best)) best = &pair;
    }
    const std::size_t lost = reached(best->fit.first) ? best->fit.second : best->fit.first;
    const std::size_t beside = lost == best->fit.second ? best->fit.first : best->fit.second;
    LostScan scan{posed_.scans[lost].name, posed_.scans[beside].name, *best};
    if (moved_too_far(*best)) scan.too_far_m = moved_m(*best, relative(*best, rough_));
    scan.reach_m = reach_m_;
    scan.min_overlap = config_.min_overlap;
    scan.hint = advice(posed_.scans[lost], posed_.scans[beside]);
    return refusal_of(scan);
  }

  // What helps where sizes do not go together, or nobody has placed the scans.
  [[nodiscard]] std::string advice(const PosedScan& lost, const PosedScan& other) const {
    if (std::max(lost.longest_m, other.longest_m) > kOtherUnit * std::min(lost.longest_m, other.longest_m)) {
      return fmt::format("; it is {} long and {} is {}: check 'units'", length_text(lost.longest_m), other.name,
                         length_text(other.longest_m));
    }
    const auto unplaced = [](const scene::ScanConfig& scan) { return scan.pose.isIdentity(0.0); };
    if (!guesses_.empty() || !std::ranges::all_of(configs_, unplaced)) return {};
    return "; no scan has a pose: `register: {guess: features}` finds them from the surfaces";
  }

  // Pairs that meet with the present poses, the given ones of which may not have been aligned by themselves.
  [[nodiscard]] std::vector<Edge> meeting() {
    std::vector<Edge> edges;
    for (const AlignedPair* candidate : pairs_within(medium_touch_m_)) {
      const AlignedPair& pair = *candidate;
      const Agreement agreement = agree(pair, &PosedScan::medium, medium_touch_m_, present(pair));
      if (agreement.overlap >= kRelaxedShare * config_.min_overlap && agreement.matches >= kLeastMatches)
        edges.push_back({pair.fit.first, pair.fit.second, pair.any_sign});
    }
    return edges;
  }

  void relax() {
    std::vector<PosedSurface> surfaces;
    for (const PosedScan& scan : posed_.scans) surfaces.push_back({scan.fine.get(), scan.pose});
    std::vector<Edge> edges = meeting();
    for (int round = 0; round < kRelaxations; ++round) {
      relax_jointly(surfaces, edges, medium_touch_m_, fine_touch_m_, context_);
      for (std::size_t s = 1; s < surfaces.size(); ++s) posed_.scans[s].pose = surfaces[s].pose;
      std::vector<Edge> again = meeting();
      if (again == edges) break;
      edges = std::move(again);
    }
    settle_jointly(surfaces, edges, fine_touch_m_, context_);
    for (std::size_t s = 1; s < surfaces.size(); ++s) posed_.scans[s].pose = surfaces[s].pose;
    for (AlignedPair& pair : pairs_) {
      if (pair.fit.use != PairFit::Use::used) continue;
      if (moved_m(pair, present(pair)) > fine_touch_m_) pair.fit.use = PairFit::Use::rejected;
    }
  }

  [[nodiscard]] Eigen::Isometry3d present(const AlignedPair& pair) const {
    return first(pair).pose.inverse() * second(pair).pose;
  }

  void measure_after(AlignedPair& pair) const {
    pair.fit.after = fit_of(agree(pair, &PosedScan::fine, fine_touch_m_, present(pair)), fine_touch_m_);
  }

  void measure_all_after() {
    for_pairs(pairs_within(fine_touch_m_), [this](AlignedPair& pair) {
      measure_after(pair);
      if (!pair.tried && pair.fit.after.matches > 0) measure_before(pair);
    });
    for (AlignedPair& pair : pairs_)
      pair.fit.after.within_m = fine_touch_m_;  // also of those that have nothing in common
  }

  // Chance puts points of two scans near each other as well; of one surface they lie as near as noise and form allow.
  [[nodiscard]] bool fits(const AlignedPair& pair) const {
    const double rough_m = std::max(first(pair).fine->roughness_m(), second(pair).fine->roughness_m());
    const PairFit::Fit& after = pair.fit.after;
    return after.residual_m <= std::max(kByChance * after.within_m, kRough * rough_m);
  }

  // Pairs that were aligned and do not fit are no links; what is left must still hold all scans.
  void reject_what_does_not_fit() {
    std::vector<WeighedEdge> edges;
    for (AlignedPair& pair : pairs_) {
      const bool used = pair.fit.use == PairFit::Use::used;
      const bool good = pair.fit.after.matches > 0 && fits(pair);
      if (used && !good) pair.fit.use = PairFit::Use::rejected;
      const bool met =
          pair.fit.after.overlap >= kRelaxedShare * config_.min_overlap && pair.fit.after.matches >= kLeastMatches;
      if (good && (used || met))
        edges.push_back({{pair.fit.first, pair.fit.second, pair.any_sign}, pair.fit.after.overlap});
    }
    const Tree tree = heaviest_tree(posed_.scans.size(), edges);
    if (tree.unreached.empty()) return;
    const auto reached = [&](std::size_t scan) {
      return std::ranges::find(tree.unreached, scan) == tree.unreached.end();
    };
    const AlignedPair* best = nullptr;  // of those that would link the two groups
    for (const AlignedPair& pair : pairs_) {
      if (reached(pair.fit.first) == reached(pair.fit.second)) continue;
      if (best == nullptr || pair.fit.after.matches > best->fit.after.matches) best = &pair;
    }
    const bool second_lost = reached(best->fit.first);
    const std::size_t lost = second_lost ? best->fit.second : best->fit.first;
    const std::size_t other = second_lost ? best->fit.first : best->fit.second;
    throw input_error(
        posed_.scans[lost].name,
        fmt::format(
            "the best pose found leaves its points {} (RMS) from those of {} where the two are within {} of each "
            "other, which chance does as well",
            length_text(best->fit.after.residual_m), posed_.scans[other].name, length_text(best->fit.after.within_m)),
        "poses nearer to the truth, more overlap, or parts that do not repeat" +
            advice(posed_.scans[lost], posed_.scans[other]));
  }

  // With the places of the scans among those that were given.
  [[nodiscard]] std::vector<PairFit> found() const {
    std::vector<PairFit> result;
    for (const AlignedPair& pair : pairs_) {
      if (pair.fit.before.matches + pair.fit.after.matches == 0) continue;
      result.push_back(pair.fit);
      result.back().first = posed_.places[pair.fit.first];
      result.back().second = posed_.places[pair.fit.second];
    }
    return result;
  }

  const std::vector<scene::ScanConfig>& given_;
  std::vector<scene::ScanConfig> configs_;  ///< of the scans that have points
  const scene::RegisterConfig& config_;
  const Context& context_;
  PosedScans posed_;
  std::vector<Eigen::Isometry3d> rough_;  ///< as given or guessed
  std::vector<FirstGuess> guesses_;
  FinishedPairs* finished_;           ///< null where nothing is kept
  std::vector<std::string> digests_;  ///< of each scan, where results are kept
  std::vector<AlignedPair> pairs_;    ///< all there are: of the first scan, then of the second
  double reach_m_ = 0.0;
  double medium_touch_m_ = 0.0;
  double fine_touch_m_ = 0.0;
};

}  // namespace

std::string to_string(PairFit::Use use) {
  switch (use) {
    case PairFit::Use::none:
      return "none";
    case PairFit::Use::used:
      return "used";
    case PairFit::Use::weak:
      return "weak";
    case PairFit::Use::rejected:
      return "rejected";
  }
  return {};
}

Registration register_scans(const std::vector<scene::ScanConfig>& scans, const scene::RegisterConfig& config,
                            const Context& context, FinishedPairs* finished) {
  return Registrar(scans, config, config.guess, context, finished).run();
}

std::vector<PairFit> measure_pairs(const std::vector<scene::ScanConfig>& scans, const scene::RegisterConfig& config,
                                   const Context& context) {
  return Registrar(scans, config, scene::RegisterConfig::Guess::poses, context, nullptr).measure();
}

}  // namespace sparsha::pipeline

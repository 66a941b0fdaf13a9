// Trials in a fixed order, so that the same points give the same choice.
#include "pipeline/suggest/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/text/text.h"
#include "pipeline/projection/lattice.h"
#include "scene/config/haptics.h"
#include "scene/frame/workspace.h"

namespace sparsha::pipeline {
namespace {

constexpr double kMostNodes = 4e6;  // of a first grid; a finer one is asked for by grid.spacing_mm
constexpr double kMeshNodes = 500.0;

// Of an object that fills the workspace; of a larger one at its own size, and no finer than of the smallest thing that
// anybody scans.
double hand_resolution_m(double longest_m) {
  constexpr double kSmallest_m = 1e-3;
  return scene::HapticsConfig{}.resolution_m * std::clamp(longest_m, kSmallest_m, scene::kDeskWorkspace_m) /
         scene::kDeskWorkspace_m;
}

// Searches views and spacings for a surface that passes its own cross-check.
class Search {
 public:
  Search(TrialCloud& points, const Sides& sides, const InnerBox& box, Progress& progress)
      : mesh_(points.has_faces()),
        share_(points.share()),
        neighbour_m_(points.neighbour_m()),
        raster_(points.is_raster()),
        longest_m_((box.high - box.low).maxCoeff()),
        resolution_m_(hand_resolution_m(longest_m_)),
        views_(sides.views),
        open_(sides.open),
        lies_(!sides.standing && sides.views.front().evident),
        trials_(points, resolution_m_, progress) {
    Eigen::Vector3d sides_m = box.high - box.low;
    std::sort(sides_m.begin(), sides_m.end());
    floor_m_ = std::max(std::sqrt(sides_m[2] * sides_m[1] / kMostNodes), resolution_m_);
  }

  [[nodiscard]] Choice run() {
    std::vector<Trial> tried{first(views_.front())};
    if (tried[0].flawless() || (views_.front().evident && tried[0].fits && !confused(tried[0])))
      return chosen(tried[0], tried[0], 1);
    constexpr int kCoarsest = 8;
    const Trial guess = tried[0];
    // What is seen in the points' form is more to go by than a finer grid, custom is not.
    if (views_.front().evident && !confused(guess)) {
      for (int times = 2; times <= kCoarsest; times *= 2) {
        const Trial trial = coarser(guess, times);
        if (trial.fits) return chosen(guess, trial, times);
      }
    }
    // Of a board with things on it, which is open below, both faces may be taken for its back: from below it hides
    // them.
    if (lies_ && guess.fits && guess.doubts.unfacing) {
      constexpr double kFewer = 0.95;
      const Trial behind = first(opposite(guess.view));
      const bool better = behind.flawless() && behind.seen >= kFewer * guess.seen;
      return chosen(guess, better ? behind : guess, 1);
    }
    for (const bool oblique : {false, true}) {
      for (std::size_t v = 1; v < views_.size(); ++v) {
        if (views_[v].oblique() == oblique) tried.push_back(first(views_[v]));
      }
      if (const Trial* best = best_of(tried)) return chosen(guess, *best, 1);
    }
    const std::vector<Trial> firsts = tried;
    for (int times = 2; 2 * times <= kCoarsest; times *= 2) {
      for (std::size_t v = 0; v < firsts.size(); ++v) tried[v] = coarser(firsts[v], times);
      if (const Trial* best = best_of(tried)) return chosen(guess, *best, times);
    }
    Choice failed = chosen(guess, guess, 1);
    failed.no_surface = std::all_of(firsts.begin(), firsts.end(), [](const Trial& t) { return !t.error.empty(); });
    return failed;
  }

 private:
  // A mesh is exact between its corners; a cloud's grid is as fine as its points on the surface.
  [[nodiscard]] Trial first(const View& view) {
    if (mesh_) {
      const Trial trial = trials_.run(view, mesh_spacing_m());
      constexpr double kNotFiner = 2.9;  // points a grid spacing, where some belong to no triangle
      return trial.error.empty() && trial.doubts.fine ? trials_.run(view, trial.point_spacing_m / kNotFiner) : trial;
    }
    const Trial trial = trials_.run_at_own_spacing(view, std::max(neighbour_m_ / std::sqrt(share_), floor_m_));
    // Points on a lattice of their own may pass at one spacing and fail at the nearest one of three digits.
    return trial.fits && share_ == 1.0 ? trials_.run(view, 1e-3 * std::stod(written_mm(trial.spacing_m))) : trial;
  }
  [[nodiscard]] Trial coarser(const Trial& trial, int times) {
    const double spacing_m = trial.error.empty() ? trial.spacing_m : std::max(neighbour_m_, floor_m_);
    return trials_.run(trial.view, times * spacing_m);
  }
  [[nodiscard]] double mesh_spacing_m() const {
    if (raster_) return neighbour_m_;
    const double fine_m = std::max(longest_m_ / kMeshNodes, resolution_m_);
    return std::min(std::max(neighbour_m_, floor_m_), fine_m);
  }
  [[nodiscard]] static View opposite(View view) {
    view.look_from = -view.look_from;
    view.reason = "its other side";
    return view;
  }
  // Far more noise than a scan of one surface has: several are taken for one. Or the back is seen for the front.
  static bool confused(const Trial& trial) {
    constexpr double kNoise = 4.0;  // point spacings
    return trial.fits && (trial.noise_m > kNoise * trial.point_spacing_m || trial.doubts.unfacing);
  }
  static double worth(const Trial& trial) { return (trial.view.above ? 0.5 : 1.0) * trial.area_m2; }
  // The one that shows the most surface, the first of equal ones.
  template <typename Accept>
  static const Trial* widest(const std::vector<Trial>& trials, const Accept& accept) {
    const Trial* best = nullptr;
    for (const Trial& trial : trials) {
      if (accept(trial) && (best == nullptr || worth(trial) > worth(*best))) best = &trial;
    }
    return best;
  }

  // Without a flaw if there is one, else the guess, else whatever passes; of these what shows most.
  static const Trial* best_of(const std::vector<Trial>& tried) {
    const Trial* best = widest(tried, [](const Trial& trial) { return trial.flawless(); });
    if (best == nullptr && tried.front().fits) best = tried.data();
    return best != nullptr ? best : widest(tried, [](const Trial& trial) { return trial.fits; });
  }

  [[nodiscard]] Choice chosen(const Trial& guess, const Trial& trial, int times) const {
    Choice choice;
    choice.trial = trial;
    choice.open = open_;
    if (&trial != &guess && (trial.view.look_from - guess.view.look_from).norm() > 1e-9) {
      choice.rejected = fmt::format("{}; but {}", guess.view.reason, guess.complaint());
    }
    const double tried_m = trial.error.empty() ? trial.spacing_m : std::max(neighbour_m_, floor_m_);
    choice.spacing_m = tried_m;
    if (!mesh_ && share_ < 1.0) {
      const double least_m = trial.spacing_m * std::sqrt(trial.nodes / kMostUnasked);
      choice.spacing_m = std::max({tried_m * std::sqrt(share_), times * floor_m_, times * trial.noise_m, least_m});
    }
    choice.exact_spacing = raster_;
    choice.spacing_reason = reason(trial, choice.spacing_m, times);
    return choice;
  }

  [[nodiscard]] std::string reason(const Trial& trial, double spacing_m, int times) const {
    if (times > 1)
      return fmt::format("{} times the distance between points: the surface of a finer grid is not theirs", times);
    if (!trial.error.empty()) return kNeighbours;
    if (raster_) return "the cells of the grid of heights: its values are those of the nodes";
    if (mesh_ && trial.spacing_m > 1.01 * mesh_spacing_m()) {
      return "a third of the distance between the points that belong to no triangle";
    }
    if (mesh_ && neighbour_m_ > longest_m_ / kMeshNodes) {
      return "triangles are exact between their corners: 500 nodes along the longest side show their form";
    }
    if (spacing_m < 1.2 * floor_m_ && spacing_m < 1.2 * resolution_m_) return "finer than this the hand gains nothing";
    if (mesh_) return kNeighbours;
    const double own_m = trial.point_spacing_m * std::sqrt(share_);
    if (spacing_m < 1.2 * floor_m_)
      return fmt::format("a first grid of {:.1f} million nodes; the points are {} apart",
                         nodes_at(trial, spacing_m) / 1e6, length_text(own_m));
    if (share_ < 1.0 && spacing_m <= trial.noise_m) return "the noise of the points, which exceeds their distance";
    if (spacing_m < 1.01 * own_m) return "the distance between neighbouring points on the surface";
    return spacing_m < 1.2 * neighbour_m_ ? kNeighbours : "few points for so wide a grid: a finer one would be empty";
  }

  [[nodiscard]] static double nodes_at(const Trial& trial, double spacing_m) {
    return trial.nodes * (trial.spacing_m / spacing_m) * (trial.spacing_m / spacing_m);
  }

  static constexpr const char* kNeighbours = "the median distance between neighbouring points";
  bool mesh_;
  double share_;
  double neighbour_m_;
  bool raster_;
  double longest_m_, resolution_m_;
  double floor_m_ = 0.0;
  std::vector<View> views_;
  bool open_;
  bool lies_;  // what is looked at is flat: it has two sides
  Trials trials_;
};

}  // namespace

std::string written_mm(double spacing_m) { return fmt::format("{:.3g}", 1e3 * spacing_m); }

Choice find_view_and_spacing(TrialCloud& points, const Sides& sides, const InnerBox& box, Progress& progress) {
  return Search(points, sides, box, progress).run();
}

}  // namespace sparsha::pipeline

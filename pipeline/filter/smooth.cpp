// PCL's fit.
#include "pipeline/filter/smooth.h"

#include <pcl/point_types.h>
#include <pcl/surface/impl/mls.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include <fmt/format.h>

#include "base/error.h"
#include "base/numbers/exact_sum.h"
#include "base/text/text.h"
#include "pipeline/filter/cancellable_tree.h"
#include "pipeline/filter/cells.h"
#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kCellsATime = 256;
constexpr std::size_t kFewest = 3;

int coefficients(int order) { return (order + 1) * (order + 2) / 2; }

/// Fits of a cell's points, whose neighbours are searched together.
class CellFitter {
 public:
  CellFitter(const Cloud& cloud, const scene::SmoothConfig& config)
      : cloud_(cloud), config_(config), limit_(static_cast<float>(config.radius_m * config.radius_m)) {}

  void fit(const CellOrder& order, std::size_t cell, const std::array<CellOrder::Range, 25>& ranges,
           std::vector<Eigen::Vector3f>& moved) {
    for (const CellOrder::Point& p : order.points(cell)) {
      near_.clear();
      for (const CellOrder::Range& range : ranges) {
        for (const CellOrder::Point& other : order.points(range)) {
          if (squared_distance(p, other) < limit_) near_.push_back(static_cast<pcl::index_t>(other.index));
        }
      }
      if (near_.size() < kFewest) continue;
      result_.computeMLSSurface<pcl::PointXYZ>(*cloud_.points, static_cast<pcl::index_t>(p.index), near_,
                                               config_.radius_m, config_.order);
      moved[p.index] =
          result_.projectQueryPoint(pcl::MLSResult::SIMPLE, coefficients(config_.order)).point.cast<float>();
    }
  }

 private:
  const Cloud& cloud_;
  const scene::SmoothConfig& config_;
  float limit_;
  pcl::Indices near_;
  pcl::MLSResult result_;
};

/// Throws when neighbourhoods are so large that the fits would take hours.
void require_few_neighbours(const CellOrder& order, const scene::SmoothConfig& config) {
  constexpr double kMost = 20000.0;
  double sum = 0.0;
  CellOrder::Sweep sweep(order);
  for (std::size_t cell = 0; cell < order.cells(); ++cell) {
    std::size_t near = 0;
    for (const CellOrder::Range& range : sweep.near(cell)) near += order.points(range).size();
    sum += static_cast<double>(near) * static_cast<double>(order.points(cell).size());
  }
  const double mean = sum / static_cast<double>(order.points().size());
  if (mean <= kMost) return;
  // The sphere of a surface is about 0.38 of the cells' part of it.
  throw usage_error(fmt::format("the filter 'smooth' would fit about {:.0f} points at a time within {}", 0.38 * mean,
                                length_text(config.radius_m)),
                    "a smaller radius_mm (four to five point distances), or a voxel filter before it");
}

void fit_by_cells(const Cloud& cloud, const scene::SmoothConfig& config, const Context& context,
                  const std::function<void(double)>& at, std::vector<Eigen::Vector3f>& moved) {
  const CellOrder order(cloud, config.radius_m, context);
  require_few_neighbours(order, config);
  std::mutex telling;
  std::size_t done = 0;
  context.pool.for_ranges(order.cells(), kCellsATime, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    CellOrder::Sweep sweep(order);
    CellFitter fitter(cloud, config);
    for (std::size_t cell = begin; cell < end; ++cell) {
      context.progress.throw_if_cancelled();
      fitter.fit(order, cell, sweep.near(cell), moved);
    }
    const std::lock_guard lock(telling);
    done += end - begin;
    if (at) at(static_cast<double>(done) / static_cast<double>(order.cells()));
  });
}

void fit_by_pcl(const Cloud& cloud, const scene::SmoothConfig& config, const Progress& progress,
                std::vector<Eigen::Vector3f>& moved) {
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointXYZ> fitter;
  fitter.setInputCloud(cloud.points);
  fitter.setSearchMethod(cancellable_tree(progress));
  fitter.setSearchRadius(config.radius_m);
  fitter.setPolynomialOrder(config.order);
  fitter.setProjectionMethod(pcl::MLSResult::SIMPLE);
  fitter.setCacheMLSResults(false);
  pcl::PointCloud<pcl::PointXYZ> fitted;
  fitter.process(fitted);
  // It leaves out points with few neighbours.
  const pcl::Indices& indices = fitter.getCorrespondingIndices()->indices;
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    moved[static_cast<std::size_t>(indices[k])] = fitted[k].getVector3fMap();
  }
}

}  // namespace

Smoothing smooth_points(Cloud& cloud, const scene::SmoothConfig& config, const Context& context,
                        const std::function<void(double)>& at) {
  const Eigen::Vector3f none = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  std::vector<Eigen::Vector3f> moved(cloud.size(), none);
  if (config.method == scene::SmoothConfig::Method::pcl) {
    fit_by_pcl(cloud, config, context.progress, moved);
  } else {
    fit_by_cells(cloud, config, context, at, moved);
  }
  const bool first = cloud.measured.empty();
  if (first) cloud.measured.reserve(cloud.size());
  Smoothing smoothing;
  ExactSum squares;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Eigen::Map<Eigen::Vector3f> point(cloud.xyz1() + 4 * i);
    if (first) cloud.measured.emplace_back(point);
    const double away = (moved[i].cast<double>() - point.cast<double>()).norm();
    if (!(away <= config.radius_m)) {  // also when it is not a number
      ++smoothing.unmoved;
      continue;
    }
    point = moved[i];
    squares.add(static_cast<double>(static_cast<float>(away * away)));
    smoothing.most_m = std::max(smoothing.most_m, away);
  }
  const double fitted = static_cast<double>(cloud.size() - smoothing.unmoved);
  if (fitted > 0.0) smoothing.rms_m = std::sqrt(squares.value() / fitted);
  return smoothing;
}

}  // namespace sparsha::pipeline

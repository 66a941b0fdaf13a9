// The one file that instantiates PCL's SampleConsensusPrerejective: its features' tree, prerejection and estimate of
// motion. Samples are drawn here, since PCL draws them by rand(), and more than one result is kept.
#include "pipeline/register/prerejective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/sample_consensus_prerejective.h>

#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {
namespace {

using Point = pcl::PointNormal;
using PclCloud = pcl::PointCloud<Point>;
using Signatures = pcl::PointCloud<pcl::FPFHSignature33>;
using Base = pcl::SampleConsensusPrerejective<Point, Point, pcl::FPFHSignature33>;

constexpr int kSimilar = 6;              // target's descriptors among which a place's own is looked for
constexpr float kEdgeSimilarity = 0.9F;  // of edge lengths of a sample
constexpr double kLeastCosine = 0.8;     // between normals of one place
constexpr int kQuick = 150;              // places that a sample is tried on first
constexpr double kQuickShare = 0.5;      // of the worst kept guess's inliers, below which the rest is not tried

PclCloud::Ptr cloud_of(const ScanFeatures& features, double unit_m) {
  auto cloud = std::make_shared<PclCloud>();
  for (std::size_t i = 0; i < features.points.size(); ++i) {
    Point p;
    p.getVector3fMap() = (features.points[i] / unit_m).cast<float>();
    p.getNormalVector3fMap() = features.normals[i].cast<float>();
    cloud->push_back(p);
  }
  return cloud;
}

Signatures::Ptr signatures_of(const ScanFeatures& features) {
  auto cloud = std::make_shared<Signatures>();
  for (const Descriptor& descriptor : features.descriptors) {
    pcl::FPFHSignature33 signature;
    std::copy(descriptor.begin(), descriptor.end(), signature.histogram);
    cloud->push_back(signature);
  }
  return cloud;
}

Eigen::Isometry3d rigid(const Eigen::Matrix4f& matrix) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>().cast<double>();
  pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>().cast<double>();
  return pose;
}

class SeededPrerejective : public Base {
 public:
  SeededPrerejective(const GuessLimits& limits, const Progress& progress)
      : limits_(limits), progress_(progress), random_(limits.seed) {}

  [[nodiscard]] const std::vector<PoseGuess>& guesses() const { return guesses_; }

 protected:
  void computeTransformation(PointCloudSource& /*output*/, const Matrix4& guess) override {
    constexpr int kCancelEvery = 1024;
    final_transformation_ = guess;
    find_similar();
    for (const Point& p : *input_) middle_ += p.getVector3fMap().cast<double>();
    middle_ /= static_cast<double>(input_->size());
    order_.resize(input_->size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
    for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[below(i)]);
    correspondence_rejector_poly_->setInputSource(input_);
    correspondence_rejector_poly_->setInputTarget(target_);
    correspondence_rejector_poly_->setCardinality(3);
    correspondence_rejector_poly_->setSimilarityThreshold(kEdgeSimilarity);
    for (int k = 0; k < limits_.samples; ++k) {
      if (k % kCancelEvery == 0) progress_.throw_if_cancelled();
      draw();
    }
    converged_ = !guesses_.empty();
  }

 private:
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }

  void find_similar() {
    similar_.resize(input_->size());
    std::vector<float> distances2;
    for (std::size_t i = 0; i < similar_.size(); ++i) {
      feature_tree_->nearestKSearch(*input_features_, static_cast<int>(i), kSimilar, similar_[i], distances2);
    }
  }

  // Three places of the source that lie apart, and for each one of the places of the target that look like it.
  void draw() {
    pcl::Indices from(3);
    pcl::Indices to(3);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = below(input_->size());
      from[k] = static_cast<pcl::index_t>(i);
      to[k] = similar_[i][below(similar_[i].size())];
      for (std::size_t j = 0; j < k; ++j) {
        const auto edge = (*input_)[i].getVector3fMap() - at(*input_, from[j]).getVector3fMap();
        if (static_cast<double>(edge.norm()) < limits_.least_m / limits_.touch_m || to[j] == to[k]) return;
      }
    }
    if (!correspondence_rejector_poly_->thresholdPolygon(from, to)) return;
    transformation_estimation_->estimateRigidTransformation(*input_, from, *target_, to, transformation_);
    if (!transformation_.allFinite()) return;
    const Eigen::Matrix3f turn = transformation_.topLeftCorner<3, 3>();
    for (std::size_t k = 0; k < 3; ++k) {
      const float cosine =
          (turn * at(*input_, from[k]).getNormalVector3fMap()).dot(at(*target_, to[k]).getNormalVector3fMap());
      if (static_cast<double>(cosine) < kLeastCosine) return;
    }
    keep(transformation_);
  }

  static const Point& at(const PclCloud& cloud, pcl::index_t index) { return cloud[static_cast<std::size_t>(index)]; }

  // Share of the places that meet one of the target with a similar normal; 0 when too few of the first of them do.
  [[nodiscard]] double inliers(const Matrix4& pose, double worst) {
    const Eigen::Matrix3f turn = pose.topLeftCorner<3, 3>();
    const Eigen::Vector3f shift = pose.topRightCorner<3, 1>();
    std::size_t count = 0;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k == kQuick && static_cast<double>(count) < kQuickShare * worst * kQuick) return 0.0;
      const Point& p = (*input_)[order_[k]];
      Point moved;
      moved.getVector3fMap() = turn * p.getVector3fMap() + shift;
      if (tree_->radiusSearch(moved, 1.0, near_, distances2_, 1) < 1) continue;
      const float cosine = (turn * p.getNormalVector3fMap()).dot(at(*target_, near_[0]).getNormalVector3fMap());
      if (static_cast<double>(cosine) >= kLeastCosine) ++count;
    }
    return static_cast<double>(count) / static_cast<double>(order_.size());
  }

  void keep(const Matrix4& pose) {
    const bool full = guesses_.size() >= limits_.most;
    PoseGuess guess;
    guess.inliers = inliers(pose, full ? guesses_.back().inliers : 0.0);
    if (guess.inliers <= 0.0 || (full && guess.inliers <= guesses_.back().inliers)) return;
    guess.pose = rigid(pose);
    for (auto other = guesses_.begin(); other != guesses_.end(); ++other) {
      if (!nearly_same(other->pose, guess.pose, middle_, limits_.apart_m / limits_.touch_m)) continue;
      if (other->inliers >= guess.inliers) return;
      guesses_.erase(other);
      break;
    }
    const auto place = std::find_if(guesses_.begin(), guesses_.end(),
                                    [&](const PoseGuess& other) { return other.inliers < guess.inliers; });
    guesses_.insert(place, guess);
    if (guesses_.size() > limits_.most) guesses_.pop_back();
  }

  const GuessLimits& limits_;
  const Progress& progress_;
  std::mt19937_64 random_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  std::vector<pcl::Indices> similar_;
  std::vector<std::size_t> order_;
  std::vector<PoseGuess> guesses_;
  pcl::Indices near_;
  std::vector<float> distances2_;
};

}  // namespace

bool nearly_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const Eigen::Vector3d& middle,
                 double distance_m) {
  constexpr double kTurn = 20.0 * 3.14159265358979323846 / 180.0;
  if ((a * middle - b * middle).norm() > distance_m) return false;
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle() < kTurn;
}

std::vector<PoseGuess> guess_pair(const ScanFeatures& source, const ScanFeatures& target, const GuessLimits& limits,
                                  const Progress& progress) {
  if (source.points.size() < 3 || target.points.size() < 3) return {};
  SeededPrerejective search(limits, progress);
  search.setInputSource(cloud_of(source, limits.touch_m));
  search.setInputTarget(cloud_of(target, limits.touch_m));
  search.setSourceFeatures(signatures_of(source));
  search.setTargetFeatures(signatures_of(target));
  PclCloud aligned;
  search.align(aligned);
  std::vector<PoseGuess> result = search.guesses();
  for (PoseGuess& guess : result) guess.pose.translation() *= limits.touch_m;
  return result;
}

std::size_t mutual_matches(const ScanFeatures& a, const ScanFeatures& b) {
  if (a.points.empty() || b.points.empty()) return 0;
  const Signatures::Ptr of_a = signatures_of(a);
  const Signatures::Ptr of_b = signatures_of(b);
  pcl::KdTreeFLANN<pcl::FPFHSignature33> in_a;
  pcl::KdTreeFLANN<pcl::FPFHSignature33> in_b;
  in_a.setInputCloud(of_a);
  in_b.setInputCloud(of_b);
  pcl::Indices there;
  pcl::Indices back;
  std::vector<float> distances2;
  std::size_t count = 0;
  for (std::size_t i = 0; i < of_a->size(); ++i) {
    if (in_b.nearestKSearch((*of_a)[i], 1, there, distances2) < 1) continue;
    if (in_a.nearestKSearch((*of_b)[static_cast<std::size_t>(there[0])], 1, back, distances2) < 1) continue;
    if (static_cast<std::size_t>(back[0]) == i) ++count;
  }
  return count;
}

}  // namespace sparsha::pipeline

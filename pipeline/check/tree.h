// FLANN's kd-tree through PCL; the one place of the cross-check that sees PCL.
#pragma once

#include <memory>
#include <span>
#include <vector>

namespace sparsha::pipeline {

/// Immutable; queries are thread-safe. Metres, any frame.
class PointTree {
 public:
  /// `xyz` holds x y z of one point after the other.
  explicit PointTree(std::span<const float> xyz);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  [[nodiscard]] std::size_t size() const;

  /// Memory of one caller's queries, reused.
  struct Answer {
    std::vector<int> index;
    std::vector<float> squared_m2;
  };
  /// The nearest point; false when the tree is empty.
  bool nearest(float x, float y, float z, Answer& answer) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::pipeline

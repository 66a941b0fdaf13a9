// A binary little-endian PLY file written point by point, its count known at the end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

class PlyStream {
 public:
  struct Fields {
    bool double_precision = false;
    bool intensity = false;
    bool colour = false;
  };
  /// `shown` is the name in messages. Throws Error{failure} when the file cannot be written.
  PlyStream(const std::filesystem::path& file, std::string shown, const Fields& fields, const std::string& comment);

  /// Appends points, file = rotation^T * (position - origin).
  void append(std::span<const SimulatedPoint> points, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& origin_m);
  /// Writes the count into the header.
  void close();
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  [[nodiscard]] std::string header() const;
  void check();

  std::ofstream stream_;
  std::string shown_;
  Fields fields_;
  std::string comment_;
  std::uint64_t count_ = 0;
  std::vector<char> buffer_;
};

}  // namespace sparsha::pipeline

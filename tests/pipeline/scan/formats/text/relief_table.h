// A small relief that tests write as a text table, and what must be read of it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {

/// A small relief, as numbers of four decimals.
struct Relief {
  std::vector<std::array<std::string, 3>> texts;
  std::vector<Eigen::Vector3d> points;
  std::vector<int> ids;

  Relief() {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 8; ++i) {
        const double place[3] = {0.02 * i - 0.05, 0.02 * j + 0.0371, 0.003 * std::sin(i * 0.7 + j)};
        std::array<std::string, 3> text;
        Eigen::Vector3d point;
        for (std::size_t k = 0; k < 3; ++k) {
          text[k] = fmt::format("{:.4f}", place[k]);
          point[static_cast<Eigen::Index>(k)] = std::stod(text[k]);
        }
        texts.push_back(text);
        points.push_back(point);
        ids.push_back((i * 37 + j * 11) % 101 + 1);
      }
    }
  }

  using Row = std::function<std::string(std::size_t)>;
  /// x, y and z of a row, or in another order, with a separator between them.
  [[nodiscard]] std::string at(std::size_t k, const std::string& separator = " ",
                               const std::string& order = "xyz") const {
    std::string text;
    for (const char axis : order)
      text += (text.empty() ? "" : separator) + texts[k][static_cast<std::size_t>(axis - 'x')];
    return text;
  }
  [[nodiscard]] std::string table(const std::string& header, const Row& row) const {
    std::string text = header;
    for (std::size_t k = 0; k < points.size(); ++k) text += row(k) + "\n";
    return text;
  }
  /// Rows of an id, x, y and z.
  [[nodiscard]] std::string numbered(const std::string& header, const std::string& separator = " ",
                                     const std::string& order = "xyz") const {
    return table(header, [&](std::size_t k) { return std::to_string(ids[k]) + separator + at(k, separator, order); });
  }
};

inline RawScan read(const std::string& text, const std::string& name = "a.txt", const ReadOptions& options = {}) {
  return read_scan_bytes(text, name, options);
}

/// Reads a table and compares its points with the relief's.
inline RawScan expect_relief(const Relief& relief, const std::string& text, const std::string& name = "a.txt",
                             const ReadOptions& options = {}) {
  RawScan scan = read(text, name, options);
  EXPECT_EQ(scan.points, relief.points) << text.substr(0, 200);
  return scan;
}

}  // namespace sparsha::pipeline

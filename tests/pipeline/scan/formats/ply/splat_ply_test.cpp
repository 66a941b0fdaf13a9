// Gaussian splats in PLY: whatever other properties they have, in every encoding and in every pass the same are left
// out.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum class Body { ascii, little, big };

struct Form {
  Body body = Body::little;
  bool doubles = false;  ///< coordinates
  bool bytes = false;    ///< red, green and blue beside f_dc
  bool list = false;     ///< a list in each vertex
  int axes = 3;
};

struct Row {
  double x = 0.0, opacity = 3.0, axis = -4.0;  ///< opacity as a logit, the axis as a logarithm
};

/// Sixty on a parabola that are kept, and one of each kind that is no surface among them.
std::vector<Row> some_rows() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Row> rows;
  for (int i = 0; i < 60; ++i) rows.push_back({0.125 * i});
  rows.insert(rows.begin() + 20, {100.0, -3.0, -4.0});
  rows.insert(rows.begin() + 30, {101.0, 3.0, 1.0});
  rows.insert(rows.begin() + 40, {102.0, kNone, -4.0});
  rows.insert(rows.begin() + 50, {103.0, 3.0, kNone});
  return rows;
}

std::string splat_ply(const std::vector<Row>& rows, const Form& form) {
  const char* const format = form.body == Body::ascii    ? "ascii"
                             : form.body == Body::little ? "binary_little_endian"
                                                         : "binary_big_endian";
  std::string bytes = std::string("ply\nformat ") + format + " 1.0\nelement vertex " + std::to_string(rows.size());
  for (const char* const name : {"x", "y", "z"})
    bytes += std::string(form.doubles ? "\nproperty double " : "\nproperty float ") + name;
  if (form.bytes) bytes += "\nproperty uchar red\nproperty uchar green\nproperty uchar blue";
  if (form.list) bytes += "\nproperty list uchar uchar seen_by";
  for (const char* const name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity"})
    bytes += std::string("\nproperty float ") + name;
  for (int k = 0; k < form.axes; ++k) bytes += "\nproperty float scale_" + std::to_string(k);
  bytes += "\nend_header\n";
  const bool big = form.body == Body::big;
  const auto real = [&](double value, bool is_double) {
    if (form.body == Body::ascii) {
      bytes += std::to_string(value) + " ";
    } else if (is_double) {
      testing::put(bytes, value, big);
    } else {
      testing::put(bytes, static_cast<float>(value), big);
    }
  };
  const auto whole = [&](int value) {
    if (form.body == Body::ascii) {
      bytes += std::to_string(value) + " ";
    } else {
      testing::put(bytes, static_cast<std::uint8_t>(value));
    }
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const double value : {rows[i].x, rows[i].x * rows[i].x, 1.0}) real(value, form.doubles);
    if (form.bytes) {
      for (const int channel : {10, 20, 30}) whole(channel);
    }
    if (form.list) {
      const int length = static_cast<int>(i % 3);
      whole(length);
      for (int k = 0; k < length; ++k) whole(k);
    }
    for (const double value : {0.0, 0.0, 0.0, rows[i].opacity}) real(value, false);
    // The last axis is the longest, so that none may be forgotten.
    for (int k = 0; k < form.axes; ++k) real(k + 1 == form.axes ? rows[i].axis : -5.0, false);
    if (form.body == Body::ascii) bytes += "\n";
  }
  return bytes;
}

std::vector<Form> all_forms() {
  std::vector<Form> forms;
  for (const Body body : {Body::ascii, Body::little, Body::big}) {
    for (int bits = 0; bits < 8; ++bits) {
      for (const int axes : {1, 2, 3}) forms.push_back({body, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, axes});
    }
  }
  return forms;
}

void expect_the_good_ones(const std::vector<Eigen::Vector3d>& points) {
  ASSERT_EQ(points.size(), 60U);
  for (std::size_t i = 0; i < 60; ++i) {
    const double x = 0.125 * static_cast<double>(i);
    EXPECT_NEAR((points[i] - Eigen::Vector3d(x, x * x, 1.0)).norm(), 0.0, 1e-6) << i;
  }
}

TEST(SplatPly, EveryFormAndEveryPassLeavesOutTheSame) {
  for (const Form& form : all_forms()) {
    SCOPED_TRACE(::testing::Message() << "body " << static_cast<int>(form.body) << ", doubles " << form.doubles
                                      << ", bytes " << form.bytes << ", list " << form.list << ", axes " << form.axes);
    const testing::ScanFolder folder;
    const std::filesystem::path file = folder.write("a.ply", splat_ply(some_rows(), form));
    // A first pass counts what the fields say; the later ones ask for nothing more.
    ReadOptions uncounted;
    uncounted.tally = ReadOptions::Tally::none;
    ReadOptions filtered;
    filtered.fields = {"opacity"};
    for (const ReadOptions& options : {ReadOptions{}, uncounted, filtered}) {
      const RawScan scan = read_scan(file, nullptr, options);
      EXPECT_EQ(scan.records, 64U);
      EXPECT_EQ(scan.invalid, 4U);
      expect_the_good_ones(scan.points);
      EXPECT_THAT(scan.rgba, ::testing::Each(form.bytes ? 0xFF1E140AU : 0xFF808080U));
      EXPECT_THAT(scan.notes, Contains(HasSubstr("Gaussian splats")));
      EXPECT_THAT(scan.warnings,
                  ElementsAre(HasSubstr("4 of 64 splats are no surface and are counted as invalid: 1 have "
                                        "an opacity below 0.1, 1 an axis longer than 20 times the "
                                        "median's, 2 an opacity or an axis that is not a number")));
      if (options.fields.empty()) continue;
      ASSERT_EQ(scan.values.size(), 1U);
      EXPECT_THAT(scan.values[0], ::testing::Each(::testing::FloatNear(1.0F / (1.0F + std::exp(-3.0F)), 1e-6F)));
    }
    std::vector<Eigen::Vector3d> streamed;
    const auto keep = [&](const PointBlock& block) {
      streamed.insert(streamed.end(), block.points.begin(), block.points.end());
    };
    const RawScan scan = stream_scan(file, keep, nullptr, uncounted);
    EXPECT_EQ(scan.invalid, 4U);
    expect_the_good_ones(streamed);
  }
}

TEST(SplatPly, SplatsWithoutAxesOrOpacityAreSaidToBeUnsifted) {
  for (const bool binary : {false, true}) {
    const RawScan scan =
        read_scan_bytes(splat_ply(some_rows(), {binary ? Body::little : Body::ascii, false, true, false, 0}), "a.ply");
    EXPECT_EQ(scan.points.size(), 64U);
    EXPECT_THAT(scan.notes, Contains(HasSubstr("Gaussian splats")));
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("none of them is left out as no surface")));
  }
}

}  // namespace
}  // namespace sparsha::pipeline

// What a scan says of its points beside their places, colours and normals: classes, confidence, opacity, intensity, ...
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/files/message.h"

namespace sparsha::pipeline {

inline constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
inline constexpr const char* kIntensityField = "intensity";

/// The name by which a field is asked for: lower case, without blanks around it and CloudCompare's "scalar_";
/// "classification" for "class".
[[nodiscard]] std::string field_key(std::string_view name);

/// True for what tells of a point's worth by its name: classification, confidence, quality, opacity.
[[nodiscard]] bool tells_worth(std::string_view key);
/// True for coordinates, colours, normals and the shape of splats, which are known otherwise or are no single number.
[[nodiscard]] bool is_known_otherwise(std::string_view key);

/// How a field's values are distributed. Depends on the values alone, not on their order. Half a MB once it has one.
class FieldTally {
 public:
  explicit FieldTally(std::string name) : name_(std::move(name)) {}

  void add(std::span<const float> values);
  /// For another process, whose tally of other points of the field adds what it is told, and takes its name.
  void write(MessageWriter& message) const;
  void add(MessageReader& message);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t values() const { return values_; }    ///< points with one
  [[nodiscard]] std::uint64_t missing() const { return missing_; }  ///< points without
  [[nodiscard]] float least() const { return least_; }
  [[nodiscard]] float most() const { return most_; }
  [[nodiscard]] bool is_constant() const { return values_ == 0 || least_ == most_; }
  /// No value has a fraction.
  [[nodiscard]] bool is_whole() const { return whole_; }
  /// How many are this whole number, 0 to 255; of whole ones.
  [[nodiscard]] std::uint64_t count(int number) const;
  /// How many are below `border`, which is not negative. Exact for borders with no more than 8 binary digits, such as
  /// 0.5, 1 and 50; else values within 1 % below it may be missing.
  [[nodiscard]] std::uint64_t below(float border) const;
  /// The value of that rank, 0 to 1, within 1 %. There must be values.
  [[nodiscard]] float quantile(double rank) const;

 private:
  std::string name_;
  std::vector<std::uint64_t> counts_;  ///< by the first 16 bits of a value
  std::uint64_t values_ = 0, missing_ = 0;
  float least_ = std::numeric_limits<float>::infinity();
  float most_ = -std::numeric_limits<float>::infinity();
  bool whole_ = true;
};

struct ValueCount {
  int value = 0;
  std::uint64_t count = 0;
};
/// The values of a field of at most 16 different ones, whole numbers from 0 to 255; else none.
[[nodiscard]] std::vector<ValueCount> few_values(const FieldTally& tally);

/// The name of a LAS class, e.g. "high noise"; empty where the standard gives it none.
[[nodiscard]] std::string_view las_class_name(int number);

}  // namespace sparsha::pipeline

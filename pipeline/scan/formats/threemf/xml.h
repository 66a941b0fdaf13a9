// Elements of an XML text one after another, without a tree: texts of meshes are long.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/scan/file.h"

namespace sparsha::pipeline {

/// Gives start and end tags; skips texts, remarks, instructions and declarations. Names come without their prefix.
/// Entities within values stay as they are written.
class XmlTags {
 public:
  XmlTags(const ScanFile& file, std::string_view text) : file_(file), text_(text) {}

  /// Goes to the next tag; false at the end. Throws Error{input} with the line when a tag breaks off.
  bool next();
  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] bool opens() const { return opens_; }
  /// An element without content opens and closes at once.
  [[nodiscard]] bool closes() const { return closes_; }
  /// Of a start tag.
  [[nodiscard]] std::optional<std::string_view> value(std::string_view attribute) const;
  /// What the prefix stands for, by the last declaration so far.
  [[nodiscard]] std::optional<std::string_view> namespace_of(std::string_view prefix) const;
  /// Throws Error{input} with the line when it is missing or no number.
  [[nodiscard]] double number(std::string_view attribute) const;
  [[nodiscard]] int line() const;
  [[nodiscard]] Error error(std::string wrong, std::string expected) const;

 private:
  bool skip_to(std::string_view mark);
  void read_attributes(std::string_view tag);

  const ScanFile& file_;
  std::string_view text_;
  std::size_t at_ = 0, tag_ = 0;
  std::string_view name_;
  bool opens_ = false, closes_ = false;
  std::vector<std::pair<std::string_view, std::string_view>> attributes_;
  std::vector<std::pair<std::string_view, std::string_view>> namespaces_;  ///< by prefix
};

}  // namespace sparsha::pipeline

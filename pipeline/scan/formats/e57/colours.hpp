// Limits of an E57 scan's colours: what its XML states, its fields' types allow and its values tell.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <pugixml.hpp>

#include "pipeline/scan/formats/e57/pictures.hpp"
#include "pipeline/scan/formats/e57/points.h"

namespace sparsha::pipeline::e57 {

class ColourLimits {
 public:
  ColourLimits() = default;
  /// Of the fields of red, green and blue; `limits` is colorLimits or no node.
  ColourLimits(const std::array<const Field*, 3>& channels, const pugi::xml_node& limits, const NumberOf& number_of);

  /// Whether values may say other limits: they may exceed these, or be bytes in wider integers.
  [[nodiscard]] bool are_open() const { return may_exceed() || may_be_bytes(); }
  /// Looks at the channels of one point; false when no further value changes the limits.
  bool look(const std::array<double, 3>& values);
  /// Takes what the values that were looked at tell. Gives what is to be said of it.
  std::optional<std::string> settle();

  [[nodiscard]] std::uint32_t rgba(const std::array<double, 3>& values) const;

 private:
  [[nodiscard]] bool may_exceed() const;
  [[nodiscard]] bool may_be_bytes() const;
  void set(double high);

  std::array<double, 3> low_{}, high_{};
  std::array<double, 3> most_{};     ///< that the fields' types can have
  std::array<double, 3> largest_{};  ///< of the values that were looked at
  bool whole_ = false, stated_ = false;
};

}  // namespace sparsha::pipeline::e57

// Keys from the bytes that a terminal sends, whatever it sends for arrows and the number pad.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sparsha::app {

struct TypedKey {
  enum class Kind { letter, up, down, left, right, home, end, page_up, page_down, middle, insert };
  Kind kind = Kind::letter;
  char letter = 0;  ///< ASCII, as typed
  friend bool operator==(const TypedKey&, const TypedKey&) = default;
};

/// Sequences may come in pieces, as over a slow line. Keys that are none of the above are skipped, and so are letters
/// outside ASCII, in any encoding.
class TypedKeys {
 public:
  /// What has been typed by `time_s`.
  [[nodiscard]] std::vector<TypedKey> take(std::string_view typed, double time_s);

 private:
  std::string begun_;  // an escape sequence without its end
  double begun_s_ = 0.0;
};

}  // namespace sparsha::app

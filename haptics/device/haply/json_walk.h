// Reads JSON (RFC 8259) as it stands, without allocation: each value is told with its path.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace sparsha::haptics::haply {

/// Where a value stands. Keys are as written, escapes included.
class JsonPath {
 public:
  static constexpr std::size_t kDeepest = 16;
  struct Step {
    std::string_view key;   ///< of an object
    std::size_t index = 0;  ///< of an array's element
  };
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const Step& operator[](std::size_t i) const noexcept { return steps_[i]; }
  /// True when the keys from `first` on are these and no more follow.
  template <typename... Keys>
  [[nodiscard]] bool ends_from(std::size_t first, Keys... keys) const noexcept {
    if (size_ != first + sizeof...(keys)) return false;
    std::size_t at = first;
    return ((steps_[at++].key == std::string_view(keys)) && ...);
  }

 private:
  template <typename Visitor>
  friend class JsonWalk;
  std::array<Step, kDeepest> steps_{};
  std::size_t size_ = 0;
};

struct JsonValue {
  enum class Kind : unsigned char { number, text, boolean, null, object, array };
  Kind kind = Kind::null;
  double number = 0.0;
  bool boolean = false;
  std::string_view text;  ///< as written, without its quotes
};

/// `visitor(path, value)` is called for each value, for objects and arrays at their beginning.
template <typename Visitor>
class JsonWalk {
 public:
  JsonWalk(std::string_view text, Visitor& visitor) noexcept : text_(text), visitor_(visitor) {}
  /// False when the text is not JSON, or deeper than kDeepest; the visitor has then seen what stands before.
  [[nodiscard]] bool run() noexcept {
    if (!value()) return false;
    blanks();
    return at_ == text_.size();
  }

 private:
  [[nodiscard]] bool end() const noexcept { return at_ >= text_.size(); }
  void blanks() noexcept {
    while (!end() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) ++at_;
  }
  [[nodiscard]] bool take(char wanted) noexcept {
    if (end() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] bool take_word(std::string_view word) noexcept {
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }
  [[nodiscard]] bool text(std::string_view& found) noexcept {
    if (!take('"')) return false;
    const std::size_t begin = at_;
    while (!end() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) return false;
      at_ += text_[at_] == '\\' ? 2 : 1;
    }
    if (end()) return false;
    found = text_.substr(begin, at_ - begin);
    return take('"');
  }
  // What from_chars takes and JSON does not: inf, nan, a point without a digit before or after, a zero before others.
  [[nodiscard]] bool number(double& found) noexcept {
    const auto digit = [this](std::size_t at) { return at < text_.size() && text_[at] >= '0' && text_[at] <= '9'; };
    const std::size_t first = at_ + (text_[at_] == '-' ? 1 : 0);
    if (!digit(first) || (text_[first] == '0' && digit(first + 1))) return false;
    const auto [stop, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), found);
    if (error != std::errc()) return false;
    at_ = static_cast<std::size_t>(stop - text_.data());
    return text_[at_ - 1] != '.' && std::isfinite(found);
  }
  [[nodiscard]] bool enter() noexcept {
    if (path_.size_ == JsonPath::kDeepest) return false;
    path_.steps_[path_.size_++] = {};
    return true;
  }
  [[nodiscard]] bool object() noexcept {
    if (!take('{') || !enter()) return false;
    blanks();
    if (!take('}')) {
      do {
        blanks();
        std::string_view key;
        if (!text(key)) return false;
        blanks();
        if (!take(':')) return false;
        path_.steps_[path_.size_ - 1] = {key, 0};
        if (!value()) return false;
        blanks();
      } while (take(','));
      if (!take('}')) return false;
    }
    --path_.size_;
    return true;
  }
  [[nodiscard]] bool array() noexcept {
    if (!take('[') || !enter()) return false;
    blanks();
    if (!take(']')) {
      std::size_t index = 0;
      do {
        path_.steps_[path_.size_ - 1] = {{}, index++};
        if (!value()) return false;
        blanks();
      } while (take(','));
      if (!take(']')) return false;
    }
    --path_.size_;
    return true;
  }
  [[nodiscard]] bool value() noexcept {
    blanks();
    if (end()) return false;
    JsonValue found;
    using Kind = JsonValue::Kind;
    const char first = text_[at_];
    bool right = true;
    if (first == '{' || first == '[') {
      found.kind = first == '{' ? Kind::object : Kind::array;
      visitor_(path_, found);
      return first == '{' ? object() : array();
    }
    if (first == '"') {
      found.kind = Kind::text;
      right = text(found.text);
    } else if (first == 't' || first == 'f') {
      found.kind = Kind::boolean;
      found.boolean = first == 't';
      right = take_word(found.boolean ? "true" : "false");
    } else if (first == 'n') {
      right = take_word("null");
    } else {
      found.kind = Kind::number;
      right = number(found.number);
    }
    if (right) visitor_(path_, found);
    return right;
  }

  std::string_view text_;
  Visitor& visitor_;
  JsonPath path_;
  std::size_t at_ = 0;
};

template <typename Visitor>
[[nodiscard]] bool walk_json(std::string_view text, Visitor&& visitor) noexcept {
  return JsonWalk<std::remove_reference_t<Visitor>>(text, visitor).run();
}

}  // namespace sparsha::haptics::haply

// What is said to visitors, by keys, in each language that there are texts for (configs/speech).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/phrases/phrase_keys.h"

namespace sparsha {

/// A key of the texts. A literal that is none does not compile.
class Phrase {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): say("unplugged") is the purpose
  consteval Phrase(const char* key) : index_(index_of(key)) {
    if (index_ == kPhraseKeys.size()) throw "no such key in base/phrases/phrase_keys.h";
  }
  /// Of a key that is known at run time only (what a device advises); empty for one that is none.
  [[nodiscard]] static std::optional<Phrase> find(std::string_view key);

  [[nodiscard]] constexpr std::string_view key() const { return kPhraseKeys[index_].name; }
  [[nodiscard]] constexpr std::size_t index() const { return index_; }

 private:
  struct Known {};
  constexpr Phrase(Known, std::size_t index) : index_(index) {}
  [[nodiscard]] static constexpr std::size_t index_of(std::string_view key) {
    std::size_t index = 0;
    while (index < kPhraseKeys.size() && kPhraseKeys[index].name != key) ++index;
    return index;
  }
  std::size_t index_;
};

/// What stands for the names in braces.
using PhraseValues = std::vector<std::pair<std::string_view, std::string>>;

/// The texts of one language. Immutable.
class Phrases {
 public:
  /// Built into the program. Throws Error{usage} that names the languages there are.
  [[nodiscard]] static Phrases of(std::string_view language);
  /// "en", "hi", ...
  [[nodiscard]] static std::vector<std::string> languages();
  /// A YAML map of texts. Throws Error{usage} with line and column for a key that is missing or unknown, and for a text
  /// whose names in braces are not those of its key.
  [[nodiscard]] static Phrases parse(std::string_view yaml, const std::string& file);

  /// Values are put in as they are. Names without a value stay in braces.
  [[nodiscard]] std::string text(Phrase phrase, const PhraseValues& values = {}) const;
  /// The text of a key, or, when there is no such key, what was asked for.
  [[nodiscard]] std::string text_or(std::string_view key) const;
  /// "12 centimetres": whole numbers of the unit that people would use.
  [[nodiscard]] std::string distance(double metres) const;
  /// The same for what may be less than a millimetre: "0.3 millimetres".
  [[nodiscard]] std::string height(double metres) const;

 private:
  Phrases() = default;
  std::array<std::string, kPhraseKeys.size()> texts_;
};

/// Names in braces, in the text's order.
[[nodiscard]] std::vector<std::string> placeholders(std::string_view text);

}  // namespace sparsha

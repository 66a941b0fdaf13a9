// Every key of the configuration with its values, unit, default and one sentence: what the JSON schema, the reference
// in docs/configuration.md, the man page and `sparsha config keys` are made of. The readers in scene/config do not use
// it; a test puts each row to them (tests/scene/keys), so that the two cannot disagree.
#pragma once

#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace sparsha::scene {

/// One kind of value that a key takes.
struct Form {
  enum class Kind {
    nothing,  ///< the block with all its defaults: "fill:"
    block,    ///< the keys below
    list,     ///< of `least` to `most` blocks; 0: no limit
    number,   ///< least to most
    whole,    ///< least to most
    toggle,   ///< true, on, yes; false, off, no
    text,
    file,     ///< a path, relative to the configuration
    word,     ///< one of `words`
    words,    ///< a list of them, `least` or more
    wholes,   ///< a list of one whole number or more, each from least to most
    numbers,  ///< a list of `least` numbers
    matrix,   ///< 16 numbers row by row, or four lists of four
    points,   ///< a list of [x, y], `least` to `most` of them
    places    ///< a list of [x, y, z], likewise
  };
  Kind kind = Kind::text;
  double least = 0.0;
  double most = 0.0;
  std::vector<std::string_view> words{};
  std::string_view pattern{};  ///< of a text or file: a regular expression that matches somewhere in it; empty: any
};

/// Where a number has no limit that a reader would name: 1e-12 and 1e12 are there to catch slips.
constexpr double kNoLeast = 1e-12;
constexpr double kNoMost = 1e12;

struct Key {
  std::string_view path;    ///< "grid.size"; of what stands in a list "scans[].units"
  std::vector<Form> forms;  ///< one of them
  std::string_view unit;    ///< "mm"; empty: none
  std::string_view absent;  ///< what its absence means, as YAML; empty: the sentence says it, or nothing is there then
  std::string_view sentence;
  bool required = false;
};

/// How many of some keys of one block may be there.
struct Choice {
  enum class Rule { at_most_one, just_one, at_least_one };
  std::string_view block;
  Rule rule = Rule::at_most_one;
  std::vector<std::string_view> keys;
};

/// A key that means something beside another one alone, of any value or of one.
struct Company {
  std::string_view block;
  std::string_view key;
  std::string_view other;
  std::string_view key_is{};        ///< of this value alone it needs the other; empty: always
  std::string_view other_is{};      ///< the other has this value; empty: any
  std::string_view other_is_not{};  ///< the other has not this value
};

/// What keys of two blocks have to do with each other.
struct Relation {
  enum class Rule { excludes, needs };
  std::string_view path;
  Rule rule = Rule::excludes;
  std::string_view other;  ///< of no list
  int numbers = 0;         ///< only where `path` is a list of so many numbers, its longest form; 0: always
  /// Only where `path` is this word, and then in configuration files alone: a scene's may have lost what it needs.
  std::string_view word{};
};

/// In the order of docs/configuration.md: a block stands before its keys.
[[nodiscard]] std::span<const Key> config_keys();
[[nodiscard]] std::span<const Choice> config_choices();
[[nodiscard]] std::span<const Company> config_company();
[[nodiscard]] std::span<const Relation> config_relations();

/// The keys of a block: those of "grid" are "grid.size" and so on; those of "scans[]" "scans[].file". "" is the root.
[[nodiscard]] std::vector<const Key*> keys_of(std::string_view block);
/// "grid" of "grid.size", "scans[]" of "scans[].file", "" of "scans".
[[nodiscard]] std::string_view block_of(std::string_view path);
/// "size" of "grid.size".
[[nodiscard]] std::string_view name_of(std::string_view path);
/// The row of that path or null.
[[nodiscard]] const Key* find_key(std::string_view path);
/// The form of that kind or null.
[[nodiscard]] const Form* form_of(const Key& key, Form::Kind kind);

}  // namespace sparsha::scene

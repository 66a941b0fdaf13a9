// A YAML document as plain values with the place of every key and scalar, and a reader of maps that names
// unknown, duplicate and misspelt keys. yaml-cpp parses; it stays behind this header.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sparsha::yaml {

struct Node;

struct Entry;

/// One value. Scalars keep their text; numbers are converted when asked for.
struct Node {
  enum class Kind { null, scalar, sequence, map };
  Kind kind = Kind::null;
  Place place;
  std::string scalar;
  bool quoted = false;
  std::vector<Node> items;     ///< of a sequence
  std::vector<Entry> entries;  ///< of a map, in the file's order

  [[nodiscard]] bool is_map() const { return kind == Kind::map; }
  [[nodiscard]] bool is_sequence() const { return kind == Kind::sequence; }
  [[nodiscard]] bool is_scalar() const { return kind == Kind::scalar; }
  /// The entry of that key or null.
  [[nodiscard]] const Node* find(std::string_view key) const;
};

struct Entry {
  std::string key;
  Place place;
  Node value;
};

/// Parses one document. Throws Error{usage} with line and column on bad syntax, duplicate keys, anchors that expand
/// without end, more than 1 MB of text or 100 levels.
[[nodiscard]] Node parse_text(std::string_view text, const std::string& name);
[[nodiscard]] Node parse_file(const std::filesystem::path& file);

/// Conversions; throw Error{usage} at the node's place. Numbers must be finite.
[[nodiscard]] double to_double(const Node& node);
[[nodiscard]] std::int64_t to_integer(const Node& node);
[[nodiscard]] bool to_bool(const Node& node);
[[nodiscard]] std::string to_text(const Node& node);
[[nodiscard]] std::vector<double> to_doubles(const Node& node, std::size_t count);

/// Error{usage} at a node.
[[nodiscard]] Error error_at(const Node& node, std::string wrong, std::string expected = {});

/// Reads a map key by key; finish() refuses every key that was not asked for and names the nearest one.
class MapReader {
 public:
  /// `what` names the map in messages, e.g. "friction". Throws when the node is not a map.
  MapReader(const Node& node, std::string what, const std::string& expected = "a block of keys");

  /// The value or null; marks the key as known.
  const Node* optional(std::string_view key);
  /// Throws when the key is absent.
  const Node& required(std::string_view key);

  /// Overwrites `value` when the key is present. The ranges are inclusive.
  void read(std::string_view key, double& value, double low, double high);
  void read(std::string_view key, int& value, int low, int high);
  void read(std::string_view key, bool& value);
  void read(std::string_view key, std::string& value);
  /// One of `names`, by index.
  void read_choice(std::string_view key, int& index, const std::vector<std::string>& names);
  template <std::size_t N>
  void read(std::string_view key, std::array<double, N>& values) {
    if (const Node* node = optional(key)) {
      const std::vector<double> numbers = to_doubles(*node, N);
      for (std::size_t i = 0; i < N; ++i) values[i] = numbers[i];
    }
  }

  /// Throws Error{usage} on the first unknown key.
  void finish() const;

 private:
  const Node& node_;
  std::string what_;
  std::vector<std::string> known_;
};

/// The name in `names` nearest to `word` by edit distance, or empty when none is near.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& names);

/// Sets `path` ("grid.size", "scans.0.units") to the YAML value `text`, creating maps on the way. Used by --set.
void set(Node& root, std::string_view path, std::string_view text);
/// The same from "grid.size=800". Throws Error{usage} without '='.
void set(Node& root, std::string_view setting);

}  // namespace sparsha::yaml

// yaml-cpp's event parser builds our own tree, so that every key keeps its mark and duplicates are seen.
#include "base/yaml/yaml.h"

#include <yaml-cpp/anchor.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/files/files.h"
#include "base/text/base64.h"
#include "base/text/lower_case.h"

namespace sparsha::yaml {
namespace {

constexpr const char* kClosed = "a word; in a line before, '}' or ']' may be missing";
constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::size_t kMaxDepth = 100;
constexpr std::size_t kMaxNodes = 1 << 18;

Place place_of(const std::string& name, const YAML::Mark& mark) { return {name, mark.line + 1, mark.column + 1}; }

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

bool is_indented_by_tab(std::string_view line) {
  return line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string_view::npos &&
         line.find_first_not_of(" \t\r") != std::string_view::npos;
}

/// "  - units: m" begins as a line of a block does, "of 1903: a bust" does not.
bool begins_as_key(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" -");
  if (first == std::string_view::npos) return false;
  line.remove_prefix(first);
  const std::size_t end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789");
  return end != 0 && end != std::string_view::npos && line[end] == ':' &&
         (end + 1 == line.size() || line[end + 1] == ' ' || line[end + 1] == '\r');
}

/// Throws where the text in quotes that begins at `mark` goes on over lines that begin as keys: its last quote is
/// missing, and another one, far below, took its place.
void require_closing_quote(const std::vector<std::string_view>& lines, const std::string& name,
                           const YAML::Mark& mark) {
  auto line = static_cast<std::size_t>(mark.line);
  if (mark.line < 0 || line >= lines.size()) return;
  auto at = static_cast<std::size_t>(mark.column);
  if (at >= lines[line].size() || (lines[line][at] != '"' && lines[line][at] != '\'')) return;
  const char quote = lines[line][at];
  ++at;
  while (line < lines.size()) {
    for (; at < lines[line].size(); ++at) {
      if (quote == '"' && lines[line][at] == '\\') {
        ++at;
      } else if (lines[line][at] == quote) {
        if (quote == '"' || at + 1 >= lines[line].size() || lines[line][at + 1] != quote) return;
        ++at;
      }
    }
    at = 0;
    if (++line < lines.size() && begins_as_key(lines[line]))
      throw Error(ErrorKind::usage, place_of(name, mark),
                  "the text in quotes goes on into line " + std::to_string(line + 1) + ", which begins with a key",
                  "a quote at the end of the text, in line " + std::to_string(mark.line + 1));
  }
}

/// What was expected where yaml-cpp found `message`; lines are counted from 0.
std::string expected_for(const std::string& message, const std::vector<std::string_view>& lines, int line) {
  const auto says = [&](const char* words) { return message.find(words) != std::string::npos; };
  if (line >= 0 && static_cast<std::size_t>(line) < lines.size() &&
      is_indented_by_tab(lines[static_cast<std::size_t>(line)]))
    return "blanks at the beginning of the line instead of a tab";
  if (says("sequence flow")) return "']' where the list ends, and ',' between its entries";
  if (says("map flow")) return "'}' where the block ends, and ',' between its keys";
  if (says("escape") || says("hex number"))
    return "single quotes around a text with backslashes, e.g. 'C:\\scans\\statue.ply'";
  if (says("EOF in scalar")) return "a quote at the end of the text";
  if (says("illegal map value")) return "keys below each other with the same indent; a text with ': ' in quotes";
  if (says("end of map") || says("end of sequence") || says("block entry"))
    return "the keys or dashes of one block below each other, with the same indent";
  return "keys and values as in docs/configuration.md";
}

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string name, const std::vector<std::string_view>& lines) : name_(std::move(name)), lines_(lines) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (begun_) throw Error(ErrorKind::usage, place_of(name_, mark), "a second document", "one document a file");
    begun_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(mark, Node::Kind::null), anchor, mark);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) throw Error(ErrorKind::usage, place_of(name_, mark), "an alias to its own parent");
    add(Node(found->second), YAML::NullAnchor, mark);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Node node = make(mark, Node::Kind::scalar);
    node.scalar = value;
    node.quoted = tag == "!";
    if (node.quoted) require_closing_quote(lines_, name_, mark);
    if (tag == "tag:yaml.org,2002:binary") {
      if (!from_base64(value, node.scalar)) throw Error(ErrorKind::usage, node.place, "no !!binary value", "base64");
      node.quoted = true;
    }
    if (!node.quoted && (value.empty() || value == "~" || value == "null")) node.kind = Node::Kind::null;
    add(std::move(node), anchor, mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(make(mark, Node::Kind::sequence), anchor, mark);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(make(mark, Node::Kind::map), anchor, mark);
  }
  void OnMapEnd() override { close(); }

  Node root;

 private:
  struct Open {
    Node node;
    YAML::anchor_t anchor;
    bool has_key = false;
    std::string key;
    Place key_place;
  };

  bool begun_ = false;

  Node make(const YAML::Mark& mark, Node::Kind kind) const {
    Node node;
    node.kind = kind;
    node.place = place_of(name_, mark);
    return node;
  }

  void open(Node node, YAML::anchor_t anchor, const YAML::Mark& mark) {
    if (stack_.size() >= kMaxDepth) {
      throw Error(ErrorKind::usage, place_of(name_, mark), "nested too deeply", "at most 100 levels");
    }
    if (!stack_.empty() && stack_.back().node.is_map() && !stack_.back().has_key) {
      throw Error(ErrorKind::usage, place_of(name_, mark), "a key must be a plain word", kClosed);
    }
    stack_.push_back({std::move(node), anchor, false, {}, {}});
  }

  void close() {
    Open done = std::move(stack_.back());
    stack_.pop_back();
    if (done.anchor != YAML::NullAnchor) anchors_[done.anchor] = done.node;
    place_value(std::move(done.node));
  }

  void add(Node node, YAML::anchor_t anchor, const YAML::Mark& mark) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
    if (!stack_.empty() && stack_.back().node.is_map() && !stack_.back().has_key) {
      Open& map = stack_.back();
      if (!node.is_scalar())
        throw Error(ErrorKind::usage, place_of(name_, mark), "a key must be a plain word", kClosed);
      if (const Node* earlier = map.node.find(node.scalar)) {
        throw Error(ErrorKind::usage, node.place, "the key '" + node.scalar + "' is given twice",
                    "one value; the first is at line " + std::to_string(earlier->place.line));
      }
      map.has_key = true;
      map.key = node.scalar;
      map.key_place = node.place;
      return;
    }
    place_value(std::move(node));
  }

  static std::size_t size_of(const Node& node) {
    std::size_t size = 1;
    for (const Node& item : node.items) size += size_of(item);
    for (const Entry& entry : node.entries) size += size_of(entry.value);
    return size;
  }

  void place_value(Node node) {
    if (stack_.empty()) {
      root = std::move(node);
      return;
    }
    nodes_ += node.items.empty() && node.entries.empty() ? 1 : size_of(node);
    if (nodes_ > kMaxNodes) throw Error(ErrorKind::usage, node.place, "the document expands without end");
    Open& parent = stack_.back();
    if (parent.node.is_map()) {
      parent.node.entries.push_back({std::move(parent.key), parent.key_place, std::move(node)});
      parent.has_key = false;
    } else {
      parent.node.items.push_back(std::move(node));
    }
  }

  std::string name_;
  const std::vector<std::string_view>& lines_;
  std::vector<Open> stack_;
  std::map<YAML::anchor_t, Node> anchors_;
  std::size_t nodes_ = 0;
};

std::string kind_name(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::scalar:
      return "'" + node.scalar + "'";
    case Node::Kind::sequence:
      return "a list";
    case Node::Kind::map:
      return "a block";
  }
  return {};
}

std::string number_text(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

/// What to write where a text with a comma, {say: Hello, world}, became a text and a key without a value; else empty.
std::string comma_in_text(const Node& map, const Entry& unknown) {
  const auto at = static_cast<std::size_t>(&unknown - map.entries.data());
  if (at == 0 || unknown.value.kind != Node::Kind::null) return {};
  const Entry& before = map.entries[at - 1];
  if (!before.value.is_scalar() || before.value.quoted || before.value.place.line != unknown.place.line) return {};
  return "quotes around a text with a comma: " + before.key + ": \"" + before.value.scalar + ", " + unknown.key + "\"";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

}  // namespace

const Node* Node::find(std::string_view key) const {
  for (const Entry& entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

Node parse_text(std::string_view text, const std::string& name) {
  if (text.size() > kMaxBytes) {
    throw Error(ErrorKind::usage, {name, 0, 0}, "the configuration is larger than 1 MB", "a YAML text file");
  }
  if (text.find('\0') != std::string_view::npos) {
    throw Error(ErrorKind::usage, {name, 0, 0}, "the file is not text", "a YAML text file");
  }
  std::istringstream stream{std::string(text)};
  const std::vector<std::string_view> lines = lines_of(text);
  TreeBuilder builder(name, lines);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    throw Error(ErrorKind::usage, place_of(name, error.mark), "not valid YAML: " + error.msg,
                expected_for(error.msg, lines, error.mark.line));
  }
  if (builder.root.place.file.empty()) builder.root.place.file = name;  // nothing was in it
  return std::move(builder.root);
}

Node parse_file(const std::filesystem::path& file) {
  try {
    return parse_text(read_file(file, kMaxBytes), file.string());
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    throw Error(ErrorKind::usage, error.place(), error.wrong(), error.expected());
  }
}

Error error_at(const Node& node, std::string wrong, std::string expected) {
  return {ErrorKind::usage, node.place, std::move(wrong), std::move(expected)};
}

double to_double(const Node& node) {
  const std::string& text = node.scalar;
  double value = 0.0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, code] = std::from_chars(begin, text.data() + text.size(), value);
  if (!node.is_scalar() || node.quoted || code != std::errc{} || end != text.data() + text.size() ||
      !std::isfinite(value)) {
    throw error_at(node, kind_name(node) + " is not a finite number", "a number");
  }
  return value;
}

std::int64_t to_integer(const Node& node) {
  const double value = to_double(node);
  if (value != std::floor(value) || std::abs(value) > 9.0e15) {
    throw error_at(node, "'" + node.scalar + "' is not a whole number", "a whole number");
  }
  return static_cast<std::int64_t>(value);
}

bool to_bool(const Node& node) {
  if (node.is_scalar() && !node.quoted) {
    if (node.scalar == "true" || node.scalar == "yes" || node.scalar == "on") return true;
    if (node.scalar == "false" || node.scalar == "no" || node.scalar == "off") return false;
  }
  throw error_at(node, kind_name(node) + " is neither true nor false", "true or false");
}

std::string to_text(const Node& node) {
  if (!node.is_scalar()) throw error_at(node, kind_name(node) + " is not a text", "a text");
  return node.scalar;
}

std::vector<double> to_doubles(const Node& node, std::size_t count) {
  const std::string expected = "a list of " + std::to_string(count) + " numbers";
  if (!node.is_sequence()) throw error_at(node, kind_name(node) + " is not a list", expected);
  if (node.items.size() != count) {
    const bool semicolons = node.items.size() == 1 && node.items.front().scalar.find(';') != std::string::npos;
    throw error_at(node, "the list has " + std::to_string(node.items.size()) + (semicolons ? " entry" : " entries"),
                   expected + (semicolons ? " with commas between them, not semicolons" : ""));
  }
  std::vector<double> values;
  for (const Node& item : node.items) values.push_back(to_double(item));
  return values;
}

MapReader::MapReader(const Node& node, std::string what, const std::string& expected)
    : node_(node), what_(std::move(what)) {
  if (!node.is_map()) throw error_at(node, what_ + " is " + kind_name(node), expected);
}

const Node* MapReader::optional(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  return node_.find(key);
}

const Node& MapReader::required(std::string_view key) {
  if (const Node* node = optional(key)) return *node;
  for (const Entry& entry : node_.entries) {  // a misspelt key explains a missing one
    if (nearest(entry.key, {std::string(key)}).empty()) continue;
    throw Error(ErrorKind::usage, entry.place, what_ + " has no key '" + entry.key + "'",
                "did you mean '" + std::string(key) + "'?");
  }
  throw error_at(node_, what_ + " has no '" + std::string(key) + "'", "the key '" + std::string(key) + "'");
}

void MapReader::read(std::string_view key, double& value, double low, double high) {
  const Node* node = optional(key);
  if (node == nullptr) return;
  const double number = to_double(*node);
  if (number < low || number > high) {
    throw error_at(*node, std::string(key) + " is " + node->scalar,
                   "a number from " + number_text(low) + " to " + number_text(high));
  }
  value = number;
}

void MapReader::read(std::string_view key, int& value, int low, int high) {
  const Node* node = optional(key);
  if (node == nullptr) return;
  const std::int64_t number = to_integer(*node);
  if (number < low || number > high) {
    throw error_at(*node, std::string(key) + " is " + node->scalar,
                   "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  value = static_cast<int>(number);
}

void MapReader::read(std::string_view key, bool& value) {
  if (const Node* node = optional(key)) value = to_bool(*node);
}

void MapReader::read(std::string_view key, std::string& value) {
  if (const Node* node = optional(key)) value = to_text(*node);
}

void MapReader::read_choice(std::string_view key, int& index, const std::vector<std::string>& names) {
  const Node* node = optional(key);
  if (node == nullptr) return;
  const std::string text = to_text(*node);
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) {
    std::string expected;
    for (const std::string& name : names) expected += (expected.empty() ? "" : " | ") + name;
    const std::string near = nearest(text, names);
    if (!near.empty()) expected += " (did you mean '" + near + "'?)";
    throw error_at(*node, std::string(key) + " is '" + text + "'", expected);
  }
  index = static_cast<int>(found - names.begin());
}

void MapReader::finish() const {
  for (const Entry& entry : node_.entries) {
    if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
    const std::string near = nearest(entry.key, known_);
    std::string expected = comma_in_text(node_, entry);
    if (expected.empty() && !near.empty()) expected = "did you mean '" + near + "'?";
    if (expected.empty()) {
      for (const std::string& name : known_) expected += (expected.empty() ? "one of " : ", ") + name;
    }
    throw Error(ErrorKind::usage, entry.place, what_ + " has no key '" + entry.key + "'", expected);
  }
}

std::string nearest(std::string_view word, const std::vector<std::string>& names) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  const std::string small = lower_case(word);
  for (const std::string& name : names) {
    std::size_t distance = edit_distance(small, lower_case(name));
    // A unit left out or added ("leaf" for "leaf_mm") is a near miss whatever its length.
    if (name.starts_with(word)) distance = std::min<std::size_t>(distance, 1);
    if (word.starts_with(name)) distance = std::min<std::size_t>(distance, 2);
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

void set(Node& root, std::string_view path, std::string_view text) {
  const std::string name = "--set " + std::string(path);
  if (path.empty() || path.ends_with('.')) throw usage_error(name + "= names no key", "e.g. --set grid.size=800");
  Node* node = &root;
  for (std::string_view rest = path; !rest.empty();) {
    const std::size_t dot = rest.find('.');
    const std::string key(rest.substr(0, dot));
    rest = dot == std::string_view::npos ? std::string_view{} : rest.substr(dot + 1);
    if (key.empty()) throw usage_error("'" + std::string(path) + "' is not a path of keys", "e.g. grid.size=800");
    if (node->is_sequence()) {
      std::size_t index = 0;
      const auto [end, code] = std::from_chars(key.data(), key.data() + key.size(), index);
      if (code != std::errc{} || end != key.data() + key.size() || index >= node->items.size()) {
        throw usage_error("'" + key + "' in '" + std::string(path) + "' is not a place in the list",
                          "0 to " + std::to_string(node->items.size()) + " exclusive");
      }
      node = &node->items[index];
      continue;
    }
    if (node->kind == Node::Kind::null) node->kind = Node::Kind::map;
    if (!node->is_map()) throw usage_error("'" + std::string(path) + "' goes through a plain value", "a path of keys");
    if (node->find(key) == nullptr) {
      node->entries.push_back({key, {name, 0, 0}, Node{}});
      node->entries.back().value.place = {name, 0, 0};
    }
    node = const_cast<Node*>(node->find(key));
  }
  *node = parse_text(text, name);
}

void set(Node& root, std::string_view setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos) {
    throw usage_error("--set " + std::string(setting) + " has no '='", "e.g. --set grid.size=800");
  }
  set(root, setting.substr(0, equals), setting.substr(equals + 1));
}

}  // namespace sparsha::yaml

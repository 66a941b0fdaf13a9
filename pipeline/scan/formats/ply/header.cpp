// The header of a PLY file, checked line by line.
#include <algorithm>
#include <array>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/formats/remark_unit.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::ply {
namespace {

constexpr std::size_t kLongestLine = 1 << 16;

std::optional<ScalarType> scalar_type(std::string_view word) {
  struct Name {
    std::string_view name;
    ScalarType type;
  };
  static constexpr Name kNames[] = {
      {"char", ScalarType::i8},     {"int8", ScalarType::i8},    {"uchar", ScalarType::u8},
      {"uint8", ScalarType::u8},    {"short", ScalarType::i16},  {"int16", ScalarType::i16},
      {"ushort", ScalarType::u16},  {"uint16", ScalarType::u16}, {"int", ScalarType::i32},
      {"int32", ScalarType::i32},   {"uint", ScalarType::u32},   {"uint32", ScalarType::u32},
      {"int64", ScalarType::i64},   {"uint64", ScalarType::u64}, {"float", ScalarType::f32},
      {"float32", ScalarType::f32}, {"double", ScalarType::f64}, {"float64", ScalarType::f64},
  };
  const std::string lower = lower_case(word);
  for (const Name& name : kNames) {
    if (name.name == lower) return name.type;
  }
  return std::nullopt;
}

/// Header lines end as the first one does: LF, CRLF or CR. The bytes behind "end_header" may be anything, so a general
/// line reader will not do.
class HeaderLines {
 public:
  explicit HeaderLines(const ScanFile& file) : file_(file) {
    const std::string_view head = file.bytes.substr(0, kLongestLine);
    const std::size_t cr = head.find('\r');
    lone_cr_ = cr != std::string_view::npos && head.find('\n') > cr + 1 && cr < 8;
  }
  std::string_view next() {
    ++number_;
    const std::string_view rest = file_.bytes.substr(offset_);
    const std::size_t length = rest.substr(0, kLongestLine).find(lone_cr_ ? '\r' : '\n');
    if (length == std::string_view::npos && rest.size() >= kLongestLine) {
      throw file_.error_at(number_, "a line of the PLY header is longer than 65536 bytes", "lines up to 'end_header'");
    }
    if (length == std::string_view::npos) {
      throw file_.error_at(number_, "the PLY header breaks off", "lines up to 'end_header'");
    }
    offset_ += length + 1;
    std::string_view line = rest.substr(0, length);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  const ScanFile& file_;
  bool lone_cr_ = false;
  std::size_t offset_ = 0;
  int number_ = 0;
};

void parse_format(const ScanFile& file, int line, std::string_view rest, Header& header) {
  const std::string name = lower_case(take_word(rest));
  if (name == "ascii") {
    header.encoding = Encoding::ascii;
  } else if (name == "binary_little_endian") {
    header.encoding = Encoding::little;
  } else if (name == "binary_big_endian") {
    header.encoding = Encoding::big;
  } else {
    throw file.error_at(line, "unknown PLY format " + in_quotes(name),
                        "'ascii', 'binary_little_endian' or 'binary_big_endian'");
  }
}

Element parse_element(const ScanFile& file, int line, std::string_view rest) {
  Element element;
  element.line = line;
  element.name = lower_case(take_word(rest));
  const std::string_view word = take_word(rest);
  std::int64_t count = 0;
  const char* const stop = parse_integer(word.data(), word.data() + word.size(), count);
  if (element.name.empty() || stop != word.data() + word.size() || word.empty() || count < 0) {
    throw file.error_at(line, "bad element line, count " + in_quotes(word), "'element NAME COUNT'");
  }
  element.count = static_cast<std::uint64_t>(count);
  return element;
}

Property parse_property(const ScanFile& file, int line, std::string_view rest) {
  Property property;
  std::string_view word = take_word(rest);
  if (lower_case(word) == "list") {
    word = take_word(rest);
    property.count_type = scalar_type(word);
    if (!property.count_type || is_floating(*property.count_type)) {
      throw file.error_at(line, "unknown type " + in_quotes(word) + " of a list's length", "an integer type");
    }
    word = take_word(rest);
  }
  const std::optional<ScalarType> type = scalar_type(word);
  if (!type) throw file.error_at(line, "unknown property type " + in_quotes(word), "a type such as 'float' or 'uchar'");
  property.type = *type;
  property.name = lower_case(take_word(rest));
  if (property.name.empty()) throw file.error_at(line, "a property without a name", "'property TYPE NAME'");
  return property;
}

}  // namespace

bool Element::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const Property& p) { return p.count_type.has_value(); });
}

std::size_t Element::least_size(bool ascii) const {
  std::size_t size = 0;
  if (ascii) {  // a digit and a separator a value; lists may be left out
    for (const Property& property : properties) size += property.count_type ? 0 : 2;
    return size;
  }
  for (const Property& property : properties) size += size_of(property.count_type.value_or(property.type));
  return size;
}

int Element::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view wanted : names) {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (properties[i].name == wanted) return static_cast<int>(i);
    }
  }
  return -1;
}

namespace {

/// Whether a program names itself: "Created by CloudCompare", "Created in RealityCapture", "Generated by Metashape".
bool names_program(std::string_view lower) {
  constexpr std::array<std::string_view, 6> kWords{"created by",  "created in",    "created with",
                                                   "exported by", "exported from", "generated"};
  return std::ranges::any_of(kWords,
                             [&](std::string_view words) { return lower.find(words) != std::string_view::npos; });
}

/// Programs name themselves in a remark, and pictures of a mesh ("TextureFile a.jpg").
void add_note(std::string_view remark, Header& header) {
  constexpr std::size_t kMost = 8;
  constexpr std::size_t kMostTextures = 65536;
  const std::string lower = lower_case(remark);
  if (lower.find("texturefile ") != std::string::npos && header.textures.size() < kMostTextures) {
    (void)take_word(remark);
    header.textures.emplace_back(remark.substr(std::min(remark.find_first_not_of(" \t"), remark.size())));
    if (header.notes.size() < kMost) header.notes.push_back("PLY: texture " + printable(header.textures.back()));
  } else if (header.notes.size() == kMost) {
    return;
  } else if (names_program(lower)) {
    header.notes.push_back("PLY: " + printable(remark.substr(std::min(remark.find_first_not_of(' '), remark.size()))));
  }
}

}  // namespace

Header parse_header(const ScanFile& file) {
  Header header;
  HeaderLines lines(file);
  lines.next();  // "ply", seen by is_ply
  bool has_format = false;
  for (;;) {
    std::string_view line = lines.next();
    const std::string key = lower_case(take_word(line));
    if (key == "end_header") break;
    if (key == "comment") add_note(line, header);
    const bool remark = key == "comment" || key == "obj_info";
    constexpr std::size_t kMostRemarks = 64;
    if (remark && header.unit_remarks.size() < kMostRemarks && gives_unit(line))
      header.unit_remarks.emplace_back(line, lines.number());
    if (key.empty() || remark) continue;
    if (key == "format") {
      parse_format(file, lines.number(), line, header);
      has_format = true;
    } else if (key == "element") {
      header.elements.push_back(parse_element(file, lines.number(), line));
    } else if (key == "property") {
      if (header.elements.empty()) {
        throw file.error_at(lines.number(), "a property before any element", "'element NAME COUNT' first");
      }
      header.elements.back().properties.push_back(parse_property(file, lines.number(), line));
    } else {
      throw file.error_at(lines.number(), "unknown PLY header line " + in_quotes(key),
                          "'element', 'property', 'comment' or 'end_header'");
    }
  }
  if (!has_format) throw file.error("the PLY header has no 'format' line", "'format ascii 1.0' or a binary one");
  header.body = lines.offset();
  header.lines = lines.number();
  return header;
}

}  // namespace sparsha::pipeline::ply

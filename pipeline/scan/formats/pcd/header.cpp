#include "pipeline/scan/formats/pcd/header.h"

#include <limits>

#include "base/text/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::pcd {
namespace {

constexpr std::size_t kLongestLine = 1 << 16;

class HeaderParser {
 public:
  explicit HeaderParser(const ScanFile& file) : file_(file) {
    const std::string_view head = file.bytes.substr(0, kLongestLine);
    const std::size_t cr = head.find('\r');
    const bool alone = cr + 1 < head.size() && head[cr + 1] != '\n' && head[cr + 1] != '\r';
    if (cr != std::string_view::npos && alone && head.find('\n') > cr) end_ = '\r';
  }

  Header parse() {
    std::string_view line;
    while (next_line(line)) {
      std::string_view rest = line;
      const std::string key = lower_case(take_word(rest));
      if (key.empty() || key[0] == '#') continue;
      if (entry(key, rest)) return finish();
    }
    throw file_.error("the PCD header breaks off", "lines up to 'DATA'");
  }

 private:
  bool next_line(std::string_view& line) {
    if (offset_ >= file_.bytes.size()) return false;
    const std::string_view rest = file_.bytes.substr(offset_);
    const std::size_t length = rest.substr(0, kLongestLine).find(end_);
    if (length == std::string_view::npos) {
      if (rest.size() > kLongestLine) throw error("a PCD header line of more than 65536 bytes", "lines up to 'DATA'");
      throw error("the PCD header breaks off", "lines up to 'DATA'");
    }
    ++line_;
    offset_ += length + 1;
    line = rest.substr(0, length);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return true;
  }

  /// True when the header is over.
  bool entry(const std::string& key, std::string_view rest) {
    if (key == "version") return false;
    if (key == "fields" || key == "columns") {
      names_ = words(rest);
    } else if (key == "size") {
      sizes_ = numbers(rest);
    } else if (key == "type") {
      types_ = words(rest);
    } else if (key == "count") {
      counts_ = numbers(rest);
    } else if (key == "width") {
      width_ = number(rest);
    } else if (key == "height") {
      height_ = number(rest);
    } else if (key == "points") {
      points_ = number(rest);
    } else if (key == "viewpoint") {
      parse_viewpoint(rest);
    } else if (key == "data") {
      parse_encoding(take_word(rest));
      return true;
    } else {
      throw error("unknown PCD header line " + in_quotes(key),
                  "FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, POINTS, DATA");
    }
    return false;
  }

  static std::vector<std::string> words(std::string_view rest) {
    std::vector<std::string> result;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) result.emplace_back(word);
    return result;
  }

  std::uint64_t number(std::string_view rest) const { return to_number(take_word(rest)); }

  std::vector<std::uint64_t> numbers(std::string_view rest) const {
    std::vector<std::uint64_t> result;
    for (const std::string& word : words(rest)) result.push_back(to_number(word));
    return result;
  }

  std::uint64_t to_number(std::string_view word) const {
    std::int64_t value = -1;
    const char* const stop = parse_integer(word.data(), word.data() + word.size(), value);
    if (stop != word.data() + word.size() || word.empty() || value < 0) {
      throw error(in_quotes(word) + " is not a count", "a whole number that is not negative");
    }
    return static_cast<std::uint64_t>(value);
  }

  void parse_viewpoint(std::string_view rest) {
    std::array<double, 7> values{};
    for (double& value : values) {
      const std::string_view word = take_word(rest);
      if (parse_number(word.data(), word.data() + word.size(), value) == nullptr) {
        throw error("bad VIEWPOINT", "seven numbers: tx ty tz qw qx qy qz");
      }
    }
    header_.viewpoint = values;
  }

  void parse_encoding(std::string_view word) {
    const std::string name = lower_case(word);
    if (name == "ascii") {
      header_.encoding = Encoding::ascii;
    } else if (name == "binary") {
      header_.encoding = Encoding::binary;
    } else if (name == "binary_compressed") {
      header_.encoding = Encoding::compressed;
    } else {
      throw error("unknown PCD data kind " + in_quotes(word), "'ascii', 'binary' or 'binary_compressed'");
    }
  }

  std::optional<ScalarType> scalar_type(char letter, std::uint64_t size) const {
    if (letter == 'F') {
      if (size == 4) return ScalarType::f32;
      if (size == 8) return ScalarType::f64;
      return std::nullopt;
    }
    const bool is_signed = letter == 'I';
    if (!is_signed && letter != 'U') return std::nullopt;
    switch (size) {
      case 1:
        return is_signed ? ScalarType::i8 : ScalarType::u8;
      case 2:
        return is_signed ? ScalarType::i16 : ScalarType::u16;
      case 4:
        return is_signed ? ScalarType::i32 : ScalarType::u32;
      case 8:
        return is_signed ? ScalarType::i64 : ScalarType::u64;
      default:
        return std::nullopt;
    }
  }

  Header finish() {
    if (names_.empty()) throw file_.error("the PCD header names no fields", "'FIELDS x y z'");
    check_length("SIZE", sizes_.size());
    check_length("TYPE", types_.size());
    check_length("COUNT", counts_.size());
    const std::uint64_t bytes = file_.bytes.size();
    for (std::size_t i = 0; i < names_.size(); ++i) {
      Field field;
      field.name = lower_case(names_[i]);
      const std::uint64_t size = sizes_.empty() ? 4 : sizes_[i];
      const char letter = types_.empty() ? 'F' : static_cast<char>(types_[i][0] & ~0x20);
      const std::optional<ScalarType> type = scalar_type(letter, size);
      if (!type) {
        throw file_.error("field " + in_quotes(names_[i]) + " has an impossible TYPE and SIZE",
                          "I or U of 1, 2, 4 or 8 bytes, or F of 4 or 8");
      }
      field.type = *type;
      const std::uint64_t count = counts_.empty() ? 1 : counts_[i];
      if (count > bytes) {
        throw file_.error("field " + in_quotes(names_[i]) + " claims more values than the file has bytes",
                          "a COUNT that fits the file");
      }
      field.count = static_cast<std::size_t>(count);
      field.offset = header_.record_size;
      field.column = header_.columns;
      header_.record_size += field.count * size_of(field.type);
      header_.columns += field.count;
      header_.fields.push_back(std::move(field));
    }
    header_.points = point_count();
    header_.body = offset_;
    header_.lines = line_;
    return std::move(header_);
  }

  void check_length(const char* key, std::size_t length) const {
    if (length != 0 && length != names_.size()) {
      throw file_.error(std::string("PCD line ") + key + " has " + std::to_string(length) + " entries for " +
                            std::to_string(names_.size()) + " fields",
                        "one entry a field");
    }
  }

  std::uint64_t point_count() const {
    if (!width_ && !points_)
      throw file_.error("the PCD header gives no number of points", "POINTS, or WIDTH and HEIGHT");
    if (!width_) return *points_;
    const std::uint64_t height = height_.value_or(1);
    if (height != 0 && *width_ > std::numeric_limits<std::uint64_t>::max() / height) {
      throw file_.error("WIDTH x HEIGHT is beyond any file", "a header that fits the file");
    }
    const std::uint64_t product = *width_ * height;
    if (points_ && *points_ != product) {
      throw file_.error("POINTS is " + std::to_string(*points_) + " but WIDTH x HEIGHT is " + std::to_string(product),
                        "the same number");
    }
    return product;
  }

  Error error(std::string wrong, std::string expected) const {
    return file_.error_at(line_, std::move(wrong), std::move(expected));
  }

  const ScanFile& file_;
  std::size_t offset_ = 0;
  int line_ = 0;
  char end_ = '\n';  ///< of a line
  Header header_;
  std::vector<std::string> names_, types_;
  std::vector<std::uint64_t> sizes_, counts_;
  std::optional<std::uint64_t> width_, height_, points_;
};

}  // namespace

const Field* Header::find(std::string_view name) const {
  for (const Field& field : fields) {
    if (field.name == name && field.count > 0) return &field;
  }
  return nullptr;
}

Header parse_header(const ScanFile& file) { return HeaderParser(file).parse(); }

}  // namespace sparsha::pipeline::pcd

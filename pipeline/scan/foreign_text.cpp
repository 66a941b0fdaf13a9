#include "pipeline/scan/foreign_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/text/lower_case.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

/// The whole numbers of a line, at most `most`; nothing when a word is no whole number or there are more.
std::optional<std::vector<std::int64_t>> whole_numbers(std::string_view line, std::size_t most) {
  std::vector<std::int64_t> numbers;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    std::int64_t value = 0;
    const char* const end = word.data() + word.size();
    if (numbers.size() == most || parse_integer(word.data(), end, value) != end) return std::nullopt;
    numbers.push_back(value);
  }
  return numbers;
}

/// The text; of what has no end of a line for long, which is no text of lines, a beginning: a reader looks for one in
/// all of it.
std::string_view lines_of(std::string_view text) {
  constexpr std::size_t kLongestLine = 1 << 16;
  const std::string_view beginning = text.substr(0, kLongestLine);
  return beginning.find_first_of("\r\n") == std::string_view::npos ? beginning : text;
}

bool next_content(LineReader& lines, std::string_view& line) {
  while (lines.next(line)) {
    line = trimmed(line.substr(0, line.find('#')));
    if (!line.empty()) return true;
  }
  return false;
}

}  // namespace

bool is_tecplot_mesh(std::string_view text) {
  constexpr std::size_t kLooked = 1 << 14;
  LineReader lines(text.substr(0, kLooked));
  std::string_view line;
  bool zone = false;
  while (lines.next(line)) {
    std::string_view content = trimmed(line);
    std::string words = lower_case(content);
    std::erase_if(words, [](char c) { return c == ' ' || c == '\t' || c == '"'; });
    double number = 0.0;
    if (zone && parse_number(content.data(), content.data() + content.size(), number) != nullptr) return false;
    zone = zone || words.starts_with("zone");
    if (!zone) continue;
    constexpr std::array<std::string_view, 8> kSigns = {",et=",    "zonetype=fe", "f=fe",          "datapacking=block",
                                                        "f=block", ",elements=",  "zoneelements=", "zoneet="};
    if (std::any_of(kSigns.begin(), kSigns.end(),
                    [&](std::string_view sign) { return words.find(sign) != std::string::npos; }))
      return true;
  }
  return false;
}

bool is_iges(std::string_view text) {
  constexpr std::size_t kLetter = 72, kLength = 80;
  LineReader lines(lines_of(text));
  std::string_view line;
  for (int seen = 0; seen < 2; ++seen) {
    if (!lines.next(line) || line.size() < kLetter + 2 || line.size() > kLength) return false;
    const std::string_view number = trimmed(line.substr(kLetter + 1));
    if (number.empty() || !std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; })) {
      return false;
    }
    const char letter = line[kLetter];
    if (seen == 0 ? letter != 'S' && letter != 'B' && letter != 'C' : letter != 'S' && letter != 'G') return false;
  }
  return true;
}

bool is_dxf(std::string_view text) {
  LineReader lines(lines_of(text));
  std::string_view code, value;
  for (int pairs = 0; pairs < 64; ++pairs) {
    if (!lines.next(code) || !lines.next(value)) return false;
    if (trimmed(code) == "0") return trimmed(value) == "SECTION";
    if (trimmed(code) != "999") return false;
  }
  return false;
}

bool is_node_list(std::string_view text) {
  LineReader lines(lines_of(text));
  std::string_view line;
  if (!next_content(lines, line)) return false;
  const auto counts = whole_numbers(line, 4);
  if (!counts || counts->size() < 2 || (*counts)[0] < 1 || ((*counts)[1] != 2 && (*counts)[1] != 3)) return false;
  std::size_t values = 1;
  for (std::size_t k = 1; k < counts->size(); ++k) {
    if ((*counts)[k] < 0 || (*counts)[k] > 64) return false;
    values += static_cast<std::size_t>((*counts)[k]);
  }
  std::int64_t before = -1;
  for (int seen = 0; seen < 2 && (seen == 0 || (*counts)[0] > 1); ++seen) {
    if (!next_content(lines, line)) return false;
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    std::int64_t number = 0;
    const char* const end = word.data() + word.size();
    if (parse_integer(word.data(), end, number) != end) return false;
    if (seen == 0 ? number != 0 && number != 1 : number != before + 1) return false;
    before = number;
    std::size_t others = 0;
    while (!take_word(rest).empty()) ++others;
    if (others + 1 != values) return false;
  }
  std::int64_t rows = std::min<std::int64_t>((*counts)[0], 2);
  while (rows <= (*counts)[0] && next_content(lines, line)) ++rows;
  return rows == (*counts)[0];
}

bool is_element_list(std::string_view text) {
  constexpr std::int64_t kMostRows = 1000, kMostAttributes = 64;
  LineReader lines(lines_of(text));
  std::string_view line;
  if (!next_content(lines, line)) return false;
  const auto counts = whole_numbers(line, 3);
  if (!counts || counts->size() < 2 || (*counts)[0] < 1) return false;
  const std::int64_t corners = (*counts)[1], attributes = counts->size() > 2 ? (*counts)[2] : 0;
  if (corners != 3 && corners != 4 && corners != 6 && corners != 10) return false;
  if (attributes < 0 || attributes > kMostAttributes) return false;
  const auto values = static_cast<std::size_t>(1 + corners);
  std::int64_t first = 0, rows = 0;
  for (; rows < kMostRows && next_content(lines, line); ++rows) {
    std::string_view rest = line;
    std::vector<std::int64_t> numbers;
    while (numbers.size() < values) {
      const std::string_view word = take_word(rest);
      const auto number = word.empty() ? std::nullopt : whole_numbers(word, 1);
      if (!number || number->front() < 0) return false;
      numbers.push_back(number->front());
    }
    if (rows == 0) first = numbers.front();
    if (first > 1 || numbers.front() != first + rows) return false;
    // No corner is there twice, as coordinates are.
    std::sort(numbers.begin() + 1, numbers.end());
    if (std::adjacent_find(numbers.begin() + 1, numbers.end()) != numbers.end()) return false;
  }
  return rows == std::min(kMostRows, (*counts)[0]);
}

bool is_pose_list(std::string_view text) {
  constexpr std::size_t kNumbers = 12;
  constexpr int kLooked = 100;
  constexpr double kRounding = 1e-3;
  LineReader lines(lines_of(text));
  std::string_view line;
  int rows = 0;
  for (; rows < kLooked && next_content(lines, line); ++rows) {
    std::array<double, kNumbers> v{};
    for (double& value : v) {
      const std::string_view word = take_word(line);
      if (word.empty() || parse_number(word.data(), word.data() + word.size(), value) != word.data() + word.size())
        return false;
    }
    if (!trimmed(line).empty()) return false;
    const auto product = [&](std::size_t a, std::size_t b) {
      return v[4 * a] * v[4 * b] + v[4 * a + 1] * v[4 * b + 1] + v[4 * a + 2] * v[4 * b + 2];
    };
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b) {
        if (!(std::abs(product(a, b) - (a == b ? 1.0 : 0.0)) < kRounding)) return false;
      }
    }
  }
  return rows > 1;
}

bool is_colmap_images(std::string_view text) {
  if (text.starts_with("# Image list with two lines of data per image")) return true;
  LineReader lines(lines_of(text));
  std::string_view line;
  if (!next_content(lines, line)) return false;
  constexpr std::size_t kNumbers = 9;
  std::array<double, kNumbers> values{};
  for (double& value : values) {
    const std::string_view word = take_word(line);
    if (word.empty() || parse_number(word.data(), word.data() + word.size(), value) != word.data() + word.size()) {
      return false;
    }
  }
  const auto whole = [](double v) { return v >= 0.0 && v == std::floor(v); };
  const double norm = std::hypot(std::hypot(values[1], values[2]), std::hypot(values[3], values[4]));
  line = trimmed(line);
  double value = 0.0;
  return whole(values[0]) && whole(values[8]) && std::abs(norm - 1.0) < 0.01 && !line.empty() &&
         parse_number(line.data(), line.data() + line.size(), value) != line.data() + line.size() &&
         line.find('.') != std::string_view::npos;
}

bool is_colmap_visibility(std::string_view bytes) {
  constexpr std::size_t kCount = 8, kLength = 4, kPicture = 4;
  if (bytes.size() < kCount + kLength) return false;
  const auto count = load<std::uint64_t>(bytes.data());
  if (count == 0 || count > (bytes.size() - kCount) / kLength) return false;
  std::size_t at = kCount;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (bytes.size() - at < kLength) return false;
    const auto pictures = load<std::uint32_t>(bytes.data() + at);
    at += kLength;
    if (pictures > (bytes.size() - at) / kPicture) return false;
    at += pictures * kPicture;
  }
  return at == bytes.size();
}

bool is_3ds(std::string_view bytes) {
  constexpr std::size_t kHeader = 6;
  if (bytes.size() < 2 * kHeader || !bytes.starts_with("MM")) return false;
  const auto next = load<std::uint16_t>(bytes.data() + kHeader);
  return load<std::uint32_t>(bytes.data() + 2) == bytes.size() && (next == 0x0002 || next == 0x3D3D);
}

bool has_line(std::string_view text, std::string_view begin) {
  text = text.substr(0, 1 << 16);
  for (std::size_t at = text.find(begin); at != std::string_view::npos; at = text.find(begin, at + 1)) {
    if (at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r') return true;
  }
  return false;
}

bool is_sparsha_config(std::string_view text) {
  LineReader lines(text.substr(0, 1 << 16));
  std::string_view line;
  bool scans = false;
  for (bool first = true; lines.next(line); first = false) {
    while (line.empty() || line.front() == '#' || line == "---") {
      if (!lines.next(line)) return scans;
    }
    const std::size_t colon = line.find(':');
    const bool is_key = colon != std::string_view::npos && colon > 0 && line.front() >= 'a' && line.front() <= 'z' &&
                        line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == colon;
    if (first && !is_key) return false;
    if (!is_key || line.substr(0, colon) != "scans") continue;
    const std::string_view rest = trimmed(line.substr(colon + 1));
    scans = rest.empty() || rest.front() == '[' || rest.front() == '#';
    if (scans) return true;
  }
  return scans;
}

bool is_markdown_table(std::string_view text) {
  constexpr int kLooked = 200;
  LineReader lines(text.substr(0, 1 << 16));
  std::string_view line;
  bool bars = false;  // the line before begins and ends with one
  for (int n = 0; n < kLooked && lines.next(line); ++n) {
    line = trimmed(line);
    const bool framed = line.size() > 2 && line.front() == '|' && line.back() == '|';
    const bool rule = framed && line.find_first_not_of("|-: \t") == std::string_view::npos &&
                      line.find("--") != std::string_view::npos;
    if (rule && bars) return true;
    bars = framed;
  }
  return false;
}

bool is_json(std::string_view text) {
  text = trimmed(text.substr(0, 4096));
  if (text.empty() || (text[0] != '{' && text[0] != '[')) return false;
  const std::size_t second = text.find_first_not_of(" \t\r\n", 1);
  if (second == std::string_view::npos) return false;
  const char c = text[second];
  return text[0] == '{' ? c == '"' || c == '}'
                        : c == '{' || c == '[' || c == '"' || c == ']' || c == '-' || (c >= '0' && c <= '9');
}

bool is_object_of_json(std::string_view text, std::initializer_list<std::string_view> words) {
  if (!is_json(text)) return false;
  const std::string_view head = text.substr(0, 1 << 16);
  return std::all_of(words.begin(), words.end(),
                     [&](std::string_view word) { return head.find(word) != std::string_view::npos; });
}

std::optional<std::string> first_element(std::string_view text) {
  text = text.substr(0, 4096);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.empty() || text[0] != '<') return std::nullopt;
  const auto has = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  if (!has("<?") && !has("<!") && !has("</") && !has("/>")) return std::nullopt;  // '<X> <Y> <Z>' above a table
  while (!text.empty()) {
    text.remove_prefix(std::min(text.find('<'), text.size()));
    const bool remark = text.starts_with("<!--");
    const std::string start = lower_case(text.substr(0, 14));
    if (start == "<!doctype html") return "html";
    if (!remark && text.size() > 1 && text[1] != '?' && text[1] != '!') {
      std::string name = lower_case(text.substr(1, std::min<std::size_t>(text.find_first_of(" \t\r\n/>", 1), 64) - 1));
      if (const std::size_t colon = name.find(':'); colon != std::string::npos) name.erase(0, colon + 1);
      return name;
    }
    const std::string_view close = remark ? "-->" : ">";
    const std::size_t end = text.find(close);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + close.size());
  }
  return std::string();
}

const char* wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32";
  if (bytes.starts_with("\xFE\xFF"sv) || bytes.starts_with("\xFF\xFE"sv)) return "UTF-16";
  constexpr std::size_t kLooked = 256, kLeast = 8;
  const std::size_t size = std::min(bytes.size(), kLooked) / 4 * 4;
  if (size < kLeast) return nullptr;
  std::array<std::size_t, 4> zeros{};
  std::array<std::size_t, 4> letters{};
  for (std::size_t n = 0; n < size; ++n) {
    const auto c = static_cast<unsigned char>(bytes[n]);
    if (c == 0) ++zeros[n % 4];
    if ((c >= ' ' && c < 127) || c == '\t' || c == '\r' || c == '\n') ++letters[n % 4];
  }
  const std::size_t all = size / 4;
  const auto is = [&](std::size_t k, bool letter) { return (letter ? letters[k] : zeros[k]) == all; };
  for (const std::size_t k : {0U, 3U}) {
    if (is(k, true) && is((k + 1) % 4, false) && is((k + 2) % 4, false) && is((k + 3) % 4, false)) return "UTF-32";
  }
  for (const std::size_t k : {0U, 1U}) {
    if (is(k, true) && is(k + 2, true) && is(1 - k, false) && is(3 - k, false)) return "UTF-16";
  }
  return nullptr;
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/formats/stl.h"

#include <array>

#include "base/text/lower_case.h"
#include "pipeline/scan/places.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kTriangle = 50;

class TriangleSink {
 public:
  explicit TriangleSink(ScanWriter& out) : out_(out) {}

  std::uint32_t vertex(float x, float y, float z) {
    const std::size_t before = places_.size();
    const std::uint32_t number = places_.number(x, y, z);
    if (number == before) out_.add(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    return number;
  }
  void triangle(const std::array<std::uint32_t, 3>& corners) {
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[0] != corners[2]) {
      out_.add_triangle(corners[0], corners[1], corners[2]);
    }
  }

 private:
  ScanWriter& out_;
  Places places_;
};

/// Some programs keep a colour of five bits a channel in the two bytes behind a triangle. Bit 15 is set where there is
/// one (VisCAM); clear, in files whose header has "COLOR=" (Magics).
class FaceColours {
 public:
  explicit FaceColours(const ScanFile& file)
      : magics_(file.bytes.substr(0, 80).find("COLOR=") != std::string_view::npos) {}

  void look_at(std::uint16_t bits) {
    const bool set = (bits & 0x8000U) != 0;
    // All bits alike are what programs without colours write.
    const bool alike = bits == 0 || bits == 0xFFFF;
    if (set != magics_ && !alike) ++count_;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  bool magics_;
  std::uint64_t count_ = 0;
};

/// A closed surface has half as many vertices as triangles.
std::uint64_t vertices_of(std::uint64_t triangles) { return triangles / 2 + 2; }

std::uint64_t count_loops(const ScanFile& file) {
  std::uint64_t count = 0;
  LineReader lines(file.bytes);
  std::string_view line;
  while (lines.next(line)) {
    constexpr std::size_t kLongest = 256;  // of one statement
    const bool several = line.size() > kLongest;
    std::string_view word = take_word(line);
    do {
      if (word.size() != 7 || (word[0] | 0x20) != 'e' || lower_case(word) != "endloop") continue;
      if ((++count & 0xFFFF) == 0 && !several) file.done_before(lines.offset() - 1);
    } while (several && !(word = take_word(line)).empty());
  }
  return count;
}

EmptyScan no_facets(const ScanFile& file) { return file.empty("the STL file has no facets", "at least one triangle"); }

void read_binary(const ScanFile& file, ScanWriter& out) {
  if (file.bytes.size() < kHeader) throw file.error("too short for a binary STL file", "a header of 84 bytes");
  const std::uint64_t count = load<std::uint32_t>(file.bytes.data() + 80);
  const std::uint64_t most = (file.bytes.size() - kHeader) / kTriangle;
  if (count > most) {
    throw file.error(
        "the header promises " + std::to_string(count) + " triangles, the file has room for " + std::to_string(most),
        "a complete file");
  }
  out.scan().format = "STL binary";
  out.begin(0, false, false);
  out.expect_mesh(vertices_of(count), count);
  if (count == 0 && most > 0) {
    throw file.error("the header promises no triangles, the file has room for " + std::to_string(most),
                     "the number of triangles in bytes 81 to 84");
  }
  if (count == 0) throw no_facets(file);
  if (most > count) {
    out.scan().warnings.push_back("the header promises " + std::to_string(count) +
                                  " triangles, the file has room for " + std::to_string(most) +
                                  "; the others are left out");
  } else if (file.bytes.size() > kHeader + count * kTriangle) {
    out.scan().warnings.push_back("bytes behind the last triangle are left out");
  }
  TriangleSink sink(out);
  FaceColours colours(file);
  const char* p = file.bytes.data() + kHeader;
  for (std::uint64_t i = 0; i < count; ++i, p += kTriangle) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const char* const v = p + 12 + 12 * k;
      corners[k] = sink.vertex(load<float>(v), load<float>(v + 4), load<float>(v + 8));
    }
    sink.triangle(corners);
    colours.look_at(load<std::uint16_t>(p + 48));
    if ((i & 0xFFFF) == 0xFFFF) file.done_before(static_cast<std::size_t>(p - file.bytes.data()));
  }
  if (colours.count() > 0) out.scan().warnings.push_back(unused_face_colours(colours.count()));
}

/// What of the text begins with its first facet, "facet normal 0 0 1" or "facet outer loop"; empty without one. Names
/// of solids end there.
std::string_view from_facet(std::string_view text) {
  while (!text.empty()) {
    std::string_view rest = text;
    const std::string_view word = take_word(rest);
    if (word.empty()) return {};
    const std::string_view begin = text.substr(static_cast<std::size_t>(word.data() - text.data()));
    if (lower_case(word) == "facet") {
      std::string_view behind = rest;
      double value = 0.0;
      const std::string first = lower_case(take_word(behind));
      const std::string_view number = take_word(behind);
      if (first == "outer" && lower_case(number) == "loop") return begin;
      if (first == "normal" && !number.empty() &&
          parse_number(number.data(), number.data() + number.size(), value) != nullptr) {
        return begin;
      }
    }
    text = rest;
  }
  return {};
}

/// Statements of an ASCII file, which may stand in one line.
class AsciiReader {
 public:
  AsciiReader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), sink_(out), lines_(file.bytes) {}

  void read() {
    std::string_view line;
    std::size_t told = 0;
    while (lines_.next(line)) {
      if (lines_.offset() - told > (1U << 22)) {
        told = lines_.offset();
        file_.done_before(told - line.size() - 1);
      }
      if (const std::string word = lower_case(take_word(line)); !word.empty() && !take(word, line)) {
        throw file_.error_at(lines_.number(), "unknown STL line " + in_quotes(word), "'facet', 'vertex', 'endloop'");
      }
      // What else follows in a line is a name or a remark.
      for (std::string_view rest = line; take(lower_case(take_word(rest)), rest);) line = rest;
    }
    if (in_loop_ || solids_ > 0) {
      throw file_.error_at(lines_.number(), "the file ends within a solid", "'endsolid'; the file may be cut short");
    }
    if (!any_) throw no_facets(file_);
    if (face_colours_ > 0) {
      out_.scan().warnings.push_back(unused_face_colours(face_colours_));
    } else if (solid_colours_ > 0) {
      out_.scan().warnings.emplace_back("the colour of a solid is not used");
    }
  }

 private:
  /// Whether it is a statement; takes from `rest` what belongs to it.
  bool take(const std::string& word, std::string_view& rest) {
    if (word == "vertex") {
      vertex(rest);
    } else if (word == "facet") {
      in_facet_ = true;
      std::string_view behind = rest;
      if (lower_case(take_word(behind)) == "normal") {
        for (int k = 0; k < 4; ++k) (void)take_word(rest);  // normal x y z
      }
    } else if (word == "outer") {
      found_ = 0;
      in_loop_ = true;
      (void)take_word(rest);  // loop
    } else if (word == "endloop") {
      end_loop();
    } else if (word == "solid") {
      ++solids_;
      const std::string_view facet = from_facet(rest);
      if (facet.empty() && ends_solid(rest)) --solids_;
      rest = facet;
    } else if (word == "endsolid") {
      --solids_;
      rest = from_facet(rest);
      if (!rest.empty()) ++solids_;
    } else if (word == "color") {
      colour(rest);
    } else if (word == "endfacet") {
      in_facet_ = false;
    } else {
      return false;
    }
    return true;
  }

  /// Of a solid without facets in one line.
  static bool ends_solid(std::string_view rest) {
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      if (lower_case(word) == "endsolid") return true;
    }
    return false;
  }

  /// Three or four numbers, which some programs write for a facet or a whole solid, in any order of statements.
  void colour(std::string_view& rest) {
    ++(in_facet_ ? face_colours_ : solid_colours_);
    std::string_view behind = rest;
    for (std::string_view word = take_word(behind); !word.empty(); word = take_word(behind)) {
      double value = 0.0;
      if (parse_number(word.data(), word.data() + word.size(), value) != word.data() + word.size()) return;
      rest = behind;
    }
  }

  void vertex(std::string_view& rest) {
    std::array<double, 3> v{};
    for (double& value : v) {
      const std::string_view number = take_word(rest);
      const char* const end = number.data() + number.size();
      if (number.empty() || parse_number(number.data(), end, value) != end) {
        throw file_.error_at(lines_.number(), in_quotes(number) + " in a vertex", "'vertex x y z'");
      }
    }
    if (found_ == 3 || !in_loop_) throw file_.error_at(lines_.number(), "a vertex too many", "three in a loop");
    corners_[found_++] = sink_.vertex(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
  }

  void end_loop() {
    if (found_ != 3) {
      throw file_.error_at(lines_.number(), "a loop of " + std::to_string(found_) + " vertices", "three vertices");
    }
    sink_.triangle(corners_);
    in_loop_ = false;
    any_ = true;
  }

  const ScanFile& file_;
  ScanWriter& out_;
  TriangleSink sink_;
  LineReader lines_;
  std::array<std::uint32_t, 3> corners_{};
  std::size_t found_ = 0;
  bool in_loop_ = false;
  bool in_facet_ = false;
  std::uint64_t face_colours_ = 0, solid_colours_ = 0;
  int solids_ = 0;
  bool any_ = false;
};

void read_ascii(const ScanFile& file, ScanWriter& out) {
  out.scan().format = "STL ascii";
  out.begin(0, false, false);
  if (out.may_refuse()) {
    const std::uint64_t count = count_loops(file);
    out.expect_mesh(vertices_of(count), count);
  }
  AsciiReader(file, out).read();
}

}  // namespace

bool is_binary_stl(const ScanFile& file) {
  if (file.bytes.size() < kHeader) return false;
  const std::uint64_t count = load<std::uint32_t>(file.bytes.data() + 80);
  return file.bytes.size() == kHeader + count * kTriangle;
}

bool is_ascii_stl(const ScanFile& file) {
  std::string_view head = file.bytes.substr(0, 4096);
  if (looks_binary(head)) return false;
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  const std::string lower = lower_case(head);
  return lower.rfind("solid", 0) == 0 &&
         (lower.find("facet") != std::string::npos || lower.find("endsolid") != std::string::npos);
}

void read_stl(const ScanFile& file, ScanWriter& out) {
  out.scan().fields = {"x", "y", "z"};
  const bool ascii = !is_binary_stl(file) && is_ascii_stl(file);
  ascii ? read_ascii(file, out) : read_binary(file, out);
}

}  // namespace sparsha::pipeline

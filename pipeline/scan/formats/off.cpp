// Vertices stand a line each, or anyhow where the first of them does not; faces are as long as their first number says.
// http://www.geomview.org/docs/html/OFF.html, with what files in use add to it.
#include "pipeline/scan/formats/off.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/text/lower_case.h"
#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/scalar.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

/// What the first word says of each vertex.
struct Kind {
  bool texture = false, colour = false, normal = false, four = false, dimension = false;
};

/// The kind that the word names, and how long its letters are: a count may follow without a blank, "OFF8".
std::optional<std::pair<Kind, std::size_t>> kind_of(std::string_view word) {
  const std::string lower = lower_case(word.substr(0, 16));
  Kind kind;
  std::size_t at = 0;
  const auto take = [&](std::string_view letters) {
    const bool found = lower.compare(at, letters.size(), letters) == 0;
    if (found) at += letters.size();
    return found;
  };
  kind.texture = take("st");
  kind.colour = take("c");
  // 'NOFF' has normals, 'nOFF' names its dimension.
  const bool dimension = word.substr(at, 4) == "nOFF";
  kind.normal = !dimension && take("n");
  if (!kind.colour) kind.colour = take("c");  // 'NCOFF', as some programs have it
  kind.four = take("4");
  kind.dimension = take("n");
  if (!take("off")) return std::nullopt;
  if (at < word.size() && !(word[at] >= '0' && word[at] <= '9')) return std::nullopt;
  return std::pair{kind, at};
}

/// Lines that hold anything, without remarks.
class Lines {
 public:
  explicit Lines(std::string_view text) : lines_(text) {}
  bool next(std::string_view& line) {
    while (lines_.next(line)) {
      line = line.substr(0, line.find('#'));
      line.remove_prefix(std::min(line.find_first_not_of(" \t\v\f"), line.size()));
      if (!line.empty()) return true;
    }
    return false;
  }
  [[nodiscard]] int number() const { return lines_.number(); }
  [[nodiscard]] std::size_t offset() const { return lines_.offset(); }

 private:
  LineReader lines_;
};

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), lines_(file.bytes) {}

  void read() {
    read_header();
    read_vertices();
    read_faces();
    if (uncertain_) {
      out_.scan().warnings.push_back(
          "values behind the coordinates are not used, as the first word names neither colours nor normals ('COFF', "
          "'NOFF')");
    }
    if (coloured_faces_ > 0) {
      out_.scan().warnings.push_back(unused_face_colours(coloured_faces_));
    }
  }

 private:
  [[nodiscard]] Error ends(const char* within, const char* expected) const {
    return file_.error_at(std::max(1, lines_.number()), std::string("the file ends within ") + within, expected);
  }

  /// The next word, from the following lines when this one has no more.
  std::string_view word(const char* within, const char* expected) {
    std::string_view found = take_word(line_);
    while (found.empty()) {
      if (!lines_.next(line_)) throw ends(within, expected);
      found = take_word(line_);
    }
    return found;
  }

  std::uint64_t count(std::string_view text, const char* of) {
    std::int64_t value = -1;
    const char* const end = text.data() + text.size();
    if (parse_integer(text.data(), end, value) != end || value < 0) {
      throw file_.error_at(lines_.number(), in_quotes(text) + " is no number of " + of,
                           "three whole numbers: vertices, faces, edges");
    }
    return static_cast<std::uint64_t>(value);
  }

  double number(std::string_view text, const char* in) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    if (parse_number(text.data(), end, value) != end) {
      throw file_.error_at(lines_.number(), in_quotes(text) + " in " + in, "numbers with blanks between them");
    }
    return value;
  }

  void read_header() {
    constexpr const char* kExpected = "'OFF', then the numbers of vertices, faces and edges";
    constexpr const char* kHeader = "the header";
    if (!lines_.next(line_)) throw ends(kHeader, kExpected);
    const std::string_view first_line = line_;
    const std::string_view first = take_word(line_);
    std::string_view vertices;
    if (const auto kind = kind_of(first)) {
      kind_ = kind->first;
      vertices = first.substr(kind->second);
    } else {
      line_ = first_line;  // the word may be missing where the file's name ends with .off
    }
    if (kind_.dimension) {
      const std::uint64_t dimension = count(vertices.empty() ? word(kHeader, kExpected) : vertices, "dimensions");
      vertices = {};
      if (dimension != 3) {
        throw file_.error_at(lines_.number(), "an OFF mesh of " + std::to_string(dimension) + " dimensions", "three");
      }
    }
    vertices_ = count(vertices.empty() ? word(kHeader, kExpected) : vertices, "vertices");
    const int line = lines_.number();
    faces_ = count(word(kHeader, kExpected), "faces");
    // The number of edges may be missing where the other two stand in one line.
    (void)(lines_.number() > line ? word(kHeader, kExpected) : take_word(line_));
    constexpr std::uint64_t kShortest = 6;  // "0 0 0" and its end
    const std::uint64_t left = file_.bytes.size() - lines_.offset() + line_.size() + 1;
    if (vertices_ > left / kShortest + 1 || faces_ > left / 2 + 1) {
      throw file_.error_at(lines_.number(),
                           std::to_string(vertices_) + " vertices and " + std::to_string(faces_) +
                               " faces cannot be in the " + std::to_string(left) + " bytes that follow",
                           "a header that fits the file; it may be cut short");
    }
    RawScan& scan = out_.scan();
    scan.format = std::string(kind_.texture ? "ST" : "") + (kind_.colour ? "C" : "") + (kind_.normal ? "N" : "") +
                  (kind_.four ? "4" : "") + "OFF text";
    scan.fields = {"x", "y", "z"};
  }

  /// Which values of a vertex are what, from the first of them.
  void find_columns(std::size_t found) {
    const std::size_t coordinates = kind_.four ? 4 : 3;
    normal_at_ = kind_.normal ? coordinates : 0;
    const std::size_t before = coordinates + (kind_.normal ? 3 : 0);
    const std::size_t texture = kind_.texture ? 2 : 0;
    const std::size_t colours = found > before + texture ? found - before - texture : 0;
    // Files in use have colours without saying so; they are three or four, as those of COFF are.
    const bool plain = !kind_.normal && !kind_.texture;
    by_lines_ = found == before + texture || colours == 3 || colours == 4;
    if (by_lines_ && (kind_.colour || plain) && (colours == 3 || colours == 4) && are_colours(before, colours)) {
      colour_at_ = before;
      colours_ = colours;
    } else if (by_lines_ && colours > 0) {
      uncertain_ = true;
    }
    if (!by_lines_ && kind_.colour) {
      colour_at_ = before;
      colours_ = 4;
    }
    values_.resize(by_lines_ ? before : before + texture + (kind_.colour ? 4 : 0));
    values_.resize(std::max(values_.size(), colour_at_ + colours_));
    RawScan& scan = out_.scan();
    if (kind_.normal) scan.fields.insert(scan.fields.end(), {"nx", "ny", "nz"});
    if (colour_at_ > 0) scan.fields.insert(scan.fields.end(), {"red", "green", "blue"});
    if (colours_ == 4) scan.fields.emplace_back("alpha");
    out_.expect_mesh(vertices_, faces_);
    out_.begin(vertices_, colour_at_ > 0, false, kind_.normal);
  }

  /// Looks at the colours of vertices: whether they can be some, and their scale.
  bool are_colours(std::size_t at, std::size_t colours) {
    Lines lines = first_lines_;
    std::string_view line = first_vertex_;
    ColourRange range(true);
    bool good = true;
    std::uint64_t vertex = 0;
    at_sampled_records(vertices_, [&](std::uint64_t v) {
      for (; vertex < v; ++vertex) {
        if (!lines.next(line)) return false;
      }
      std::string_view rest = line;
      for (std::size_t k = 0; good && k < at + colours; ++k) {
        const std::string_view text = take_word(rest);
        double value = 0.0;
        if (k < at) continue;
        good = !text.empty() && parse_number(text.data(), text.data() + text.size(), value) != nullptr &&
               value >= 0.0 && value <= 65535.0;
        range.look(value);
      }
      return good;
    });
    scale_ = range.scale();
    return good;
  }

  void read_vertices() {
    if (vertices_ == 0) {
      out_.begin(0, false, false);
      return;
    }
    constexpr const char* kWithin = "the vertices";
    if (line_.find_first_not_of(" \t\v\f") == std::string_view::npos && !lines_.next(line_)) {
      throw ends(kWithin, "a line 'x y z' for each");
    }
    first_vertex_ = line_;
    first_lines_ = lines_;
    std::string_view rest = line_;
    std::size_t found = 0;
    while (!take_word(rest).empty()) ++found;
    find_columns(found);
    for (std::uint64_t v = 0; v < vertices_; ++v) {
      if (by_lines_ && v > 0 && !lines_.next(line_)) throw ends(kWithin, "a line for each vertex");
      for (std::size_t k = 0; k < values_.size(); ++k) {
        const std::string_view text = by_lines_ ? take_word(line_) : word(kWithin, "as many as promised");
        if (text.empty()) {
          throw file_.error_at(lines_.number(), "a vertex of " + std::to_string(k) + " values",
                               std::to_string(values_.size()) + " values, as the first vertex has");
        }
        values_[k] = number(text, "a vertex");
      }
      if (by_lines_) line_ = {};
      add_vertex();
      if ((v & 0xFFFF) == 0xFFFF) file_.done_before(lines_.offset() - 1);
    }
  }

  void add_vertex() {
    const double w = kind_.four ? values_[3] : 1.0;  // 4OFF is homogeneous
    if (kind_.normal) out_.set_normal(values_[normal_at_], values_[normal_at_ + 1], values_[normal_at_ + 2]);
    std::uint32_t rgba = kNoColour;
    if (colour_at_ > 0) {
      const auto byte = [&](std::size_t k) { return colour_byte(values_[colour_at_ + k], scale_); };
      rgba = pack_rgba(byte(0), byte(1), byte(2), colours_ == 4 ? byte(3) : 255);
    }
    out_.add(values_[0] / w, values_[1] / w, values_[2] / w, rgba);
  }

  void read_faces() {
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    constexpr const char* kExpected = "a line for each face: the number of its corners, then theirs";
    std::vector<std::uint32_t> corners;
    for (std::uint64_t f = 0; f < faces_; ++f) {
      const std::uint64_t size = count(word("the faces", kExpected), "corners of a face");
      if (size > ScanWriter::kMostCorners) {
        throw file_.error_at(lines_.number(), "a face of " + std::to_string(size) + " corners",
                             "at most " + std::to_string(ScanWriter::kMostCorners));
      }
      corners.clear();
      for (std::uint64_t k = 0; k < size; ++k) {
        const std::string_view text = word("the faces", kExpected);
        std::int64_t index = 0;
        const char* const end = text.data() + text.size();
        if (parse_integer(text.data(), end, index) != end) {
          throw file_.error_at(lines_.number(), in_quotes(text) + " is no vertex of a face", "whole numbers from 0");
        }
        corners.push_back(index < 0 || index >= kNone ? kNone : static_cast<std::uint32_t>(index));
      }
      if (by_lines_ && !take_word(line_).empty()) ++coloured_faces_;  // a face's colour reaches to the end of its line
      if (by_lines_) line_ = {};
      out_.add_polygon(corners);
      if ((f & 0xFFFF) == 0xFFFF) file_.done_before(lines_.offset() - 1);
    }
  }

  const ScanFile& file_;
  ScanWriter& out_;
  Lines lines_;
  std::string_view line_;  ///< what is left of the present line
  std::string_view first_vertex_;
  Lines first_lines_{{}};  ///< behind it
  Kind kind_;
  std::uint64_t vertices_ = 0, faces_ = 0;
  bool by_lines_ = true;
  bool uncertain_ = false;
  std::size_t normal_at_ = 0, colour_at_ = 0, colours_ = 0;
  ColourScale scale_ = ColourScale::unit;
  std::vector<double> values_;
  std::uint64_t coloured_faces_ = 0;
};

}  // namespace

bool is_off(const ScanFile& file) {
  if (file.extension == "off") return true;
  Lines lines(file.bytes.substr(0, 4096));
  std::string_view line;
  if (!lines.next(line)) return false;
  const std::string_view word = take_word(line);
  const auto kind = kind_of(word);
  if (!kind) return false;
  if (kind->second < word.size()) return true;
  // A number must come next: the word may also be the name of a column.
  std::string_view number = take_word(line);
  if (number.empty() && lines.next(line)) number = take_word(line);
  std::int64_t value = 0;
  return !number.empty() && parse_integer(number.data(), number.data() + number.size(), value) != nullptr;
}

void read_off(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline

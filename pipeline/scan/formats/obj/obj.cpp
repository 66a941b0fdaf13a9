#include "pipeline/scan/formats/obj/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/formats/obj/materials.h"
#include "pipeline/scan/formats/obj/statements.h"
#include "pipeline/scan/formats/remark_unit.h"
#include "pipeline/scan/scalar.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

using obj::is_vertex;
using obj::Statements;

/// An exponent whose sign stands before its letter, "3.1+e2", is read as "3.1e+2"; found in files.
const char* parse_swapped_exponent(const char* p, const char* end, double& value) {
  if (end - p < 3 || (*p != '+' && *p != '-') || (p[1] != 'e' && p[1] != 'E')) return p;
  std::int64_t power = 0;
  const char* const stop = parse_integer(p + 2, end, power);
  if (stop == nullptr || power < 0 || power > 300) return p;
  value *= std::pow(10.0, static_cast<double>(*p == '-' ? -power : power));
  return stop;
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out) {}

  void read() {
    paint_ = obj::paint_of(file_, out_);
    inspect();
    Statements statements(file_.bytes);
    std::string_view statement;
    std::size_t told = 0;
    while (statements.next(statement)) {
      if (is_vertex(statement)) {
        vertex(statement, statements.number());
      } else if (const std::size_t keyword = obj::face_keyword(statement); keyword > 0) {
        face(statement.substr(keyword), statements.number());
        ++faces_;
      } else {
        count_other(statement);
      }
      if (statements.offset() - told > (1U << 22)) {
        told = statements.offset();
        file_.done_before(told - 1);
      }
    }
    if (vertices_ == 0) throw file_.empty("the OBJ file has no vertices", "lines 'v x y z'");
    RawScan& scan = out_.scan();
    decide_first_number();
    if (swapped_ > 0) {
      scan.warnings.push_back(std::to_string(swapped_) + " numbers like '3.1+e2' were read as '3.1e+2'");
    }
    take_unit_of_remarks();
    tell_others();
    if (uncoloured_ > 0) {
      scan.warnings.push_back("only some vertices have colours; " + std::to_string(uncoloured_) + " have none");
    }
  }

 private:
  /// Finds the scale of colours from vertices all over the file, and the largest value of the first of them.
  void look_at_colours(double largest) {
    ColourRange range(true);
    range.look(largest);
    for (const std::string_view part : sampled_lines(file_.bytes)) {
      Statements statements(part);
      std::string_view statement;
      while (!range.is_decided() && statements.next(statement)) {
        if (!is_vertex(statement)) continue;
        std::string_view rest = statement.substr(1);
        std::size_t count = 0;
        for (std::string_view word = take_word(rest); !word.empty() && word[0] != '#' && count < values_.size();
             word = take_word(rest), ++count) {
          if (parse_number(word.data(), word.data() + word.size(), values_[count]) == nullptr) break;
        }
        if (count < 6) continue;
        const std::size_t k = colour_place(count);
        for (std::size_t channel = k; channel < k + 3; ++channel) range.look(values_[channel]);
      }
    }
    scale_ = range.scale();
  }
  /// Of a vertex of so many numbers, six or seven: one of six has no weight.
  [[nodiscard]] std::size_t colour_place(std::size_t count) const { return count == 7 ? first_colour_ : 3; }

  /// Colours or not, and what the fourth number is, from the first vertices.
  void inspect() {
    Statements statements(file_.bytes);
    std::string_view statement;
    double largest = 0.0, largest_behind_weight = 0.0;
    Range fourth, fifth, sixth, seventh;
    for (int seen = 0; seen < 1000 && statements.next(statement);) {
      if (!is_vertex(statement)) continue;
      ++seen;
      const int count = parse_values(statement, statements.number());
      if (count < 6) continue;
      colour_ = true;
      for (std::size_t k = 3; k < 6; ++k) largest = std::max(largest, values_[k]);
      fourth.add(values_[3]);
      if (count < 7) continue;
      for (std::size_t k = 4; k < 7; ++k) largest_behind_weight = std::max(largest_behind_weight, values_[k]);
      fifth.add(values_[4]);
      sixth.add(values_[5]);
      seventh.add(values_[6]);
    }
    // Of seven numbers the fourth is a weight where it is always 1 and the last, as an opacity, would vary; white or
    // red vertices of some opacity have others that do not.
    const bool vary = fifth.most > fifth.least && sixth.most > sixth.least && seventh.most > seventh.least;
    if (fourth.is_always(1.0) && vary) {
      first_colour_ = 4;
      largest = largest_behind_weight;
    }
    if (colour_) look_at_colours(largest);
    swapped_ = 0;
    RawScan& scan = out_.scan();
    scan.format = "OBJ";
    scan.fields = {"x", "y", "z"};
    if (colour_) scan.fields.insert(scan.fields.end(), {"red", "green", "blue"});
    if (first_colour_ == 4) {
      scan.notes.emplace_back("OBJ: the fourth of seven numbers of a vertex is 1, a weight; colours are behind it");
    }
    out_.begin(0, colour_ || paint_.any(), false);
  }

  /// Faces count from 1. Some programs let them count from 0: then they name 0, and never the last vertex.
  void decide_first_number() {
    if (zeros_ == 0) return;
    std::vector<std::string>& warnings = out_.scan().warnings;
    const bool from_zero = !counts_back_ && highest_ + 1 == static_cast<std::int64_t>(vertices_);
    if (from_zero && !paint_.any()) {
      out_.count_faces_from_zero();
      warnings.push_back(
          "the faces count from 0, as OBJ files should not: they name vertex 0, and never the last one; "
          "they are read so");
    } else if (from_zero) {
      warnings.push_back(
          "the faces seem to count from 0: they name vertex 0, and never the last one; they are read as "
          "if they counted from 1, since their pictures are; write them so");
    } else {
      warnings.push_back(fmt::format(
          "{} vertex 0, while OBJ files count from 1; if all faces count from 0, each of them is a vertex off",
          zeros_ == 1 ? "1 corner of faces names" : fmt::format("{} corners of faces name", zeros_)));
    }
  }

  /// Elements that are no faces.
  void count_other(std::string_view statement) {
    for (std::size_t k = 0; k < kOthers.size(); ++k)
      others_[k] += obj::begins_with(statement, kOthers[k].keyword) ? 1 : 0;
  }

  /// Lines and points beside faces are what modellers leave behind; without faces they may be all that was meant.
  void tell_others() {
    RawScan& scan = out_.scan();
    std::string words;
    bool surface = false;
    for (std::size_t k = 0; k < kOthers.size(); ++k) {
      if (others_[k] == 0) continue;
      words +=
          fmt::format("{}{} ('{}', {})", words.empty() ? "" : ", ", kOthers[k].name, kOthers[k].keyword, others_[k]);
      surface = surface || kOthers[k].surface;
    }
    if (words.empty()) return;
    const std::string text = "not used: " + words + "; ";
    if (surface) {
      scan.warnings.push_back(text + "their control points are taken as points; export the surface as triangles");
    } else if (faces_ > 0) {
      scan.notes.push_back(text + "the faces are the surface");
    } else if (others_[0] > 0) {
      scan.warnings.push_back(text + "the file has no faces, and its vertices are taken as points");
    } else {
      scan.notes.push_back(text + "all vertices are points");
    }
  }

  /// "# File units = mm" and the like, before the first vertex.
  void take_unit_of_remarks() {
    LineReader lines(file_.bytes.substr(0, 1 << 16));
    std::string_view line;
    while (lines.next(line)) {
      const char* const begin = skip_blanks(line.data(), line.data() + line.size());
      line.remove_prefix(static_cast<std::size_t>(begin - line.data()));
      if (is_vertex(line)) return;
      if (line.empty() || line[0] != '#') continue;
      if (!out_.scan().several_units) take_unit_of_remark(line, lines.number(), out_.scan());
    }
  }

  /// Numbers behind the keyword, at most seven.
  int parse_values(std::string_view statement, int line) {
    const char* p = statement.data() + 1;
    const char* const end = statement.data() + statement.size();
    int count = 0;
    for (p = skip_blanks(p, end); p < end && *p != '#'; p = skip_blanks(p, end)) {
      double value = 0.0;
      const char* stop = parse_number(p, end, value);
      if (stop != nullptr && stop < end && !is_blank(*stop)) {
        const char* const swapped = parse_swapped_exponent(stop, end, value);
        if (swapped != stop) ++swapped_;
        stop = swapped;
      }
      if (stop == nullptr || (stop < end && !is_blank(*stop)) || count == 7) {
        throw file_.error_at(line, in_quotes({p, static_cast<std::size_t>(end - p)}) + " in a vertex",
                             "three coordinates and at most four more numbers");
      }
      values_[static_cast<std::size_t>(count++)] = value;
      p = stop;
    }
    if (count < 3) throw file_.error_at(line, "a vertex with " + std::to_string(count) + " numbers", "'v x y z'");
    return count;
  }

  void vertex(std::string_view statement, int line) {
    const int count = parse_values(statement, line);
    std::uint32_t rgba = kNoColour;
    if (count >= 6) {
      const std::size_t k = colour_place(static_cast<std::size_t>(count));
      rgba =
          pack_rgba(colour_byte(values_[k], scale_), colour_byte(values_[k + 1], scale_),
                    colour_byte(values_[k + 2], scale_), count == 7 && k == 3 ? colour_byte(values_[6], scale_) : 255);
    } else if (colour_) {
      ++uncoloured_;
    }
    if (const std::uint32_t painted = paint_[vertices_]; painted != kNoColour) rgba = painted;
    out_.add(values_[0], values_[1], values_[2], rgba);
    ++vertices_;
  }

  void face(std::string_view rest, int line) {
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    corners_.clear();
    int zeros = 0;
    for (std::string_view word = take_word(rest); !word.empty() && word[0] != '#'; word = take_word(rest)) {
      std::int64_t index = 0;
      const char* const stop = parse_integer(word.data(), word.data() + word.size(), index);
      if (stop == nullptr || (stop < word.data() + word.size() && *stop != '/')) {
        throw file_.error_at(line, in_quotes(word) + " is no vertex of a face", "'v', 'v/t', 'v//n' or 'v/t/n'");
      }
      if (corners_.size() == ScanWriter::kMostCorners) {
        throw file_.error_at(line, "a face of more than " + std::to_string(corners_.size()) + " corners", "fewer");
      }
      zeros += index == 0 ? 1 : 0;
      highest_ = std::max(highest_, index);
      counts_back_ = counts_back_ || index < 0;
      // Negative numbers count back from the last vertex so far.
      const std::int64_t number = index < 0 ? static_cast<std::int64_t>(vertices_) + index : index - 1;
      corners_.push_back(index == 0 || number < 0 || number >= kNone ? kNone : static_cast<std::uint32_t>(number));
    }
    zeros_ += zeros == 1 ? 1 : 0;  // a face of nothing but zeros holds a place
    out_.add_polygon(corners_);
  }

  struct Range {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;

    void add(double value) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
    [[nodiscard]] bool is_always(double value) const { return least == value && most == value; }
  };

  struct Other {
    std::string_view keyword;
    std::string_view name;
    bool surface;  ///< whose vertices are control points
  };
  static constexpr std::array<Other, 5> kOthers = {{{"l", "lines", false},
                                                    {"p", "points", false},
                                                    {"curv", "curves", true},
                                                    {"curv2", "curves", true},
                                                    {"surf", "surfaces", true}}};

  const ScanFile& file_;
  ScanWriter& out_;
  Paint paint_;
  std::array<double, 7> values_{};
  std::array<std::uint64_t, kOthers.size()> others_{};
  std::uint64_t faces_ = 0;
  std::vector<std::uint32_t> corners_;
  std::uint64_t vertices_ = 0;
  std::uint64_t zeros_ = 0;   ///< corners of faces that name vertex 0
  std::int64_t highest_ = 0;  ///< that a face names
  bool counts_back_ = false;
  bool colour_ = false;
  std::size_t first_colour_ = 3;  ///< of seven numbers
  ColourScale scale_ = ColourScale::unit;
  std::uint64_t swapped_ = 0;
  std::uint64_t uncoloured_ = 0;
};

}  // namespace

bool is_obj(const ScanFile& file) {
  static constexpr std::string_view kKeywords[] = {"v", "vn", "vt",     "f",      "fo", "o",
                                                   "g", "s",  "mtllib", "usemtl", "l",  "p"};
  Statements statements(file.bytes.substr(0, 1 << 16));
  std::string_view statement;
  for (int seen = 0; seen < 16 && statements.next(statement); ++seen) {
    std::string_view rest = statement;
    const std::string_view word = take_word(rest);
    bool known = false;
    for (const std::string_view keyword : kKeywords) known = known || word == keyword;
    if (!known) return false;
    if (word == "v" || word == "f" || word == "fo" || word == "mtllib") return true;
  }
  return false;
}

void read_obj(const ScanFile& file, ScanWriter& out) { Reader(file, out).read(); }

}  // namespace sparsha::pipeline

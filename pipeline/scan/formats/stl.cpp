#include "pipeline/scan/formats/stl.h"

#include <array>
#include <bit>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"
#include "base/text/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kTriangle = 50;

/// Vertices are the same where their float32 coordinates are.
struct Vertex {
  std::array<std::uint32_t, 3> key;  ///< the bits of x, y and z
};
struct VertexHash {
  std::uint64_t operator()(const std::array<std::uint32_t, 3>& key) const {
    return hash_words(std::array<std::uint64_t, 2>{std::uint64_t{key[0]} << 32U | key[1], key[2]});
  }
};

class TriangleSink {
 public:
  explicit TriangleSink(ScanWriter& out) : out_(out) {}

  std::uint32_t vertex(float x, float y, float z) {
    // -0.0 and 0.0 are the same place.
    const std::size_t before = table_.size();
    const std::uint32_t number =
        table_.number({std::bit_cast<std::uint32_t>(x + 0.0F), std::bit_cast<std::uint32_t>(y + 0.0F),
                       std::bit_cast<std::uint32_t>(z + 0.0F)});
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
  KeyTable<Vertex, VertexHash> table_;
};

/// A closed surface has half as many vertices as triangles.
std::uint64_t vertices_of(std::uint64_t triangles) { return triangles / 2 + 2; }

std::uint64_t count_loops(const ScanFile& file) {
  std::uint64_t count = 0;
  LineReader lines(file.bytes);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view word = take_word(line);
    if (word.size() != 7 || (word[0] | 0x20) != 'e' || lower_case(word) != "endloop") continue;
    if ((++count & 0xFFFF) == 0) file.done_before(lines.offset() - 1);
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
  const char* p = file.bytes.data() + kHeader;
  for (std::uint64_t i = 0; i < count; ++i, p += kTriangle) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const char* const v = p + 12 + 12 * k;
      corners[k] = sink.vertex(load<float>(v), load<float>(v + 4), load<float>(v + 8));
    }
    sink.triangle(corners);
    if ((i & 0xFFFF) == 0xFFFF) file.done_before(static_cast<std::size_t>(p - file.bytes.data()));
  }
}

void read_ascii(const ScanFile& file, ScanWriter& out) {
  out.scan().format = "STL ascii";
  out.begin(0, false, false);
  if (out.may_refuse()) {
    const std::uint64_t count = count_loops(file);
    out.expect_mesh(vertices_of(count), count);
  }
  TriangleSink sink(out);
  LineReader lines(file.bytes);
  std::string_view line;
  std::array<std::uint32_t, 3> corners{};
  std::size_t found = 0;
  bool in_loop = false;
  int solids = 0;
  bool any = false;
  std::size_t told = 0;
  while (lines.next(line)) {
    if (lines.offset() - told > (1U << 22)) {
      told = lines.offset();
      file.done_before(told - line.size() - 1);
    }
    std::string_view rest = line;
    const std::string word = lower_case(take_word(rest));
    if (word == "solid") {
      ++solids;
    } else if (word == "outer") {
      found = 0;
      in_loop = true;
    } else if (word == "vertex") {
      std::array<double, 3> v{};
      for (double& value : v) {
        const std::string_view number = take_word(rest);
        const char* const end = number.data() + number.size();
        if (number.empty() || parse_number(number.data(), end, value) != end) {
          throw file.error_at(lines.number(), in_quotes(number) + " in a vertex", "'vertex x y z'");
        }
      }
      if (found == 3 || !in_loop) throw file.error_at(lines.number(), "a vertex too many", "three in a loop");
      corners[found++] = sink.vertex(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
    } else if (word == "endloop") {
      if (found != 3) {
        throw file.error_at(lines.number(), "a loop of " + std::to_string(found) + " vertices", "three vertices");
      }
      sink.triangle(corners);
      in_loop = false;
      any = true;
    } else if (word == "endsolid") {
      --solids;
    } else if (!word.empty() && word != "facet" && word != "endfacet") {
      throw file.error_at(lines.number(), "unknown STL line " + in_quotes(word), "'facet', 'vertex', 'endloop'");
    }
  }
  if (in_loop || solids > 0) {
    throw file.error_at(lines.number(), "the file ends within a solid", "'endsolid'; the file may be cut short");
  }
  if (!any) throw no_facets(file);
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

// PLY: header, ASCII and both binary bodies. Turk 1994, "The PLY Polygon File Format", with what files in use add to
// it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/splat/splats.h"
#include "pipeline/scan/formats/texture/paint.h"
#include "pipeline/scan/scalar.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// True when the bytes begin as a PLY file does.
[[nodiscard]] bool is_ply(const ScanFile& file);
void read_ply(const ScanFile& file, ScanWriter& out);

namespace ply {

struct Property {
  std::string name;  ///< lower case
  ScalarType type = ScalarType::f32;
  std::optional<ScalarType> count_type;  ///< of a list
};

struct Element {
  std::string name;  ///< lower case
  std::uint64_t count = 0;
  std::vector<Property> properties;
  int line = 0;

  [[nodiscard]] bool has_lists() const;
  /// Fewest bytes of one record: lists empty in binary, one digit and one separator a value in ASCII.
  [[nodiscard]] std::size_t least_size(bool ascii) const;
  /// Index of the first property with one of the names, -1 without.
  [[nodiscard]] int find(std::initializer_list<std::string_view> names) const;
};

enum class Encoding : std::uint8_t { ascii, little, big };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t body = 0;  ///< offset of the first byte behind the header
  int lines = 0;
  std::vector<std::string> notes;                         ///< software and textures that its remarks name
  std::vector<std::string> textures;                      ///< in the order of their numbers
  std::vector<std::pair<std::string, int>> unit_remarks;  ///< lines that give the unit, and their numbers
};

[[nodiscard]] Header parse_header(const ScanFile& file);

/// Which properties of the vertex element are what; -1 where it has none.
struct VertexColumns {
  int x = -1, y = -1, z = -1;
  int red = -1, green = -1, blue = -1, alpha = -1;
  int packed = -1;  ///< may be colours in one whole number, where there are no others; see PackedColours
  int intensity = -1;
  int nx = -1, ny = -1, nz = -1;
  int opacity = -1;
  std::array<int, 3> axes = {-1, -1, -1};  ///< of splats; flat ones (Huang et al. 2024) have two, round ones one
  bool splats = false;                     ///< Gaussian splats, see VertexField::logit
  bool splat_colour = false;               ///< red, green and blue are as colour_of_splat() takes them

  [[nodiscard]] bool has_colour() const { return red >= 0 && green >= 0 && blue >= 0; }
  /// The longest axis by the values of its columns; -infinity without any.
  template <typename Value>
  [[nodiscard]] double longest_axis(const Value& value) const {
    double longest = -std::numeric_limits<double>::infinity();
    for (const int axis : axes) longest = axis < 0 ? longest : longer_axis(longest, value(axis));
    return longest;
  }
  /// Splats with all that tells which of them are no surface.
  [[nodiscard]] bool has_whole_splats() const { return splats && opacity >= 0 && axes[0] >= 0; }
  [[nodiscard]] bool has_normals() const { return nx >= 0 && ny >= 0 && nz >= 0; }
};
[[nodiscard]] VertexColumns vertex_columns(const ScanFile& file, const Element& vertex);

/// A property that somebody asks for.
struct VertexField {
  std::size_t column = 0;
  int slot = 0;
  bool logit = false;  ///< a splat's opacity: 1 / (1 + exp(-value)) is the one that people mean, 0 to 1
  double whole = 1.0;  ///< a splat's opacity that is no logit: the value of an opaque one

  [[nodiscard]] double value(double stored) const { return logit ? 1.0 / (1.0 + std::exp(-stored)) : stored / whole; }
};
/// Whole numbers of 32 bits that may be colours: 0xRRGGBB below a byte that is the same in all of them, as PCL packs
/// both `rgb` and `rgba`, or `rgba` as 0xRRGGBB before such a byte.
class PackedColours {
 public:
  explicit PackedColours(const Property& property) : named_rgba_(property.name == "rgba") {}

  void look(double stored) {
    const std::uint32_t value = bits(stored);
    if (!first_) first_ = value;
    top_same_ = top_same_ && value >> 24 == *first_ >> 24;
    low_same_ = low_same_ && (value & 255) == (*first_ & 255);
  }
  [[nodiscard]] bool good() const { return top_same_ || (named_rgba_ && low_same_); }
  [[nodiscard]] std::uint32_t rgba(double stored) const {
    return unpack_argb(top_same_ ? bits(stored) : bits(stored) >> 8, true);
  }
  /// Numbers called `rgba` that are no colours are said.
  void warn(RawScan& scan) const;

 private:
  static std::uint32_t bits(double stored) {
    constexpr double kWhole = 9e15;  // text may hold any number
    return std::fabs(stored) < kWhole ? static_cast<std::uint32_t>(static_cast<std::int64_t>(stored)) : 0;
  }

  bool named_rgba_;
  bool top_same_ = true, low_same_ = true;
  std::optional<std::uint32_t> first_;
};

/// Whether splats' opacities are logits, as training writes them, or what some programs write in their place: 0 to 1,
/// or whole numbers up to 255 or 65535. Logits from 0 to 1 alone would be a cloud whose splats all let a quarter to
/// half of the light through.
class OpacityRange {
 public:
  /// Of a property that is stored in that type.
  explicit OpacityRange(ScalarType type) : floating_(is_floating(type)) {}

  void look_at(double stored) {
    if (!std::isfinite(stored)) return;
    least_ = std::min(least_, stored);
    most_ = std::max(most_, stored);
    whole_ = whole_ && stored == std::floor(stored);
  }
  void tell(VertexField& field) const {
    field.logit = !is_share() && !is_count();
    field.whole = !is_count() ? 1.0 : most_ <= 255.0 ? 255.0 : 65535.0;
  }

 private:
  [[nodiscard]] bool is_share() const { return least_ >= 0.0 && most_ <= 1.0 && least_ < most_; }
  /// Floats only where no logit goes: that of 100 is opaque to 1e-43.
  [[nodiscard]] bool is_count() const {
    const double least_of_most = floating_ ? 100.0 : 1.0;
    return whole_ && least_ >= 0.0 && most_ > least_of_most && most_ <= 65535.0 && (least_ < most_ || !floating_);
  }

  bool floating_;
  bool whole_ = true;
  double least_ = std::numeric_limits<double>::infinity();
  double most_ = -std::numeric_limits<double>::infinity();
};

/// Splats as vertices have them: opacities are logits or shares, axes the logarithms of lengths.
class SplatVertices {
 public:
  /// With opacities that are stored in that type.
  explicit SplatVertices(ScalarType opacity) : range_(opacity) {}

  void look_at(double opacity, double longest) {
    range_.look_at(opacity);
    looked_.emplace_back(opacity, longest);
  }
  /// Ends the look.
  void decide();
  [[nodiscard]] bool keeps(double opacity, double longest) {
    return sieve_.keeps(opacity_.value(opacity), std::exp(longest));
  }
  void warn(RawScan& scan) const { sieve_.warn(scan); }

 private:
  OpacityRange range_;
  std::vector<std::pair<double, double>> looked_;
  VertexField opacity_{0, 0, true};
  SplatSieve sieve_;
};

[[nodiscard]] std::vector<VertexField> vertex_fields(const Element& vertex, const VertexColumns& columns,
                                                     ScanWriter& out);

/// What an element is to us.
enum class Role : std::uint8_t { vertex, face, strips, other };
/// By its name alone.
[[nodiscard]] bool is_face(const Element& element);
[[nodiscard]] Role role_of(const Element& element);
/// The list of vertex numbers of a face or strip element, -1 without.
[[nodiscard]] int index_list(const Element& element);

/// Triangles of a strip, -1 beginning a new one.
void add_strip(const std::vector<std::int64_t>& strip, ScanWriter& out);
/// A face whose vertex numbers may be anything.
void add_face(const std::vector<std::int64_t>& corners, ScanWriter& out);

/// Colours from the pictures that the header names, by coordinates of vertices (s and t, u and v) or of the corners of
/// faces (a list `texcoord`, with `texnumber`). Damage is left to those who read the body.
[[nodiscard]] Paint paint_of(const ScanFile& file, const Header& header, ScanWriter& out);

void read_ascii_body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out);
void read_binary_body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out);

}  // namespace ply
}  // namespace sparsha::pipeline

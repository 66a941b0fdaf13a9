// Textures of PLY as MeshLab and photogrammetry programs write them: 'comment TextureFile NAME', coordinates from the
// bottom left corner.
#include <algorithm>
#include <span>

#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::ply {
namespace {

/// Values of a record one after the other; a list begins with its length.
struct Record {
  std::vector<double> values;
  std::vector<std::size_t> begins;  ///< of each property

  [[nodiscard]] double scalar(int column) const { return values[begins[static_cast<std::size_t>(column)]]; }
  [[nodiscard]] std::size_t length(int list) const { return static_cast<std::size_t>(scalar(list)); }
  [[nodiscard]] double item(int list, std::size_t k) const {
    return values[begins[static_cast<std::size_t>(list)] + 1 + k];
  }
};

/// Reads records of either kind; false where the file ends or is damaged.
class Records {
 public:
  Records(const ScanFile& file, const Header& header)
      : encoding_(header.encoding),
        p_(file.bytes.data() + header.body),
        end_(file.bytes.data() + file.bytes.size()),
        lines_(file.bytes, header.body, header.lines) {}

  bool next(const Element& element, Record& record) {
    record.values.clear();
    record.begins.clear();
    if (encoding_ == Encoding::ascii && !next_line()) return false;
    for (const Property& property : element.properties) {
      record.begins.push_back(record.values.size());
      if (!add(property.count_type.value_or(property.type), record)) return false;
      if (!property.count_type) continue;
      const double length = record.values.back();
      if (!(length >= 0.0) || length > static_cast<double>(std::min(left(), kMostValues))) return false;
      for (auto k = static_cast<std::size_t>(length); k > 0; --k)
        if (!add(property.type, record)) return false;
    }
    return true;
  }

  bool skip(const Element& element) {
    if (encoding_ == Encoding::ascii) {
      for (std::uint64_t k = 0; k < element.count; ++k)
        if (!next_line()) return false;
      return true;
    }
    if (element.has_lists()) {
      Record record;
      for (std::uint64_t k = 0; k < element.count; ++k)
        if (!next(element, record)) return false;
      return true;
    }
    const std::size_t size = element.least_size(false);
    if (size > 0 && left() / size < element.count) return false;
    p_ += size * static_cast<std::size_t>(element.count);
    return true;
  }

 private:
  static constexpr std::size_t kMostValues = 2 * ScanWriter::kMostCorners;

  [[nodiscard]] std::size_t left() const {
    return encoding_ == Encoding::ascii ? static_cast<std::size_t>(line_end_ - q_)
                                        : static_cast<std::size_t>(end_ - p_);
  }
  bool next_line() {
    std::string_view line;
    do {
      if (!lines_.next(line)) return false;
      q_ = line.data();
      line_end_ = q_ + line.size();
    } while (skip_blanks(q_, line_end_) == line_end_);
    return true;
  }
  bool add(ScalarType type, Record& record) {
    double value = 0.0;
    if (encoding_ == Encoding::ascii) {
      q_ = skip_blanks(q_, line_end_);
      const char* const stop = parse_number(q_, line_end_, value);
      if (stop == nullptr) return false;
      q_ = stop;
    } else {
      if (left() < size_of(type)) return false;
      value = encoding_ == Encoding::big ? load_scalar<true>(p_, type) : load_scalar<false>(p_, type);
      p_ += size_of(type);
    }
    record.values.push_back(value);
    return true;
  }

  Encoding encoding_;
  const char* p_;
  const char* end_;
  LineReader lines_;
  const char* q_ = nullptr;
  const char* line_end_ = nullptr;
};

/// Where coordinates are: two properties of vertices, or a list of faces with two values a corner.
struct Coordinates {
  int u = -1, v = -1;
  int list = -1, indices = -1, number = -1;

  [[nodiscard]] bool any() const { return (u >= 0 && v >= 0) || (list >= 0 && indices >= 0); }
};

Coordinates coordinates_of(const Element& element) {
  Coordinates found;
  const auto is_list = [&](int column) {
    return column >= 0 && element.properties[static_cast<std::size_t>(column)].count_type.has_value();
  };
  const Role role = role_of(element);
  if (role == Role::vertex) {
    for (const auto& [u, v] : {std::pair("texture_u", "texture_v"), std::pair("s", "t"), std::pair("u", "v"),
                               std::pair("texture_s", "texture_t"), std::pair("tx", "ty")}) {
      found.u = element.find({u});
      found.v = element.find({v});
      if (found.u >= 0 && found.v >= 0 && !is_list(found.u) && !is_list(found.v)) return found;
    }
    found.u = found.v = -1;
  } else if (role == Role::face) {
    found.list = element.find({"texcoord", "texcoords", "texture_coordinates"});
    if (!is_list(found.list)) found.list = -1;
    found.indices = index_list(element);
    found.number = element.find({"texnumber", "tex_number"});
    if (is_list(found.number)) found.number = -1;
  }
  return found;
}

void lay_face(const Record& record, const Coordinates& at, std::span<const std::uint32_t> pictures,
              std::uint64_t vertices, Paint& paint) {
  const std::size_t corners = record.length(at.indices);
  const double picture = at.number >= 0 ? record.scalar(at.number) : 0.0;
  if (record.length(at.list) < 2 * corners || !(picture >= 0.0) || picture >= static_cast<double>(pictures.size()))
    return;
  for (std::size_t k = 0; k < corners; ++k) {
    const double vertex = record.item(at.indices, k);
    if (!(vertex >= 0.0) || vertex >= static_cast<double>(vertices)) continue;
    paint.lay(static_cast<std::uint64_t>(vertex), pictures[static_cast<std::size_t>(picture)],
              record.item(at.list, 2 * k), record.item(at.list, 2 * k + 1));
  }
}

/// False where the file ends within the element.
bool lay(const ScanFile& file, Records& records, const Element& element, std::span<const std::uint32_t> pictures,
         std::uint64_t vertices, Paint& paint) {
  const Coordinates at = coordinates_of(element);
  if (!at.any()) return records.skip(element);
  Record record;
  for (std::uint64_t k = 0; k < element.count; ++k) {
    if (!records.next(element, record)) return false;
    if (at.u >= 0) {
      paint.lay(k, pictures[0], record.scalar(at.u), record.scalar(at.v));
    } else {
      lay_face(record, at, pictures, vertices, paint);
    }
    if ((k & 0xFFFFU) == 0) file.throw_if_cancelled();
  }
  return true;
}

}  // namespace

Paint paint_of(const ScanFile& file, const Header& header, ScanWriter& out) {
  Paint paint;
  std::uint64_t vertices = 0;
  bool any = false;
  for (const Element& element : header.elements) {
    if (role_of(element) == Role::vertex) vertices = element.count;
    any = any || (element.count > 0 && coordinates_of(element).any());
  }
  if (header.textures.empty()) return paint;
  if (!any) {
    out.scan().warnings.emplace_back(
        "a texture is named, and neither vertices nor faces have coordinates on it: its colours are missing");
    return paint;
  }
  std::vector<std::uint32_t> pictures;
  for (const std::string& name : header.textures) pictures.push_back(paint.picture(name));
  Records records(file, header);
  for (const Element& element : header.elements) {
    if (!element.properties.empty() && !lay(file, records, element, pictures, vertices, paint)) break;
  }
  paint.dry(file, out.scan().warnings);
  return paint;
}

}  // namespace sparsha::pipeline::ply

// Textures of PLY as MeshLab and photogrammetry programs write them: 'comment TextureFile NAME', coordinates from the
// bottom left corner.
#include <algorithm>
#include <array>
#include <optional>
#include <set>

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
  int list = -1, indices = -1;
  int number = -1;  ///< of the picture, of faces or vertices

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
      if (found.u >= 0 && found.v >= 0 && !is_list(found.u) && !is_list(found.v)) break;
      found.u = found.v = -1;
    }
  } else if (role == Role::face) {
    found.list = element.find({"texcoord", "texcoords", "texture_coordinates"});
    if (!is_list(found.list)) found.list = -1;
    found.indices = index_list(element);
  }
  found.number = element.find({"texnumber", "tex_number"});
  if (is_list(found.number)) found.number = -1;
  return found;
}

/// Lays what elements say of places on the pictures, which are at least one.
class Layer {
 public:
  Layer(const ScanFile& file, const Header& header, Paint& paint) : file_(file), paint_(paint) {
    for (const std::string& name : header.textures) pictures_.push_back(paint.picture(name));
    bool vertices = false;
    for (const Element& element : header.elements) {
      const Coordinates at = coordinates_of(element);
      if (role_of(element) == Role::vertex) {
        vertices = true;
        vertices_ = element.count;
        vertices_tell_picture_ = at.any() && at.number >= 0;
      } else if (element.count > 0 && vertices) {
        faces_tell_picture_ = faces_tell_picture_ || (at.indices >= 0 && at.number >= 0);
      }
    }
  }

  /// False where the file ends within the element.
  bool lay(Records& records, const Element& element) {
    const Coordinates at = coordinates_of(element);
    const bool face = role_of(element) == Role::face;
    // Coordinates of vertices whose pictures only the faces know wait for these.
    const bool waits = at.u >= 0 && pictures_.size() > 1 && faces_tell_picture_ && !vertices_tell_picture_;
    const bool of_vertices = face && at.list < 0 && at.number >= 0 && !waiting_.empty();
    if (!at.any() && !of_vertices) return records.skip(element);
    Record record;
    for (std::uint64_t k = 0; k < element.count; ++k) {
      if (!records.next(element, record)) return false;
      if (waits) {
        waiting_.push_back({static_cast<float>(record.scalar(at.u)), static_cast<float>(record.scalar(at.v))});
      } else if (at.u >= 0) {
        if (const std::optional<std::uint32_t> picture = picture_of(record, at))
          paint_.lay(k, *picture, record.scalar(at.u), record.scalar(at.v));
      } else {
        lay_face(record, at);
      }
      if ((k & 0xFFFFU) == 0) file_.throw_if_cancelled();
    }
    return true;
  }

  void warn(RawScan& scan) const {
    const std::set<std::uint32_t> pictures(pictures_.begin(), pictures_.end());
    if (guessed_ > 0 && pictures.size() > 1) {
      scan.warnings.push_back(std::to_string(pictures.size()) +
                              " textures are named, and no property 'texnumber' says which of them lies where: the "
                              "first is taken for all");
    }
    if (beyond_ > 0) {
      scan.warnings.push_back(std::to_string(beyond_) + (beyond_ == 1 ? " 'texnumber' names" : " 'texnumber's name") +
                              " textures that the header does not: colours are missing");
    }
  }

 private:
  /// Nothing for -1, which stands for none, and for one that is not there.
  std::optional<std::uint32_t> picture_of(const Record& record, const Coordinates& at) {
    if (at.number < 0) {
      ++guessed_;
      return pictures_[0];
    }
    const double number = record.scalar(at.number);
    if (!(number >= 0.0)) return std::nullopt;
    if (number >= static_cast<double>(pictures_.size())) {
      ++beyond_;
      return std::nullopt;
    }
    return pictures_[static_cast<std::size_t>(number)];
  }

  void lay_face(const Record& record, const Coordinates& at) {
    const std::size_t corners = record.length(at.indices);
    if (at.list >= 0 && record.length(at.list) < 2 * corners) return;
    const std::optional<std::uint32_t> picture = picture_of(record, at);
    if (!picture) return;
    for (std::size_t k = 0; k < corners; ++k) {
      const double vertex = record.item(at.indices, k);
      if (!(vertex >= 0.0) || vertex >= static_cast<double>(vertices_)) continue;
      const auto n = static_cast<std::uint64_t>(vertex);
      if (at.list >= 0) {
        paint_.lay(n, *picture, record.item(at.list, 2 * k), record.item(at.list, 2 * k + 1));
      } else if (n < waiting_.size()) {
        const std::array<float, 2>& place = waiting_[static_cast<std::size_t>(n)];
        paint_.lay(n, *picture, static_cast<double>(place[0]), static_cast<double>(place[1]));
      }
    }
  }

  const ScanFile& file_;
  Paint& paint_;
  std::vector<std::uint32_t> pictures_;
  std::uint64_t vertices_ = 0;
  bool vertices_tell_picture_ = false, faces_tell_picture_ = false;
  std::vector<std::array<float, 2>> waiting_;  ///< coordinates of vertices
  std::uint64_t guessed_ = 0, beyond_ = 0;
};

}  // namespace

Paint paint_of(const ScanFile& file, const Header& header, ScanWriter& out) {
  Paint paint;
  bool any = false;
  for (const Element& element : header.elements) any = any || (element.count > 0 && coordinates_of(element).any());
  if (header.textures.empty()) return paint;
  if (!any) {
    out.scan().warnings.emplace_back(
        "a texture is named, and neither vertices nor faces have coordinates on it: its colours are missing");
    return paint;
  }
  Records records(file, header);
  Layer layer(file, header, paint);
  for (const Element& element : header.elements) {
    if (!element.properties.empty() && !layer.lay(records, element)) break;
  }
  layer.warn(out.scan());
  paint.dry(file, out.scan().warnings);
  return paint;
}

}  // namespace sparsha::pipeline::ply

// The body of a binary PLY file, either byte order. Records of fixed size take the quick way.
#include <algorithm>

#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::ply {
namespace {

/// Offset and type of one wanted property; absent ones have offset kNone.
struct Slot {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t offset = kNone;
  ScalarType type = ScalarType::f32;

  [[nodiscard]] bool present() const { return offset != kNone; }
};

struct VertexLayout {
  Slot x, y, z, red, green, blue, alpha, intensity;
  Slot packed;      // colours, where it is present
  Slot nx, ny, nz;  // all or none
  Slot opacity;     // of whole splats, with their axes
  std::array<Slot, 3> axes;
  ColourScale scale = ColourScale::byte;
  bool splat_colour = false;
  std::vector<Slot> fields;  // in the order of Body::fields_
};

template <bool big>
class Body {
 public:
  Body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out)
      : file_(file),
        out_(out),
        paint_(paint),
        p_(file.bytes.data() + header.body),
        end_(file.bytes.data() + file.bytes.size()) {}

  void read_vertices(const Element& vertex) {
    if (vertex.count == 0) return;  // there may be no record to look at
    const VertexColumns columns = vertex_columns(file_, vertex);
    fields_ = vertex_fields(vertex, columns, out_);
    if (vertex.has_lists()) {
      read_vertices_with_lists(vertex, columns);
      return;
    }
    const std::size_t stride = vertex.least_size(false);
    if (static_cast<std::size_t>(end_ - p_) / stride < vertex.count) throw cut_short(vertex);
    std::vector<std::size_t> offsets;
    record_offsets(vertex, p_, offsets);
    VertexLayout layout = make_layout(vertex, columns, offsets);
    read_opacity_range(vertex, layout, stride);
    if (columns.has_whole_splats()) look_at_splats(vertex, layout, stride);
    if (columns.has_colour()) layout.scale = sampled_scale(vertex, layout, stride);
    const bool packed = look_at_packed(vertex, columns);
    if (packed) layout.packed = slot_of(vertex, columns.packed, offsets);
    if (packed) out_.set_attributes(true, layout.intensity.present(), columns.has_normals());
    // The quick ways know places, normals and colours alone; what is wanted besides may differ from pass to pass.
    const bool quick = !splats_ && !layout.intensity.present() && fields_.empty() && !paint_.any();
    const bool bytes_only = quick && !layout.splat_colour && layout.red.type == ScalarType::u8 &&
                            layout.green.type == ScalarType::u8 && layout.blue.type == ScalarType::u8 &&
                            !layout.alpha.present();
    const bool plain = quick && !columns.has_colour() && !packed;
    const bool same = layout.x.type == layout.y.type && layout.x.type == layout.z.type;
    constexpr std::size_t kChunk = 1 << 16;
    const auto [first, last] = out_.part_of(vertex.count);
    const char* const behind = p_ + static_cast<std::size_t>(vertex.count) * stride;
    p_ += static_cast<std::size_t>(first) * stride;
    for (std::uint64_t left = last - first; left > 0;) {
      const auto chunk = static_cast<std::size_t>(std::min<std::uint64_t>(left, kChunk));
      const char* const stop = p_ + chunk * stride;
      if (same && layout.x.type == ScalarType::f32 && plain) {
        for (; p_ < stop; p_ += stride) add_plain<float>(layout);
      } else if (same && layout.x.type == ScalarType::f64 && plain) {
        for (; p_ < stop; p_ += stride) add_plain<double>(layout);
      } else if (same && layout.x.type == ScalarType::f32 && bytes_only) {
        for (; p_ < stop; p_ += stride) add_with_bytes<float>(layout);
      } else if (same && layout.x.type == ScalarType::f64 && bytes_only) {
        for (; p_ < stop; p_ += stride) add_with_bytes<double>(layout);
      } else {
        for (; p_ < stop; p_ += stride) add_any(layout, p_);
      }
      left -= chunk;
      file_.done_before(static_cast<std::size_t>(p_ - file_.bytes.data()));
    }
    p_ = behind;
    if (splats_ && out_.is_part()) out_.scan().needs_whole = true;
    if (splats_) splats_->warn(out_.scan());
  }

  void read_faces(const Element& element, Role role) {
    const auto wanted = static_cast<std::size_t>(index_list(element));
    std::vector<std::size_t> offsets;
    std::vector<std::int64_t> list;
    const Property& property = element.properties[wanted];
    const std::size_t count_size = size_of(*property.count_type);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const char* const next = record_offsets(element, p_, offsets);
      if (next == nullptr) throw cut_short(element);
      const char* q = p_ + offsets[wanted];
      const auto length = static_cast<std::size_t>(load_scalar<big>(q, *property.count_type));
      q += count_size;
      if (role == Role::face && length > ScanWriter::kMostCorners) {
        throw file_.error("a face of " + std::to_string(length) + " corners",
                          "at most " + std::to_string(ScanWriter::kMostCorners));
      }
      list.resize(length);
      for (std::int64_t& value : list) {
        value = index_at(q, property.type);
        q += size_of(property.type);
      }
      role == Role::strips ? add_strip(list, out_) : add_face(list, out_);
      p_ = next;
    }
  }

  /// Called behind the last element: a count that is too small leaves points or faces out.
  void warn_of_more(const Element& last) {
    const auto left = static_cast<std::size_t>(end_ - p_);
    if (left > 0 && has_translated_line_ends(file_.bytes)) {
      throw file_.error("its line feeds were turned into CR LF: the file was copied as text", "a copy of its bytes");
    }
    if (left < std::min<std::size_t>(last.least_size(false), kPadding)) return;
    out_.scan().warnings.push_back(std::to_string(left) + " bytes behind the last record are left out");
  }

  void skip(const Element& element) {
    if (!element.has_lists()) {
      const std::size_t size = element.least_size(false);
      if (size > 0 && static_cast<std::size_t>(end_ - p_) / size < element.count) throw cut_short(element);
      p_ += size * static_cast<std::size_t>(element.count);
      return;
    }
    std::vector<std::size_t> offsets;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      p_ = record_offsets(element, p_, offsets);
      if (p_ == nullptr) throw cut_short(element);
    }
  }

 private:
  static constexpr std::size_t kPadding = 4;  // a line end, or zeros up to a word

  [[nodiscard]] Error cut_short(const Element& element) const {
    return file_.error("the file ends within element " + in_quotes(element.name) + ", which should have " +
                           std::to_string(element.count) + " records",
                       "a complete file");
  }

  static std::int64_t index_at(const char* q, ScalarType type) {
    switch (type) {
      case ScalarType::i32:
        return load<std::int32_t, big>(q);
      case ScalarType::u32:
        return load<std::uint32_t, big>(q);
      default: {
        const double value = load_scalar<big>(q, type);
        return value >= 0.0 && value < 9e15 ? static_cast<std::int64_t>(value) : -1;
      }
    }
  }

  /// Where each property of the record at `record` begins. Returns the record's end, null when the file ends first.
  const char* record_offsets(const Element& element, const char* record, std::vector<std::size_t>& offsets) const {
    offsets.clear();
    const auto left = static_cast<std::size_t>(end_ - record);
    std::size_t at = 0;
    for (const Property& property : element.properties) {
      offsets.push_back(at);
      const std::size_t size = size_of(property.count_type.value_or(property.type));
      if (left - at < size) return nullptr;
      if (property.count_type) {
        const double length = load_scalar<big>(record + at, *property.count_type);
        at += size;
        const std::size_t most = (left - at) / size_of(property.type);
        if (!(length >= 0.0) || length > static_cast<double>(most)) return nullptr;
        at += static_cast<std::size_t>(length) * size_of(property.type);
      } else {
        at += size;
      }
    }
    return record + at;
  }

  static Slot slot_of(const Element& vertex, int column, const std::vector<std::size_t>& offsets) {
    if (column < 0) return {};
    const auto i = static_cast<std::size_t>(column);
    return {offsets[i], vertex.properties[i].type};
  }

  VertexLayout make_layout(const Element& vertex, const VertexColumns& columns,
                           const std::vector<std::size_t>& offsets) const {
    const auto slot = [&](int column) { return slot_of(vertex, column, offsets); };
    VertexLayout layout;
    layout.x = slot(columns.x);
    layout.y = slot(columns.y);
    layout.z = slot(columns.z);
    if (columns.has_colour()) {
      layout.red = slot(columns.red);
      layout.green = slot(columns.green);
      layout.blue = slot(columns.blue);
      layout.alpha = slot(columns.alpha);
    }
    layout.intensity = slot(columns.intensity);
    if (columns.has_normals()) {
      layout.nx = slot(columns.nx);
      layout.ny = slot(columns.ny);
      layout.nz = slot(columns.nz);
    }
    layout.splat_colour = columns.splat_colour;
    if (columns.has_whole_splats()) {
      layout.opacity = slot(columns.opacity);
      for (std::size_t k = 0; k < 3; ++k) layout.axes[k] = slot(columns.axes[k]);
    }
    for (const VertexField& field : fields_) layout.fields.push_back(slot(static_cast<int>(field.column)));
    return layout;
  }

  ColourScale sampled_scale(const Element& vertex, const VertexLayout& layout, std::size_t stride) const {
    if (layout.splat_colour) return ColourScale::unit;
    if (size_of(layout.red.type) == 1) return ColourScale::byte;
    ColourRange range(is_floating(layout.red.type));
    at_sampled_records(vertex.count, [&](std::uint64_t i) {
      look_at_colour(layout, p_ + static_cast<std::size_t>(i) * stride, range);
      return !range.is_decided();
    });
    return range.scale();
  }
  static void look_at_colour(const VertexLayout& layout, const char* record, ColourRange& range) {
    for (const Slot& slot : {layout.red, layout.green, layout.blue}) range.look(stored(slot, record));
  }

  void read_opacity_range(const Element& vertex, const VertexLayout& layout, std::size_t stride) {
    constexpr std::uint64_t kSample = 20'000;
    const std::uint64_t every = std::max<std::uint64_t>(1, vertex.count / kSample);
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      if (!fields_[k].logit) continue;
      OpacityRange range(layout.fields[k].type);
      for (std::uint64_t i = 0; i < vertex.count; i += every) {
        const char* const q = p_ + static_cast<std::size_t>(i) * stride;
        range.look_at(load_scalar<big>(q + layout.fields[k].offset, layout.fields[k].type));
      }
      range.tell(fields_[k]);
    }
  }

  static double stored(const Slot& slot, const char* record) {
    return load_scalar<big>(record + slot.offset, slot.type);
  }
  static double longest_axis(const VertexLayout& layout, const char* record) {
    double longest = -std::numeric_limits<double>::infinity();
    for (const Slot& axis : layout.axes)
      longest = axis.present() ? longer_axis(longest, stored(axis, record)) : longest;
    return longest;
  }
  void look_at_splats(const Element& vertex, const VertexLayout& layout, std::size_t stride) {
    splats_.emplace(layout.opacity.type);
    const std::uint64_t every = std::max<std::uint64_t>(1, vertex.count / SplatSieve::kSample);
    for (std::uint64_t i = 0; i < vertex.count; i += every) {
      const char* const record = p_ + static_cast<std::size_t>(i) * stride;
      splats_->look_at(stored(layout.opacity, record), longest_axis(layout, record));
    }
    splats_->decide();
  }

  /// Calls `look(record, offsets)` of records of any length all over the file until it gives false.
  template <typename Look>
  void at_walked_records(const Element& vertex, const Look& look) const {
    std::vector<std::size_t> offsets;
    const char* record = p_;
    std::uint64_t at = 0;
    at_sampled_records(vertex.count, [&](std::uint64_t i) {
      for (; at < i; ++at) {
        record = record_offsets(vertex, record, offsets);
        if (record == nullptr) throw cut_short(vertex);
      }
      if (record_offsets(vertex, record, offsets) == nullptr) throw cut_short(vertex);
      return look(record, offsets);
    });
  }

  ColourScale walked_scale(const Element& vertex, const VertexColumns& columns) const {
    const ScalarType type = vertex.properties[static_cast<std::size_t>(columns.red)].type;
    if (columns.splat_colour) return ColourScale::unit;
    if (size_of(type) == 1) return ColourScale::byte;
    ColourRange range(is_floating(type));
    at_walked_records(vertex, [&](const char* record, const std::vector<std::size_t>& offsets) {
      look_at_colour(make_layout(vertex, columns, offsets), record, range);
      return !range.is_decided();
    });
    return range.scale();
  }

  /// Their opacities, for the fields and the sieve, where records may have any length.
  void look_at_walked_splats(const Element& vertex, const VertexColumns& columns) {
    if (!columns.splats || columns.opacity < 0) return;
    const ScalarType type = vertex.properties[static_cast<std::size_t>(columns.opacity)].type;
    OpacityRange range(type);
    if (columns.has_whole_splats()) splats_.emplace(type);
    at_walked_records(vertex, [&](const char* record, const std::vector<std::size_t>& offsets) {
      const auto value = [&](int column) { return stored(slot_of(vertex, column, offsets), record); };
      range.look_at(value(columns.opacity));
      if (splats_) splats_->look_at(value(columns.opacity), columns.longest_axis(value));
      return true;
    });
    if (splats_) splats_->decide();
    for (VertexField& field : fields_) {
      if (field.logit) range.tell(field);
    }
  }

  /// Whether colours are packed into one property.
  bool look_at_packed(const Element& vertex, const VertexColumns& columns) {
    if (columns.packed < 0) return false;
    const auto column = static_cast<std::size_t>(columns.packed);
    PackedColours& colours = packed_.emplace(vertex.properties[column]);
    at_walked_records(vertex, [&](const char* record, const std::vector<std::size_t>& offsets) {
      colours.look(load_scalar<big>(record + offsets[column], vertex.properties[column].type));
      return colours.good();
    });
    colours.warn(out_.scan());
    return colours.good();
  }

  void read_vertices_with_lists(const Element& vertex, const VertexColumns& columns) {
    const ColourScale scale = columns.has_colour() ? walked_scale(vertex, columns) : ColourScale::byte;
    const bool packed = look_at_packed(vertex, columns);
    if (packed) out_.set_attributes(true, columns.intensity >= 0, columns.has_normals());
    look_at_walked_splats(vertex, columns);
    std::vector<std::size_t> offsets;
    for (std::uint64_t i = 0; i < vertex.count; ++i) {
      const char* const next = record_offsets(vertex, p_, offsets);
      if (next == nullptr) throw cut_short(vertex);
      VertexLayout layout = make_layout(vertex, columns, offsets);
      layout.scale = scale;
      if (packed) layout.packed = slot_of(vertex, columns.packed, offsets);
      add_any(layout, p_);
      p_ = next;
    }
    if (splats_) splats_->warn(out_.scan());
  }

  void set_normal(const VertexLayout& layout, const char* q) {
    if (!layout.nx.present()) return;
    const auto value = [&](const Slot& slot) { return load_scalar<big>(q + slot.offset, slot.type); };
    out_.set_normal(value(layout.nx), value(layout.ny), value(layout.nz));
  }

  template <typename T>
  void add_plain(const VertexLayout& layout) {
    set_normal(layout, p_);
    out_.add(load<T, big>(p_ + layout.x.offset), load<T, big>(p_ + layout.y.offset),
             load<T, big>(p_ + layout.z.offset));
  }

  template <typename T>
  void add_with_bytes(const VertexLayout& layout) {
    set_normal(layout, p_);
    out_.add(load<T, big>(p_ + layout.x.offset), load<T, big>(p_ + layout.y.offset), load<T, big>(p_ + layout.z.offset),
             pack_rgba(load<std::uint8_t>(p_ + layout.red.offset), load<std::uint8_t>(p_ + layout.green.offset),
                       load<std::uint8_t>(p_ + layout.blue.offset)));
  }

  void add_any(const VertexLayout& layout, const char* q) {
    if (splats_ && !splats_->keeps(stored(layout.opacity, q), longest_axis(layout, q))) {
      out_.add_invalid();
      return;
    }
    set_normal(layout, q);
    const auto value = [&](const Slot& slot) { return load_scalar<big>(q + slot.offset, slot.type); };
    const auto channel = [&](const Slot& slot) {
      return colour_byte(layout.splat_colour ? colour_of_splat(value(slot)) : value(slot), layout.scale);
    };
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      out_.set_field(fields_[k].slot, fields_[k].value(value(layout.fields[k])));
    }
    std::uint32_t rgba = paint_.any() ? kNoColour : kWhite;
    if (layout.red.present()) {
      rgba = pack_rgba(channel(layout.red), channel(layout.green), channel(layout.blue),
                       layout.alpha.present() ? colour_byte(value(layout.alpha), layout.scale) : 255);
    }
    if (layout.packed.present()) rgba = packed_->rgba(value(layout.packed));
    if (const std::uint32_t painted = paint_[out_.records()]; painted != kNoColour) rgba = painted;
    out_.add(value(layout.x), value(layout.y), value(layout.z), rgba,
             layout.intensity.present() ? static_cast<float>(value(layout.intensity)) : 0.0F);
  }

  const ScanFile& file_;
  ScanWriter& out_;
  const Paint& paint_;
  std::vector<VertexField> fields_;
  std::optional<SplatVertices> splats_;
  std::optional<PackedColours> packed_;
  const char* p_;
  const char* end_;
};

template <bool big>
void read_body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out) {
  std::size_t needed = 0;  // elements behind the last one of use are not read
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (role_of(header.elements[i]) != Role::other) needed = i + 1;
  }
  Body<big> body(file, header, paint, out);
  for (std::size_t i = 0; i < needed; ++i) {
    const Element& element = header.elements[i];
    if (element.properties.empty()) continue;
    const Role role = role_of(element);
    if (role == Role::vertex) {
      body.read_vertices(element);
    } else if (role == Role::other) {
      body.skip(element);
    } else {
      body.read_faces(element, role);
    }
  }
  if (needed > 0 && needed == header.elements.size()) body.warn_of_more(header.elements.back());
}

}  // namespace

void read_binary_body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out) {
  header.encoding == Encoding::big ? read_body<true>(file, header, paint, out)
                                   : read_body<false>(file, header, paint, out);
}

}  // namespace sparsha::pipeline::ply

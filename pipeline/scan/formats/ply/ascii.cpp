// The body of an ASCII PLY file: one line a record, as the format demands; anything else is an error, never a guess.
#include <cmath>
#include <limits>

#include "pipeline/scan/formats/ply/ply.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline::ply {
namespace {

/// One record's line into values: scalars, and of lists only the wanted one.
class RecordParser {
 public:
  /// A wanted list of more than `most` is refused.
  RecordParser(const ScanFile& file, const Element& element, int wanted_list,
               std::size_t most = std::numeric_limits<std::size_t>::max())
      : file_(file), element_(element), wanted_list_(wanted_list), most_(most), values_(element.properties.size()) {}

  void parse(std::string_view line, int number) {
    const char* p = line.data();
    const char* const end = p + line.size();
    list_.clear();
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (element_.properties[i].count_type && skip_blanks(p, end) == end) {
        ++missing_lists_;  // some writers leave an empty list out
        continue;
      }
      p = next_number(p, end, number, values_[i]);
      if (!element_.properties[i].count_type) continue;
      const double length = values_[i];
      // Each value takes two bytes at least, so this also bounds the loop.
      if (!(length >= 0.0) || length != std::floor(length) || length > static_cast<double>(line.size())) {
        throw file_.error_at(number, "bad list length in element " + in_quotes(element_.name),
                             "as many values as it says");
      }
      if (static_cast<int>(i) == wanted_list_ && length > static_cast<double>(most_)) {
        throw file_.error_at(number, "a face of " + std::to_string(static_cast<std::int64_t>(length)) + " corners",
                             "at most " + std::to_string(most_));
      }
      for (auto k = static_cast<std::int64_t>(length); k > 0; --k) {
        double value = 0.0;
        p = next_number(p, end, number, value);
        if (static_cast<int>(i) == wanted_list_) {
          list_.push_back(std::fabs(value) < 9e15 ? static_cast<std::int64_t>(value) : -1);
        }
      }
    }
    if (skip_blanks(p, end) != end) {
      throw file_.error_at(number, "more values than element " + in_quotes(element_.name) + " has properties",
                           std::to_string(values_.size()) + " properties a line");
    }
  }
  [[nodiscard]] double operator[](int column) const { return values_[static_cast<std::size_t>(column)]; }
  [[nodiscard]] const std::vector<std::int64_t>& list() const { return list_; }
  void warn_of_missing_lists(ScanWriter& out) const {
    if (missing_lists_ == 0) return;
    out.scan().warnings.push_back(std::to_string(missing_lists_) + " lists of element " + in_quotes(element_.name) +
                                  " are missing from their lines; taken as empty");
  }

 private:
  const char* next_number(const char* p, const char* end, int number, double& value) const {
    p = skip_blanks(p, end);
    const char* const stop = parse_number(p, end, value);
    if (stop == nullptr || (stop < end && !is_blank(*stop))) {
      throw file_.error_at(number,
                           p == end ? "too few values for element " + in_quotes(element_.name)
                                    : in_quotes({p, static_cast<std::size_t>(end - p)}) + " is not a number",
                           std::to_string(values_.size()) + " properties a line");
    }
    return stop;
  }

  const ScanFile& file_;
  const Element& element_;
  int wanted_list_;
  std::size_t most_;
  std::vector<double> values_;
  std::vector<std::int64_t> list_;
  std::uint64_t missing_lists_ = 0;
};

void next_record(const ScanFile& file, LineReader& lines, const Element& element, std::uint64_t i,
                 std::string_view& line) {
  if ((i & 0xFFFF) == 0xFFFF) file.done_before(lines.offset() - 1);
  do {
    if (!lines.next(line)) {
      throw file.error_at(lines.number(),
                          "the file ends after " + std::to_string(i) + " of " + std::to_string(element.count) +
                              " records of element " + in_quotes(element.name),
                          "a line for each record");
    }
  } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
}

ColourScale sampled_scale(const ScanFile& file, LineReader lines, const Element& vertex, const VertexColumns& columns) {
  const ScalarType type = vertex.properties[static_cast<std::size_t>(columns.red)].type;
  if (columns.splat_colour) return ColourScale::unit;
  if (size_of(type) == 1) return ColourScale::byte;
  RecordParser record(file, vertex, -1);
  std::string_view line;
  ColourRange range(is_floating(type));
  std::uint64_t at = 0;
  at_sampled_records(vertex.count, [&](std::uint64_t i) {
    for (; at <= i; ++at) next_record(file, lines, vertex, at, line);
    record.parse(line, lines.number());
    for (const int column : {columns.red, columns.green, columns.blue}) range.look(record[column]);
    return !range.is_decided();
  });
  return range.scale();
}

PackedColours packed_colours(const ScanFile& file, LineReader lines, const Element& vertex,
                             const VertexColumns& columns) {
  RecordParser record(file, vertex, -1);
  std::string_view line;
  PackedColours colours(vertex.properties[static_cast<std::size_t>(columns.packed)]);
  std::uint64_t at = 0;
  at_sampled_records(vertex.count, [&](std::uint64_t i) {
    for (; at <= i; ++at) next_record(file, lines, vertex, at, line);
    record.parse(line, lines.number());
    colours.look(record[columns.packed]);
    return colours.good();
  });
  return colours;
}

/// From the first records.
void read_opacity_range(const ScanFile& file, LineReader lines, const Element& vertex,
                        std::vector<VertexField>& fields) {
  constexpr std::uint64_t kSample = 1000;
  RecordParser record(file, vertex, -1);
  std::string_view line;
  for (VertexField& field : fields) {
    if (!field.logit) continue;
    OpacityRange range(vertex.properties[field.column].type);
    for (std::uint64_t i = 0; i < std::min(vertex.count, kSample); ++i) {
      next_record(file, lines, vertex, i, line);
      record.parse(line, lines.number());
      range.look_at(record[static_cast<int>(field.column)]);
    }
    range.tell(field);
  }
}

double longest_axis(const RecordParser& record, const VertexColumns& columns) {
  return columns.longest_axis([&](int axis) { return record[axis]; });
}

/// By the first records.
std::optional<SplatVertices> look_at_splats(const ScanFile& file, LineReader lines, const Element& vertex,
                                            const VertexColumns& columns) {
  if (!columns.has_whole_splats()) return std::nullopt;
  SplatVertices splats(vertex.properties[static_cast<std::size_t>(columns.opacity)].type);
  RecordParser record(file, vertex, -1);
  std::string_view line;
  for (std::uint64_t i = 0; i < std::min(vertex.count, SplatSieve::kSample); ++i) {
    next_record(file, lines, vertex, i, line);
    record.parse(line, lines.number());
    splats.look_at(record[columns.opacity], longest_axis(record, columns));
  }
  splats.decide();
  return splats;
}

void read_vertices(const ScanFile& file, LineReader& lines, const Element& vertex, const Paint& paint,
                   ScanWriter& out) {
  const VertexColumns columns = vertex_columns(file, vertex);
  const bool colour = columns.has_colour();
  const bool intensity = columns.intensity >= 0;
  const ColourScale scale = colour ? sampled_scale(file, lines, vertex, columns) : ColourScale::byte;
  std::optional<PackedColours> packed;
  if (columns.packed >= 0) {
    packed = packed_colours(file, lines, vertex, columns);
    packed->warn(out.scan());
    if (!packed->good()) packed.reset();
  }
  if (packed) out.set_attributes(true, intensity, columns.has_normals());
  std::vector<VertexField> fields = vertex_fields(vertex, columns, out);
  read_opacity_range(file, lines, vertex, fields);
  std::optional<SplatVertices> splats = look_at_splats(file, lines, vertex, columns);
  const auto channel = [&](double value) {
    return colour_byte(columns.splat_colour ? colour_of_splat(value) : value, scale);
  };
  RecordParser record(file, vertex, -1);
  std::string_view line;
  for (std::uint64_t i = 0; i < vertex.count; ++i) {
    next_record(file, lines, vertex, i, line);
    record.parse(line, lines.number());
    if (splats && !splats->keeps(record[columns.opacity], longest_axis(record, columns))) {
      out.add_invalid();
      continue;
    }
    std::uint32_t rgba = paint.any() ? kNoColour : kWhite;
    if (colour) {
      rgba = pack_rgba(channel(record[columns.red]), channel(record[columns.green]), channel(record[columns.blue]),
                       columns.alpha >= 0 ? colour_byte(record[columns.alpha], scale) : 255);
    }
    if (packed) rgba = packed->rgba(record[columns.packed]);
    if (const std::uint32_t painted = paint[i]; painted != kNoColour) rgba = painted;
    for (const VertexField& field : fields) {
      out.set_field(field.slot, field.value(record[static_cast<int>(field.column)]));
    }
    if (columns.has_normals()) out.set_normal(record[columns.nx], record[columns.ny], record[columns.nz]);
    out.add(record[columns.x], record[columns.y], record[columns.z], rgba,
            intensity ? static_cast<float>(record[columns.intensity]) : 0.0F);
  }
  if (splats) splats->warn(out.scan());
  record.warn_of_missing_lists(out);
}

}  // namespace

void read_ascii_body(const ScanFile& file, const Header& header, const Paint& paint, ScanWriter& out) {
  std::size_t needed = 0;  // elements behind the last one of use are not read
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (role_of(header.elements[i]) != Role::other) needed = i + 1;
  }
  LineReader lines(file.bytes, header.body, header.lines);
  std::string_view line;
  for (std::size_t i = 0; i < needed; ++i) {
    const Element& element = header.elements[i];
    const Role role = role_of(element);
    if (element.properties.empty()) continue;
    if (role == Role::vertex) {
      read_vertices(file, lines, element, paint, out);
      continue;
    }
    RecordParser record(file, element, index_list(element),
                        role == Role::face ? ScanWriter::kMostCorners : std::numeric_limits<std::size_t>::max());
    for (std::uint64_t k = 0; k < element.count; ++k) {
      next_record(file, lines, element, k, line);
      if (role == Role::other) continue;
      record.parse(line, lines.number());
      role == Role::strips ? add_strip(record.list(), out) : add_face(record.list(), out);
    }
    record.warn_of_missing_lists(out);
  }
  if (needed < header.elements.size()) return;
  while (lines.next(line)) {
    if (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size()) continue;
    out.scan().warnings.push_back("the file has more lines than its header has records; left out");
    return;
  }
}

}  // namespace sparsha::pipeline::ply

#include "pipeline/scan/formats/ply/ply.h"

#include <algorithm>
#include <limits>

#include "base/text/lower_case.h"
#include "pipeline/scan/formats/remark_unit.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

/// Whether all of it, or at least half, is what numbers in text are made of.
struct TextShare {
  bool all = false, half = false;
};
TextShare text_share(std::string_view body) {
  constexpr std::string_view kText = "0123456789+-.eE \t\r\n";
  const std::string_view head = body.substr(0, 4096);
  const auto count = static_cast<std::size_t>(
      std::count_if(head.begin(), head.end(), [&](char c) { return kText.find(c) != std::string_view::npos; }));
  return {count == head.size(), 2 * count >= head.size()};
}

/// Whether binary records without lists are just so long.
bool has_size_of(const ply::Header& header, std::size_t body) {
  std::uint64_t bytes = 0;
  for (const ply::Element& element : header.elements) {
    const std::uint64_t size = element.least_size(false);
    if (element.has_lists() || (size > 0 && element.count > body / size)) return false;
    bytes += element.count * size;
  }
  return bytes == body;
}

/// A header that says text before bytes, or bytes before text: else nonsense is read, or said of a line.
void require_encoding(const ScanFile& file, const ply::Header& header) {
  std::string_view body = file.bytes.substr(header.body);
  while (header.encoding == ply::Encoding::ascii && !body.empty() && body.back() == '\0') body.remove_suffix(1);
  const TextShare text = text_share(body);
  if (header.encoding == ply::Encoding::ascii) {
    if (!looks_binary(body) || text.half) return;
    throw file.error("the PLY header says 'format ascii', but what follows it is binary",
                     "'format binary_little_endian 1.0', or big_endian, in the header");
  }
  if (!text.all) return;
  const bool numbers = body.find_first_of("0123456789") != std::string_view::npos &&
                       body.find_first_of(" \t\r\n") != std::string_view::npos;
  if (!numbers || has_size_of(header, body.size())) return;
  throw file.error("the PLY header says that the file is binary, but what follows it are numbers in text",
                   "'format ascii 1.0' in the header");
}

}  // namespace

namespace ply {

VertexColumns vertex_columns(const ScanFile& file, const Element& vertex) {
  VertexColumns columns;
  columns.x = vertex.find({"x"});
  columns.y = vertex.find({"y"});
  columns.z = vertex.find({"z"});
  for (const int column : {columns.x, columns.y, columns.z}) {
    if (column < 0 || vertex.properties[static_cast<std::size_t>(column)].count_type) {
      throw file.error_at(vertex.line, "the vertices have no x, y and z", "properties x, y and z of element vertex");
    }
  }
  for (const std::string_view name : {"x", "y", "z"}) {
    const auto same = [&](const Property& property) { return property.name == name; };
    if (std::count_if(vertex.properties.begin(), vertex.properties.end(), same) > 1) {
      throw file.error_at(vertex.line, "the vertices have " + in_quotes(name) + " twice", "each property once");
    }
  }
  columns.red = vertex.find({"red", "diffuse_red", "r"});
  columns.green = vertex.find({"green", "diffuse_green", "g"});
  columns.blue = vertex.find({"blue", "diffuse_blue", "b"});
  columns.alpha = vertex.find({"alpha", "diffuse_alpha"});
  columns.intensity = vertex.find({"intensity", "scalar_intensity", "reflectance"});
  const auto is_packed = [](const Property& property) {
    return !property.count_type && (property.type == ScalarType::u32 || property.type == ScalarType::i32);
  };
  const int packed = vertex.find({"rgb", "rgba"});
  if (packed >= 0 && !columns.has_colour() && is_packed(vertex.properties[static_cast<std::size_t>(packed)]))
    columns.packed = packed;
  columns.splats = vertex.find({"f_dc_0"}) >= 0 && vertex.find({"f_dc_1"}) >= 0 && vertex.find({"f_dc_2"}) >= 0;
  if (columns.splats && !columns.has_colour()) {
    columns.red = vertex.find({"f_dc_0"});
    columns.green = vertex.find({"f_dc_1"});
    columns.blue = vertex.find({"f_dc_2"});
    columns.alpha = -1;
    columns.packed = -1;
    columns.splat_colour = true;
  }
  columns.opacity = vertex.find({"opacity"});
  columns.axes = {vertex.find({"scale_0"}), vertex.find({"scale_1"}), vertex.find({"scale_2"})};
  columns.nx = vertex.find({"nx", "normal_x"});
  columns.ny = vertex.find({"ny", "normal_y"});
  columns.nz = vertex.find({"nz", "normal_z"});
  for (int* column :
       {&columns.red, &columns.green, &columns.blue, &columns.alpha, &columns.intensity, &columns.nx, &columns.ny,
        &columns.nz, &columns.opacity, &columns.axes[0], &columns.axes[1], &columns.axes[2]}) {
    if (*column >= 0 && vertex.properties[static_cast<std::size_t>(*column)].count_type) *column = -1;
  }
  return columns;
}

std::vector<VertexField> vertex_fields(const Element& vertex, const VertexColumns& columns, ScanWriter& out) {
  std::vector<VertexField> fields;
  for (std::size_t k = 0; k < vertex.properties.size(); ++k) {
    const Property& property = vertex.properties[k];
    const int column = static_cast<int>(k);
    if (property.count_type || column == columns.x || column == columns.y || column == columns.z) continue;
    const int slot = out.want(property.name, column != columns.intensity);
    if (slot == ScanWriter::kUnwanted) continue;
    fields.push_back({k, slot, columns.splats && property.name == "opacity"});
  }
  return fields;
}

void PackedColours::warn(RawScan& scan) const {
  if (!named_rgba_ || good()) return;
  scan.warnings.emplace_back(
      "the numbers of 'rgba' are not read as colours: neither their first nor their last byte, the opacity, is the "
      "same "
      "in all of them; red, green and blue as properties of their own are");
}

void SplatVertices::decide() {
  range_.tell(opacity_);
  for (const auto& [opacity, longest] : looked_) sieve_.look_at(opacity_.value(opacity), std::exp(longest));
  sieve_.decide();
  looked_ = {};
}

bool is_face(const Element& element) {
  for (const std::string_view name :
       {"face", "faces", "polygon", "polygons", "triangle", "triangles", "facet", "facets"})
    if (element.name == name) return true;
  return element.name == "tristrips" || element.name == "tristrip";
}

Role role_of(const Element& element) {
  if (element.name == "vertex" || element.name == "vertices") return Role::vertex;
  if (!is_face(element) || index_list(element) < 0) return Role::other;
  return element.name.starts_with("tristrip") ? Role::strips : Role::face;
}

int index_list(const Element& element) {
  const auto is_list = [&](int column) {
    return column >= 0 && element.properties[static_cast<std::size_t>(column)].count_type.has_value();
  };
  if (const int column = element.find({"vertex_indices", "vertex_index"}); is_list(column)) return column;
  // Other names in use, "vertex_index_list" or "indices", where one list alone can be meant.
  int found = -1;
  for (std::size_t k = 0; k < element.properties.size(); ++k) {
    const Property& property = element.properties[k];
    const auto has = [&](std::string_view part) { return property.name.find(part) != std::string::npos; };
    const bool whole = property.type != ScalarType::f32 && property.type != ScalarType::f64;
    if (!property.count_type || !whole || !(has("vert") || has("ind")) || has("texc") || has("texn") || has("textur") ||
        has("norm") || has("uv"))
      continue;
    if (found >= 0) return -1;
    found = static_cast<int>(k);
  }
  return found;
}

namespace {

std::uint32_t vertex_number(std::int64_t value) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  return value < 0 || value >= kNone ? kNone : static_cast<std::uint32_t>(value);
}

}  // namespace

void add_strip(const std::vector<std::int64_t>& strip, ScanWriter& out) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < strip.size(); ++i) {
    if (strip[i] < 0) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const bool odd = ((i - begin) & 1U) != 0;
      const std::uint32_t a = vertex_number(strip[i - 2]);
      const std::uint32_t b = vertex_number(strip[i - 1]);
      const std::uint32_t c = vertex_number(strip[i]);
      if (a == b || b == c || a == c) continue;
      odd ? out.add_triangle(b, a, c) : out.add_triangle(a, b, c);
    }
  }
}

void add_face(const std::vector<std::int64_t>& corners, ScanWriter& out) {
  if (corners.size() == 3) {
    out.add_triangle(vertex_number(corners[0]), vertex_number(corners[1]), vertex_number(corners[2]));
    return;
  }
  std::vector<std::uint32_t> numbers;
  numbers.reserve(corners.size());
  for (const std::int64_t corner : corners) numbers.push_back(vertex_number(corner));
  out.add_polygon(numbers);
}

}  // namespace ply

bool is_ply(const ScanFile& file) {
  const std::string_view head = file.bytes.substr(0, 16);
  if (lower_case(head.substr(0, 3)) != "ply") return false;
  const std::size_t end = head.find_first_not_of(" \t", 3);
  return end != std::string_view::npos && (head[end] == '\n' || head[end] == '\r');
}

void read_ply(const ScanFile& file, ScanWriter& out) {
  const ply::Header header = ply::parse_header(file);
  const ply::Element* vertex = nullptr;
  for (const ply::Element& element : header.elements) {
    if (ply::role_of(element) != ply::Role::vertex) continue;
    if (vertex != nullptr) throw file.error_at(element.line, "a second vertex element", "only one");
    vertex = &element;
  }
  if (vertex == nullptr) throw file.error("the PLY header has no vertex element", "'element vertex COUNT'");

  RawScan& scan = out.scan();
  scan.notes = header.notes;
  for (const auto& [remark, line] : header.unit_remarks)
    if (!scan.several_units) take_unit_of_remark(remark, line, scan);
  for (const ply::Property& property : vertex->properties) scan.fields.push_back(property.name);
  const bool ascii = header.encoding == ply::Encoding::ascii;
  scan.format = ascii                                      ? "PLY ascii"
                : header.encoding == ply::Encoding::little ? "PLY binary little-endian"
                                                           : "PLY binary big-endian";
  require_encoding(file, header);
  const std::size_t body = file.bytes.size() - header.body;
  std::size_t left = body;
  for (const ply::Element& element : header.elements) {
    // In ASCII the last separator may be missing, hence one more.
    const std::size_t size = element.least_size(ascii);
    const std::size_t most = size == 0 ? 0 : (left + (ascii ? 1 : 0)) / size;
    if (size > 0 && element.count > most) {
      throw file.error_at(element.line,
                          std::to_string(element.count) + " records of element " + in_quotes(element.name) +
                              " cannot be in the " + std::to_string(body) + " bytes behind the header",
                          "a header that fits the file; it may be cut short");
    }
    left -= std::min<std::size_t>(left, static_cast<std::size_t>(element.count) * size);
  }
  for (const ply::Element& element : header.elements) {
    if (element.count == 0 || ply::role_of(element) != ply::Role::other || !ply::is_face(element)) continue;
    scan.warnings.push_back("the " + std::to_string(element.count) + " records of element " + in_quotes(element.name) +
                            " are not used, since no list of theirs is known to hold vertices ('vertex_indices'); the "
                            "vertices are taken as points");
  }
  const ply::VertexColumns columns = ply::vertex_columns(file, *vertex);
  std::uint64_t faces = 0;
  std::uint64_t coloured = 0;
  for (const ply::Element& element : header.elements) {
    if (ply::role_of(element) != ply::Role::face) continue;
    faces += element.count;
    if (element.find({"red", "diffuse_red", "r"}) >= 0) coloured += element.count;
  }
  if (coloured > 0 && !columns.has_colour() && columns.packed < 0)
    scan.warnings.push_back(unused_face_colours(coloured));
  out.expect_mesh(vertex->count, faces);
  if (columns.splats && !columns.has_whole_splats()) {
    note_splats(scan);
    scan.warnings.emplace_back(
        "the splats have no opacity or no axes (properties opacity and scale_0): none of them is left out as no "
        "surface");
  }
  const Paint paint = ply::paint_of(file, header, out);
  if (paint.any() && !columns.has_colour()) scan.fields.insert(scan.fields.end(), {"red", "green", "blue"});
  out.begin(vertex->count, columns.has_colour() || paint.any(), columns.intensity >= 0, columns.has_normals());
  ascii ? ply::read_ascii_body(file, header, paint, out) : ply::read_binary_body(file, header, paint, out);
}

}  // namespace sparsha::pipeline

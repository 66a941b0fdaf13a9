#include "pipeline/scan/formats/pcd/pcd.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text/lower_case.h"
#include "pipeline/scan/colour_sample.h"
#include "pipeline/scan/formats/pcd/header.h"
#include "pipeline/scan/formats/pcd/lzf.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace pcd {
namespace {

/// The fields we use; null where the file has none.
struct Wanted {
  const Field *x, *y, *z;
  const Field* packed;  ///< rgb or rgba in one 32-bit value
  const Field *red, *green, *blue;
  const Field* intensity;
  const Field *normal_x, *normal_y, *normal_z;  ///< all or none
  ColourScale scale = ColourScale::byte;
  std::vector<std::pair<const Field*, int>> others;  ///< that somebody asks for, and their slots

  [[nodiscard]] bool has_colour() const { return packed != nullptr || red != nullptr; }
  [[nodiscard]] bool opaque() const { return packed != nullptr && packed->name == "rgb"; }
};

Wanted wanted_fields(const ScanFile& file, const Header& header, ScanWriter& out) {
  Wanted wanted{};
  wanted.x = header.find("x");
  wanted.y = header.find("y");
  wanted.z = header.find("z");
  if (wanted.x == nullptr || wanted.y == nullptr || wanted.z == nullptr) {
    throw file.error("the points have no x, y and z", "fields x, y and z");
  }
  wanted.packed = header.find("rgba") != nullptr ? header.find("rgba") : header.find("rgb");
  if (wanted.packed != nullptr && size_of(wanted.packed->type) != 4) wanted.packed = nullptr;
  if (wanted.packed == nullptr) {
    wanted.red = header.find("red") != nullptr ? header.find("red") : header.find("r");
    wanted.green = header.find("green") != nullptr ? header.find("green") : header.find("g");
    wanted.blue = header.find("blue") != nullptr ? header.find("blue") : header.find("b");
    if (wanted.green == nullptr || wanted.blue == nullptr) wanted.red = nullptr;
  }
  wanted.intensity = header.find("intensity");
  wanted.normal_x = header.find("normal_x");
  wanted.normal_y = header.find("normal_y");
  wanted.normal_z = header.find("normal_z");
  if (wanted.normal_y == nullptr || wanted.normal_z == nullptr) wanted.normal_x = nullptr;
  for (const Field& field : header.fields) {
    if (field.count != 1 || field.name == "_" || &field == wanted.x || &field == wanted.y || &field == wanted.z) {
      continue;
    }
    if (const int slot = out.want(field.name); slot != ScanWriter::kUnwanted) wanted.others.emplace_back(&field, slot);
  }
  return wanted;
}

/// A packed colour in text is an integer, or a float whose bits are the colour: those are far below 1.
std::uint32_t packed_from_text(double value, bool is_signed) {
  if (is_signed && value < 0.0 && value >= -2147483648.0 && value == std::floor(value))
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
  if (value >= 1.0 && value < 4294967296.0) return static_cast<std::uint32_t>(value);
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

/// Where each field's values begin in the body and how far apart they are: by records, or field after field.
class BinaryBody {
 public:
  BinaryBody(const Header& header, const char* body, bool by_fields)
      : header_(header), body_(body), by_fields_(by_fields) {}

  [[nodiscard]] bool is_by_fields() const { return by_fields_; }
  [[nodiscard]] const char* first(const Field& field) const {
    return body_ + (by_fields_ ? field.offset * static_cast<std::size_t>(header_.points) : field.offset);
  }
  [[nodiscard]] std::size_t stride(const Field& field) const {
    return by_fields_ ? field.count * size_of(field.type) : header_.record_size;
  }
  [[nodiscard]] double value(const Field& field, std::size_t record) const {
    return load_scalar(first(field) + record * stride(field), field.type);
  }
  [[nodiscard]] std::uint32_t bits(const Field& field, std::size_t record) const {
    return load<std::uint32_t>(first(field) + record * stride(field));
  }

 private:
  const Header& header_;
  const char* body_;
  bool by_fields_;
};

void read_records(const ScanFile& file, const Header& header, Wanted wanted, const BinaryBody& body, ScanWriter& out) {
  const auto n = static_cast<std::size_t>(header.points);
  if (wanted.red != nullptr) {
    ColourRange range(is_floating(wanted.red->type));
    at_sampled_records(n, [&](std::uint64_t i) {
      for (const Field* field : {wanted.red, wanted.green, wanted.blue})
        range.look(body.value(*field, static_cast<std::size_t>(i)));
      return !range.is_decided();
    });
    wanted.scale = range.scale();
  }
  const bool floats =
      wanted.x->type == ScalarType::f32 && wanted.y->type == ScalarType::f32 && wanted.z->type == ScalarType::f32;
  const char* const x = body.first(*wanted.x);
  const char* const y = body.first(*wanted.y);
  const char* const z = body.first(*wanted.z);
  const std::size_t sx = body.stride(*wanted.x);
  const std::size_t sy = body.stride(*wanted.y);
  const std::size_t sz = body.stride(*wanted.z);
  const auto [first, last] = body.is_by_fields() ? std::pair<std::uint64_t, std::uint64_t>(0, n) : out.part_of(n);
  for (auto i = static_cast<std::size_t>(first); i < last; ++i) {
    std::uint32_t rgba = kWhite;
    if (wanted.packed != nullptr) {
      rgba = unpack_argb(body.bits(*wanted.packed, i), wanted.opaque());
    } else if (wanted.red != nullptr) {
      rgba = pack_rgba(colour_byte(body.value(*wanted.red, i), wanted.scale),
                       colour_byte(body.value(*wanted.green, i), wanted.scale),
                       colour_byte(body.value(*wanted.blue, i), wanted.scale));
    }
    if (wanted.normal_x != nullptr) {
      out.set_normal(body.value(*wanted.normal_x, i), body.value(*wanted.normal_y, i), body.value(*wanted.normal_z, i));
    }
    for (const auto& [field, slot] : wanted.others) out.set_field(slot, body.value(*field, i));
    const float intensity = wanted.intensity != nullptr ? static_cast<float>(body.value(*wanted.intensity, i)) : 0.0F;
    if (floats) {
      out.add(static_cast<double>(load<float>(x + i * sx)), static_cast<double>(load<float>(y + i * sy)),
              static_cast<double>(load<float>(z + i * sz)), rgba, intensity);
    } else {
      out.add(body.value(*wanted.x, i), body.value(*wanted.y, i), body.value(*wanted.z, i), rgba, intensity);
    }
    if ((i & 0xFFFF) == 0xFFFF) file.done_before(header.body + i * header.record_size);
  }
}

void read_compressed(const ScanFile& file, const Header& header, const Wanted& wanted, ScanWriter& out) {
  const std::string_view body = file.bytes.substr(header.body);
  if (body.size() < 8) throw file.error("the compressed PCD body breaks off", "its two sizes and the data");
  const std::size_t compressed = load<std::uint32_t>(body.data());
  const std::size_t uncompressed = load<std::uint32_t>(body.data() + 4);
  if (compressed > body.size() - 8) {
    throw file.error("the compressed PCD body should have " + std::to_string(compressed) + " bytes, " +
                         std::to_string(body.size() - 8) + " are there",
                     "a complete file");
  }
  const std::size_t needed = static_cast<std::size_t>(header.points) * header.record_size;
  if (uncompressed != needed || uncompressed > lzf_largest_output(compressed)) {
    throw file.error("the compressed PCD body holds " + std::to_string(uncompressed) + " bytes, its header says " +
                         std::to_string(needed),
                     "a header that fits the data");
  }
  // The walk needs no memory: what does not hold as much as it says is refused before any is taken.
  const std::span<const char> packed(body.data() + 8, compressed);
  std::vector<char> records(lzf_output_size(packed) == uncompressed ? uncompressed : 0);
  if (records.size() != uncompressed || !lzf_decompress(packed, records)) {
    throw file.error("the compressed PCD body is damaged", "an LZF stream");
  }
  ScanFile no_pages = file;
  no_pages.map = nullptr;  // the records are not the file's pages
  read_records(no_pages, header, wanted, BinaryBody(header, records.data(), true), out);
}

/// Numbers of one line, between blanks or commas.
bool parse_row(std::string_view line, std::vector<double>& values) {
  values.clear();
  const char* p = line.data();
  const char* const end = p + line.size();
  const auto skip = [&] {
    while (p < end && (is_blank(*p) || *p == ',')) ++p;
  };
  for (skip(); p < end; skip()) {
    double value = 0.0;
    p = parse_number(p, end, value);
    if (p == nullptr || (p < end && !is_blank(*p) && *p != ',')) return false;
    values.push_back(value);
  }
  return true;
}

void read_ascii(const ScanFile& file, const Header& header, Wanted wanted, ScanWriter& out) {
  LineReader lines(file.bytes, header.body, header.lines);
  std::vector<double> row;
  const auto next = [&](LineReader& reader) {
    std::string_view line;
    while (reader.next(line)) {
      if (!parse_row(line, row)) {
        throw file.error_at(reader.number(), "not a line of numbers: " + in_quotes(line),
                            std::to_string(header.columns) + " values");
      }
      if (row.empty()) continue;
      if (row.size() != header.columns) {
        throw file.error_at(reader.number(), std::to_string(row.size()) + " values in a line",
                            std::to_string(header.columns) + " values");
      }
      return true;
    }
    return false;
  };
  if (wanted.red != nullptr) {
    ColourRange range(is_floating(wanted.red->type));
    for (const std::string_view part : sampled_lines(file.bytes.substr(header.body))) {
      LineReader sample(part);
      std::string_view line;
      while (!range.is_decided() && sample.next(line)) {
        if (!parse_row(line, row) || row.size() != header.columns) continue;  // refused below
        for (const Field* field : {wanted.red, wanted.green, wanted.blue}) range.look(row[field->column]);
      }
    }
    wanted.scale = range.scale();
  }
  for (std::uint64_t i = 0; i < header.points; ++i) {
    if (!next(lines)) {
      throw file.error_at(
          lines.number(),
          "the file ends after " + std::to_string(i) + " of " + std::to_string(header.points) + " points",
          "a line for each point");
    }
    std::uint32_t rgba = kWhite;
    if (wanted.packed != nullptr) {
      rgba = unpack_argb(packed_from_text(row[wanted.packed->column], wanted.packed->type == ScalarType::i32),
                         wanted.opaque());
    } else if (wanted.red != nullptr) {
      rgba = pack_rgba(colour_byte(row[wanted.red->column], wanted.scale),
                       colour_byte(row[wanted.green->column], wanted.scale),
                       colour_byte(row[wanted.blue->column], wanted.scale));
    }
    if (wanted.normal_x != nullptr) {
      out.set_normal(row[wanted.normal_x->column], row[wanted.normal_y->column], row[wanted.normal_z->column]);
    }
    for (const auto& [field, slot] : wanted.others) out.set_field(slot, row[field->column]);
    out.add(row[wanted.x->column], row[wanted.y->column], row[wanted.z->column], rgba,
            wanted.intensity != nullptr ? static_cast<float>(row[wanted.intensity->column]) : 0.0F);
  }
  if (next(lines)) out.scan().warnings.push_back("the file has more lines than its header has points; left out");
}

}  // namespace
}  // namespace pcd

bool is_pcd(const ScanFile& file) {
  std::string_view line;
  LineReader lines(file.bytes.substr(0, 4096));
  while (lines.next(line)) {
    std::string_view rest = line;
    const std::string word = lower_case(take_word(rest));
    if (word.empty()) continue;
    if (word[0] == '#') {
      if (lower_case(line.substr(0, 64)).find(".pcd") != std::string::npos) return true;
      continue;
    }
    if (word == "version") {
      const std::string_view number = take_word(rest);
      double version = 0.0;
      return parse_number(number.data(), number.data() + number.size(), version) != nullptr;
    }
    return word == "fields" || word == "columns";
  }
  return false;
}

void read_pcd(const ScanFile& file, ScanWriter& out) {
  const pcd::Header header = pcd::parse_header(file);
  RawScan& scan = out.scan();
  scan.format = header.encoding == pcd::Encoding::ascii    ? "PCD ascii"
                : header.encoding == pcd::Encoding::binary ? "PCD binary"
                                                           : "PCD binary_compressed";
  scan.viewpoint = header.viewpoint;
  // All zero is what programs write that do not know.
  if (header.viewpoint) {
    const Eigen::Vector3d place((*header.viewpoint)[0], (*header.viewpoint)[1], (*header.viewpoint)[2]);
    if (!place.isZero(0.0)) out.set_station(place);
  }
  for (const pcd::Field& field : header.fields) {
    if (field.name != "_") scan.fields.push_back(field.name);
  }
  for (const std::string_view name : {"x", "y", "z"}) {
    if (std::count(scan.fields.begin(), scan.fields.end(), name) > 1) {
      throw file.error("the points have " + in_quotes(name) + " twice", "each field once");
    }
  }
  const pcd::Wanted wanted = pcd::wanted_fields(file, header, out);
  const std::uint64_t body = file.bytes.size() - header.body;
  const std::uint64_t most = header.encoding == pcd::Encoding::ascii    ? (body + 1) / (2 * header.columns)
                             : header.encoding == pcd::Encoding::binary ? body / header.record_size
                                                                        : lzf_largest_output(body) / header.record_size;
  if (header.points > most) {
    throw file.error(
        std::to_string(header.points) + " points cannot be in the " + std::to_string(body) + " bytes behind the header",
        "a header that fits the file; it may be cut short");
  }
  if (header.encoding == pcd::Encoding::binary && header.points < most) {
    scan.warnings.push_back("the file has room for " + std::to_string(most) + " points, its header promises " +
                            std::to_string(header.points) + "; the others are left out");
  }
  out.begin(header.points, wanted.has_colour(), wanted.intensity != nullptr, wanted.normal_x != nullptr);
  if (header.points == 0) return;
  switch (header.encoding) {
    case pcd::Encoding::ascii:
      return pcd::read_ascii(file, header, wanted, out);
    case pcd::Encoding::binary:
      return pcd::read_records(file, header, wanted, pcd::BinaryBody(header, file.bytes.data() + header.body, false),
                               out);
    case pcd::Encoding::compressed:
      return pcd::read_compressed(file, header, wanted, out);
  }
}

}  // namespace sparsha::pipeline

#include "pipeline/scan/formats/las/fields.h"

#include <algorithm>
#include <limits>

#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline::las {
namespace {

void add_standard(const Header& header, std::vector<PointField>& fields) {
  const auto add = [&](const char* name, std::size_t offset, ScalarType type) -> PointField& {
    PointField& field = fields.emplace_back();
    field.name = name;
    field.offset = offset;
    field.type = type;
    return field;
  };
  const auto bits = [&](const char* name, std::size_t offset, unsigned shift, unsigned mask) {
    PointField& field = add(name, offset, ScalarType::u8);
    field.shift = shift;
    field.mask = mask;
  };
  // LAS 1.4 R15, tables 7 to 17; LAS 1.0 has no flags beside the class.
  if (header.format >= 6) {
    add(sparsha::pipeline::PointField::kClass, 16, ScalarType::u8);
    bits("synthetic", 15, 0, 1);
    bits("key_point", 15, 1, 1);
    bits("overlap", 15, 3, 1);
    bits("return_number", 14, 0, 15);
    bits("number_of_returns", 14, 4, 15);
    constexpr double kDegrees = 0.006;
    add("scan_angle", 18, ScalarType::i16).scale = kDegrees;
    add("user_data", 17, ScalarType::u8);
    add("point_source_id", 20, ScalarType::u16);
    add("gps_time", 22, ScalarType::f64);
    if (header.format == 8 || header.format == 10) add("infrared", 36, ScalarType::u16);
    return;
  }
  bits(sparsha::pipeline::PointField::kClass, 15, 0, header.minor > 0 ? 31 : 255);
  if (header.minor > 0) {
    bits("synthetic", 15, 5, 1);
    bits("key_point", 15, 6, 1);
  }
  bits("return_number", 14, 0, 7);
  bits("number_of_returns", 14, 3, 7);
  add("scan_angle", 16, ScalarType::i8);
  add("user_data", 17, ScalarType::u8);
  add("point_source_id", 18, ScalarType::u16);
  if (header.format == 1 || header.format >= 3) add("gps_time", 20, ScalarType::f64);
}

/// One of the descriptions in the record of extra bytes (LAS 1.4 R15, table 24).
struct Description {
  static constexpr std::size_t kBytes = 192;

  std::string_view bytes;

  [[nodiscard]] unsigned type() const { return load<std::uint8_t>(bytes.data() + 2); }
  [[nodiscard]] unsigned options() const { return load<std::uint8_t>(bytes.data() + 3); }
  [[nodiscard]] std::string name() const {
    const std::string_view text = bytes.substr(4, 32);
    return std::string(text.substr(0, text.find('\0')));
  }
  [[nodiscard]] std::optional<ScalarType> scalar() const {
    static constexpr ScalarType kTypes[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                            ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                            ScalarType::f32, ScalarType::f64};
    const unsigned t = type();
    return t >= 1 && t <= 10 ? std::optional(kTypes[t - 1]) : std::nullopt;
  }
  /// Of all its numbers: types from 11 on are two or three of one.
  [[nodiscard]] std::size_t size() const {
    const unsigned t = type();
    if (t == 0) return options();
    constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return t <= 30 ? kSizes[(t - 1) % 10] * ((t - 1) / 10 + 1) : 0;
  }
  /// No data are stored in eight bytes of the number's own kind.
  [[nodiscard]] double no_data() const {
    const char* const at = bytes.data() + 40;
    if (type() >= 9) return load<double>(at);
    return type() % 2 == 1 ? static_cast<double>(load<std::uint64_t>(at)) : static_cast<double>(load<std::int64_t>(at));
  }
};

/// Returns the offset behind what is described.
std::size_t add_extra(const Header& header, std::vector<PointField>& fields) {
  std::size_t at = header.extra_offset();
  for (const Record& record : header.records) {
    if (record.user != "LASF_Spec" || record.id != 4) continue;
    for (std::size_t k = 0; k + Description::kBytes <= record.data.size(); k += Description::kBytes) {
      const Description description{record.data.substr(k, Description::kBytes)};
      const std::size_t size = description.size();
      if (size == 0 || size > header.record_size - at) return at;
      const std::optional<ScalarType> type = description.scalar();
      if (type && !description.name().empty()) {
        PointField& field = fields.emplace_back();
        field.name = description.name();
        field.offset = at;
        field.type = *type;
        const unsigned options = description.options();
        if ((options & 1U) != 0) field.no_data = description.no_data();
        if ((options & 8U) != 0) field.scale = load<double>(description.bytes.data() + 112);
        if ((options & 16U) != 0) field.bias = load<double>(description.bytes.data() + 136);
      }
      at += size;
    }
    return at;
  }
  return at;
}

}  // namespace

double PointField::value(const char* point) const {
  const char* const at = point + offset;
  if (mask != 0) return (load<std::uint8_t>(at) >> shift) & mask;
  const double number = load_scalar(at, type);
  if (no_data && number == *no_data) return std::numeric_limits<double>::quiet_NaN();
  return number * scale + bias;
}

std::size_t undescribed_bytes(const Header& header) {
  std::vector<PointField> fields;
  const std::size_t end = add_extra(header, fields);
  return header.record_size - std::min(end, header.record_size);
}

std::vector<PointField> point_fields(const Header& header) {
  std::vector<PointField> fields;
  add_standard(header, fields);
  add_extra(header, fields);
  return fields;
}

}  // namespace sparsha::pipeline::las

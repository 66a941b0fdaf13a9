// notes.yaml, and what measures measure.
#include "viewer/marks/notes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <system_error>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/text.h"
#include "base/yaml/yaml.h"

namespace sparsha::viewer {
namespace {

constexpr std::array<const char*, Measure::kKinds> kKindNames{"distance", "angle", "profile"};
constexpr std::size_t kMostNotes = 10'000;
constexpr std::size_t kLongestText = 2000;  // bytes

std::string vector_text(const Eigen::Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

/// A YAML string in double quotes; control characters are left out.
std::string quoted(const std::string& words) {
  std::string text = "\"";
  for (const char c : words) {
    if (static_cast<unsigned char>(c) < 0x20U || c == 0x7F) continue;
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

Eigen::Vector3d to_vector(const yaml::Node& node) {
  const std::vector<double> values = yaml::to_doubles(node, 3);
  return {values[0], values[1], values[2]};
}

const std::vector<yaml::Node>& list_of(const yaml::Node& node, const char* what) {
  if (!node.is_sequence()) throw yaml::error_at(node, std::string(what) + " is not a list", "a list");
  if (node.items.size() > kMostNotes)
    throw yaml::error_at(node, fmt::format("{} {}", node.items.size(), what), fmt::format("at most {}", kMostNotes));
  return node.items;
}

Pin parse_pin(const yaml::Node& node) {
  yaml::MapReader reader(node, "a pin");
  Pin pin;
  pin.at_m = to_vector(reader.required("at_m"));
  pin.text = yaml::to_text(reader.required("text"));
  std::erase_if(pin.text, [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7F; });
  if (pin.text.size() > kLongestText) throw yaml::error_at(node, "the pin's text is too long", "at most 2000 bytes");
  reader.finish();
  return pin;
}

Measure parse_measure(const yaml::Node& node) {
  yaml::MapReader reader(node, "a measure");
  Measure measure;
  int kind = 0;
  static_cast<void>(reader.required("kind"));
  reader.read_choice("kind", kind, {kKindNames.begin(), kKindNames.end()});
  measure.kind = static_cast<Measure::Kind>(kind);
  const yaml::Node& points = reader.required("points_m");
  for (const yaml::Node& point : list_of(points, "points")) measure.points_m.push_back(to_vector(point));
  if (measure.points_m.size() != points_of(measure.kind))
    throw yaml::error_at(points, fmt::format("{} points of a measure", measure.points_m.size()),
                         fmt::format("{}", points_of(measure.kind)));
  reader.finish();
  return measure;
}

Section parse_section(const yaml::Node& node) {
  yaml::MapReader reader(node, "section");
  Section section;
  section.at_m = to_vector(reader.required("at_m"));
  const yaml::Node& out = reader.required("out");
  section.out = to_vector(out);
  if (!(section.out.norm() > 1e-12)) throw yaml::error_at(out, "out has no direction", "a vector that is not 0 0 0");
  section.out.normalize();
  reader.finish();
  return section;
}

}  // namespace

const char* name_of(Measure::Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

std::size_t points_of(Measure::Kind kind) { return kind == Measure::Kind::angle ? 3 : 2; }

double value_of(const Measure& measure) {
  const auto& p = measure.points_m;
  if (p.size() < points_of(measure.kind)) return 0.0;
  if (measure.kind != Measure::Kind::angle) return (p[1] - p[0]).norm();
  const Eigen::Vector3d a = p[0] - p[1], b = p[2] - p[1];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::string value_text(const Measure& measure) {
  const double value = value_of(measure);
  if (measure.kind != Measure::Kind::angle) return length_text(value, TextStyle::screen);
  return sparsha::value_text(value * 180.0 / std::numbers::pi, 3) + " degrees";
}

Notes moved(const Notes& notes, const Eigen::Matrix4d& matrix) {
  const auto place = [&](const Eigen::Vector3d& p) { return Eigen::Vector3d((matrix * p.homogeneous()).head<3>()); };
  Notes result = notes;
  for (Pin& pin : result.pins) pin.at_m = place(pin.at_m);
  for (Measure& measure : result.measures)
    for (Eigen::Vector3d& point : measure.points_m) point = place(point);
  if (result.section) {
    result.section->at_m = place(result.section->at_m);
    result.section->out = (matrix.topLeftCorner<3, 3>() * result.section->out).normalized();
  }
  return result;
}

Notes read_notes(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return {};
  try {
    const yaml::Node root = yaml::parse_file(file);
    Notes notes;
    if (root.kind == yaml::Node::Kind::null) return notes;
    yaml::MapReader reader(root, "notes");
    if (const yaml::Node* node = reader.optional("pins"))
      for (const yaml::Node& item : list_of(*node, "pins")) notes.pins.push_back(parse_pin(item));
    if (const yaml::Node* node = reader.optional("measures"))
      for (const yaml::Node& item : list_of(*node, "measures")) notes.measures.push_back(parse_measure(item));
    if (const yaml::Node* node = reader.optional("section")) notes.section = parse_section(*node);
    reader.read("parallel", notes.parallel);
    reader.finish();
    return notes;
  } catch (const Error& error) {
    throw Error(ErrorKind::input, error.place(), error.wrong(), error.expected());
  }
}

void write_notes(const Notes& notes, const std::filesystem::path& file) {
  std::string text = "# Notes on the object, in the frame of its scans, metres. Written by sparsha explore.\n";
  if (!notes.pins.empty()) text += "pins:\n";
  for (const Pin& pin : notes.pins)
    text += fmt::format("  - {{at_m: {}, text: {}}}\n", vector_text(pin.at_m), quoted(pin.text));
  if (!notes.measures.empty()) text += "measures:\n";
  for (const Measure& measure : notes.measures) {
    std::string points;
    for (const Eigen::Vector3d& point : measure.points_m) points += (points.empty() ? "" : ", ") + vector_text(point);
    text += fmt::format("  - {{kind: {}, points_m: [{}]}}\n", name_of(measure.kind), points);
  }
  if (notes.section)
    text += fmt::format("section: {{at_m: {}, out: {}}}\n", vector_text(notes.section->at_m),
                        vector_text(notes.section->out));
  if (notes.parallel) text += "parallel: true\n";
  write_file(file, text);
}

}  // namespace sparsha::viewer

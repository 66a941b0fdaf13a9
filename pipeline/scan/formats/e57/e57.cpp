#include "pipeline/scan/formats/e57/e57.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <pugixml.hpp>

#include "pipeline/scan/formats/e57/colours.hpp"
#include "pipeline/scan/formats/e57/notes.hpp"
#include "pipeline/scan/formats/e57/pictures.hpp"
#include "pipeline/scan/formats/e57/points.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace e57 {
namespace {

/// Indices of a point's place within the wanted streams, -1 without.
struct Place {
  int a = -1, b = -1, c = -1;  ///< x y z, or range azimuth elevation
  bool spherical = false;
  int invalid = -1;

  [[nodiscard]] bool is_whole() const { return a >= 0 && b >= 0 && c >= 0; }
};

/// Index of a field within the wanted streams, -1 without.
struct Roles {
  Place place;
  std::optional<Place> other_place;  ///< of points whose place is not valid
  int red = -1, green = -1, blue = -1;
  int intensity = -1;
  int no_intensity = -1, no_colour = -1;    // flags of points that have none
  std::vector<std::pair<int, int>> others;  // that somebody asks for, and their slots
  int nx = -1, ny = -1, nz = -1;            // of the extension for normals
};

struct Scan {
  std::string name, guid;
  std::uint64_t section = 0;
  std::uint64_t records = 0;
  std::vector<Field> fields;
  std::vector<std::size_t> wanted;
  Roles roles;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  bool posed = false;  // the file says where it was made from
  ColourLimits colours;
};

/// A text without the blanks around it; empty where there is none.
std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

class Reader {
 public:
  Reader(const ScanFile& file, ScanWriter& out) : file_(file), out_(out), pages_(file) {}

  void read() {
    const std::string text = pages_.xml();
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
    if (!parsed) throw file_.error(std::string("the XML section is damaged: ") + parsed.description(), "XML");
    std::vector<Scan> scans;
    std::size_t count = 0;
    for (const pugi::xml_node& node : document.child("e57Root").child("data3D").children("vectorChild")) {
      attempt(name_of(node, ++count), [&] {
        scans.push_back(parse_scan(node));
        scans.back().name = name_of(node, count);
      });
    }
    if (count == 0) throw file_.error("the file has no 3D data", "at least one scan");
    RawScan& scan = out_.scan();
    scan.format = "E57";
    scan.unit = scene::LengthUnit::m;
    scan.scans = count;
    std::uint64_t records = 0;
    for (const Scan& s : scans) {
      records += std::min<std::uint64_t>(s.records, file_.bytes.size() * 8);
      for (const Field& field : s.fields) {
        if (std::find(scan.fields.begin(), scan.fields.end(), field.name) == scan.fields.end()) {
          scan.fields.push_back(field.name);
        }
      }
    }
    // A record may be as short as a few bits, so only what the bytes surely hold is reserved.
    out_.begin(std::min<std::uint64_t>(records, file_.bytes.size() / 4), false, false);
    for (Scan& s : scans) {
      const std::uint64_t before = out_.records();
      attempt(
          s.name, [&] { read_scan_points(s, document.child("e57Root").child("images2D")); },
          [&] { return "only " + std::to_string(out_.records() - before) + " of its points are read: "; });
    }
    if (unreadable_ == count) throw *first_error_;
    if (out_.records() > 0) {
      for (const Scan& s : scans) {
        if (s.records == 0) scan.warnings.push_back(s.name + ": it has no points and is left out");
      }
    }
    scan.notes = notes_of(document.child("e57Root"), used_pictures_);
  }

 private:
  /// Runs `read` for one of the file's scans. What cannot be read is a warning, since the others can: `lead` says in it
  /// what is lost.
  template <typename Read, typename Lead>
  void attempt(const std::string& name, const Read& read, const Lead& lead) {
    try {
      read();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      if (!first_error_)
        first_error_ = Error(error.kind(), error.place(), name + ": " + error.wrong(), error.expected());
      ++unreadable_;
      out_.scan().warnings.push_back(name + ": " + lead() + error.wrong());
    }
  }
  template <typename Read>
  void attempt(const std::string& name, const Read& read) {
    attempt(name, read, [] { return "it cannot be read and is left out: "; });
  }

  /// As people know a scan of the file: its number, its name and its GUID.
  static std::string name_of(const pugi::xml_node& node, std::size_t number) {
    std::string text = "scan " + std::to_string(number) + " of the file";
    for (const char* key : {"name", "guid"}) {
      const std::string_view value = trimmed(node.child_value(key));
      if (!value.empty()) text += ", " + printable(value);
    }
    return text;
  }

  /// The finite number that `text` is; `otherwise` when there is none.
  double number_in(std::string_view text, const char* name, double otherwise) const {
    text = trimmed(text);
    if (text.empty()) return otherwise;
    double value = 0.0;
    const char* const end = text.data() + text.size();
    if (parse_number(text.data(), end, value) != end || !std::isfinite(value)) {
      throw file_.error(in_quotes(text) + " as " + in_quotes(name) + " in the XML section", "a finite number");
    }
    return value;
  }
  /// What an element says, by its type.
  double number_of(const pugi::xml_node& node) const {
    const double number = number_in(node.child_value(), node.name(), 0.0);
    if (std::string_view(node.attribute("type").value()) != "ScaledInteger") return number;
    return number * number_in(node.attribute("scale").value(), "scale", 1.0) +
           number_in(node.attribute("offset").value(), "offset", 0.0);
  }

  std::int64_t integer_of(const pugi::xml_attribute& attribute, std::int64_t otherwise) const {
    const std::string_view text = trimmed(attribute.value());
    if (text.empty()) return otherwise;
    std::int64_t value = 0;
    const char* const end = text.data() + text.size();
    if (parse_integer(text.data(), end, value) == end) return value;
    const double number = number_in(text, attribute.name(), 0.0);  // "3.0" is whole too
    constexpr double kExact = 9007199254740992.0;
    if (number != std::floor(number) || std::fabs(number) > kExact) {
      throw file_.error(in_quotes(text) + " as " + in_quotes(attribute.name()) + " in the XML section",
                        "a whole number of 64 bits");
    }
    return static_cast<std::int64_t>(number);
  }

  void parse_fields(const pugi::xml_node& node, Scan& scan, int depth) const {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view type = child.attribute("type").value();
      Field field;
      field.name = child.name();
      if (type == "Float") {
        const bool single = std::string_view(child.attribute("precision").value()) == "single";
        field.kind = single ? Field::Kind::single : Field::Kind::real;
      } else if (type == "Integer" || type == "ScaledInteger") {
        field.kind = Field::Kind::integer;
        field.minimum = integer_of(child.attribute("minimum"), std::numeric_limits<std::int64_t>::min());
        field.maximum = integer_of(child.attribute("maximum"), std::numeric_limits<std::int64_t>::max());
        if (field.maximum < field.minimum) {
          throw file_.error("field " + in_quotes(field.name) + " has a maximum below its minimum",
                            "an undamaged E57 file");
        }
        if (type == "ScaledInteger") {
          field.scale = number_in(child.attribute("scale").value(), "scale", 1.0);
          field.offset = number_in(child.attribute("offset").value(), "offset", 0.0);
          if (field.scale == 0.0) {
            throw file_.error("field " + in_quotes(field.name) + " has a scale of zero", "a scale that is not zero");
          }
        }
      } else if (type == "Structure" && depth < 16) {
        parse_fields(child, scan, depth + 1);
        continue;
      } else {
        field.kind = Field::Kind::other;
      }
      scan.fields.push_back(std::move(field));
    }
  }

  int want(Scan& scan, std::string_view name) const {
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
      if (scan.fields[i].name != name || scan.fields[i].kind == Field::Kind::other) continue;
      scan.wanted.push_back(i);
      return static_cast<int>(scan.wanted.size()) - 1;
    }
    return -1;
  }

  void choose_others(Scan& scan) const {
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
      if (scan.fields[i].kind == Field::Kind::other) continue;
      const int slot = out_.want(scan.fields[i].name);
      if (slot == ScanWriter::kUnwanted) continue;
      const auto known = std::find(scan.wanted.begin(), scan.wanted.end(), i);
      scan.roles.others.emplace_back(static_cast<int>(known - scan.wanted.begin()), slot);
      if (known == scan.wanted.end()) scan.wanted.push_back(i);
    }
  }

  Place want_place(Scan& scan, bool spherical) const {
    Place place;
    place.spherical = spherical;
    place.a = want(scan, spherical ? "sphericalRange" : "cartesianX");
    place.b = want(scan, spherical ? "sphericalAzimuth" : "cartesianY");
    place.c = want(scan, spherical ? "sphericalElevation" : "cartesianZ");
    place.invalid = want(scan, spherical ? "sphericalInvalidState" : "cartesianInvalidState");
    return place;
  }

  /// Of the names of the extension for normals, which the file may choose; the usual one where it declares none.
  static std::string prefix_of_normals(const pugi::xml_node& scan) {
    constexpr std::string_view kDeclaration = "xmlns:";
    const pugi::xml_node prototype = scan.child("points").child("prototype");
    for (pugi::xml_node node = prototype; node; node = node.parent()) {
      for (const pugi::xml_attribute& attribute : node.attributes()) {
        const std::string_view name = attribute.name(), uri = attribute.value();
        if (name.starts_with(kDeclaration) && uri.find("surface_normals") != std::string_view::npos)
          return std::string(name.substr(kDeclaration.size()));
      }
    }
    return "nor";
  }

  void choose_fields(const pugi::xml_node& node, Scan& scan) const {
    const auto has = [&](std::string_view name) {
      return std::any_of(scan.fields.begin(), scan.fields.end(), [&](const Field& f) { return f.name == name; });
    };
    Roles& roles = scan.roles;
    const Place cartesian = want_place(scan, false);
    const Place spherical = cartesian.is_whole() && !(cartesian.invalid >= 0 && has("sphericalInvalidState"))
                                ? Place{}
                                : want_place(scan, true);
    if (!cartesian.is_whole() && !spherical.is_whole()) {
      throw file_.error("a scan has neither Cartesian nor spherical coordinates",
                        "cartesianX, Y, Z or sphericalRange, Azimuth, Elevation");
    }
    roles.place = cartesian.is_whole() ? cartesian : spherical;
    if (cartesian.is_whole() && spherical.is_whole()) roles.other_place = spherical;
    roles.intensity = want(scan, "intensity");
    if (roles.intensity >= 0) roles.no_intensity = want(scan, "isIntensityInvalid");
    const std::string normal = prefix_of_normals(node) + ":normal";
    if (has(normal + "X") && has(normal + "Y") && has(normal + "Z")) {
      roles.nx = want(scan, normal + "X");
      roles.ny = want(scan, normal + "Y");
      roles.nz = want(scan, normal + "Z");
      if (roles.ny < 0 || roles.nz < 0) roles.nx = -1;
    }
    if (has("colorRed") && has("colorGreen") && has("colorBlue")) {
      roles.red = want(scan, "colorRed");
      roles.green = want(scan, "colorGreen");
      roles.blue = want(scan, "colorBlue");
      if (roles.green < 0 || roles.blue < 0) roles.red = -1;
    }
    if (roles.red >= 0) roles.no_colour = want(scan, "isColorInvalid");
    choose_others(scan);
    if (roles.red >= 0) {
      scan.colours =
          ColourLimits({field_of(scan, roles.red), field_of(scan, roles.green), field_of(scan, roles.blue)},
                       node.child("colorLimits"), [&](const pugi::xml_node& number) { return number_of(number); });
    }
  }

  static const Field* field_of(const Scan& scan, int role) {
    return &scan.fields[scan.wanted[static_cast<std::size_t>(role)]];
  }

  /// Where the limits of colours are open: what the values of all records tell, with a warning.
  void settle_colours(Scan& scan) const {
    if (!scan.colours.are_open()) return;
    std::vector<std::size_t> channels;
    for (const int role : {scan.roles.red, scan.roles.green, scan.roles.blue})
      channels.push_back(scan.wanted[static_cast<std::size_t>(role)]);
    try {
      read_points(file_, pages_, scan.section, scan.records, scan.fields, channels,
                  [&](std::vector<FieldStream>& streams) {
                    const double red = streams[0].take(), green = streams[1].take();
                    return scan.colours.look({red, green, streams[2].take()});
                  });
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;  // damage is said by those who read the points
    }
    if (const std::optional<std::string> said = scan.colours.settle())
      out_.scan().warnings.push_back(scan.name + ": " + *said);
  }

  Scan parse_scan(const pugi::xml_node& node) const {
    Scan scan;
    const pugi::xml_node points = node.child("points");
    const std::int64_t records = integer_of(points.attribute("recordCount"), -1);
    const std::int64_t section = integer_of(points.attribute("fileOffset"), -1);
    if (records < 0 || section < 0) throw file_.error("a scan without points", "their place and number");
    for (const pugi::xml_node& codec : points.child("codecs").children("vectorChild")) {
      if (!codec.child("bitPackCodec")) throw file_.error("points packed by an unknown codec", "bitPackCodec");
    }
    scan.records = static_cast<std::uint64_t>(records);
    scan.section = static_cast<std::uint64_t>(section);
    parse_fields(points.child("prototype"), scan, 0);
    choose_fields(node, scan);
    const Pose pose = pose_of(node, [&](const pugi::xml_node& number) { return number_of(number); });
    if (pose.zero_turn) {
      out_.scan().warnings.push_back("the quaternion of a scan's pose is zero; taken as no rotation");
    }
    scan.turn = pose.turn;
    scan.shift = pose.shift;
    scan.guid = node.child_value("guid");
    scan.posed = !node.child("pose").empty();
    return scan;
  }

  /// Of a scan without colours, where it has some.
  std::optional<Pictures> pictures_of(const Scan& scan, const pugi::xml_node& images) {
    if (scan.roles.red >= 0 || !images) return std::nullopt;
    Pictures pictures(
        file_, pages_, images, scan.guid, scan.shift, [&](const pugi::xml_node& number) { return number_of(number); },
        out_.scan().warnings);
    used_pictures_ += pictures.size();
    if (pictures.size() == 0) return std::nullopt;
    return pictures;
  }

  void read_scan_points(Scan& scan, const pugi::xml_node& images) {
    const Roles& roles = scan.roles;
    if (roles.red >= 0) settle_colours(scan);
    const std::optional<Pictures> pictures = pictures_of(scan, images);
    const bool posed = !scan.turn.isIdentity(0.0) || !scan.shift.isZero(0.0);
    // The scanner is the origin of its own coordinates; without a pose or angles they may be anybody's.
    out_.set_station(scan.posed || roles.place.spherical || roles.other_place ? std::optional(scan.shift)
                                                                              : std::nullopt);
    std::vector<double> values(scan.wanted.size());
    const auto value = [&](int role) { return values[static_cast<std::size_t>(role)]; };
    out_.set_attributes(roles.red >= 0 || pictures.has_value(), roles.intensity >= 0, roles.nx >= 0);
    const auto is_flagged = [&](int role) { return role >= 0 && value(role) != 0.0; };
    read_points(
        file_, pages_, scan.section, scan.records, scan.fields, scan.wanted, [&](std::vector<FieldStream>& streams) {
          for (std::size_t i = 0; i < streams.size(); ++i) values[i] = streams[i].take();
          const Place* const place =
              is_flagged(roles.place.invalid) && roles.other_place ? &*roles.other_place : &roles.place;
          if (is_flagged(place->invalid)) {
            out_.add_invalid();
            return true;
          }
          Eigen::Vector3d p(value(place->a), value(place->b), value(place->c));
          if (place->spherical) {
            const double flat = p.x() * std::cos(p.z());
            p = {flat * std::cos(p.y()), flat * std::sin(p.y()), p.x() * std::sin(p.z())};
          }
          if (posed) p = scan.turn * p + scan.shift;
          for (const auto& [role, slot] : roles.others) out_.set_field(slot, value(role));
          std::uint32_t rgba = kNoColour;
          if (pictures) {
            rgba = pictures->colour(p);
          } else if (roles.red >= 0 && !is_flagged(roles.no_colour)) {
            rgba = scan.colours.rgba({value(roles.red), value(roles.green), value(roles.blue)});
          }
          if (roles.nx >= 0) {
            const Eigen::Vector3d n = scan.turn * Eigen::Vector3d(value(roles.nx), value(roles.ny), value(roles.nz));
            out_.set_normal(n.x(), n.y(), n.z());
          }
          out_.add(p.x(), p.y(), p.z(), rgba,
                   roles.intensity >= 0 && !is_flagged(roles.no_intensity) ? static_cast<float>(value(roles.intensity))
                                                                           : kNoIntensity);
          return true;
        });
  }

  const ScanFile& file_;
  ScanWriter& out_;
  std::size_t unreadable_ = 0, used_pictures_ = 0;
  std::optional<Error> first_error_;
  Pages pages_;
};

}  // namespace
}  // namespace e57

bool is_e57(const ScanFile& file) { return file.bytes.substr(0, 8) == "ASTM-E57"; }

void read_e57(const ScanFile& file, ScanWriter& out) { e57::Reader(file, out).read(); }

}  // namespace sparsha::pipeline

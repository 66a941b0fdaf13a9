// Scans with their units and poses, and the orientation of the grid.
#include "scene/config/placement.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <fmt/ranges.h>

#include "base/error.h"
#include "scene/config/reader.h"

namespace sparsha::scene {
namespace {

using yaml::MapReader;
using yaml::Node;

// Rotation about fixed axes, x first.
Eigen::Matrix3d euler(const Node& node) {
  const Eigen::Vector3d radians = vector(node) * (std::numbers::pi / 180.0);
  return (Eigen::AngleAxisd(radians.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(radians.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(radians.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d quaternion(const Node& node) {
  const std::vector<double> v = yaml::to_doubles(node, 4);
  const Eigen::Quaterniond q(v[3], v[0], v[1], v[2]);
  if (std::abs(q.norm() - 1.0) > 1e-2) {
    throw yaml::error_at(node, "the quaternion does not have length 1", "[x, y, z, w] of length 1");
  }
  return q.normalized().toRotationMatrix();
}

Eigen::Matrix4d matrix(const Node& node) {
  std::vector<double> v;
  if (node.is_sequence() && node.items.size() == 4 && node.items.front().is_sequence()) {
    for (const Node& row : node.items)
      for (const double value : yaml::to_doubles(row, 4)) v.push_back(value);
  } else {
    v = yaml::to_doubles(node, 16);
  }
  Eigen::Matrix4d m;
  for (int i = 0; i < 16; ++i) m(i / 4, i % 4) = v[static_cast<std::size_t>(i)];
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw yaml::error_at(node, "the last row is not 0 0 0 1", "an affine 4x4 matrix, row by row");
  }
  const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
  const double size = linear.cwiseAbs().maxCoeff();
  if (!(size > 0.0) || std::abs((linear / size).determinant()) < 1e-9) {
    throw yaml::error_at(node, "the matrix is singular", "an invertible affine matrix");
  }
  return m;
}

Units parse_units(const Node& node) {
  Units units;
  if (node.is_map()) {
    MapReader reader(node, "units");
    static_cast<void>(reader.required("longest_side_mm"));
    units.unit = LengthUnit::longest_side;
    read_mm(reader, "longest_side_mm", units.longest_side_m, kSmallest, kAny);
    reader.finish();
    return units;
  }
  const std::string text = yaml::to_text(node);
  std::vector<std::string> names;
  for (const LengthUnit unit : {LengthUnit::m, LengthUnit::cm, LengthUnit::mm, LengthUnit::ft, LengthUnit::us_ft}) {
    names.push_back(to_string(unit));
    units.unit = unit;
    if (text == names.back()) return units;
  }
  std::string expected = "m | cm | mm | ft | us_ft | {longest_side_mm: NUMBER}";
  if (const std::string near = yaml::nearest(text, names); !near.empty()) {
    expected += " (did you mean '" + near + "'?)";
  }
  throw yaml::error_at(node, "units is '" + text + "'", expected);
}

Eigen::Matrix4d parse_pose(const Node& node) {
  MapReader reader(node, "pose");
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  const int form = exclusive(reader, {"quaternion", "euler_deg", "matrix"});
  if (form == 0) pose.topLeftCorner<3, 3>() = quaternion(reader.required("quaternion"));
  if (form == 1) pose.topLeftCorner<3, 3>() = euler(reader.required("euler_deg"));
  if (form == 2) {
    const Node& value = reader.required("matrix");
    pose = matrix(value);
    const Eigen::Matrix3d r = pose.topLeftCorner<3, 3>();
    if (!(r * r.transpose()).isIdentity(1e-3) || r.determinant() < 0) {
      throw yaml::error_at(value, "the pose's matrix is not rigid",
                           "a rotation and a translation; sizes belong in units");
    }
  }
  if (const Node* translate = reader.optional("translate")) {
    if (form == 2) throw yaml::error_at(*translate, "'matrix' and 'translate' contradict", "one of them");
    pose.topRightCorner<3, 1>() = vector(*translate);
  }
  reader.finish();
  return pose;
}

/// Field names of a text file's columns; x, y and z once each, colours and normals with all three parts or none.
std::vector<std::string> parse_columns(const Node& node) {
  static const std::vector<std::string> kNames{"skip", "x",         "y",  "z",  "red", "green",
                                               "blue", "intensity", "nx", "ny", "nz"};
  if (!node.is_sequence()) throw yaml::error_at(node, "columns is not a list", "[skip, x, y, z, red, green, blue]");
  std::vector<std::string> columns;
  for (const Node& item : node.items) {
    columns.push_back(yaml::to_text(item));
    if (std::find(kNames.begin(), kNames.end(), columns.back()) == kNames.end()) {
      const std::string near = yaml::nearest(columns.back(), kNames);
      throw yaml::error_at(item, "a column is called '" + columns.back() + "'",
                           "skip | x | y | z | red | green | blue | intensity | nx | ny | nz" +
                               (near.empty() ? "" : " (did you mean '" + near + "'?)"));
    }
    if (columns.back() != "skip" && std::count(columns.begin(), columns.end(), columns.back()) > 1) {
      throw yaml::error_at(item, "two columns are called '" + columns.back() + "'", "each name once, but skip");
    }
  }
  for (const char* axis : {"x", "y", "z"}) {
    if (std::find(columns.begin(), columns.end(), axis) == columns.end()) {
      throw yaml::error_at(node, std::string("no column is called ") + axis, "x, y and z among the columns");
    }
  }
  const auto is_named = [&](const char* name) {
    return std::find(columns.begin(), columns.end(), name) != columns.end();
  };
  constexpr std::array<std::array<const char*, 3>, 2> kTriples{{{"red", "green", "blue"}, {"nx", "ny", "nz"}}};
  for (const auto& [a, b, c] : kTriples) {
    if ((is_named(a) || is_named(b) || is_named(c)) && !(is_named(a) && is_named(b) && is_named(c))) {
      throw yaml::error_at(node, fmt::format("not all of {}, {} and {} are among the columns", a, b, c),
                           "the three of them or none");
    }
  }
  return columns;
}

}  // namespace

ScanConfig parse_scan(const Node& node, const std::filesystem::path& folder) {
  ScanConfig scan;
  MapReader reader(node, "a scan", "a block of keys for each file: '- file: NAME', without patterns");
  scan.file = resolved(reader.required("file"), folder);
  if (const Node* units = reader.optional("units")) scan.units = parse_units(*units);
  if (const Node* pose = reader.optional("pose")) scan.pose = parse_pose(*pose);
  if (const Node* columns = reader.optional("columns")) scan.columns = parse_columns(*columns);
  reader.finish();
  return scan;
}

OrientationConfig parse_orientation(const Node& node) {
  OrientationConfig orientation;
  MapReader reader(node, "orientation");
  const int form = exclusive(reader, {"look_from", "euler_deg", "quaternion", "matrix", "face"});
  double scale = 1.0;
  reader.read("scale", scale, 1e-9, 1e9);
  const Node* up = reader.optional("up");
  int face = 0;
  if (form == 4) reader.read_choice("face", face, {"auto", "plane", "principal"});
  if (const Node* regions = reader.optional("regions_matrix")) orientation.regions_scan_to_grid = matrix(*regions);
  reader.finish();
  if (form == 4) {
    orientation.face = static_cast<OrientationConfig::Face>(face);
    orientation.face_scale = scale;
    if (up == nullptr) return orientation;
    orientation.face_up = vector(*up);
    if (orientation.face_up->isZero(0.0)) throw yaml::error_at(*up, "'up' has no direction", "a vector of some length");
    return orientation;
  }
  if (up != nullptr && form > 0) throw yaml::error_at(*up, "'up' belongs to 'look_from'", "leave it out");
  Eigen::Matrix4d& m = orientation.scan_to_grid;
  if (form == 3) {
    if (const Node* given = node.find("scale")) {
      throw yaml::error_at(*given, "'matrix' and 'scale' contradict", "the scale within the matrix");
    }
    m = matrix(*node.find("matrix"));
  } else if (form == 1 || form == 2) {
    m.topLeftCorner<3, 3>() =
        scale * (form == 1 ? euler(*node.find("euler_deg")) : quaternion(*node.find("quaternion")));
  } else {
    const Eigen::Vector3d direction = form == 0 ? vector(*node.find("look_from")) : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d up_direction = up != nullptr ? vector(*up) : Eigen::Vector3d::UnitY();
    try {
      m = look_from(direction, up_direction, scale);
    } catch (const Error& error) {
      throw yaml::error_at(up != nullptr ? *up : node, error.wrong(), error.expected());
    }
  }
  return orientation;
}

Eigen::Matrix4d look_from(const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double scale) {
  if (!(direction.norm() > 0.0)) throw usage_error("look_from has no direction", "a vector that is not 0 0 0");
  const Eigen::Vector3d z = direction.normalized();
  const Eigen::Vector3d x = up.cross(z);
  if (!(x.norm() > 1e-6 * up.norm())) {
    throw usage_error("up is parallel to look_from", "an up that points elsewhere than the viewer");
  }
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = scale * x.normalized().transpose();
  m.block<1, 3>(1, 0) = scale * z.cross(x.normalized()).transpose();
  m.block<1, 3>(2, 0) = scale * z.transpose();
  return m;
}

}  // namespace sparsha::scene

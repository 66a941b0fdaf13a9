// The models of a 3MF package: objects with meshes or components, and what of them is built.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/threemf/zip.h"

namespace sparsha::pipeline::threemf {

/// The part of the package, lower case, and the number that it gives the object.
using ObjectKey = std::pair<std::string, std::string>;

struct Use {
  ObjectKey object;
  Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
};

struct Object {
  std::vector<Eigen::Vector3d> vertices;  ///< the model's unit
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Use> components;
  bool support = false;  ///< not part of what is printed in the end
};

struct Package {
  std::string unit = "millimeter";
  std::map<ObjectKey, Object> objects;
  std::vector<Use> items;
  std::uint64_t bytes = 0;                                   ///< of the models' text
  bool coloured = false;                                     ///< colours or materials are there
  std::map<std::string, std::uint64_t, std::less<>> unread;  ///< elements within objects that would give them form
  std::vector<std::string> warnings;
};

/// Reads the model that the package names, and those that it names in turn. Throws Error{input}.
[[nodiscard]] Package read_package(const ScanFile& file, const ZipArchive& archive);

}  // namespace sparsha::pipeline::threemf

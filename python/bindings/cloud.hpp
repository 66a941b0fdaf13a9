// Clouds of points: from files, from arrays, through filters, and as a file for those that read files.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/files/files.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::python {

using CloudPointer = std::shared_ptr<pipeline::Cloud>;

/// A cloud as a PLY file of doubles, in a folder that goes with this object. The same cloud gives the same bytes.
class CloudFile {
 public:
  /// Throws Error{failure} when there is no room.
  explicit CloudFile(const pipeline::Cloud& cloud);
  [[nodiscard]] std::filesystem::path path() const { return folder_.temporary() / kName; }
  static constexpr const char* kName = "cloud.ply";

 private:
  AtomicPath folder_;
};

void bind_cloud(pybind11::module_& module);

}  // namespace sparsha::python

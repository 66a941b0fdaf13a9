// Clouds of points: from files, from arrays, through filters, and as a file for those that read files.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::python {

using CloudPointer = std::shared_ptr<pipeline::Cloud>;

/// A cloud as a PLY file of doubles, in a folder that goes with this object. The same cloud gives the same bytes.
class CloudFile {
 public:
  /// `cloud` outlives this. Throws Error{failure} when there is no folder for temporary files.
  explicit CloudFile(const pipeline::Cloud& cloud);
  /// Throws Error{failure} when there is no room; Cancelled.
  void write(Progress& progress) const;
  [[nodiscard]] std::filesystem::path path() const { return folder_.temporary() / kName; }
  static constexpr const char* kName = "cloud.ply";

 private:
  const pipeline::Cloud& cloud_;
  AtomicPath folder_;
};

/// The cloud of an object that is one. Raises TypeError where it was never made.
[[nodiscard]] CloudPointer cloud_of(const pybind11::handle& given);

void bind_cloud(pybind11::module_& module);

}  // namespace sparsha::python

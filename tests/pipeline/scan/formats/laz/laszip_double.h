// What stands for LASzip in tests: "unpacks" what packed() made, records the calls and fails where it is told
// to.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "tests/pipeline/scan/formats/las_files.h"

namespace sparsha::pipeline::testing {

/// What goes wrong, read before the process is copied.
struct LaszipFaults {
  bool create = false;
  bool open = false;
  bool point_pointer = false;
  bool close = false;                ///< crashes
  std::optional<std::int64_t> read;  ///< of that point, from 0
  std::function<void()> instead;     ///< done in place of the failure of `read`
  std::string message = "as the test wants it";
};

/// In memory that the process in which LASzip runs shares with the test.
struct LaszipBooks {
  int process = 0;  ///< that made the last reader
  int created = 0, destroyed = 0, opened = 0, closed = 0;
  std::int64_t reads = 0;
  char misuses[256] = {};  ///< calls that LASzip forbids, or by which it would leak
};

extern LaszipFaults laszip_faults;
extern LaszipBooks& laszip_books;

/// The file as LAZ: the bits of format and record that tell of LASzip, and points that are garbled.
[[nodiscard]] std::string packed(LasFile file);

}  // namespace sparsha::pipeline::testing

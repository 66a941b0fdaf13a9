// What stands for LASzip in tests: "unpacks" what packed() made, keeps books of the calls and fails where it is told
// to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/pipeline/scan/las_files.h"

namespace sparsha::pipeline::testing {

/// What goes wrong.
struct LaszipFaults {
  bool create = false;
  bool open = false;
  bool point_pointer = false;
  bool seek = false;
  std::optional<std::int64_t> read;  ///< of that point, from 0
  std::string message = "as the test wants it";
};

struct LaszipBooks {
  int created = 0, destroyed = 0, opened = 0, closed = 0, seeks = 0;
  std::int64_t reads = 0;
  std::vector<std::string> misuses;  ///< calls that LASzip forbids, or by which it would leak
};

extern LaszipFaults laszip_faults;
extern LaszipBooks laszip_books;

/// The file as LAZ: the bits of format and record that tell of LASzip, and points that are garbled.
[[nodiscard]] std::string packed(LasFile file);

}  // namespace sparsha::pipeline::testing

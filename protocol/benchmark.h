// The open benchmark (protocol/protocol.md): its cases, and its files for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "protocol/course.h"

namespace sparsha::protocol {

inline constexpr double kOpenStiffness_n_per_m = 500.0;
inline constexpr int kOpenNodes = 201;  // per side
inline constexpr double kOpenTick_s = 0.001;

/// One path over one surface with its true forces. Grid frame, metres and newtons.
struct OpenCase {
  std::string name;  ///< of small letters, digits and dashes
  Ground ground;
  double speed_m_per_s = 0.0;
  double depth_m = 0.0;
  Course course;
  std::size_t last = 0;  ///< ticks [course.first, last) are judged; later ones leave the surface

  [[nodiscard]] bool contact(std::size_t tick) const;
  [[nodiscard]] Eigen::Vector3d true_force(std::size_t tick) const;  ///< zero without contact
};

[[nodiscard]] std::vector<OpenCase> open_cases();

/// protocol/protocol.md as it was when this program was built.
[[nodiscard]] const char* protocol_text();

/// Writes the whole benchmark; `folder` appears when it is complete and replaces an older one. Throws Error{failure}
/// when it cannot be written, Error{usage} when it is a folder with a file that no export wrote.
/// `progress`, where there is one, is told of the stage "export" and may cancel.
void export_benchmark(const std::filesystem::path& folder, Progress* progress = nullptr);

/// Files of a case below the benchmark's folder.
[[nodiscard]] std::filesystem::path path_file(const std::string& case_name);
[[nodiscard]] std::filesystem::path truth_file(const std::string& case_name);

}  // namespace sparsha::protocol

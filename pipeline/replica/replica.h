// A scene as a solid to be printed and held: the relief on a base plate, its parts' names in Braille below it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

struct ReplicaOptions {
  double longest_mm = 200.0;       ///< the relief's longer side in print
  std::optional<double> depth_mm;  ///< from the lowest to the highest node; empty = true to scale, 3 to 15 mm
  double curve = 1.0;              ///< < 1 raises low relief, > 1 flattens it; the order of depths stays
  double base_mm = 3.0;            ///< under the lowest node
  bool braille = true;             ///< the parts' names below the relief
};

/// Heights above the plate's bottom, mm, over a lattice in print; row 0 is the lower edge.
struct ReplicaPlate {
  int nx = 0, ny = 0;
  double spacing_mm = 0.0;
  int first_row = 0;  ///< of the relief; below it lies the Braille
  std::vector<float> height_mm;

  [[nodiscard]] float at(int i, int j) const {
    return height_mm[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double width_mm() const { return (nx - 1) * spacing_mm; }
  [[nodiscard]] double length_mm() const { return (ny - 1) * spacing_mm; }
};

/// What a person who prints it should know.
struct ReplicaReport {
  double width_mm = 0.0, length_mm = 0.0, thickness_mm = 0.0;
  double scale = 0.0;       ///< print over object, across
  double raised = 1.0;      ///< depth in print over depth true to that scale
  double volume_mm3 = 0.0;  ///< of the solid, by the integral of its bilinear heights
  std::uint64_t triangles = 0;
  double unknown = 0.0;               ///< share of the relief that nobody measured; it lies at the base
  double felt = 0.0;                  ///< share of the relief with features of 0.5 mm and more within 5 mm
  double crowded = 0.0;               ///< share where grooves or ridges of 0.5 mm are narrower than 5 mm
  std::vector<std::string> lines;     ///< of Braille, as text
  std::vector<std::string> warnings;  ///< each with what to do
};

/// Rules for tactile graphics that the legibility map follows: features of 0.5 mm, 5 mm apart, on 1.5 mm of base.
inline constexpr double kLeastFeature_mm = 0.5, kLeastGap_mm = 5.0, kLeastBase_mm = 1.5;

/// Throws Error{usage} for options out of range, Error{input} for a scene without a known node.
[[nodiscard]] ReplicaPlate make_replica(const scene::Scene& scene, const ReplicaOptions& options,
                                        ReplicaReport& report);

/// Writes plate and report's map: FILE.stl (binary) or FILE.3mf, and beside it FILE with .legibility.png. Atomic;
/// millimetres. Closed: each edge belongs to two triangles.
ReplicaReport export_replica(const scene::Scene& scene, const std::filesystem::path& file,
                             const ReplicaOptions& options, Progress& progress);
/// Throws Error{usage} when a print would be shorter than 20 mm or longer than 2 m.
void check_replica_size(double longest_mm);
/// The picture beside a replica.
[[nodiscard]] std::filesystem::path legibility_file_of(const std::filesystem::path& file);
/// Whether a name's ending is a replica's.
[[nodiscard]] bool is_replica(const std::filesystem::path& file);

}  // namespace sparsha::pipeline

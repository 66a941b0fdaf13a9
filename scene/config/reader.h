// What the readers of configuration blocks share; for the files of scene/config/ alone.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "base/yaml/yaml.h"
#include "scene/config/audio.h"
#include "scene/config/cues.h"
#include "scene/config/filters.h"
#include "scene/config/guide.h"
#include "scene/config/unroll.h"

namespace sparsha::scene {

struct Config;

constexpr double kAny = 1e12;        // widest coordinate that is accepted, metres
constexpr double kSmallest = 1e-12;  // smallest length that is accepted, in the key's unit

/// Reads a length in millimetres, when the key is present, into metres.
void read_mm(yaml::MapReader& reader, std::string_view key, double& value_m, double low_mm, double high_mm);

/// Reads a name of the table of materials, when the key is present.
void read_material(yaml::MapReader& reader, std::string_view key, Material& material);

/// Reads a number, when the key is present.
void read_number(yaml::MapReader& reader, std::string_view key, std::optional<double>& value, double low, double high);

/// xmin ymin xmax ymax of a box that is not empty.
[[nodiscard]] std::array<double, 4> read_box(const yaml::Node& node);
/// [xmin, ymin, zmin, xmax, ymax, zmax] in the frame of the scans where `node` has six numbers; else nothing.
[[nodiscard]] std::optional<std::array<double, 6>> read_solid_box(const yaml::Node& node);

/// Corners of a polygon that has an area (scene/area/polygon.h).
[[nodiscard]] std::vector<std::array<double, 2>> read_polygon(const yaml::Node& node);

/// A pixel value of the label image.
[[nodiscard]] int read_label(const yaml::Node& node);

/// A file name, relative to `folder`.
[[nodiscard]] std::filesystem::path resolved(const yaml::Node& node, const std::filesystem::path& folder);

[[nodiscard]] Eigen::Vector3d vector(const yaml::Node& node);

/// At most one of the keys may be present; the index of it, or -1.
int exclusive(yaml::MapReader& reader, const std::vector<std::string>& keys);

/// The block `filters`.
[[nodiscard]] std::vector<FilterConfig> parse_filters(const yaml::Node& node);

/// The block `unroll`. `before`: the blocks `orientation`, `grid` and `around`, some of which mean something else, or
/// nothing, on an unrolled mantle.
[[nodiscard]] UnrollConfig parse_unroll(const yaml::Node& node, const Config& before);
[[nodiscard]] std::string unroll_text(const UnrollConfig& unroll);

/// The block `audio`.
[[nodiscard]] AudioConfig parse_audio(const yaml::Node& node, const std::filesystem::path& folder);

/// The block `guide`.
[[nodiscard]] GuideConfig parse_guide(const yaml::Node& node);

/// The block `cues`; empty where it says off.
[[nodiscard]] std::optional<CuesConfig> parse_cues(const yaml::Node& node);

}  // namespace sparsha::scene

// The configuration as plain values, one struct a block of the YAML file (docs/configuration.md).
// An absent optional block is an empty std::optional and costs nothing.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "base/yaml.h"
#include "scene/cues_config.h"
#include "scene/haptics_config.h"

namespace sparsha::pipeline {

/// Unit of a scan's coordinates. `automatic`: the format's own, else metres with a warning when implausible.
enum class LengthUnit { automatic, m, cm, mm, ft, us_ft, longest_side };

/// "m", "cm", "mm", "ft", "us_ft", as configurations have it; "unknown" for automatic, else "longest_side_mm".
[[nodiscard]] std::string to_string(LengthUnit unit);

struct Units {
  LengthUnit unit = LengthUnit::automatic;
  double longest_side_m = 0.0;  ///< with LengthUnit::longest_side
};

/// One file and where its scanner stood: scan = pose * units * (pose stored in the file) * p.
struct ScanConfig {
  std::filesystem::path file;  ///< absolute, or relative to the current folder
  Units units;
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();  ///< rigid, metres
  /// Of a text file whose columns have no names, one word a column: a field's name ("x", "red") or "skip"; empty: the
  /// reader's own guess.
  std::vector<std::string> columns{};
};

struct CropConfig {
  Eigen::Vector3d min_m;  ///< scan frame, after poses
  Eigen::Vector3d max_m;
};
struct VoxelConfig {
  double leaf_m = 0.0005;
};
struct OutlierConfig {
  enum class Method { fast, pcl };
  int neighbours = 8;
  double sigma = 2.0;
  Method method = Method::fast;
};
/// Keeps points that have at least `neighbours` others within the radius; the others are outliers.
struct RadiusOutlierConfig {
  enum class Method { fast, pcl };
  double radius_m = 0.005;
  int neighbours = 4;
  Method method = Method::fast;
};
/// Keeps points from `min_m` to `max_m` along an axis of the scan frame, borders included.
struct PassConfig {
  int axis = 2;  ///< 0 x, 1 y, 2 z
  double min_m = -std::numeric_limits<double>::infinity();
  double max_m = std::numeric_limits<double>::infinity();
};
/// Takes away the largest plane whose normal lies within `max_angle_deg` of `normal`, and what lies beyond it.
struct RemovePlaneConfig {
  enum class Side { below, above, both };  ///< both: the plane alone
  double distance_m = 0.005;
  Side side = Side::below;
  Eigen::Vector3d normal{0, 0, 1};  ///< scan frame, any length but 0; from below to above
  double max_angle_deg = 15.0;
};
/// Keeps one group of points, each within `tolerance_m` of another of the group.
struct KeepConfig {
  enum class Method { fast, pcl };
  std::optional<Eigen::Vector3d> nearest_to_m;  ///< scan frame; absent: the largest
  double tolerance_m = 0.01;
  Method method = Method::fast;
};
/// Moves points to the polynomial that fits their neighbours within the radius (moving least squares).
struct SmoothConfig {
  enum class Method { fast, pcl };
  double radius_m = 0.003;
  int order = 2;  ///< 1: a plane
  Method method = Method::fast;
};
/// Leaves at most so many points in every cube with the grid's spacing as its side.
struct ThinConfig {
  int points_per_node = 4;
};
/// Keeps points of which the file says a value from `min` to `max`, borders included.
struct FieldConfig {
  std::string name;  ///< as `info` lists it: "confidence", "opacity", "quality", "intensity"
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
/// Keeps points by their class, 0 to 255: the listed ones, or all but the listed ones. One of the lists is empty.
struct ClassesConfig {
  std::vector<int> keep;
  std::vector<int> drop;
};
/// One entry of `filters`.
struct FilterConfig
    : std::variant<CropConfig, VoxelConfig, OutlierConfig, RadiusOutlierConfig, PassConfig, RemovePlaneConfig,
                   KeepConfig, SmoothConfig, ThinConfig, FieldConfig, ClassesConfig> {
  using variant::variant;
  Place place;  ///< of its key in the configuration, for errors that the data show; empty when it was not read
};
/// The filter's key in a configuration, e.g. "remove_plane".
[[nodiscard]] std::string filter_name(const FilterConfig& filter);

/// How `sparsha register` finds the poses of the scans; a build measures with it and moves nothing.
struct RegisterConfig {
  enum class Method { gicp, point_to_plane, icp };
  enum class Guess { poses, features };
  Method method = Method::gicp;
  Guess guess = Guess::poses;   ///< where alignment begins: the poses as given, or features of the scans alone
  double max_distance_m = 0.0;  ///< how far rough poses may put one place apart; 0 = 15 % of the longest side
  double voxel_m = 0.0;         ///< of the thinned points that are compared; 0 = at most 40 000 points a scan
  double min_overlap = 0.1;     ///< least share of a scan's points that a pair must have in common
};

/// How the object is looked at; `scan_to_grid` is what counts, an invertible affine about the scan frame's origin.
struct OrientationConfig {
  enum class Face { automatic, plane, principal };
  /// Looked for in the points when the scene is built; then scan_to_grid holds what was found, and this is absent.
  std::optional<Face> face;
  std::optional<Eigen::Vector3d> face_up;  ///< scan frame; absent = the format's own
  double face_scale = 1.0;
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();
  /// Where parts and sounds are written in the grid frame of another orientation: `regions_matrix`.
  std::optional<Eigen::Matrix4d> regions_scan_to_grid;
};
/// Rotation whose +z looks at the viewer who stands in direction `look_from`, +y up. Throws Error{usage} when parallel.
[[nodiscard]] Eigen::Matrix4d look_from(const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double scale);

struct GridConfig {
  int size = 0;                                   ///< nodes along the longer side; 0 = not given
  double spacing_m = 0.0;                         ///< 0 = not given; neither given = automatic
  std::optional<std::array<double, 4>> bounds_m;  ///< xmin ymin xmax ymax, grid frame
  std::optional<double> noise_m;                  ///< of the points across the surface; absent = estimated
  bool colour = false;                            ///< keep a colour layer when the scans have colour
  bool intensity = false;                         ///< keep an intensity layer when the scans have intensity
};
struct FillConfig {
  double max_gap_m = 0.005;
};
struct TextureConfig {
  enum class Method { direct, opencv };
  double sigma_space_m = 0.002;
  double sigma_range_m = 0.0005;
  Method method = Method::direct;
};
struct FrictionConfig {
  enum class Law { curvature, paper, constant };
  Law law = Law::curvature;
  double mu_static = 0.4;
  double mu_0 = 0.2;
  double mu_max = 0.9;
  double scale_m = 0.0;       ///< 0 = max(3 spacings, sigma_space)
  std::optional<double> c_m;  ///< slope of law: curvature, metres (mu per 1/m); absent = from the 95th percentile
};
struct LevelsConfig {
  int window = 200;  ///< nodes per side of the haptic window
};
struct CheckConfig {
  std::int64_t samples = 50000;  ///< 0 = all
};
/// How a part is touched where it differs from the rest of the scene.
struct PartTouch {
  std::optional<double> stiffness_n_per_m;
  std::optional<double> mu_dynamic;
  std::optional<double> mu_static;  ///< without it the larger of mu_dynamic and the scene's mu_static
  std::optional<Material> material;
};
/// It lies in the box, or, where one of these is there, in the polygon or where the label image has the label.
struct PartConfig {
  std::string name;
  std::string say;
  std::array<double, 4> box_m{};  ///< xmin ymin xmax ymax, grid frame; zeros with a polygon or a label
  PartTouch touch{};
  std::string more{};                              ///< told when more is asked for
  std::vector<std::array<double, 2>> polygon_m{};  ///< corners, grid frame; empty: none
  std::optional<int> label{};                      ///< of the label image, AudioConfig::labels
  [[nodiscard]] bool is_box() const { return polygon_m.empty() && !label; }
};
/// Along what, how strongly and how fast a hand is led that asks for it.
struct GuideConfig {
  enum class Path { outline, part, drawn };
  static constexpr std::array<const char*, 3> kPathNames{"outline", "part", "drawn"};
  Path path = Path::outline;                  ///< what is found in the heights; a part's border; `line_m`
  double force_n = 1.0;                       ///< the guide is never stronger
  double speed_m_per_s = 0.04;                ///< at the hand
  std::vector<std::array<double, 2>> line_m;  ///< grid frame; closed where it ends in its first point
};
/// What is announced is spoken.
struct SpeechConfig {
  std::string language = "en";  ///< of configs/speech
  std::string voice;            ///< espeak's name; empty: the language's own
  int words_per_minute = 170;
};
/// One decaying partial of a note.
struct ModeConfig {
  double frequency_hz = 0.0;
  double decay_s = 0.0;   ///< to fall by 60 dB
  double level_db = 0.0;  ///< relative to the others
};
/// A pillar's note, or, as `sparsha sound fit` gives them, the modes of a recorded strike.
struct ModalConfig {
  double frequency_hz = 240.0;
  double decay_s = 1.2;
  std::vector<ModeConfig> modes;  ///< when not empty, these and not the bar's
};
/// The sound of a material; what is absent is the table's (scene/materials.h).
struct MaterialSoundConfig {
  Material material = Material::granite;
  std::optional<double> frequency_hz;
  std::optional<double> damping;
  std::optional<double> brightness;
};
struct AudioRegionConfig {
  enum class Loop { none, one_period };
  std::string name;
  std::optional<std::array<double, 4>> box_m;  ///< grid frame
  std::optional<int> label;                    ///< of the label image
  std::variant<ModalConfig, std::filesystem::path, MaterialSoundConfig> sound;
  std::vector<std::array<double, 2>> polygon_m{};  ///< corners, grid frame; empty: none
  Loop loop = Loop::none;                          ///< of a clip: one period of it, repeated while it decays
  [[nodiscard]] bool has_place() const { return box_m || label || !polygon_m.empty(); }
};
/// A picture of whole numbers that lies over the grid: pixels of value n belong to the regions and parts with
/// `label: n`.
struct LabelImageConfig {
  std::filesystem::path file;                     ///< PNG, grey or palette; the top row is the largest y
  std::optional<std::array<double, 4>> bounds_m;  ///< that it covers, grid frame; absent: the whole grid
};
struct AudioConfig {
  std::vector<AudioRegionConfig> regions;
  std::optional<double> friction_sound_gain;
  bool friction_sound_grain = true;             ///< what lies between the nodes is heard as the grain continues it
  std::optional<MaterialSoundConfig> material;  ///< of every place without a region; absent: these are mute
  std::optional<LabelImageConfig> labels;
  bool find_pillars = false;  ///< regions without a place lie on the pillars that are found when the scene is built
};
struct ViewerConfig {
  enum class Colour {
    relief,
    height,
    scan,
    friction,
    texture,
    slope,
    curvature,
    coverage,
    local_relief,
    sky_view,
    error
  };
  static constexpr std::array<const char*, 11> kColourNames{"relief",       "height",   "scan",      "friction",
                                                            "texture",      "slope",    "curvature", "coverage",
                                                            "local_relief", "sky_view", "error"};
  enum class Stereo { off, anaglyph, grey, side_by_side };
  static constexpr std::array<const char*, 4> kStereoNames{"off", "anaglyph", "grey", "side_by_side"};
  enum class Side { right, left };
  static constexpr std::array<const char*, 2> kSideNames{"right", "left"};
  Colour colour = Colour::relief;
  Stereo stereo = Stereo::off;
  Side overview = Side::right;  ///< where the overview lies, beside the selected region
};

struct Config {
  std::vector<ScanConfig> scans;
  std::vector<FilterConfig> filters;
  std::optional<RegisterConfig> registration;  ///< the block `register`
  OrientationConfig orientation;
  GridConfig grid;
  std::optional<FillConfig> fill;
  std::optional<TextureConfig> texture;
  std::optional<FrictionConfig> friction;
  LevelsConfig levels;
  std::optional<CheckConfig> check;
  HapticsConfig haptics;
  std::vector<PartConfig> parts;
  std::optional<AudioConfig> audio;
  std::optional<SpeechConfig> speech;
  std::optional<GuideConfig> guide;
  std::optional<CuesConfig> cues;
  ViewerConfig viewer;
};

/// Reads a configuration; paths become relative to `folder` (the file's own). Throws Error{usage} with line, column and
/// the nearest valid key. Contradictions (size and spacing_mm, singular matrices, parallel `up`) are errors too.
[[nodiscard]] Config parse_config(const yaml::Node& root, const std::filesystem::path& folder);
/// True for the scene.yaml of a scene: a configuration, and what was made of it.
[[nodiscard]] bool describes_scene(const yaml::Node& root);
/// Of a scene.yaml the configuration alone: the scene can be built again.
[[nodiscard]] Config load_config(const std::filesystem::path& file, const std::vector<std::string>& settings = {});

/// The same configuration as YAML text that parse_config reads back to equal values.
[[nodiscard]] std::string to_yaml(const Config& config);

}  // namespace sparsha::pipeline

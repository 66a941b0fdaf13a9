// The configuration: defaults, units, poses, orientation, contradictions, and the way back to YAML.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>

#include "base/yaml/yaml.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace {

using ::testing::HasSubstr;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

Config parse(const std::string& text) { return parse_config(yaml::parse_text(text, "c.yaml"), "folder"); }

std::string message_of(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

const std::string kScan = "scans: [{file: a.ply}]\n";

TEST(Config, NeedsOnlyScansAndLeavesOptionalBlocksOut) {
  const Config config = parse(kScan);
  EXPECT_EQ(config.scans[0].file, "folder/a.ply");
  EXPECT_FALSE(config.fill || config.texture || config.friction || config.check || config.audio);
  EXPECT_TRUE(config.orientation.scan_to_grid.isIdentity());
  EXPECT_EQ(config.haptics.stiffness_n_per_m, 800.0);
}

TEST(Config, FillsTheKeysLeftOutOfABlockWithTheDocumentedValues) {
  const Config config = parse(kScan + "fill:\ntexture: {}\nfriction: {}\ncheck: {}\n");
  EXPECT_DOUBLE_EQ(config.fill->max_gap_m, 0.005);
  EXPECT_DOUBLE_EQ(config.texture->sigma_space_m, 0.002);
  EXPECT_DOUBLE_EQ(config.texture->sigma_range_m, 0.0005);
  EXPECT_EQ(config.friction->law, FrictionConfig::Law::curvature);
  EXPECT_EQ(config.friction->mu_max, 0.9);
  EXPECT_EQ(config.check->samples, 50000);
}

TEST(Config, FrictionWithoutTextureUsesTheTexturesDefaults) {
  EXPECT_TRUE(parse(kScan + "friction: {law: constant}\n").texture.has_value());
}

TEST(Config, PosesTurnByQuaternionXyzwThenTranslate) {
  const Config config = parse(
      "scans: [{file: a.ply, pose: {translate: [1, 2, 3], quaternion: [0, 0, 0.70710678118654752, "
      "0.70710678118654752]}}]");
  const Eigen::Vector4d moved = config.scans[0].pose * Eigen::Vector4d(1, 0, 0, 1);  // +90 degrees about z: x to y
  EXPECT_NEAR((moved - Eigen::Vector4d(1, 3, 3, 1)).norm(), 0.0, 8 * kEpsilon);
}

TEST(Config, EulerAnglesTurnAboutFixedAxesXFirst) {
  const Config config = parse("scans: [{file: a.ply, pose: {euler_deg: [90, 0, 90]}}]");
  // x first: y to z; then about fixed z: z stays.
  const Eigen::Vector4d moved = config.scans[0].pose * Eigen::Vector4d(0, 1, 0, 1);
  EXPECT_NEAR((moved - Eigen::Vector4d(0, 0, 1, 1)).norm(), 0.0, 8 * kEpsilon);
}

TEST(Config, LookingFromADirectionPutsItOnZAndUpOnY) {
  const Config config = parse(kScan + "orientation: {look_from: [1, 0, 0], up: [0, 0, 1], scale: 2}\n");
  const Eigen::Matrix3d m = config.orientation.scan_to_grid.topLeftCorner<3, 3>();
  EXPECT_NEAR((m * Eigen::Vector3d::UnitX() - 2 * Eigen::Vector3d::UnitZ()).norm(), 0.0, 8 * kEpsilon);
  EXPECT_NEAR((m * Eigen::Vector3d::UnitZ() - 2 * Eigen::Vector3d::UnitY()).norm(), 0.0, 8 * kEpsilon);
  EXPECT_NEAR(m.determinant(), 8.0, 64 * kEpsilon);  // right-handed
}

struct Refusal {
  const char* name;
  std::string text;
  std::vector<const char*> says;
};

TEST(Config, RefusesWhatIsUnknownContradictoryOrImpossibleAtItsPlace) {
  const std::vector<Refusal> cases = {
      {"no scans", "grid: {}\n", {"has no 'scans'"}},
      {"empty scans", "scans: []\n", {"c.yaml:1:8", "scans is empty"}},
      {"near a key of a block",
       kScan + "stiffness: 500\n",
       {"has no key 'stiffness'; did you mean 'haptics.stiffness_n_per_m'?"}},
      {"large letters", kScan + "HAPTICS: {surface: c1}\n", {"has no key 'HAPTICS'; did you mean 'haptics'?"}},
      {"no block", kScan + "surface: c1\n", {"has no key 'surface'; did you mean 'haptics.surface'?"}},
      {"no block, near another key", kScan + "size: 800\n", {"did you mean 'grid.size'?"}},
      {"misspelt scans", "scan: [{file: a.ply}]\n", {"has no key 'scan'; did you mean 'scans'?"}},
      {"unknown key", kScan + "grid: {sizes: 3}\n", {"c.yaml:2:8", "grid has no key 'sizes'", "'size'"}},
      {"unknown unit", "scans: [{file: a.ply, units: inches}]\n", {"c.yaml:1:30", "units is 'inches'", "m | cm | mm"}},
      {"degrees", "scans: [{file: a.ply, units: degrees}]\n", {"units is 'degrees'"}},
      {"size and spacing", kScan + "grid: {size: 3, spacing_mm: 1}\n", {"'size' and 'spacing_mm' contradict"}},
      {"parallel up", kScan + "orientation: {look_from: [0, 1, 0], up: [0, 2, 0]}\n", {"up is parallel to look_from"}},
      {"default up", kScan + "orientation: {look_from: [0, 1, 0]}\n", {"up is parallel to look_from"}},
      {"singular", kScan + "orientation: {matrix: [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]}\n", {"the matrix is singular"}},
      {"not affine", kScan + "orientation: {matrix: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}\n", {"the last row"}},
      {"not rigid", "scans: [{file: a, pose: {matrix: [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]\n", {"not rigid"}},
      {"quaternion", "scans: [{file: a, pose: {quaternion: [0, 0, 0, 2]}}]\n", {"does not have length 1"}},
      {"columns without x", "scans: [{file: a.txt, columns: [y, z]}]\n", {"c.yaml:1:32", "no column is called x"}},
      {"a column of no kind", "scans: [{file: a.txt, columns: [x, y, zz]}]\n", {"'zz'", "skip | x | y"}},
      {"a column twice", "scans: [{file: a.txt, columns: [x, y, z, x]}]\n", {"two columns are called 'x'"}},
      {"columns of no list", "scans: [{file: a.txt, columns: x}]\n", {"columns is not a list"}},
      {"red alone", "scans: [{file: a.txt, columns: [x, y, z, red]}]\n", {"not all of red, green and blue"}},
      {"half a normal", "scans: [{file: a.txt, columns: [x, y, z, nx, nz]}]\n", {"not all of nx, ny and nz"}},
      {"empty crop", kScan + "filters: [{crop: {min_m: [0,0,0], max_m: [1,0,1]}}]\n", {"the crop box is empty"}},
      {"two filters in one", kScan + "filters: [{crop: {}, voxel: {}}]\n", {"a filter has 2 keys"}},
      {"unknown filter", kScan + "filters: [{voxels: {leaf_mm: 1}}]\n", {"'voxels'", "did you mean 'voxel'?"}},
      {"negative leaf", kScan + "filters: [{voxel: {leaf_mm: -1}}]\n", {"leaf_mm is -1"}},
      {"axis", kScan + "filters: [{pass: {axis: w, min_m: 0}}]\n", {"axis is 'w'"}},
      {"pass without limits", kScan + "filters: [{pass: {axis: z}}]\n", {"c.yaml:2:18", "pass has no limit"}},
      {"empty pass", kScan + "filters: [{pass: {axis: z, min_m: 2, max_m: 1}}]\n", {"pass keeps nothing"}},
      {"no pass", kScan + "filters: [{pass: }]\n", {"pass"}},
      {"side", kScan + "filters: [{remove_plane: {side: beneath}}]\n", {"side is 'beneath'", "below"}},
      {"no normal", kScan + "filters: [{remove_plane: {normal: [0, 0, 0]}}]\n", {"normal has no direction"}},
      {"normal of nan", kScan + "filters: [{remove_plane: {normal: [0, .nan, 1]}}]\n", {"c.yaml:2:"}},
      {"no angle", kScan + "filters: [{remove_plane: {max_angle_deg: 0}}]\n", {"max_angle_deg is 0"}},
      {"no distance", kScan + "filters: [{remove_plane: {distance_mm: 0}}]\n", {"distance_mm is 0"}},
      {"cluster", kScan + "filters: [{keep: {cluster: biggest}}]\n", {"cluster is 'biggest'", "largest"}},
      {"two clusters",
       kScan + "filters: [{keep: {cluster: largest, nearest_to: [0, 0, 0]}}]\n",
       {"'cluster' and 'nearest_to' contradict"}},
      {"order of smooth", kScan + "filters: [{smooth: {order: 9}}]\n", {"order is 9"}},
      {"voxel after smooth", kScan + "filters: [{smooth: }, {voxel: {leaf_mm: 1}}]\n", {"'voxel' after 'smooth'"}},
      {"thin to nothing", kScan + "filters: [{thin: {points_per_node: 0}}]\n", {"points_per_node is 0"}},
      {"neighbours", kScan + "filters: [{radius_outliers: {neighbours: 0}}]\n", {"neighbours is 0"}},
      {"no filter", kScan + "filters: [{}]\n", {"one of crop, voxel, outliers, radius_outliers"}},
      {"size of one", kScan + "grid: {size: 1}\n", {"size is 1"}},
      {"inverted bounds", kScan + "grid: {bounds_m: [1, 0, 0, 1]}\n", {"the box is empty"}},
      {"a slope beyond any", kScan + "friction: {c_m: 1.0e13}\n", {"c_m is beyond 1e12 m"}},
      {"mu_0 above mu_max", kScan + "friction: {mu_0: 2}\n", {"mu_0 is above mu_max"}},
      {"law", kScan + "friction: {law: papers}\n", {"law is 'papers'", "did you mean 'paper'?"}},
      {"material", kScan + "haptics: {material: granit}\n", {"material is 'granit'", "did you mean 'granite'?"}},
      {"impact", kScan + "haptics: {impact: granite}\n", {"neither true nor false"}},
      {"part's friction alone",
       kScan + "parts: [{name: a, box_m: [0,0,1,1], mu_dynamic: 0.3}]\n",
       {"a part has friction and the scene has none", "the block 'friction'"}},
      {"part's static friction alone",
       kScan + "friction: {}\nparts: [{name: a, box_m: [0,0,1,1], mu_static: 0.3}]\n",
       {"mu_static without mu_dynamic"}},
      {"part's friction upside down",
       kScan + "friction: {}\nparts: [{name: a, box_m: [0,0,1,1], mu_static: 0.3, mu_dynamic: 0.4}]\n",
       {"mu_static is below mu_dynamic"}},
      {"part's stiffness",
       kScan + "parts: [{name: a, box_m: [0,0,1,1], stiffness_n_per_m: -1}]\n",
       {"stiffness_n_per_m"}},
      {"part's more", kScan + "parts: [{name: a, box_m: [0,0,1,1], mor: b}]\n", {"did you mean 'more'?"}},
      {"speech", kScan + "speech: loud\n", {"neither true nor false"}},
      {"speech's language", kScan + "speech: {language: xx}\n", {"the language 'xx'", "en or hi"}},
      {"speech's rate", kScan + "speech: {words_per_minute: 5}\n", {"words_per_minute is 5"}},
      {"speech's key", kScan + "speech: {langage: en}\n", {"did you mean 'language'?"}},
      {"region without place",
       kScan + "audio: {regions: [{name: x, modal: {}}]}\n",
       {"region 'x' has no place", "find: pillars"}},
      {"loop of a note",
       kScan + "audio: {regions: [{name: x, box_m: [0,0,1,1], modal: {}, loop: one_period}]}\n",
       {"'loop' belongs to 'clip'"}},
      {"polygon of two corners",
       kScan + "audio: {regions: [{name: x, polygon_m: [[0,0],[1,1]], modal: {}}]}\n",
       {"fewer than three corners"}},
      {"polygon without area",
       kScan + "audio: {regions: [{name: x, polygon_m: [[0,0],[1,1],[2,2]], modal: {}}]}\n",
       {"the polygon has no area"}},
      {"modes and a note",
       kScan + "audio: {regions: [{name: x, box_m: [0,0,1,1], modal: {frequency_hz: 200, modes: []}}]}\n",
       {"'modes' and other keys"}},
      {"no modes",
       kScan + "audio: {regions: [{name: x, box_m: [0,0,1,1], modal: {modes: []}}]}\n",
       {"modes is not a list of 1 to 32 modes"}},
      {"sound of no material", kScan + "audio: {material: stone}\n", {"material is 'stone'", "granite"}},
      {"damping", kScan + "audio: {material: {name: wood, damping: 2}}\n", {"damping"}},
      {"what is found", kScan + "audio: {find: pilars}\n", {"find is 'pilars'", "did you mean 'pillars'?"}},
      {"region without sound", kScan + "audio: {regions: [{name: x, box_m: [0,0,1,1]}]}\n", {"has no sound"}},
      {"region with two",
       kScan + "audio: {regions: [{name: x, label: 1, box_m: [0,0,1,1], clip: a}]}\n",
       {"'box_m' and 'label' contradict"}},
      {"an unknown path", kScan + "guide: {path: contour}\n", {"path is 'contour'", "outline | part | drawn"}},
      {"drawn without a line", kScan + "guide: {path: drawn}\n", {"c.yaml:2:8", "path: drawn without a line"}},
      {"a line of no length", kScan + "guide: {path: drawn, line_m: [[1, 2], [1, 2]]}\n", {"the line has no length"}},
      {"a line in space of one view",
       kScan + "guide: {path: drawn, line_m: [[1, 2, 3], [1, 3, 3]]}\n",
       {"needs the whole object"}},
      {"a line of points of two kinds",
       kScan + "around: {}\nguide: {path: drawn, line_m: [[1, 2, 3], [1, 3]]}\n",
       {"3"}},
      {"a line in space of no length",
       kScan + "around: {}\nguide: {path: drawn, line_m: [[1, 2, 3], [1, 2, 3]]}\n",
       {"the line has no length"}},
      {"a line that is not drawn", kScan + "guide: {line_m: [[1, 2], [1, 3]]}\n", {"belongs to 'path: drawn'"}},
      {"a guide too strong", kScan + "guide: {force_n: 40}\n", {"force_n"}},
      {"a guide too fast", kScan + "guide: {speed_mm_per_s: 2000}\n", {"speed_mm_per_s"}},
      {"an unknown cue", kScan + "cues: {rim: off}\n", {"cues has no key 'rim'"}},
      {"an unknown kind of cue", kScan + "cues: {edge: loud}\n", {"edge is 'loud'", "both | sound | tick | off"}},
      {"cues that are neither", kScan + "cues: maybe\n", {"neither true nor false"}},
      {"box in space of one view",
       kScan + "parts: [{name: a, box_m: [0, 0, 0, 1, 1, 1]}]\n",
       {"c.yaml:2:26", "a box of six numbers needs the whole object", "around: {}"}},
      {"box in space that sounds of one view",
       kScan + "audio: {regions: [{name: a, box_m: [0, 0, 0, 1, 1, 1], material: marble}]}\n",
       {"a box of six numbers needs the whole object"}},
      {"empty box in space",
       kScan + "around: {}\nparts: [{name: a, box_m: [0, 0, 1, 1, 1, 1]}]\n",
       {"c.yaml:3:26", "the box is empty", "zmin"}},
      {"box of five numbers", kScan + "around: {}\nparts: [{name: a, box_m: [0, 0, 1, 1, 1]}]\n", {"c.yaml:3:26"}},
      {"not a map", "[1, 2]\n", {"the configuration is a list"}},
      {"nothing", "", {"the configuration is nothing"}},
  };
  for (const Refusal& refusal : cases) {
    const std::string message = message_of(refusal.text);
    for (const char* part : refusal.says) EXPECT_THAT(message, HasSubstr(part)) << refusal.name;
  }
}

TEST(Config, BoxesInSpaceOfWholeObjectsAreReadBackAsTheyWereWritten) {
  const Config config = parse(kScan +
                              "around: {}\nparts: [{name: knot, box_m: [-1, -2.5, 0.125, 1, 2, 3]}]\n"
                              "audio: {regions: [{name: bell, box_m: [0, 1, 2, 3, 4, 5], material: bronze}]}\n");
  ASSERT_TRUE(config.parts.at(0).solid_m);
  EXPECT_FALSE(config.parts[0].is_box());
  EXPECT_EQ(*config.parts[0].solid_m, (std::array<double, 6>{-1, -2.5, 0.125, 1, 2, 3}));
  const Config again = parse(to_yaml(config));
  EXPECT_EQ(again.parts.at(0).solid_m, config.parts[0].solid_m);
  EXPECT_EQ(again.audio->regions.at(0).solid_m, (std::array<double, 6>{0, 1, 2, 3, 4, 5}));
}

TEST(Config, ALineInSpaceIsWrittenAsItWasRead) {
  const std::string text =
      "scans: [{file: a.ply}]\naround: {}\nguide: {path: drawn, line_m: [[0, 0.5, -1], [1.25, 0, 1e-3], [0, 0.5, "
      "-1]]}\n";
  const Config config = parse_config(yaml::parse_text(text, "c.yaml"), {});
  const Config again = parse_config(yaml::parse_text(to_yaml(config), "again"), {});
  ASSERT_TRUE(again.guide);
  EXPECT_TRUE(again.guide->line_m.empty());
  const std::vector<std::array<double, 3>> line{{0.0, 0.5, -1.0}, {1.25, 0.0, 0.001}, {0.0, 0.5, -1.0}};
  EXPECT_EQ(again.guide->line_in_space_m, line);
}

TEST(Config, ReadsBackWhatItWrites) {
  const std::string text = R"(
scans:
  - {file: "a b\"c.ply", units: mm, pose: {translate: [1, 2, 3], euler_deg: [10, 20, 30]}}
  - {file: b.ply, units: {longest_side_mm: 300}}
  - {file: c.txt, columns: [skip, x, y, z, skip, red, green, blue, intensity, nx, ny, nz]}
filters: [{crop: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}}, {voxel: {leaf_mm: 0.3}}, {outliers: {neighbours: 9, sigma: 1.5, method: pcl}},
  {radius_outliers: {radius_mm: 1.3, neighbours: 7, method: pcl}}, {pass: {axis: y, max_m: 0.1}},
  {remove_plane: {distance_mm: 0.7, side: both, normal: [1, 2, 3], max_angle_deg: 12.5}},
  {keep: {cluster: {nearest_to: [1, 2.5, 3]}, tolerance_mm: 1.1}}, {keep: {cluster: largest, method: pcl}},
  {smooth: {radius_mm: 2.3, order: 3}}, {thin: {points_per_node: 6}}]
register: {method: point_to_plane, guess: features, max_distance_mm: 7.5, voxel_mm: 0.3, min_overlap: 0.25}
orientation: {look_from: [1, 2, 3], up: [0, 0, 1], scale: 1.5}
grid: {spacing_mm: 0.7, bounds_m: [0, 0, 1, 1], colour: true}
fill: {max_gap_mm: 0.1}
texture: {sigma_space_mm: 0.3, sigma_range_mm: 0.07}
friction: {law: paper, scale_mm: 1.1, c_m: 0.02}
levels: {window: 100}
check: {samples: all}
haptics: {stiffness_n_per_m: 700, solver: paper, surface: c1, creases: sharp, beyond: rim, rate_hz: 2000, resolution_mm: 0.03, tip_radius_mm: 0.3, impact: on,
  grain: on, material: bronze}
speech: {language: hi, voice: "hi+f3", words_per_minute: 210}
parts: [{name: a, say: "A, b: c", more: "All \"about\" it: {x}", box_m: [0, 0, 1, 1]},
  {name: b, box_m: [0, 0, 1, 1], stiffness_n_per_m: 350.5, mu_dynamic: 0.3, mu_static: 0.45, material: marble}]
audio:
  find: pillars
  regions: [{name: sa, box_m: [0, 0, 1, 1], modal: {frequency_hz: 240.5, decay_s: 0.7}}, {name: re, label: 2, clip: re.wav},
    {name: ga, polygon_m: [[0, 0], [1, 0], [0.5, 1.25]], clip: ga.ogg, loop: one_period}, {name: ma, material: wood},
    {name: pa, box_m: [0, 0, 1, 1], material: {name: marble, frequency_hz: 500.5, damping: 0.01, brightness: 0.5}},
    {name: dha, label: 7, modal: {modes: [{frequency_hz: 200.25, decay_s: 1.5}, {frequency_hz: 511, decay_s: 0.5, level_db: -6.5}]}}]
  labels: {file: labels.png, bounds_m: [0, 0, 2, 1]}
  material: {name: bronze, damping: 0.002}
  friction_sound: {gain: 0.25, grain: off}
guide: {path: drawn, force_n: 0.75, speed_mm_per_s: 35, line_m: [[0, 0], [0.5, 1.25]]}
cues: {level: off, edge: sound, part_left: tick, lost: off}
viewer: {colour: friction, stereo: anaglyph}
)";
  const Config config = parse_config(yaml::parse_text(text, "c.yaml"), {});
  const std::string written = to_yaml(config);
  const Config again = parse_config(yaml::parse_text(written, "again"), {});
  EXPECT_EQ(to_yaml(again), written);
  ASSERT_TRUE(again.guide && again.cues);
  EXPECT_EQ(again.guide->path, GuideConfig::Path::drawn);
  EXPECT_EQ(again.guide->force_n, 0.75);
  EXPECT_EQ(again.guide->speed_m_per_s, 0.035);
  EXPECT_EQ(again.guide->line_m, config.guide->line_m);
  EXPECT_EQ(again.guide->line_m.size(), 2U);
  EXPECT_EQ(again.cues->sound, (std::array<bool, kCues>{false, true, true, true, false}));
  EXPECT_EQ(again.cues->tick, (std::array<bool, kCues>{false, false, true, true, true}));
  EXPECT_FALSE(again.cues->lost);
  ASSERT_EQ(again.filters.size(), 10U);
  EXPECT_EQ(std::get<PassConfig>(again.filters[4]).max_m, 0.1);
  EXPECT_TRUE(std::isinf(std::get<PassConfig>(again.filters[4]).min_m));
  EXPECT_EQ(std::get<RemovePlaneConfig>(again.filters[5]).normal, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<RemovePlaneConfig>(again.filters[5]).distance_m,
            std::get<RemovePlaneConfig>(config.filters[5]).distance_m);
  EXPECT_EQ(std::get<KeepConfig>(again.filters[6]).nearest_to_m, Eigen::Vector3d(1, 2.5, 3));
  EXPECT_FALSE(std::get<KeepConfig>(again.filters[7]).nearest_to_m.has_value());
  EXPECT_EQ(std::get<SmoothConfig>(again.filters[8]).order, 3);
  EXPECT_EQ(again.scans[0].file, "a b\"c.ply");
  EXPECT_EQ(again.scans[0].pose, config.scans[0].pose);
  EXPECT_EQ(again.scans[1].units.longest_side_m, config.scans[1].units.longest_side_m);
  ASSERT_TRUE(again.registration);
  EXPECT_EQ(again.registration->method, RegisterConfig::Method::point_to_plane);
  EXPECT_EQ(again.registration->guess, RegisterConfig::Guess::features);
  EXPECT_EQ(again.registration->max_distance_m, config.registration->max_distance_m);
  EXPECT_EQ(again.registration->voxel_m, config.registration->voxel_m);
  EXPECT_EQ(again.registration->min_overlap, 0.25);
  EXPECT_EQ(again.orientation.scan_to_grid, config.orientation.scan_to_grid);
  EXPECT_EQ(again.grid.spacing_m, config.grid.spacing_m);
  EXPECT_EQ(again.texture->sigma_range_m, config.texture->sigma_range_m);
  EXPECT_EQ(again.parts[0].say, "A, b: c");
  EXPECT_EQ(again.parts[0].more, "All \"about\" it: {x}");
  EXPECT_EQ(again.parts[1].more, "");
  EXPECT_EQ(again.speech->language, "hi");
  EXPECT_EQ(again.speech->voice, "hi+f3");
  EXPECT_EQ(again.speech->words_per_minute, 210);
  EXPECT_TRUE(again.haptics.impact);
  EXPECT_TRUE(again.haptics.grain);
  EXPECT_EQ(again.haptics.material, Material::bronze);
  EXPECT_FALSE(again.parts[0].touch.stiffness_n_per_m || again.parts[0].touch.material);
  EXPECT_EQ(again.parts[1].touch.stiffness_n_per_m, 350.5);
  EXPECT_EQ(again.parts[1].touch.mu_dynamic, 0.3);
  EXPECT_EQ(again.parts[1].touch.mu_static, 0.45);
  EXPECT_EQ(again.parts[1].touch.material, Material::marble);
  EXPECT_EQ(again.check->samples, 0);
  const auto& regions = again.audio->regions;
  ASSERT_EQ(regions.size(), 6U);
  EXPECT_EQ(std::get<ModalConfig>(regions[0].sound).frequency_hz, 240.5);
  EXPECT_EQ(regions[2].polygon_m, (std::vector<std::array<double, 2>>{{0, 0}, {1, 0}, {0.5, 1.25}}));
  EXPECT_EQ(regions[2].loop, AudioRegionConfig::Loop::one_period);
  EXPECT_FALSE(regions[3].has_place());
  EXPECT_EQ(std::get<MaterialSoundConfig>(regions[3].sound).material, Material::wood);
  EXPECT_EQ(std::get<MaterialSoundConfig>(regions[4].sound).frequency_hz, 500.5);
  EXPECT_EQ(std::get<MaterialSoundConfig>(regions[4].sound).damping, 0.01);
  EXPECT_EQ(std::get<MaterialSoundConfig>(regions[4].sound).brightness, 0.5);
  ASSERT_EQ(std::get<ModalConfig>(regions[5].sound).modes.size(), 2U);
  EXPECT_EQ(std::get<ModalConfig>(regions[5].sound).modes[1].level_db, -6.5);
  EXPECT_TRUE(again.audio->find_pillars);
  EXPECT_EQ(again.audio->labels->file, "labels.png");
  EXPECT_EQ(again.audio->labels->bounds_m, (std::array<double, 4>{0, 0, 2, 1}));
  EXPECT_EQ(again.audio->material->material, Material::bronze);
  EXPECT_EQ(again.audio->material->damping, 0.002);
  EXPECT_FALSE(again.audio->friction_sound_grain);
}

TEST(Config, WithoutImpactGrainAndMaterialIsWrittenAsItWasBeforeThereWereAny) {
  const std::string written = to_yaml(parse_config(yaml::parse_text(kScan, "c.yaml"), {}));
  for (const char* word : {"impact", "grain", "material"}) EXPECT_EQ(written.find(word), std::string::npos) << word;
}

TEST(Config, CuesAreAllOnOrAllOffOrChosenOneByOne) {
  EXPECT_FALSE(parse(kScan).cues);
  EXPECT_FALSE(parse(kScan + "cues: off\n").cues);
  for (const char* on : {"cues: on\n", "cues: {}\n", "cues:\n"}) {
    const Config config = parse(kScan + on);
    ASSERT_TRUE(config.cues) << on;
    for (std::size_t cue = 0; cue < kCues; ++cue) EXPECT_TRUE(config.cues->sound[cue] && config.cues->tick[cue]) << on;
    EXPECT_TRUE(config.cues->lost) << on;
  }
  for (std::size_t cue = 0; cue < kCues; ++cue) {
    const CuesConfig one = *parse(kScan + "cues: {" + std::string(kCueNames[cue]) + ": off}\n").cues;
    for (std::size_t other = 0; other < kCues; ++other) {
      EXPECT_EQ(one.sound[other], other != cue);
      EXPECT_EQ(one.tick[other], other != cue);
    }
  }
}

}  // namespace
}  // namespace sparsha::scene

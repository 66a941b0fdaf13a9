// `sparsha simulate`: YAML in, files out, each checked by reading it with code of its own.
#include "pipeline/simulate/simulate.h"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include "base/error.h"
#include "pipeline/simulate/statue.h"
#include "scene/config/config.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;
using sparsha::test::TestFolder;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void run(const TestFolder& folder, const std::string& yaml, const std::string& out = "out") {
  std::ofstream(folder / "simulation.yaml") << yaml;
  Progress progress;
  simulate(folder / "simulation.yaml", folder / out, progress);
}

/// What is wrong with this YAML, as the user reads it.
std::string complaint(const std::string& yaml) {
  try {
    (void)parse_simulation(yaml::parse_text(yaml, "s.yaml"));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "";
}

/// x y z of a PLY written by the simulator, whose vertex has `stride` bytes and starts with the coordinates.
template <typename Scalar>
std::vector<Eigen::Vector3d> ply_points(const fs::path& file, std::size_t stride) {
  const std::string bytes = bytes_of(file);
  const std::size_t at = bytes.find("element vertex ");
  const std::size_t count = std::stoul(bytes.substr(at + 15));
  const std::size_t body = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size(), body + count * stride);
  std::vector<Eigen::Vector3d> points(count);
  for (std::size_t k = 0; k < count; ++k) {
    Scalar xyz[3];
    std::memcpy(xyz, &bytes[body + k * stride], sizeof(xyz));
    points[k] = {static_cast<double>(xyz[0]), static_cast<double>(xyz[1]), static_cast<double>(xyz[2])};
  }
  return points;
}

constexpr const char* kTwoStations = R"(
seed: 11
nodes: 101
surface: {form: accuracy, back: {kind: rough, depth_mm: 200, density: 0.1}}
outliers: {fraction: 0.01}
noise_mm: 0.2
placement: {origin_m: [450000, 5412000, 100], look_from: [0, -1, 0], up: [0, 0, 1]}
stations:
  - {position_m: [0.2, 0.9, 1.5], target_m: [0.5, 0.5, 0], step_mrad: 8}
  - {name: second, position_m: [1.2, 0.1, 1.2], target_m: [0.5, 0.5, 0], step_mrad: 8}
)";

TEST(Simulate, WritesTheSamplesInTheRepositoryByteForByte) {
  const fs::path root = fs::path(SPARSHA_SOURCE_DIR);
  const TestFolder folder;
  Progress progress;
  for (const std::string name : {"relief", "statue"}) {
    simulate(root / ("configs/simulate-" + name + ".yaml"), folder / name, progress);
    std::uintmax_t total = 0;
    for (const auto& entry : fs::directory_iterator(root / "data" / name)) {
      EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder / (name + "/" + entry.path().filename().string())))
          << entry.path();
      total += entry.file_size();
    }
    EXPECT_GT(total, 0U);
    EXPECT_LE(total, 3000000U) << name;
  }
}

TEST(Simulate, StatueIsSeenFromAllSidesAndItsPointsLieOnIt) {
  const fs::path root = fs::path(SPARSHA_SOURCE_DIR);
  SimulationConfig config = parse_simulation(yaml::parse_file(root / "configs/simulate-statue.yaml"));
  config.outlier_fraction = 0.0;
  for (StationConfig& station : std::get<ScannerConfig>(config.scan).stations) station.step_rad *= 4.0;
  const SimulatedScan scan = generate(config);
  ASSERT_GT(scan.points_m.size(), 5000U);
  const Truth truth(config);
  std::array<int, 8> octants{};
  for (const Eigen::Vector3d& p : scan.points_m) {
    const Eigen::Vector3d local = truth.scan_to_grid().topLeftCorner<3, 3>() * (p - config.origin_m);
    // Noise along the beam is no farther from the surface than along it; 5 standard deviations, and what pleats add.
    ASSERT_LT(std::abs(statue_distance_m(kStatueWidth_m, kStatueHeight_m, local)), 1.4 * 5.0 * config.noise_m);
    ++octants[(local.x() > 0.5 * kStatueWidth_m ? 1U : 0U) + (local.y() > 0.5 * kStatueHeight_m ? 2U : 0U) +
              (local.z() > 0.0 ? 4U : 0U)];
  }
  for (const int count : octants) EXPECT_GT(count, 300);
}

TEST(Simulate, PosesOfTheWrittenConfigurationPutStationFilesWhereTheScanIs) {
  const TestFolder folder;
  run(folder, std::string(kTwoStations) + "output: {coordinates: double, frame: station}\n");
  const scene::Config config = scene::load_config(folder / "out/sparsha.yaml");
  const SimulationConfig simulation = parse_simulation(yaml::parse_file(folder / "simulation.yaml"));
  const SimulatedScan scan = generate(simulation);
  ASSERT_EQ(config.scans.size(), 2U);
  EXPECT_EQ(config.scans[1].file.filename(), "second.ply");
  std::size_t at = 0;
  for (const scene::ScanConfig& entry : config.scans) {
    for (const Eigen::Vector3d& p : ply_points<double>(entry.file, 24)) {
      const Eigen::Vector3d posed = entry.pose.topLeftCorner<3, 3>() * p + entry.pose.topRightCorner<3, 1>();
      ASSERT_LT((posed - scan.points_m[at++]).norm(), 5e-9);  // a few ulp of 5.4e6 m
      ASSERT_LT(p.norm(), 5.0);                               // about its own scanner
    }
  }
  EXPECT_EQ(at, scan.points_m.size());
}

TEST(Simulate, TheWrittenConfigurationHasTheLatticeOfTheTruth) {
  const TestFolder folder;
  run(folder, std::string(kTwoStations) + "output: {coordinates: double}\n");
  const scene::Config config = scene::load_config(folder / "out/sparsha.yaml");
  const Truth truth(parse_simulation(yaml::parse_file(folder / "simulation.yaml")));
  EXPECT_LT((config.orientation.scan_to_grid - truth.scan_to_grid()).norm(), 1e-15);
  ASSERT_TRUE(config.grid.bounds_m.has_value());
  const auto [xmin, ymin, xmax, ymax] = *config.grid.bounds_m;
  const double spacing = config.grid.spacing_m;
  EXPECT_EQ(static_cast<int>(std::floor((xmax - xmin) / spacing + 1e-9)) + 1, truth.lattice().nx);
  EXPECT_EQ(static_cast<int>(std::floor((ymax - ymin) / spacing + 1e-9)) + 1, truth.lattice().ny);
  EXPECT_EQ(xmin, truth.lattice().x_m(0));
  EXPECT_EQ(ymin, truth.lattice().y_m(0));
}

TEST(Simulate, TruthTiffHoldsTheClosedFormWithItsTopRowFirst) {
  const TestFolder folder;
  run(folder, "nodes: 301\nsurface: {form: accuracy, size_m: [1, 0.6]}\nsampler: {points_per_node: 0.1}\n");
  TIFF* tiff = TIFFOpen((folder / "out/truth.tif").c_str(), "r");
  ASSERT_NE(tiff, nullptr);
  std::uint32_t width = 0, length = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &length);
  EXPECT_EQ(width, 301U);
  EXPECT_EQ(length, 181U);
  SurfaceConfig surface_config;
  surface_config.height_m = 0.6;
  const Surface surface(surface_config);
  std::vector<double> tile(static_cast<std::size_t>(TIFFTileSize(tiff)) / sizeof(double));
  for (const auto& [column, row] : {std::pair<std::uint32_t, std::uint32_t>{0, 0}, {17, 3}, {300, 180}, {290, 20}}) {
    ASSERT_GT(TIFFReadTile(tiff, tile.data(), column, row, 0, 0), 0);
    const double x = column / 300.0;
    const double y = (180.0 - row) / 300.0;
    EXPECT_NEAR(tile[(row % 256) * 256 + column % 256], surface.z(x, y), 1e-12);
  }
  TIFFClose(tiff);
  std::ifstream world(folder / "out/truth.tfw");
  double a = 0, d = 0, b = 0, e = 0, c = 0, f = 0;
  world >> a >> d >> b >> e >> c >> f;
  EXPECT_EQ(a, 1.0 / 300.0);
  EXPECT_EQ(e, -1.0 / 300.0);
  EXPECT_EQ(c, 0.0);
  EXPECT_NEAR(f, 0.6, 1e-15);
}

TEST(Simulate, FloatFilesWithIntensityAndColourHaveTheirFieldsAfterTheCoordinates) {
  const TestFolder folder;
  run(folder,
      "nodes: 64\nsurface: {form: relief}\nsampler: {}\noutput: {intensity: true, colour: true, truth: false}\n");
  const std::vector<Eigen::Vector3d> points = ply_points<float>(folder / "out/scan.ply", 12 + 4 + 3);
  EXPECT_GT(points.size(), 1000U);
  EXPECT_FALSE(fs::exists(folder / "out/truth.tif"));
  const std::string header = bytes_of(folder / "out/scan.ply").substr(0, 400);
  EXPECT_NE(header.find("property float intensity\nproperty uchar red\n"), std::string::npos);
}

TEST(Simulate, AFailureLeavesNoScanBehind) {
  const TestFolder folder;
  EXPECT_THROW(run(folder, "surface: {form: plane}\nstations: [{position_m: [0, 0, -1], target_m: [1, 0, 0]}]\n"),
               Error);
  EXPECT_FALSE(fs::exists(folder / "out/station-1.ply"));
  EXPECT_FALSE(fs::exists(folder / "out/sparsha.yaml"));
}

TEST(SimulationConfig, WrongKeysAndValuesAreNamedWithTheirPlace) {
  EXPECT_NE(complaint("surface: {form: accuracy, stepp_mm: 3}\nsampler: {}\n").find("s.yaml:1:"), std::string::npos);
  EXPECT_NE(complaint("surface: {form: accuracy, stepp_mm: 3}\nsampler: {}\n").find("step_mm"), std::string::npos);
  EXPECT_NE(complaint("surface: {form: moon}\nsampler: {}\n"), "");
  EXPECT_NE(complaint("surface: {form: plane, step_mm: 3}\nsampler: {}\n"), "") << "a plane has no step";
  EXPECT_NE(complaint("surface: {form: plane}\n"), "") << "no way to scan";
  EXPECT_NE(complaint("surface: {form: plane}\nsampler: {}\nstations: []\n"), "");
  EXPECT_NE(complaint("surface: {form: plane}\nsampler: {points_per_node: -1}\n"), "");
  EXPECT_NE(complaint("surface: {form: plane}\nsampler: {}\nplacement: {look_from: [0, 1, 0], up: [0, 2, 0]}\n"), "");
  EXPECT_NE(complaint("surface: {form: relief, inscription: \"a7\"}\nsampler: {}\n"), "");
  EXPECT_NE(complaint("surface: {form: bars, width_mm: 60}\nsampler: {}\n"), "");
  EXPECT_NE(complaint("surface: {form: accuracy, back: {kind: rough, depth_mm: 10}}\nsampler: {}\n"), "");
  EXPECT_NE(complaint("surface: {form: plane}\nsampler: {}\noutput: {frame: station}\n"), "");
  EXPECT_EQ(complaint("surface: {form: plane}\nsampler: {}\n"), "");
}

TEST(SimulationConfig, EveryExampleInTheDocumentationIsAccepted) {
  const std::string page = bytes_of(fs::path(SPARSHA_SOURCE_DIR) / "docs/measure/simulation.md");
  const std::string fence = "```yaml\n";
  int examples = 0;
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, at + 1)) {
    const std::string example = page.substr(at + fence.size(), page.find("```", at + 3) - at - fence.size());
    EXPECT_EQ(complaint(example), "") << example;
    ++examples;
  }
  EXPECT_GE(examples, 5);
}

TEST(Relief, LettersAreCutIntoThePanelAndPetalsStandAboveTheGround) {
  SurfaceConfig config;
  config.width_m = 0.36;
  config.height_m = 0.44;
  config.form = ReliefForm{7, 0.0, "I"};
  const Surface letter(config);
  config.form = ReliefForm{7, 0.0, ""};
  const Surface blank(config);
  EXPECT_LT(letter.z(0.18, 0.066), blank.z(0.18, 0.066) - 0.002) << "the stem of the I in the panel's middle";
  EXPECT_EQ(letter.z(0.10, 0.066), blank.z(0.10, 0.066));
  EXPECT_GT(blank.z(0.18, 0.262), 0.010) << "the pod";
  double low = 1.0, high = -1.0;
  for (double y = 0.0; y <= 0.44; y += 0.001) {
    for (double x = 0.0; x <= 0.36; x += 0.001) {
      low = std::min(low, letter.z(x, y));
      high = std::max(high, letter.z(x, y));
    }
  }
  EXPECT_GE(low, letter.z_range()[0]);
  EXPECT_LE(high, letter.z_range()[1]);
}

}  // namespace
}  // namespace sparsha::pipeline

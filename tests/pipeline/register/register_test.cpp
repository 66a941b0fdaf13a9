// Scans of known surfaces whose true poses are known, brought out of place and registered.
#include "pipeline/register/register.h"

#include <bit>

#include "base/error.h"
#include "base/files/files.h"
#include "scene/config/config.h"
#include "tests/pipeline/register/stations.h"

namespace sparsha::pipeline::testing {
namespace {

namespace fs = std::filesystem;

constexpr double kReliefNoise_m = 0.06e-3;  // data/relief/truth.json

// The three stations of the sample relief with their true poses.
std::vector<scene::ScanConfig> relief() {
  const fs::path file = fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml";
  return scene::load_config(file).scans;
}

// Carving without repeats: no two places of it are alike.
double carved(double x, double y) {
  return 0.02 * std::sin(21.0 * x + 3.0 * y) * std::cos(17.0 * y - 5.0 * x * y) +
         0.012 * std::sin(47.0 * x * y + 31.0 * x) + 0.008 * std::cos(61.0 * y + 13.0 * x * x);
}

/// Random points over a box in x, y of a surface z(x, y), as a text file of the units' numbers.
struct Patch {
  double x0, y0, x1, y1;
  int points = 8000;
  double noise_m = 0.0;
  double outliers = 0.0;  // share
};
scene::ScanConfig scan_of(const ScanFolder& folder, const std::string& name, const Patch& patch, std::uint64_t seed,
                          const std::function<double(double, double)>& surface, double per_metre = 1.0) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  std::string text;
  char line[128];
  for (int i = 0; i < patch.points; ++i) {
    const double x = patch.x0 + (patch.x1 - patch.x0) * uniform();
    const double y = patch.y0 + (patch.y1 - patch.y0) * uniform();
    double sum = -6.0;  // of twelve uniform numbers: nearly Gaussian
    for (int k = 0; k < 12; ++k) sum += uniform();
    double z = surface(x, y) + patch.noise_m * sum;
    if (uniform() < patch.outliers) z += 0.1 * (uniform() - 0.5);
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f\n", x * per_metre, y * per_metre, z * per_metre);
    text += line;
  }
  scene::ScanConfig scan;
  scan.file = folder.write(name, text);
  scan.units.unit = per_metre > 1.0 ? scene::LengthUnit::mm : scene::LengthUnit::m;
  return scan;
}

std::string error_of_registering(const std::vector<scene::ScanConfig>& scans, ErrorKind kind,
                                 const scene::RegisterConfig& config = {}) {
  try {
    (void)registered(scans, config);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  return "no error";
}

TEST(Register, StationsOfTheReliefComeBackToAThirdOfTheNoise) {
  const std::vector<scene::ScanConfig> truth = relief();
  for (const std::uint64_t seed : {1U, 2U}) {
    const Registration found = registered(disturbed(truth, seed, 5.0, 0.010));
    EXPECT_LT(rms_error(truth, found.poses), kReliefNoise_m / 3.0) << "seed " << seed;
  }
}

TEST(Register, TenDegreesAndFivePercentOfTheSizeComeBack) {
  const std::vector<scene::ScanConfig> truth = relief();
  const Registration found = registered(disturbed(truth, 3, 10.0, 0.05 * 0.44));
  EXPECT_LT(rms_error(truth, found.poses), kReliefNoise_m / 3.0);
}

TEST(Register, TheFirstPoseStaysAsItIsGiven) {
  const std::vector<scene::ScanConfig> rough = disturbed(relief(), 4, 3.0, 0.005);
  EXPECT_EQ(registered(rough).poses.front(), rough.front().pose);
}

TEST(Register, TheResultHasTheSameBitsWithAnyNumberOfThreads) {
  const std::vector<scene::ScanConfig> rough = disturbed(relief(), 5, 5.0, 0.010);
  const Registration one = registered(rough, {}, 1);
  for (const unsigned threads : {3U}) {
    const Registration more = registered(rough, {}, threads);
    EXPECT_EQ(one.poses, more.poses) << threads << " threads";
    ASSERT_EQ(one.pairs.size(), more.pairs.size());
    for (std::size_t k = 0; k < one.pairs.size(); ++k) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(one.pairs[k].after.residual_m),
                std::bit_cast<std::uint64_t>(more.pairs[k].after.residual_m));
    }
  }
}

TEST(Register, AGeoreferencedSetIsRegisteredAsWell) {
  std::vector<scene::ScanConfig> truth = relief();
  for (scene::ScanConfig& scan : truth) scan.pose.topRightCorner<3, 1>() += Eigen::Vector3d(5e5, 4e6, 300.0);
  const Registration found = registered(disturbed(truth, 6, 5.0, 0.010));
  EXPECT_LT(rms_error(truth, found.poses), kReliefNoise_m / 3.0);
}

TEST(Register, CoordinatesFarFromZeroAreRegisteredAsWell) {
  const ScanFolder folder;
  const Eigen::Vector3d far(5e5, 4e6, 100.0);
  std::vector<scene::ScanConfig> truth;
  for (const double x : {0.0, 0.15}) {
    const auto name = "far-" + std::to_string(truth.size()) + ".xyz";
    scene::ScanConfig near = scan_of(folder, name, {x, 0.0, x + 0.3, 0.3, 20000}, 7 + truth.size(), carved);
    std::string text;
    char line[128];
    for (const Eigen::Vector3d& p : read_scan(near.file).points) {
      std::snprintf(line, sizeof line, "%.6f %.6f %.6f\n", p.x() + far.x(), p.y() + far.y(), p.z() + far.z());
      text += line;
    }
    near.file = folder.write("geo-" + name, text);
    truth.push_back(near);
  }
  const Registration found = registered(disturbed(truth, 8, 3.0, 0.005));
  EXPECT_LT(rms_error(truth, found.poses), 20e-6);  // a hundredth of the distance between points
}

TEST(Register, OverlapAndResidualAreGivenBeforeAndAfterForEachPair) {
  const std::vector<scene::ScanConfig> rough = disturbed(relief(), 1, 5.0, 0.010);
  const Registration found = registered(rough);
  ASSERT_EQ(found.pairs.size(), 3U);
  for (const PairFit& pair : found.pairs) {
    EXPECT_LT(pair.first, pair.second);
    EXPECT_EQ(pair.use, PairFit::Use::used);
    EXPECT_GT(pair.after.overlap, 0.6);  // each station sees most of the front
    EXPECT_GT(pair.before.residual_m, 10.0 * pair.after.residual_m);
  }
}

TEST(Register, MeasuringMovesNothingAndSeesWhatRegistrationRemoves) {
  const std::vector<scene::ScanConfig> truth = relief();
  Progress progress;
  ThreadPool pool(2);
  const std::vector<PairFit> good = measure_pairs(truth, {}, {pool, progress});
  std::vector<scene::ScanConfig> off = truth;
  off[1].pose(1, 3) += 0.5e-3;
  const std::vector<PairFit> bad = measure_pairs(off, {}, {pool, progress});
  ASSERT_EQ(good.size(), 3U);
  ASSERT_EQ(bad.size(), 3U);
  EXPECT_GT(bad[0].after.residual_m, 2.0 * good[0].after.residual_m);
  EXPECT_LT(good[0].after.residual_m, 0.25e-3);
}

TEST(Register, TooLittleOverlapIsAnErrorThatNamesThePair) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> scans = {scan_of(folder, "left.xyz", {0.0, 0.0, 0.3, 0.3}, 1, carved),
                                                scan_of(folder, "right.xyz", {0.285, 0.0, 0.585, 0.3}, 2, carved)};
  scene::RegisterConfig config;
  config.max_distance_m = 0.005;
  const std::string text = error_of_registering(scans, ErrorKind::input, config);
  EXPECT_THAT(text, ::testing::HasSubstr("left.xyz"));
  EXPECT_THAT(text, ::testing::HasSubstr("right.xyz"));
  EXPECT_THAT(text, ::testing::HasSubstr("at least 10 %"));
}

TEST(Register, AScanThatTouchesNoOtherIsNamed) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> scans = {scan_of(folder, "a.xyz", {0.0, 0.0, 0.3, 0.3}, 1, carved),
                                                scan_of(folder, "b.xyz", {0.1, 0.0, 0.4, 0.3}, 2, carved),
                                                scan_of(folder, "lost.xyz", {5.0, 5.0, 5.3, 5.3}, 3, carved)};
  EXPECT_THAT(error_of_registering(scans, ErrorKind::input), ::testing::HasSubstr("lost.xyz"));
}

TEST(Register, OneScanAloneIsAUsageError) {
  const ScanFolder folder;
  EXPECT_THAT(error_of_registering({scan_of(folder, "a.xyz", {0, 0, 0.3, 0.3}, 1, carved)}, ErrorKind::usage),
              ::testing::HasSubstr("two or more"));
}

TEST(Register, PlanesSlideAndAreRefusedInsteadOfMovedAnywhere) {
  const ScanFolder folder;
  const auto plane = [](double x, double) { return 0.1 * x; };
  for (const double noise_m : {0.0, 0.3e-3}) {
    const std::vector<scene::ScanConfig> scans = {
        scan_of(folder, "wall-1.xyz", {0.0, 0.0, 0.3, 0.3, 8000, noise_m}, 1, plane),
        scan_of(folder, "wall-2.xyz", {0.05, 0.0, 0.35, 0.3, 8000, noise_m}, 2, plane)};
    const std::string text = error_of_registering(disturbed(scans, 3, 2.0, 0.005), ErrorKind::input);
    EXPECT_THAT(text, ::testing::HasSubstr("slide"));
    EXPECT_THAT(text, ::testing::HasSubstr("wall-2.xyz"));
  }
}

TEST(Register, NoiseAndOutliersAverageOut) {
  const ScanFolder folder;
  const Patch a{0.0, 0.0, 0.3, 0.3, 40000, 0.5e-3, 0.05};
  const Patch b{0.1, 0.0, 0.4, 0.3, 40000, 0.5e-3, 0.05};
  const std::vector<scene::ScanConfig> truth = {scan_of(folder, "a.xyz", a, 1, carved),
                                                scan_of(folder, "b.xyz", b, 2, carved)};
  const Registration found = registered(disturbed(truth, 4, 5.0, 0.010));
  EXPECT_LT(rms_error(truth, found.poses), 0.5e-3 / 3.0);
}

TEST(Register, ASparseScanInsideADenseOneFindsItsPlace) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> truth = {scan_of(folder, "all.xyz", {0.0, 0.0, 0.4, 0.4, 60000}, 1, carved),
                                                scan_of(folder, "part.xyz", {0.1, 0.12, 0.28, 0.3, 3000}, 2, carved)};
  const Registration found = registered(disturbed(truth, 5, 5.0, 0.009));
  EXPECT_LT(rms_error(truth, found.poses), 0.3e-3);  // a tenth of the sparse scan's 3.3 mm between points
  ASSERT_EQ(found.pairs.size(), 1U);
  EXPECT_GT(found.pairs[0].after.overlap, 0.9);
}

TEST(Register, TheSameScanTwiceBecomesOne) {
  const ScanFolder folder;
  const scene::ScanConfig scan = scan_of(folder, "a.xyz", {0.0, 0.0, 0.3, 0.3}, 1, carved);
  const std::vector<scene::ScanConfig> truth = {scan, scan};
  const Registration found = registered(disturbed(truth, 6, 5.0, 0.010));
  EXPECT_LT(rms_error(truth, found.poses), 1e-6);
}

TEST(Register, MillimetresAreTakenAsMillimetres) {
  const ScanFolder folder;
  std::vector<scene::ScanConfig> rough = {scan_of(folder, "a.xyz", {0.0, 0.0, 0.3, 0.3, 20000}, 1, carved, 1000.0),
                                          scan_of(folder, "b.xyz", {0.1, 0.0, 0.4, 0.3, 20000}, 2, carved, 1000.0)};
  rough[1].pose(0, 3) = 0.008;
  const Registration found = registered(rough);
  EXPECT_LT(found.poses[1].topRightCorner(3, 1).norm(), 50e-6);
}

std::vector<scene::ScanConfig> carved_pair(const ScanFolder& folder) {
  return {scan_of(folder, "a.xyz", {0.0, 0.0, 0.3, 0.3, 20000}, 1, carved),
          scan_of(folder, "b.xyz", {0.1, 0.0, 0.4, 0.3, 20000}, 2, carved)};
}

// Scans with more points about them, evenly spread up to `away_m` from the object's middle in each direction.
std::vector<scene::ScanConfig> with_strays(const ScanFolder& folder, const std::vector<scene::ScanConfig>& scans,
                                           int strays, double away_m) {
  std::mt19937_64 random(11);
  const auto uniform = [&] { return 2.0 * (static_cast<double>(random() >> 11U) * 0x1p-53) - 1.0; };
  std::vector<scene::ScanConfig> result = scans;
  for (std::size_t s = 0; s < result.size(); ++s) {
    std::string text = read_file(scans[s].file, 1U << 30U);
    for (int k = 0; k < strays; ++k) {
      const double z = strays == 1 ? away_m : away_m * uniform();
      text += std::to_string(away_m * uniform()) + ' ' + std::to_string(away_m * uniform()) + ' ' + std::to_string(z) +
              '\n';
    }
    result[s].file = folder.write("strays-" + std::to_string(s) + ".xyz", text);
  }
  return result;
}

TEST(Register, StraysFarFromTheObjectDoNotKeepItsScansApart) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> truth = carved_pair(folder);
  struct Strays {
    int points;
    double away_m;
  };
  for (const Strays& strays : {Strays{1, 7000.0}, Strays{100, 6.0}, Strays{200, 100.0}}) {
    const std::vector<scene::ScanConfig> scans = with_strays(folder, truth, strays.points, strays.away_m);
    std::vector<scene::ScanConfig> rough = disturbed(truth, 3, 5.0, 0.010);  // about the middle without strays
    for (std::size_t s = 0; s < scans.size(); ++s) rough[s].file = scans[s].file;
    const Registration found = registered(rough);
    EXPECT_LT(rms_error(truth, found.poses), 0.1e-3)  // a twentieth of the distance between points
        << strays.points << " strays within " << strays.away_m << " m";
  }
}

TEST(Register, AFirstPoseOfThreeDigitsIsMadeRigidSoThatTheOthersFitIt) {
  const ScanFolder folder;
  std::vector<scene::ScanConfig> truth = carved_pair(folder);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (scene::ScanConfig& scan : truth) scan.pose = rigid(turn, {1.0, 2.0, 3.0});
  std::vector<scene::ScanConfig> rough = disturbed(truth, 3, 3.0, 0.005);
  rough[0].pose = rigid((1e3 * turn).array().round() / 1e3, {1.0, 2.0, 3.0});
  const Registration found = registered(rough);
  for (const Eigen::Matrix4d& pose : found.poses) {
    const Eigen::Matrix3d r = pose.topLeftCorner<3, 3>();
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
  }
  EXPECT_LT((found.poses[0] - rough[0].pose).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(rms_error(truth, found.poses, true), 0.3 * 1e-3);  // the rounding's turn over the scan, no more
  EXPECT_LT(rms_error(truth, found.poses), 0.1e-3);
}

TEST(Register, ScansThatNobodyPlacedAreToldOfFeatures) {
  const ScanFolder folder;
  const Scattered set = scattered(folder, carved_pair(folder), 1, 0.4);
  EXPECT_THAT(error_of_registering(set.scans, ErrorKind::input), ::testing::HasSubstr("register: {guess: features}"));
  std::vector<scene::ScanConfig> posed = set.scans;
  posed[1].pose(0, 3) = 5.0;
  EXPECT_THAT(error_of_registering(posed, ErrorKind::input),
              ::testing::Not(::testing::HasSubstr("register: {guess: features}")));
}

TEST(Register, ScansOfDifferentUnitsAreToldSo) {
  const ScanFolder folder;
  std::vector<scene::ScanConfig> scans = carved_pair(folder);
  scans[1].units.unit = scene::LengthUnit::mm;
  const std::string text = error_of_registering(scans, ErrorKind::input);
  EXPECT_THAT(text, ::testing::HasSubstr("check 'units'"));
  EXPECT_THAT(text, ::testing::HasSubstr("b.xyz"));
}

scene::RegisterConfig by_features() {
  scene::RegisterConfig config;
  config.guess = scene::RegisterConfig::Guess::features;
  return config;
}

TEST(RegisterByFeatures, ScansThatNobodyPlacedComeTogether) {
  const ScanFolder folder;
  const Scattered set = scattered(folder, carved_pair(folder), 1, 0.4);
  const Registration found = registered(set.scans, by_features());
  EXPECT_LT(rms_error(set.truth, found.poses), 0.1e-3);  // a twentieth of the distance between points
  ASSERT_EQ(found.guesses.size(), 1U);
  EXPECT_EQ(found.guesses[0].scan, 1U);
  EXPECT_GT(found.guesses[0].overlap, 0.5);
}

TEST(RegisterByFeatures, GivenPosesAreNotUsedAndTheFirstStays) {
  std::vector<scene::ScanConfig> wrong = relief();
  wrong[0].pose(2, 3) += 3.0;
  wrong[1].pose(0, 3) += 100.0;
  const Registration found = registered(wrong, by_features());
  EXPECT_EQ(found.poses.front(), wrong.front().pose);
  EXPECT_LT(rms_error(relief(), found.poses), kReliefNoise_m / 3.0);
}

TEST(RegisterByFeatures, TheResultHasTheSameBitsWithAnyNumberOfThreads) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> scans = carved_pair(folder);
  EXPECT_EQ(registered(scans, by_features(), 1).poses, registered(scans, by_features(), 3).poses);
}

TEST(RegisterByFeatures, WhatIsAlikeInSeveralWaysIsRefusedByName) {
  const ScanFolder folder;
  const auto plane = [](double, double) { return 0.0; };
  const auto cylinder = [](double x, double) { return std::sqrt(0.2 * 0.2 - (x - 0.15) * (x - 0.15)); };
  const auto sphere = [](double x, double y) {
    return std::sqrt(0.3 * 0.3 - (x - 0.15) * (x - 0.15) - (y - 0.15) * (y - 0.15));
  };
  const auto pyramid = [](double x, double y) { return -std::max(std::fabs(x - 0.15), std::fabs(y - 0.15)); };
  for (const std::function<double(double, double)>& shape :
       {std::function<double(double, double)>(plane), std::function<double(double, double)>(cylinder),
        std::function<double(double, double)>(sphere), std::function<double(double, double)>(pyramid)}) {
    const std::vector<scene::ScanConfig> set = {
        scan_of(folder, "one.xyz", {0.0, 0.0, 0.3, 0.3, 4000, 0.1e-3}, 1, shape),
        scan_of(folder, "two.xyz", {0.0, 0.0, 0.3, 0.3, 4000, 0.1e-3}, 2, shape)};
    EXPECT_THAT(error_of_registering(scattered(folder, set, 3, 0.3).scans, ErrorKind::input, by_features()),
                ::testing::HasSubstr("seed-3-1.xyz"));
  }
}

TEST(RegisterByFeatures, ScansOfDifferentObjectsAreRefusedByName) {
  const ScanFolder folder;
  const auto other = [](double x, double y) { return carved(y + 0.7, 0.9 - x); };
  const std::vector<scene::ScanConfig> set = {scan_of(folder, "one.xyz", {0.0, 0.0, 0.3, 0.3, 20000}, 1, carved),
                                              scan_of(folder, "two.xyz", {0.0, 0.0, 0.3, 0.3, 20000}, 2, other)};
  const std::string text = error_of_registering(set, ErrorKind::input, by_features());
  EXPECT_THAT(text, ::testing::HasSubstr("two.xyz"));
  EXPECT_THAT(text, ::testing::HasSubstr("register.guess: poses"));
}

TEST(RegisterByFeatures, StopsWhenItIsCancelledInEachStage) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> scans = carved_pair(folder);
  for (const std::string stage : {"features", "guess pairs", "place scans"}) {
    Progress* target = nullptr;
    Progress progress([&](const ProgressUpdate& update) {
      if (update.kind == ProgressUpdate::Kind::stage && update.text == stage) target->cancel();
    });
    target = &progress;
    ThreadPool pool(2);
    EXPECT_THROW((void)register_scans(scans, by_features(), {pool, progress}), Cancelled) << stage;
  }
}

TEST(Register, ScansWithoutPointsAreLeftOutWithAWarningThatNamesThem) {
  const ScanFolder folder;
  const std::vector<scene::ScanConfig> rough = disturbed(carved_pair(folder), 5, 1.0, 0.002);
  const Registration alone = registered(rough);
  std::vector<scene::ScanConfig> more = rough;
  scene::ScanConfig empty;
  empty.pose(0, 3) = 1.5;
  empty.file = folder.write("nobytes.xyz", "");
  more.insert(more.begin(), empty);
  empty.file = folder.write("headeronly.csv", "x,y,z\n");
  more.insert(more.begin() + 2, empty);
  std::vector<std::string> warnings;
  Progress progress([&](const ProgressUpdate& update) {
    if (update.kind == ProgressUpdate::Kind::warning) warnings.emplace_back(update.text);
  });
  ThreadPool pool(2);
  const Registration found = register_scans(more, {}, {pool, progress});
  EXPECT_THAT(warnings, ::testing::IsSupersetOf({::testing::HasSubstr("nobytes.xyz: the file is empty"),
                                                 ::testing::HasSubstr("headeronly.csv: ")}));
  ASSERT_EQ(found.poses.size(), more.size());
  EXPECT_EQ(found.poses[0], empty.pose);
  EXPECT_EQ(found.poses[2], empty.pose);
  const std::size_t places[] = {1, 3};
  for (std::size_t s = 0; s < alone.poses.size(); ++s) EXPECT_EQ(found.poses[places[s]], alone.poses[s]) << s;
  ASSERT_EQ(found.pairs.size(), alone.pairs.size());
  for (std::size_t k = 0; k < alone.pairs.size(); ++k) {
    EXPECT_EQ(found.pairs[k].first, places[alone.pairs[k].first]);
    EXPECT_EQ(found.pairs[k].second, places[alone.pairs[k].second]);
  }
}

TEST(Register, OneScanWithPointsBesideEmptyOnesIsRefusedAndMeasuresNothing) {
  const ScanFolder folder;
  scene::ScanConfig empty;
  empty.file = folder.write("nothing.xyz", "");
  const std::vector<scene::ScanConfig> scans = {carved_pair(folder).front(), empty};
  EXPECT_THAT(error_of_registering(scans, ErrorKind::input), ::testing::HasSubstr("only one of the scans has points"));
  Progress progress;
  ThreadPool pool(1);
  EXPECT_TRUE(measure_pairs(scans, {}, {pool, progress}).empty());
}

TEST(Register, StopsWhenItIsCancelledInEachStage) {
  const std::vector<scene::ScanConfig> rough = disturbed(relief(), 1, 5.0, 0.010);
  for (const std::string stage : {"read", "align pairs", "relax"}) {
    Progress* target = nullptr;
    Progress progress([&](const ProgressUpdate& update) {
      if (update.kind == ProgressUpdate::Kind::stage && update.text == stage) target->cancel();
    });
    target = &progress;
    ThreadPool pool(2);
    EXPECT_THROW((void)register_scans(rough, {}, {pool, progress}), Cancelled) << stage;
  }
}

}  // namespace
}  // namespace sparsha::pipeline::testing

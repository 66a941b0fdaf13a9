// A registration that was ended and begins again: the same poses, from the results that it kept.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/register/finished_pairs.h"
#include "tests/pipeline/register/stations.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline::testing {
namespace {

int few(int /*station*/) { return 3000; }

std::size_t lines_of(const std::filesystem::path& file) {
  const std::string text = read_file(file, std::size_t{1} << 24U);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class Resumed : public ::testing::Test {
 protected:
  // Taken from results: how many.
  std::size_t taken(const std::vector<scene::ScanConfig>& scans, const scene::RegisterConfig& config,
                    Registration& found, Progress& progress) {
    FinishedPairs finished(kept_, "program");
    ThreadPool pool(2);
    found = register_scans(scans, config, {pool, progress}, &finished);
    return finished.taken();
  }
  std::size_t taken(const std::vector<scene::ScanConfig>& scans, Registration& found) {
    Progress progress;
    return taken(scans, config_, found, progress);
  }
  // Cancels once so many results are in the file.
  void end_after(const std::vector<scene::ScanConfig>& scans, std::size_t results) {
    Progress* cancelled = nullptr;
    Progress progress([&](const ProgressUpdate&) {
      if (std::filesystem::exists(kept_) && lines_of(kept_) > results) cancelled->cancel();
    });
    cancelled = &progress;
    Registration none;
    EXPECT_THROW((void)taken(scans, config_, none, progress), Cancelled);
  }

  test::TestFolder folder_;
  std::filesystem::path kept_ = folder_.path() / ".registered.yaml.pairs";
  scene::RegisterConfig config_;
};

void expect_same(const Registration& a, const Registration& b) {
  EXPECT_EQ(a.poses, b.poses);
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (std::size_t k = 0; k < a.pairs.size(); ++k) {
    EXPECT_EQ(a.pairs[k].use, b.pairs[k].use);
    EXPECT_EQ(a.pairs[k].before.residual_m, b.pairs[k].before.residual_m);
    EXPECT_EQ(a.pairs[k].before.matches, b.pairs[k].before.matches);
    EXPECT_EQ(a.pairs[k].after.residual_m, b.pairs[k].after.residual_m);
  }
}

TEST_F(Resumed, AfterAnEndInTheMiddleThePosesAreThoseOfOneRunToTheLastBit) {
  const std::vector<scene::ScanConfig> truth = ring(folder_.path(), 5, few, 1e-4, 1);
  const std::vector<scene::ScanConfig> rough = disturbed(truth, 1, 4.0, 0.006);
  const Registration once = registered(rough);
  end_after(rough, 3);
  const std::size_t there = lines_of(kept_) - 1;
  EXPECT_GE(there, 3U);
  // What a kill leaves: a line that was cut off.
  std::ofstream(kept_, std::ios::app) << "0123456789abcdef,1,2,3";
  Registration again;
  EXPECT_EQ(taken(rough, again), there);
  expect_same(again, once);
  const std::size_t all = lines_of(kept_) - 1;
  EXPECT_GT(all, there);
  EXPECT_EQ(taken(rough, again), all) << "every pair was there";
  expect_same(again, once);
}

// A quarter of a vessel is too little in common for a guess: what was found of each pair is kept all the same.
TEST_F(Resumed, GuessesFromFeaturesAreKeptAlsoWhenAnErrorEndsTheRegistration) {
  const ScanFolder scans;
  const Scattered set = scattered(scans, ring(folder_.path(), 4, few, 1e-4, 1), 3, 0.2);
  config_.guess = scene::RegisterConfig::Guess::features;
  std::vector<std::string> errors;
  for (const std::size_t there : {0U, 6U}) {
    FinishedPairs finished(kept_, "program");
    ThreadPool pool(2);
    Progress progress;
    try {
      (void)register_scans(set.scans, config_, {pool, progress}, &finished);
      FAIL() << "no error";
    } catch (const Error& error) {
      errors.emplace_back(error.what());
    }
    EXPECT_EQ(finished.taken(), there);
    EXPECT_EQ(lines_of(kept_) - 1, 6U) << "pairs of four scans";
  }
  EXPECT_EQ(errors.front(), errors.back());
}

TEST_F(Resumed, OtherScansPosesMethodsAndProgramsTakeNothing) {
  const std::vector<scene::ScanConfig> truth = ring(folder_.path(), 5, few, 1e-4, 1);
  const std::vector<scene::ScanConfig> rough = disturbed(truth, 1, 4.0, 0.006);
  Registration found, other;
  EXPECT_EQ(taken(rough, found), 0U);
  config_.method = scene::RegisterConfig::Method::point_to_plane;
  EXPECT_EQ(taken(rough, other), 0U);
  config_.method = scene::RegisterConfig::Method::gicp;
  EXPECT_EQ(taken(disturbed(truth, 2, 4.0, 0.006), other), 0U);
  const test::TestFolder folder;
  EXPECT_EQ(taken(disturbed(ring(folder.path(), 5, few, 1e-4, 2), 1, 4.0, 0.006), other), 0U);
  {
    FinishedPairs finished(kept_, "another program");
    ThreadPool pool(2);
    Progress progress;
    (void)register_scans(rough, config_, {pool, progress}, &finished);
    EXPECT_EQ(finished.taken(), 0U);
  }
  EXPECT_GT(taken(rough, other), 0U);
  expect_same(other, found);
}

TEST_F(Resumed, ChangedResultsAreNotBelieved) {
  const std::vector<scene::ScanConfig> truth = ring(folder_.path(), 5, few, 1e-4, 1);
  const std::vector<scene::ScanConfig> rough = disturbed(truth, 1, 4.0, 0.006);
  Registration found, again;
  EXPECT_EQ(taken(rough, found), 0U);
  const std::size_t results = lines_of(kept_) - 1;
  std::string text = read_file(kept_, std::size_t{1} << 24U);
  text[text.size() / 2] = text[text.size() / 2] == '1' ? '2' : '1';
  write_file(kept_, text);
  EXPECT_EQ(taken(rough, again), results - 1);
  expect_same(again, found);
}

TEST_F(Resumed, FilesOfSomethingElseFoldersAndLinksStay) {
  const std::filesystem::path other = folder_.path() / "letter.txt";
  write_file(other, "a letter\n");
  EXPECT_THROW(FinishedPairs(other, ""), Error);
  std::filesystem::create_directory(folder_.path() / "pairs");
  EXPECT_THROW(FinishedPairs(folder_.path() / "pairs", ""), Error);
  std::filesystem::create_symlink(other, kept_);
  EXPECT_THROW(FinishedPairs(kept_, ""), Error);
  for (const std::filesystem::path& path : {other, folder_.path() / "pairs", kept_}) remove_finished_pairs(path);
  EXPECT_EQ(read_file(other, 100), "a letter\n");
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "pairs"));
  EXPECT_TRUE(std::filesystem::is_symlink(kept_));
  std::filesystem::remove(kept_);
  write_file(kept_, "sparsha pa");  // killed while it was begun
  FinishedPairs(kept_, "").add("key", {1.5});
  std::vector<double> numbers;
  EXPECT_TRUE(FinishedPairs(kept_, "").find("key", numbers));
  EXPECT_EQ(numbers, std::vector<double>{1.5});
  remove_finished_pairs(kept_);
  EXPECT_FALSE(std::filesystem::exists(kept_));
}

}  // namespace
}  // namespace sparsha::pipeline::testing

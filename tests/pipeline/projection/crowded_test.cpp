// The points that stay of a crowded bin, in memory and one by one.
#include "pipeline/projection/crowded.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

namespace sparsha::pipeline {
namespace {

using Place = std::array<float, 3>;

std::vector<std::set<Place>> places_of(const Bins& bins) {
  std::vector<std::set<Place>> places(bins.lattice.bin_count());
  for (std::size_t b = 0; b < places.size(); ++b)
    for (std::uint32_t p = bins.start[b]; p < bins.start[b + 1]; ++p)
      EXPECT_TRUE(places[b].insert({bins.x[p], bins.y[p], bins.z[p]}).second) << "twice in bin " << b;
  return places;
}

OrientedPoints oriented(const std::vector<Place>& places) {
  OrientedPoints points;
  points.count = places.size();
  points.x = make_buffer<float>(places.size());
  points.y = make_buffer<float>(places.size());
  points.z = make_buffer<float>(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    points.x[k] = places[k][0];
    points.y[k] = places[k][1];
    points.z[k] = places[k][2];
  }
  return points;
}

// Of bins with 300 to 5000 places each, some of them told many times.
std::vector<Place> some_places() {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-0.5F, 0.5F);
  std::vector<Place> places;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int count = (i + j) % 2 == 0 ? 300 : 1200 * (i + 1);
      for (int k = 0; k < count; ++k) {
        const auto x = static_cast<float>(i) + 0.98F * unit(random), y = static_cast<float>(j) + 0.98F * unit(random);
        places.push_back({x, y, unit(random)});
        if (k % 50 == 0) places.insert(places.end(), 60, places.back());
      }
    }
  return places;
}

TEST(CrowdedBins, KeepOneChoiceInAnyOrderAndOneByOne) {
  std::vector<Place> places = some_places();
  BinLattice lattice;
  lattice.nx = lattice.ny = 4;
  lattice.spacing_m = 1.0;
  const BinLocator locator(lattice);
  const BinWindow window = BinWindow::all(lattice);
  std::vector<std::set<Place>> first;
  for (const unsigned threads : {1U, 3U}) {
    ThreadPool pool(threads);
    std::shuffle(places.begin(), places.end(), std::mt19937(threads));
    Bins bins = sort_into_bins(oriented(places), {}, lattice, window, pool);
    leave_out_repeats(bins, window, pool);
    const std::vector<std::set<Place>> all = places_of(bins);
    leave_out_crowd(bins, window, pool);
    const std::vector<std::set<Place>> kept = places_of(bins);
    std::vector<CrowdedBin> one_by_one(lattice.bin_count());
    for (const auto& [x, y, z] : places) {
      int column = 0, row = 0;
      ASSERT_TRUE(locator.locate(x, y, column, row));
      one_by_one[static_cast<std::size_t>(row * lattice.bins_x() + column)].add(x, y, z);
    }
    for (std::size_t b = 0; b < kept.size(); ++b) {
      EXPECT_EQ(kept[b].size(), std::min(all[b].size(), kMostInBin));
      EXPECT_TRUE(std::includes(all[b].begin(), all[b].end(), kept[b].begin(), kept[b].end()));
      const std::vector<Place> taken = one_by_one[b].take();
      EXPECT_EQ(std::set<Place>(taken.begin(), taken.end()), kept[b]);
      EXPECT_EQ(taken.size(), kept[b].size());
    }
    if (first.empty()) first = kept;
    EXPECT_EQ(kept, first);
  }
}

TEST(CrowdedBins, KeepAnEvenSample) {
  // The mean height of what stays is that of all within five standard errors.
  std::vector<Place> places;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-0.5F, 0.5F);
  for (int k = 0; k < 100'000; ++k) places.push_back({0.9F * unit(random), 0.9F * unit(random), unit(random)});
  CrowdedBin bin;
  for (const auto& [x, y, z] : places) bin.add(x, y, z);
  const double error = std::sqrt(1.0 / 12.0 / static_cast<double>(kMostInBin));
  Place sum{};
  for (const Place& place : bin.take())
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += place[axis];
  for (const float axis : sum) EXPECT_NEAR(axis / static_cast<double>(kMostInBin), 0.0, 5.0 * error);
}

}  // namespace
}  // namespace sparsha::pipeline

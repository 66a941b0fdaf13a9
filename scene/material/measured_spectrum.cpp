#include "scene/material/measured_spectrum.h"

#include <algorithm>
#include <vector>

#include "scene/scene.h"

namespace sparsha::scene {
namespace {

constexpr int kPatches = 4;      // along the longer side
constexpr int kProfileStep = 4;  // neighbouring rows say the same

/// Longest power of two of nodes that a level's shorter side holds; 0 when it is too short.
int profile_length(const Lattice& lattice) {
  int length = kLongestProfile;
  while (length > std::min(lattice.nx, lattice.ny)) length /= 2;
  return length >= kShortestProfile ? length : 0;
}

void add_profiles(HeightSpectrumFit& fit, const Layers& patch, int length) {
  const DepthGrid& grid = patch.grid;
  std::vector<double> heights_m(static_cast<std::size_t>(length));
  for (const bool along_x : {true, false})
    for (int line = 0; line < length; line += kProfileStep) {
      bool measured = true;
      for (int k = 0; k < length && measured; ++k) {
        const std::size_t node = along_x ? grid.lattice.index(k, line) : grid.lattice.index(line, k);
        measured = grid.state[node] == NodeState::measured;
        heights_m[static_cast<std::size_t>(k)] = static_cast<double>(grid.height_m[node]);
      }
      if (measured) fit.add(heights_m);
    }
}

}  // namespace

HeightSpectrum measure_spectrum(const Scene& scene) {
  const Lattice& lattice = scene.description().levels.front();
  const int length = profile_length(lattice);
  if (length == 0) return {};
  HeightSpectrumFit fit(length, lattice.spacing_m);
  const auto patches = [&](int n) { return std::clamp(n / length, 1, kPatches); };
  const int nx = patches(lattice.nx);
  const int ny = patches(lattice.ny);
  // Evenly spread, the outermost ones as far from the rim as from each other.
  const auto first = [&](int n, int count, int k) { return (2 * k + 1) * n / (2 * count) - length / 2; };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int i0 = std::clamp(first(lattice.nx, nx, i), 0, lattice.nx - length);
      const int j0 = std::clamp(first(lattice.ny, ny, j), 0, lattice.ny - length);
      add_profiles(fit, scene.read(0, i0, j0, length, length), length);
    }
  return fit.fit();
}

}  // namespace sparsha::scene

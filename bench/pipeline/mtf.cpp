// Modulation transfer: how much of the form of each wavelength the heights keep (gain), and how much of what they show
// at it is form rather than noise (coherence); on gratings of all phases and headings, and on the sample relief.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "base/numbers/statistics.h"
#include "base/yaml/yaml.h"
#include "bench/pipeline/run.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/reader.h"
#include "pipeline/simulate/simulate.h"
#include "scene/config/config.h"
#include "tests/support/clouds.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;

/// Wavelengths in nodes, one band between each and the next.
constexpr std::array<double, 12> kBands{2.0, 2.5, 3.0, 3.5, 4.0, 4.65, 5.8, 8.0, 12.0, 18.0, 27.0, 40.0};

/// In place; the length is a power of two. `step` is the distance of its elements.
void transform(Complex* data, std::size_t count, std::size_t step) {
  for (std::size_t i = 1, j = 0; i < count; ++i) {
    std::size_t bit = count >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(data[i * step], data[j * step]);
  }
  for (std::size_t length = 2; length <= count; length <<= 1) {
    const Complex turn = std::polar(1.0, -2.0 * kPi / static_cast<double>(length));
    for (std::size_t begin = 0; begin < count; begin += length) {
      Complex w = 1.0;
      for (std::size_t k = 0; k < length / 2; ++k, w *= turn) {
        Complex& a = data[(begin + k) * step];
        Complex& b = data[(begin + k + length / 2) * step];
        const Complex product = w * b;
        b = a - product;
        a += product;
      }
    }
  }
}

struct Plane {
  std::size_t nx = 0, ny = 0;
  std::vector<double> z;
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return z[j * nx + i]; }
  /// The Laplacian times the spacing squared.
  [[nodiscard]] double bend(std::size_t i, std::size_t j) const {
    return at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1) - 4.0 * at(i, j);
  }
};

/// Spectrum of a tile's Laplacian, which flattens the spectrum of forms, under a Hann window. Filters do not touch the
/// ratio of two spectra.
std::vector<Complex> spectrum(const Plane& plane, std::size_t i0, std::size_t j0, std::size_t size) {
  std::vector<Complex> tile(size * size);
  const auto hann = [size](std::size_t k) {
    return 0.5 - 0.5 * std::cos(2.0 * kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(size));
  };
  for (std::size_t j = 0; j < size; ++j) {
    for (std::size_t i = 0; i < size; ++i) tile[j * size + i] = hann(i) * hann(j) * plane.bend(i0 + i, j0 + j);
  }
  for (std::size_t j = 0; j < size; ++j) transform(&tile[j * size], size, 1);
  for (std::size_t i = 0; i < size; ++i) transform(&tile[i], size, size);
  return tile;
}

struct Transfer {
  std::array<double, kBands.size() - 1> truth{}, found{};
  std::array<Complex, kBands.size() - 1> cross{};

  [[nodiscard]] double gain(std::size_t band) const { return cross[band].real() / truth[band]; }
  [[nodiscard]] double coherence(std::size_t band) const {
    return std::norm(cross[band]) / (truth[band] * found[band]);
  }
};

void add_tile(Transfer& sums, const std::vector<Complex>& truth, const std::vector<Complex>& found, std::size_t size) {
  const auto nodes = static_cast<double>(size);
  for (std::size_t j = 0; j < size; ++j) {
    for (std::size_t i = 0; i <= size / 2; ++i) {
      if (i + j == 0) continue;
      const double wavelength = nodes / std::hypot(static_cast<double>(i), static_cast<double>(std::min(j, size - j)));
      const auto above = std::upper_bound(kBands.begin(), kBands.end(), wavelength);
      if (above == kBands.begin() || above == kBands.end()) continue;
      const auto band = static_cast<std::size_t>(above - kBands.begin()) - 1;
      const Complex t = truth[j * size + i], f = found[j * size + i];
      sums.truth[band] += std::norm(t);
      sums.found[band] += std::norm(f);
      sums.cross[band] += f * std::conj(t);
    }
  }
}

/// Over tiles of `size` nodes that overlap by half and bend by no more than `most_bend_m` anywhere.
Transfer transfer_of(const Plane& truth, const Plane& found, std::size_t size, double most_bend_m) {
  Transfer sums;
  for (std::size_t j0 = 1; j0 + size + 1 <= truth.ny; j0 += size / 2) {
    for (std::size_t i0 = 1; i0 + size + 1 <= truth.nx; i0 += size / 2) {
      bool smooth = true;
      for (std::size_t j = j0; j < j0 + size && smooth; ++j) {
        for (std::size_t i = i0; i < i0 + size; ++i) smooth = smooth && std::abs(truth.bend(i, j)) <= most_bend_m;
      }
      if (smooth) add_tile(sums, spectrum(truth, i0, j0, size), spectrum(found, i0, j0, size), size);
    }
  }
  return sums;
}

/// What is judged: tiles of so many nodes that bend by no more.
struct Tiles {
  std::size_t size = 128;
  double most_bend_m = std::numeric_limits<double>::infinity();
};

struct Pair {
  Plane truth, found;
  double rms_m = 0.0, median_m = 0.0;
  double measured = 0.0;
};

/// An unmeasured node takes the error of its measured neighbours, which hides neither form nor noise.
Pair compare(const scene::DepthGrid& grid, const std::function<double(double, double)>& height_m) {
  const scene::Lattice& lattice = grid.lattice;
  Pair pair;
  pair.truth.nx = pair.found.nx = static_cast<std::size_t>(lattice.nx);
  pair.truth.ny = pair.found.ny = static_cast<std::size_t>(lattice.ny);
  pair.truth.z.resize(lattice.count());
  pair.found.z.resize(lattice.count());
  std::vector<double> errors;
  double squares = 0.0;
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) pair.truth.z[lattice.index(i, j)] = height_m(lattice.x_m(i), lattice.y_m(j));
  }
  const auto error_at = [&](int i, int j, double& sum, int& count) {
    if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) return;
    const std::size_t k = lattice.index(i, j);
    if (grid.state[k] != scene::NodeState::measured) return;
    sum += lattice.origin_m.z() + static_cast<double>(grid.height_m[k]) - pair.truth.z[k];
    ++count;
  };
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      double error = 0.0;
      int count = 0;
      error_at(i, j, error, count);
      if (count > 0) {
        errors.push_back(std::abs(error));
        squares += error * error;
      } else {
        for (int b = -1; b <= 1; ++b) {
          for (int a = -1; a <= 1; ++a) error_at(i + a, j + b, error, count);
        }
        if (count > 0) error /= count;
      }
      pair.found.z[k] = pair.truth.z[k] + error;
    }
  }
  pair.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, errors.size())));
  pair.measured = static_cast<double>(errors.size()) / static_cast<double>(lattice.count());
  if (!errors.empty()) pair.median_m = median(errors);
  return pair;
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "scene,rms_mm,median_mm,measured_percent,wavelength_from_nodes,wavelength_to_nodes,gain,coherence\n";
    std::string line = "\n| wavelength, nodes | RMS mm | median mm |", rule = "|---|---|---|";
    for (std::size_t b = 0; b + 1 < kBands.size(); ++b) {
      line += fmt::format(" {:g} to {:g} |", kBands[b], kBands[b + 1]);
      rule += "---|";
    }
    fmt::print("{}\n{}\n", line, rule);
  }
  void rows(const std::string& scene, const Pair& pair, const Tiles& tiles = {}) {
    const Transfer transfer = transfer_of(pair.truth, pair.found, tiles.size, tiles.most_bend_m);
    // Errors are those of all nodes, so a choice of tiles goes without.
    const bool all = std::isinf(tiles.most_bend_m);
    std::string gain = fmt::format("| {}: gain | {} |", scene,
                                   all ? fmt::format("{:.4f} | {:.4f}", 1e3 * pair.rms_m, 1e3 * pair.median_m) : "|");
    std::string coherence = fmt::format("| {}: coherence | | |", scene);
    for (std::size_t b = 0; b + 1 < kBands.size(); ++b) {
      gain += fmt::format(" {:.3f} |", transfer.gain(b));
      coherence += fmt::format(" {:.3f} |", transfer.coherence(b));
      csv_ << fmt::format("\"{}\",{},{},{},{},{},{},{}\n", scene, 1e3 * pair.rms_m, 1e3 * pair.median_m,
                          100.0 * pair.measured, kBands[b], kBands[b + 1], transfer.gain(b), transfer.coherence(b));
    }
    fmt::print("{}\n{}\n", gain, coherence);
    std::fflush(stdout);
    csv_.flush();
  }

 private:
  std::ofstream csv_;
};

struct Wave {
  double kx, ky, phase, amplitude_m;
};

/// A sum of gratings: 8 in each band, their wavelengths, headings and phases at random; the amplitude of a wavelength
/// is a share of it, as the grain of stone has it, so that all are alike in slope.
std::vector<Wave> gratings(double spacing_m, double slope, std::uint64_t seed) {
  constexpr int kPerBand = 8;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Wave> waves;
  for (std::size_t b = 0; b + 1 < kBands.size(); ++b) {
    for (int k = 0; k < kPerBand; ++k) {
      const double wavelength = spacing_m * kBands[b] * std::pow(kBands[b + 1] / kBands[b], unit(random));
      const double heading = 2.0 * kPi * unit(random);
      const double number = 2.0 * kPi / wavelength;
      waves.push_back({number * std::cos(heading), number * std::sin(heading), 2.0 * kPi * unit(random),
                       slope / number * std::sqrt(2.0 / kPerBand / (kBands.size() - 1))});
    }
  }
  return waves;
}

void run_gratings(double per_node, double noise_spacings, double slope, Table& table) {
  constexpr int kNodes = 322;
  constexpr double kSpacing_m = 0.001;
  const std::vector<Wave> waves = gratings(kSpacing_m, slope, 5);
  const auto height_m = [&](double x, double y) {
    double z = 0.0;
    for (const Wave& w : waves) z += w.amplitude_m * std::cos(w.kx * x + w.ky * y + w.phase);
    return z;
  };
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise_spacings * kSpacing_m);
  const double side = (kNodes - 1) * kSpacing_m;
  test::Points points;
  for (double k = 0.0; k < per_node * kNodes * kNodes; k += 1.0) {
    const double x = side * unit(random), y = side * unit(random);
    points.push_back({x, y, height_m(x, y) + normal(random)});
  }
  scene::GridConfig grid;
  grid.spacing_m = kSpacing_m;
  grid.bounds_m = {0.0, 0.0, side + 0.25 * kSpacing_m, side + 0.25 * kSpacing_m};
  const pipeline::Projection projection = test::project_cloud(test::make_cloud(points), grid);
  table.rows(fmt::format("gratings of slope {}, {} points per node", slope, per_node),
             compare(projection.grid, height_m));
}

/// The sample beside the program's sources, against the surface that it was drawn from.
void run_sample(Table& table) {
  const fs::path source = SPARSHA_SOURCE_DIR;
  const pipeline::SimulationConfig simulation =
      pipeline::parse_simulation(yaml::parse_file(source / "configs/simulate-relief.yaml"));
  const pipeline::Truth truth(simulation);
  const scene::Config config = scene::load_config(source / "data/relief/sparsha.yaml");
  Progress progress;
  ThreadPool pool(2);
  const pipeline::Cloud cloud = pipeline::load_scans(config.scans, progress);
  const pipeline::Projection projection = pipeline::project(cloud, config.orientation.scan_to_grid, config.grid,
                                                            config.haptics.resolution_m, {pool, progress});
  const Pair pair = compare(projection.grid, [&](double x, double y) { return truth.height_m(x, y); });
  table.rows("sample relief", pair);
  table.rows("its grain between the carvings", pair, {32, 0.002});
}

}  // namespace

void run_mtf(const RunOptions& options) {
  Table table(options.out / "pipeline_mtf.csv");
  for (const double per_node : {1.0, 3.6, 16.0}) {
    if (options.quick && per_node > 4.0) continue;
    for (const double slope : {0.1, 0.4}) run_gratings(per_node, 0.07, slope, table);
  }
  run_sample(table);
}

}  // namespace sparsha::bench

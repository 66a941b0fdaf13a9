// Truth as TIFF and JSON, configuration as YAML.
#include "pipeline/simulate/outputs.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text/text.h"
#include "pipeline/export/height_tiff.h"
#include "pipeline/simulate/frames.h"

namespace sparsha::pipeline {
namespace {

/// Shortest text that reads back as the same double.
std::string number(double value) { return exact_text(value + 0.0); }  // + 0.0: no negative zero

template <typename Vector>
std::string list(const Vector& vector) {
  std::string text = "[";
  for (const double value : vector) text += (text.size() > 1 ? ", " : "") + number(value);
  return text + "]";
}
std::array<double, 3> array_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

const char* form_name(const Form& form) {
  constexpr std::array<const char*, 8> kNames{"plane",  "sinusoid", "accuracy", "bars",
                                              "relief", "facade",   "hall",     "statue"};
  return kNames[form.index()];
}

}  // namespace

void write_truth_tiff(const Truth& truth, const std::filesystem::path& file, const std::string& shown,
                      const Context& context) {
  const scene::Lattice& lattice = truth.lattice();
  const auto nx = static_cast<std::size_t>(lattice.nx);
  HeightTiff tiff(file, shown, lattice.nx, lattice.ny, true);
  std::vector<double> band;
  for (int top = 0; top < lattice.ny; top += HeightTiff::kBand) {
    context.progress.at(static_cast<double>(top) / lattice.ny);
    const auto rows = static_cast<std::size_t>(std::min(HeightTiff::kBand, lattice.ny - top));
    band.resize(rows * nx);
    context.pool.for_ranges(rows, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const double y = lattice.y_m(lattice.ny - 1 - top - static_cast<int>(row));
        for (int i = 0; i < lattice.nx; ++i)
          band[row * nx + static_cast<std::size_t>(i)] = truth.height_m(lattice.x_m(i), y);
      }
    });
    tiff.write_band(top, band);
  }
  tiff.close();
}

std::string truth_world_file(const Truth& truth) {
  const scene::Lattice& l = truth.lattice();
  return fmt::format("{}\n0\n0\n{}\n{}\n{}\n", l.spacing_m, -l.spacing_m, l.x_m(0), l.y_m(l.ny - 1));
}

std::string truth_json(const SimulationConfig& config, const Truth& truth, const std::vector<SimulatedFile>& files) {
  const scene::Lattice& l = truth.lattice();
  const Eigen::Matrix4d inverse = [&] {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = truth.scan_to_grid().topLeftCorner<3, 3>().transpose();
    return m;
  }();
  std::string matrix;
  for (int row = 0; row < 4; ++row) {
    matrix += (row > 0 ? ", " : "") +
              list(std::array<double, 4>{inverse(row, 0), inverse(row, 1), inverse(row, 2), inverse(row, 3)});
  }
  std::string text = fmt::format(
      "{{\n  \"form\": \"{}\",\n  \"seed\": {},\n  \"grid\": {{\"nx\": {}, \"ny\": {}, \"spacing_m\": {}, "
      "\"origin_m\": {}}},\n"
      "  \"scan_from_grid\": [{}],\n  \"noise_m\": {},\n  \"outlier_fraction\": {},\n  \"outlier_spread_m\": {},\n"
      "  \"files\": [",
      form_name(config.surface.form), config.seed, l.nx, l.ny, number(l.spacing_m), list(array_of(l.origin_m)), matrix,
      number(config.noise_m), number(config.outlier_fraction), number(config.outlier_spread_m));
  for (const SimulatedFile& file : files) {
    text += fmt::format("{}\n    {{\"file\": \"{}\", \"points\": {}, \"back\": {}, \"outliers\": {}}}",
                        &file == files.data() ? "" : ",", file.name, file.points, file.back, file.outliers);
  }
  return text + "\n  ]\n}\n";
}

std::string build_yaml(const SimulationConfig& config, const Truth& truth, const std::vector<SimulatedFile>& files) {
  std::string text = fmt::format("# Builds the simulated scan beside it{}: `sparsha build sparsha.yaml`\nscans:\n",
                                 truth.surface().is_body() ? "" : " on the lattice of truth.tif");
  for (std::size_t k = 0; k < files.size(); ++k) {
    text += fmt::format("  - file: \"{}\"\n    units: m\n", files[k].name);
    if (config.station_frame) {
      const StationPose pose = scan_from_station(config, std::get<ScannerConfig>(config.scan).stations[k]);
      text += fmt::format("    pose: {{translate: {}, quaternion: {}}}\n", list(array_of(pose.translation_m)),
                          list(quaternion_of(pose.rotation)));
    }
  }
  text += fmt::format("orientation: {{look_from: {}, up: {}, scale: 1.0}}\n", list(array_of(config.look_from)),
                      list(array_of(config.up)));
  if (truth.surface().is_body()) return text + "around: {}\ncheck: {samples: 50000}\n";
  text += fmt::format("grid: {{spacing_mm: {}, bounds_m: {}}}\n", number(1e3 * truth.lattice().spacing_m),
                      list(truth.bounds_m()));
  return text + "fill: {max_gap_mm: 5}\ncheck: {samples: 50000}\n";
}

}  // namespace sparsha::pipeline

// A noisy scan of the textured sinusoid through projection, bilateral filter, curvature and friction law to a window;
// the stroke begins in free space.
#include "bench/haptics/scanned.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "bench/haptics/stroke.h"
#include "haptics/proxy/proxy.h"
#include "haptics/window/window.h"
#include "pipeline/build/build.h"
#include "pipeline/simulate/ply_stream.h"
#include "scene/scene.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kNoise_m = 0.0002;     // along z
constexpr double kWorkspace_m = 0.1;    // kStrokeScale times the surface
constexpr double kPerNode = 3.6;        // points
constexpr double kSmoothing_mm = 12.0;  // the bilateral filter's reach, 0.4 of a grain
constexpr double kRange_mm = 3.0;       // more than the grain's height

double seconds_since(Clock::time_point began) { return std::chrono::duration<double>(Clock::now() - began).count(); }

void write_scan(const fs::path& file, std::size_t count) {
  std::mt19937_64 random(2014);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  pipeline::PlyStream stream(file, file.string(), {}, "textured sinusoid");
  std::vector<pipeline::SimulatedPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    double noise = -6.0;  // of twelve uniform numbers: nearly Gaussian
    for (int n = 0; n < 12; ++n) noise += uniform();
    const double x = uniform(), y = uniform();
    points.push_back({{x, y, stroke_envelope(x, y) + stroke_texture(x, y) + kNoise_m * noise}});
  }
  stream.append(points, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  stream.close();
}

scene::Config config_of(const fs::path& folder, int nodes, const std::string& friction) {
  const fs::path file = folder / "scanned.yaml";
  {
    std::ofstream yaml(file);
    yaml << "scans:\n  - {file: scan.ply, units: m}\ngrid: {size: " << nodes << ", bounds_m: [0, 0, 1, 1]}\n"
         << "texture: {sigma_space_mm: " << kSmoothing_mm << ", sigma_range_mm: " << kRange_mm << "}\n"
         << "friction: {" << friction << "}\nlevels: {window: " << nodes
         << "}\nhaptics: {tip_radius_mm: 0}\ncheck: {samples: 50000}\n";
  }
  return scene::load_config(file);
}

haptics::SurfacePointer window_of(const scene::Scene& scene, bool texture, bool friction) {
  haptics::WindowPlan plan =
      haptics::plan_window(scene.description(), 0, haptics::middle_of(scene.description().levels[0]), kWorkspace_m);
  plan.effects = {texture, friction};
  return haptics::load_window(scene, plan, 1).surface;
}

double mean_mu(const haptics::MongeSurface& surface) {
  double sum = 0.0;
  for (const float mu : surface.mu_dynamic) sum += static_cast<double>(mu);
  return surface.mu_dynamic.empty() ? 0.0 : sum / static_cast<double>(surface.mu_dynamic.size());
}

/// What the pipeline's texture (heights less envelope) is worth against the grain that was scanned.
struct TextureFidelity {
  double correlation = 0.0;
  double gain = 0.0;  ///< regression on the true texture
};
TextureFidelity texture_fidelity(const scene::Scene& scene) {
  const scene::Layers layers = scene.read_level(0);
  const scene::Lattice& lattice = layers.grid.lattice;
  double tt = 0.0, ft = 0.0, ff = 0.0;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      const double x = lattice.x_m(i), y = lattice.y_m(j);
      if (std::min({x, y, 1.0 - x, 1.0 - y}) < 0.05 || layers.grid.state[k] != scene::NodeState::measured) continue;
      const double found = static_cast<double>(layers.grid.height_m[k]) - static_cast<double>(layers.envelope_m[k]);
      const double truth = stroke_texture(x, y);
      tt += truth * truth;
      ft += found * truth;
      ff += found * found;
    }
  return {ft / std::sqrt(ff * tt), ft / tt};
}

bool write_strokes(const fs::path& folder, const std::vector<Stroke>& strokes, double z_ms, double force_ms) {
  std::ofstream csv(folder / "haptics_scanned.csv");
  csv << "t_s";
  for (const char* value : {"z", "force"})
    for (const char* name : {"without", "texture", "texture_friction", "friction"})
      csv << ',' << value << '_' << name << (value[0] == 'z' ? "_mm" : "_n");
  csv << '\n';
  for (std::size_t k = 0; k < strokes[0].t.size(); ++k) {
    csv << strokes[0].t[k];
    for (const Stroke& stroke : strokes) csv << ',' << stroke.z_mm[k];
    for (const Stroke& stroke : strokes) csv << ',' << stroke.force_n[k];
    csv << '\n';
  }
  const auto figure = [&](const char* file, const char* title, const char* unit, double lag_ms,
                          std::vector<double> Stroke::*value) {
    char head[160];
    std::snprintf(head, sizeof head, "%s; friction makes it %.1f ms later", title, lag_ms);
    return write_lines(folder / file, head, "time, s (below: the shaded part)",
                       stroke_panels(strokes, unit, value, 0.5, 0.75));
  };
  return static_cast<bool>(csv.flush()) &&
         figure("haptics_scanned_z.svg", "Height of the proxy, scanned sinusoid", "z, mm", z_ms, &Stroke::z_mm) &&
         figure("haptics_scanned_force.svg", "Force, scanned sinusoid, from free space on", "force, N", force_ms,
                &Stroke::force_n);
}

/// Figures of the default law, lags of all laws.
bool write_lags(const fs::path& work, const fs::path& folder, int nodes) {
  std::ofstream csv(folder / "haptics_lags.csv");
  csv << "law,mean_mu,lag_z_ms,lag_force_ms,plane_ms,texture_correlation,texture_gain\n";
  std::printf("%-10s %8s %10s %10s %10s\n", "law", "mean mu", "z, ms", "force, ms", "plane, ms");
  bool good = true;
  const std::vector<Eigen::Vector3d> hands = stroke_hands(true);
  for (const std::string law : {"curvature", "paper", "constant"}) {
    Progress progress;
    const auto built = pipeline::build_scene(
        config_of(work, nodes, "law: " + law + (law == "constant" ? ", mu_0: 0.5" : "")), {}, progress);
    std::vector<Stroke> strokes;
    for (const auto& [texture, friction] :
         {std::pair{false, false}, std::pair{true, false}, std::pair{true, true}, std::pair{false, true}})
      strokes.push_back(render_stroke(*window_of(*built.scene, texture, friction), hands));
    constexpr std::size_t kFirst = stroke_ticks(kStrokeApproach_s) + stroke_ticks(kStrokeSettled_s);
    const double z_ms = 1e3 * kStrokeTick_s * lag_ticks(strokes[1].z_mm, strokes[2].z_mm, kFirst);
    const double force_ms = 1e3 * kStrokeTick_s * lag_ticks(strokes[1].force_n, strokes[2].force_n, kFirst);
    const double mu = mean_mu(*window_of(*built.scene, true, true));
    const double plane_ms = 1e3 * mu * kStrokeDepth_m / stroke_speed();
    const TextureFidelity fidelity = texture_fidelity(*built.scene);
    csv << law << ',' << mu << ',' << z_ms << ',' << force_ms << ',' << plane_ms << ',' << fidelity.correlation << ','
        << fidelity.gain << '\n';
    std::printf("%-10s %8.3f %10.2f %10.2f %10.2f  texture: correlation %.4f, gain %.3f\n", law.c_str(), mu, z_ms,
                force_ms, plane_ms, fidelity.correlation, fidelity.gain);
    if (law == "curvature") good = write_strokes(folder, strokes, z_ms, force_ms);
  }
  return static_cast<bool>(csv.flush()) && good;
}

/// Generation, loading and accuracy of depth data by its nodes.
bool write_tables(const fs::path& work, const fs::path& folder) {
  std::ofstream csv(folder / "haptics_paper_tables.csv");
  csv << "nodes,points,generate_s,build_s,load_window_s,load_all_s,check_mean_mm,check_rms_mm,truth_rms_mm,"
         "proxy_mean_ns\n";
  std::printf("%-6s %10s %10s %10s %10s %10s %10s\n", "nodes", "project s", "build s", "window s", "level s",
              "truth mm", "proxy ns");
  for (const int nodes : {200, 400, 800}) {
    Progress progress;  // its stages add up
    const scene::Config config = config_of(work, nodes, "law: curvature");
    const auto built = pipeline::build_scene_folder(config, {}, work / "scene", progress);
    double generate_s = 0.0;
    for (const StageTime& stage : built.report.stages)
      if (stage.name == "project") generate_s = stage.seconds;
    Clock::time_point began = Clock::now();
    const auto near = scene::open_scene(work / "scene");
    haptics::WindowPlan plan = haptics::plan_window(near->description(), haptics::ZoomStep{0, 200}, {0.5, 0.5}, 0.1);
    static_cast<void>(haptics::load_window(*near, plan, 1));
    const double window_s = seconds_since(began);
    began = Clock::now();
    const haptics::SurfacePointer surface = window_of(*scene::open_scene(work / "scene"), true, true);
    const double level_s = seconds_since(began);
    const scene::Layers layers = near->read_level(0);
    double squares = 0.0;
    std::size_t count = 0;
    for (int j = 0; j < layers.grid.lattice.ny; ++j)
      for (int i = 0; i < layers.grid.lattice.nx; ++i) {
        const std::size_t k = layers.grid.lattice.index(i, j);
        if (layers.grid.state[k] != scene::NodeState::measured) continue;
        const double x = layers.grid.lattice.x_m(i), y = layers.grid.lattice.y_m(j);
        const double z = static_cast<double>(layers.grid.height_m[k]) + layers.grid.lattice.origin_m.z();
        squares += std::pow(z - stroke_envelope(x, y) - stroke_texture(x, y), 2);
        ++count;
      }
    const std::vector<Eigen::Vector3d> hands = stroke_hands(true);
    double best_ns = 1e18;
    for (int run = 0; run < 5; ++run) {
      began = Clock::now();
      static_cast<void>(render_stroke(*surface, hands));
      best_ns = std::min(best_ns, 1e9 * seconds_since(began) / static_cast<double>(hands.size()));
    }
    const double rms_mm = 1e3 * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, count)));
    const auto& check = built.report.check;
    csv << nodes << ',' << built.report.points.read << ',' << generate_s << ',' << built.report.total_seconds << ','
        << window_s << ',' << level_s << ',' << (check ? 1e3 * check->cloud_to_surface.mean_m : 0.0) << ','
        << (check ? 1e3 * check->cloud_to_surface.rms_m : 0.0) << ',' << rms_mm << ',' << best_ns << '\n';
    std::printf("%-6d %10.4f %10.3f %10.5f %10.5f %10.4f %10.0f\n", nodes, generate_s, built.report.total_seconds,
                window_s, level_s, rms_mm, best_ns);
  }
  return static_cast<bool>(csv.flush());
}

}  // namespace

bool write_scanned(const fs::path& folder, bool quick) {
  const fs::path work = folder / "bench_haptics-scan";
  fs::create_directories(work);
  const int nodes = quick ? 400 : 800;
  write_scan(work / "scan.ply", static_cast<std::size_t>(kPerNode * nodes * nodes));
  const bool good = write_lags(work, folder, nodes) && write_tables(work, folder);
  fs::remove_all(work);
  return good;
}

}  // namespace sparsha::bench

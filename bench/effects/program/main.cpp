// bench_effects: laws of friction and ways to render texture, ours and other people's. Writes friction.csv and
// texture.csv.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "bench/effects/friction_trials.h"
#include "bench/effects/texture.h"

namespace sparsha::bench {
namespace {

bool write_friction(const std::filesystem::path& file) {
  std::ofstream csv(file);
  csv << "method,source,slide_error,angle_deg,break_error,drift_m,chatter,slow_error,period_s,period_true_s,"
         "tick_p50_ns,tick_p99_ns,ratio,ratio_low,ratio_high\n";
  std::printf("%-18s %9s %9s %9s %9s %9s %9s %8s\n", "friction", "slide", "angle", "break", "drift um", "chatter",
              "period s", "ns");
  for (const FrictionRow& r : friction_rows()) {
    csv << r.law << ",\"" << r.source << "\"," << r.slide_error << ',' << r.angle_deg << ',' << r.break_error << ','
        << r.drift_m << ',' << r.chatter << ',' << r.slow_error << ',' << r.period_s << ',' << r.period_true_s << ','
        << r.tick_p50_ns << ',' << r.tick_p99_ns << ',' << r.ratio << ',' << r.ratio_low << ',' << r.ratio_high << '\n';
    std::printf("%-18s %8.2f%% %8.3f° %8.2f%% %9.3g %8.2f%% %9.3f %8.1f\n", r.law.c_str(), 100.0 * r.slide_error,
                r.angle_deg, 100.0 * r.break_error, 1e6 * r.drift_m, 100.0 * r.chatter, r.period_s, r.tick_p50_ns);
  }
  return static_cast<bool>(csv.flush());
}

bool write_texture(const std::filesystem::path& file) {
  std::ofstream csv(file);
  csv << "method,setting,source,gain_low,coherence_low,gain_middle,coherence_middle,gain_high,coherence_high,"
         "spectrum_error,lateral,force_error,numbers,tick_p50_ns,tick_p99_ns,ratio,"
         "ratio_low,ratio_high\n";
  std::printf("\n%-10s %-28s %9s %9s %9s %8s\n", "texture", "setting", "spectrum", "lateral", "force", "ns");
  for (const TextureRow& r : texture_rows()) {
    csv << r.method << ",\"" << r.setting << "\",\"" << r.source << '"';
    for (int band = 0; band < 3; ++band) csv << ',' << r.gain[band] << ',' << r.coherence[band];
    csv << ',' << r.spectrum_error << ',' << r.lateral << ',' << r.force_error << ',' << r.numbers << ','
        << r.tick_p50_ns << ',' << r.tick_p99_ns << ',' << r.ratio << ',' << r.ratio_low << ',' << r.ratio_high << '\n';
    std::printf("%-10s %-28s %8.2f%% %9.3f %8.2f%% %8.1f\n", r.method.c_str(), r.setting.c_str(),
                100.0 * r.spectrum_error, r.lateral, 100.0 * r.force_error, r.tick_p50_ns);
  }
  return static_cast<bool>(csv.flush());
}

}  // namespace
}  // namespace sparsha::bench

int main(int argc, char** argv) {
  std::filesystem::path out = ".";
  for (int k = 1; k + 1 < argc; k += 2)
    if (std::strcmp(argv[k], "--out") == 0) out = argv[k + 1];
  std::filesystem::create_directories(out);
  const bool friction = sparsha::bench::write_friction(out / "friction.csv");
  return sparsha::bench::write_texture(out / "texture.csv") && friction ? 0 : 1;
}

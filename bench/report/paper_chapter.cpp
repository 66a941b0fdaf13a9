// The source paper's validation again.
#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {

std::string paper_html(const std::filesystem::path& folder) {
  std::string html =
      html_figure(folder / "haptics_scanned_z.svg",
                  "Height of the proxy against time: without effects, with texture, with texture and friction, with "
                  "friction alone. Below the shaded part.") +
      html_figure(folder / "haptics_scanned_force.svg", "Force at the hand against time, likewise; 0 in free space.");
  html += html_of(folder / "haptics_lags.csv", "Lag that friction adds, by cross-correlation",
                  {{"law", "law of friction"},
                   {"mean_mu", "mean coefficient"},
                   {"lag_z_ms", "lag of z, ms"},
                   {"lag_force_ms", "lag of the force, ms"},
                   {"plane_ms", "mean coefficient × depth / speed, ms"},
                   {"texture_correlation", "texture: correlation with the true grain"},
                   {"texture_gain", "texture: gain"}});
  html +=
      html_of(folder / "haptics_paper_tables.csv", "Generation, loading and accuracy of the depth data, this machine",
              {{"nodes", "nodes per side"},
               {"points", "points"},
               {"generate_s", "heights from points, s"},
               {"build_s", "whole build, s"},
               {"load_window_s", "open and load 200 × 200, s"},
               {"load_all_s", "open and load all, s"},
               {"check_mean_mm", "points to surface, mean, mm"},
               {"check_rms_mm", "RMS, mm"},
               {"truth_rms_mm", "surface to truth, RMS, mm"},
               {"proxy_mean_ns", "proxy update, mean, ns"}});
  if (html.empty()) return {};
  return html_heading("The source paper's validation") +
         "<p>A scan of z = 0.05 sin 2πx sin 2πy with grains of up to 0.9 mm (noise 0.2 mm, points at random) goes "
         "through the pipeline: projection, bilateral filter (12 mm, 3 mm) for the texture, curvature for the friction "
         "map, a window at a tenth of its size. The hand begins 10 mm above, comes down through free space in 0.1 s "
         "and "
         "strokes 4 mm under the untextured surface at 0.45 m/s. The paper (arXiv 2010.02015) states 0.5 s to generate "
         "and 0.02 s to load 800 × 800 depth data and 5.6 µs for an update, on a processor of 2.66 GHz; its surfaces "
         "and ours differ, so orders of magnitude compare, not digits. docs/measure/accuracy.md lists where the paper "
         "contradicts itself and what Sparsha does.</p>" +
         html;
}

}  // namespace sparsha::bench

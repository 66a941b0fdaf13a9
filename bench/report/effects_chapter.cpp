// Friction and texture.
#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {

std::string effects_html(const std::filesystem::path& folder) {
  std::string html;
  const std::string friction = html_of(folder / "friction.csv", "Laws of friction on one plane, one press and one hand",
                                       {{"method", "law"},
                                        {"slide_error", "force while sliding, off by %", 100.0, 7.0},
                                        {"angle_deg", "direction, off by °", 1.0, 5.0},
                                        {"break_error", "force at the break, off by %", 100.0, 7.0},
                                        {"drift_m", "creep in 9 s when held, µm", 1e6, 10.0},
                                        {"chatter", "chatter at 2 mm/s, % of the force", 100.0, 7.0},
                                        {"slow_error", "force at 2 mm/s, off by %", 100.0, 7.0},
                                        {"period_s", "stick-slip period, s"},
                                        {"period_true_s", "period in continuous time, s"},
                                        {"tick_p50_ns", "update, median, ns"},
                                        {"tick_p99_ns", "update, 99 %, ns"},
                                        {"ratio", "time over ours"},
                                        {"ratio_low", "least"},
                                        {"ratio_high", "greatest"},
                                        {"source", "source"}});
  if (!friction.empty())
    html += html_heading("Friction") +
            "<p>Seven laws as an impedance device renders them: place of the hand and press in, force along the plane "
            "out, 1 kHz, 800 N/m, coefficients 0.5 at rest and 0.4 in motion, 2 N of press. <em>Creep</em>: the hand "
            "is held at half of what slides while it and the press tremble; what holds must not move. "
            "<em>Chatter</em>: standard deviation of the force of a slow stroke on encoder steps of 58 µm, a Falcon's. "
            "<em>Stick-slip</em>: a mass of 0.1 kg drawn by a spring at 10 mm/s, beside the period of Coulomb's law "
            "integrated in steps of 2 µs; 0: none. Laws with one coefficient have no stick-slip and are judged by the "
            "one in motion.</p>" +
            friction;
  const std::string texture =
      html_of(folder / "texture.csv", "Ways to render texture against the spectrum of the true profile",
              {{"method", "method"},
               {"setting", "setting"},
               {"gain_low", "gain, 33 to 10 mm"},
               {"gain_middle", "gain, 10 to 3.3 mm"},
               {"gain_high", "gain, 3.3 to 0.9 mm"},
               {"coherence_low", "in phase, 33 to 10 mm"},
               {"coherence_middle", "in phase, 10 to 3.3 mm"},
               {"coherence_high", "in phase, 3.3 to 0.9 mm"},
               {"spectrum_error", "spectrum, off by %", 100.0},
               {"lateral", "force along the stroke, of the true one"},
               {"force_error", "force, off by % of its variation", 100.0},
               {"numbers", "numbers kept"},
               {"tick_p50_ns", "tick, median, ns"},
               {"tick_p99_ns", "tick, 99 %, ns"},
               {"ratio", "time over geometry's"},
               {"ratio_low", "least"},
               {"ratio_high", "greatest"},
               {"source", "source"}});
  if (!texture.empty())
    html +=
        html_heading("Texture") +
        "<p>A rough profile (waves of 1 to 30 mm, 0.05 mm RMS) is stroked at 100 mm/s, 0.5 mm deep. The truth is the "
        "spring to the nearest point of the profile itself; <em>gain</em> is the amplitude of the rendered normal "
        "force over the true one, <em>in phase</em> the share of it that follows the truth. <code>geometry</code> "
        "is what Sparsha does: the heights themselves are touched, and texture is a part of them. The others add a "
        "force to a smooth surface; they push along the normal only, so that they lack most of the force along the "
        "stroke. <code>wavelet</code> puts its profile together before the stroke, which its time leaves out, and then "
        "looks it up.</p>" +
        texture;
  return html;
}

}  // namespace sparsha::bench

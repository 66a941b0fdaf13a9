// Whole objects.
#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {

std::string objects_html(const std::filesystem::path& folder) {
  const std::string table =
      html_of(folder / "haptics_objects.csv", "A tick on whole objects: time, error, what is lost",
              {{"method", "method"},
               {"object", "on"},
               {"p50_ns", "median, ns"},
               {"p99_ns", "99 %, ns"},
               {"force_error_mean", "force, off by %", 100.0, 7.0},
               {"direction_error_deg", "direction, off by °", 1.0, 5.0},
               {"lost", "ticks lost, %", 100.0, 0.01},
               {"measured", "measured"}});
  if (table.empty()) return {};
  return html_heading("Whole objects") +
         "<p>A hand wanders over clouds of known objects with noise of 0.1 spacings, outside and up to four spacings "
         "deep, at 0.01 to 2 spacings a tick; a god-object in small steps on the exact distance says what it should "
         "feel. Rows of CHAI3D 3.3 were measured before, on meshes of a relief and at another hour, and are not run "
         "here: they say what its proxy takes on meshes of such a size, whatever their form. Empty: not measured.</p>" +
         table;
}

}  // namespace sparsha::bench

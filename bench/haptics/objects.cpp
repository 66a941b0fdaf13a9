#include "bench/haptics/objects.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/wandering_hand.h"

namespace sparsha::bench {
namespace {

struct Row {
  std::string method, object;
  double p50_ns, p99_ns, force_error, turn_deg;
  double lost;  ///< share of ticks that came through, were let go or had no contact where there is some
  const char* measured;
};

/// CHAI3D 3.3 at its best settings (EPS 1e-5, radius 0), slow path over a sinusoid, 200 x 200 and 800 x 800 quads; its
/// point-cloud mode on 640 000 points. It touches meshes of whole objects by the same proxy.
const std::array kKnown{
    Row{"CHAI3D", "relief, 200 x 200 quads", 480.0, 1400.0, 0.017, -1.0, -1.0, "before"},
    Row{"CHAI3D", "relief, 800 x 800 quads", 1450.0, 36000.0, 0.018, -1.0, -1.0, "before"},
    Row{"CHAI3D, full speed", "relief", -1.0, -1.0, -1.0, -1.0, 0.13, "before, the least of 0.13 to 0.7"},
    Row{"CHAI3D, points", "640 000 points", 1700.0, -1.0, 0.27, 15.0, -1.0, "before"},
};

Row measured(const test::Touched& on, haptics::CellShape shape, std::size_t ticks) {
  const test::Outcome o = test::wander(on, ticks, 4.0, 7, {.shape = shape});
  const double lost = static_cast<double>(o.through + o.released) / static_cast<double>(o.ticks);
  return {shape == haptics::CellShape::rounded ? "around, rounded" : "around, bilinear",
          on.name,
          o.ns_median,
          o.ns_p99,
          o.force_error,
          o.turn_deg,
          lost,
          "now"};
}

/// What was not measured is empty.
std::string field(double value) {
  if (value < 0.0) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

bool write_objects(const std::filesystem::path& out, bool quick) {
  std::vector<Row> rows;
  const std::size_t ticks = quick ? 6'000 : 40'000;
  for (const auto shape : {haptics::CellShape::bilinear, haptics::CellShape::rounded}) {
    rows.push_back(measured(test::touched("torus, 20 000 points", test::make_torus()), shape, ticks));
    rows.push_back(measured(test::touched("two spheres, 20 000 points", test::make_two_spheres()), shape, ticks));
    rows.push_back(measured(test::touched("knot of a tube, 100 000 points", test::make_knot(), 100'000), shape, ticks));
  }
  rows.insert(rows.end(), kKnown.begin(), kKnown.end());
  std::ofstream csv(out / "haptics_objects.csv");
  csv << "method,object,p50_ns,p99_ns,force_error_mean,direction_error_deg,lost,measured\n";
  bool held = true;
  for (const Row& row : rows) {
    csv << '"' << row.method << "\",\"" << row.object << "\"," << field(row.p50_ns) << ',' << field(row.p99_ns) << ','
        << field(row.force_error) << ',' << field(row.turn_deg) << ',' << field(row.lost) << ",\"" << row.measured
        << "\"\n";
    std::printf("%-20s %-32s %8s ns %8s ns  force %8s  %6s degrees  lost %s, %s\n", row.method.c_str(),
                row.object.c_str(), field(row.p50_ns).c_str(), field(row.p99_ns).c_str(),
                field(row.force_error).c_str(), field(row.turn_deg).c_str(), field(row.lost).c_str(), row.measured);
    held = held && (std::string(row.measured) != "now" || row.lost < 1e-4);
  }
  csv << std::flush;
  return held && static_cast<bool>(csv);
}

}  // namespace sparsha::bench

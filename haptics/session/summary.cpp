#include "haptics/session/summary.h"

namespace sparsha::haptics {

void add_figures(SessionSummary& summary, const ServoFigures& servo) {
  summary.ticks = servo.ticks;
  summary.missed_ticks = servo.missed_ticks;
  summary.share_in_time = servo.share_in_time;
  summary.real_time = servo.real_time;
  summary.locked_memory = servo.locked_memory;
  summary.faults = servo.faults;
  summary.watchdog_trips = servo.watchdog_trips;
  summary.late_faults = servo.late_faults;
  summary.runaways = servo.runaways;
  summary.jumps = servo.jumps;
  summary.swap_ns_max = servo.swap_ns_max;
  summary.tick_ns_p50 = servo.tick_ns.quantile_ns(0.5);
  summary.tick_ns_p99 = servo.tick_ns.quantile_ns(0.99);
  summary.tick_ns_p999 = servo.tick_ns.quantile_ns(0.999);
  summary.tick_ns_max = servo.tick_ns.max_ns();
  summary.late_ns_max = static_cast<double>(servo.lateness.max_ns());
  summary.lateness_histogram.assign(servo.lateness.counts().begin(), servo.lateness.counts().end());
}

void add_figures(SessionSummary& summary, const RunFigures& figures) {
  summary.duration_s = figures.duration_s;
  summary.contact_s = figures.contact_s;
  summary.contacts = figures.contacts;
  summary.path_m = figures.path_m;
  summary.mean_force_n = figures.mean_force_n;
  summary.peak_force_n = figures.peak_force_n;
  summary.area_m2 = figures.area_m2;
  summary.levels = figures.levels;
  summary.unfinished = figures.unfinished;
}

}  // namespace sparsha::haptics

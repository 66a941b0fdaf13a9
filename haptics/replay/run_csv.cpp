// How a row of run.csv looks (docs/formats.md): 17 significant digits, so that reading gives back the same bits.
#include <cmath>

#include "base/text/csv.h"
#include "haptics/replay/recorder.h"

namespace sparsha::haptics {
const std::string& run_csv_header() {
  static const std::string header =
      "t_s,hip_x_m,hip_y_m,hip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,contact,level,tick_ns,"
      "device_x_m,device_y_m,device_z_m,centre_x_m,centre_y_m,centre_z_m,scale,commanded_force_x_n,"
      "commanded_force_y_n,commanded_force_z_n,surface_id,command,flags,buttons,stiffness_n_per_m,period_s,late_ns,"
      "window_i,window_j,window_nx,window_ny,workspace_m,max_force_n,slew_n_per_s,least_damping_n_s_per_m,delay_"
      "ticks,nominal_period_s,tip_radius_m,guide_x_n,guide_y_n,guide_stored_j,guide_supplied_j,turn_x,turn_y,turn_z,"
      "turn_w,undeclared_s,device_share,orientation_w,orientation_x,orientation_y,orientation_z,applied_force_x_n,"
      "applied_force_y_n,applied_force_z_n,measured_delay_s,encoder_step_m,scene,guide_z_n\n";
  return header;
}

void append_run_csv_row(std::string& text, const Record& record, const DeviceInfo& device) {
  const State& state = record.state;
  csv::append(text, state.time_s);
  csv::append(text, state.hip_m);
  csv::append(text, state.proxy_m);
  csv::append(text, state.force_n);
  csv::append(text, state.contact);
  csv::append(text, state.level);
  csv::append(text, std::round(state.tick_ns));
  csv::append(text, record.raw_device_m);
  csv::append(text, state.centre_m);
  csv::append(text, state.scale);
  csv::append(text, state.commanded_force_n);
  csv::append(text, state.surface_id);
  csv::append(text, state.command);
  csv::append(text, state.flags);
  csv::append(text, state.buttons);
  csv::append(text, state.stiffness_n_per_m);
  csv::append(text, record.period_s);
  csv::append(text, std::round(state.late_ns));
  for (const std::int64_t value : state.window) csv::append(text, value);
  csv::append(text, device.workspace_width_m);
  csv::append(text, device.limits.max_force_n);
  csv::append(text, device.limits.slew_n_per_s);
  csv::append(text, device.limits.least_damping_n_s_per_m);
  csv::append(text, static_cast<std::int64_t>(device.limits.delay_ticks));
  csv::append(text, record.nominal_period_s);
  csv::append(text, state.tip_radius_m);
  csv::append(text, state.guide_n[0]);
  csv::append(text, state.guide_n[1]);
  csv::append(text, state.guide_stored_j);
  csv::append(text, state.guide_supplied_j);
  for (const double part : state.turn) csv::append(text, part);
  csv::append(text, device.limits.undeclared_s);
  csv::append(text, record.device_share);
  for (const double part : state.orientation) csv::append(text, part);
  csv::append(text, record.applied_force_n);
  csv::append(text, record.measured_delay_s);
  csv::append(text, device.limits.encoder_step_m);
  csv::append(text, state.scene);
  csv::append(text, state.guide_n[2]);
  csv::end_row(text);
}

}  // namespace sparsha::haptics

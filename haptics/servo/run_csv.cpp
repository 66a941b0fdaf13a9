// How a row of run.csv looks (docs/formats.md): 17 significant digits, so that reading gives back the same bits.
#include <charconv>
#include <cmath>

#include "haptics/servo/recorder.h"

namespace sparsha::haptics {
namespace {

void append(std::string& text, double value) {
  char digits[40];
  const auto end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr;
  text.append(digits, end);
  text.push_back(',');
}

void append(std::string& text, std::uint64_t value) {
  char digits[24];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  text.push_back(',');
}

void append(std::string& text, std::int64_t value) {
  char digits[24];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  text.push_back(',');
}

void append(std::string& text, const std::array<double, 3>& values) {
  for (const double value : values) append(text, value);
}

}  // namespace

const std::string& run_csv_header() {
  static const std::string header =
      "t_s,hip_x_m,hip_y_m,hip_z_m,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,contact,level,tick_ns,"
      "device_x_m,device_y_m,device_z_m,centre_x_m,centre_y_m,centre_z_m,scale,commanded_force_x_n,"
      "commanded_force_y_n,commanded_force_z_n,surface_id,command,flags,buttons,stiffness_n_per_m,period_s,late_ns,"
      "window_i,window_j,window_nx,window_ny,workspace_m,max_force_n,slew_n_per_s,least_damping_n_s_per_m,delay_"
      "ticks,nominal_period_s\n";
  return header;
}

void append_run_csv_row(std::string& text, const Record& record, const DeviceInfo& device) {
  const State& state = record.state;
  append(text, state.time_s);
  append(text, state.hip_m);
  append(text, state.proxy_m);
  append(text, state.force_n);
  append(text, state.contact);
  append(text, state.level);
  append(text, std::round(state.tick_ns));
  append(text, record.raw_device_m);
  append(text, state.centre_m);
  append(text, state.scale);
  append(text, state.commanded_force_n);
  append(text, state.surface_id);
  append(text, state.command);
  append(text, state.flags);
  append(text, state.buttons);
  append(text, state.stiffness_n_per_m);
  append(text, record.period_s);
  append(text, std::round(state.late_ns));
  for (const std::int64_t value : state.window) append(text, value);
  append(text, device.workspace_width_m);
  append(text, device.limits.max_force_n);
  append(text, device.limits.slew_n_per_s);
  append(text, device.limits.least_damping_n_s_per_m);
  append(text, static_cast<std::int64_t>(device.limits.delay_ticks));
  append(text, record.nominal_period_s);
  text.back() = '\n';
}

}  // namespace sparsha::haptics

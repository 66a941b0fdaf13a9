// A device as a plug-in: built by itself, with sparsha/device_plugin.h alone, and touched with
//   sparsha explore SCENE --device plugin:./liba_device_plugin.so
// Here the device is a hand in software on a spring that goes up and down; put your driver's calls in their place.
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "sparsha/device_plugin.h"

namespace {

const double kMass_kg = 0.1, kDamping_n_s_per_m = 4.0, kSpring_n_per_m = 150.0;
double position_m[3], velocity_m_per_s[3], force_n[3];
double opened_s, read_s;

double now_s() {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

int open_device(char* problem, uint32_t problem_size) {
  // Your driver: open the device. What is wrong is told to the person.
  opened_s = read_s = now_s();
  position_m[2] = 0.02;
  if (opened_s > 0.0) return 0;
  snprintf(problem, problem_size, "the system has no clock");
  return 1;
}

int describe(sparsha_device_info* info) {
  snprintf(info->name, sizeof info->name, "a hand in a plug-in");
  info->workspace_width_m = 0.1;
  info->max_force_n = 4.0;
  info->least_damping_n_s_per_m = 2.0;
  info->slew_n_per_s = 1500.0;
  info->rate_hz = 1000.0;
  info->fastest_m_per_s = 5.0;
  info->delay_ticks = 1;
  return 0;
}

int read_device(sparsha_device_sample* sample) {
  // Your driver: the newest position and buttons. Here the time since the last call moves the hand.
  const double time_s = now_s();
  const double step_s = fmin(time_s - read_s, 0.002);
  read_s = time_s;
  const double wish_m[3] = {0.01 * sin(time_s - opened_s), 0.0, 0.005 + 0.015 * cos(3.0 * (time_s - opened_s))};
  for (int i = 0; i < 3; ++i) {
    const double pull_n = kSpring_n_per_m * (wish_m[i] - position_m[i]) - kDamping_n_s_per_m * velocity_m_per_s[i];
    velocity_m_per_s[i] += step_s * (pull_n + force_n[i]) / kMass_kg;
    position_m[i] += step_s * velocity_m_per_s[i];
  }
  memcpy(sample->position_m, position_m, sizeof position_m);
  sample->orientation[0] = 1.0;
  sample->fresh = sample->homed = sample->connected = 1;
  return 0;
}

int write_device(const double asked_n[3]) {
  memcpy(force_n, asked_n, sizeof force_n);  // your driver: the force
  return 0;
}

void zero_device(void) { memset(force_n, 0, sizeof force_n); }  // your driver: motors off, from any thread
void close_device(void) {}

}  // namespace

extern "C" const sparsha_device_plugin* sparsha_device_plugin_entry(void) {
  static const sparsha_device_plugin plugin = {SPARSHA_DEVICE_PLUGIN_VERSION,
                                               sizeof(sparsha_device_plugin),
                                               open_device,
                                               describe,
                                               read_device,
                                               write_device,
                                               zero_device,
                                               close_device};
  return &plugin;
}

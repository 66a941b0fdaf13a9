// A plug-in that does what SPARSHA_TEST_PLUGIN says, and a motor that holds its last force: words in the file that
// SPARSHA_TEST_MOTOR names, which outlive the process.
#include <fcntl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "sparsha/device_plugin.h"

namespace {

struct Motor {
  std::atomic<std::uint64_t> micronewtons, strongest, opened, closed, zeros, faults, reads;
};
Motor* motor = nullptr;

std::string fault() {
  const char* const name = std::getenv("SPARSHA_TEST_PLUGIN");
  return name == nullptr ? "" : name;
}

double now_s() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void sleep_s(double time_s) {
  timespec time{};
  time.tv_sec = static_cast<time_t>(time_s);
  time.tv_nsec = static_cast<long>(1e9 * (time_s - std::floor(time_s)));
  nanosleep(&time, nullptr);
}

/// True once it has pushed with 0.3 N, in the process that opened it first.
bool now_faulty() {
  const bool pushed = motor->strongest.load() > 300'000;
  if (pushed) motor->faults.fetch_add(1);
  return pushed && motor->opened.load() == 1;
}

int open_device(char* problem, std::uint32_t size) {
  if (fault() == "refuses") {
    std::snprintf(problem, size, "its cable is not plugged in");
    return 1;
  }
  if (fault() == "crashes-at-open") std::abort();
  const int file = ::open(std::getenv("SPARSHA_TEST_MOTOR"), O_RDWR);
  void* const page = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (page == MAP_FAILED) return 1;
  motor = static_cast<Motor*>(page);
  motor->opened.fetch_add(1);
  return 0;
}

int describe(sparsha_device_info* info) {
  std::snprintf(info->name, sizeof info->name, "%s", fault() == "odd-name" ? "no\xFF name\nerror: at all" : "faulty");
  info->workspace_width_m = fault() == "no-workspace" ? std::numeric_limits<double>::quiet_NaN() : 0.1;
  info->max_force_n = 4.0;
  info->least_damping_n_s_per_m = 2.0;
  info->slew_n_per_s = 1500.0;
  info->rate_hz = fault() == "wrong-rate" ? 4000.0 : fault() == "odd-rate" ? 50.0 : 1000.0;
  info->fastest_m_per_s = 5.0;
  info->delay_ticks = 1;
  info->encoder_step_um = 150;
  return fault() == "no-info" ? 1 : 0;
}

int read_device(sparsha_device_sample* sample) {
  const std::uint64_t reads = motor->reads.fetch_add(1);
  if (fault() == "wrong-rate" && reads % 8 != 0) return 0;  // nothing fresh
  if (now_faulty()) {
    if (fault() == "crashes") std::raise(SIGSEGV);
    if (fault() == "hangs") sleep_s(60.0);
    if (fault() == "fails") return 1;
    if (fault() == "ends") std::_Exit(0);
  }
  if (fault() == "prints") {
    std::printf("a banner\n");
    std::fflush(stdout);
  }
  const double time_s = now_s();
  // A third of a second in the air, then slowly 2 mm into the plane.
  const double phase_s = std::fmod(time_s, 1.0);
  sample->position_m[2] = phase_s < 0.3 ? 0.004 : std::max(-0.002, 0.004 - 0.05 * (phase_s - 0.3));
  if (phase_s > 0.9) sample->position_m[2] = -0.002 + 0.06 * (phase_s - 0.9);
  if (motor->faults.load() > 0 && fault() == "no-number")
    sample->position_m[1] = std::numeric_limits<double>::quiet_NaN();
  if (motor->faults.load() > 0 && fault() == "jumps") sample->position_m[0] = reads % 2 == 0 ? 0.03 : -0.03;
  if (motor->faults.load() > 0 && fault() == "stands-still") return 0;
  sample->fresh = sample->homed = sample->connected = 1;
  return 0;
}

int write_device(const double force_n[3]) {
  const double size_n = std::sqrt(force_n[0] * force_n[0] + force_n[1] * force_n[1] + force_n[2] * force_n[2]);
  const auto size = static_cast<std::uint64_t>(1e6 * size_n);
  motor->micronewtons.store(size);
  if (size > motor->strongest.load()) motor->strongest.store(size);
  if (size > 300'000 && fault() == "crashes-in-write") std::abort();
  if (size > 0 && fault() == "refuses-forces") {
    motor->faults.fetch_add(1);
    return 1;
  }
  return 0;
}

void zero_device() {
  if (motor == nullptr) return;
  motor->micronewtons.store(0);
  motor->zeros.fetch_add(1);
}
void close_device() { motor->closed.fetch_add(1); }

}  // namespace

extern "C" const sparsha_device_plugin* sparsha_device_plugin_entry(void) {
  static sparsha_device_plugin plugin = {SPARSHA_DEVICE_PLUGIN_VERSION,
                                         sizeof(sparsha_device_plugin),
                                         open_device,
                                         describe,
                                         read_device,
                                         write_device,
                                         zero_device,
                                         close_device};
  if (fault() == "wrong-version") plugin.version = 99;
  if (fault() == "no-zero") plugin.zero = nullptr;
  if (fault() == "no-table") return nullptr;
  return &plugin;
}

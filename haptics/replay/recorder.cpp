#include "haptics/replay/recorder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <span>

#include "base/error.h"

namespace sparsha::haptics {
namespace {

constexpr double kQueue_s = 8.0;
constexpr double kShortestGap_s = 0.005;  // as for contact events
constexpr std::size_t kBufferBytes = 1U << 18U;

std::uint64_t pack(std::int32_t i, std::int32_t j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32U) | static_cast<std::uint32_t>(j);
}

}  // namespace

struct Recorder::CsvFile {
  CsvFile(const std::filesystem::path& target_file, const DeviceInfo& info)
      : target(target_file), path(target_file), stream(path.temporary(), std::ios::binary), device(info) {
    if (!stream)
      throw Error(ErrorKind::failure, {target.string()}, "cannot write the recording", "a folder that can be written");
    text.reserve(kBufferBytes + 2048);
    text = run_csv_header();
  }
  void write() {
    digest.add(std::as_bytes(std::span<const char>(text)));
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  }

  std::filesystem::path target;
  AtomicPath path;
  std::ofstream stream;
  DeviceInfo device;
  std::string text;
  Sha256 digest;
};

Recorder::Recorder(const std::filesystem::path& file, const DeviceInfo& device, double rows_per_s)
    : queue_(static_cast<std::size_t>(std::max(1024.0, kQueue_s * rows_per_s))) {
  if (!file.empty()) csv_ = std::make_unique<CsvFile>(file, device);
}

Recorder::~Recorder() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

bool Recorder::push(const Record& record) noexcept {
  if (queue_.push(record)) return true;
  dropped_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

void Recorder::start() {
  thread_ = std::thread([this] { run(); });
}

void Recorder::run() {
  Record record;
  for (;;) {
    const bool last = stopping_.load(std::memory_order_acquire);
    bool any = false;
    while (queue_.pop(record)) {
      take(record);
      any = true;
    }
    if (last) return;
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void Recorder::take(const Record& record) {
  const State& state = record.state;
  ++figures_.rows;
  if (!has_last_) first_s_ = state.time_s - record.period_s;
  figures_.duration_s = state.time_s - first_s_;
  if (has_last_)
    figures_.path_m +=
        std::hypot(state.device_m[0] - last_m_[0], state.device_m[1] - last_m_[1], state.device_m[2] - last_m_[2]);
  has_last_ = true;
  last_m_ = state.device_m;
  if ((state.flags & kFlagUnfinished) != 0) ++figures_.unfinished;
  const int level = static_cast<int>(state.level);
  if (std::find(figures_.levels.begin(), figures_.levels.end(), level) == figures_.levels.end())
    figures_.levels.push_back(level);
  if (figures_.scenes.empty() || figures_.scenes.back() != state.scene) figures_.scenes.push_back(state.scene);
  const double force_n = std::hypot(state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]);
  figures_.peak_force_n = std::max(figures_.peak_force_n, force_n);
  if (state.contact != 0) {
    if (last_contact_s_ < 0.0 || state.time_s - last_contact_s_ > kShortestGap_s) ++figures_.contacts;
    last_contact_s_ = state.time_s;
    figures_.contact_s += record.period_s;
    force_time_ += force_n * record.period_s;
    touch(record);
  }
  if (csv_) {
    append_run_csv_row(csv_->text, record, csv_->device);
    if (csv_->text.size() >= kBufferBytes) csv_->write();
  }
}

// Cells count from the origin that all levels of a scene share. Another scene has cells of its own.
void Recorder::touch(const Record& record) {
  if ((record.state.flags & kFlagOutside) != 0) return;
  // The charts of a whole object have one level.
  const bool around = (record.state.flags & kFlagAround) != 0;
  const int level = around ? 0 : static_cast<int>(record.state.level);
  const double spacing_m = std::ldexp(record.cell_m, -level);
  if (spacing_m != spacing_m_) {
    figures_.area_m2 += touched_area_m2();
    touched_.clear();
    last_level_ = -1;
    spacing_m_ = spacing_m;
  }
  const std::uint64_t cell = pack(record.cell_i, record.cell_j);
  if (level != last_level_ || cell != last_cell_) touched_[level].insert(cell);
  last_level_ = level;
  last_cell_ = cell;
}

double Recorder::touched_area_m2() const {
  double area_m2 = 0.0;
  for (const auto& touched : touched_) {
    const int level = touched.first;
    std::uint64_t count = 0;
    for (const std::uint64_t cell : touched.second) {
      const auto i = static_cast<std::int32_t>(static_cast<std::uint32_t>(cell >> 32U));
      const auto j = static_cast<std::int32_t>(static_cast<std::uint32_t>(cell));
      const bool inside_coarser = std::any_of(touched_.upper_bound(level), touched_.end(), [&](const auto& coarser) {
        const int shift = coarser.first - level;
        return coarser.second.contains(pack(i >> shift, j >> shift));
      });
      if (!inside_coarser) ++count;
    }
    const double side_m = std::ldexp(spacing_m_, level);
    area_m2 += static_cast<double>(count) * side_m * side_m;
  }
  return area_m2;
}

RunFigures Recorder::finish() {
  stopping_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
  figures_.mean_force_n = figures_.contact_s > 0.0 ? force_time_ / figures_.contact_s : 0.0;
  figures_.area_m2 += touched_area_m2();
  touched_.clear();
  std::sort(figures_.levels.begin(), figures_.levels.end());
  if (csv_) {
    csv_->write();
    csv_->stream.close();
    if (!csv_->stream)
      throw Error(ErrorKind::failure, {csv_->target.string()}, "the recording could not be written whole",
                  "enough room on the disk");
    csv_->path.commit();
    sha256_ = csv_->digest.finish();
    csv_.reset();
  }
  return figures_;
}

}  // namespace sparsha::haptics

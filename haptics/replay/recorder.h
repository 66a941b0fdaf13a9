// Takes a row per tick from the servo through a bounded queue; a thread of its own counts and writes run.csv.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <unordered_set>
#include <vector>

#include "base/files/files.h"
#include "haptics/device/device.h"
#include "haptics/servo/record.h"
#include "haptics/state/spsc_queue.h"

namespace sparsha::haptics {

/// What the rows of a run add up to.
struct RunFigures {
  std::uint64_t rows = 0;
  double duration_s = 0.0;
  double contact_s = 0.0;
  std::uint64_t contacts = 0;  ///< touches; gaps shorter than 5 ms do not part them
  double path_m = 0.0;         ///< of the hand, device frame
  double mean_force_n = 0.0;   ///< commanded, while in contact
  double peak_force_n = 0.0;
  double area_m2 = 0.0;  ///< of the scene's cells touched, grid frame; a cell inside a touched coarser one counts once
  std::vector<int> levels;
  std::vector<std::uint64_t> scenes;  ///< numbers of those that were touched, in the order of their coming
  std::uint64_t unfinished = 0;
};

class Recorder final : public RecordSink {
 public:
  /// `file` empty: counts only. `rows_per_s` sizes the queue for eight seconds.
  Recorder(const std::filesystem::path& file, const DeviceInfo& device, double rows_per_s);
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Servo thread; neither waits nor allocates. False when the queue is full: the row is lost and counted.
  bool push(const Record& record) noexcept override;
  [[nodiscard]] std::uint64_t dropped() const noexcept override { return dropped_.load(std::memory_order_relaxed); }

  void start();
  /// Takes the rest of the rows and puts the file in its place. Throws Error{failure} when it could not be written.
  RunFigures finish();
  /// SHA-256 of the file that finish() has put in its place; empty without one.
  [[nodiscard]] const std::string& sha256() const noexcept { return sha256_; }
  /// After finish(), also one that threw.
  [[nodiscard]] const RunFigures& figures() const noexcept { return figures_; }

 private:
  struct CsvFile;
  void run();
  void take(const Record& record);
  void touch(const Record& record);
  [[nodiscard]] double touched_area_m2() const;

  SpscQueue<Record> queue_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
  std::unique_ptr<CsvFile> csv_;
  std::string sha256_;
  RunFigures figures_;
  double spacing_m_ = 0.0;   // level 0 of the scene that is being touched
  double force_time_ = 0.0;  // N s
  bool has_last_ = false;
  double last_contact_s_ = -1.0;
  double first_s_ = 0.0;
  std::array<double, 3> last_m_{};
  std::map<int, std::unordered_set<std::uint64_t>> touched_;  // cells by level
  std::uint64_t last_cell_ = 0;
  int last_level_ = -1;
};

/// The header of run.csv and one row of it, for tests and tools.
[[nodiscard]] const std::string& run_csv_header();
void append_run_csv_row(std::string& text, const Record& record, const DeviceInfo& device);

}  // namespace sparsha::haptics

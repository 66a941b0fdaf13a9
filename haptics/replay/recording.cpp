#include "haptics/replay/recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files/files.h"
#include "base/numbers/statistics.h"
#include "base/text/csv.h"
#include "haptics/state/state.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

enum Column : std::size_t {
  kTime,
  kX,
  kY,
  kZ,
  kButtons,
  kCentreX,
  kCentreY,
  kCentreZ,
  kScale,
  kSurface,
  kCommand,
  kFlags,
  kLevel,
  kStiffness,
  kPeriod,
  kWindowI,
  kWindowJ,
  kWindowNx,
  kWindowNy,
  kWorkspace,
  kMaxForce,
  kSlew,
  kDamping,
  kDelay,
  kNominalPeriod,
  kTipRadius,
  kGuideX,
  kGuideY,
  kGuideZ,
  kGuideStored,
  kGuideSupplied,
  kScene,
  kTurnX,
  kTurnY,
  kTurnZ,
  kTurnW,
  kUndeclared,
  kOrientationW,
  kOrientationX,
  kOrientationY,
  kOrientationZ,
  kMeasuredDelay,
  kEncoderStep,
  kShare,
  kAppliedX,
  kAppliedY,
  kAppliedZ,
  kColumns
};
constexpr std::array<std::string_view, kColumns> kNames = {"t_s",
                                                           "device_x_m",
                                                           "device_y_m",
                                                           "device_z_m",
                                                           "buttons",
                                                           "centre_x_m",
                                                           "centre_y_m",
                                                           "centre_z_m",
                                                           "scale",
                                                           "surface_id",
                                                           "command",
                                                           "flags",
                                                           "level",
                                                           "stiffness_n_per_m",
                                                           "period_s",
                                                           "window_i",
                                                           "window_j",
                                                           "window_nx",
                                                           "window_ny",
                                                           "workspace_m",
                                                           "max_force_n",
                                                           "slew_n_per_s",
                                                           "least_damping_n_s_per_m",
                                                           "delay_ticks",
                                                           "nominal_period_s",
                                                           "tip_radius_m",
                                                           "guide_x_n",
                                                           "guide_y_n",
                                                           "guide_z_n",
                                                           "guide_stored_j",
                                                           "guide_supplied_j",
                                                           "scene",
                                                           "turn_x",
                                                           "turn_y",
                                                           "turn_z",
                                                           "turn_w",
                                                           "undeclared_s",
                                                           "orientation_w",
                                                           "orientation_x",
                                                           "orientation_y",
                                                           "orientation_z",
                                                           "measured_delay_s",
                                                           "encoder_step_m",
                                                           "device_share",
                                                           "applied_force_x_n",
                                                           "applied_force_y_n",
                                                           "applied_force_z_n"};

constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

// Where each known column stands in the file.
std::array<std::size_t, kColumns> find_columns(const std::string& file, std::string_view header, std::size_t& count) {
  std::array<std::size_t, kColumns> place;
  place.fill(kAbsent);
  count = 0;
  while (!header.empty()) {
    const std::string_view name = csv::trimmed(csv::take_field(header));
    const auto known = std::find(kNames.begin(), kNames.end(), name);
    if (known != kNames.end()) place[static_cast<std::size_t>(known - kNames.begin())] = count;
    ++count;
  }
  for (const Column column : {kTime, kX, kY, kZ})
    if (place[column] == kAbsent)
      throw input_error_at(file, 1, "no column " + std::string(kNames[column]),
                           "a run.csv as `explore --record` writes it");
  return place;
}

// Reads as many numbers as there are fields; what is wrong with the line, or nothing.
std::string read_fields(std::string_view line, std::vector<double>& fields) {
  for (double& value : fields) {
    const std::string_view field = csv::take_field(line);
    if (!csv::to_number(field, value)) return csv::in_quotes(field) + " is not a number";
  }
  return line.empty() ? "" : "more fields than the header names";
}

/// What a column may hold; `whole` numbers only where so said.
struct Range {
  double low, high;
  bool whole = false;
};

// The device's own position may be what a broken device gave: the servo judges it.
constexpr Range range_of(Column column) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  constexpr double kLeast = std::numeric_limits<double>::min();
  switch (column) {
    case kX:
    case kY:
    case kZ:
      return {-kAny, kAny};
    case kTime:
    case kCentreX:
    case kCentreY:
    case kCentreZ:
      return {-1e9, 1e9};
    case kScale:
      return {1e-9, 1e9};
    case kButtons:
    case kSurface:
    case kCommand:
    case kFlags:
      return {0.0, 0x1p62, true};
    case kLevel:
      return {0.0, 64.0, true};
    case kWindowI:
    case kWindowJ:
    case kWindowNx:
    case kWindowNy:
      return {-1e9, 1e9, true};
    case kStiffness:
      return {0.0, 1e5};
    case kPeriod:
      return {kLeast, 1e9};
    case kNominalPeriod:
      return {1e-5, 1.0};
    case kTipRadius:
      return {0.0, 0.1};
    case kScene:
      return {1.0, 1e9, true};
    case kGuideX:
    case kGuideY:
    case kGuideZ:
      return {-100.0, 100.0};
    case kGuideStored:
    case kGuideSupplied:
      return {-1e3, 1e3};
    case kTurnX:
    case kTurnY:
    case kTurnZ:
    case kTurnW:
    case kOrientationW:
    case kOrientationX:
    case kOrientationY:
    case kOrientationZ:
      return {-1.0, 1.0};
    case kWorkspace:
      return {1e-3, 10.0};
    case kMaxForce:
      return {0.0, 100.0};
    case kSlew:
      return {kLeast, 1e6};
    case kDamping:
      return {0.0, 100.0};
    case kDelay:
      return {0.0, kLongestDelayTicks, true};
    case kUndeclared:
    case kMeasuredDelay:
    case kEncoderStep:
    case kShare:
      return {0.0, 1.0};
    case kAppliedX:
    case kAppliedY:
    case kAppliedZ:
      return {-kAny, kAny};
    case kColumns:
      break;
  }
  return {0.0, 0.0};
}

/// The fields of one line by their columns.
class Fields {
 public:
  Fields(const std::array<std::size_t, kColumns>& place, const std::vector<double>& values)
      : place_(place), values_(values) {}
  /// `otherwise` where the file has no such column.
  [[nodiscard]] double at(Column column, double otherwise) const {
    return place_[column] == kAbsent ? otherwise : values_[place_[column]];
  }
  [[nodiscard]] std::uint64_t word(Column column, double otherwise = 0.0) const {
    return static_cast<std::uint64_t>(at(column, otherwise));
  }
  [[nodiscard]] int whole(Column column) const { return static_cast<int>(at(column, 0.0)); }

 private:
  const std::array<std::size_t, kColumns>& place_;
  const std::vector<double>& values_;
};

Eigen::Quaterniond turn_of(const Fields& fields) {
  return {fields.at(kTurnW, 1.0), fields.at(kTurnX, 0.0), fields.at(kTurnY, 0.0), fields.at(kTurnZ, 0.0)};
}

std::string wrong_value(const std::array<std::size_t, kColumns>& place, const std::vector<double>& fields) {
  for (std::size_t column = 0; column < kColumns; ++column) {
    if (place[column] == kAbsent || column == kX || column == kY || column == kZ) continue;
    const double value = fields[place[column]];
    const Range range = range_of(static_cast<Column>(column));
    if (value >= range.low && value <= range.high && (!range.whole || value == std::floor(value))) continue;
    return "an impossible " + std::string(kNames[column]);
  }
  constexpr double kUnit = 1e-9;
  const Eigen::Quaterniond turn = turn_of({place, fields});
  if (!(std::abs(turn.norm() - 1.0) <= kUnit)) return "a turn that is no rotation";
  return "";
}

bool has_windows(const std::array<std::size_t, kColumns>& place) {
  const bool has_ticks =
      std::all_of(place.begin() + kCentreX, place.begin() + kWindowI, [](std::size_t at) { return at != kAbsent; });
  return has_ticks && std::all_of(place.begin() + kWindowI, place.begin() + kWorkspace,
                                  [](std::size_t at) { return at != kAbsent; });
}

RecordedRow row_of(const Fields& fields) {
  RecordedRow row;
  row.time_s = fields.at(kTime, 0.0);
  row.position_m = {fields.at(kX, 0.0), fields.at(kY, 0.0), fields.at(kZ, 0.0)};
  row.buttons = fields.word(kButtons);
  row.tick.centre_m = {fields.at(kCentreX, 0.0), fields.at(kCentreY, 0.0), fields.at(kCentreZ, 0.0)};
  row.tick.stiffness_n_per_m = fields.at(kStiffness, 0.0);
  row.tick.period_s = fields.at(kPeriod, 0.001);
  row.tick.nominal_period_s = fields.at(kNominalPeriod, 0.0);
  row.tick.command = fields.word(kCommand);
  row.delay_s = fields.at(kMeasuredDelay, 0.0);
  row.force_share = fields.at(kShare, 1.0);
  constexpr double kUntold = std::numeric_limits<double>::quiet_NaN();
  row.applied_n = {fields.at(kAppliedX, kUntold), fields.at(kAppliedY, kUntold), fields.at(kAppliedZ, kUntold)};
  row.tick.guide_n = {fields.at(kGuideX, 0.0), fields.at(kGuideY, 0.0), fields.at(kGuideZ, 0.0)};
  row.tick.guide_stored_j = fields.at(kGuideStored, 0.0);
  row.tick.guide_supplied_j = fields.at(kGuideSupplied, 0.0);
  row.orientation = {fields.at(kOrientationW, 0.0), fields.at(kOrientationX, 0.0), fields.at(kOrientationY, 0.0),
                     fields.at(kOrientationZ, 0.0)};
  row.tick.turn = turn_of(fields);
  row.tick.flags = fields.word(kFlags, static_cast<double>(kFlagHomed));
  return row;
}

/// The window that a row begins, all but the row's number.
RecordedWindow window_of(const Fields& fields, std::uint64_t flags) {
  RecordedWindow window;
  window.surface_id = fields.word(kSurface);
  window.scene = fields.word(kScene, 1.0);
  window.plan.level = fields.whole(kLevel);
  window.plan.i0 = fields.whole(kWindowI);
  window.plan.j0 = fields.whole(kWindowJ);
  window.plan.nx = fields.whole(kWindowNx);
  window.plan.ny = fields.whole(kWindowNy);
  window.plan.scale = fields.at(kScale, 1.0);
  window.plan.tip_radius_m = fields.at(kTipRadius, 0.0);
  window.plan.effects.texture = (flags & kFlagTexture) != 0;
  window.plan.effects.friction = (flags & kFlagFriction) != 0;
  window.plan.impact = (flags & kFlagImpact) != 0;
  window.plan.around = (flags & kFlagAround) != 0;
  window.plan.grain = (flags & kFlagGrain) != 0;
  window.plan.cues = (flags & kFlagCues) != 0;
  window.plan.beyond = scene::beyond_of((flags & kFlagFalls) != 0, (flags & kFlagRim) != 0);
  return window;
}

DeviceLimits recorded_limits(const Fields& fields) {
  DeviceLimits recorded;
  recorded.max_force_n = fields.at(kMaxForce, recorded.max_force_n);
  recorded.slew_n_per_s = fields.at(kSlew, recorded.slew_n_per_s);
  recorded.least_damping_n_s_per_m = fields.at(kDamping, recorded.least_damping_n_s_per_m);
  recorded.delay_ticks = static_cast<int>(fields.at(kDelay, recorded.delay_ticks));
  recorded.undeclared_s = fields.at(kUndeclared, 0.0);  // before there was such a column, none was assumed
  recorded.encoder_step_m = fields.at(kEncoderStep, recorded.encoder_step_m);
  return recorded;
}

/// The weaker of what the recorded device had and of playback's own limits.
DeviceLimits limits_of(const DeviceLimits& recorded, bool& limited) {
  const DeviceLimits own;
  DeviceLimits result = recorded;
  result.max_force_n = std::min(recorded.max_force_n, own.max_force_n);
  result.slew_n_per_s = std::min(recorded.slew_n_per_s, own.slew_n_per_s);
  limited = result.max_force_n < recorded.max_force_n || result.slew_n_per_s < recorded.slew_n_per_s;
  return usable(result);
}

double commonest_step(const std::vector<RecordedRow>& rows) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size() && steps.size() < 1000; ++i)
    steps.push_back(rows[i].time_s - rows[i - 1].time_s);
  if (steps.empty()) return 0.001;
  const double step = median(steps);
  return step > 0.0 ? step : 0.001;
}

}  // namespace

Recording::Recording(const std::filesystem::path& file) : file_(file) {
  const MappedFile mapped(file);
  std::string_view text = mapped.text();
  const bool ends_whole = text.ends_with('\n');
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::string name = file.string();
  std::size_t count = 0;
  const auto place = find_columns(name, csv::take_line(text), count);
  const bool windows = has_windows(place);
  std::vector<double> fields(count);
  int line_number = 1;
  while (!text.empty()) {
    const std::string_view line = csv::take_line(text);
    ++line_number;
    if (line.empty()) continue;
    std::string wrong = read_fields(line, fields);
    if (!wrong.empty() && text.empty() && !ends_whole && !rows_.empty()) {
      cut_short_ = true;
      break;
    }
    if (wrong.empty()) wrong = wrong_value(place, fields);
    if (!wrong.empty())
      throw input_error_at(name, line_number, wrong,
                           std::to_string(count) + " numbers as `explore --record` writes them");
    const Fields columns(place, fields);
    const RecordedRow row = row_of(columns);
    if (!rows_.empty() && !(row.time_s > rows_.back().time_s))
      throw input_error_at(name, line_number, "time does not increase", "t_s above that of the row before");
    if (windows && (windows_.empty() || windows_.back().surface_id != columns.word(kSurface) ||
                    windows_.back().scene != columns.word(kScene, 1.0))) {
      windows_.push_back(window_of(columns, row.tick.flags));
      windows_.back().row = rows_.size();
    }
    if (rows_.empty()) {
      info_.name = "playback";
      info_.workspace_width_m = columns.at(kWorkspace, info_.workspace_width_m);
      info_.limits = limits_of(recorded_limits(columns), limited_);
    }
    rows_.push_back(row);
  }
  mapped.require_whole();
  if (rows_.empty())
    throw input_error_at(name, line_number, "the recording has no rows", "at least one row below the header");
  if (place[kNominalPeriod] != kAbsent) {
    period_s_ = rows_.front().tick.nominal_period_s;
  } else {
    period_s_ = commonest_step(rows_);
    for (RecordedRow& row : rows_) row.tick.nominal_period_s = period_s_;
  }
}

HapticWindow load_recorded(const scene::Scene& scene, const RecordedWindow& recorded) {
  HapticWindow window = load_window(scene, recorded.plan, recorded.surface_id);
  window.scene = recorded.scene;
  return window;
}

}  // namespace sparsha::haptics

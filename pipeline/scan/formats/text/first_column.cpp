// A surface has many points of one x, and its points lie beside the ones before them.
#include "pipeline/scan/formats/text/first_column.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/numbers/hash.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kFewest = 16;
constexpr std::uint64_t kFewestUnordered = 100;
constexpr std::size_t kMostValues = 4096;

}  // namespace

void FirstColumn::step(double x, double y, double z) {
  const double dx = x - last_x_;
  if (rows_ == 1) first_step_ = dx;
  rising_ = rising_ && dx > 0.0;
  falls_ += dx < 0.0 ? 1 : 0;
  constexpr double kLike = 0.1;
  even_ += std::abs(dx - first_step_) <= kLike * std::abs(first_step_) ? 1 : 0;
  y_.way += std::abs(y - last_y_);
  z_.way += std::abs(z - last_z_);
}

void FirstColumn::count_value(double x) {
  const auto value = static_cast<std::int64_t>(x);
  const auto key = [](std::int64_t v) { return hash_word(static_cast<std::uint64_t>(v)); };
  if (key(value) > threshold_) return;
  ++values_[value];
  while (values_.size() > kMostValues) {
    threshold_ /= 2;
    std::erase_if(values_, [&](const auto& entry) { return key(entry.first) > threshold_; });
  }
}

bool FirstColumn::is_number() const {
  if (!whole_ || rows_ < kFewest || !(x_.size() > 0.0)) return false;
  if (rising_) return true;
  // In another order: whole numbers that were drawn at random would repeat.
  constexpr double kRepeats = 10.0;
  const auto rows = static_cast<double>(rows_);
  const bool would_repeat = rows * rows / (2.0 * (x_.size() + 1.0)) >= kRepeats;
  const bool none_does =
      std::all_of(values_.begin(), values_.end(), [](const auto& entry) { return entry.second == 1; });
  return rows_ >= kFewestUnordered && !rest_whole_ && would_repeat && none_does && x_.size() + 1.0 >= rows;
}

// A number of the scan, a class: with it as x, all points would lie in a plane. It has three columns behind it.
bool FirstColumn::is_constant() const {
  return whole_ && rows_ >= kFewest && any_next_ && !(x_.size() > 0.0) && y_.size() > 0.0 && z_.size() > 0.0;
}

// Numbers of scans, rings or classes: few, before three columns of fractions.
bool FirstColumn::is_group() const {
  constexpr double kMostGroups = 64.0;
  constexpr double kMostly = 0.9;
  constexpr double kMostInOrder = 8.0;  // profiles in their order are more
  if (falls_ == 0 && x_.size() >= kMostInOrder) return false;
  return whole_ && rows_ >= kFewestUnordered && x_.size() > 0.0 && x_.size() < kMostGroups &&
         static_cast<double>(fractions_) >= kMostly * static_cast<double>(rows_);
}

// A time has three columns behind it.
bool FirstColumn::is_even_time() const {
  constexpr double kEven = 0.95;
  constexpr double kToAndFro = 4.0;  // sizes of the scan that its points go
  const auto steps = static_cast<double>(rows_ - 1);
  const auto wanders = [&](const Range& range) { return range.way > kToAndFro * range.size() && range.size() > 0.0; };
  return any_next_ && rows_ >= kFewestUnordered && rising_ && static_cast<double>(even_) >= kEven * steps &&
         (wanders(y_) || wanders(z_)) && !time_.is_profile_or_lattice();
}

bool FirstColumn::is_time() const { return any_next_ && rows_ >= kFewestUnordered && falls_ == 0 && time_.sweeps(); }

bool FirstColumn::is_angle() const {
  constexpr double kEven = 0.95;
  constexpr std::uint64_t kSweeps = 3;
  constexpr double kTurn = 6.283185307179586;
  if (rows_ < kFewestUnordered || falls_ < kSweeps || !(first_step_ > 0.0)) return false;
  const bool picture = whole_ && x_.low == 0.0;  // as columns of a picture are counted
  const auto steps = static_cast<double>(rows_ - 1);
  const double span = x_.size() + first_step_;
  const bool turn = std::abs(span - 360.0) <= 0.5 * first_step_ || std::abs(span - kTurn) <= 0.5 * first_step_;
  return !picture && turn && static_cast<double>(even_ + falls_) >= kEven * steps;
}

std::string FirstColumn::doubt(bool more_behind_z) const {
  std::string what;
  if (is_number()) {
    what = fmt::format("holds whole numbers that {} ({:.0f} to {:.0f}), as points are numbered",
                       rising_ ? "rise from row to row" : "never repeat", x_.low, x_.high);
  } else if (!more_behind_z && is_constant()) {
    what = fmt::format("holds {:.6g} in all rows, as scans are numbered, which makes a plane of all points", x_.low);
  } else if (!more_behind_z && is_group()) {
    what = fmt::format(
        "holds few whole numbers ({:.0f} to {:.0f}) and the three behind it fractions, as scans, rings "
        "and classes are numbered",
        x_.low, x_.high);
  } else if (rows_ > 1 && is_even_time()) {
    what = fmt::format("rises evenly by {:.3g} from row to row while the others go to and fro, as a time does",
                       x_.size() / static_cast<double>(rows_ - 1));
  } else if (is_time()) {
    what = "never falls while the others go to and fro in small steps, as a time does";
  } else if (rows_ > 1 && is_angle()) {
    what = fmt::format("goes around from {:.4g} to {:.4g} again and again, as an angle does", x_.low, x_.high);
  } else {
    return {};
  }
  return "the first column, taken as x, " + what +
         "; name the columns in the configuration, for example 'columns: [skip, x, y, z]', if it is none";
}

}  // namespace sparsha::pipeline

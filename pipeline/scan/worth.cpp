// Only meanings that standards and habit give without doubt are taken: LAS classes 7 and 18; a confidence of 0, or
// below half of a scale that ends at 1 or 100; an opacity below half; a mark of 1 on withheld points.
#include "pipeline/scan/worth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text/text.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/drop.h"
#include "pipeline/scan/value_test.h"

namespace sparsha::pipeline {
namespace {

std::string part(std::uint64_t some, std::uint64_t all) {
  return fmt::format("{} of {} points ({} %)", count_text(some), count_text(all),
                     value_text(100.0 * static_cast<double>(some) / static_cast<double>(all), 3));
}

std::string number(float value) { return value_text(static_cast<double>(value), 4); }

/// What is not below `border`.
void propose_minimum(const FieldTally& tally, float border, const std::string& what, Worth& worth) {
  const std::uint64_t below = tally.below(border);
  if (below == 0 || below == tally.values()) return;
  scene::FieldConfig field;
  field.name = tally.name();
  field.min = static_cast<double>(border);
  worth.filter = field;
  worth.kept = worth.points - below;
  worth.reason = part(below, worth.points) + " have " + what;
}

void judge_classes(const FieldTally& tally, Worth& worth) {
  constexpr std::array<int, 2> kNoise = {7, 18};
  if (!tally.is_whole() || tally.least() < 0.0F || tally.most() > 255.0F) return;
  scene::ClassesConfig classes;
  std::uint64_t noise = 0;
  std::string names;
  for (const int number : kNoise) {
    if (tally.count(number) == 0) continue;
    noise += tally.count(number);
    classes.drop.push_back(number);
    names += fmt::format("{}{} ({})", names.empty() ? "" : " and ", number, las_class_name(number));
  }
  if (noise == 0 || noise == tally.values()) return;
  worth.kept = worth.points - noise;
  worth.reason = fmt::format("{} are of class {}", part(noise, worth.points), names);
  worth.filter = std::move(classes);
}

void judge_confidence(const FieldTally& tally, Worth& worth) {
  const float most = tally.most();
  const std::string scale = fmt::format("where others have up to {}", number(most));
  if (tally.least() < -1.0F) return;  // -1: not known
  if (tally.is_whole() && tally.least() <= 0.0F) {
    propose_minimum(tally, 1.0F,
                    std::string("a confidence of 0") + (tally.least() < 0.0F ? " or less, " : ", ") + scale, worth);
  } else if (!tally.is_whole() && most <= 1.0F) {
    propose_minimum(tally, 0.5F, "a confidence below 0.5, " + scale, worth);
  } else if (most > 95.0F && most <= 100.0F && !tally.is_whole()) {
    propose_minimum(tally, 50.0F, "a confidence below 50, " + scale, worth);
  }
}

void judge_opacity(const FieldTally& tally, Worth& worth) {
  if (tally.least() < 0.0F) return;
  const float whole = tally.most() <= 1.0F ? 1.0F : tally.is_whole() && tally.most() <= 255.0F ? 256.0F : 0.0F;
  if (whole == 0.0F) return;
  propose_minimum(tally, whole / 2, fmt::format("an opacity below {}: they are more transparent than not", whole / 2),
                  worth);
}

/// LAS flags so what was deleted, and other formats have its flag as a column.
void judge_withheld(const FieldTally& tally, Worth& worth) {
  const bool is_flag = tally.is_whole() && tally.least() == 0.0F && tally.most() == 1.0F;
  if (!is_flag) return;
  scene::FieldConfig field;
  field.name = tally.name();
  field.max = 0.0;
  worth.filter = field;
  worth.kept = worth.points - tally.count(1);
  worth.reason = part(tally.count(1), worth.points) + " are withheld, as LAS flags what was deleted";
}

}  // namespace

std::string Worth::text() const {
  if (const auto* classes = std::get_if<scene::ClassesConfig>(&*filter)) {
    return fmt::format("classes: {{drop: [{}]}}", fmt::join(classes->drop, ", "));
  }
  const auto& limits = std::get<scene::FieldConfig>(*filter);
  const bool above = std::isfinite(limits.max);
  return fmt::format("field: {{name: {}, {}: {}}}", limits.name, above ? "max" : "min",
                     exact_text(above ? limits.max : limits.min));
}

bool leaves_enough(const Worth& worth) {
  constexpr std::uint64_t kFewest = 100;
  constexpr double kLeast = 0.02;
  return worth.kept >= kFewest && worth.share() >= kLeast;
}

bool is_worthless(std::span<const std::span<const float>> values, std::size_t point,
                  const std::vector<std::string>& fields, const std::vector<Worth>& worth) {
  for (const Worth& w : worth) {
    const auto place = static_cast<std::size_t>(std::find(fields.begin(), fields.end(), w.field) - fields.begin());
    if (!w.filter || place >= values.size() || values[place].empty()) continue;
    const float value = values[place][point];
    const auto* field = std::get_if<scene::FieldConfig>(&*w.filter);
    const bool stays =
        field != nullptr ? keeps(*field, value) : keeps(std::get<scene::ClassesConfig>(*w.filter), value);
    if (!stays) return true;
  }
  return false;
}

void leave_out_worthless(RawScan& scan, const std::vector<std::string>& fields, const std::vector<Worth>& worth) {
  const std::vector<std::span<const float>> values(scan.values.begin(), scan.values.end());
  std::vector<bool> gone(scan.points.size());
  for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = is_worthless(values, i, fields, worth);
  std::vector<bool> stranded(gone.size());
  for (const bool left : {false, true}) {
    for (const auto& face : scan.faces) {
      if (left && (gone[face[0]] || gone[face[1]] || gone[face[2]])) continue;
      for (const std::uint32_t v : face) stranded[v] = !left;
    }
  }
  for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = gone[i] || stranded[i];
  drop_points(scan, gone);
}

std::vector<Worth> worth_of(const std::vector<FieldTally>& tallies) {
  std::vector<Worth> found;
  for (const FieldTally& tally : tallies) {
    if (!tells_worth(tally.name()) || tally.is_constant()) continue;
    Worth worth;
    worth.field = tally.name();
    worth.points = tally.values() + tally.missing();
    worth.kept = worth.points;
    if (tally.name() == PointField::kClass) judge_classes(tally, worth);
    if (tally.name() == "confidence") judge_confidence(tally, worth);
    if (tally.name() == "opacity") judge_opacity(tally, worth);
    if (tally.name() == "withheld") judge_withheld(tally, worth);
    if (!worth.filter && (tally.name() == PointField::kClass || tally.name() == "withheld")) continue;
    if (!worth.filter) {
      worth.reason =
          fmt::format("'{}' of the points is {} to {}", tally.name(), number(tally.least()), number(tally.most()));
    }
    found.push_back(std::move(worth));
  }
  return found;
}

}  // namespace sparsha::pipeline

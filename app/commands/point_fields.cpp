#include "app/commands/point_fields.h"

#include <fmt/format.h>

#include "base/text/text.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::app {

bool is_worth_showing(const pipeline::FieldTally& tally) {
  return tally.values() > 0 && (!tally.is_constant() || pipeline::tells_worth(tally.name()));
}

std::string field_words(const pipeline::FieldTally& tally, const char* percent) {
  const auto number = [](float value) { return value_text(static_cast<double>(value), 5); };
  const auto share = [&](std::uint64_t count) {
    return value_text(100.0 * static_cast<double>(count) / static_cast<double>(tally.values() + tally.missing()), 3);
  };
  std::string text;
  for (const pipeline::ValueCount& value : pipeline::few_values(tally)) {
    std::string name;
    if (tally.name() == pipeline::PointField::kClass) name = pipeline::las_class_name(value.value);
    if (!name.empty()) name = " (" + name + ")";
    text += fmt::format("{}{}{}: {}{}", text.empty() ? "" : ", ", value.value, name, share(value.count), percent);
  }
  if (text.empty()) {
    text = fmt::format("{} to {}, median {}", number(tally.least()), number(tally.most()), number(tally.quantile(0.5)));
  }
  if (tally.missing() > 0) text += fmt::format(", none: {}{}", share(tally.missing()), percent);
  return text;
}

}  // namespace sparsha::app

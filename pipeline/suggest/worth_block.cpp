#include "pipeline/suggest/worth_block.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/yaml/yaml.h"
#include "base/yaml/yaml_text.h"

namespace sparsha::pipeline {

void WorthBlock::add(const std::string& file, const std::vector<Worth>& worth, Progress& progress) {
  for (const Worth& w : worth) {
    if (!w.filter) {
      comments_ += fmt::format("# {}\n", yaml::comment(file + ": " + w.reason + "; it is not used"));
      continue;
    }
    const std::string share = value_text(100.0 * w.share(), 3);
    std::string reason = fmt::format("{}: {}; {} % of its points stay", file, w.reason, share);
    if (w.share() < 0.5) reason += ": MOST GO, compare with a build without this filter";
    progress.warn(fmt::format("{}: {}; the filter '{}' leaves them out, and {} % of the points stay", file, w.reason,
                              w.text(), share));
    add_filter(w, reason);
  }
}

std::string WorthBlock::filters() const {
  std::string text;
  for (const Proposed& p : proposed_) text += fmt::format("  - {}  # {}\n", p.worth.text(), yaml::comment(p.reason));
  return text;
}

// Of limits the one that keeps more, of classes all.
void WorthBlock::add_filter(const Worth& worth, const std::string& reason) {
  const auto same = [&](const Proposed& p) { return p.worth.field == worth.field; };
  const auto known = std::find_if(proposed_.begin(), proposed_.end(), same);
  if (known == proposed_.end()) {
    proposed_.push_back({worth, reason});
    return;
  }
  known->reason += "; " + reason;
  if (auto* field = std::get_if<scene::FieldConfig>(&*known->worth.filter)) {
    const auto& other = std::get<scene::FieldConfig>(*worth.filter);
    field->min = std::min(field->min, other.min);
    field->max = std::max(field->max, other.max);
    return;
  }
  std::vector<int>& drop = std::get<scene::ClassesConfig>(*known->worth.filter).drop;
  for (const int number : std::get<scene::ClassesConfig>(*worth.filter).drop) {
    if (std::find(drop.begin(), drop.end(), number) == drop.end()) drop.push_back(number);
  }
}

}  // namespace sparsha::pipeline

// The blocks `guide` and `cues`: what leads a hand, and what tells it where it has come to.
#include <cstddef>
#include <string>

#include "scene/config/reader.h"

namespace sparsha::scene {

using yaml::MapReader;
using yaml::Node;

GuideConfig parse_guide(const Node& node) {
  constexpr double kWeakest_n = 0.1;
  constexpr double kStrongest_n = 4.0;
  constexpr double kSlowest_mm_per_s = 5.0;
  constexpr double kFastest_mm_per_s = 200.0;
  constexpr std::size_t kMostPoints = 10000;
  GuideConfig guide;
  if (node.kind == Node::Kind::null) return guide;
  MapReader reader(node, "guide");
  int path = 0;
  reader.read_choice("path", path, {GuideConfig::kPathNames.begin(), GuideConfig::kPathNames.end()});
  guide.path = static_cast<GuideConfig::Path>(path);
  reader.read("force_n", guide.force_n, kWeakest_n, kStrongest_n);
  double speed_mm_per_s = 1000.0 * guide.speed_m_per_s;
  reader.read("speed_mm_per_s", speed_mm_per_s, kSlowest_mm_per_s, kFastest_mm_per_s);
  guide.speed_m_per_s = speed_mm_per_s / 1000.0;
  const Node* line = reader.optional("line_m");
  reader.finish();
  const bool drawn = guide.path == GuideConfig::Path::drawn;
  if (drawn && line == nullptr)
    throw yaml::error_at(node, "path: drawn without a line",
                         "line_m: [[x, y], [x, y], ...] beside it; of a whole object [[x, y, z], ...]");
  if (line == nullptr) return guide;
  if (!drawn) throw yaml::error_at(*line, "'line_m' belongs to 'path: drawn'", "path: drawn, or no line_m");
  if (!line->is_sequence() || line->items.size() > kMostPoints)
    throw yaml::error_at(*line, "line_m is not a list of at most 10000 points", "[[x, y], [x, y], ...]");
  const bool in_space = !line->items.empty() && line->items.front().items.size() == 3;
  bool has_length = false;
  for (const Node& item : line->items) {
    const std::vector<double> point = yaml::to_doubles(item, in_space ? 3 : 2);
    if (in_space) {
      guide.line_in_space_m.push_back({point[0], point[1], point[2]});
      has_length = has_length || guide.line_in_space_m.back() != guide.line_in_space_m.front();
    } else {
      guide.line_m.push_back({point[0], point[1]});
      has_length = has_length || guide.line_m.back() != guide.line_m.front();
    }
  }
  if (!has_length) throw yaml::error_at(*line, "the line has no length", "two different points or more");
  return guide;
}

// On, off, or what of each cue is wanted.
std::optional<CuesConfig> parse_cues(const Node& node) {
  CuesConfig cues;
  if (node.kind == Node::Kind::null) return cues;
  if (node.is_scalar()) return yaml::to_bool(node) ? std::optional(cues) : std::nullopt;
  MapReader reader(node, "cues");
  for (std::size_t cue = 0; cue < kCues; ++cue) {
    int kind = 0;
    reader.read_choice(kCueNames[cue], kind, {"both", "sound", "tick", "off"});
    cues.sound[cue] = kind == 0 || kind == 1;
    cues.tick[cue] = kind == 0 || kind == 2;
  }
  reader.read("lost", cues.lost);
  reader.finish();
  return cues;
}

}  // namespace sparsha::scene

#include "scene/keys/keys.h"

#include <algorithm>

#include "scene/keys/forms.h"

namespace sparsha::scene {

std::span<const Key> config_keys() {
  static const std::vector<Key> kAll = [] {
    std::vector<Key> all;
    for (std::vector<Key>& part : std::vector{keys::scan_keys(), keys::filter_keys(), keys::layer_keys(),
                                              keys::touch_keys(), keys::sound_keys(), keys::guidance_keys()})
      std::move(part.begin(), part.end(), std::back_inserter(all));
    return all;
  }();
  return kAll;
}

std::span<const Choice> config_choices() {
  static const std::vector<Choice> kChoices = [] {
    constexpr auto kOne = Choice::Rule::just_one;
    constexpr auto kSome = Choice::Rule::at_least_one;
    constexpr auto kMostOne = Choice::Rule::at_most_one;
    std::vector<Choice> choices{{"scans[].pose", kMostOne, {"quaternion", "euler_deg", "matrix"}},
                                {"scans[].pose", kMostOne, {"translate", "matrix"}},
                                {"filters[].pass", kSome, {"min_m", "max_m"}},
                                {"filters[].keep", kMostOne, {"cluster", "nearest_to"}},
                                {"filters[].field", kSome, {"min", "max"}},
                                {"filters[].classes", kOne, {"keep", "drop"}},
                                {"orientation", kMostOne, {"look_from", "euler_deg", "quaternion", "matrix", "face"}},
                                {"orientation", kMostOne, {"up", "euler_deg"}},
                                {"orientation", kMostOne, {"up", "quaternion"}},
                                {"orientation", kMostOne, {"up", "matrix"}},
                                {"orientation", kMostOne, {"scale", "matrix"}},
                                {"grid", kMostOne, {"size", "spacing_mm"}},
                                {"parts[]", kOne, {"box_m", "polygon_m", "label"}},
                                {"audio.regions[]", kMostOne, {"box_m", "polygon_m", "label"}},
                                {"audio.regions[]", kOne, {"modal", "clip", "material"}},
                                {"audio.regions[].modal", kMostOne, {"modes", "frequency_hz"}},
                                {"audio.regions[].modal", kMostOne, {"modes", "decay_s"}}};
    Choice filter{"filters[]", kOne, {}};
    for (const Key* key : keys_of("filters[]")) filter.keys.push_back(name_of(key->path));
    choices.push_back(filter);
    return choices;
  }();
  return kChoices;
}

std::span<const Company> config_company() {
  static const std::vector<Company> kCompany{
      {"unroll", "centre_m", "axis", {}, {}, "auto"}, {"unroll", "slope_deg", "shape", {}, "cone"},
      {"parts[]", "mu_static", "mu_dynamic"},         {"audio.regions[]", "loop", "clip"},
      {"guide", "line_m", "path", {}, "drawn"},       {"guide", "path", "line_m", "drawn"}};
  return kCompany;
}

std::span<const Relation> config_relations() {
  constexpr auto kExcludes = Relation::Rule::excludes;
  constexpr auto kNeeds = Relation::Rule::needs;
  static const std::vector<Relation> kRelations{{"unroll", kExcludes, "around"},
                                                {"unroll", kExcludes, "grid.bounds_m"},
                                                {"unroll", kExcludes, "orientation.face"},
                                                {"unroll", kExcludes, "orientation.regions_matrix"},
                                                {"parts[].mu_dynamic", kNeeds, "friction"},
                                                {"parts[].label", kNeeds, "audio.labels"},
                                                {"audio.regions[].label", kNeeds, "audio.labels"},
                                                {"guide.path", kNeeds, "parts", 0, "part"},
                                                {"parts[].box_m", kNeeds, "around", 6},
                                                {"audio.regions[].box_m", kNeeds, "around", 6}};
  return kRelations;
}

std::string_view block_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::string_view name_of(std::string_view path) { return path.substr(path.rfind('.') + 1); }

std::vector<const Key*> keys_of(std::string_view block) {
  std::vector<const Key*> found;
  for (const Key& key : config_keys())
    if (block_of(key.path) == block) found.push_back(&key);
  return found;
}

const Key* find_key(std::string_view path) {
  const std::span<const Key> all = config_keys();
  const auto found = std::ranges::find(all, path, &Key::path);
  return found == all.end() ? nullptr : &*found;
}

const Form* form_of(const Key& key, Form::Kind kind) {
  const auto found = std::ranges::find(key.forms, kind, &Form::kind);
  return found == key.forms.end() ? nullptr : &*found;
}

}  // namespace sparsha::scene

#include "app/keys/json_schema.h"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/yaml/yaml.h"
#include "scene/keys/keys.h"

namespace sparsha::app {
namespace {

using nlohmann::ordered_json;
using scene::Choice;
using scene::Form;
using scene::Key;
using Kind = Form::Kind;

ordered_json limited(const char* type, const Form& form) {
  ordered_json schema{{"type", type}};
  const auto number = [&](double limit) {
    return form.kind == Kind::number ? ordered_json(limit) : ordered_json(static_cast<std::int64_t>(limit));
  };
  if (std::isfinite(form.least)) schema["minimum"] = number(form.least);
  if (std::isfinite(form.most)) schema["maximum"] = number(form.most);
  return schema;
}

ordered_json list_of(const ordered_json& items, double least, double most) {
  ordered_json schema{{"type", "array"}, {"items", items}};
  if (least > 0.0) schema["minItems"] = static_cast<int>(least);
  if (most > 0.0) schema["maxItems"] = static_cast<int>(most);
  return schema;
}

ordered_json numbers(double count) { return list_of({{"type", "number"}}, count, count); }

ordered_json text(const Form& form) {
  ordered_json schema{{"type", {"string", "number", "boolean"}}};
  if (!form.pattern.empty()) schema["pattern"] = form.pattern;
  return schema;
}

ordered_json block_schema(std::string_view block);

ordered_json form_schema(const Key& key, const Form& form) {
  switch (form.kind) {
    case Kind::nothing:
      return {{"type", "null"}};
    case Kind::block:
      return block_schema(key.path);
    case Kind::list:
      return list_of(block_schema(std::string(key.path) + "[]"), form.least, form.most);
    case Kind::number:
      return limited("number", form);
    case Kind::whole:
      return limited("integer", form);
    // As YAML 1.1 and 1.2 read them.
    case Kind::toggle:
      return {{"enum", {true, false, "on", "off", "yes", "no"}}};
    case Kind::text:
    case Kind::file:
      return text(form);
    case Kind::word:
      return {{"enum", form.words}};
    case Kind::words:
      return list_of({{"enum", form.words}}, form.least, 0.0);
    case Kind::wholes:
      return list_of(limited("integer", form), 1.0, 0.0);
    case Kind::numbers:
      return numbers(form.least);
    case Kind::matrix:
      return {{"anyOf", {numbers(16.0), list_of(numbers(4.0), 4.0, 4.0)}}};
    case Kind::points:
      return list_of(numbers(2.0), form.least, form.most);
    case Kind::places:
      return list_of(numbers(3.0), form.least, form.most);
  }
  return {};
}

ordered_json json_of(const yaml::Node& node) {
  if (node.is_sequence()) {
    ordered_json list = ordered_json::array();
    for (const yaml::Node& item : node.items) list.push_back(json_of(item));
    return list;
  }
  if (node.scalar == "true" || node.scalar == "false") return node.scalar == "true";
  const ordered_json number = ordered_json::parse(node.scalar, nullptr, false);
  return number.is_number() ? number : ordered_json(node.scalar);
}

ordered_json key_schema(const Key& key) {
  ordered_json schema;
  std::string sentence(key.sentence);
  if (!key.unit.empty()) sentence += " (" + std::string(key.unit) + ")";
  schema["description"] = sentence;
  if (!key.absent.empty()) schema["default"] = json_of(yaml::parse_text(key.absent, "the table of keys"));
  if (key.forms.size() == 1) {
    schema.update(form_schema(key, key.forms.front()));
    return schema;
  }
  schema["anyOf"] = ordered_json::array();
  for (const Form& form : key.forms) schema["anyOf"].push_back(form_schema(key, form));
  return schema;
}

ordered_json required(std::string_view name) { return {{"required", {name}}}; }

/// What must hold of the keys of one choice.
void add_rules(ordered_json& rules, const Choice& choice) {
  if (choice.rule != Choice::Rule::at_most_one) {
    ordered_json each = ordered_json::array();
    for (const std::string_view name : choice.keys) each.push_back(required(name));
    rules.push_back({{choice.rule == Choice::Rule::just_one ? "oneOf" : "anyOf", each}});
    return;
  }
  for (std::size_t i = 0; i < choice.keys.size(); ++i)
    for (std::size_t j = i + 1; j < choice.keys.size(); ++j)
      rules.push_back({{"not", {{"required", {choice.keys[i], choice.keys[j]}}}}});
}

ordered_json with_value(std::string_view name, const ordered_json& value) {
  return {{"required", {name}}, {"properties", {{std::string(name), value}}}};
}

void add_rules(ordered_json& rules, const scene::Company& company) {
  ordered_json beside = required(company.other);
  if (!company.other_is.empty()) beside = with_value(company.other, {{"const", company.other_is}});
  if (!company.other_is_not.empty()) beside = with_value(company.other, {{"not", {{"const", company.other_is_not}}}});
  const ordered_json there =
      company.key_is.empty() ? required(company.key) : with_value(company.key, {{"const", company.key_is}});
  rules.push_back({{"if", there}, {"then", beside}});
}

/// Of a path from the root, "audio.regions[].label": its first part, and what is behind it.
std::pair<std::string, std::string_view> first_of(std::string_view path) {
  const std::size_t dot = path.find('.');
  return {std::string(path.substr(0, dot)), dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1)};
}

ordered_json present(std::string_view path) {
  const auto [name, rest] = first_of(path);
  ordered_json schema{{"type", "object"}, {"required", {name}}};
  if (!rest.empty()) schema["properties"][name] = present(rest);
  return schema;
}

/// No value at this path in any list, or none of so many numbers.
ordered_json absent(std::string_view path, int numbers) {
  auto [name, rest] = first_of(path);
  if (rest.empty() && numbers > 0) return {{"properties", {{name, {{"maxItems", numbers - 1}}}}}};
  if (rest.empty()) return {{"not", required(name)}};
  const bool in_list = name.ends_with("[]");
  if (in_list) name.resize(name.size() - 2);
  const ordered_json inside = absent(rest, numbers);
  return {{"properties", {{name, in_list ? ordered_json{{"items", inside}} : inside}}}};
}

/// That the key of a block at the root is not that word.
ordered_json other_than(std::string_view path, std::string_view word) {
  const ordered_json key{{std::string(scene::name_of(path)), {{"not", {{"const", std::string(word)}}}}}};
  return {{"properties", {{std::string(scene::block_of(path)), {{"properties", key}}}}}};
}

void add_rules(ordered_json& rules, const scene::Relation& relation) {
  const ordered_json none =
      relation.word.empty() ? absent(relation.path, relation.numbers) : other_than(relation.path, relation.word);
  const ordered_json other = present(relation.other);
  if (relation.rule == scene::Relation::Rule::needs)
    rules.push_back({{"anyOf", {none, other}}});
  else
    rules.push_back({{"anyOf", {none, {{"not", other}}}}});
}

ordered_json block_schema(std::string_view block) {
  ordered_json schema{{"type", "object"}, {"additionalProperties", false}, {"properties", ordered_json::object()}};
  for (const Key* key : scene::keys_of(block)) {
    const std::string name(scene::name_of(key->path));
    schema["properties"][name] = key_schema(*key);
    if (key->required) schema["required"].push_back(name);
  }
  ordered_json rules = ordered_json::array();
  for (const scene::Company& company : scene::config_company())
    if (company.block == block) add_rules(rules, company);
  for (const Choice& choice : scene::config_choices())
    if (choice.block == block) add_rules(rules, choice);
  if (block.empty())
    for (const scene::Relation& relation : scene::config_relations()) add_rules(rules, relation);
  if (!rules.empty()) schema["allOf"] = rules;
  return schema;
}

}  // namespace

std::string json_schema_text() {
  ordered_json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                      {"title", "Sparsha: the configuration of a scene"}};
  schema.update(block_schema(""));
  return schema.dump(1) + "\n";
}

}  // namespace sparsha::app

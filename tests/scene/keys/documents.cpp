#include "documents.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/yaml/yaml.h"

namespace sparsha::scene::test {
namespace {

using Kind = Form::Kind;

// What a key needs beside it, and at the root, to be taken whatever its value.
const std::map<std::string_view, Fields> kBeside{
    {"unroll.centre_m", {{"axis", "[0, 0, 1]"}}},  {"unroll.slope_deg", {{"shape", "cone"}}},
    {"parts[].mu_static", {{"mu_dynamic", "0"}}},  {"guide.line_m", {{"path", "drawn"}}},
    {"audio.regions[].loop", {{"clip", "a.wav"}}}, {"friction.mu_0", {{"mu_max", "10"}}},
    {"friction.mu_max", {{"mu_0", "0"}}}};
const std::map<std::string_view, std::string_view> kAtRoot{{"parts[].mu_static", "friction: {}"},
                                                           {"parts[].mu_dynamic", "friction: {}"},
                                                           {"parts[].label", "audio: {labels: a.png}"},
                                                           {"parts[].box_m", "around: {}"},
                                                           {"guide.line_m", "around: {}"},
                                                           {"audio.regions[].box_m", "around: {}"}};

// Values that the form alone does not make sensible.
const std::map<std::string_view, std::string_view> kSensible{
    {"box_m", "[0, 0, 1, 1]"}, {"bounds_m", "[0, 0, 1, 1]"}, {"max_m", "[1, 1, 2]"}, {"up", "[0, 1, 0]"}};

bool has(const Fields& fields, std::string_view name) {
  return std::ranges::any_of(fields, [&](const auto& field) { return field.first == name; });
}

std::string flow(const Fields& fields) {
  std::string text;
  for (const auto& [name, value] : fields) text += (text.empty() ? "" : ", ") + name + ": " + value;
  return "{" + text + "}";
}

Fields completed(std::string_view block, Fields fields) {
  for (const Key* key : keys_of(block)) {
    const std::string name(name_of(key->path));
    if (key->required && !has(fields, name)) fields.emplace_back(name, sample(*key));
  }
  for (const Choice& choice : config_choices()) {
    if (choice.block != block || choice.rule == Choice::Rule::at_most_one) continue;
    if (std::ranges::any_of(choice.keys, [&](std::string_view name) { return has(fields, name); })) continue;
    const std::string name(choice.keys.front());
    fields.emplace_back(name, sample(*find_key(block.empty() ? name : std::string(block) + "." + name)));
  }
  // One place, unless the pillars are looked for (audio.find), which is no matter of one block.
  if (block == "audio.regions[]" && !has(fields, "polygon_m") && !has(fields, "label") && !has(fields, "box_m"))
    fields.emplace_back("box_m", "[0, 0, 1, 1]");
  const bool labelled = std::ranges::any_of(fields, [](const auto& field) {
    return field.first == "regions" && field.second.find("label:") != std::string::npos;
  });
  if (block == "audio" && labelled && !has(fields, "labels")) fields.emplace_back("labels", "a.png");
  return fields;
}

std::string sample_block(std::string_view block) { return flow(completed(block, {})); }

Fields beside(const Key& key) {
  const auto found = kBeside.find(key.path);
  return found == kBeside.end() ? Fields{} : found->second;
}

std::string sample_numbers(int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) text += i + 1 == count ? "1]" : "0, ";
  return text;
}

}  // namespace

std::string sample(const Key& key, const Form& form) {
  const auto sensible = kSensible.find(name_of(key.path));
  switch (form.kind) {
    case Kind::nothing:
      return "";
    case Kind::block:
      return sample_block(key.path);
    case Kind::list:
      return "[" + sample_block(std::string(key.path) + "[]") + "]";
    case Kind::number:
      return exact_text(std::clamp(1.0, form.least, form.most));
    case Kind::whole:
      return exact_text(std::clamp(20.0, form.least, form.most));
    case Kind::toggle:
      return "on";
    case Kind::text:
      return "hello";
    case Kind::file:
      return "a.ply";
    case Kind::word:
      return std::string(form.words.front());
    case Kind::words:
      return "[x, y, z]";
    case Kind::wholes:
      return "[2]";
    case Kind::numbers:
      if (form.least == 6.0) return "[0, 0, 0, 1, 1, 1]";  // low corner, high corner
      return sensible != kSensible.end() ? std::string(sensible->second) : sample_numbers(static_cast<int>(form.least));
    case Kind::matrix:
      return "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]";
    case Kind::points:
      return "[[0, 0], [1, 0], [0, 1]]";
    case Kind::places:
      return "[[0, 0, 0], [1, 0, 0], [0, 1, 1]]";
  }
  return {};
}

std::string sample(const Key& key) { return sample(key, key.forms.front()); }

std::string document(std::string_view block, Fields fields, bool complete) {
  if (complete) fields = completed(block, std::move(fields));
  while (!block.empty()) {
    const bool in_list = block.ends_with("[]");
    const std::string_view path = in_list ? block.substr(0, block.size() - 2) : block;
    const std::string value = in_list ? "[" + flow(fields) + "]" : flow(fields);
    block = block_of(path);
    fields = completed(block, {{std::string(name_of(path)), value}});
  }
  std::string text;
  for (const auto& [name, value] : fields) text += fmt::format("{}: {}\n", name, value);
  return text;
}

std::string document(const Key& key, const std::string& value) {
  Fields fields = beside(key);
  fields.insert(fields.begin(), {std::string(name_of(key.path)), value});
  if (key.path == "guide.path" && value == "drawn") fields.emplace_back("line_m", "[[0, 0], [1, 0]]");
  return document(block_of(key.path), fields) + at_root(key);
}

std::string document_without(const Key& key) { return document(block_of(key.path), beside(key)) + at_root(key); }

std::string at_root(const Key& key) {
  const auto found = kAtRoot.find(key.path);
  return found == kAtRoot.end() ? std::string{} : std::string(found->second) + "\n";
}

std::optional<Error> refusal(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

Config parsed(const std::string& text) { return parse_config(yaml::parse_text(text, "c.yaml"), "folder"); }

}  // namespace sparsha::scene::test

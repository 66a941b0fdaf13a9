// The texts of configs/speech are compiled in, so that a program without its source tree can speak.
#include "base/phrases/phrases.h"

#include <cmath>
#include <cstdint>
#include <set>

#include "base/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml.h"

namespace sparsha {

// Made by base/CMakeLists.txt of configs/speech/*.yaml: language, text.
extern const std::pair<std::string_view, std::string_view> kPhraseFiles[];
extern const std::size_t kPhraseFileCount;

namespace {

std::set<std::string, std::less<>> names_in(std::string_view values) {
  std::set<std::string, std::less<>> names;
  for (std::size_t begin = 0; begin < values.size();) {
    const std::size_t end = std::min(values.find(' ', begin), values.size());
    names.emplace(values.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::optional<Phrase> Phrase::find(std::string_view key) {
  const std::size_t index = index_of(key);
  if (index == kPhraseKeys.size()) return std::nullopt;
  return Phrase(Known{}, index);
}

std::vector<std::string> Phrases::languages() {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kPhraseFileCount; ++k) names.emplace_back(kPhraseFiles[k].first);
  return names;
}

Phrases Phrases::of(std::string_view language) {
  for (std::size_t k = 0; k < kPhraseFileCount; ++k)
    if (kPhraseFiles[k].first == language)
      return parse(kPhraseFiles[k].second, "configs/speech/" + std::string(language) + ".yaml");
  throw usage_error("no texts are there in the language '" + std::string(language) + "'", listed(languages()));
}

Phrases Phrases::parse(std::string_view yaml, const std::string& file) {
  const yaml::Node root = yaml::parse_text(yaml, file);
  yaml::MapReader reader(root, "the texts");
  Phrases phrases;
  for (std::size_t k = 0; k < kPhraseKeys.size(); ++k) {
    const yaml::Node& node = reader.required(kPhraseKeys[k].name);
    phrases.texts_[k] = yaml::to_text(node);
    const std::vector<std::string> names = placeholders(phrases.texts_[k]);
    const auto expected = names_in(kPhraseKeys[k].values);
    if (std::set<std::string, std::less<>>(names.begin(), names.end()) != expected)
      throw yaml::error_at(node, "the names in braces are not those of " + std::string(kPhraseKeys[k].name),
                           expected.empty() ? "none" : listed({expected.begin(), expected.end()}));
    if (phrases.texts_[k].empty()) throw yaml::error_at(node, "an empty text", "words");
  }
  reader.finish();
  return phrases;
}

std::string Phrases::text(Phrase phrase, const PhraseValues& values) const {
  const std::string& text = texts_[phrase.index()];
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    const std::size_t close = text.find('}', open);
    result.append(text, at, open - at);
    if (close == std::string::npos) return result + text.substr(open);
    const std::string_view name = std::string_view(text).substr(open + 1, close - open - 1);
    const auto value = std::find_if(values.begin(), values.end(), [name](const auto& v) { return v.first == name; });
    result += value != values.end() ? value->second : "{" + std::string(name) + "}";
    at = close + 1;
  }
  return result;
}

std::string Phrases::text_or(std::string_view key) const {
  const std::optional<Phrase> phrase = Phrase::find(key);
  return phrase ? text(*phrase) : std::string(key);
}

std::string Phrases::distance(double metres) const {
  const double size = std::abs(metres);
  if (!std::isfinite(size) || size > 1e9) return text("distance_unknown");
  const auto number = [](double value) { return PhraseValues{{"number", value_text(value, 3)}}; };
  const double millimetres = std::max(1.0, std::round(1e3 * size));
  if (millimetres < 10.0)
    return millimetres == 1.0 ? text("millimetre", number(1.0)) : text("millimetres", number(millimetres));
  const double centimetres = std::round(1e2 * size);
  if (centimetres < 100.0)
    return centimetres <= 1.0 ? text("centimetre", number(1.0)) : text("centimetres", number(centimetres));
  const double round_metres = std::round(1e1 * size) / 1e1;
  return round_metres == 1.0 ? text("metre", number(1.0)) : text("metres", number(round_metres));
}

std::string Phrases::height(double metres) const {
  const double tenths = std::round(1e4 * std::abs(metres));
  if (!(tenths < 10.0)) return distance(metres);
  return text("millimetres", {{"number", value_text(std::max(1.0, tenths) / 10.0, 2)}});
}

std::vector<std::string> placeholders(std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t open = text.find('{'); open != std::string_view::npos; open = text.find('{', open + 1)) {
    const std::size_t close = text.find('}', open);
    if (close == std::string_view::npos) break;
    names.emplace_back(text.substr(open + 1, close - open - 1));
  }
  return names;
}

}  // namespace sparsha

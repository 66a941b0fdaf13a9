// The table of keys and the readers of the configuration agree: each row is put to the readers, which do not know it.
#include <cmath>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "base/phrases/phrases.h"
#include "base/text/text.h"
#include "documents.h"
#include "scene/config/block_hint.h"

namespace sparsha::scene::test {
namespace {

using Kind = Form::Kind;

std::string said(const std::optional<Error>& error) { return error ? error->what() : "nothing"; }

void expect_taken(const std::string& text) {
  const std::optional<Error> error = refusal(text);
  EXPECT_FALSE(error) << text << said(error);
}

void expect_refused(const std::string& text) { EXPECT_TRUE(refusal(text)) << text; }

bool is_block(const Key& key) { return form_of(key, Kind::block) != nullptr; }

std::vector<std::string> all_blocks() {
  std::vector<std::string> blocks{""};
  for (const Key& key : config_keys()) {
    if (is_block(key)) blocks.emplace_back(key.path);
    if (form_of(key, Kind::list) != nullptr) blocks.push_back(std::string(key.path) + "[]");
  }
  return blocks;
}

std::set<std::string> split(std::string_view text, std::string_view by) {
  std::set<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = text.find(by);
    parts.emplace(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + by.size());
  }
  return parts;
}

TEST(ConfigKeys, EachBlockOfTheReadersHasTheKeysOfTheTableAndNoOthers) {
  for (const std::string& block : all_blocks()) {
    SCOPED_TRACE(block.empty() ? "the root" : block);
    // A key that is none makes the reader list those that it asked for.
    const std::optional<Error> error = refusal(document(block, {{"qqqqqqqqqqqqqqqqqqqq", "1"}}));
    ASSERT_TRUE(error);
    EXPECT_THAT(error->wrong(), ::testing::HasSubstr("has no key 'qqqqqqqqqqqqqqqqqqqq'"));
    std::string_view listed = error->expected();
    if (listed.starts_with("one of ")) listed.remove_prefix(7);
    std::set<std::string> names;
    for (const Key* key : keys_of(block)) names.emplace(name_of(key->path));
    EXPECT_EQ(split(listed, ", "), names);
  }
}

TEST(ConfigKeys, EachFormOfAKeyIsTakenAndNoOther) {
  for (const Key& key : config_keys()) {
    SCOPED_TRACE(key.path);
    bool scalar = false;
    bool list = false;
    for (const Form& form : key.forms) {
      const std::string value = sample(key, form);
      expect_taken(document(key, value));
      list = list || value.starts_with('[');
      scalar = scalar || (!value.empty() && !value.starts_with('[') && !value.starts_with('{'));
    }
    if (form_of(key, Kind::nothing) == nullptr) expect_refused(document(key, ""));
    if (!is_block(key)) expect_refused(document(key, "{a: 1}"));
    if (!list) expect_refused(document(key, "[1, 2, 3]"));
    if (!scalar) expect_refused(document(key, "hello"));
  }
}

TEST(ConfigKeys, NumbersAreTakenAtTheirLimitsAndRefusedBeyond) {
  int checked = 0;
  for (const Key& key : config_keys()) {
    for (const Form& form : key.forms) {
      const bool whole = form.kind == Kind::whole || form.kind == Kind::wholes;
      if (!whole && form.kind != Kind::number) continue;
      SCOPED_TRACE(key.path);
      const auto text = [&](double value) {
        return document(key, form.kind == Kind::wholes ? "[" + exact_text(value) + "]" : exact_text(value));
      };
      const auto step = [&](double value) {
        return whole ? 1.0 : value == 0.0 ? std::numeric_limits<double>::denorm_min() : std::abs(value) * 1e-12;
      };
      expect_taken(text(form.least));
      expect_refused(text(form.least - step(form.least)));
      if (std::isfinite(form.most)) {
        expect_taken(text(form.most));
        if (form.most < 1e15) expect_refused(text(form.most + step(form.most)));
      } else {
        expect_taken(text(1e300));
      }
      if (whole) expect_refused(text(form.least + 0.5));
      ++checked;
    }
  }
  EXPECT_GT(checked, 50);
}

TEST(ConfigKeys, WordsAreThoseThatTheReadersName) {
  int checked = 0;
  for (const Key& key : config_keys()) {
    const Form* form = form_of(key, Kind::word);
    if (form == nullptr) continue;
    SCOPED_TRACE(key.path);
    for (const std::string_view word : form->words) expect_taken(document(key, std::string(word)));
    if (form_of(key, Kind::file) != nullptr) continue;
    const std::optional<Error> error = refusal(document(key, "qqqqqqqqqqqqqqqqqqqq"));
    ASSERT_TRUE(error);
    if (key.path == "speech.language") {
      const std::vector<std::string> languages = Phrases::languages();
      EXPECT_THAT(languages, ::testing::UnorderedElementsAreArray(form->words));
      continue;
    }
    std::set<std::string> listed = split(error->expected(), " | ");
    std::erase_if(listed, [](const std::string& word) { return word.starts_with('{'); });
    if (form->words.size() == 1) continue;  // and another form, which the message tells in a sentence
    EXPECT_THAT(listed, ::testing::UnorderedElementsAreArray(form->words));
    ++checked;
  }
  EXPECT_GT(checked, 20);
}

TEST(ConfigKeys, WhatAnAbsentKeyMeansIsWhatTheTableSays) {
  int checked = 0;
  for (const Key& key : config_keys()) {
    if (key.absent.empty()) continue;
    SCOPED_TRACE(key.path);
    const std::string without = to_yaml(parsed(document_without(key)));
    EXPECT_EQ(to_yaml(parsed(document(key, std::string(key.absent)))), without);
    // And the key is not without effect.
    bool differs = false;
    for (const Form& form : key.forms) {
      std::vector<std::string> others{sample(key, form)};
      if (form.kind == Kind::toggle) others = {"on", "off"};
      if (form.kind == Kind::numbers) others = {form.least == 4.0 ? "[0, 0, 1, 0]" : "[1, 2, 3]"};
      if (form.kind == Kind::number || form.kind == Kind::whole) others.push_back(exact_text(form.most));
      if (form.kind == Kind::word) others.assign(form.words.begin(), form.words.end());
      for (const std::string& other : others) differs = differs || to_yaml(parsed(document(key, other))) != without;
    }
    EXPECT_TRUE(differs);
    ++checked;
  }
  EXPECT_GT(checked, 40);
}

TEST(ConfigKeys, WhatIsRequiredIsRefusedWithoutItAndNothingElseIs) {
  for (const std::string& block : all_blocks()) {
    SCOPED_TRACE(block.empty() ? "the root" : block);
    expect_taken(document(block, {}));
    for (const Key* key : keys_of(block)) {
      if (!key->required) continue;
      Fields others;
      for (const Key* other : keys_of(block))
        if (other->required && other != key) others.emplace_back(name_of(other->path), sample(*other));
      expect_refused(document(block, others, false));
    }
  }
}

TEST(ConfigKeys, KeysThatExcludeEachOtherAreRefusedTogetherAndWhereOneIsNeededWithoutAny) {
  for (const Choice& choice : config_choices()) {
    SCOPED_TRACE(choice.block);
    const auto row = [&](std::string_view name) -> const Key& {
      return *find_key(std::string(choice.block) + "." + std::string(name));
    };
    const auto field = [&](std::string_view name) { return std::pair{std::string(name), sample(row(name))}; };
    for (const std::string_view name : choice.keys)
      expect_taken(document(choice.block, {field(name)}) + at_root(row(name)));
    if (choice.rule == Choice::Rule::at_least_one) {
      Fields required;
      for (const Key* key : keys_of(choice.block))
        if (key->required) required.push_back(field(name_of(key->path)));
      expect_refused(document(choice.block, required, false));
      continue;
    }
    for (std::size_t i = 0; i < choice.keys.size(); ++i)
      for (std::size_t j = i + 1; j < choice.keys.size(); ++j)
        expect_refused(document(choice.block, {field(choice.keys[i]), field(choice.keys[j])}));
  }
}

TEST(ConfigKeys, AKeyThatBelongsToAnotherIsRefusedWithoutIt) {
  for (const Company& company : config_company()) {
    SCOPED_TRACE(company.key);
    const Key* key = find_key(std::string(company.block) + "." + std::string(company.key));
    ASSERT_NE(key, nullptr);
    ASSERT_NE(find_key(std::string(company.block) + "." + std::string(company.other)), nullptr);
    const std::string name(company.key), other(company.other);
    const std::string value(company.key_is.empty() ? sample(*key) : company.key_is);
    expect_taken(document(*key, value));
    expect_refused(document(company.block, {{name, value}}) + at_root(*key));
    const Key& beside = *find_key(std::string(company.block) + "." + other);
    if (!company.other_is_not.empty())
      expect_refused(document(company.block, {{name, value}, {other, std::string(company.other_is_not)}}));
    if (company.other_is.empty()) continue;
    const Form* words = form_of(beside, Kind::word);
    ASSERT_NE(words, nullptr);
    for (const std::string_view word : words->words)
      EXPECT_EQ(!refusal(document(company.block, {{name, value}, {other, std::string(word)}})),
                word == company.other_is)
          << word;
  }
}

TEST(ConfigKeys, KeysOfTwoBlocksNeedOrExcludeEachOtherAsTheTableSays) {
  for (const Relation& relation : config_relations()) {
    SCOPED_TRACE(relation.path);
    SCOPED_TRACE(relation.other);
    const Key* key = find_key(relation.path);
    const Key* other = find_key(relation.other);
    ASSERT_NE(key, nullptr);
    ASSERT_NE(other, nullptr);
    if (relation.rule == Relation::Rule::excludes) {
      const std::string block(block_of(relation.other));
      const std::string fields = std::string(name_of(relation.other)) + ": " + sample(*other);
      const std::pair beside{block.empty() ? std::string(relation.other) : block,
                             block.empty() ? sample(*other) : "{" + fields + "}"};
      const std::pair alone{std::string(relation.path), sample(*key)};
      expect_taken(document("", {alone}));
      expect_taken(document("", {beside}));
      expect_refused(document("", {alone, beside}));
      continue;
    }
    // Words are judged of files alone, and every document() with a region's label has the image: by the schema's test.
    if (!relation.word.empty() || key->path == "audio.regions[].label") continue;
    ASSERT_FALSE(at_root(*key).empty());
    const bool any = relation.numbers == 0;
    const std::string value = any ? sample(*key) : sample(*key, key->forms.back());
    const std::string without = document(block_of(key->path), {{std::string(name_of(key->path)), value}});
    expect_taken(without + at_root(*key));
    expect_refused(without);
    if (!any) expect_taken(document(block_of(key->path), {{std::string(name_of(key->path)), sample(*key)}}));
  }
}

TEST(ConfigKeys, ListsAndTextsAreAsLongAsTheTableSays) {
  int lists = 0, texts = 0;
  for (const Key& key : config_keys()) {
    SCOPED_TRACE(key.path);
    if (const Form* list = form_of(key, Kind::list)) {
      const std::string one = sample(key, *list);
      const auto of = [&](double count) {
        std::string items;
        for (int k = 0; k < static_cast<int>(count); ++k) items += (k == 0 ? "" : ", ") + one.substr(1, one.size() - 2);
        return document(key, "[" + items + "]");
      };
      EXPECT_EQ(!refusal(of(0.0)), list->least == 0.0);
      if (list->most > 0.0) {
        expect_taken(of(list->most));
        expect_refused(of(list->most + 1.0));
        ++lists;
      }
    }
    for (const Kind kind : {Kind::text, Kind::file}) {
      const Form* text = form_of(key, kind);
      if (text == nullptr) continue;
      EXPECT_EQ(!refusal(document(key, "\"\"")), text->pattern.empty());
      EXPECT_EQ(!refusal(document(key, "\" \"")), text->pattern != "\\S");
      ++texts;
    }
  }
  EXPECT_GT(lists, 0);
  EXPECT_GT(texts, 5);
}

TEST(ConfigKeys, UnitsAreThoseOfTheNamesAndSentencesAreWhole) {
  const std::vector<std::pair<std::string_view, std::string_view>> suffixes{
      {"_n_per_m", "N/m"}, {"_mm_per_s", "mm/s"}, {"_per_minute", "1/min"},
      {"_mm", "mm"},       {"_m", "m"},           {"_deg", "deg"},
      {"_hz", "Hz"},       {"_db", "dB"},         {"_n", "N"},
      {"_s", "s"}};
  std::set<std::string_view> paths;
  for (const Key& key : config_keys()) {
    SCOPED_TRACE(key.path);
    EXPECT_TRUE(paths.insert(key.path).second) << "twice";
    EXPECT_FALSE(key.forms.empty());
    EXPECT_GT(key.sentence.size(), 4U);
    EXPECT_FALSE(key.sentence.ends_with('.'));
    for (const auto& [suffix, unit] : suffixes) {
      if (!key.path.ends_with(suffix)) continue;
      EXPECT_EQ(key.unit, unit);
      break;
    }
  }
  for (const std::string_view path : keys_of_one_block()) EXPECT_NE(find_key(path), nullptr) << path;
}

}  // namespace
}  // namespace sparsha::scene::test

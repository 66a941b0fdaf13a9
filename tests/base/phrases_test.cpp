// The texts of speech: read here line by line, with nothing of the program's own reader.
#include "base/phrases/phrases.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace sparsha {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = SPARSHA_SOURCE_DIR;

std::string content(const fs::path& file) {
  std::ifstream in(file);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

/// key -> text of a file with one `key: "text"` a line.
std::map<std::string, std::string> texts_of(const fs::path& file) {
  std::map<std::string, std::string> texts;
  const std::regex entry("^(\\w+): \"(.*)\"$");
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (line.empty() || line[0] == '#') continue;
    EXPECT_TRUE(std::regex_match(line, match, entry)) << file << ": " << line;
    if (match.empty()) continue;
    EXPECT_TRUE(texts.emplace(match[1], match[2]).second) << "twice: " << match[1];
  }
  return texts;
}

std::set<std::string> names_in(const std::string& text) {
  const std::regex name("\\{(\\w*)\\}");
  std::set<std::string> names;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), name); it != std::sregex_iterator(); ++it)
    names.insert((*it)[1]);
  return names;
}

std::vector<fs::path> language_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kSource / "configs/speech")) files.push_back(entry.path());
  return files;
}

/// The .cpp files of the rooms that announce.
std::vector<fs::path> announcing_sources() {
  std::vector<fs::path> files;
  for (const char* folder : {"haptics/session", "haptics/device", "app"})
    for (const auto& entry : fs::recursive_directory_iterator(kSource / folder))
      if (entry.path().extension() == ".cpp") files.push_back(entry.path());
  EXPECT_GT(files.size(), 20U);
  return files;
}

TEST(Phrases, EveryAnnouncementExistsInEachLanguageWithTheSameValues) {
  const auto english = texts_of(kSource / "configs/speech/en.yaml");
  ASSERT_GE(language_files().size(), 2U);
  for (const fs::path& file : language_files()) {
    const auto texts = texts_of(file);
    EXPECT_EQ(texts.size(), english.size()) << file;
    for (const auto& [key, text] : english) {
      const auto other = texts.find(key);
      ASSERT_NE(other, texts.end()) << file << " lacks " << key;
      EXPECT_EQ(names_in(other->second), names_in(text)) << file << ": " << key;
      EXPECT_FALSE(other->second.empty()) << file << ": " << key;
    }
  }
  EXPECT_EQ(english.size(), kPhraseKeys.size());
}

TEST(Phrases, HindiIsWrittenInDevanagari) {
  for (const auto& [key, text] : texts_of(kSource / "configs/speech/hi.yaml")) {
    if (text.find_first_not_of("{}_, abcdefghijklmnopqrstuvwxyz") == std::string::npos) continue;  // values alone
    EXPECT_TRUE(text.find("\xE0\xA4") != std::string::npos || text.find("\xE0\xA5") != std::string::npos)
        << key << ": " << text;
  }
}

TEST(Phrases, WhatIsCompiledInIsWhatTheFilesSay) {
  ASSERT_EQ(Phrases::languages().size(), language_files().size());
  for (const fs::path& file : language_files()) {
    const Phrases phrases = Phrases::of(file.stem().string());
    for (const auto& [key, text] : texts_of(file)) EXPECT_EQ(phrases.text_or(key), text) << file;
  }
}

TEST(Phrases, NoAnnouncementIsWrittenInTheCode) {
  // Words that go past the texts: a literal given to what takes words as they are.
  const std::regex raw(R"re((say_as_is|board_?\.say|announcements\(\)\.say|announcements_\.say)\s*\()re");
  int calls = 0;
  for (const fs::path& file : announcing_sources()) {
    const std::string text = content(file);
    for (auto it = std::sregex_iterator(text.begin(), text.end(), raw); it != std::sregex_iterator(); ++it) {
      const auto begin = static_cast<std::size_t>(it->position() + it->length());
      std::string call = text.substr(begin, text.find(';', begin) - begin);
      call = std::regex_replace(call, std::regex(R"re(" "|Phrase\("\w+"\))re"), "");
      EXPECT_EQ(call.find('"'), std::string::npos) << file << ": " << call;
      ++calls;
    }
  }
  EXPECT_GE(calls, 8) << "what is looked for is not called so any more";
}

TEST(Phrases, EveryTextIsSaidSomewhereAndWhatDevicesAdviseIsAText) {
  std::string all;
  for (const fs::path& file : announcing_sources()) all += content(file);
  all += content(kSource / "base/phrases/phrases.cpp");
  for (const PhraseKey& key : kPhraseKeys)
    EXPECT_NE(all.find("\"" + std::string(key.name) + "\""), std::string::npos) << key.name << " is never said";
  const std::regex advice(R"re(DeviceAdvice k\w+\{\s*"([^"]+)")re");
  int found = 0;
  for (auto it = std::sregex_iterator(all.begin(), all.end(), advice); it != std::sregex_iterator(); ++it, ++found)
    EXPECT_TRUE(Phrase::find((*it)[1].str())) << (*it)[1];
  EXPECT_GE(found, 14);
}

TEST(Phrases, ValuesArePutInAsTheyAreAndOnce) {
  const Phrases english = Phrases::of("en");
  EXPECT_EQ(english.text("part_way", {{"clock", "two o'clock"}, {"part", "{distance}"}, {"distance", "1 metre"}}),
            "{distance}, 1 metre, two o'clock");
}

TEST(Phrases, AFileThatLacksATextOrMixesUpItsValuesIsRefusedWithItsLine) {
  const std::string good = content(kSource / "configs/speech/en.yaml");
  EXPECT_NO_THROW(static_cast<void>(Phrases::parse(good, "good.yaml")));
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& expected) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    try {
      static_cast<void>(Phrases::parse(bad, "bad.yaml"));
      ADD_FAILURE() << to;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("bad.yaml:"), std::string::npos) << error.what();
    }
  };
  refused("already_whole: \"This is the whole stone\"\n", "", "already_whole");
  refused("already_whole:", "already_hole:", "already_");
  refused("{part} is not", "{pert} is not", "part");
  refused("\"Moving up\"", "\"\"", "empty");
  refused("\"Moving up\"", "[1, 2]", "");
  EXPECT_THROW(static_cast<void>(Phrases::of("xx")), Error);
}

TEST(Phrases, DistancesAreWholeNumbersInTheUnitThatPeopleUse) {
  const Phrases english = Phrases::of("en");
  const std::vector<std::pair<double, std::string>> cases = {{0.12, "12 centimetres"},
                                                             {0.1249, "12 centimetres"},
                                                             {0.0104, "1 centimetre"},
                                                             {0.0098, "1 centimetre"},
                                                             {0.0094, "9 millimetres"},
                                                             {0.001, "1 millimetre"},
                                                             {0.0, "1 millimetre"},
                                                             {-0.029, "3 centimetres"},
                                                             {1.0, "1 metre"},
                                                             {2.34, "2.3 metres"},
                                                             {0.999, "1 metre"},
                                                             {12.0, "12 metres"},
                                                             {1.0 / 0.0, "an unknown distance"}};
  for (const auto& [metres, words] : cases) EXPECT_EQ(english.distance(metres), words) << metres;
  EXPECT_EQ(Phrases::of("hi").distance(0.12), "12 सेंटीमीटर");
}

}  // namespace
}  // namespace sparsha

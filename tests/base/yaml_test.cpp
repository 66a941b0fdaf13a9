// The YAML tree and its map reader: places, duplicates, misspelt keys, limits.
#include "base/yaml/yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sparsha::yaml {
namespace {

using ::testing::HasSubstr;

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return {};
}

TEST(Yaml, KeepsThePlaceOfEveryKeyAndValueCountedFromOne) {
  const Node root = parse_text("a: 1\nb:\n  - x\n  - {c: 2}\n", "f.yaml");
  EXPECT_EQ(root.entries[0].place.line, 1);
  EXPECT_EQ(root.find("a")->place.column, 4);
  const Node& second = root.find("b")->items[1];
  EXPECT_EQ(second.find("c")->place.line, 4);
  EXPECT_EQ(second.find("c")->place.column, 9);
  EXPECT_EQ(second.find("c")->place.file, "f.yaml");
}

TEST(Yaml, NothingAtAllHasThePlaceOfItsFile) {
  for (const char* text : {"", "# nothing\n"})
    EXPECT_EQ(parse_text(text, "empty.yaml").place.file, "empty.yaml") << text;
}

TEST(Yaml, RefusesADuplicateKeyAtItsSecondPlace) {
  const std::string text = message_of([] { (void)parse_text("a: 1\nb: 2\na: 3\n", "f.yaml"); });
  EXPECT_THAT(text, HasSubstr("f.yaml:3:1: error: the key 'a' is given twice"));
  EXPECT_THAT(text, HasSubstr("line 1"));
}

TEST(Yaml, ReportsBadSyntaxWithLineAndColumn) {
  EXPECT_THAT(message_of([] { (void)parse_text("a: [1, 2\nb: 3\n", "f.yaml"); }), HasSubstr("f.yaml:2:"));
}

TEST(Yaml, SaysWhatWasExpectedOfEveryCommonSlip) {
  const auto says = [](const std::string& text, const std::string& what) {
    EXPECT_THAT(message_of([&] { (void)parse_text(text, "f.yaml"); }), HasSubstr(what)) << text;
  };
  says("a:\n  b: 1\n   c: 2\n", "same indent");
  says("a:\n  - b: 1\n  c: 2\n", "same indent");
  says("a: [{b: 1}\nc: 2\n", "']' where the list ends");
  says("a:\n  - {b: 1, c: 2\nd: {e: 3}\n", "'}' or ']' may be missing");
  says("a:\n\tb: 1\n", "instead of a tab");
  says("a: \"C:\\data\\b.ply\"\n", "single quotes");
  says("a: \"C:\\Users\\b.ply\"\n", "single quotes");
  for (const char* quote : {"\"", "'"})
    says(std::string("a:\n  - b: ") + quote + "oni.ply\n    c: m\nd: 1\ne: " + quote + "x" + quote + "\n",
         "f.yaml:2:8: error: the text in quotes goes on into line 3");
  EXPECT_EQ(parse_text("a: \"one\n  Two: a half,\n  of 1903: 'three'\"\n", "f.yaml").entries.size(), 1U)
      << "prose may go on";
}

TEST(Yaml, AdvisesQuotesForTextsWithCommasAndCommasForLists) {
  const Node root = parse_text("a: {say: Hello, world, n: [0;0;1;1]}\n", "f.yaml");
  EXPECT_THAT(message_of([&] {
                MapReader reader(*root.find("a"), "a part");
                (void)reader.optional("say");
                (void)reader.optional("n");
                reader.finish();
              }),
              HasSubstr("say: \"Hello, world\""));
  EXPECT_THAT(message_of([&] { (void)to_doubles(*root.find("a")->find("n"), 4); }), HasSubstr("not semicolons"));
}

TEST(Yaml, ACompletedOrMisspeltKeyIsNearerThanItsBlock) {
  EXPECT_EQ(nearest("grid.siz", {"grid", "grid.size", "grid.spacing_mm"}), "grid.size");
  EXPECT_EQ(nearest("leaf", {"leaf_mm", "last"}), "leaf_mm");
}

TEST(Yaml, NamesTheNearestKeyOfAMisspeltOne) {
  const Node root = parse_text("leaf: 1\n", "f.yaml");
  MapReader reader(root, "voxel");
  double leaf = 0.0;
  reader.read("leaf_mm", leaf, 0, 1);
  EXPECT_THAT(message_of([&] { reader.finish(); }),
              HasSubstr("f.yaml:1:1: error: voxel has no key 'leaf'; did you mean 'leaf_mm'?"));
}

TEST(Yaml, RefusesNumbersThatAreNoneOrOutOfRange) {
  const Node root = parse_text("a: nan\nb: 1e999\nc: '3'\nd: 3x\ne: 7\n", "f.yaml");
  for (const char* key : {"a", "b", "c", "d"}) {
    MapReader reader(root, "it");
    double value = 0.0;
    EXPECT_THAT(message_of([&] { reader.read(key, value, 0, 5); }), HasSubstr("is not a finite number")) << key;
  }
  MapReader reader(root, "it");
  double value = 0.0;
  EXPECT_THAT(message_of([&] { reader.read("e", value, 0, 5); }), HasSubstr("e is 7; a number from 0 to 5"));
}

TEST(Yaml, StopsAliasesThatExpandWithoutEnd) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) text += (k > 0 ? ", " : "") + last;
    text += "]\n";
  }
  EXPECT_THAT(message_of([&] { (void)parse_text(text, "f.yaml"); }), HasSubstr("expands without end"));
}

TEST(Yaml, StopsNestingThatIsTooDeep) {
  EXPECT_NE(message_of([] { (void)parse_text(std::string(5000, '['), "f.yaml"); }), "");
}

TEST(Yaml, SetsAValueByItsPathAndMakesTheBlocksOnTheWay) {
  Node root = parse_text("scans: [{file: a.ply}]\n", "f.yaml");
  set(root, "grid.size=800");
  set(root, "scans.0.units=mm");
  EXPECT_EQ(to_integer(*root.find("grid")->find("size")), 800);
  EXPECT_EQ(to_text(*root.find("scans")->items[0].find("units")), "mm");
  EXPECT_NE(message_of([&] { set(root, "scans.3.units=mm"); }), "");
  EXPECT_NE(message_of([&] { set(root, "grid"); }), "");
  EXPECT_NE(message_of([&] { set(root, "=3"); }), "");
  EXPECT_NE(message_of([&] { set(root, "grid.=3"); }), "");
  set(root, "fill.made.here=1");
  EXPECT_EQ(root.find("fill")->find("made")->place.file, "--set fill.made.here");
}

}  // namespace
}  // namespace sparsha::yaml

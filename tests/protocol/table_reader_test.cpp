// Tables as other people's programs write them: quoted strings, row names, and what cannot be read.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "protocol/table_reader.h"
#include "tests/support/test_folder.h"

namespace sparsha::protocol {
namespace {

class Tables : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& text) const {
    std::ofstream(folder_ / "results.csv") << text;
    return folder_ / "results.csv";
  }
  /// The error of reading all rows; empty without one.
  [[nodiscard]] std::string error_of(const std::string& text) const {
    try {
      TableReader table(file(text), {"case", "t_s"});
      while (table.next()) static_cast<void>(table.number(1, "seconds", 1.0));
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  test::TestFolder folder_;
};

TEST_F(Tables, WrittenByRHaveQuotedNamesAndRowNames) {
  TableReader table(file("\"\",\"case\",\"t_s\",\"note\"\n"
                         "\"1\",\"plane\",0.25,\"by \"\"us\"\", twice\"\n"
                         "\"2\" , \"step\" ,\"0.5\",\r\n"),
                    {"case", "t_s"});
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.word(0), "plane");
  EXPECT_EQ(table.number(1, "seconds", 1.0), 0.25);
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.word(0), "step");
  EXPECT_EQ(table.number(1, "seconds", 1.0), 0.5);
  EXPECT_FALSE(table.next());
}

TEST_F(Tables, AQuoteThatDoesNotCloseIsShownWithItsPlace) {
  const std::string error = error_of("case,t_s\n\"plane\",\"0.5\n");
  EXPECT_NE(error.find("results.csv:2:9"), std::string::npos) << error;
  EXPECT_NE(error.find("\"0.5"), std::string::npos) << error;
}

TEST_F(Tables, CommasInQuotesDoNotMakeFieldsAndOthersDo) {
  EXPECT_EQ(error_of("case,t_s,note\nplane,0.5,\"a,b\"\n"), "");
  const std::string error = error_of("case,t_s,note\nplane,0.5,a,b\n");
  EXPECT_NE(error.find("results.csv:2"), std::string::npos) << error;
  EXPECT_NE(error.find("4 fields"), std::string::npos) << error;
}

}  // namespace
}  // namespace sparsha::protocol

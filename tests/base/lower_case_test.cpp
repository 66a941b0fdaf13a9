// Words and file endings in any case.
#include "base/text/lower_case.h"

#include <gtest/gtest.h>

namespace sparsha {
namespace {

TEST(LowerCase, ChangesTheLettersOfAsciiAndNothingElse) {
  EXPECT_EQ(lower_case("AZ az @[`{ 09 \xC3\x84"), "az az @[`{ 09 \xC3\x84");
  EXPECT_EQ(lower_case(""), "");
}

TEST(LowerCase, AnEndingHasItsFullStopAndNoCase) {
  EXPECT_EQ(ending_of("/a.B/Statue.PLY"), ".ply");
  EXPECT_EQ(ending_of("statue.tar.Gz"), ".gz");
  EXPECT_EQ(ending_of("/a.b/statue"), "");
  EXPECT_EQ(ending_of(".ply"), "") << "a hidden file's name";
}

}  // namespace
}  // namespace sparsha

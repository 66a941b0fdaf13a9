// The plots of curves against time.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "bench/haptics/lines.h"
#include "tests/support/test_folder.h"

namespace sparsha::bench {
namespace {

TEST(Lines, NoNameOfACurveEndsBeyondTheDrawing) {
  const test::TestFolder folder;
  Panel panel;
  for (const char* name :
       {"sparsha, loop alone", "bare, loop alone", "sparsha, window and sound", "bare, window and sound"})
    panel.curves.push_back({name, "#000", "", {0.0, 1.0}, {0.0, 1.0}});
  ASSERT_TRUE(write_lines(folder / "a.svg", "title", "x", {panel}));
  std::ifstream file(folder / "a.svg");
  const std::string svg{std::istreambuf_iterator<char>(file), {}};
  const std::regex text("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\">([a-z, ]+)</text>");
  int names = 0;
  for (std::sregex_iterator at(svg.begin(), svg.end(), text), end; at != end; ++at, ++names)
    EXPECT_LT(std::stod((*at)[1]) + 7.0 * static_cast<double>((*at)[3].length()), 760.0) << (*at)[3];
  EXPECT_EQ(names, 4);
}

}  // namespace
}  // namespace sparsha::bench

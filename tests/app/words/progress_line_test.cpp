#include "app/words/progress_line.h"

#include <gtest/gtest.h>

#include <string>

namespace sparsha::app {
namespace {

TEST(ProgressLine, IsAsLongAsABarOfThirtyWhereThereIsRoom) {
  EXPECT_EQ(progress_line("read", 0.4, 3.0, 80), "read         [############..................]  40 %, 3 s left");
  EXPECT_EQ(progress_line("read", 1.0, 0.0, 80), "read         [##############################] 100 %");
  EXPECT_EQ(stage_line("read", 80), "read ...");
}

TEST(ProgressLine, LeavesOutWhatANarrowTerminalHasNoRoomFor) {
  EXPECT_EQ(progress_line("read", 0.5, 3.0, 41), "read         [####.....]  50 %, 3 s left");
  EXPECT_EQ(progress_line("read", 0.5, 3.0, 30), "read         [####....]  50 %") << "no time";
  EXPECT_EQ(progress_line("reading of 100 scans", 0.5, 3.0, 20), "reading of 10  50 %") << "no bar";
  EXPECT_EQ(stage_line("reading of 100 scans", 12), "reading ...");
  EXPECT_EQ(stage_line("Sch\u00f6ne S\u00e4ule", 10), "Sch\u00f6n ...") << "characters, not bytes";
}

TEST(ProgressLine, NeverFillsTheLastColumn) {
  for (const char* stage : {"", "read", "a stage whose name is longer than some terminals are wide"})
    for (int columns = 0; columns < 100; ++columns) {
      const auto most = static_cast<std::size_t>(columns > 0 ? columns - 1 : 0);
      EXPECT_LE(progress_line(stage, 0.77, 12345.0, columns).size(), most) << stage << columns;
      EXPECT_LE(stage_line(stage, columns).size(), most) << stage << columns;
    }
}

}  // namespace
}  // namespace sparsha::app

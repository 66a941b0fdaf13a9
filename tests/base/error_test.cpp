#include "base/error.h"

#include <gtest/gtest.h>

namespace sparsha {
namespace {

TEST(Error, EndsNoSentenceBeforeWhatWasExpected) {
  EXPECT_STREQ(input_error("a.ogg", "cannot read: Format not recognised.", "a sound").what(),
               "a.ogg: error: cannot read: Format not recognised; a sound");
  EXPECT_STREQ(usage_error("one of a, b, ...", "a").what(), "error: one of a, b, ...; a");
  EXPECT_STREQ(usage_error("it ends here.").what(), "error: it ends here.");
}

}  // namespace
}  // namespace sparsha

#include "scene/config/block_hint.h"

#include <string>

#include <gmock/gmock.h>

#include "base/error.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace {

std::string message_of(const std::string& text) {
  try {
    (void)parse_config(yaml::parse_text("scans: [{file: a.ply}]\n" + text, "a.yaml"), ".");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(BlockHint, EachKeyExistsInItsBlockAndIsToldWithItWhenItStandsWithout) {
  for (const std::string_view path : keys_of_one_block()) {
    const std::string block(path.substr(0, path.find('.')));
    const std::string key(path.substr(path.find('.') + 1));
    SCOPED_TRACE(path);
    // A list of maps is no key's value: it is refused for what it is, and the key for being unknown otherwise.
    const std::string in_block = message_of(block + ": {" + key + ": [{not_a_value: 1}]}\n");
    EXPECT_FALSE(in_block.empty());
    EXPECT_THAT(in_block, ::testing::Not(::testing::HasSubstr("no key '" + key + "'")));
    EXPECT_THAT(message_of(key + ": 1\n"), ::testing::HasSubstr("did you mean '" + std::string(path) + "'?"));
  }
  EXPECT_THAT(message_of("grid: {spacing_mmm: 1}\n"), ::testing::HasSubstr("no key 'spacing_mmm'"))
      << "what the first expectation looks for";
}

}  // namespace
}  // namespace sparsha::scene

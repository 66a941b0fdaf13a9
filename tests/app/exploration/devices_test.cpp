// The table of devices.
#include "app/exploration/devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "base/error.h"

namespace sparsha::app {
namespace {
using ::testing::HasSubstr;

TEST(Devices, EachKindHasANameOfItsOwnAndCanBeFoundAndMade) {
  std::set<std::string> names;
  for (const haptics::DeviceKind& kind : device_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_TRUE(kind.find && kind.make) << kind.name;
    EXPECT_FALSE(kind.find({}).empty()) << kind.name << ": one that is not there is told too";
    for (const haptics::FoundDevice& found : kind.find({}))
      EXPECT_EQ(found.available, found.problem.empty()) << kind.name;
    EXPECT_THAT(device_names(), HasSubstr(kind.name));
  }
}

TEST(Devices, ANameMeansItsKindAndItsArgument) {
  EXPECT_STREQ(kind_of("simulated").kind->name, "simulated");
  const NamedKind plugin = kind_of("plugin:./a:b.so");
  EXPECT_STREQ(plugin.kind->name, "plugin");
  EXPECT_EQ(plugin.argument, "./a:b.so");
  for (const char* wrong : {"", "plugin", "plugin:", "simulated:2", "falcon:", "phantom", "auto"}) {
    try {
      static_cast<void>(kind_of(wrong));
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << wrong;
      EXPECT_THAT(error.expected(), HasSubstr("plugin:FILE.so"));
    }
  }
}

TEST(Devices, OneThatIsNotThereIsADeviceError) {
  for (const char* name : {"pointer", "plugin:no-such-file.so"}) {
    try {
      static_cast<void>(make_device(name, {}));
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::device) << name;
    }
  }
  EXPECT_THROW(static_cast<void>(make_device("playback:no-such-run.csv", {})), Error);
  EXPECT_NE(make_device("simulated", {}), nullptr);
}

}  // namespace
}  // namespace sparsha::app

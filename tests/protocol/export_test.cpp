// An export of the benchmark replaces an older export and nothing else.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "base/error.h"
#include "protocol/benchmark.h"
#include "tests/support/test_folder.h"

namespace sparsha::protocol {
namespace {

namespace fs = std::filesystem;

class Export : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// What the refusal says; empty when the export took the folder's place.
  [[nodiscard]] std::string refusal(const std::string& name) const {
    try {
      export_benchmark(folder_ / name);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return {};
  }
  test::TestFolder folder_;
};

TEST_F(Export, AFolderWithCasesOfSomebodyElseIsLeftAlone) {
  write("patients/cases.csv", "case,surgeon\n1,somebody\n");
  write("patients/notes.txt", "kept");
  EXPECT_NE(refusal("patients").find("patients holds other files"), std::string::npos);
  EXPECT_EQ(text("patients/notes.txt"), "kept");
}

TEST_F(Export, AnOlderExportIsReplacedUntilSomebodyPutsAFileIntoIt) {
  EXPECT_EQ(refusal("data"), "");
  EXPECT_EQ(refusal("data"), "");
  for (const std::string name : {"data/results.csv", "data/paths/mine.csv", "data/surfaces/plane.obj"}) {
    write(name, "kept");
    const std::string said = refusal("data");
    EXPECT_NE(said.find("data holds other files"), std::string::npos) << name;
    EXPECT_NE(said.find(fs::path(name).filename().string()), std::string::npos) << said;
    EXPECT_EQ(text(name), "kept");
    fs::remove(folder_ / name);
  }
  EXPECT_EQ(refusal("data"), "");
}

TEST_F(Export, AnEmptyFolderIsFilled) {
  fs::create_directories(folder_ / "data");
  EXPECT_EQ(refusal("data"), "");
  EXPECT_TRUE(fs::exists(folder_ / "data" / "protocol.md"));
}

}  // namespace
}  // namespace sparsha::protocol

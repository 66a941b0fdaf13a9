// The program run as a user runs it, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "tests/support/test_folder.h"

namespace sparsha {
namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

inline std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path config = fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml";
    relief_ = "\"" + config.string() + "\" --set \"grid={spacing_mm: 3}\"";
  }

  // Runs in the test's own folder, without a display; `before` are commands for the shell.
  Outcome run(const std::string& arguments, const std::string& input = "/dev/null", const std::string& before = "") {
    const std::string command = "cd \"" + folder_.path().string() + "\" && " + before +
                                " env -u DISPLAY -u WAYLAND_DISPLAY \"" + SPARSHA_PROGRAM + "\" " + arguments +
                                " > .out 2> .err < " + input;
    const int status = std::system(command.c_str());
    Outcome outcome;
    outcome.code = WEXITSTATUS(status);
    outcome.out = text_of(folder_ / ".out");
    outcome.err = text_of(folder_ / ".err");
    fs::remove(folder_ / ".out");
    fs::remove(folder_ / ".err");
    return outcome;
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const test::TestFolder folder_;
  std::string relief_;
};

inline constexpr const char* kTetrahedron =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0.1\n0 1 0.2\n1 1 0\n3 0 1 2\n3 1 3 2\n";

}  // namespace sparsha

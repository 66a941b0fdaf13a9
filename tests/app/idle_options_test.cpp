// Options that would change nothing are refused, each with what it needs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/app/program.h"

namespace sparsha {
namespace {
using ::testing::HasSubstr;

class IdleOptions : public Program {
 protected:
  void expect_idle(const std::string& command, const std::string& option) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr(option + " means nothing here")) << command;
  }
};

TEST_F(IdleOptions, OfAnExportAreRefusedWhereTheSceneHasOneView) {
  write("a.ply", kTetrahedron);
  for (const char* file : {"x.ply", "x.tif", "x.stl"}) {
    expect_idle(std::string("export a.ply --front --to ") + file, "--front");
    expect_idle(std::string("export a.ply --unrolled --to ") + file, "--unrolled");
    EXPECT_FALSE(fs::exists(folder_ / file));
  }
}

TEST_F(IdleOptions, OfASolverAreRefusedWithTheOther) {
  write("a.ply", kTetrahedron);
  write("path.csv", "t_s,x_m,y_m,z_m\n0,0.1,0.1,0\n");
  const std::string trace = "trace a.ply --hip path.csv --out trace.csv ";
  expect_idle(trace + "--rho 0.3", "--rho");
  expect_idle(trace + "--solver exact --iterations 7", "--iterations");
  expect_idle(trace + "--solver paper --creases rounded", "--creases");
  EXPECT_FALSE(fs::exists(folder_ / "trace.csv"));
  EXPECT_EQ(run(trace + "--solver paper --rho 0.3 --iterations 7").code, 0);
  EXPECT_EQ(run(trace + "--creases rounded").code, 0);
}

TEST_F(IdleOptions, OfADeviceAreRefusedWithAnother) {
  write("a.ply", kTetrahedron);
  const std::string explore = "explore a.ply --device simulated --headless --duration 0.2 ";
  expect_idle(explore + "--firmware nope.bin", "--firmware");
  expect_idle(explore + "--kiosk", "--kiosk");
  expect_idle("device monitor --device simulated --duration 0.2 --firmware nope.bin", "--firmware");
}

}  // namespace
}  // namespace sparsha

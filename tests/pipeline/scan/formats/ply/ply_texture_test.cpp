// Several pictures on one PLY mesh: which of them lies where, by a number of faces or of vertices.
#include <gmock/gmock.h>

#include <array>

#include "base/png/png.h"
#include "pipeline/scan/writer.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t kRed = pack_rgba(255, 0, 0), kBlue = pack_rgba(0, 0, 255);

struct Form {
  bool ascii = true;
  bool vertices = true;  ///< have coordinates
  bool corners = false;  ///< of faces have coordinates
  bool number_of_vertex = false;
  bool number_of_face = false;
};

/// Two triangles without a common vertex, of the numbers given.
std::string two_triangles(const Form& form, std::array<int, 2> numbers,
                          std::array<const char*, 2> names = {"red.png", "blue.png"}) {
  std::string bytes = "ply\nformat " + std::string(form.ascii ? "ascii" : "binary_little_endian") + " 1.0\n";
  for (const char* const name : names) bytes += std::string("comment TextureFile ") + name + "\n";
  bytes += "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n";
  if (form.vertices) bytes += "property float texture_u\nproperty float texture_v\n";
  if (form.number_of_vertex) bytes += "property int texnumber\n";
  bytes += "element face 2\nproperty list uchar int vertex_indices\n";
  if (form.corners) bytes += "property list uchar float texcoord\n";
  if (form.number_of_face) bytes += "property int texnumber\n";
  bytes += "end_header\n";
  const auto add = [&](auto value) {
    if (form.ascii) {
      bytes += std::to_string(value) + " ";
    } else {
      testing::put(bytes, value);
    }
  };
  for (int i = 0; i < 6; ++i) {
    for (const int value : {i, i * i, i / 3}) add(static_cast<float>(value));
    if (form.vertices) add(0.5F), add(0.5F);
    if (form.number_of_vertex) add(numbers[static_cast<std::size_t>(i / 3)]);
    if (form.ascii) bytes += "\n";
  }
  for (int face = 0; face < 2; ++face) {
    add(std::uint8_t{3});
    for (int k = 0; k < 3; ++k) add(3 * face + k);
    if (form.corners) {
      add(std::uint8_t{6});
      for (int k = 0; k < 6; ++k) add(0.5F);
    }
    if (form.number_of_face) add(numbers[static_cast<std::size_t>(face)]);
    if (form.ascii) bytes += "\n";
  }
  return bytes;
}

class PlyTextures : public ::testing::Test {
 protected:
  PlyTextures() {
    PngFormat format;
    format.width = format.height = 1;
    (void)folder_.write("red.png", encode_png(format, std::vector<std::uint8_t>{255, 0, 0}));
    (void)folder_.write("blue.png", encode_png(format, std::vector<std::uint8_t>{0, 0, 255}));
  }
  testing::ScanFolder folder_;
};

TEST_F(PlyTextures, LieWhereTheNumberOfFacesOrVerticesSays) {
  const Form forms[] = {{true, true, false, false, true},
                        {true, true, false, true, false},
                        {true, false, true, false, true},
                        {true, true, true, false, true},
                        {true, true, false, true, true}};
  for (Form form : forms) {
    for (const bool ascii : {true, false}) {
      form.ascii = ascii;
      const RawScan scan = folder_.read("a.ply", two_triangles(form, {1, 0}));
      EXPECT_THAT(scan.rgba, ElementsAre(kBlue, kBlue, kBlue, kRed, kRed, kRed));
      EXPECT_THAT(scan.warnings, IsEmpty());
      // -1 stands for no picture; one that is not there is said.
      EXPECT_THAT(folder_.read("a.ply", two_triangles(form, {1, -1})).rgba,
                  ElementsAre(kBlue, kBlue, kBlue, kNoColour, kNoColour, kNoColour));
      const RawScan beyond = folder_.read("a.ply", two_triangles(form, {2, 0}));
      EXPECT_THAT(beyond.rgba, ElementsAre(kNoColour, kNoColour, kNoColour, kRed, kRed, kRed));
      EXPECT_THAT(beyond.warnings, ElementsAre(HasSubstr("textures that the header does not")));
    }
  }
}

TEST_F(PlyTextures, WithoutANumberTheFirstIsTakenAndThatIsSaid) {
  for (const Form& form : {Form{true, true}, Form{false, true}, Form{true, false, true}, Form{false, true, true}}) {
    const RawScan scan = folder_.read("a.ply", two_triangles(form, {}));
    EXPECT_THAT(scan.rgba, ::testing::Each(kRed));
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("2 textures are named, and no property 'texnumber' says")));
    EXPECT_THAT(folder_.read("a.ply", two_triangles(form, {}, {"red.png", "red.png"})).warnings, IsEmpty());
  }
}

}  // namespace
}  // namespace sparsha::pipeline

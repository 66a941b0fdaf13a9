// Meshes that somebody refuses by their size: what is counted is what the file has, and no more is kept than was
// allowed.
#include <cctype>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "pipeline/scan/read_bytes.h"

namespace sparsha::pipeline {
namespace {

struct Size {
  std::uint64_t vertices = 0, triangles = 0;
  bool operator==(const Size&) const = default;
};

/// The size that the error of a refused mesh names; nothing when it was read.
std::optional<Size> refused(const std::string& bytes, const std::string& name, std::uint64_t most_triangles) {
  ReadOptions options;
  options.mesh_refusal = [&](std::uint64_t vertices, std::uint64_t triangles) -> std::optional<Error> {
    if (triangles <= most_triangles) return std::nullopt;
    return input_error(name, std::to_string(vertices) + " " + std::to_string(triangles));
  };
  try {
    (void)read_scan_bytes(bytes, name, options);
  } catch (const Error& error) {
    Size size;
    EXPECT_EQ(std::sscanf(error.wrong().c_str(), "%lu %lu", &size.vertices, &size.triangles), 2) << error.what();
    return size;
  }
  return std::nullopt;
}

/// A sheet of `side` x `side` vertices as OBJ, in squares or in triangles.
std::string sheet(int side, bool squares) {
  std::string text;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) text += "v " + std::to_string(i) + " " + std::to_string(j) + " 0\n";
  const auto word = [](int vertex) { return " " + std::to_string(vertex + 1); };
  for (int j = 0; j + 1 < side; ++j)
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i, b = a + 1, c = b + side, d = a + side;
      if (squares) {
        text += "f" + word(a) + word(b) + word(c) + word(d) + "\n";
      } else {
        text += "f" + word(a) + word(b) + word(c) + "\nf" + word(a) + word(c) + word(d) + "\n";
      }
    }
  return text;
}

TEST(MeshRefusal, OfAFileThatDoesNotSayItsSizeCountsAllOfIt) {
  for (const bool squares : {false, true}) {
    const std::string text = sheet(200, squares);  // 79 202 triangles, asked every 32 768
    const Size whole{40'000, 79'202};
    EXPECT_EQ(refused(text, "a.obj", 1000), whole);
    EXPECT_EQ(refused(text, "a.obj", 79'201), whole);
    EXPECT_EQ(refused(text, "a.obj", 79'202), std::nullopt);
  }
}

TEST(MeshRefusal, OfAFileThatSaysItsSizeComesBeforeItsBody) {
  // Bodies that would be errors if they were read.
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
      std::string(100, '?');
  EXPECT_EQ(refused(ply, "a.ply", 1), (Size{4, 2}));
  EXPECT_EQ(refused("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 77\n3 0 2 x\n", "a.off", 1), (Size{4, 2}));
  std::string stl(84 + 50 * 6, '\0');
  stl[80] = 6;
  for (std::size_t at = 84 + 12; at < stl.size(); ++at) stl[at] = '\xFF';  // no number
  EXPECT_EQ(refused(stl, "a.stl", 5), (Size{5, 6}));
  std::string ascii = "solid a\n";
  for (int k = 0; k < 6; ++k) ascii += "facet normal 0 0 1\nouter loop\nvertex no number\nendloop\nendfacet\n";
  EXPECT_EQ(refused(ascii, "a.stl", 5), (Size{5, 6}));
  std::string capitals;
  for (const char c : ascii) capitals += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(refused(capitals, "a.stl", 5), (Size{5, 6}));
}

TEST(MeshRefusal, IsNotAskedOfPoints) {
  EXPECT_EQ(refused("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj", 0), std::nullopt);
  EXPECT_EQ(refused("0 0 0\n1 0 0\n0 1 0\n", "a.xyz", 0), std::nullopt);
}

}  // namespace
}  // namespace sparsha::pipeline

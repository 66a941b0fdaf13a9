// Colours of vertices from pictures: what decodes them, how they are laid on, and pictures that mean harm.
#include <gmock/gmock.h>

#include <cstdio>

#include <jpeglib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/png/png.h"
#include "base/text/base64.h"
#include "pipeline/scan/formats/texture/texture.h"
#include "pipeline/scan/writer.h"
#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::gltf::kFloat;
using testing::gltf::kUnsignedByte;
using testing::gltf::Maker;

constexpr std::uint32_t kRed = pack_rgba(255, 0, 0), kGreen = pack_rgba(0, 255, 0), kBlue = pack_rgba(0, 0, 255);

std::string png_of(int width, int height, const std::vector<std::uint8_t>& rgb) {
  PngFormat format;
  format.width = width;
  format.height = height;
  return encode_png(format, rgb);
}

/// Red and green above blue and white.
std::string four_colours() { return png_of(2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}); }

/// One colour; `inks`: as Adobe's programs write it, in four inverted inks.
std::string jpeg_of(unsigned width, unsigned height, std::array<std::uint8_t, 4> colour, bool progressive = false,
                    bool inks = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = inks ? 4 : 3;
  jpeg.in_color_space = inks ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> row;
  for (unsigned k = 0; k < width; ++k) row.insert(row.end(), colour.begin(), colour.begin() + jpeg.input_components);
  auto* at = row.data();
  while (jpeg.next_scanline < height) jpeg_write_scanlines(&jpeg, &at, 1);
  jpeg_finish_compress(&jpeg);
  std::string result(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return result;
}

std::string error_of_picture(std::string_view bytes) {
  try {
    (void)decode_picture(bytes, "a picture");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_near(std::uint32_t found, std::uint32_t expected, int within) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    EXPECT_NEAR(static_cast<int>(found >> shift & 255U), static_cast<int>(expected >> shift & 255U), within)
        << std::hex << found << ", expected " << expected;
  }
}

TEST(ColourPicture, IsToldByItsBytes) {
  const ColourPicture png = decode_picture(four_colours(), "a");
  EXPECT_EQ(png.width, 2U);
  EXPECT_EQ(png.height, 2U);
  EXPECT_THAT(png.rgba, ElementsAre(kRed, kGreen, kBlue, kWhite));
  for (const bool progressive : {false, true}) {
    const ColourPicture jpeg = decode_picture(jpeg_of(33, 9, {200, 100, 50, 0}, progressive), "a");
    ASSERT_EQ(jpeg.rgba.size(), 33U * 9U);
    for (const std::uint32_t pixel : jpeg.rgba) expect_near(pixel, pack_rgba(200, 100, 50), 2);
  }
  // Inverted cyan 200, magenta 100, yellow 50 and black 255, which is none.
  expect_near(decode_picture(jpeg_of(8, 8, {200, 100, 50, 255}, false, true), "a").rgba[9], pack_rgba(200, 100, 50), 3);
  EXPECT_THAT(error_of_picture(""), HasSubstr("an empty file"));
  EXPECT_THAT(error_of_picture("RIFF\1\1\1\1WEBPVP8 "), HasSubstr("a WebP picture"));
  EXPECT_THAT(error_of_picture("<svg/>"), HasSubstr("no picture that is known here"));
}

TEST(ColourPicture, CutShortAtAnyByteIsAnError) {
  for (const std::string& whole :
       {four_colours(), jpeg_of(24, 16, {9, 8, 7, 0}), jpeg_of(24, 16, {9, 8, 7, 0}, true)}) {
    // The last marker of a JPEG, and the last chunk of a PNG, have no pixels.
    for (std::size_t size = 0; size + 16 < whole.size(); ++size)
      EXPECT_NE(error_of_picture(whole.substr(0, size)), "") << size << " of " << whole.size();
  }
}

TEST(ColourPicture, ThatClaimsMoreThanItsBytesCanHoldTakesNoMemory) {
  std::string jpeg = jpeg_of(16, 16, {1, 2, 3, 0});
  const std::size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  for (std::size_t k = 5; k < 9; k += 2) {
    jpeg[frame + k] = static_cast<char>(60000 >> 8);
    jpeg[frame + k + 1] = static_cast<char>(60000 & 255);
  }
  EXPECT_THAT(error_of_picture(jpeg), HasSubstr("60000 x 60000 pixels"));
  jpeg[frame + 5] = jpeg[frame + 7] = 0x20;  // 8192 and some
  EXPECT_THAT(error_of_picture(jpeg), HasSubstr("pixels in"));
}

TEST(Texture, IsSampledBetweenCentresInLight) {
  const ColourPicture picture = decode_picture(four_colours(), "a");
  EXPECT_EQ(colour_of(sample(picture, 0.25, 0.25)), kRed);
  EXPECT_EQ(colour_of(sample(picture, 0.75, 0.25)), kGreen);
  EXPECT_EQ(colour_of(sample(picture, 0.25, 0.75)), kBlue);
  EXPECT_EQ(colour_of(sample(picture, 1.25, -0.75)), kRed);
  EXPECT_EQ(colour_of(sample(picture, 0.5, 0.25)), pack_rgba(188, 188, 0));  // half of the light of each
  EXPECT_EQ(colour_of(sample(picture, 0.0, 0.25)), pack_rgba(188, 188, 0));
  EXPECT_EQ(colour_of(sample(picture, 0.0, 0.25, Wrap::clamp)), kRed);
  EXPECT_EQ(colour_of(sample(picture, 9.0, 0.25, Wrap::clamp)), kGreen);
  EXPECT_EQ(colour_of(sample(picture, 1.25, 0.25, Wrap::mirror)), kGreen);
  EXPECT_EQ(colour_of(sample(picture, 1.75, 0.25, Wrap::mirror)), kRed);
  EXPECT_EQ(colour_of(sample(picture, -0.25, 0.25, Wrap::mirror)), kRed);
  for (const double wild : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e300}) (void)sample(picture, wild, wild);
}

/// A square whose corners lie in the middles of the four colours: red, green, white, blue.
struct Painted : Maker {
  explicit Painted(const std::string& picture, const char* mime = "image/png") : Maker(testing::gltf::square()) {
    json& attributes = primitive()["attributes"];
    attributes["TEXCOORD_0"] = numbers<float>({0.25F, 0.25F, 0.75F, 0.25F, 0.75F, 0.75F, 0.25F, 0.75F}, kFloat, 2);
    primitive()["material"] = 0;
    root["images"] = json::array({{{"bufferView", view(picture)}, {"mimeType", mime}}});
    root["textures"] = json::array({{{"source", 0}}});
    root["materials"] = json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  }
  json& primitive() { return root["meshes"][0]["primitives"][0]; }
  json& paint() { return root["materials"][0]["pbrMetallicRoughness"]; }
  [[nodiscard]] RawScan read() const { return read_scan_bytes(glb(), "a.glb"); }
};

TEST(GltfTexture, BecomesTheColourOfVertices) {
  const RawScan scan = Painted(four_colours()).read();
  EXPECT_THAT(scan.rgba, ElementsAre(kRed, kGreen, kWhite, kBlue));
  EXPECT_THAT(scan.warnings, IsEmpty());
  EXPECT_EQ(scan.fields, (std::vector<std::string>{"x", "y", "z", "red", "green", "blue", "alpha"}));
  // A wrong type beside it says nothing; a JPEG is read where a PNG is promised.
  for (const std::uint32_t pixel : Painted(jpeg_of(16, 16, {9, 99, 199, 0})).read().rgba)
    expect_near(pixel, pack_rgba(9, 99, 199), 2);
}

TEST(GltfTexture, IsTimesTheFactorAndTheColourOfTheVertex) {
  Painted maker(four_colours());
  maker.paint()["baseColorFactor"] = {1, 0.2159, 0, 1};
  EXPECT_THAT(maker.read().rgba, ElementsAre(kRed, pack_rgba(0, 128, 0), pack_rgba(255, 128, 0), pack_rgba(0, 0, 0)));
  maker.paint().erase("baseColorFactor");
  const std::size_t colours = maker.numbers<std::uint8_t>(
      {128, 0, 0, 255, 0, 255, 0, 255, 255, 128, 0, 255, 0, 0, 9, 255}, kUnsignedByte, 4, true);
  maker.primitive()["attributes"]["COLOR_0"] = colours;
  EXPECT_THAT(maker.read().rgba, ElementsAre(pack_rgba(128, 0, 0), kGreen, pack_rgba(255, 128, 0), pack_rgba(0, 0, 9)));
}

TEST(GltfTexture, LiesAsItsTransformSetAndWrapsSay) {
  Painted maker(four_colours());
  maker.paint()["baseColorTexture"]["extensions"] = {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}};
  EXPECT_THAT(maker.read().rgba, ElementsAre(kGreen, kRed, kBlue, kWhite));
  // The picture's right side is to the vertices' left after a quarter turn: (u, v) becomes (v, 1 - u).
  maker.paint()["baseColorTexture"]["extensions"] = {
      {"KHR_texture_transform", {{"offset", {0, 1}}, {"rotation", 1.5707963267948966}}}};
  EXPECT_THAT(maker.read().rgba, ElementsAre(kBlue, kRed, kGreen, kWhite));
  maker.paint()["baseColorTexture"]["extensions"] = {
      {"KHR_texture_transform", {{"scale", {1, -1}}, {"offset", {0, 1}}, {"texCoord", 1}}}};
  maker.primitive()["attributes"]["TEXCOORD_1"] =
      maker.numbers<float>({2.25F, 0.25F, 1.75F, 0.25F, 0.25F, 0.25F, 0.25F, 1.75F}, kFloat, 2);
  EXPECT_THAT(maker.read().rgba, ElementsAre(kBlue, kWhite, kBlue, kRed));
  maker.root["samplers"] = json::array({{{"wrapS", 33071}, {"wrapT", 33648}}});
  maker.root["textures"][0]["sampler"] = 0;
  EXPECT_THAT(maker.read().rgba, ElementsAre(kWhite, kWhite, kBlue, kBlue));
}

TEST(GltfTexture, OfOlderMaterialsIsReadToo) {
  Painted maker(four_colours());
  maker.root["materials"][0] = {
      {"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseTexture", {{"index", 0}}}}}}}};
  EXPECT_THAT(maker.read().rgba, ElementsAre(kRed, kGreen, kWhite, kBlue));
}

TEST(GltfTexture, LiesBesideTheFileOrInItsText) {
  const testing::ScanFolder folder;
  (void)folder.write("a picture.png", four_colours());
  const auto read = [&](const std::string& uri) {
    Painted maker(four_colours());
    maker.root["images"][0] = {{"uri", uri}};
    return folder.read("a.glb", maker.glb());
  };
  EXPECT_THAT(read("a%20picture.png").rgba, ElementsAre(kRed, kGreen, kWhite, kBlue));
  EXPECT_THAT(read("data:image/png;base64," + to_base64(four_colours())).rgba,
              ElementsAre(kRed, kGreen, kWhite, kBlue));
  (void)folder.write("empty.png", "");
  for (const char* uri :
       {"none.png", "../a.png", "/etc/passwd", "http://a.b/c.png", "empty.png", "data:image/png,xx"}) {
    const RawScan scan = read(uri);
    EXPECT_THAT(scan.rgba, IsEmpty()) << uri;
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("colours are missing: images[0]"))) << uri;
    EXPECT_EQ(scan.points.size(), 4U);
  }
}

/// Corners of a square in the middles of the four colours, from the bottom left: blue, white, green, red.
constexpr const char* kObj =
    "mtllib my model.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nvt 0.25 0.25\nvt 0.75 0.25 0\nvt 0.75 0.75\n"
    "vt 0.25 0.75\nusemtl wall\nf 1/1 2/2 3/3\nf 1/3 -3/-2 -2/4\nusemtl plain\nf 1/4 2/4 5/4\n";

TEST(ObjTexture, BecomesTheColourOfVertices) {
  const testing::ScanFolder folder;
  (void)folder.write("a b.png", four_colours());
  const auto read = [&](const std::string& map, const std::string& obj = kObj) {
    (void)folder.write("my model.mtl", "# made\nnewmtl plain\nKd 1 0 0\nnewmtl wall\nKd 0.8 0.8 0.8\n" + map);
    return folder.read("a.obj", obj);
  };
  const auto as_laid = ElementsAre(kBlue, kWhite, kGreen, kRed, kNoColour);
  for (const char* map : {"map_Kd a b.png\n", "\tmap_Kd -blendu on -mm 0 1 a b.png\r\n", "map_Kd ./a b.png\n",
                          "map_Kd C:\\work\\a b.png\n", "map_Kd -o 1 0 0 -s 1 -t 0 0 0 ..\\..\\a b.png"}) {
    const RawScan scan = read(map);
    EXPECT_THAT(scan.rgba, as_laid) << map;
    EXPECT_THAT(scan.warnings, IsEmpty()) << map;
    EXPECT_EQ(scan.faces.size(), 3U);
  }
  EXPECT_THAT(read("map_Kd -s -1 1 a b.png\n").rgba, ElementsAre(kWhite, kBlue, kRed, kGreen, kNoColour));
  EXPECT_THAT(read("map_Kd -clamp on -o 2 0 a b.png\n").rgba, ElementsAre(kWhite, kWhite, kGreen, kGreen, kNoColour));
  EXPECT_THAT(read("map_Kd none.png\n").rgba, IsEmpty());
  EXPECT_THAT(read("map_Kd none.png\n").warnings, ElementsAre(HasSubstr("none.png")));
  EXPECT_THAT(read("map_Kd my model.mtl\n").warnings, ElementsAre(HasSubstr("no picture that is known")));
  // Vertices keep their own colours where no picture lies; coordinates that are not there lay nothing.
  const RawScan both = read("map_Kd a b.png\n",
                            "mtllib my model.mtl\nv 0 0 0 0.5 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 1 0\n"
                            "vt 0.25 0.75\nusemtl wall\nf 1 2/1 3/7\n");
  EXPECT_THAT(both.rgba, ElementsAre(pack_rgba(128, 0, 0), kRed, kGreen));
}

TEST(ObjTexture, LibrariesAreAListAndMayBeNamedAnywhere) {
  const testing::ScanFolder folder;
  (void)folder.write("red.png", png_of(1, 1, {255, 0, 0}));
  (void)folder.write("blue.png", png_of(1, 1, {0, 0, 255}));
  (void)folder.write("m1.mtl", "newmtl A\nmap_Kd red.png # warm\n");
  (void)folder.write("m 2.mtl", "newmtl B # cold\nmap_Kd blue.png\nnewmtl C\nKd 1 1 1\n");
  const auto read = [&](const std::string& before, const std::string& behind, const char* first = "A",
                        const char* second = "B") {
    return folder.read("a.obj", before + "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nvt 0.5 0.5\n" + behind +
                                    "usemtl " + first + "\nf 1/1 2/1 3/1\nusemtl " + second + "\nf 4/1 5/1 6/1\n");
  };
  const auto both = ElementsAre(kRed, kRed, kRed, kBlue, kBlue, kBlue);
  for (const char* const line : {"mtllib m1.mtl m 2.mtl\n", "mtllib m 2.mtl\tm1.mtl # both\n",
                                 "mtllib m1.mtl\nmtllib m 2.mtl\n", "  mtllib m1.mtl none.mtl m 2.mtl\n"}) {
    for (const bool late : {false, true}) {
      const RawScan scan = read(late ? "" : line, late ? line : "");
      EXPECT_THAT(scan.rgba, both) << line << late;
      EXPECT_THAT(scan.warnings, IsEmpty());
      EXPECT_EQ(scan.notes.size(), std::string_view(line).find("none") == std::string_view::npos ? 0U : 1U);
    }
  }
  // A name behind a long text, across the parts in which it is looked for.
  for (std::size_t k = 0; k < 12; ++k) {
    const std::string remarks = "#" + std::string((std::size_t{1} << 22) - 8 + k, 'm') + "\n";
    EXPECT_THAT(read(remarks, "mtllib m1.mtl m 2.mtl\n").rgba, both) << k;
    EXPECT_THAT(read(remarks + "mtllib m1.mtl m 2.mtl\n", "").rgba, both) << k;
  }
  EXPECT_THAT(read("# mtllib m1.mtl\no mtllib m1.mtl\n", "").rgba, IsEmpty());
  // Remarks behind names, unless a material has that very name.
  EXPECT_THAT(read("mtllib m1.mtl m 2.mtl\n", "", "A # red", "B\t# blue").rgba, both);
  (void)folder.write("m1.mtl", "newmtl A\nmap_Kd red.png\nnewmtl A # red\nmap_Kd blue.png\n");
  EXPECT_THAT(read("mtllib m1.mtl m 2.mtl\n", "", "A", "A # red").rgba, both);
  const RawScan unknown = read("mtllib m1.mtl m 2.mtl\n", "", "A", "D");
  EXPECT_THAT(unknown.rgba, ElementsAre(kRed, kRed, kRed, kNoColour, kNoColour, kNoColour));
  EXPECT_THAT(unknown.warnings,
              ElementsAre(HasSubstr("faces use 1 material that the libraries do not have, 'D' first")));
  EXPECT_THAT(read("mtllib m1.mtl m 2.mtl\n", "", "A", "C").warnings, IsEmpty());
}

std::string ply_of(bool ascii, bool of_faces) {
  std::string bytes = "ply\nformat " + std::string(ascii ? "ascii" : "binary_big_endian") +
                      " 1.0\ncomment TextureFile none.png\ncomment TextureFile a.png\nelement vertex 4\n"
                      "property float x\nproperty float y\nproperty float z\n";
  if (!of_faces) bytes += "property float s\nproperty float t\n";
  bytes += "element face 2\nproperty list uchar int vertex_indices\n";
  if (of_faces) bytes += "property list uchar float texcoord\nproperty int texnumber\n";
  bytes += "end_header\n";
  const auto add = [&](auto value) {
    if (ascii) {
      bytes += std::to_string(value) + " ";
    } else {
      testing::put(bytes, value, true);
    }
  };
  const std::array<std::array<float, 2>, 4> at{{{0.25F, 0.25F}, {0.75F, 0.25F}, {0.75F, 0.75F}, {0.25F, 0.75F}}};
  for (const auto& [u, v] : at) {
    for (const float value : {u, v, 0.0F}) add(value);
    if (!of_faces) add(u), add(v);
    if (ascii) bytes += "\n";
  }
  for (const auto& face : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
    add(std::uint8_t{3});
    for (const int corner : face) add(corner);
    if (of_faces) {
      add(std::uint8_t{6});
      for (const int corner : face)
        for (const float value : at[static_cast<std::size_t>(corner)]) add(value);
      add(1);
    }
    if (ascii) bytes += "\n";
  }
  return bytes;
}

TEST(PlyTexture, BecomesTheColourOfVertices) {
  const testing::ScanFolder folder;
  (void)folder.write("a.png", four_colours());
  for (const bool ascii : {true, false}) {
    const RawScan by_faces = folder.read("a.ply", ply_of(ascii, true));
    EXPECT_THAT(by_faces.rgba, ElementsAre(kBlue, kWhite, kGreen, kRed)) << ascii;
    EXPECT_THAT(by_faces.warnings, IsEmpty());
    EXPECT_EQ(by_faces.fields.back(), "blue");
    EXPECT_THAT(by_faces.notes, ElementsAre("PLY: texture none.png", "PLY: texture a.png"));
    // Coordinates of vertices lie on the first picture, which is not there, where nothing says on which they lie.
    std::string by_vertices = ply_of(ascii, false);
    EXPECT_THAT(folder.read("a.ply", by_vertices).warnings,
                ElementsAre(HasSubstr("the first is taken for all"), HasSubstr("none.png")));
    by_vertices.erase(by_vertices.find("comment TextureFile none.png\n"), 29);
    EXPECT_THAT(folder.read("a.ply", by_vertices).rgba, ElementsAre(kBlue, kWhite, kGreen, kRed)) << ascii;
    // Cut short anywhere: an error of the body, whatever the coordinates.
    const std::string whole = ply_of(ascii, true);
    for (std::size_t size = whole.size() - 40; size + 2 < whole.size(); ++size)
      EXPECT_TRUE(testing::error_of_bytes("a.ply", whole.substr(0, size)).has_value() || ascii) << size;
  }
}

TEST(GltfTexture, ThatCannotBeReadIsSaid) {
  EXPECT_THAT(Painted("no picture").read().warnings, ElementsAre(HasSubstr("images[0]: no picture")));
  EXPECT_THAT(Painted(four_colours().substr(0, 60)).read().warnings, ElementsAre(HasSubstr("a PNG that cannot be")));
  Painted without(four_colours());
  without.primitive()["attributes"].erase("TEXCOORD_0");
  EXPECT_THAT(without.read().warnings, ElementsAre(HasSubstr("no coordinates")));
  Painted wild(four_colours());
  wild.root["textures"][0]["source"] = 7;
  EXPECT_THAT(wild.read().warnings, ElementsAre(HasSubstr("names images[7]")));
  wild.paint()["baseColorTexture"]["index"] = 5;
  EXPECT_THAT(wild.read().warnings, ElementsAre(HasSubstr("names textures[5]")));
}

}  // namespace
}  // namespace sparsha::pipeline

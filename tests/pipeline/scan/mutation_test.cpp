// Damaged files of every format, by the thousand: each gives points or Error{input}, at once; nothing else may happen.
#include <algorithm>
#include <cstdlib>
#include <random>
#include <string_view>

#include "pipeline/scan/read_bytes.h"
#include "tests/support/copc_file.h"
#include "tests/support/mended.h"
#include "tests/support/sanitized.h"
#include "tests/support/scan_files.h"
#include "tests/support/wave_files.h"

namespace sparsha::pipeline {
namespace {

using testing::put;

struct Seed {
  std::string name;
  std::string bytes;
  ReadOptions options{};
};

std::vector<Seed> seeds() {
  std::vector<Seed> result;
  const std::string xyz = "property float x\nproperty double y\nproperty short z\n";
  const std::string list = "element face 2\nproperty list uchar int vertex_indices\n";
  result.push_back({"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + list +
                                 "end_header\n0 0 0\n1 0.5 2\n-1e3 nan 7\n3 0 1 2\n4 0 1 2 0\n"});
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\nelement vertex 3\n" + xyz + "property list uint float q\n" + list +
                        "end_header\n";
    for (int i = 0; i < 3; ++i) {
      put(bytes, 1.5F, big);
      put(bytes, 2.5, big);
      put(bytes, std::int16_t{3}, big);
      put(bytes, static_cast<std::uint32_t>(i), big);
      for (int k = 0; k < i; ++k) put(bytes, 0.0F, big);
    }
    for (int i = 0; i < 2; ++i) {
      put(bytes, std::uint8_t{3});
      for (const int k : {0, 1, 2}) put(bytes, std::int32_t{k}, big);
    }
    result.push_back({big ? "b.ply" : "l.ply", bytes});
  }
  const auto pcd = [](const std::string& data) {
    return "VERSION .7\nFIELDS x y z rgb _\nSIZE 4 4 4 4 1\nTYPE F F F F U\nCOUNT 1 1 1 1 3\nWIDTH 2\nHEIGHT 1\n"
           "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
           data + "\n";
  };
  result.push_back({"a.pcd", pcd("ascii") + "1 2 3 4e-39 0 0 0\n4 5 nan 16711680 1 1 1\n"});
  result.push_back({"b.pcd", pcd("binary") + std::string(38, '\x3f')});
  std::string packed = pcd("binary_compressed");
  put(packed, std::uint32_t{6});
  put(packed, std::uint32_t{38});
  packed += std::string("\x01zz\xE0\x1B\x01", 6);
  result.push_back({"c.pcd", packed});
  result.push_back({"a.obj", "# x\nv 1 2 3\nv 1 2 4 0.5 0.5 0.5\nv -1 2e1 .4\nf 1//1 2/2 -1\nf 1 2 3 \\\n 1 2\n"});
  result.push_back(
      {"a.off", "COFF\n4 2 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n1 1 0 0 0 1 1\n0 1 nan 0 0 0 1\n3 0 1 2\n3 0 2 3 7\n"});
  const std::string json =
      "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[1,2,1]}],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{\"bufferView\":"
      "0,"
      "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,"
      "\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"
      "\"byteLength\":3}],\"buffers\":[{\"byteLength\":39}]} ";
  std::string glb = "glTF";
  put(glb, std::uint32_t{2});
  put(glb, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + 40));
  put(glb, static_cast<std::uint32_t>(json.size()));
  glb += "JSON" + json;
  put(glb, std::uint32_t{40});
  glb += std::string("BIN\0", 4);
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.5F}) put(glb, value);
  glb += std::string("\0\1\2\0", 4);
  result.push_back({"a.glb", glb});
  result.push_back({"b.off", "OFF 4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3\n"});
  result.push_back(
      {"a.asc", "ncols 3\nnrows 2\nxllcorner 0\nyllcenter 5,5\ncellsize 0,5\nNODATA_value -9\n1 2,5 3\n4 -9 6\n"});
  result.push_back({"a.grd", "DSAA\n3 2\n0 2\n0 1\n1 6\n1 2\n3\n\n4 1.70141e38\n6\n"});
  result.push_back({"a.xyz", "//X Y Z Rf Gf Bf\n3\n1 2 3 .5 .5 .5\n4 5 6 1 1 1\n7, 8; 9 0 0 0\n"});
  result.push_back({"a.csv", "\"x\";\"y\";\"z\"\n1,5;2,5;3,5\n;;\n1;2;3\n"});
  result.push_back(
      {"n.csv", "Nr,Remark,X [mm],Y [mm],Z [mm]\n-,-,mm,mm,mm\n1,\"a, b\",1,2,3\n2,north wall,4,5,-9999\n"});
  result.push_back({"n.txt", "2\n# Nr X Y Z\n1 2 3 4 left wall\nP 2 3 4\n"});
  std::string counted;
  for (int k = 0; k < 12; ++k) counted += std::to_string(k + 7) + ",1.5,2.5,1.70141E+38,10,20,30\n";
  result.push_back({"c.csv", counted});
  result.push_back({"d.csv", "\"x\",\"y\",\"z\"\n\"1,5\",\"2,25\",\"-9999\"\n1;2;3\n\"4,0\",5,\"0,5\"\n"});
  std::string tracks = "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (int k = 0; k < 12; ++k) {
    tracks += std::to_string(31 * k % 17) + " 0.5 1.5 2 1 2 3 0.71";
    for (int n = 0; n < 2 + k; ++n) tracks += " " + std::to_string(n) + " 7";
    tracks += "\n";
  }
  result.push_back({"points3D.txt", tracks});
  result.push_back({"k.txt",
                    "Name a b c\nP 1;1;2;3;9;1;2;3\nP 2;4;5;6;9;4;5;6\n",
                    {{"skip", "x", "y", "z", "skip", "red", "green", "blue"}}});
  result.push_back({"a.pts", "2\r\n1 2 3 -100 1 2 3\r\n1 2 3 -100 1 2 3\r\n1\n1 2 3 4 5 6 7\n"});
  result.push_back(
      {"a.ptx", "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n1 2 3 0.5\n0 0 0 0.5\n"});
  result.push_back({"a.stl",
                    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                    "endfacet\nendsolid a\n"});
  std::string stl(80, ' ');
  put(stl, std::uint32_t{1});
  stl += std::string(50, '\x3e');
  result.push_back({"b.stl", stl});
  std::string las(375 + 54 + 32 + 60, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1;
  las[25] = 4;
  const auto set = [&](std::size_t at, auto value) { std::memcpy(las.data() + at, &value, sizeof value); };
  set(94, std::uint16_t{375});
  set(96, std::uint32_t{375 + 54 + 32});
  set(100, std::uint32_t{1});
  set(105, std::uint16_t{30});
  las[104] = 6;
  for (std::size_t k = 0; k < 3; ++k) set(131 + 8 * k, 0.01);
  set(247, std::uint64_t{2});
  las.replace(375 + 2, 15, "LASF_Projection");
  set(375 + 18, std::uint16_t{2112});
  set(375 + 20, std::uint16_t{32});
  las.replace(375 + 54, 31, "PROJCS[\"p\",UNIT[\"foot\",0.3048]]");
  result.push_back({"a.las", las});
  // A COPC file whose second level stands in a page of its own, and splats.
  std::vector<testing::CopcNode> nodes(3);
  for (std::int32_t n = 0; n < 3; ++n) {
    nodes[static_cast<std::size_t>(n)].level = n;
    for (std::int32_t k = 0; k < 5; ++k) nodes[static_cast<std::size_t>(n)].points.push_back({k, 7 * k + n, k * k});
  }
  result.push_back({"a.copc.laz", testing::CopcFile(nodes, 1).bytes});
  std::string splats;
  for (int k = 0; k < 4; ++k) {
    for (const float value : {static_cast<float>(k), 2.F, 3.F, 0.01F, 0.02F, 0.001F}) put(splats, value);
    put(splats, 0xFF804020U);
    put(splats, 0x808080FFU);
  }
  result.push_back({"a.splat", splats});
  // Of the other formats, the same small surface; under sanitizers, which take many times as long, by night alone.
  if (SPARSHA_SANITIZED != 0 && std::getenv("SPARSHA_NIGHTLY") == nullptr) return result;
  const auto ending = [](std::string_view name) { return name.substr(name.rfind('.')); };
  for (const testing::WaveFile& wave : testing::wave_files()) {
    const bool there =
        std::ranges::any_of(result, [&](const Seed& seed) { return ending(seed.name) == ending(wave.name); });
    if (there) continue;
    const std::string bytes = wave.bytes({3}), contents = testing::bare(bytes, wave.name);
    result.push_back({std::string(wave.name), bytes});
    if (contents != bytes) result.push_back({std::string(wave.name), contents});
  }
  return result;
}

/// Changes bits, bytes and lengths, and repeats or drops pieces.
void mutate(std::string& bytes, std::mt19937& random) {
  static const char* const kWords[] = {"4000000000",           "-1", "nan", "1e999", "0",
                                       "99999999999999999999", ",",  ";",   "\\\n",  "\r"};
  const auto anywhere = [&] { return bytes.empty() ? 0 : random() % bytes.size(); };
  for (unsigned n = 1 + random() % 4; n > 0; --n) {
    switch (random() % 7) {
      case 0:
        if (!bytes.empty()) bytes[anywhere()] ^= static_cast<char>(1U << random() % 8);
        break;
      case 1:
        if (!bytes.empty()) bytes[anywhere()] = static_cast<char>(random());
        break;
      case 2:
        bytes.resize(anywhere());
        break;
      case 3:
        bytes.insert(anywhere(), kWords[random() % std::size(kWords)]);
        break;
      case 4:
        bytes.erase(anywhere(), random() % 9);
        break;
      case 5:
        bytes.insert(anywhere(), bytes.substr(anywhere(), random() % 64));
        break;
      default:
        if (bytes.size() >= 4) {
          const std::uint32_t word = random() % 2 == 0 ? 0xFFFFFFFFU : static_cast<std::uint32_t>(random());
          std::memcpy(bytes.data() + random() % (bytes.size() - 3), &word, 4);
        }
    }
  }
}

void expect_consistent(const RawScan& scan) {
  ASSERT_EQ(scan.records, scan.points.size() + scan.invalid);
  ASSERT_TRUE(scan.rgba.empty() || scan.rgba.size() == scan.points.size());
  ASSERT_TRUE(scan.intensity.empty() || scan.intensity.size() == scan.points.size());
  for (const auto& p : scan.points) ASSERT_TRUE(p.allFinite());
  for (const auto& face : scan.faces) {
    for (const std::uint32_t corner : face) ASSERT_LT(corner, scan.points.size());
  }
}

TEST(DamagedScans, GivePointsOrAnInputErrorWhateverTheDamage) {
  constexpr unsigned kSeed = 20240607;
  const char* const nightly = std::getenv("SPARSHA_NIGHTLY");
  const int rounds = nightly != nullptr ? 200000 : 2000;
  std::size_t read = 0;
  std::size_t refused = 0;
  for (const Seed& seed : seeds()) {
    ASSERT_NO_THROW((void)read_scan_bytes(testing::mended(seed.bytes, seed.name), seed.name, seed.options))
        << seed.name;
    std::mt19937 random(kSeed);
    for (int round = 0; round < rounds; ++round) {
      std::string bytes = seed.bytes;
      mutate(bytes, random);
      bytes = testing::mended(bytes, seed.name);
      SCOPED_TRACE(seed.name + ", seed " + std::to_string(kSeed) + ", round " + std::to_string(round));
      try {
        expect_consistent(read_scan_bytes(bytes, seed.name, seed.options));
        ++read;
      } catch (const Error& error) {
        ASSERT_EQ(error.kind(), ErrorKind::input) << error.what();
        ++refused;
      }
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(read, refused / 20) << "the damage is too coarse to tell anything";
}

}  // namespace
}  // namespace sparsha::pipeline

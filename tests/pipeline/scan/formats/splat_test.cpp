// Gaussian splats: .splat, SPZ and whole PLY; what is no surface is left out and counted; files that lie or are cut.
#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "pipeline/scan/formats/splat/splats.h"
#include "tests/pipeline/scan/formats/gltf_files.h"
#include "tests/support/deflated.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline {
namespace {

using ::testing::ElementsAre;
using testing::expect_refused;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::put;

struct Splat {
  std::array<double, 3> place{};
  std::array<double, 3> axes{0.01, 0.01, 0.001};
  std::array<int, 3> colour{128, 128, 128};
  double opacity = 1.0;
};

/// A grid of good ones, then one of each kind that is no surface.
std::vector<Splat> some_splats() {
  std::vector<Splat> splats;
  for (int i = 0; i < 40; ++i)
    splats.push_back({{0.125 * i, -0.25 * i, 1.0}, {0.01, 0.02, 0.001}, {i, 255 - i, 7}, 0.8});
  splats.push_back({{9.0, 9.0, 9.0}, {0.01, 0.01, 0.01}, {1, 2, 3}, 0.09});
  splats.push_back({{8.0, 8.0, 8.0}, {0.001, 0.47, 0.01}, {1, 2, 3}, 1.0});
  splats.push_back({{7.0, 7.0, 7.0}, {0.001, 0.34, 0.01}, {1, 2, 3}, 0.11});
  return splats;
}

std::string splat_file(const std::vector<Splat>& splats) {
  std::string bytes;
  for (const Splat& splat : splats) {
    for (const double x : splat.place) put(bytes, static_cast<float>(x));
    for (const double x : splat.axes) put(bytes, static_cast<float>(x));
    for (const int x : splat.colour) put(bytes, static_cast<std::uint8_t>(x));
    put(bytes, static_cast<std::uint8_t>(std::lround(255 * splat.opacity)));
    for (const int x : {255, 128, 128, 128}) put(bytes, static_cast<std::uint8_t>(x));
  }
  return bytes;
}

std::string gzip(const std::string& bytes) { return testing::deflated(bytes, 16 + MAX_WBITS); }

/// The stream within the gzip. Coordinates are exact in 1/4096 and, in version 1, as halves.
std::string spz_stream(const std::vector<Splat>& splats, std::uint32_t version, int degree = 0) {
  std::string bytes = "NGSP";
  put(bytes, version);
  put(bytes, static_cast<std::uint32_t>(splats.size()));
  for (const int x : {degree, 12, 0, 0}) put(bytes, static_cast<std::uint8_t>(x));
  for (const Splat& splat : splats) {
    for (const double x : splat.place) {
      if (version == 1) {
        int exponent = 0;
        const double fraction = std::frexp(std::fabs(x), &exponent);  // 0.5 to 1
        const int half = x == 0.0 ? 0 : (exponent + 14) << 10 | static_cast<int>((2 * fraction - 1) * 1024);
        put(bytes, static_cast<std::uint16_t>((x < 0 ? 0x8000 : 0) | half));
      } else {
        const auto fixed = static_cast<std::int32_t>(std::lround(x * 4096));
        for (const int shift : {0, 8, 16}) put(bytes, static_cast<std::uint8_t>(fixed >> shift & 255));
      }
    }
  }
  for (const Splat& splat : splats) put(bytes, static_cast<std::uint8_t>(std::lround(255 * splat.opacity)));
  for (const Splat& splat : splats) {
    for (const int x : splat.colour) {
      const double harmonic = (x / 255.0 - 0.5) / 0.28209479177387814;
      put(bytes, static_cast<std::uint8_t>(std::lround(255 * (0.5 + 0.15 * harmonic))));
    }
  }
  for (const Splat& splat : splats) {
    for (const double x : splat.axes) put(bytes, static_cast<std::uint8_t>(std::lround(16 * (std::log(x) + 10))));
  }
  constexpr std::array<std::size_t, 5> kHarmonics = {0, 9, 24, 45, 72};
  bytes.append(splats.size() * ((version == 3 ? 4 : 3) + kHarmonics[static_cast<std::size_t>(degree)]), '\x7F');
  return bytes;
}

enum class Opacities { logits, shares, bytes, whole_floats };

std::string ply_file(const std::vector<Splat>& splats, bool binary, Opacities kind = Opacities::logits) {
  std::string head = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") + " 1.0\n";
  head += "element vertex " + std::to_string(splats.size()) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                           "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    const bool byte = kind == Opacities::bytes && std::string_view(name) == "opacity";
    head += std::string(byte ? "property uchar " : "property float ") + name + "\n";
  }
  constexpr std::size_t kOpacity = 9;
  std::string body;
  for (const Splat& splat : splats) {
    std::vector<double> row(splat.place.begin(), splat.place.end());
    row.insert(row.end(), 3, 0.0);
    for (const int x : splat.colour) row.push_back((x / 255.0 - 0.5) / 0.28209479177387814);
    const double opacity = std::min(splat.opacity, 0.9999);
    row.push_back(kind == Opacities::logits   ? std::log(opacity / (1 - opacity))
                  : kind == Opacities::shares ? opacity
                                              : std::round(255 * opacity));
    for (const double x : splat.axes) row.push_back(std::log(x));
    row.insert(row.end(), {1.0, 0.0, 0.0, 0.0});
    for (std::size_t k = 0; k < row.size(); ++k) {
      const bool byte = kind == Opacities::bytes && k == kOpacity;
      if (!binary) {
        body += (byte ? std::to_string(std::lround(row[k])) : std::to_string(row[k])) + " ";
      } else if (byte) {
        put(body, static_cast<std::uint8_t>(row[k]));
      } else {
        put(body, static_cast<float>(row[k]));
      }
    }
    if (!binary) body += "\n";
  }
  return head + "end_header\n" + body;
}

/// The good ones, with the colours within `steps`, and what is said of the others.
void expect_sifted(const RawScan& scan, int steps) {
  const std::vector<Splat> splats = some_splats();
  EXPECT_EQ(scan.records, 43U);
  EXPECT_EQ(scan.invalid, 2U);
  ASSERT_EQ(scan.points.size(), 41U);
  for (std::size_t i = 0; i < 41; ++i) {
    const Splat& splat = splats[i < 40 ? i : 42];
    EXPECT_EQ(scan.points[i], Eigen::Vector3d(splat.place[0], splat.place[1], splat.place[2])) << i;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(static_cast<int>(scan.rgba[i] >> 8 * k & 255), splat.colour[k], steps) << i;
    }
  }
  EXPECT_THAT(scan.notes, ::testing::Contains(HasSubstr("Gaussian splats")));
  EXPECT_THAT(scan.warnings,
              ElementsAre(HasSubstr("2 of 43 splats are no surface and are counted as invalid: 1 have an "
                                    "opacity below 0.1, 1 an axis longer than 20 times")));
}

TEST(Splats, EveryFormatGivesTheSameSurface) {
  expect_sifted(read_scan_bytes(splat_file(some_splats()), "a.splat"), 0);
  // SPZ keeps colours in coarse steps, and axes in steps of 6 %.
  for (const std::uint32_t version : {1U, 2U, 3U}) {
    for (const int degree : {0, 1, 3, 4}) {
      const RawScan scan = read_scan_bytes(gzip(spz_stream(some_splats(), version, degree)), "a.spz");
      EXPECT_EQ(scan.format, "SPZ " + std::to_string(version));
      expect_sifted(scan, 2);
    }
  }
  for (const bool binary : {false, true}) {
    for (const Opacities kind : {Opacities::logits, Opacities::shares, Opacities::bytes, Opacities::whole_floats})
      expect_sifted(read_scan_bytes(ply_file(some_splats(), binary, kind), "a.ply"), 1);
  }
}

/// The stream in a GLB whose accessors have no bytes.
testing::gltf::Maker packed_gltf(const std::string& spz, std::size_t splats, const char* extension) {
  testing::gltf::Maker maker;
  const std::size_t view = maker.view(spz);
  maker.root["accessors"] = {{{"componentType", testing::gltf::kFloat}, {"count", splats}, {"type", "VEC3"}}};
  maker.root["extensionsRequired"] = {"KHR_gaussian_splatting", extension};
  maker.mesh({{"attributes", {{"POSITION", 0}, {"KHR_gaussian_splatting:SCALE", 0}}},
              {"mode", 0},
              {"extensions", {{"KHR_gaussian_splatting", {{"extensions", {{extension, {{"bufferView", view}}}}}}}}}});
  return maker;
}

TEST(Splats, AnSpzStreamInGltfIsTurnedIntoItsFrame) {
  const std::vector<Splat> splats = some_splats();
  for (const std::uint32_t version : {2U, 3U}) {
    const std::string spz = gzip(spz_stream(splats, version, 1));
    const RawScan alone = read_scan_bytes(spz, "a.spz");
    for (const char* name : {"KHR_gaussian_splatting_compression_spz_2", "KHR_gaussian_splatting_compression_spz"}) {
      testing::gltf::Maker maker = packed_gltf(spz, splats.size(), name);
      maker.root["nodes"][0]["translation"] = {10, 20, 30};
      const RawScan scan = read_scan_bytes(maker.glb(), "a.glb");
      ASSERT_EQ(scan.points.size(), 41U);
      EXPECT_EQ(scan.invalid, 2U);
      EXPECT_EQ(scan.rgba, alone.rgba);
      EXPECT_EQ(scan.warnings, alone.warnings);
      // Left, up, front of right, up, back: half a turn about the upright.
      EXPECT_EQ(scan.points[8], Eigen::Vector3d(10 - 1.0, 20 - 2.0, 30 - 1.0));
    }
  }
}

TEST(Splats, AnSpzStreamInGltfThatDoesNotFitIsToldWithItsPlace) {
  const char* const name = "KHR_gaussian_splatting_compression_spz_2";
  const std::vector<Splat> splats = some_splats();
  const std::string spz = gzip(spz_stream(splats, 2));
  expect_refused("a.glb", packed_gltf(spz, 1'000'000'000, name).glb(), "43 splats");
  expect_refused("a.glb", packed_gltf(spz.substr(0, 100), 43, name).glb(), "meshes[0].primitives[0].SPZ");
  testing::gltf::Maker maker = packed_gltf(spz, splats.size(), name);
  nlohmann::json& primitive = maker.root["meshes"][0]["primitives"][0];
  primitive["mode"] = 4;
  expect_refused("a.glb", maker.glb(), "mode 0");
  primitive["mode"] = 0;
  primitive["extensions"]["KHR_gaussian_splatting"]["extensions"][name] = 7;
  expect_refused("a.glb", maker.glb(), "no object");
}

TEST(Splats, OpacityIsAField) {
  ReadOptions options;
  options.fields = {"opacity"};
  std::vector<Splat> splats(2);
  splats[1].opacity = 0.4;
  for (const auto& [name, bytes] : {std::pair{"a.splat", splat_file(splats)}, {"a.spz", gzip(spz_stream(splats, 3))}}) {
    const RawScan scan = read_scan_bytes(bytes, name, options);
    ASSERT_EQ(scan.values.size(), 1U);
    EXPECT_THAT(scan.values[0], ElementsAre(1.0F, 0.4F)) << name;
  }
}

TEST(Splats, OpacitiesOfPlyAreSharesWhateverTheirScale) {
  ReadOptions options;
  options.fields = {"opacity"};
  std::vector<Splat> splats(2);
  splats[1].opacity = 0.4;
  for (const bool binary : {false, true}) {
    const RawScan scan = read_scan_bytes(ply_file(splats, binary, Opacities::bytes), "a.ply", options);
    ASSERT_EQ(scan.values.size(), 1U);
    EXPECT_THAT(scan.values[0], ElementsAre(1.0F, 0.4F));
    // All alike: bytes are still bytes, and a logit of 10 is opaque.
    splats[1].opacity = 1.0;
    const RawScan opaque = read_scan_bytes(ply_file(splats, binary, Opacities::bytes), "a.ply", options);
    EXPECT_THAT(opaque.values.at(0), ElementsAre(1.0F, 1.0F));
    std::string ten = ply_file(splats, false);
    for (std::size_t at = ten.find("9.210240"); at != std::string::npos; at = ten.find("9.210240"))
      ten.replace(at, 8, "10.00000");
    EXPECT_THAT(read_scan_bytes(ten, "a.ply", options).values.at(0), ::testing::Each(::testing::Gt(0.999F)));
    splats[1].opacity = 0.4;
  }
}

TEST(Splats, CoordinatesOfSpzHaveSignsAndHalvesTheirExtremes) {
  const std::vector<Splat> splats = {{{-2047.75, 2047.75, -0.000244140625}, {}, {}, 1.0}};
  const RawScan fixed = read_scan_bytes(gzip(spz_stream(splats, 2)), "a.spz");
  EXPECT_THAT(fixed.points, ElementsAre(Eigen::Vector3d(-2047.75, 2047.75, -0.000244140625)));
  std::string halves = spz_stream(splats, 1);
  // The smallest number of all, the greatest, and one that is not finite.
  const auto read = [&](std::uint16_t x) {
    std::memcpy(halves.data() + 16, &x, 2);
    return read_scan_bytes(gzip(halves), "a.spz");
  };
  EXPECT_EQ(read(0x0001).points.at(0).x(), std::ldexp(1.0, -24));
  EXPECT_EQ(read(0xFBFF).points.at(0).x(), -65504.0);
  EXPECT_EQ(read(0x7C00).invalid, 1U);
  EXPECT_EQ(read(0x7E00).invalid, 1U);
}

TEST(Splats, AFileThatIsCutIsRefused) {
  const std::string splats = splat_file(some_splats());
  for (std::size_t size = 1; size < splats.size(); ++size) {
    if (size % 32 != 0) expect_refused("a.splat", splats.substr(0, size), size < 32 ? "" : "no whole number of splats");
  }
  for (const std::uint32_t version : {1U, 3U}) {
    const std::string packed = gzip(spz_stream(some_splats(), version, 1));
    for (std::size_t size = 0; size < packed.size(); ++size) expect_refused("a.spz", packed.substr(0, size), "");
    const std::string stream = spz_stream(some_splats(), version, 1);
    for (std::size_t size = 4; size < stream.size(); ++size) {
      expect_refused("a.spz", gzip(stream.substr(0, size)), "the SPZ stream ends within its");
    }
  }
}

TEST(Splats, AnSpzHeaderThatLiesIsRefusedBeforeMemoryIsTaken) {
  const std::string stream = spz_stream(some_splats(), 3);
  const auto with = [&](std::size_t at, std::uint32_t value, std::size_t bytes) {
    std::string changed = stream;
    std::memcpy(changed.data() + at, &value, bytes);
    return gzip(changed);
  };
  expect_refused("a.spz", with(8, 0xFFFFFFFFU, 4), "4294967295 splats cannot be in");
  expect_refused("a.spz", with(8, 44, 4), "the SPZ stream ends within its turns and harmonics");
  expect_refused("a.spz", with(4, 4, 4), "SPZ version 4");
  expect_refused("a.spz", with(4, 0, 4), "SPZ version 0");
  expect_refused("a.spz", with(12, 5, 1), "SPZ harmonics of degree 5");
  expect_refused("a.spz", with(13, 24, 1), "SPZ coordinates with 24 fractional bits");
  expect_refused("a.spz", stream, "SPZ of version 4 or without its gzip stream");
  EXPECT_EQ(read_scan_bytes(gzip(stream + "extension"), "a.spz").points.size(), 41U);
  std::string wrong = gzip(stream);
  wrong[wrong.size() - 8] = static_cast<char>(wrong[wrong.size() - 8] ^ 1);  // the checksum
  expect_refused("a.spz", wrong, "does not end whole");
}

TEST(Splats, ChangedBytesGivePointsOrAnError) {
  std::mt19937 random(3);
  const std::pair<const char*, std::string> files[] = {{"a.splat", splat_file(some_splats())},
                                                       {"a.spz", gzip(spz_stream(some_splats(), 3))},
                                                       {"a.ply", ply_file(some_splats(), true)}};
  for (const auto& [name, bytes] : files) {
    for (int trial = 0; trial < 3000; ++trial) {
      std::string changed = bytes;
      for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<char>(random());
      try {
        const RawScan scan = read_scan_bytes(changed, name);
        EXPECT_EQ(scan.points.size() + scan.invalid, scan.records);
      } catch (const Error&) {
      }
    }
  }
}

TEST(Splats, WithoutAxesOrOfOneSizeNothingIsTooLong) {
  SplatSieve none;
  none.decide();
  EXPECT_TRUE(none.keeps(1.0, 1e30));
  SplatSieve zero;
  for (int i = 0; i < 3; ++i) zero.look_at(1.0, 0.0);
  zero.decide();
  EXPECT_TRUE(zero.keeps(1.0, 1.0));
  EXPECT_FALSE(zero.keeps(std::nextafter(0.1, 0.0), 1.0));
}

}  // namespace
}  // namespace sparsha::pipeline

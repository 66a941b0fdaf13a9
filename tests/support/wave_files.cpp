#include "tests/support/wave_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/scan/formats/e57/pages.h"
#include "tests/support/copc_file.h"
#include "tests/support/deflated.h"
#include "tests/support/las_files.h"
#include "tests/support/laz_encoder.h"

namespace sparsha::pipeline::testing {
namespace {

std::string rows(const Waves& waves, const char* lead = "") {
  std::string text;
  for (int n = 0; n < waves.points(); ++n)
    text += fmt::format("{}{:.4f} {:.4f} {:.6f}\n", lead, waves.x(n), waves.y(n), waves.z(n));
  return text;
}

std::string places(const Waves& waves) {
  std::string bytes;
  for (int n = 0; n < waves.points(); ++n) {
    for (const float value : {waves.x(n), waves.y(n), waves.z(n)}) put(bytes, value);
  }
  return bytes;
}

std::string ply(const Waves& waves, bool ascii) {
  return fmt::format(
             "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
             "z\nend_header\n",
             ascii ? "ascii" : "binary_little_endian", waves.points()) +
         (ascii ? rows(waves) : places(waves));
}

std::string pcd(const Waves& waves) {
  return fmt::format(
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 "
             "0 "
             "0\nPOINTS {0}\nDATA binary\n",
             waves.points()) +
         places(waves);
}

std::vector<std::string> las_points(const Waves& waves) {
  std::vector<std::string> points;
  const auto stored = [](float metres) { return static_cast<std::int32_t>(std::lround(1e5F * metres)); };
  for (int n = 0; n < waves.points(); ++n)
    points.push_back(las_point(0, stored(waves.x(n)), stored(waves.y(n)), stored(waves.z(n))));
  return points;
}

constexpr double kLasStep_m = 1e-5;  // of stored coordinates

/// A LAS header with that step.
std::string with_scale(std::string bytes) {
  for (std::size_t k = 0; k < 3; ++k) set(bytes, 131 + 8 * k, kLasStep_m);
  return bytes;
}

std::string las(const Waves& waves) {
  LasFile file;
  file.scale = 1e-5;
  file.points = las_points(waves);
  return file.bytes();
}

std::string laz(const Waves& waves) {
  constexpr std::size_t kEach = 50'000;
  const std::vector<std::string> points = las_points(waves);
  std::vector<std::vector<std::string>> chunks;
  for (std::size_t at = 0; at < points.size(); at += kEach) {
    chunks.emplace_back(points.begin() + static_cast<std::ptrdiff_t>(at),
                        points.begin() + static_cast<std::ptrdiff_t>(std::min(at + kEach, points.size())));
  }
  return with_scale(pack_las(chunks, kEach));
}

/// Points of format 6 in layers; each node is a child of the one before.
std::string copc(const Waves& waves) {
  constexpr int kEach = 50'000;
  std::vector<CopcNode> nodes;
  const auto stored = [](float metres) { return static_cast<std::int32_t>(std::lround(1e5F * metres)); };
  for (int n = 0; n < waves.points(); ++n) {
    if (n % kEach == 0) nodes.push_back({static_cast<int>(nodes.size()), {0, 0, 0}, {}});
    nodes.back().points.push_back({stored(waves.x(n)), stored(waves.y(n)), stored(waves.z(n))});
  }
  return with_scale(CopcFile(nodes).bytes);
}

/// Pages of 1020 bytes with their checksums around packets; each point has three floats and, with colours, a fourth for
/// its intensity and three bytes.
std::string e57(const Waves& waves, bool coloured) {
  constexpr std::size_t kPage = 1020;
  constexpr int kEach = 3000;  // points of a packet
  const auto physical = [](std::size_t at) { return static_cast<std::uint64_t>(at / kPage * 1024 + at % kPage); };
  const int reals = coloured ? 4 : 3, bytes = coloured ? 3 : 0;
  std::string packets;
  for (int from = 0; from < waves.points(); from += kEach) {
    const int count = std::min(kEach, waves.points() - from);
    const int size = 6 + 2 * (reals + bytes) + count * (4 * reals + bytes), padding = (4 - size % 4) % 4;
    put(packets, std::uint16_t{1});
    put(packets, static_cast<std::uint16_t>(size + padding - 1));
    put(packets, static_cast<std::uint16_t>(reals + bytes));
    for (int k = 0; k < reals + bytes; ++k) put(packets, static_cast<std::uint16_t>(k < reals ? 4 * count : count));
    for (int n = from; n < from + count; ++n) put(packets, waves.x(n));
    for (int n = from; n < from + count; ++n) put(packets, waves.y(n));
    for (int n = from; n < from + count; ++n) put(packets, waves.z(n));
    for (int n = from; coloured && n < from + count; ++n) put(packets, 0.5F + waves.z(n));
    for (int k = 0; k < bytes; ++k) {
      for (int n = from; n < from + count; ++n) put(packets, static_cast<std::uint8_t>(n >> 2 * k));
    }
    packets.append(static_cast<std::size_t>(padding), '\0');
  }
  std::string logical(48, '\0');
  put(logical, std::uint64_t{1});
  put(logical, static_cast<std::uint64_t>(32 + packets.size()));
  put(logical, physical(48 + 32));
  put(logical, std::uint64_t{0});
  logical += packets;
  const std::size_t xml_at = logical.size();
  std::string xml = fmt::format(
      "<e57Root type=\"Structure\"><data3D type=\"Vector\"><vectorChild type=\"Structure\"><points "
      "type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"{}\"><prototype type=\"Structure\">",
      waves.points());
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ", "intensity"}) {
    if (coloured || std::string_view(name) != "intensity")
      xml += fmt::format("<{} type=\"Float\" precision=\"single\"/>", name);
  }
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
    if (coloured) xml += fmt::format("<{} type=\"Integer\" minimum=\"0\" maximum=\"255\"/>", name);
  }
  xml += "</prototype><codecs type=\"Vector\"/></points></vectorChild></data3D></e57Root>";
  logical += xml;
  logical.resize((logical.size() + kPage - 1) / kPage * kPage, ' ');
  std::string head = "ASTM-E57";
  put(head, std::uint32_t{1});
  put(head, std::uint32_t{0});
  put(head, static_cast<std::uint64_t>(logical.size() / kPage * 1024));
  put(head, physical(xml_at));
  put(head, static_cast<std::uint64_t>(xml.size()));
  put(head, std::uint64_t{1024});
  logical.replace(0, head.size(), head);
  std::string file;
  for (std::size_t at = 0; at < logical.size(); at += kPage) {
    const std::string_view page = std::string_view(logical).substr(at, kPage);
    file += page;
    const std::uint32_t crc = sparsha::pipeline::e57::crc32c(page);
    for (const int shift : {24, 16, 8, 0}) file += static_cast<char>(crc >> shift & 255U);
  }
  return file;
}

std::string colmap(const Waves& waves) {
  std::string bytes;
  put(bytes, static_cast<std::uint64_t>(waves.points()));
  for (int n = 0; n < waves.points(); ++n) {
    put(bytes, static_cast<std::uint64_t>(n + 1));
    for (const float value : {waves.x(n), waves.y(n), waves.z(n)}) put(bytes, static_cast<double>(value));
    bytes.append("\x80\x80\x80", 3);
    put(bytes, 0.5);
    put(bytes, std::uint64_t{2});
    for (const std::uint32_t seen : {1U, 7U, 2U, 9U}) put(bytes, seen);
  }
  return bytes;
}

std::string ptx(const Waves& waves) {
  std::string text =
      fmt::format("{0}\n{0}\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", waves.side);
  for (int n = 0; n < waves.points(); ++n)
    text += fmt::format("{:.4f} {:.4f} {:.6f} 0.5\n", waves.x(n), waves.y(n), waves.z(n));
  return text;
}

std::string splat(const Waves& waves) {
  std::string bytes;
  for (int n = 0; n < waves.points(); ++n) {
    for (const float value : {waves.x(n), waves.y(n), waves.z(n), 0.001F, 0.001F, 0.0002F}) put(bytes, value);
    put(bytes, 0xFF808080U);
    put(bytes, 0x808080FFU);
  }
  return bytes;
}

std::string pts(const Waves& waves) {
  std::string text = fmt::format("{}\n", waves.points());
  for (int n = 0; n < waves.points(); ++n)
    text += fmt::format("{:.4f} {:.4f} {:.6f} -100 1 2 3\n", waves.x(n), waves.y(n), waves.z(n));
  return text;
}

/// Three lines of seven for each triangle.
std::string ascii_stl(const Waves& waves) {
  std::string text = "solid waves\n";
  waves.for_each_triangle([&](int a, int b, int c) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int n : {a, b, c})
      text += fmt::format("vertex {:.4f} {:.4f} {:.6f}\n", waves.x(n), waves.y(n), waves.z(n));
    text += "endloop\nendfacet\n";
  });
  return text + "endsolid waves\n";
}

std::string obj(const Waves& waves) {
  std::string text = rows(waves, "v ");
  waves.for_each_triangle([&](int a, int b, int c) { text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1); });
  return text;
}

std::string off(const Waves& waves) {
  std::string text = fmt::format("OFF\n{} {} 0\n", waves.points(), waves.triangles()) + rows(waves);
  waves.for_each_triangle([&](int a, int b, int c) { text += fmt::format("3 {} {} {}\n", a, b, c); });
  return text;
}

std::string stl(const Waves& waves) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(waves.triangles()));
  waves.for_each_triangle([&](int a, int b, int c) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0F);
    for (const int n : {a, b, c}) {
      for (const float value : {waves.x(n), waves.y(n), waves.z(n)}) put(bytes, value);
    }
    put(bytes, std::uint16_t{0});
  });
  return bytes;
}

/// Positions, then the corners of triangles.
std::string gltf_buffer(const Waves& waves) {
  std::string body = places(waves);
  waves.for_each_triangle([&](int a, int b, int c) {
    for (const int n : {a, b, c}) put(body, static_cast<std::uint32_t>(n));
  });
  return body;
}

/// `uri`: of the buffer, with its key; empty in a GLB.
std::string gltf_json(const Waves& waves, const std::string& uri) {
  const std::size_t first = std::size_t{12} * static_cast<std::size_t>(waves.points());
  const std::size_t rest = std::size_t{12} * static_cast<std::size_t>(waves.triangles());
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[)"
      R"({{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{},)"
      R"("type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,)"
      R"("byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],"buffers":[{{{}"byteLength":{}}}]}})",
      waves.points(), 3 * waves.triangles(), first, first, rest, uri, first + rest);
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8U | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += at + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::string gltf(const Waves& waves) {
  return gltf_json(waves, R"("uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer(waves)) + "\",");
}

std::string glb(const Waves& waves) {
  const std::string body = gltf_buffer(waves);
  std::string text = gltf_json(waves, "");
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(28 + text.size() + body.size()));
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  put(bytes, static_cast<std::uint32_t>(body.size()));
  return bytes + std::string("BIN\0", 4) + body;
}

/// Millimetres.
std::string threemf(const Waves& waves) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<model unit=\"millimeter\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" type=\"model\">"
      "<mesh><vertices>";
  for (int n = 0; n < waves.points(); ++n)
    text += fmt::format("<vertex x=\"{:.1f}\" y=\"{:.1f}\" z=\"{:.3f}\"/>\n", 1e3F * waves.x(n), 1e3F * waves.y(n),
                        1e3F * waves.z(n));
  text += "</vertices><triangles>";
  waves.for_each_triangle(
      [&](int a, int b, int c) { text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", a, b, c); });
  text += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
  return zipped({{"[Content_Types].xml", "<Types/>"}, {"3D/3dmodel.model", text}});
}

/// Version 2: 24 bits a coordinate, of which 12 are behind the point.
std::string spz(const Waves& waves) {
  std::string bytes = "NGSP";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(waves.points()));
  for (const int x : {0, 12, 0, 0}) put(bytes, static_cast<std::uint8_t>(x));
  for (int n = 0; n < waves.points(); ++n) {
    for (const float metres : {waves.x(n), waves.y(n), waves.z(n)}) {
      const auto fixed = static_cast<std::int32_t>(std::lround(4096.0F * metres));
      for (const int shift : {0, 8, 16}) put(bytes, static_cast<std::uint8_t>(fixed >> shift & 255));
    }
  }
  const auto each = [&](std::size_t count, std::uint8_t value) {
    bytes.append(count * static_cast<std::size_t>(waves.points()), static_cast<char>(value));
  };
  each(1, 200);  // opacity
  each(3, 128);  // colour
  each(3, 50);   // logarithms of axes
  each(3, 127);  // turns
  return deflated(bytes, 16 + 15);
}

/// Heights over rows of a grid, the last first.
std::string esri(const Waves& waves) {
  std::string text = fmt::format("ncols {0}\nnrows {0}\nxllcenter 0\nyllcenter 0\ncellsize 0.001\n", waves.side);
  for (int j = waves.side - 1; j >= 0; --j) {
    for (int i = 0; i < waves.side; ++i) text += fmt::format("{:.6f} ", waves.z(j * waves.side + i));
    text += '\n';
  }
  return text;
}

/// The same, the first row first.
std::string surfer(const Waves& waves) {
  const double last = 0.001 * (waves.side - 1);
  std::string text = fmt::format("DSAA\n{0} {0}\n0 {1}\n0 {1}\n-0.02 0.02\n", waves.side, last);
  for (int j = 0; j < waves.side; ++j) {
    for (int i = 0; i < waves.side; ++i) text += fmt::format("{:.6f} ", waves.z(j * waves.side + i));
    text += '\n';
  }
  return text;
}

constexpr std::array kFiles = {
    WaveFile{"XYZ", "waves.xyz", [](const Waves& waves) { return rows(waves); }},
    WaveFile{"PTS", "waves.pts", pts},
    WaveFile{"PLY", "ascii.ply", [](const Waves& waves) { return ply(waves, true); }},
    WaveFile{"PLY", "binary.ply", [](const Waves& waves) { return ply(waves, false); }},
    WaveFile{"PCD", "waves.pcd", pcd},
    WaveFile{"LAS", "waves.las", las},
    WaveFile{"LAZ", "waves.laz", laz},
    WaveFile{"LAZ", "waves.copc.laz", copc},
    WaveFile{"E57", "waves.e57", [](const Waves& waves) { return e57(waves, false); }},
    WaveFile{"E57", "coloured.e57", [](const Waves& waves) { return e57(waves, true); }},
    WaveFile{"COLMAP", "points3D.bin", colmap},
    WaveFile{"PTX", "waves.ptx", ptx},
    WaveFile{"splat", "waves.splat", splat},
    WaveFile{"SPZ", "waves.spz", spz},
    WaveFile{"ESRI", "waves.asc", esri},
    WaveFile{"Surfer", "waves.grd", surfer},
    WaveFile{"OBJ", "waves.obj", obj},
    WaveFile{"OFF", "waves.off", off},
    WaveFile{"STL", "waves.stl", stl},
    WaveFile{"STL", "ascii.stl", ascii_stl},
    WaveFile{"glTF", "waves.gltf", gltf},
    WaveFile{"GLB", "waves.glb", glb},
    WaveFile{"3MF", "waves.3mf", threemf},
};

}  // namespace

std::span<const WaveFile> wave_files() { return kFiles; }

}  // namespace sparsha::pipeline::testing

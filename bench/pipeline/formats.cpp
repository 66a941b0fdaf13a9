// Speed of each reader, points a second, beside the speed at which the file's bytes alone are read ("cat"): one surface
// in all formats that are simply written, and the real scans of SPARSHA_SCANS_DIR where it is set.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "bench/pipeline/run.h"
#include "pipeline/scan/formats/e57/pages.h"
#include "pipeline/scan/reader.h"
#include "tests/support/copc_file.h"
#include "tests/support/las_files.h"
#include "tests/support/laz_encoder.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using pipeline::testing::las_point;

template <typename T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// Waves over a square of side x side points, a millimetre apart.
struct Waves {
  int side = 0;

  [[nodiscard]] int points() const { return side * side; }
  [[nodiscard]] float x(int n) const { return 0.001F * static_cast<float>(n % side); }
  [[nodiscard]] float y(int n) const { return 0.001F * static_cast<float>(n / side); }
  [[nodiscard]] float z(int n) const { return 0.02F * std::sin(30.0F * x(n)) * std::cos(20.0F * y(n)); }
  /// Calls face(a, b, c) for two triangles a square.
  template <typename Face>
  void for_each_triangle(const Face& face) const {
    for (int j = 0; j + 1 < side; ++j) {
      for (int i = 0; i + 1 < side; ++i) {
        const int a = j * side + i;
        face(a, a + 1, a + side + 1);
        face(a, a + side + 1, a + side);
      }
    }
  }
  [[nodiscard]] int triangles() const { return 2 * (side - 1) * (side - 1); }
};

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

std::string las(const Waves& waves) {
  pipeline::testing::LasFile file;
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
  return pipeline::testing::pack_las(chunks, kEach);
}

/// Points of format 6 in layers; each node is a child of the one before.
std::string copc(const Waves& waves) {
  constexpr int kEach = 50'000;
  std::vector<pipeline::testing::CopcNode> nodes;
  const auto stored = [](float metres) { return static_cast<std::int32_t>(std::lround(1e5F * metres)); };
  for (int n = 0; n < waves.points(); ++n) {
    if (n % kEach == 0) nodes.push_back({static_cast<int>(nodes.size()), {0, 0, 0}, {}});
    nodes.back().points.push_back({stored(waves.x(n)), stored(waves.y(n)), stored(waves.z(n))});
  }
  return pipeline::testing::CopcFile(nodes).bytes;
}

/// Pages of 1020 bytes with their checksums around packets of single numbers.
std::string e57(const Waves& waves) {
  constexpr std::size_t kPage = 1020;
  constexpr int kEach = 4000;  // points of a packet
  const auto physical = [](std::size_t at) { return static_cast<std::uint64_t>(at / kPage * 1024 + at % kPage); };
  std::string packets;
  for (int from = 0; from < waves.points(); from += kEach) {
    const int count = std::min(kEach, waves.points() - from);
    const auto bytes = static_cast<std::uint16_t>(4 * count);
    put(packets, std::uint16_t{1});
    put(packets, static_cast<std::uint16_t>(12 + 3 * bytes - 1));
    put(packets, std::uint16_t{3});
    for (int k = 0; k < 3; ++k) put(packets, bytes);
    for (int n = from; n < from + count; ++n) put(packets, waves.x(n));
    for (int n = from; n < from + count; ++n) put(packets, waves.y(n));
    for (int n = from; n < from + count; ++n) put(packets, waves.z(n));
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
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    xml += fmt::format("<{} type=\"Float\" precision=\"single\"/>", name);
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
  std::string bytes;
  for (std::size_t at = 0; at < logical.size(); at += kPage) {
    const std::string_view page = std::string_view(logical).substr(at, kPage);
    bytes += page;
    const std::uint32_t crc = pipeline::e57::crc32c(page);
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(crc >> shift & 255U);
  }
  return bytes;
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

std::string glb(const Waves& waves) {
  std::string body = places(waves);
  const std::size_t first = body.size();
  waves.for_each_triangle([&](int a, int b, int c) {
    for (const int n : {a, b, c}) put(body, static_cast<std::uint32_t>(n));
  });
  std::string text = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[)"
      R"({{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{},)"
      R"("type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,)"
      R"("byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],"buffers":[{{"byteLength":{}}}]}})",
      waves.points(), 3 * waves.triangles(), first, first, body.size() - first, body.size());
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(28 + text.size() + body.size()));
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  put(bytes, static_cast<std::uint32_t>(body.size()));
  return bytes + std::string("BIN\0", 4) + body;
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

/// Seconds of processor time, all threads together, the least of several.
double least_cpu(const std::function<void()>& work) {
  constexpr int kTimes = 5;
  double least = 1e300;
  for (int k = 0; k < kTimes; ++k) {
    const std::clock_t from = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC);
  }
  return std::max(least, 1e-6);
}

std::size_t cat(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  std::size_t bytes = 0;
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0)
    bytes += static_cast<std::size_t>(in.gcount());
  return bytes;
}

class Table {
 public:
  explicit Table(const fs::path& file) : csv_(file) {
    csv_ << "format,file,points,megabytes,points_per_s,megabytes_per_s,cat_megabytes_per_s\n";
    fmt::print("\n## Readers, processor time, beside reading the bytes alone\n\n");
    fmt::print("| format | file | points | MB | M points/s | MB/s | cat, MB/s |\n|---|---|---|---|---|---|---|\n");
  }
  void row(const fs::path& file) {
    std::string format;
    std::uint64_t points = 0;
    const double seconds = least_cpu([&] {
      const pipeline::RawScan scan = pipeline::read_scan(file);
      format = scan.format;
      points = scan.records;
    });
    const double cat_seconds = least_cpu([&] { (void)cat(file); });
    const double megabytes = static_cast<double>(fs::file_size(file)) * 1e-6;
    const double rate = static_cast<double>(points) / seconds;
    fmt::print("| {} | {} | {} | {:.1f} | {:.2f} | {:.0f} | {:.0f} |\n", format, file.filename().string(), points,
               megabytes, 1e-6 * rate, megabytes / seconds, megabytes / cat_seconds);
    csv_ << fmt::format("\"{}\",\"{}\",{},{},{},{},{}\n", format, file.filename().string(), points, megabytes, rate,
                        megabytes / seconds, megabytes / cat_seconds);
    csv_.flush();
  }

 private:
  std::ofstream csv_;
};

/// Real scans of a megabyte and more, which say what they are worth only together with their size.
void add_real_scans(Table& table) {
  const char* const folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) return;
  std::vector<fs::path> files;
  for (const char* part : {"scans", "heritage"}) {
    std::error_code code;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(folder) / part, code)) {
      if (entry.is_regular_file() && entry.file_size() >= 1'000'000) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    try {
      table.row(file);
    } catch (const Error&) {
      continue;  // what is no scan
    }
  }
}

}  // namespace

void run_formats(const RunOptions& options) {
  fs::create_directories(options.work);
  const Waves waves{options.quick ? 300 : 1000};
  Table table(options.out / "pipeline_formats.csv");
  const auto measure = [&](const char* name, const std::string& bytes) {
    const fs::path file = options.work / name;
    write_file(file, bytes);
    table.row(file);
    fs::remove(file);
  };
  measure("waves.xyz", rows(waves));
  measure("ascii.ply", ply(waves, true));
  measure("binary.ply", ply(waves, false));
  measure("waves.pcd", pcd(waves));
  measure("waves.las", las(waves));
  measure("waves.laz", laz(waves));
  measure("waves.copc.laz", copc(waves));
  measure("waves.e57", e57(waves));
  measure("points3D.bin", colmap(waves));
  measure("waves.ptx", ptx(waves));
  measure("waves.splat", splat(waves));
  measure("waves.asc", esri(waves));
  measure("waves.obj", obj(waves));
  measure("waves.off", off(waves));
  measure("waves.stl", stl(waves));
  measure("waves.glb", glb(waves));
  add_real_scans(table);
}

}  // namespace sparsha::bench

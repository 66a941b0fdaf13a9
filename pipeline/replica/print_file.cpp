#include "pipeline/replica/print_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <minizip/zip.h>

#include "base/error.h"
#include "base/text/lower_case.h"

namespace sparsha::pipeline {
namespace {

static_assert(std::endian::native == std::endian::little);

[[noreturn]] void fail(const std::string& shown, const char* why) {
  throw Error(ErrorKind::failure, {shown, 0, 0}, std::string("cannot be written: ") + why, "a folder with room for it");
}

/// One file inside a 3MF package, written in pieces.
class Part {
 public:
  Part(zipFile package, const char* name, const std::string& shown) : package_(package), shown_(shown) {
    zip_fileinfo info{};
    info.tmz_date = {0, 0, 0, 1, 0, 1980};  // the same replica gives the same bytes
    constexpr int kFastLevel = 3;
    if (zipOpenNewFileInZip64(package_, name, &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, kFastLevel, 1) !=
        ZIP_OK)
      fail(shown_, "the package takes no further part");
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  ~Part() {
    if (open_) zipCloseFileInZip(package_);
  }
  void write(std::string_view text) {
    held_ += text;
    if (held_.size() > kPiece) flush();
  }
  void flush() {
    if (!held_.empty() && zipWriteInFileInZip(package_, held_.data(), static_cast<unsigned>(held_.size())) != ZIP_OK)
      fail(shown_, "the disk is full");
    held_.clear();
  }
  /// The last compressed bytes are written here.
  void close() {
    flush();
    open_ = false;
    if (zipCloseFileInZip(package_) != ZIP_OK) fail(shown_, "the disk is full");
  }

 private:
  static constexpr std::size_t kPiece = 1U << 20U;
  zipFile package_;
  const std::string& shown_;
  std::string held_;
  bool open_ = true;
};

constexpr std::string_view kContentTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
constexpr std::string_view kRelations =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

/// The different colours of a mesh's vertices, as the format numbers them.
class Palette {
 public:
  explicit Palette(const PrintedMesh& mesh) {
    if (!mesh.has_colours()) return;
    colours_.reserve(mesh.vertices());
    for (std::uint32_t i = 0; i < mesh.vertices(); ++i) colours_.push_back(shown(mesh.colour(i)));
    std::sort(colours_.begin(), colours_.end());
    colours_.erase(std::unique(colours_.begin(), colours_.end()), colours_.end());
  }
  [[nodiscard]] bool empty() const { return colours_.empty(); }
  void write(Part& part) const {
    part.write("<m:colorgroup id=\"2\">\n");
    for (const std::uint32_t rgb : colours_)
      part.write(fmt::format("<m:color color=\"#{:02X}{:02X}{:02X}\"/>\n", rgb & 0xFFU, rgb >> 8U & 0xFFU, rgb >> 16U));
    part.write("</m:colorgroup>\n");
  }
  [[nodiscard]] std::size_t number(std::uint32_t rgba) const {
    return static_cast<std::size_t>(std::lower_bound(colours_.begin(), colours_.end(), shown(rgba)) - colours_.begin());
  }

 private:
  static std::uint32_t shown(std::uint32_t rgba) { return rgba == 0 ? 0xFFFFFFU : rgba & 0xFFFFFFU; }
  std::vector<std::uint32_t> colours_;  // rising
};

void write_model(const PrintedMesh& solid, Part& part, Progress& progress) {
  const Palette palette(solid);
  part.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"");
  if (!palette.empty()) part.write(" xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"");
  part.write(">\n<resources>");
  if (!palette.empty()) palette.write(part);
  part.write("<object id=\"1\" type=\"model\" name=\"" + solid.name() + "\"");
  if (!palette.empty()) part.write(" pid=\"2\" pindex=\"0\"");  // asked for where triangles have properties
  part.write("><mesh><vertices>\n");
  constexpr std::uint32_t kLook = 1U << 14U;
  for (std::uint32_t i = 0; i < solid.vertices(); ++i) {
    if (i % kLook == 0) progress.at(0.3 * i / solid.vertices());
    const PointMm p = solid.vertex(i);
    part.write(fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p[0], p[1], p[2]));
  }
  part.write("</vertices><triangles>\n");
  solid.for_each_triangle(
      [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        part.write(fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"", a, b, c));
        if (!palette.empty())
          part.write(fmt::format(" pid=\"2\" p1=\"{}\" p2=\"{}\" p3=\"{}\"", palette.number(solid.colour(a)),
                                 palette.number(solid.colour(b)), palette.number(solid.colour(c))));
        part.write("/>\n");
      },
      [&](double share) { progress.at(0.3 + 0.7 * share); });
  part.write("</triangles></mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n");
  part.close();
}

void write_stl(const PrintedMesh& solid, const std::filesystem::path& file, const std::string& shown,
               Progress& progress) {
  if (solid.triangles() > 0xFFFFFFFFULL) fail(shown, "more triangles than the format can count");
  std::ofstream out(file, std::ios::binary);
  std::array<char, 80> title{};
  const std::string text = solid.name() + ", millimetres";
  std::copy_n(text.begin(), std::min(text.size(), title.size()), title.begin());
  out.write(title.data(), title.size());
  const auto count = static_cast<std::uint32_t>(solid.triangles());
  out.write(reinterpret_cast<const char*>(&count), sizeof count);
  constexpr std::size_t kRecord = 50;
  std::vector<char> held;
  held.reserve(kRecord << 15U);
  const auto flush = [&] {
    out.write(held.data(), static_cast<std::streamsize>(held.size()));
    held.clear();
  };
  solid.for_each_triangle(
      [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const std::array<PointMm, 3> corners{solid.vertex(a), solid.vertex(b), solid.vertex(c)};
        std::array<double, 3> u{}, v{};
        for (std::size_t k = 0; k < 3; ++k) {
          u[k] = static_cast<double>(corners[1][k]) - static_cast<double>(corners[0][k]);
          v[k] = static_cast<double>(corners[2][k]) - static_cast<double>(corners[0][k]);
        }
        std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        std::array<float, 12> numbers{};
        for (std::size_t k = 0; k < 3; ++k) numbers[k] = length > 0.0 ? static_cast<float>(n[k] / length) : 0.0F;
        for (std::size_t k = 0; k < 9; ++k) numbers[3 + k] = corners[k / 3][k % 3];
        const std::size_t at = held.size();
        held.resize(at + kRecord);
        std::memcpy(held.data() + at, numbers.data(), sizeof numbers);
        if (held.size() + kRecord > held.capacity()) flush();
      },
      [&](double share) { progress.at(share); });
  flush();
  if (!out.flush()) fail(shown, "the disk is full");
}

void write_3mf(const PrintedMesh& solid, const std::filesystem::path& file, const std::string& shown,
               Progress& progress) {
  const zipFile package = zipOpen64(file.c_str(), APPEND_STATUS_CREATE);
  if (package == nullptr) fail(shown, "the place cannot be written to");
  try {
    const auto small = [&](const char* name, std::string_view text) {
      Part part(package, name, shown);
      part.write(text);
      part.close();
    };
    small("[Content_Types].xml", kContentTypes);
    small("_rels/.rels", kRelations);
    Part model(package, "3D/3dmodel.model", shown);
    write_model(solid, model, progress);
  } catch (...) {
    zipClose(package, nullptr);
    throw;
  }
  if (zipClose(package, nullptr) != ZIP_OK) fail(shown, "the disk is full");
}

}  // namespace

void write_print_file(const PrintedMesh& mesh, const std::filesystem::path& file, const std::string& shown,
                      Progress& progress) {
  if (ending_of(shown) == ".stl")
    write_stl(mesh, file, shown, progress);
  else
    write_3mf(mesh, file, shown, progress);
}

}  // namespace sparsha::pipeline

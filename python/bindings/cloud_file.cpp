#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/system.h"
#include "pipeline/scan/fields.h"
#include "python/bindings/cloud.hpp"

namespace sparsha::python {
namespace {

/// Whether the file has it from `fields`: not what stands in it by that name already, such as normals.
bool is_written(const pipeline::Cloud& cloud, const pipeline::PointField& field) {
  if (field.name == pipeline::kIntensityField) return cloud.intensity.empty();
  return !pipeline::is_known_otherwise(field.name);
}

std::string header_of(const pipeline::Cloud& cloud) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(cloud.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!cloud.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!cloud.rgba.empty()) {
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  }
  if (!cloud.intensity.empty()) text += "property float intensity\n";
  for (const pipeline::PointField& field : cloud.fields) {
    if (is_written(cloud, field)) text += "property float " + field.name + "\n";
  }
  if (!cloud.faces.empty()) {
    text += "element face " + std::to_string(cloud.faces.size()) + "\nproperty list uchar uint vertex_indices\n";
  }
  return text + "end_header\n";
}

/// Bytes that go to the file by the megabyte.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary) {}
  template <typename Value>
  void put(const Value& value) {
    const auto* const bytes = reinterpret_cast<const char*>(&value);
    buffer_.insert(buffer_.end(), bytes, bytes + sizeof(Value));
    if (buffer_.size() > kBuffer) flush();
  }
  void put_text(const std::string& text) { buffer_.insert(buffer_.end(), text.begin(), text.end()); }
  void close() {
    flush();
    stream_.close();
    if (!stream_) {
      throw Error(ErrorKind::failure, {file_.string(), 0, 0}, "the cloud cannot be written for the build",
                  "room in the folder for temporary files (TMPDIR)");
    }
  }

 private:
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;
  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<char> buffer_;
};

// No two clouds of a process share a name: each would take the other's folder for what a dead process has left.
std::filesystem::path own_folder() {
  static std::atomic<unsigned> made{0};
  return system::temporary_folder() /
         ("sparsha-" + std::to_string(system::process_id()) + "-" + std::to_string(made++));
}

}  // namespace

CloudFile::CloudFile(const pipeline::Cloud& cloud) : cloud_(cloud), folder_(own_folder(), AtomicPath::Kind::folder) {}

void CloudFile::write(Progress& progress) const {
  constexpr std::size_t kLook = std::size_t{1} << 16;
  const pipeline::Cloud& cloud = cloud_;
  Bytes bytes(path());
  bytes.put_text(header_of(cloud));
  const float* const xyz1 = cloud.xyz1();
  for (std::size_t n = 0; n < cloud.size(); ++n) {
    if (n % kLook == 0) progress.throw_if_cancelled();
    for (int axis = 0; axis < 3; ++axis) {
      bytes.put(cloud.origin_m[axis] + static_cast<double>(xyz1[4 * n + static_cast<std::size_t>(axis)]));
    }
    if (!cloud.normals.empty()) {
      for (int axis = 0; axis < 3; ++axis) bytes.put(cloud.normals[n][axis]);
    }
    if (!cloud.rgba.empty()) bytes.put(cloud.rgba[n]);
    if (!cloud.intensity.empty()) bytes.put(cloud.intensity[n]);
    for (const pipeline::PointField& field : cloud.fields) {
      if (is_written(cloud, field)) bytes.put(field.values[n]);
    }
  }
  for (const std::array<std::uint32_t, 3>& face : cloud.faces) {
    bytes.put(std::uint8_t{3});
    bytes.put(face);
  }
  bytes.close();
}

}  // namespace sparsha::python

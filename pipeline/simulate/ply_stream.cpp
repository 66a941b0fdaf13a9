// The header keeps its length whatever the count: a comment takes up what the number does not need.
#include "pipeline/simulate/ply_stream.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kCountDigits = 20;  // of the largest 64-bit number

template <typename Word>
void put(std::vector<char>& buffer, Word word) {
  static_assert(std::endian::native == std::endian::little, "PLY files are written little-endian");
  const std::size_t at = buffer.size();
  buffer.resize(at + sizeof(word));
  std::memcpy(&buffer[at], &word, sizeof(word));
}

}  // namespace

PlyStream::PlyStream(const std::filesystem::path& file, std::string shown, const Fields& fields,
                     const std::string& comment)
    : stream_(file, std::ios::binary), shown_(std::move(shown)), fields_(fields), comment_(comment) {
  stream_ << header();
  check();
}

std::string PlyStream::header() const {
  const std::string count = std::to_string(count_);
  const char* type = fields_.double_precision ? "double" : "float";
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + comment_ + "\ncomment " +
                     std::string(kCountDigits - count.size(), '.') + "\nelement vertex " + count + "\n";
  for (const char* axis : {"x", "y", "z"}) text += fmt::format("property {} {}\n", type, axis);
  if (fields_.intensity) text += "property float intensity\n";
  if (fields_.colour) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text + "end_header\n";
}

void PlyStream::append(std::span<const SimulatedPoint> points, const Eigen::Matrix3d& rotation,
                       const Eigen::Vector3d& origin_m) {
  buffer_.clear();
  for (const SimulatedPoint& point : points) {
    const Eigen::Vector3d p = rotation.transpose() * (point.position_m - origin_m);
    for (int axis = 0; axis < 3; ++axis) {
      if (fields_.double_precision) {
        put(buffer_, p[axis]);
      } else {
        put(buffer_, static_cast<float>(p[axis]));
      }
    }
    if (fields_.intensity) put(buffer_, point.intensity);
    if (fields_.colour) {
      for (unsigned shift : {0U, 8U, 16U}) put(buffer_, static_cast<std::uint8_t>(point.rgba >> shift));
    }
  }
  stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  count_ += points.size();
  check();
}

void PlyStream::close() {
  stream_.seekp(0);
  stream_ << header();
  stream_.close();
  check();
}

void PlyStream::check() {
  if (!stream_) {
    throw Error(ErrorKind::failure, {shown_, 0, 0}, "cannot be written: the disk may be full or the folder read-only",
                "expected a folder that can be written to");
  }
}

}  // namespace sparsha::pipeline

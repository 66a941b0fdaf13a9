// Files that printers' programs read: binary STL and 3MF, in millimetres.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "base/threads/progress.h"

namespace sparsha::pipeline {

using PointMm = std::array<float, 3>;

/// A closed mesh that is turned outwards.
class PrintedMesh {
 public:
  /// Calls that are made for each triangle, counter-clockwise as seen from outside, and now and then with the share
  /// that is done.
  using ForTriangle = std::function<void(std::uint32_t a, std::uint32_t b, std::uint32_t c)>;
  using ForShare = std::function<void(double share)>;

  virtual ~PrintedMesh() = default;
  /// What it is, in one word: "relief".
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::uint32_t vertices() const = 0;
  [[nodiscard]] virtual std::uint64_t triangles() const = 0;
  [[nodiscard]] virtual PointMm vertex(std::uint32_t number) const = 0;
  [[nodiscard]] virtual bool has_colours() const { return false; }
  /// 0xAABBGGRR; 0: none.
  [[nodiscard]] virtual std::uint32_t colour(std::uint32_t /*number*/) const { return 0; }
  virtual void for_each_triangle(const ForTriangle& triangle, const ForShare& row) const = 0;

 protected:
  PrintedMesh() = default;
  PrintedMesh(const PrintedMesh&) = default;
  PrintedMesh& operator=(const PrintedMesh&) = default;
};

/// As STL or 3MF, told by the ending of `shown`, the name in messages. Colours go to 3MF, white where a vertex has none
/// (3MF Materials and Properties Extension 1.2.1). The same mesh gives the same bytes. Throws
/// Error{failure} when the file cannot be written.
void write_print_file(const PrintedMesh& mesh, const std::filesystem::path& file, const std::string& shown,
                      Progress& progress);

}  // namespace sparsha::pipeline

// Colours of vertices from pictures whose coordinates the faces have.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scan/file.h"
#include "pipeline/scan/formats/texture/texture.h"

namespace sparsha::pipeline {

/// First everything is laid, then the pictures are read one by one, so that one alone is in memory.
class Paint {
 public:
  /// As scans name it, with what is beyond its border. The same name is the same picture.
  std::uint32_t picture(const std::string& name, Wrap wrap = Wrap::repeat);
  /// The place of a vertex on a picture, from the *bottom* left corner; of several, as along a seam, the first counts.
  void lay(std::uint64_t vertex, std::uint32_t picture, double u, double v);
  /// Reads the pictures, which lie beside the scan; those that cannot be read are warnings.
  void dry(const ScanFile& file, std::vector<std::string>& warnings);

  /// Whether any vertex has a colour.
  [[nodiscard]] bool any() const { return any_; }
  /// After dry(): kNoColour where no picture lies.
  [[nodiscard]] std::uint32_t operator[](std::uint64_t vertex) const;

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  struct Spot {
    std::uint32_t picture = kNone;
    float u = 0.0F, v = 0.0F;
  };
  struct Named {
    std::string name;
    Wrap wrap = Wrap::repeat;
  };
  void colour(const ScanFile& file, std::uint32_t number);

  std::vector<Named> names_;
  std::map<std::pair<std::string, Wrap>, std::uint32_t> numbers_;
  std::vector<Spot> spots_;
  std::vector<std::uint32_t> rgba_;
  bool any_ = false;
};

}  // namespace sparsha::pipeline

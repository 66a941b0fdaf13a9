// Which vertices a primitive of a glTF mesh gives, where primitives share an accessor of positions.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/formats/gltf/accessor.hpp"

namespace sparsha::pipeline::gltf {

/// Each primitive that has indices gives the vertices that they name. Those that no primitive names are given by the
/// first mesh that shows their accessor at a place, so that no points are lost; of points those alone are drawn that
/// indices name (specification, 3.7.2).
class SharedVertices {
 public:
  /// Of an accessor of positions.
  struct Use {
    std::uint64_t accessor = 0;
    std::uint64_t size = 0;
    const Accessor* indices = nullptr;  ///< none: all vertices are given
    bool points = false;
  };

  /// To be called for each primitive of each mesh that is shown, once.
  void look_at(const Use& use);
  /// After all looks: vertices that indices of points name and that do not exist, and those that nothing gives.
  [[nodiscard]] std::uint64_t missing() const { return missing_; }
  [[nodiscard]] std::uint64_t unnamed() const;

  /// An instance begins; primitives stand at this place from now on.
  void stand_at(const Eigen::Matrix4d& place);
  /// All instances come again.
  void begin_again() { given_.clear(); }
  /// At most so many vertices are given by the primitive at the present place. To be called as given_by() would be.
  [[nodiscard]] std::uint64_t most_given_by(const Use& use);
  /// Vertices that the primitive gives at the present place, ascending; nothing: all of them.
  [[nodiscard]] std::optional<std::vector<std::uint32_t>> given_by(const Use& use);

 private:
  struct Accessed {
    std::uint64_t uses = 0;
    std::vector<bool> named{};  ///< empty: none yet
    bool points_alone = true;   ///< with indices: what they do not name is not given
  };
  using Bits = std::array<std::uint64_t, 16>;

  [[nodiscard]] bool comes_first(const Use& use);

  std::map<std::uint64_t, Accessed> accessors_;
  std::uint64_t missing_ = 0;
  std::map<Bits, std::uint64_t> places_;
  std::uint64_t place_ = 0;                                  ///< number of the present one
  std::set<std::pair<std::uint64_t, std::uint64_t>> given_;  ///< accessors at places
};

}  // namespace sparsha::pipeline::gltf

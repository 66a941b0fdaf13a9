#include "pipeline/scan/formats/gltf/shared_vertices.hpp"

#include <algorithm>
#include <bit>

namespace sparsha::pipeline::gltf {
namespace {

template <typename Visit>
void each_named(const SharedVertices::Use& use, const Visit& visit) {
  for (std::uint64_t k = 0; k < use.indices->size(); ++k) {
    const std::uint32_t index = use.indices->index(k);
    if (index < use.size) visit(index);
  }
}

}  // namespace

void SharedVertices::look_at(const Use& use) {
  Accessed& accessed = accessors_[use.accessor];
  ++accessed.uses;
  accessed.named.resize(static_cast<std::size_t>(use.size));
  accessed.points_alone = accessed.points_alone && use.points && use.indices != nullptr;
  if (use.indices == nullptr) {
    accessed.named.assign(accessed.named.size(), true);
  } else {
    std::uint64_t there = 0;
    each_named(use, [&](std::uint32_t index) {
      accessed.named[index] = true;
      ++there;
    });
    if (use.points) missing_ += use.indices->size() - there;
  }
}

std::uint64_t SharedVertices::unnamed() const {
  std::uint64_t count = 0;
  for (const auto& [accessor, accessed] : accessors_) {
    if (accessed.points_alone)
      count += static_cast<std::uint64_t>(std::count(accessed.named.begin(), accessed.named.end(), false));
  }
  return count;
}

void SharedVertices::stand_at(const Eigen::Matrix4d& place) {
  Bits bits{};
  for (std::size_t k = 0; k < bits.size(); ++k) {
    bits[k] = std::bit_cast<std::uint64_t>(place.data()[k]);
  }
  place_ = places_.try_emplace(bits, places_.size()).first->second;
}

bool SharedVertices::comes_first(const Use& use) { return given_.emplace(use.accessor, place_).second; }

std::uint64_t SharedVertices::most_given_by(const Use& use) {
  if (use.indices == nullptr || (!use.points && comes_first(use))) return use.size;
  return std::min(use.size, use.indices->size());
}

std::optional<std::vector<std::uint32_t>> SharedVertices::given_by(const Use& use) {
  if (use.indices == nullptr) return std::nullopt;
  std::vector<std::uint32_t> vertices;
  if (use.points || !comes_first(use)) {
    vertices.reserve(static_cast<std::size_t>(use.indices->size()));
    each_named(use, [&](std::uint32_t index) { vertices.push_back(index); });
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }
  const Accessed& accessed = accessors_.at(use.accessor);
  if (accessed.uses == 1) return std::nullopt;
  std::vector<bool> gives = accessed.named;
  gives.flip();
  each_named(use, [&](std::uint32_t index) { gives[index] = true; });
  for (std::uint32_t n = 0; n < gives.size(); ++n) {
    if (gives[n]) vertices.push_back(n);
  }
  return vertices;
}

}  // namespace sparsha::pipeline::gltf

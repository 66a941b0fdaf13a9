#include "pipeline/scan/formats/las/copc.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace sparsha::pipeline::las {
namespace {

constexpr std::size_t kInfoPlace = 375 + 54;  // the record is the first one, by the standard
constexpr std::size_t kInfoSize = 160;
constexpr std::size_t kEntry = 32;  // bytes
constexpr int kMostLevel = 30;      // cells are 32-bit numbers

const Record* find_info(const ScanFile& file, const Header& header) {
  for (const Record& record : header.records) {
    if (record.user == "copc" && record.id == 1 && record.data.size() >= kInfoSize &&
        static_cast<std::size_t>(record.data.data() - file.bytes.data()) == kInfoPlace) {
      return &record;
    }
  }
  return nullptr;
}

struct Page {
  std::uint64_t begin = 0, size = 0;
};

/// Goes through the pages of the hierarchy, each once.
class Hierarchy {
 public:
  Hierarchy(const ScanFile& file, const Header& header, const laz::Packing& packing)
      : file_(file), header_(header), packing_(packing) {}

  std::vector<Octree::Node> read(const Page& root) {
    pages_.push_back(root);
    while (!pages_.empty()) {
      const Page page = pages_.back();
      pages_.pop_back();
      file_.throw_if_cancelled();
      read_page(page);
    }
    check_cells();
    check_chunks();
    return std::move(nodes_);
  }

 private:
  void read_page(const Page& page) {
    const std::size_t place = static_cast<std::size_t>(page.begin);
    if (page.begin > file_.bytes.size() || page.size > file_.bytes.size() - page.begin || page.size % kEntry != 0) {
      throw laz::Damage{
          fmt::format("a page of the COPC hierarchy of {} bytes from byte {} on does not fit the file's {}", page.size,
                      page.begin, file_.bytes.size()),
          std::min(place, file_.bytes.size())};
    }
    if (!seen_pages_.insert(page.begin).second) throw laz::Damage{"a page of the COPC hierarchy is there twice", place};
    entries_ += page.size / kEntry;
    if (entries_ > file_.bytes.size() / kEntry) throw laz::Damage{"pages of the COPC hierarchy overlap", place};
    for (std::size_t at = place; at < place + page.size; at += kEntry) read_entry(at);
  }

  void read_entry(std::size_t at) {
    const char* const p = file_.bytes.data() + at;
    Octree::Node node;
    node.level = load<std::int32_t>(p);
    for (std::size_t k = 0; k < 3; ++k) node.cell[k] = load<std::int32_t>(p + 4 + 4 * k);
    const auto begin = load<std::uint64_t>(p + 16);
    const auto size = load<std::int32_t>(p + 24);
    const auto points = load<std::int32_t>(p + 28);
    const bool known = node.level >= 0 && node.level <= kMostLevel &&
                       std::all_of(node.cell.begin(), node.cell.end(), [&](std::int32_t cell) {
                         return cell >= 0 && std::int64_t{cell} < std::int64_t{1} << node.level;
                       });
    if (!known || points < -1 || size < 0) {
      throw laz::Damage{fmt::format("the COPC hierarchy has a node {}-{}-{}-{} with {} bytes and {} points", node.level,
                                    node.cell[0], node.cell[1], node.cell[2], size, points),
                        at};
    }
    if (points == -1) {
      pages_.push_back({begin, static_cast<std::uint64_t>(size)});
      return;
    }
    seen_cells_.push_back({{node.level, node.cell[0], node.cell[1], node.cell[2]}, at});
    if (points == 0) return;
    node.chunk = {static_cast<std::size_t>(begin), static_cast<std::size_t>(size), static_cast<std::uint64_t>(points)};
    const bool fits = begin >= header_.first_point + 8 && begin <= file_.bytes.size() &&
                      node.chunk.size <= file_.bytes.size() - begin && node.chunk.size >= packing_.record_size;
    if (!fits) {
      throw laz::Damage{fmt::format("the COPC hierarchy gives {} points {} bytes from byte {} on; the file has {}",
                                    points, size, begin, file_.bytes.size()),
                        at};
    }
    nodes_.push_back(node);
  }

  void check_cells() {
    std::sort(seen_cells_.begin(), seen_cells_.end());
    const auto twice = std::adjacent_find(seen_cells_.begin(), seen_cells_.end(),
                                          [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != seen_cells_.end()) throw laz::Damage{"a node of the COPC hierarchy is there twice", twice->second};
    seen_cells_ = {};
  }

  void check_chunks() {
    std::sort(nodes_.begin(), nodes_.end(),
              [](const Octree::Node& a, const Octree::Node& b) { return a.chunk.begin < b.chunk.begin; });
    std::uint64_t points = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      points += nodes_[i].chunk.points;
      if (i > 0 && nodes_[i].chunk.begin < nodes_[i - 1].chunk.begin + nodes_[i - 1].chunk.size) {
        throw laz::Damage{"nodes of the COPC hierarchy overlap in the file", nodes_[i].chunk.begin};
      }
    }
    if (points != header_.points) {
      throw laz::Damage{
          fmt::format("the nodes of the COPC hierarchy have {} points, the header has {}", points, header_.points),
          kInfoPlace};
    }
  }

  const ScanFile& file_;
  const Header& header_;
  const laz::Packing& packing_;
  std::vector<Page> pages_;
  std::set<std::uint64_t> seen_pages_;
  std::vector<std::pair<std::array<std::int32_t, 4>, std::size_t>> seen_cells_;  // level and cell, and where
  std::uint64_t entries_ = 0;
  std::vector<Octree::Node> nodes_;
};

}  // namespace

std::vector<laz::Chunk> Octree::chunks() const {
  std::vector<laz::Chunk> chunks;
  chunks.reserve(nodes.size());
  for (const Node& node : nodes) chunks.push_back(node.chunk);
  return chunks;
}

int Octree::levels() const {
  int levels = 0;
  for (const Node& node : nodes) levels = std::max(levels, node.level + 1);
  return levels;
}

Octree::Box Octree::box_of(const Node& node, double z_factor) const {
  const double edge = std::ldexp(side, -node.level);
  const Eigen::Vector3d cell(node.cell[0], node.cell[1], node.cell[2]);
  const Eigen::Vector3d corner = low + edge * cell;
  Box box{corner - step, corner + Eigen::Vector3d::Constant(edge) + step};
  box.low.z() *= z_factor;
  box.high.z() *= z_factor;
  if (z_factor < 0.0) std::swap(box.low.z(), box.high.z());
  return box;
}

int Octree::level_of_spacing(double wanted) const {
  const int last = std::max(levels() - 1, 0);
  int level = 0;
  while (level < last && std::ldexp(spacing, -level) > wanted) ++level;
  return level;
}

int Octree::level_of_points(std::uint64_t points) const {
  std::vector<std::uint64_t> held(static_cast<std::size_t>(levels()));
  for (const Node& node : nodes) held[static_cast<std::size_t>(node.level)] += node.chunk.points;
  std::uint64_t sum = 0;
  for (std::size_t level = 0; level < held.size(); ++level) {
    sum += held[level];
    if (sum >= points) return static_cast<int>(level);
  }
  return std::max(levels() - 1, 0);
}

std::optional<Octree> read_octree(const ScanFile& file, const Header& header, const laz::Packing& packing) {
  const Record* const info = find_info(file, header);
  if (info == nullptr) return std::nullopt;
  if (header.format < 6 || header.format > 8 || packing.compressor != laz::Compressor::layered) {
    throw laz::Damage{fmt::format("it says COPC, which has layered points of format 6 to 8, not of {}", header.format),
                      kInfoPlace};
  }
  const auto number = [&](std::size_t i) { return load<double>(info->data.data() + 8 * i); };
  Octree octree;
  const Eigen::Vector3d centre(number(0), number(1), number(2));
  const double half = number(3);
  octree.spacing = number(4);
  if (!centre.allFinite() || !std::isfinite(half) || !(half > 0.0) || !(octree.spacing > 0.0)) {
    throw laz::Damage{"the COPC record has no cube or spacing", kInfoPlace};
  }
  octree.low = centre - Eigen::Vector3d::Constant(half);
  octree.side = 2.0 * half;
  octree.step = Eigen::Vector3d(header.scale[0], header.scale[1], header.scale[2]).cwiseAbs();
  const Page root{load<std::uint64_t>(info->data.data() + 40), load<std::uint64_t>(info->data.data() + 48)};
  octree.nodes = Hierarchy(file, header, packing).read(root);
  return octree;
}

}  // namespace sparsha::pipeline::las

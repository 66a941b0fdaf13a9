// COPC files that tests write themselves: points of format 6, single returns, packed in layers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/scan/formats/las/laz/integers.h"
#include "tests/support/las_files.h"
#include "tests/support/laz_encoder.h"
#include "tests/support/scan_files.h"

namespace sparsha::pipeline::testing {

using Stored = std::array<std::int32_t, 3>;

struct CopcNode {
  int level = 0;
  std::array<std::int32_t, 3> cell{};
  std::vector<Stored> points;
};

/// A chunk of compressor 3 with streams for x, y and z; all else stays as it is in the first point.
inline std::string pack_layered_chunk(const std::vector<Stored>& points) {
  std::string packed(30, '\0');
  for (std::size_t k = 0; k < 3; ++k) set(packed, 4 * k, points.front()[k]);
  packed[14] = 0x11;  // the first return of one
  Encoder xy, z;
  EncoderModel changed(128);
  IntegerEncoder dx(32, 2), dy(32, 22), dz(32, 20);
  laz::RunningMedian median_x, median_y;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Stored& p = points[i];
    const Stored& last = points[i - 1];
    xy.symbol(changed, 0);
    dx.put(xy, median_x.get(), p[0] - last[0], 1);
    median_x.add(p[0] - last[0]);
    dy.put(xy, median_y.get(), p[1] - last[1], 1 + std::min(dx.size() & ~1U, 20U));
    median_y.add(p[1] - last[1]);
    dz.put(z, last[2], p[2], 1 + std::min((dx.size() + dy.size()) / 2 & ~1U, 18U));
  }
  put(packed, static_cast<std::uint32_t>(points.size()));
  std::array<std::string, 9> layers;
  if (points.size() > 1) {
    layers[0] = xy.finish();
    layers[1] = z.finish();
  }
  for (const std::string& layer : layers) put(packed, static_cast<std::uint32_t>(layer.size()));
  for (const std::string& layer : layers) packed += layer;
  return packed;
}

/// The cube is from 0 to 16 m on each axis, coordinates have steps of 0.01.
struct CopcFile {
  static constexpr double kSide = 16.0, kScale = 0.01, kSpacing = 1.0;
  std::string bytes;
  std::size_t hierarchy = 0;  ///< where its root page begins
  std::vector<std::size_t> chunks, sizes;

  /// `second_page`: the last so many nodes stand in a page of their own.
  explicit CopcFile(const std::vector<CopcNode>& nodes, std::size_t second_page = 0) {
    bytes.assign(375, '\0');
    set(bytes, 0, std::array<char, 4>{'L', 'A', 'S', 'F'});
    bytes[24] = 1;
    bytes[25] = 4;
    bytes[6] = 16;  // WKT
    set(bytes, 94, std::uint16_t{375});
    set(bytes, 100, std::uint32_t{2});
    bytes[104] = static_cast<char>(128 + 6);
    set(bytes, 105, std::uint16_t{30});
    for (std::size_t k = 0; k < 3; ++k) set(bytes, 131 + 8 * k, kScale);
    add_record("copc", 1, std::string(160, '\0'));
    for (std::size_t k = 0; k < 4; ++k) set(bytes, 429 + 8 * k, kSide / 2);
    set(bytes, 461, kSpacing);
    std::string packing;
    for (const int number : {3, 0, 0, 0, 0}) put(packing, static_cast<std::uint16_t>(number));
    packing += std::string(2, '\0');
    put(packing, 0xFFFFFFFFU);
    packing += std::string(16, '\0');
    for (const int number : {1, 10, 30, 3}) put(packing, static_cast<std::uint16_t>(number));
    add_record("laszip encoded", 22204, packing);
    set(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
    add_chunks(nodes);
    add_hierarchy(nodes, second_page);
  }

 private:
  void add_record(const std::string& user, std::uint16_t id, const std::string& data) {
    std::string lead(54, '\0');
    std::copy(user.begin(), user.end(), lead.begin() + 2);
    set(lead, 18, id);
    set(lead, 20, static_cast<std::uint16_t>(data.size()));
    bytes += lead + data;
  }
  void add_chunks(const std::vector<CopcNode>& nodes) {
    const std::size_t place = bytes.size();
    put(bytes, std::int64_t{0});
    Encoder table;
    IntegerEncoder numbers(32, 2);
    std::int32_t last_count = 0, last_size = 0;
    std::uint64_t all = 0;
    std::uint32_t chunks_in_table = 0;
    for (const CopcNode& node : nodes) {
      chunks.push_back(bytes.size());
      sizes.push_back(0);
      if (node.points.empty()) continue;
      const std::string chunk = pack_layered_chunk(node.points);
      sizes.back() = chunk.size();
      bytes += chunk;
      numbers.put(table, last_count, static_cast<std::int32_t>(node.points.size()), 0);
      numbers.put(table, last_size, static_cast<std::int32_t>(chunk.size()), 1);
      last_count = static_cast<std::int32_t>(node.points.size());
      last_size = static_cast<std::int32_t>(chunk.size());
      all += node.points.size();
      ++chunks_in_table;
    }
    set(bytes, place, static_cast<std::int64_t>(bytes.size()));
    put(bytes, std::uint32_t{0});
    put(bytes, chunks_in_table);
    bytes += table.finish();
    set(bytes, 247, all);
  }
  [[nodiscard]] std::string entry(const std::vector<CopcNode>& nodes, std::size_t i) const {
    std::string entry;
    put(entry, std::int32_t{nodes[i].level});
    for (const std::int32_t cell : nodes[i].cell) put(entry, cell);
    put(entry, static_cast<std::uint64_t>(nodes[i].points.empty() ? 0 : chunks[i]));
    put(entry, static_cast<std::int32_t>(sizes[i]));
    put(entry, static_cast<std::int32_t>(nodes[i].points.size()));
    return entry;
  }
  void add_hierarchy(const std::vector<CopcNode>& nodes, std::size_t second_page) {
    const std::size_t first = nodes.size() - second_page;
    std::string root, more;
    for (std::size_t i = 0; i < first; ++i) root += entry(nodes, i);
    for (std::size_t i = first; i < nodes.size(); ++i) more += entry(nodes, i);
    set(bytes, 235, static_cast<std::uint64_t>(bytes.size()));
    set(bytes, 243, std::uint32_t{1});
    std::string lead(60, '\0');
    std::copy_n("copc", 4, lead.begin() + 2);
    set(lead, 18, std::uint16_t{1000});
    hierarchy = bytes.size() + lead.size();
    if (second_page > 0) {  // its key is that of its first node
      std::string link = more.substr(0, 16);
      put(link, static_cast<std::uint64_t>(hierarchy + root.size() + 32));
      put(link, static_cast<std::int32_t>(more.size()));
      put(link, std::int32_t{-1});
      root += link;
    }
    set(lead, 20, static_cast<std::uint64_t>(root.size() + more.size()));
    bytes += lead + root + more;
    set(bytes, 429 + 40, static_cast<std::uint64_t>(hierarchy));
    set(bytes, 429 + 48, static_cast<std::uint64_t>(root.size()));
  }
};

}  // namespace sparsha::pipeline::testing

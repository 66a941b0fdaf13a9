// What was written by a process that was killed is in the file as far as the system took it; the sum of each tile tells
// whether it is whole.
#include "pipeline/outofcore/finished_tiles.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha::pipeline {
namespace {

constexpr const char* kFormat = "sparsha tiles 1 ";
constexpr std::size_t kSumBytes = 64;  // hexadecimal digits

struct Head {
  std::array<std::int32_t, 4> borders{};
  std::uint64_t scattered = 0;
  std::uint64_t verdicts = 0;
};
static_assert(sizeof(Head) == 32, "no padding goes to the file");

std::uint64_t nodes_within(const std::array<std::int32_t, 4>& borders) {
  return static_cast<std::uint64_t>(borders[1] - borders[0]) * static_cast<std::uint64_t>(borders[3] - borders[2]);
}

bool is_possible(const Head& head) {
  constexpr std::uint64_t kMostNodes = std::uint64_t{1} << 48U;  // so that no sum of bytes overflows
  return head.borders[0] >= 0 && head.borders[0] < head.borders[1] && head.borders[2] >= 0 &&
         head.borders[2] < head.borders[3] && nodes_within(head.borders) <= kMostNodes &&
         (head.verdicts == 0 || head.verdicts == nodes_within(head.borders));
}

std::uint64_t bytes_of(const Head& head) {
  return sizeof(Head) + nodes_within(head.borders) * (sizeof(float) + sizeof(scene::NodeState)) + head.verdicts +
         kSumBytes;
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

// The key is part of it: tiles that another build appends to the same file are not taken for this one's.
std::string sum_of(const std::string& key, const Head& head, const TileNodes& nodes) {
  Sha256 sum;
  sum.add(std::as_bytes(std::span<const char>(key)));
  sum.add(std::as_bytes(std::span<const Head>(&head, 1)));
  sum.add(bytes_of(nodes.height_m));
  sum.add(bytes_of(nodes.state));
  sum.add(bytes_of(nodes.verdicts));
  return sum.finish();
}

template <typename T>
void write_values(std::ostream& stream, const std::vector<T>& values) {
  stream.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

template <typename T>
void read_values(std::istream& stream, std::uint64_t count, std::vector<T>& values) {
  values.resize(static_cast<std::size_t>(count));
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

Error cannot_write(const std::filesystem::path& file) {
  return {ErrorKind::failure,
          {file.string(), 0, 0},
          "finished tiles cannot be written",
          "room on the disk and a folder that can be written to"};
}

// Calls use(place in the grid, place in the tile, nodes) for each row of a tile.
template <typename Use>
void each_row(const Tile& tile, const scene::Lattice& lattice, const Use& use) {
  const auto count = static_cast<std::size_t>(tile.last_column - tile.first_column);
  for (int j = tile.first_row; j < tile.last_row; ++j)
    use(lattice.index(tile.first_column, j), static_cast<std::size_t>(j - tile.first_row) * count, count);
}

}  // namespace

TileNodes take_nodes(const Tile& tile, const scene::DepthGrid& grid, const std::vector<std::uint8_t>& verdicts) {
  TileNodes nodes;
  each_row(tile, grid.lattice, [&](std::size_t from, std::size_t, std::size_t count) {
    const auto add = [&](const auto& all, auto& some) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
      if (!all.empty()) some.insert(some.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    add(grid.height_m, nodes.height_m);
    add(grid.state, nodes.state);
    add(verdicts, nodes.verdicts);
  });
  return nodes;
}

void put_nodes(const Tile& tile, const TileNodes& nodes, scene::DepthGrid& grid, std::vector<std::uint8_t>& verdicts) {
  each_row(tile, grid.lattice, [&](std::size_t to, std::size_t from, std::size_t count) {
    std::copy_n(nodes.height_m.data() + from, count, grid.height_m.data() + to);
    std::copy_n(nodes.state.data() + from, count, grid.state.data() + to);
    if (!verdicts.empty()) std::copy_n(nodes.verdicts.data() + from, count, verdicts.data() + to);
  });
}

FinishedTiles::FinishedTiles(std::filesystem::path file, std::string key)
    : file_(std::move(file)), key_(std::move(key)) {
  const std::string first = kFormat + key_ + "\n";
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::symlink_status(file_, code);
  const bool is_there = std::filesystem::exists(status);
  if (is_there && !std::filesystem::is_regular_file(status)) throw cannot_write(file_);  // nothing that we have made
  const std::uint64_t size = is_there ? std::filesystem::file_size(file_, code) : 0;
  std::uint64_t end = 0;  // of what is whole
  code.clear();
  if (size > 0) {
    std::string found(first.size(), '\0');
    stream_.open(file_, std::ios::in | std::ios::binary);
    stream_.read(found.data(), static_cast<std::streamsize>(found.size()));
    was_of_another_ = found != first;
    if (!was_of_another_) end = find_tiles(first.size(), size);
    stream_.close();
  }
  if (end == 0) {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << first;
  } else if (end < size) {
    std::filesystem::resize_file(file_, end, code);
  }
  stream_.clear();
  stream_.open(file_, std::ios::in | std::ios::out | std::ios::binary);
  if (!stream_ || code) throw cannot_write(file_);
}

FinishedTiles::Borders FinishedTiles::borders_of(const Tile& tile) {
  return {tile.first_row, tile.last_row, tile.first_column, tile.last_column};
}

/// Where the last whole tile ends.
std::uint64_t FinishedTiles::find_tiles(std::uint64_t begin, std::uint64_t size) {
  std::uint64_t at = begin;
  for (Head head; size - at >= sizeof(Head); at += bytes_of(head)) {
    stream_.seekg(static_cast<std::streamoff>(at));
    stream_.read(reinterpret_cast<char*>(&head), sizeof(head));
    if (!stream_ || !is_possible(head) || bytes_of(head) > size - at) break;
    places_[head.borders] = at;
  }
  stream_.clear();
  return at;
}

bool FinishedTiles::take(const Tile& tile, TileNodes& nodes) {
  const auto found = places_.find(borders_of(tile));
  if (found == places_.end()) return false;
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(found->second));
  Head head;
  stream_.read(reinterpret_cast<char*>(&head), sizeof(head));
  if (!stream_ || head.borders != found->first || !is_possible(head)) return false;
  nodes.scattered = head.scattered;
  read_values(stream_, nodes_within(head.borders), nodes.height_m);
  read_values(stream_, nodes_within(head.borders), nodes.state);
  read_values(stream_, head.verdicts, nodes.verdicts);
  std::string sum(kSumBytes, '\0');
  stream_.read(sum.data(), static_cast<std::streamsize>(sum.size()));
  return stream_ && sum == sum_of(key_, head, nodes);
}

void FinishedTiles::add(const Tile& tile, const TileNodes& nodes) {
  const Head head{borders_of(tile), nodes.scattered, nodes.verdicts.size()};
  stream_.clear();
  stream_.seekp(0, std::ios::end);
  stream_.write(reinterpret_cast<const char*>(&head), sizeof(head));
  write_values(stream_, nodes.height_m);
  write_values(stream_, nodes.state);
  write_values(stream_, nodes.verdicts);
  stream_ << sum_of(key_, head, nodes) << std::flush;
  if (!stream_) throw cannot_write(file_);
}

void remove_finished_tiles(const std::filesystem::path& file) { remove_own_file(file, kFormat); }

}  // namespace sparsha::pipeline

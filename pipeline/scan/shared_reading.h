// How several processes share the reading of scans: each has its stretch of all their bytes, one file behind the other,
// so that no byte of a point is read twice. Files whose records cannot be told apart before they are read stay whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace sparsha::pipeline {

/// The processes that read a set of scans, and what they tell each other. Every call is made by all of them at the same
/// time.
struct ReadingRanks {
  using Bytes = std::vector<std::byte>;
  using Merge = std::function<Bytes(const Bytes& first, const Bytes& second)>;
  std::size_t number = 0, size = 1;
  std::function<void(Bytes&)> join{};  ///< what all have, in their order, to all of them
  /// What `merge` makes of what all have, two by two, to all of them: no more than two at once is in memory.
  std::function<Bytes(Bytes mine, const Merge& merge)> merged{};
};

/// What one process reads of a file.
struct FileShare {
  enum class Kind : std::uint8_t {
    part,          ///< records from a share of all of them to another
    whole_by_one,  ///< one process reads all of it
    whole_by_all,  ///< each reads all of it and keeps a share of the points
  };
  Kind kind = Kind::whole_by_all;
  double from = 0.0, to = 1.0;  ///< of a part
  bool reads = true;            ///< whether this process reads any of it
  bool digests = false;         ///< whether it is the one that takes the file's SHA-256
};

/// `bytes` of each file, and whether its records have one length. A file whose records have not is read by the process
/// that has its middle; by all, as no single one should wait for, when it is larger than a process's stretch.
[[nodiscard]] std::vector<FileShare> shares_of_files(const std::vector<std::uint64_t>& bytes,
                                                     const std::vector<bool>& of_one_length, std::size_t number,
                                                     std::size_t size);

/// The first of `records` at a share of them: what ends one part begins the next.
[[nodiscard]] inline std::uint64_t record_at(std::uint64_t records, double share) {
  return share >= 1.0 ? records : static_cast<std::uint64_t>(share * static_cast<double>(records));
}

}  // namespace sparsha::pipeline

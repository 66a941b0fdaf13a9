#include "pipeline/scan/shared_reading.h"

#include <algorithm>
#include <numeric>

namespace sparsha::pipeline {

std::vector<FileShare> shares_of_files(const std::vector<std::uint64_t>& bytes, const std::vector<bool>& of_one_length,
                                       std::size_t number, std::size_t size) {
  const std::uint64_t all = std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
  const auto stretch_begins = [&](std::size_t rank) {  // all * rank / size without overflow
    return all / size * rank + all % size * rank / size;
  };
  const std::uint64_t low = stretch_begins(number), high = stretch_begins(number + 1);
  std::vector<FileShare> shares;
  std::uint64_t begin = 0;
  for (std::size_t k = 0; k < bytes.size(); begin += bytes[k], ++k) {
    const std::uint64_t end = begin + bytes[k];
    FileShare share;
    // The middle of a file lies in one stretch, also that of a file without a byte.
    const std::uint64_t middle = begin + bytes[k] / 2;
    const bool has_middle =
        (middle >= low && middle < high) || (middle == all && high == all && low < all) || (all == 0 && number == 0);
    share.digests = has_middle;
    if (of_one_length[k] && bytes[k] > 0) {
      const auto share_at = [&](std::uint64_t place) {
        return static_cast<double>(std::clamp(place, begin, end) - begin) / static_cast<double>(bytes[k]);
      };
      share.kind = FileShare::Kind::part;
      share.from = share_at(low);
      share.to = share_at(high);
      share.reads = share.from < share.to;
    } else if (size > 1 && bytes[k] / 2 <= all / size / 2) {
      share.kind = FileShare::Kind::whole_by_one;
      share.reads = has_middle;
    }
    shares.push_back(share);
  }
  return shares;
}

}  // namespace sparsha::pipeline

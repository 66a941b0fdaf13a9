// Pass 1 of building out of core.
#include "pipeline/outofcore/cloud_on_disk.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/error.h"
#include "pipeline/projection/attributes.h"

namespace sparsha::pipeline {

namespace {

// The first record of a rank's share of the file order; that of the rank after the last is `records`.
std::uint64_t share_begins(std::uint64_t records, std::size_t rank, std::size_t size) {
  const std::uint64_t share = records / size;
  return share * rank + std::min<std::uint64_t>(records % size, rank);
}

}  // namespace

CloudOnDisk write_to_disk(const ScanSet& scans, StreamedFilters filters, bool colour, bool intensity,
                          const std::filesystem::path& folder, const Ranks* ranks, Progress& progress) {
  const PointLayout layout{colour && scans.has_colour(), intensity && scans.has_intensity()};
  CloudOnDisk cloud;
  cloud.origin_m = scans.origin_m();
  cloud.file = std::make_unique<PointFile>(folder, layout, 1);
  cloud.invalid = scans.invalid();
  cloud.stations = scans.stations();
  const std::uint64_t first = ranks != nullptr ? share_begins(scans.points(), ranks->number(), ranks->size()) : 0;
  const std::uint64_t last =
      ranks != nullptr ? share_begins(scans.points(), ranks->number() + 1, ranks->size()) : scans.points();
  std::uint64_t record_number = 0;
  cloud.invalid += scans.stream(
      [&](const CloudBlock& block) {
        std::array<float, 5> record{};
        for (std::size_t k = 0; k < block.points.size(); ++k) {
          const Eigen::Vector3f& p = block.points[k];
          const std::uint64_t number = record_number++;
          if (!filters.keep(block, k)) continue;
          ++cloud.all;
          std::copy_n(p.data(), 3, record.begin());
          if (layout.colour) record[3] = std::bit_cast<float>(block.rgba[k]);
          if (layout.intensity) {
            record[layout.words() - 1] = block.intensity[k];
            cloud.largest_intensity = std::max(cloud.largest_intensity, largest_magnitude(&block.intensity[k], 1));
          }
          if (number >= first && number < last) cloud.file->add(0, record.data());
        }
      },
      progress);
  cloud.file->finish();
  cloud.filters = filters.finish(progress);
  return cloud;
}

}  // namespace sparsha::pipeline

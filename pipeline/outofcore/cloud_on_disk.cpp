// Pass 1 of building out of core.
#include "pipeline/outofcore/cloud_on_disk.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/error.h"
#include "base/files/message.h"
#include "pipeline/projection/attributes.h"

namespace sparsha::pipeline {

namespace {

/// What a process finds in its share of the scans.
struct Counted {
  std::uint64_t points = 0, beyond = 0;
  float largest_intensity = 0.0F;
};

}  // namespace

CloudOnDisk write_to_disk(const ScanSet& scans, StreamedFilters filters, bool colour, bool intensity,
                          const std::filesystem::path& folder, Progress& progress) {
  const PointLayout layout{colour && scans.has_colour(), intensity && scans.has_intensity()};
  CloudOnDisk cloud;
  cloud.origin_m = scans.origin_m();
  cloud.file = std::make_unique<PointFile>(folder, layout, 1);
  cloud.invalid = scans.invalid();
  cloud.stations = scans.stations();
  std::uint64_t beyond = scans.stream(
      [&](const CloudBlock& block) {
        std::array<float, 5> record{};
        for (std::size_t k = 0; k < block.points.size(); ++k) {
          const Eigen::Vector3f& p = block.points[k];
          if (!filters.keep(block, k)) continue;
          ++cloud.all;
          std::copy_n(p.data(), 3, record.begin());
          if (layout.colour) record[3] = std::bit_cast<float>(block.rgba[k]);
          if (layout.intensity) {
            record[layout.words() - 1] = block.intensity[k];
            cloud.largest_intensity = std::max(cloud.largest_intensity, largest_magnitude(&block.intensity[k], 1));
          }
          cloud.file->add(0, record.data());
        }
      },
      progress);
  cloud.file->finish();
  if (scans.is_shared()) {
    filters.join(scans.ranks());
    MessageWriter mine;
    mine.put(Counted{cloud.all, beyond, cloud.largest_intensity});
    ReadingRanks::Bytes bytes = mine.take();
    scans.ranks().join(bytes);
    cloud.all = beyond = 0;
    for (MessageReader message(bytes); !message.at_end();) {
      const auto theirs = message.get<Counted>();
      cloud.all += theirs.points;
      beyond += theirs.beyond;
      cloud.largest_intensity = std::max(cloud.largest_intensity, theirs.largest_intensity);
    }
  }
  cloud.invalid += beyond;
  cloud.filters = filters.finish(progress);
  return cloud;
}

}  // namespace sparsha::pipeline

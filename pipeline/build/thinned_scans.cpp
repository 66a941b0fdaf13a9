#include "pipeline/build/thinned_scans.h"

#include <cstddef>
#include <optional>
#include <variant>

#include "pipeline/build/refused_scans.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/filter/voxel.h"

namespace sparsha::pipeline {
namespace {

// Thrown while a filter leaves more voxels than fit.
struct TooManyVoxels {};

}  // namespace

ThinnedScans thin_scans(const ScanSet& scans, const scene::Config& config,
                        const std::vector<scene::FilterConfig>& filters, std::uint64_t most, const Context& context) {
  Progress& progress = context.progress;
  StreamedFilters streamed(scans, filters, context);
  const std::size_t leading = streamed.count();
  const scene::FilterConfig& filter = filters[leading];
  std::optional<VoxelThinner> thinner;
  thinner.emplace(scans.origin_m(), std::get<scene::VoxelConfig>(filter).leaf_m, scans.has_colour(),
                  scans.has_intensity());
  ThinnedScans thinned;
  thinned.points.invalid = scans.invalid();
  std::uint64_t kept = 0;
  try {
    thinned.points.invalid += scans.stream(
        [&](const CloudBlock& block) {
          thinned.points.read += block.points.size();
          at_key_of(filter, [&] {
            for (std::size_t k = 0; k < block.points.size(); ++k) {
              if (!streamed.keep(block, k)) continue;
              ++kept;
              thinner->add(block.points[k].data(), block.rgba.empty() ? kNoColour : block.rgba[k],
                           block.intensity.empty() ? kNoIntensity : block.intensity[k]);
            }
          });
          if (thinner->voxels() > most) throw TooManyVoxels();
        },
        progress);
  } catch (const TooManyVoxels&) {
    thinner.reset();  // its memory is free before the scans are read again
    throw refusal_of_voxels(scans, streamed, filter, progress);
  }
  if (thinned.points.read == 0) throw no_points(config);
  thinned.points.read += thinned.points.invalid;
  thinned.steps = streamed.finish(progress);
  FilterStep& voxels = thinned.steps.steps.emplace_back();
  voxels.name = scene::filter_name(filter);
  voxels.merges = true;
  voxels.removed = kept - thinner->voxels();
  thinned.cloud = std::make_shared<Cloud>(thinner->finish());
  thinned.cloud->stations = scans.stations();
  thinned.rest.assign(filters.begin() + static_cast<std::ptrdiff_t>(leading) + 1, filters.end());
  return thinned;
}

}  // namespace sparsha::pipeline

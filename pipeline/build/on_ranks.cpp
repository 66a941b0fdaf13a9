// The errors that tell what several processes do not build together.
#include "pipeline/build/on_ranks.h"

#include <string>

#include "base/error.h"
#include "pipeline/filter/streamed.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

Error not_on_ranks(const Place& place, const std::string& what) {
  return {ErrorKind::usage, place, what + " by one process only, and this one was started by a launcher of MPI",
          "`sparsha build` without mpirun"};
}

}  // namespace

void require_fit_for_ranks(const scene::Config& config) {
  if (config.around) throw not_on_ranks({}, "around: a whole object is built");
  if (config.unroll) throw not_on_ranks({}, "unroll: an unrolled object is built");
  for (const scene::FilterConfig& filter : config.filters) {
    if (!can_be_streamed(filter))
      throw not_on_ranks(filter.place,
                         "the filter '" + scene::filter_name(filter) + "' looks at many points at once and is applied");
  }
}

void require_points_for_ranks(const scene::Config& config, std::size_t faces) {
  if (faces == 0) return;
  throw not_on_ranks({config.scans.front().file.string(), 0, 0}, "a mesh is built");
}

}  // namespace sparsha::pipeline

// The filters a configuration can name, in its order. All keep colour, intensity and the origin.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/origin.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// What one filter did.
struct FilterStep {
  static constexpr std::size_t kSample = std::size_t{1} << 15;

  std::string name;  ///< as in the configuration
  std::uint64_t removed = 0;
  bool outliers = false;        ///< what it takes away are outliers, which the cross-check still counts
  bool merges = false;          ///< other points stand for those that are gone
  std::uint64_t in_plane = 0;   ///< of those that remove_plane takes away: within the plane's thickness
  double of_object = 0.0;       ///< share of the object that goes with the plane (share_of_object())
  std::string found;            ///< what it found, in words; may be empty
  PointSample sample{kSample};  ///< of what it took away, scan frame; not of what is merged
};

/// What all of them did, in order.
struct FilterSteps {
  static constexpr std::size_t kSample = std::size_t{1} << 17;

  std::vector<FilterStep> steps;
  PointSample kept{kSample};  ///< of the points that are left, scan frame; by StreamedFilters
  double moved_rms_m = 0.0;   ///< how far `smooth` moved points, RMS

  [[nodiscard]] std::uint64_t filtered() const;  ///< points taken away that are no outliers
  [[nodiscard]] std::uint64_t outliers() const;
};

/// What filters need to know beside the cloud, and what is asked of them.
struct FilterNeeds {
  /// Spacing of the grid that the cloud will be projected on, metres of the scan frame; for `thin`.
  std::function<double(const Cloud& cloud)> spacing_m;
  /// Where points go that outlier filters take away (positions as measured, same origin): a cross-check must see them.
  Cloud* removed_outliers = nullptr;
};

/// A sample of a cloud for pictures, scan frame.
[[nodiscard]] PointSample sample_of_kept(const Cloud& cloud);

/// Does what a filter asks for; an error that has no place gets that of the filter's key in the configuration.
template <typename Work>
void at_key_of(const scene::FilterConfig& filter, const Work& work) {
  try {
    work();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (!error.place().file.empty()) throw;
    throw Error(error.kind(), filter.place, error.wrong(), error.expected());
  }
}

/// What a filter throws that takes all points away.
[[nodiscard]] Error nothing_left(const std::string& filter, const std::string& found = {});

/// The fields beside the intensity that filters look at, each once, as field_key() gives them.
[[nodiscard]] std::vector<std::string> fields_of(const std::vector<scene::FilterConfig>& filters);
/// The field that a filter looks at; empty when it looks at none.
[[nodiscard]] std::string field_of(const scene::FilterConfig& filter);

/// "12.3 %".
[[nodiscard]] std::string share_text(std::uint64_t part, std::uint64_t whole);

/// What is said of points that stay since the scans say no value of them; empty when there are none.
[[nodiscard]] std::string unknown_text(std::uint64_t points);

/// Applies `filters` in order. Faces survive only while no point is taken away. `smooth` moves points and leaves their
/// places as measured in cloud.measured. The result does not depend on the number of threads. Warns of what looks like
/// a mistake. Throws Error{usage} when a voxel leaf is too small for the extent, Error{input} when nothing is left or
/// what a filter looks for is not there; Cancelled.
FilterSteps apply_filters(Cloud& cloud, const std::vector<scene::FilterConfig>& filters, const Context& context,
                          const FilterNeeds& needs = {});

}  // namespace sparsha::pipeline

// The memory limit decides between points in memory and on disk; both give the same bytes.
#include "pipeline/build/project_scans.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/system.h"
#include "pipeline/build/cropped.h"
#include "pipeline/build/kept_tiles.h"
#include "pipeline/build/measured_points.h"
#include "pipeline/build/memory_needs.h"
#include "pipeline/build/on_ranks.h"
#include "pipeline/build/point_worth.h"
#include "pipeline/build/refused_scans.h"
#include "pipeline/build/sides.h"
#include "pipeline/build/thinned_scans.h"
#include "pipeline/build/unrolled.h"
#include "pipeline/build/whole_object.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/streamed.h"
#include "pipeline/orient/face.h"
#include "pipeline/outofcore/cloud_on_disk.h"
#include "pipeline/outofcore/crowding.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/outofcore/tiled_check.h"
#include "pipeline/outofcore/tiled_projection.h"
#include "pipeline/projection/projector.h"
#include "pipeline/scan/sampled_faces.h"
#include "pipeline/scan/set.h"

namespace sparsha::pipeline {
namespace {

// Of a tile that is kept: a build that is ended loses no more than it takes to measure as many.
constexpr std::uint64_t kTilePoints = 4'000'000;

// Thrown while a build in memory turns out to exceed the limit.
struct DoesNotFit {
  std::uint64_t bytes = 0;  ///< that it needs with the grid; 0 where that is not known
  std::uint64_t least = 0;  ///< that it needs in any case, where that is not known
};

class Builder {
 public:
  Builder(const scene::Config& config, const BuildOptions& options, const Context& context)
      : config_(config),
        options_(options),
        pool_(context.pool),
        progress_(context.progress),
        scan_to_grid_(config.orientation.scan_to_grid),
        grid_(config.grid),
        needs_(config, options.grid_only),
        limit_{options.memory_bytes, options.memory_points} {
    oriented_ = !config.orientation.face.has_value();
    if (!options.grid_only) filters_ = config.filters;
  }

  ProjectedScans run() {
    if (limit_.bytes > 0) system::trim_heap();  // views may have been tried
    progress_.begin("read");
    ScanSet scans(config_.scans,
                  limit_.none() && !shared() && !resumes() ? ScanSet::Keep::quickest : ScanSet::Keep::disk, true,
                  progress_, fields_of(filters_), mesh_refusal(limit_, filters_, fields_of(filters_).size(), false),
                  part_left_by_crops(filters_, options_.force), readers());
    require_fields(config_.scans, scans, filters_, progress_);
    if (!options_.grid_only) warn_of_unused_worth(config_.scans, scans, filters_, progress_);
    scans.require_surface();
    z_up_ = scans.z_up();
    if (!take_places_away(filters_)) {
      for (const std::string& pieces : scans.pieces()) progress_.warn(pieces);
    }
    try {
      if (shared() || keeps_tiles(scans) || !may_fit(limit_, amount_of(scans), filters_)) throw DoesNotFit();
      build_in_memory(scans);
    } catch (const DoesNotFit& needed) {
      result_ = {};
      grid_ = config_.grid;
      oriented_ = !config_.orientation.face.has_value();
      if (shared()) {
        require_points_for_ranks(config_, scans.faces());
        result_.sources = scans.sources();
        require_same_scans(*options_.ranks, result_.sources, scans.points(), scans.invalid());
      }
      const std::uint64_t in_memory = needed.bytes > 0 ? needed.bytes : likely_in_memory(scans, needed.least);
      require_points_only(amount_of(scans), filters_, in_memory);
      if (thins()) {
        build_thinned(scans);
      } else {
        limit_.in_memory = in_memory;
        build_out_of_core(scans, in_memory);
      }
    }
    count_unread(scans.unread(), result_.points, result_.filters);
    if (result_.sources.empty()) result_.sources = scans.sources();
    result_.nearest_of_chosen_unit_m = scans.nearest_of_chosen_unit_m();
    result_.scan_to_grid = unrolled_ ? unrolled_->scan_to_grid : scan_to_grid_;
    return std::move(result_);
  }

 private:
  /// Looked for when it is needed: a TMPDIR that does not exist is no matter for what fits into memory.
  [[nodiscard]] std::filesystem::path scratch_folder() const {
    return options_.scratch_folder.empty() ? system::temporary_folder() : options_.scratch_folder;
  }
  /// Whether several processes build the scene, and whether this one goes on with what they have projected.
  [[nodiscard]] bool shared() const { return options_.ranks != nullptr; }
  /// The ranks as those who share the reading of the scans.
  [[nodiscard]] ReadingRanks readers() const {
    if (!shared()) return {};
    const Ranks& ranks = *options_.ranks;
    return {
        ranks.number(), ranks.size(), [&ranks](Ranks::Bytes& bytes) { ranks.join(bytes); },
        [&ranks](Ranks::Bytes mine, const ReadingRanks::Merge& merge) { return ranks.merged(std::move(mine), merge); }};
  }
  [[nodiscard]] bool is_root() const { return !shared() || options_.ranks->is_root(); }
  [[nodiscard]] bool resumes() const { return !options_.finished_tiles.empty(); }
  /// What is not projected through files on disk has no tiles to go on from.
  [[nodiscard]] bool keeps_tiles(const ScanSet& scans) const {
    if (!resumes()) return false;
    const bool on_disk =
        scans.faces() == 0 && !around() && !unrolls() && std::all_of(filters_.begin(), filters_.end(), can_be_streamed);
    if (!on_disk) progress_.warn("this scene is built in memory as a whole: a build that is ended begins anew");
    return on_disk;
  }
  [[nodiscard]] bool around() const { return needs_.around(); }
  [[nodiscard]] bool unrolls() const { return needs_.unrolls(); }
  [[nodiscard]] bool checks() const { return needs_.checks(); }
  [[nodiscard]] bool finds_pillars() const { return needs_.finds_pillars(); }

  [[nodiscard]] Error refusal_in_memory(std::uint64_t points, std::uint64_t bytes, bool with_grid) const {
    return pipeline::refusal_in_memory(around(), points, bytes, with_grid);
  }

  /// Of a whole object, beside those of its front view.
  [[nodiscard]] std::uint64_t chart_bytes(const Cloud& cloud, const scene::Lattice& lattice) const {
    if (!around() || limit_.bytes == 0) return 0;
    const double per_place_m = kPlacesOfSpacing * lattice.spacing_m / scale();
    const bool mesh = !cloud.faces.empty();
    const double places = mesh ? area_of_faces(cloud) / (per_place_m * per_place_m) : static_cast<double>(cloud.size());
    return needs_.charts(places, sample_of_kept(cloud).points(), mesh, scan_to_grid_, lattice);
  }

  /// The same by a sample, `least` at least, before a point is in memory; 0 where a sample does not tell.
  [[nodiscard]] std::uint64_t likely_in_memory(const ScanSet& scans, std::uint64_t least) const {
    constexpr std::uint64_t kMissing = 50;  // a part of it may be missing, since the sample's lattice is smaller
    if (limit_.bytes == 0 || shared() || resumes()) return 0;
    if (!oriented_ || unrolls() || (around() && scans.faces() > 0)) return 0;
    const std::optional<SampledGrid> grid =
        sampled_grid(scans.sample_m(), scan_to_grid_, config_.grid, config_.haptics.resolution_m, {pool_, progress_});
    if (!grid) return 0;
    const ProjectionNeeds needs = scans.faces() > 0 ? ProjectionNeeds() : grid->needs;  // those are of points
    const auto points = static_cast<double>(scans.points());
    const std::uint64_t charts =
        around() ? needs_.charts(points, scans.sample_m(), false, scan_to_grid_, grid->lattice) : 0;
    const std::uint64_t bytes =
        std::max({least, needs_.with_grid(scans, filters_, points, charts, grid->lattice, needs),
                  bytes_with_sides(amount_of(scans), needs.side_bytes(points))});
    return bytes + bytes / kMissing;
  }

  void build_in_memory(ScanSet& scans) {
    auto cloud = std::make_shared<Cloud>(scans.load(scans.origin_m(), progress_));
    if (cloud->size() == 0) throw no_points(config_);
    Report::Points points;
    points.read = cloud->size() + cloud->invalid;
    points.invalid = cloud->invalid;
    const auto approve_sides = [&](std::uint64_t bytes) {
      const std::uint64_t needed = bytes_with_sides(amount_of(scans), bytes);
      if (limit_.bytes > 0 && needed > limit_.bytes) throw DoesNotFit{0, needed};
    };
    const auto approve_nodes = [&](const scene::Lattice& lattice, const ProjectionNeeds& needs) {
      const std::uint64_t needed = needs_.with_grid(scans, filters_, static_cast<double>(cloud->size()),
                                                    chart_bytes(*cloud, lattice), lattice, needs);
      if (limit_.bytes > 0 && needed > limit_.bytes) throw DoesNotFit{needed};
      require_room(lattice, needs_.nodes(scans, lattice));
    };
    build_cloud(cloud, filters_, points, {}, {approve_sides, approve_nodes});
  }

  // Filters and projects a cloud of which `points` and `before` say what has become so far.
  void build_cloud(const std::shared_ptr<Cloud>& cloud, const std::vector<scene::FilterConfig>& filters,
                   const Report::Points& points, FilterSteps&& before, const Approval& approval) {
    result_.points = points;
    add_steps(std::move(before));
    const std::vector<Station> stations = cloud->stations;
    auto removed = std::make_shared<Cloud>();
    double moved_rms_m = 0.0;
    if (!filters.empty()) {
      progress_.begin("filter");
      FilterNeeds needs;
      needs.spacing_m = [this](const Cloud& present) { return planned_spacing_m(present); };
      needs.removed_outliers = config_.check ? removed.get() : nullptr;
      FilterSteps steps = apply_filters(*cloud, filters, {pool_, progress_}, needs);
      cloud->fields = {};
      moved_rms_m = steps.moved_rms_m;
      add_steps(std::move(steps));
    }
    cloud->stations = stations;  // filters make new clouds
    use_sample(*cloud, stations);
    if (unrolls()) lay_flat(*cloud, *removed);
    progress_.begin("project");
    result_.triangles = cloud->faces.size();
    result_.projection =
        project(*cloud, scan_to_grid_, grid_, config_.haptics.resolution_m, {pool_, progress_}, approval);
    if (unrolled_) uncount_repeated(unrolled_->points, result_.projection);
    // The noise is that of the points as measured; a mesh has none.
    double& noise_m = result_.projection.noise_m;
    if (!result_.projection.only_mesh) noise_m = std::hypot(noise_m, moved_rms_m);
    if (around()) {
      progress_.begin("charts");
      result_.charts = charts_of(*cloud, scan_to_grid_, grid_, result_.projection.grid.lattice.spacing_m, config_,
                                 {pool_, progress_});
    }
    if (!checks()) return;
    result_.check_charts = [&config = config_, &pool = pool_, &progress = progress_, scan_to_grid = scan_to_grid_,
                            cloud](const scene::Charts& charts) {
      return check_charts_of(*cloud, scan_to_grid, charts, config, {pool, progress});
    };
    auto classes = std::make_shared<Projection>();
    classes->point_class = std::move(result_.projection.point_class);
    classes->noise_m = result_.projection.noise_m;
    classes->point_spacing_m = result_.projection.point_spacing_m;
    classes->gap_m = result_.projection.gap_m;
    result_.check = [&config = config_, &pool = pool_, &progress = progress_, scan_to_grid = scan_to_grid_, cloud,
                     removed, classes](scene::DepthGrid& grid) {
      classes->grid = std::move(grid);
      restore_measured(*cloud);
      add_outliers(*cloud, *removed, scan_to_grid, *classes);
      CheckResult check = cross_check(*cloud, scan_to_grid, *classes, config.fill, *config.check, {pool, progress});
      grid = std::move(classes->grid);
      return check;
    };
  }

  // From here on what is a scan is laid flat, in the grid's frame.
  void lay_flat(Cloud& cloud, Cloud& removed) {
    progress_.begin("unroll");
    unrolled_ = unroll_cloud(cloud, sample_of_kept(cloud).points(), config_, grid_, {pool_, progress_});
    unroll_points(removed, scene::Unrolling(unrolled_->unroll, unrolled_->scan_to_grid));
    grid_ = unrolled_->grid;
    scan_to_grid_ = Eigen::Matrix4d::Identity();
    result_.unroll = unrolled_->unroll;
    result_.orientation = unrolled_->reason;
  }

  void add_steps(FilterSteps&& steps) {
    result_.points.filtered += steps.filtered();
    result_.points.outlier += steps.outliers();
    for (const FilterStep& step : steps.steps) {
      result_.filters.push_back(
          {step.name, step.removed, step.outliers, step.merges, step.found, step.sample.points()});
    }
  }

  // For the report's pictures, the pillars and the orientation, whichever of them the configuration asks for.
  void use_sample(const Cloud& cloud, const std::vector<Station>& stations) {
    if (finds_pillars() || !oriented_ || (shows_sides() && cloud.faces.empty()))
      use_sample(sample_of_kept(cloud).points(), stations);
    if (shows_sides() && !cloud.faces.empty()) result_.kept_m = sample_of_kept(places_on_faces(cloud)).points();
  }

  void use_sample(const std::vector<Eigen::Vector3d>& sample_m, const std::vector<Station>& stations) {
    if (shows_sides()) result_.kept_m = sample_m;
    if (finds_pillars()) result_.sample_m = some_of(sample_m, 60000);
    if (!oriented_) find_orientation(sample_m, stations);
  }

  [[nodiscard]] static std::vector<Eigen::Vector3d> some_of(const std::vector<Eigen::Vector3d>& points_m,
                                                            std::size_t count) {
    PointSample sample(count);
    for (const Eigen::Vector3d& p : points_m) sample.add(p);
    return sample.points();
  }

  // What `face` asks for, found once: by the filter that needs it first, or by what is left of the points.
  void find_orientation(const std::vector<Eigen::Vector3d>& points_m, const std::vector<Station>& stations) {
    progress_.begin("orient");
    const scene::OrientationConfig& orientation = config_.orientation;
    FoundFace found = find_face({some_of(points_m, 20000), stations, z_up_}, *orientation.face, orientation.face_up,
                                orientation.face_scale);
    scan_to_grid_ = found.scan_to_grid;
    result_.orientation = std::move(found.reason);
    oriented_ = true;
  }

  // Spacing of the grid, metres of the scan frame, for `thin`. An automatic one is kept from here on: thinning must not
  // make the grid coarser.
  double planned_spacing_m(const Cloud& cloud) {
    if (!(grid_.spacing_m > 0.0)) {
      if (!oriented_) find_orientation(sample_of_kept(cloud).points(), cloud.stations);
      const double spacing_m = Projector(cloud, pool_, false)
                                   .lattice(scan_to_grid_, grid_, config_.haptics.resolution_m, {pool_, progress_})
                                   .spacing_m;
      if (grid_.size == 0) grid_.spacing_m = spacing_m;
      return spacing_m / scale();
    }
    return grid_.spacing_m / scale();
  }
  [[nodiscard]] double scale() const { return scale_of(scan_to_grid_); }

  /// OpenCV takes its memory past the program's allocator.
  [[nodiscard]] bool may_put_nodes_on_disk() const {
    const bool opencv =
        !options_.grid_only && config_.texture && config_.texture->method == scene::TextureConfig::Method::opencv;
    return limit_.bytes > 0 && system::has_disk_arrays() && !opencv;
  }
  void put_nodes_on_disk_unless_they_fit(std::uint64_t node_bytes, std::uint64_t bytes_per_point,
                                         std::uint64_t sample_bytes, const scene::Lattice& lattice) {
    if (!may_put_nodes_on_disk() || nodes_fit(limit_, node_bytes, bytes_per_point, sample_bytes, lattice)) return;
    limit_.nodes_on_disk = true;
    result_.disk_arrays = std::make_shared<system::DiskArrays>(scratch_folder(), limit_.bytes);
  }

  /// Whole objects have pictures of their own.
  [[nodiscard]] bool has_sides() const { return !options_.grid_only && !around() && !unrolls(); }
  /// The root draws them, from what all ranks have sampled.
  [[nodiscard]] bool shows_sides() const { return has_sides() && is_root(); }

  [[nodiscard]] bool thins() const {
    return std::any_of(filters_.begin(), filters_.end(), [](const scene::FilterConfig& filter) {
      return std::holds_alternative<scene::VoxelConfig>(filter);
    });
  }

  // Streams the scans through a voxel filter, whose voxels must fit into memory.
  void build_thinned(const ScanSet& scans) {
    progress_.begin("filter");
    ThinnedScans thinned = thin_scans(scans, config_, filters_, most_voxels(limit_), {pool_, progress_});
    const std::shared_ptr<Cloud>& cloud = thinned.cloud;
    const auto approve_sides = [&](std::uint64_t bytes) { require_room_for_sides(bytes); };
    const auto approve_nodes = [&](const scene::Lattice& lattice, const ProjectionNeeds& needs) {
      const std::uint64_t nodes = needs_.nodes(scans, lattice);
      limit_.beside = needs.column_bytes + needs.kept_side_bytes(static_cast<double>(cloud->size()));
      if (const std::uint64_t charts = chart_bytes(*cloud, lattice); charts > 0) {
        const ScanAmount left{cloud->size(), 0, amount_of(scans).attributes};
        const std::uint64_t needed = bytes_in_memory(left, {}) + nodes + charts + limit_.beside +
                                     needs_.more_than_windows(needs.bytes_per_point) * left.points;
        if (needed > limit_.bytes) throw refusal_in_memory(left.points, needed, true);
      }
      put_nodes_on_disk_unless_they_fit(nodes, needs.bytes_per_point, 0, lattice);
      if (!limit_.nodes_on_disk) require_room(lattice, nodes);
      MemoryLimit of_bytes = limit_;
      of_bytes.points = 0;
      (void)points_of_a_tile(of_bytes, nodes, needs.bytes_per_point, 0, lattice);
    };
    build_cloud(cloud, thinned.rest, thinned.points, std::move(thinned.steps), {approve_sides, approve_nodes});
  }

  /// Discs and what tells sides apart take and free arrays of many sizes, which a heap that is kept would add up.
  void save_memory() {
    if (limit_.bytes > 0 && !thrifty_) thrifty_.emplace();
  }

  void require_room_for_sides(std::uint64_t bytes) {
    pipeline::require_room_for_sides(limit_, bytes);
    save_memory();
  }

  // Before points go to disk, where a sample already tells that the limit cannot hold.
  void require_room_by_sample(const ScanSet& scans) const {
    if (!filters_.empty() || !oriented_) return;
    const std::optional<SampledGrid> grid =
        sampled_grid(scans.sample_m(), scan_to_grid_, config_.grid, config_.haptics.resolution_m, {pool_, progress_});
    if (!grid) return;
    MemoryLimit limit = limit_;
    limit.nodes_on_disk = may_put_nodes_on_disk();
    const auto all = static_cast<double>(scans.points());
    limit.beside = grid->needs.kept_side_bytes(all);
    const std::uint64_t sample_bytes = checks() ? bytes_of_sample(*config_.check, scans.points(), grid->lattice) : 0;
    limit.floor = bytes_on_disk(limit, grid->needs.side_bytes(all), needs_.nodes(scans, grid->lattice),
                                grid->needs.bytes_per_point, sample_bytes, grid->lattice);
    limit.floor += limit.floor / 50;  // the lattice of all points is larger
    require_room_about_nodes(limit, scans.sample_m(), scans.points(), scan_to_grid_, *grid);
    require_room_likely(limit, checks() ? &*config_.check : nullptr, scans.points(), needs_.nodes(scans, grid->lattice),
                        grid->needs.bytes_per_point, grid->lattice);
    pipeline::require_room_for_sides(limit, grid->needs.side_bytes(all));
  }

  /// `needed` in memory with the grid, bytes; 0 where that is not known.
  void build_out_of_core(ScanSet& scans, std::uint64_t needed) {
    if (around() || unrolls()) {
      std::uint64_t least = needed;
      if (least == 0) least = bytes_in_memory(amount_of(scans), filters_);
      if (needed == 0 && around()) least += bytes_of_charts(static_cast<double>(scans.points()), 0.0, false);
      throw refusal_in_memory(scans.points(), least, needed > 0);
    }
    require_room_by_sample(scans);
    require_room_on_disk(limit_);
    progress_.begin("points to disk");
    StreamedFilters streamed(scans, filters_, {pool_, progress_});
    if (!oriented_ || finds_pillars() || has_sides()) streamed.sample_kept();
    CloudOnDisk cloud = write_to_disk(scans, std::move(streamed), config_.grid.colour, config_.grid.intensity,
                                      scratch_folder(), progress_);
    if (cloud.all == 0) throw no_points(config_);
    if (limit_.bytes > 0) system::trim_heap();
    result_.points = {};
    result_.points.invalid = cloud.invalid;
    const std::vector<Eigen::Vector3d> sample_m = cloud.filters.kept.points();
    add_steps(std::move(cloud.filters));
    result_.points.read = cloud.all + cloud.invalid + result_.points.filtered;

    use_sample(sample_m, cloud.stations);
    progress_.begin("project");
    const auto approve_sides = [&](std::uint64_t bytes) {
      // All points may show sides near each other that a sample does not.
      if (limit_.in_memory > 0)
        limit_.in_memory = std::max(limit_.in_memory, bytes_with_sides(amount_of(scans), bytes));
      require_room_for_sides(bytes);
    };
    TiledProjection tiled(std::move(cloud), scan_to_grid_, config_.grid, config_.haptics.resolution_m, options_.ranks,
                          approve_sides, {pool_, progress_});
    const scene::Lattice& lattice = tiled.plan().lattice;
    const std::uint64_t sample_bytes = checks() ? bytes_of_sample(*config_.check, result_.points.read, lattice) : 0;
    const std::uint64_t nodes = needs_.nodes(scans, lattice);
    const std::uint64_t bytes_per_point = tiled.needs().bytes_per_point;
    limit_.beside = tiled.needs().kept_side_bytes(tiled.needs().points);
    if (limit_.in_memory > 0) {
      const std::uint64_t now = needs_.with_grid(scans, filters_, tiled.needs().points, 0, lattice, tiled.needs());
      limit_.in_memory = std::max(limit_.in_memory, now);
    }
    if (tiled.plan().discs) save_memory();
    put_nodes_on_disk_unless_they_fit(nodes, bytes_per_point, sample_bytes, lattice);
    if (!limit_.nodes_on_disk) require_room(lattice, nodes);
    const std::uint64_t tile_points = points_of_a_tile(limit_, nodes, bytes_per_point, sample_bytes, lattice);
    if (checks()) require_room_for_sample(limit_, *config_.check, result_.points.read, nodes, lattice);
    if (resumes()) result_.sources = scans.sources();
    std::optional<FinishedTiles> finished =
        open_kept_tiles(options_, config_, result_.sources, tiled.plan(), progress_);
    const std::uint64_t most = finished ? std::min(tile_points, kTilePoints) : tile_points;
    result_.projection =
        tiled.run({most, limit_, finished ? &*finished : nullptr}, scratch_folder(), {pool_, progress_});
    system::trim_heap();
    if (!checks() || !is_root()) return;
    auto points = std::make_shared<BucketedPoints>(tiled.take_points());
    const double noise_m = result_.projection.noise_m;
    const double point_spacing_m = result_.projection.point_spacing_m;
    result_.check = [&config = config_, &pool = pool_, &progress = progress_, scan_to_grid = scan_to_grid_, points,
                     noise_m, point_spacing_m](scene::DepthGrid& grid) {
      const CountedPoints counted = counted_points(*points, scan_to_grid, grid.lattice, progress);
      return cross_check(counted, grid, noise_m, point_spacing_m, config.fill, *config.check, {pool, progress});
    };
  }

  const scene::Config& config_;
  const BuildOptions& options_;
  ThreadPool& pool_;
  Progress& progress_;
  Eigen::Matrix4d scan_to_grid_;
  std::optional<UnrolledCloud> unrolled_;
  bool oriented_ = true;
  bool z_up_ = false;
  scene::GridConfig grid_;
  MemoryNeeds needs_;
  MemoryLimit limit_;
  std::optional<system::ThriftyHeap> thrifty_;
  std::vector<scene::FilterConfig> filters_;
  ProjectedScans result_;
};

}  // namespace

ProjectedScans project_scans(const scene::Config& config, const BuildOptions& options, const Context& context) {
  return Builder(config, options, context).run();
}

}  // namespace sparsha::pipeline

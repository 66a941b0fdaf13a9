// Units, poses, the common origin, and the one rounding of every point.
#include "pipeline/scan/set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/files/files.h"
#include "base/threads/background.h"
#include "pipeline/scan/doubts.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/named_file.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/placement.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/straight.h"
#include "pipeline/scan/units.h"
#include "pipeline/scan/up_axes.h"
#include "pipeline/scan/viewpoint.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kMostStations = 256;  // of a file
constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// The one place where a point is rounded: near(i, q) of points that fit a float, far(i) of the others.
template <typename Near, typename Far>
void round_points(const Placement& placement, const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3d> points,
                  const Near& near, const Far& far) {
  constexpr float kFar = 1e30F;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f q = (placement(points[i]) - origin_m).cast<float>();
    if (std::fabs(q.x()) < kFar && std::fabs(q.y()) < kFar && std::fabs(q.z()) < kFar) {
      near(i, q);
    } else {
      far(i);
    }
  }
}

bool is_among(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Of a field: that it is no coordinate, which tables have as "easting (x)", no colour and no normal.
bool tells_more(const std::string& key) {
  for (const std::string_view of_place : {" (x)", " (y)", " (z)"}) {
    if (key.ends_with(of_place)) return false;
  }
  return key == kIntensityField || !is_known_otherwise(key);
}

/// The fields of some points of a block.
class FieldBuffer {
 public:
  void begin(std::span<const std::span<const float>> fields) {
    values_.resize(fields.size());
    for (std::vector<float>& values : values_) values.clear();
  }
  void add(std::span<const std::span<const float>> fields, std::size_t point) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (!fields[k].empty()) values_[k].push_back(fields[k][point]);
    }
  }
  /// Good until the next begin().
  [[nodiscard]] std::span<const std::span<const float>> spans() {
    spans_.assign(values_.begin(), values_.end());
    return spans_;
  }

 private:
  std::vector<std::vector<float>> values_;
  std::vector<std::span<const float>> spans_;
};

/// Read piece by piece: a mapped file would count as memory of this process.
std::string digest_of(const std::filesystem::path& file, const std::atomic<bool>& abandoned) {
  // Opening a named pipe would wait for somebody who writes to it.
  require_file_name(file);
  if (!std::filesystem::is_regular_file(file)) throw input_error(file.string(), "this is not a regular file", "a scan");
  Sha256 digest;
  std::vector<char> buffer(1U << 18U);
  std::ifstream stream(file, std::ios::binary);
  while (stream && !abandoned) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    digest.add(std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(stream.gcount()))));
  }
  if (!stream.eof() && !abandoned) throw input_error(file.string(), "the file cannot be read", "a readable file");
  return digest.finish();
}

}  // namespace

/// One scan: everything but its points, which are kept in double or streamed from the file again.
struct ScanSet::Scan {
  std::filesystem::path file;
  ReadOptions options;
  RawScan raw;
  bool streamed = false;
  std::uint64_t delivered = 0;  ///< finite points of the file
  std::uint64_t valid = 0;      ///< of these, without empty returns
  bool colour = false;
  bool intensity = false;
  bool normals = false;
  std::vector<bool> has_field;  ///< of ReadOptions::fields
  /// Points that were looked at, file units.
  struct Looked {
    std::uint64_t count = 0;
    PointSample sample;
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;

    void add(const Eigen::Vector3d& p, bool bounds) {
      ++count;
      sample.add(p);
      if (!bounds) return;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    void add(const Looked& other) {
      count += other.count;
      sample.merge(other.sample, [](const Eigen::Vector3d& p) { return p; });
      low = low.cwiseMin(other.low);
      high = high.cwiseMax(other.high);
    }
  };
  Looked looked;      ///< all but
  Looked at_scanner;  ///< what may be empty returns, until their number is known
  Placement placement;
  struct Seen {
    Eigen::Vector3d place;
    PointSample sample;
    PointSample at_scanner;  ///< as above
  };
  std::vector<Seen> from;   ///< each station, file units
  PointSample with_normal;  ///< points whose normals the file states, file units
  PointSample normal_at_scanner;

  /// A pose answers whether the points are in the sensor's own frame: they are where it is the viewpoint's.
  void take_pose_for_viewpoint(const scene::ScanConfig& config) {
    if (!raw.viewpoint) return;
    const bool sized = config.units.unit == scene::LengthUnit::longest_side;
    if (!sized && is_viewpoint(*raw.viewpoint, config.pose, scene::metres_in(config.units.unit))) {
      for (Seen& seen : from) seen.place.setZero();
    }
    raw.viewpoint.reset();
  }

  void look_from(const PointBlock& block) {
    if (!block.station) return;
    if (from.empty() || from.back().place != *block.station) {
      if (from.size() == kMostStations) return;
      from.push_back({*block.station, PointSample(), PointSample()});
    }
    for (const Eigen::Vector3d& p : block.points) {
      (is_at_scanner(p, block.station) ? from.back().at_scanner : from.back().sample).add(p);
    }
  }
  void look_at_normals(const PointBlock& block) {
    for (std::size_t i = 0; i < block.normals.size(); ++i) {
      const Eigen::Vector3f& normal = block.normals[i];
      if (!normal.allFinite() || !(normal.squaredNorm() > 0.0F)) continue;
      const bool apart = is_at_scanner(block.points[i], block.station);
      (apart ? normal_at_scanner : with_normal).add(block.points[i], normal);
    }
  }
  void look(const PointBlock& block, bool bounds) {
    look_from(block);
    look_at_normals(block);
    colour = colour || !block.rgba.empty();
    intensity = intensity || !block.intensity.empty();
    normals = normals || !block.normals.empty();
    has_field.resize(options.fields.size());
    for (std::size_t k = 0; k < block.fields.size(); ++k) {
      if (!block.fields[k].empty()) has_field[k] = true;
    }
    for (const Eigen::Vector3d& p : block.points) {
      (is_at_scanner(p, block.station) ? at_scanner : looked).add(p, bounds);
    }
  }
  /// After the last block: whether what stands at the scanner is surface.
  void decide_empty_returns() {
    delivered = valid = looked.count + at_scanner.count;
    const std::uint64_t all = delivered + raw.unread;
    if (raw.faces.empty() && are_empty_returns(at_scanner.count, all)) {
      raw.warnings.push_back(empty_returns_warning(at_scanner.count, all));
      raw.invalid += at_scanner.count;
      valid -= at_scanner.count;
      return;
    }
    const auto stay = [](const Eigen::Vector3d& p) { return p; };
    looked.add(at_scanner);
    for (Seen& seen : from) seen.sample.merge(seen.at_scanner, stay);
    with_normal.merge(normal_at_scanner, stay);
  }
  [[nodiscard]] PointSink without_empty_returns(const PointSink& sink) const {
    if (valid == delivered) return sink;
    return [&sink, points = std::vector<Eigen::Vector3d>(), rgba = std::vector<std::uint32_t>(),
            intensity = std::vector<float>(), normals = std::vector<Eigen::Vector3f>(),
            fields = FieldBuffer()](const PointBlock& block) mutable {
      points.clear();
      rgba.clear();
      intensity.clear();
      normals.clear();
      fields.begin(block.fields);
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        if (is_at_scanner(block.points[i], block.station)) continue;
        points.push_back(block.points[i]);
        if (!block.rgba.empty()) rgba.push_back(block.rgba[i]);
        if (!block.intensity.empty()) intensity.push_back(block.intensity[i]);
        if (!block.normals.empty()) normals.push_back(block.normals[i]);
        fields.add(block.fields, i);
      }
      sink({points, rgba, intensity, {}, normals, fields.spans()});
    };
  }
  /// Throws Error{input} when the file has not the points any more that were looked at.
  void for_each_block(const PointSink& sink, Progress& progress) const {
    if (valid == 0) return;
    std::uint64_t seen = 0;
    const PointSink use = without_empty_returns(sink);
    const auto changed = [&] {
      return input_error(file.string(), "the file changed while it was read", "a file that nobody writes to");
    };
    const auto counted = [&](const PointBlock& block) {
      progress.throw_if_cancelled();
      seen += block.points.size();
      if (seen > delivered) throw changed();
      use(block);
    };
    if (streamed) {
      ReadOptions again = options;
      again.tally = ReadOptions::Tally::none;
      (void)stream_scan(file, counted, &progress, again);
    } else {
      const std::vector<std::span<const float>> fields(raw.values.begin(), raw.values.end());
      counted({raw.points, raw.rgba, raw.intensity, {}, raw.normals, fields});
    }
    if (seen != delivered) throw changed();
  }
  double scale(const scene::ScanConfig& config, Progress& progress) const {
    const std::string name = config.file.string();
    const scene::Units& units = config.units;
    if (!raw.guessed_degrees || units.unit == scene::LengthUnit::automatic) require_lengths(raw, name);
    if (units.unit == scene::LengthUnit::longest_side) {
      const double side = (looked.high - looked.low).maxCoeff();
      if (!(side > 0.0)) throw input_error(name, "all points are the same, so no longest side can be set", "an extent");
      return units.longest_side_m / side;
    }
    const double metres = metres_in_unit(config, raw.unit);
    if (raw.unit || units.unit != scene::LengthUnit::automatic) return metres;
    if (const std::optional<UnitGuess> guess = doubt_metres(looked.sample)) {
      progress.warn(fmt::format("{}: no unit is known, metres are taken; {}{}", name, guess->reason,
                                guess->unit == scene::LengthUnit::m
                                    ? "; set 'units' if that is wrong"
                                    : fmt::format("; set 'units: {}' if that is right", to_string(guess->unit))));
    }
    return metres;
  }
  /// By the configuration, against or without the format's.
  [[nodiscard]] bool has_chosen_unit(const scene::ScanConfig& config) const {
    const scene::LengthUnit unit = config.units.unit;
    return unit != scene::LengthUnit::automatic && unit != scene::LengthUnit::longest_side && unit != raw.unit;
  }
  /// The farthest coordinate, outliers aside, file units.
  [[nodiscard]] double away() const {
    const std::vector<Eigen::Vector3d> points = looked.sample.points();
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double rank : {0.01, 0.99}) farthest = std::max(farthest, std::abs(quantile(points, axis, rank)));
    }
    return farthest;
  }
  static std::unique_ptr<Scan> look_at(const scene::ScanConfig& config, const std::vector<std::string>& fields,
                                       bool streamed, Progress& progress, const MeshRefusal& mesh_refusal = {},
                                       const ScanPart& part = {}) {
    auto scan = std::make_unique<Scan>();
    scan->file = config.file;
    scan->options.columns = config.columns;
    scan->options.fields = fields;
    scan->options.mesh_refusal = mesh_refusal;
    if (part.box) scan->options.region = region_of(config, *part.box);
    scan->options.enough = part.enough;
    scan->options.whole_chunks_only = part.whole_chunks_only;
    scan->streamed = streamed;
    const bool bounds = config.units.unit == scene::LengthUnit::longest_side;
    if (streamed) {
      scan->raw = stream_scan(
          config.file,
          [&](const PointBlock& block) {
            progress.throw_if_cancelled();
            scan->look(block, bounds);
          },
          &progress, scan->options);
    } else {
      scan->raw = read_scan(config.file, &progress, scan->options);
      drop_what_is_no_surface(scan->raw);
      const std::vector<std::span<const float>> values(scan->raw.values.begin(), scan->raw.values.end());
      scan->look({scan->raw.points, scan->raw.rgba, scan->raw.intensity, {}, scan->raw.normals, values}, bounds);
      const std::vector<RawStation>& stations = scan->raw.stations;
      for (std::size_t s = 0; s < stations.size(); ++s) {
        const std::size_t end = s + 1 < stations.size() ? stations[s + 1].first : scan->raw.points.size();
        const std::span points(scan->raw.points);
        scan->look_from({points.subspan(stations[s].first, end - stations[s].first), {}, {}, stations[s].place, {}});
      }
    }
    scan->options.mesh_refusal = {};
    scan->decide_empty_returns();
    // A stream cannot know where a polygon is hollow, nor which points are corners: a mesh is looked at in memory.
    if (streamed && !scan->raw.faces.empty()) {
      scan.reset();
      scan = look_at(config, fields, false, progress);
      scan->streamed = true;
      scan->raw.points = {};
      scan->raw.rgba = {};
      scan->raw.intensity = {};
      scan->raw.normals = {};
      scan->raw.values = {};
      return scan;
    }
    // What is said of a scan without a point that is wanted is said of all of it.
    if (scan->valid == 0 && scan->raw.unread > 0) {
      return look_at(config, fields, streamed, progress, mesh_refusal, {{}, 0, part.whole_chunks_only});
    }
    if (!config.pose.isIdentity(0.0)) scan->take_pose_for_viewpoint(config);
    add_doubts(scan->raw, scan->looked.sample, scan->looked.count, [&](const auto& use) {
      scan->for_each_block([&](const PointBlock& block) { use(block.points); }, progress);
    });
    const std::string name = config.file.string();
    for (const std::string& warning : scan->raw.warnings) progress.warn(name + ": " + warning);
    if (scan->valid == 0) {
      throw EmptyScan(name,
                      scan->raw.records == 0 ? "the scan has no points"
                                             : fmt::format("none of the {} points is valid", scan->raw.records),
                      "at least one finite point");
    }
    scan->placement = place(config, scan->scale(config, progress));
    return scan;
  }
};

ScanSet::ScanSet(const std::vector<scene::ScanConfig>& scans, Keep keep, bool digests, Progress& progress,
                 const std::vector<std::string>& fields, const MeshRefusal& mesh_refusal, const ScanPart& part)
    : configs_(scans), fields_(fields), abandoned_(std::make_shared<std::atomic<bool>>(false)) {
  PointSample sample;
  std::vector<ScanSize> sizes;
  std::vector<ScanUp> ups;
  std::vector<std::string> apart;  // what is said of points' pieces
  std::optional<EmptyScan> empty;  // the first of those without a point
  MeshRefusal refusal_of_all;
  if (mesh_refusal) {
    refusal_of_all = [&](std::uint64_t vertices, std::uint64_t triangles) {
      return mesh_refusal(points_ + vertices, faces_ + triangles);
    };
  }
  try {
    for (const scene::ScanConfig& config : scans) {
      progress.throw_if_cancelled();
      if (digests) {
        digests_.push_back(
            in_background([file = config.file, abandoned = abandoned_] { return digest_of(file, *abandoned); }));
      }
      const bool streamed = keep == Keep::disk || is_quick_to_stream(config.file);
      try {
        scans_.push_back(Scan::look_at(config, fields_, streamed, progress, refusal_of_all, part));
      } catch (const EmptyScan& found) {
        if (scans.size() == 1) throw;
        progress.warn(left_out_warning(found));
        if (!empty) empty = found;
        scans_.push_back(std::make_unique<Scan>());
        records_.push_back(0);
        continue;
      }
      const Scan& scan = *scans_.back();
      records_.push_back(scan.raw.records + scan.raw.unread);
      unread_ += scan.raw.unread;
      points_ += scan.valid;
      invalid_ += scan.raw.invalid;
      faces_ += scan.raw.faces.size();
      colour_ = colour_ || scan.colour;
      intensity_ = intensity_ || scan.intensity;
      normals_ = normals_ || scan.normals;
      z_up_ = z_up_ || is_z_up(scan.raw.format);
      if (!scan.raw.pieces.empty()) {
        (scan.raw.faces.empty() ? apart : pieces_).push_back(config.file.string() + ": " + scan.raw.pieces);
      }
      sample.merge(scan.looked.sample, scan.placement);
      PointSample placed;
      placed.merge(scan.looked.sample, scan.placement);
      const bool has_unit = scan.raw.unit || config.units.unit != scene::LengthUnit::automatic;
      sizes.emplace_back(config.file.string(), placed.points(), scan.valid, has_unit);
      const bool turned = !config.pose.topLeftCorner<3, 3>().isIdentity(0.0);
      ups.push_back({config.file.string(), scan.raw.format, turned});
      if (scan.has_chosen_unit(config)) {
        const double away_m = scan.away() * metres_in_unit(config, scan.raw.unit);
        nearest_of_chosen_unit_m_ = std::min(nearest_of_chosen_unit_m_.value_or(away_m), away_m);
      }
    }
    if (empty && points_ == 0) throw *empty;
    for (const UnitDifference& difference : differing_units(sizes)) progress.warn(difference.reason);
    if (const std::optional<UpDifference> difference = differing_up(ups)) progress.warn(difference->reason);
  } catch (...) {
    *abandoned_ = true;
    throw;
  }
  origin_m_ = common_origin(sample);
  sample_m_ = sample.points();
  if (apart_together(scans.size(), sample_m_)) pieces_.insert(pieces_.end(), apart.begin(), apart.end());
}

void ScanSet::require_surface() const {
  std::vector<std::string> files;
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (scans_[s]->valid > 0) files.push_back(configs_[s].file.string());
  }
  pipeline::require_surface(names_together(files), files.size(), sample_m_, points_);
}

void ScanSet::require_fields() const {
  std::vector<std::string> files;
  std::vector<std::string> names;
  std::vector<bool> has(fields_.size());
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const Scan& scan = *scans_[s];
    if (scan.valid == 0) continue;
    files.push_back(configs_[s].file.string());
    for (const std::string& name : scan.raw.fields) {
      const std::string key = field_key(name);
      if (tells_more(key) && !is_among(key, names)) names.push_back(key);
    }
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      has[k] = has[k] || scan.has_field[k] || (fields_[k] == kIntensityField && scan.intensity);
    }
  }
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (has[k]) continue;
    throw input_error(
        names_together(files),
        fmt::format("{} the field '{}'", files.size() == 1 ? "it has not" : "none of them has", fields_[k]),
        names.empty() ? "scans with that field; these have none beside places, colours and normals"
                      : fmt::format("one of {}", fmt::join(names, ", ")));
  }
}

ScanSet::~ScanSet() { *abandoned_ = true; }

const std::vector<std::string>& ScanSet::fields_of(std::size_t scan) const { return scans_[scan]->raw.fields; }

const std::vector<FieldTally>& ScanSet::tallies_of(std::size_t scan) const { return scans_[scan]->raw.tallies; }

bool ScanSet::drops_empty_returns() const {
  return std::ranges::any_of(scans_, [](const auto& scan) { return scan->valid < scan->delivered; });
}

std::vector<Station> ScanSet::stations() const {
  std::vector<Station> stations;
  const auto add = [&](const Scan& scan, bool declared, const Eigen::Vector3d& place, const PointSample& sample) {
    Station station{scan.file.string(), declared, scan.placement(place), sample.points(), {}};
    for (Eigen::Vector3d& p : station.seen_m) p = scan.placement(p);
    if (&sample == &scan.with_normal) {
      station.normals = sample.normals();
      const Eigen::Matrix3f turn = scan.placement.turn_and_scale.cast<float>();
      for (Eigen::Vector3f& n : station.normals) n = (turn * n.normalized()).normalized();
    }
    stations.push_back(std::move(station));
  };
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const Scan& scan = *scans_[s];
    if (scan.valid == 0) continue;
    for (const Scan::Seen& seen : scan.from) {
      if (!seen.sample.empty()) add(scan, true, seen.place, seen.sample);
    }
    // A pose moves a scanner's own coordinates, whose origin it is.
    if (scan.from.empty() && !configs_[s].pose.isIdentity(0.0))
      add(scan, false, Eigen::Vector3d::Zero(), scan.looked.sample);
    if (!scan.with_normal.empty()) add(scan, true, Eigen::Vector3d::Zero(), scan.with_normal);
  }
  return stations;
}

Cloud ScanSet::load(const Eigen::Vector3d& origin_m, Progress& progress) { return load(origin_m, progress, false); }

Cloud ScanSet::load(const Eigen::Vector3d& origin_m, Progress& progress, bool normals) {
  Cloud cloud;
  cloud.stations = stations();
  cloud.origin_m = origin_m;
  cloud.resize_points(static_cast<std::size_t>(points_));
  cloud.faces.reserve(faces_);
  if (colour_) cloud.rgba.reserve(cloud.size());
  if (intensity_) cloud.intensity.reserve(cloud.size());
  normals = normals && normals_;
  if (normals) cloud.normals.reserve(cloud.size());
  for (const std::string& name : fields_) {
    cloud.fields.push_back({name, {}});
    cloud.fields.back().values.reserve(cloud.size());
  }
  std::size_t count = 0;
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    Scan* scan = scans_[s].get();
    std::unique_ptr<Scan> again;
    if (scan->streamed && !scan->raw.faces.empty()) {
      again = Scan::look_at(configs_[s], fields_, false, progress);
      scan = again.get();
    }
    std::vector<std::uint32_t> moved;
    const bool faces = !scan->raw.faces.empty();
    if (faces) moved.reserve(static_cast<std::size_t>(scan->valid));
    const Eigen::Matrix3f turn = configs_[s].pose.topLeftCorner<3, 3>().cast<float>();
    scan->for_each_block(
        [&](const PointBlock& block) {
          float* out = cloud.xyz1() + 4 * count;
          round_points(
              scan->placement, origin_m, block.points,
              [&](std::size_t i, const Eigen::Vector3f& q) {
                if (faces) moved.push_back(static_cast<std::uint32_t>(count));
                out[0] = q.x();
                out[1] = q.y();
                out[2] = q.z();
                out += 4;
                ++count;
                if (colour_) cloud.rgba.push_back(block.rgba.empty() ? kNoColour : block.rgba[i]);
                if (intensity_) cloud.intensity.push_back(block.intensity.empty() ? kNoIntensity : block.intensity[i]);
                if (normals) {
                  const Eigen::Vector3f none = Eigen::Vector3f::Zero();
                  cloud.normals.push_back(block.normals.empty() ? none : Eigen::Vector3f(turn * block.normals[i]));
                }
                for (std::size_t k = 0; k < fields_.size(); ++k) {
                  // Not every format gives its intensity by that name, too.
                  const bool other = block.fields[k].empty() && fields_[k] == kIntensityField;
                  const std::span<const float> values = other ? block.intensity : block.fields[k];
                  cloud.fields[k].values.push_back(values.empty() ? kNoValue : values[i]);
                }
              },
              [&](std::size_t) {
                if (faces) moved.push_back(kGone);
                ++cloud.invalid;
              });
        },
        progress);
    for (const std::array<std::uint32_t, 3>& face : scan->raw.faces) {
      const std::array<std::uint32_t, 3> corners = {moved[face[0]], moved[face[1]], moved[face[2]]};
      if (corners[0] != kGone && corners[1] != kGone && corners[2] != kGone) cloud.faces.push_back(corners);
    }
    cloud.invalid += scan->raw.invalid;
    // Gives the memory back before the next scan is copied.
    if (!scan->streamed) scan->raw = RawScan{};
  }
  cloud.resize_points(count);
  return cloud;
}

std::uint64_t ScanSet::stream(const std::function<void(const CloudBlock&)>& use, Progress& progress) const {
  std::uint64_t beyond = 0;
  std::uint64_t done = 0;
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> rgba;
  std::vector<float> intensity;
  FieldBuffer fields;
  for (const std::unique_ptr<Scan>& scan : scans_) {
    scan->for_each_block(
        [&](const PointBlock& block) {
          points.clear();
          rgba.clear();
          intensity.clear();
          fields.begin(block.fields);
          round_points(
              scan->placement, origin_m_, block.points,
              [&](std::size_t i, const Eigen::Vector3f& q) {
                points.push_back(q);
                if (colour_) rgba.push_back(block.rgba.empty() ? kNoColour : block.rgba[i]);
                if (intensity_) intensity.push_back(block.intensity.empty() ? kNoIntensity : block.intensity[i]);
                fields.add(block.fields, i);
              },
              [&](std::size_t) { ++beyond; });
          use({points, rgba, intensity, fields.spans()});
          done += block.points.size();
          progress.at(static_cast<double>(done) / static_cast<double>(points_));
        },
        progress);
  }
  return beyond;
}

std::vector<scene::ScanSource> ScanSet::sources() {
  std::vector<scene::ScanSource> sources;
  for (std::size_t i = 0; i < digests_.size(); ++i) {
    sources.push_back({configs_[i].file, digests_[i].get(), records_[i]});
  }
  digests_.clear();
  return sources;
}

}  // namespace sparsha::pipeline

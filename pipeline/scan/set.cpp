// Units, poses, the common origin, and the one rounding of every point.
#include "pipeline/scan/set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/files/files.h"
#include "base/files/message.h"
#include "base/threads/background.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/field_buffer.h"
#include "pipeline/scan/looked_scan.h"
#include "pipeline/scan/named_file.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/placement.h"
#include "pipeline/scan/read_bytes.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/straight.h"
#include "pipeline/scan/units.h"
#include "pipeline/scan/up_axes.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

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

/// What the processes tell each other of a scan: of each of its parts, or of all of it.
struct ScanSet::Told {
  FileShare share;
  std::vector<ReadingRanks::Bytes> parts;
  std::uint64_t own = 0;  ///< points that this process has read
};

ScanSet::ScanSet(const std::vector<scene::ScanConfig>& scans, Keep keep, bool digests, Progress& progress,
                 const std::vector<std::string>& fields, const MeshRefusal& mesh_refusal, const ScanPart& part,
                 ReadingRanks ranks)
    : configs_(scans),
      fields_(fields),
      ranks_(std::move(ranks)),
      abandoned_(std::make_shared<std::atomic<bool>>(false)) {
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
    std::vector<Told> told;
    if (is_shared()) told = look_together(digests, progress, mesh_refusal, part);
    for (std::size_t s = 0; s < scans.size(); ++s) {
      const scene::ScanConfig& config = scans[s];
      progress.throw_if_cancelled();
      if (digests && !is_shared()) begin_digest(s);
      const bool streamed = keep == Keep::disk || is_quick_to_stream(config.file);
      try {
        scans_.push_back(is_shared() ? take(std::move(told[s]), s, progress, mesh_refusal, part)
                                     : LookedScan::look_at(config, fields_, streamed, progress, refusal_of_all, part));
      } catch (const EmptyScan& found) {
        if (scans.size() == 1) throw;
        progress.warn(left_out_warning(found));
        if (!empty) empty = found;
        scans_.push_back(std::make_unique<LookedScan>());
        records_.push_back(0);
        continue;
      }
      const LookedScan& scan = *scans_.back();
      records_.push_back(scan.raw.records + scan.raw.unread);
      unread_ += scan.raw.unread;
      points_ += scan.valid;
      invalid_ += scan.raw.invalid;
      faces_ += scan.faces;
      colour_ = colour_ || scan.colour;
      intensity_ = intensity_ || scan.intensity;
      normals_ = normals_ || scan.normals;
      z_up_ = z_up_ || is_z_up(scan.raw.format);
      if (!scan.raw.pieces.empty()) {
        (scan.faces == 0 ? apart : pieces_).push_back(config.file.string() + ": " + scan.raw.pieces);
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

/// Each process looks at its share; all of them get what was found.
std::vector<ScanSet::Told> ScanSet::look_together(bool digests, Progress& progress, const MeshRefusal& mesh_refusal,
                                                  const ScanPart& part) {
  std::vector<std::uint64_t> bytes;
  std::vector<bool> of_one_length;
  for (const scene::ScanConfig& config : configs_) {
    std::error_code code;
    const std::uint64_t size = std::filesystem::file_size(config.file, code);
    bytes.push_back(code ? 0 : size);
    of_one_length.push_back(is_quick_to_stream(config.file));
  }
  const std::vector<FileShare> shares = shares_of_files(bytes, of_one_length, ranks_.number, ranks_.size);
  std::vector<Told> told(configs_.size());
  MessageWriter message;
  for (std::size_t s = 0; s < configs_.size(); ++s) {
    told[s].share = shares[s];
    if (digests && shares[s].digests) begin_digest(s);
    if (!shares[s].reads || shares[s].kind == FileShare::Kind::whole_by_all) continue;
    message.put(std::uint64_t{s});
    MessageWriter found;
    try {
      const std::unique_ptr<LookedScan> scan =
          LookedScan::read(configs_[s], fields_, true, progress, mesh_refusal, part, shares[s]);
      told[s].own = scan->own;
      found.put(false);
      scan->write(found);
    } catch (const EmptyScan& empty) {
      found.put(true);
      found.put(empty.wrong());
      found.put(empty.expected());
    }
    const ReadingRanks::Bytes text = found.take();
    message.put(std::uint64_t{text.size()});
    message.put(std::span<const std::byte>(text));
  }
  ReadingRanks::Bytes all = message.take();
  ranks_.join(all);
  for (MessageReader reader(all); !reader.at_end();) {
    Told& of_scan = told[static_cast<std::size_t>(reader.get<std::uint64_t>())];
    const std::span<const std::byte> text = reader.bytes(reader.get<std::uint64_t>());
    of_scan.parts.emplace_back(text.begin(), text.end());
  }
  return told;
}

/// A scan by what was told of it, the same in every process; read by each of them where that is not enough.
std::unique_ptr<LookedScan> ScanSet::take(Told&& told, std::size_t number, Progress& progress,
                                          const MeshRefusal& mesh_refusal, const ScanPart& part) const {
  const scene::ScanConfig& config = configs_[number];
  auto scan = std::make_unique<LookedScan>();
  bool first = true;
  for (const ReadingRanks::Bytes& bytes : told.parts) {
    MessageReader message(bytes);
    if (message.get<bool>()) {
      std::string wrong = message.text();
      throw EmptyScan(config.file.string(), std::move(wrong), message.text());
    }
    scan->add(message, std::exchange(first, false));
  }
  const auto by_all = [&](const ScanPart& wanted) {
    auto whole = LookedScan::look_at(config, fields_, true, progress, mesh_refusal, wanted);
    whole->number = ranks_.number;
    whole->size = ranks_.size;
    return whole;
  };
  if (told.parts.empty() || scan->raw.needs_whole) return by_all(part);
  scan->prepare(config, fields_, part);
  scan->share = told.share;
  scan->own = told.own;
  scan->decide_empty_returns();
  if (scan->valid == 0 && scan->raw.unread > 0) return by_all({{}, 0, part.whole_chunks_only});
  scan->settle(config, progress);
  return scan;
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
    const LookedScan& scan = *scans_[s];
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
  const auto add = [&](const LookedScan& scan, bool declared, bool proved, const Eigen::Vector3d& place,
                       const PointSample& sample) {
    Station station{scan.file.string(), declared, scan.placement(place), sample.points(), {}, proved};
    for (Eigen::Vector3d& p : station.seen_m) p = scan.placement(p);
    if (&sample == &scan.with_normal) {
      station.normals = sample.normals();
      const Eigen::Matrix3f turn = scan.placement.turn_and_scale.cast<float>();
      for (Eigen::Vector3f& n : station.normals) n = (turn * n.normalized()).normalized();
    }
    stations.push_back(std::move(station));
  };
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const LookedScan& scan = *scans_[s];
    if (scan.valid == 0) continue;
    for (const SeenStation& seen : scan.from) {
      if (!seen.sample.empty()) add(scan, true, seen.steps.are_even(), seen.place, seen.sample);
    }
    // A pose moves a scanner's own coordinates, whose origin it is.
    if (scan.from.empty() && !configs_[s].pose.isIdentity(0.0))
      add(scan, false, scan.about_origin.are_even(), Eigen::Vector3d::Zero(), scan.looked.sample);
    if (!scan.with_normal.empty()) add(scan, true, false, Eigen::Vector3d::Zero(), scan.with_normal);
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
    LookedScan* scan = scans_[s].get();
    std::unique_ptr<LookedScan> again;
    if (scan->streamed && !scan->raw.faces.empty()) {
      again = LookedScan::look_at(configs_[s], fields_, false, progress);
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
  for (const std::unique_ptr<LookedScan>& scan : scans_) {
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
          progress.at(std::min(1.0, static_cast<double>(done * ranks_.size) / static_cast<double>(points_)));
        },
        progress, is_shared());
  }
  return beyond;
}

void ScanSet::begin_digest(std::size_t scan) {
  digests_.emplace(scan, in_background([file = configs_[scan].file, abandoned = abandoned_] {
                     return digest_of(file, *abandoned);
                   }));
}

std::vector<scene::ScanSource> ScanSet::sources() {
  MessageWriter message;
  std::vector<std::string> digests(configs_.size());
  for (auto& [scan, digest] : digests_) {
    digests[scan] = digest.get();
    message.put(std::uint64_t{scan});
    message.put(digests[scan]);
  }
  digests_.clear();
  if (is_shared()) {
    ReadingRanks::Bytes bytes = message.take();
    ranks_.join(bytes);
    for (MessageReader reader(bytes); !reader.at_end();) {
      const auto scan = static_cast<std::size_t>(reader.get<std::uint64_t>());
      digests[scan] = reader.text();
    }
  }
  std::vector<scene::ScanSource> sources;
  for (std::size_t i = 0; i < configs_.size(); ++i) {
    if (!digests[i].empty()) sources.push_back({configs_[i].file, digests[i], records_[i]});
  }
  return sources;
}

}  // namespace sparsha::pipeline

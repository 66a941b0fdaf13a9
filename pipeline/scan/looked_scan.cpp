// What is looked at depends on the set of points alone, so that parts of a file that several processes have read merge
// into what one of them would have found.
#include "pipeline/scan/looked_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pipeline/scan/doubts.h"
#include "pipeline/scan/empty_returns.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/field_buffer.h"
#include "pipeline/scan/units.h"
#include "pipeline/scan/viewpoint.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

Eigen::Vector3d unmoved(const Eigen::Vector3d& p) { return p; }

template <typename T>
std::span<T> cut(std::span<T> values, std::size_t first, std::size_t count) {
  return values.empty() ? values : values.subspan(first, count);
}

}  // namespace

void LookedScan::Looked::add(const Looked& other) {
  count += other.count;
  sample.merge(other.sample, unmoved);
  low = low.cwiseMin(other.low);
  high = high.cwiseMax(other.high);
}

void LookedScan::Looked::write(MessageWriter& message) const {
  message.put(count);
  sample.write(message);
  for (const Eigen::Vector3d* const corner : {&low, &high}) {
    for (const double coordinate : *corner) message.put(coordinate);
  }
}

void LookedScan::Looked::add(MessageReader& message) {
  Looked other;
  other.count = message.get<std::uint64_t>();
  other.sample.add(message);
  for (Eigen::Vector3d* const corner : {&other.low, &other.high}) {
    for (double& coordinate : *corner) coordinate = message.get<double>();
  }
  add(other);
}

/// A pose answers whether the points are in the sensor's own frame: they are where it is the viewpoint's.
void LookedScan::take_pose_for_viewpoint(const scene::ScanConfig& config) {
  if (!raw.viewpoint) return;
  const bool sized = config.units.unit == scene::LengthUnit::longest_side;
  if (!sized && is_viewpoint(*raw.viewpoint, config.pose, scene::metres_in(config.units.unit))) {
    for (SeenStation& seen : from) seen.place.setZero();
  }
  raw.viewpoint.reset();
}

void LookedScan::look_at_normals(const PointBlock& block) {
  for (std::size_t i = 0; i < block.normals.size(); ++i) {
    const Eigen::Vector3f& normal = block.normals[i];
    if (!normal.allFinite() || !(normal.squaredNorm() > 0.0F)) continue;
    const bool apart = is_at_scanner(block.points[i], block.station);
    (apart ? normal_at_scanner : with_normal).add(block.points[i], normal);
  }
}
void LookedScan::look(const PointBlock& block, bool bounds) {
  add_to_stations(block, from);
  if (posed && !block.station) about_origin.add(block.points, Eigen::Vector3d::Zero());
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
void LookedScan::decide_empty_returns() {
  delivered = valid = looked.count + at_scanner.count;
  const std::uint64_t all = delivered + raw.unread;
  if (faces == 0 && are_empty_returns(at_scanner.count, all)) {
    raw.warnings.push_back(empty_returns_warning(at_scanner.count, all));
    raw.invalid += at_scanner.count;
    valid -= at_scanner.count;
    return;
  }
  const auto stay = [](const Eigen::Vector3d& p) { return p; };
  looked.add(at_scanner);
  for (SeenStation& seen : from) seen.sample.merge(seen.at_scanner, stay);
  with_normal.merge(normal_at_scanner, stay);
}
PointSink LookedScan::without_empty_returns(const PointSink& sink) const {
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

/// Of a scan that every process reads: its share of the points, by their numbers.
PointSink LookedScan::share_of_points(const PointSink& sink) const {
  const auto border = [&](std::size_t rank) { return delivered / size * rank + delivered % size * rank / size; };
  return [&sink, first = border(number), last = border(number + 1),
          at = std::uint64_t{0}](const PointBlock& block) mutable {
    const std::uint64_t begin = std::clamp(at, first, last), end = std::clamp(at + block.points.size(), first, last);
    const auto skipped = static_cast<std::size_t>(begin - std::min(begin, at));
    const auto count = static_cast<std::size_t>(end - begin);
    at += block.points.size();
    if (count == 0) return;
    std::vector<std::span<const float>> fields;
    for (const std::span<const float> values : block.fields) fields.push_back(cut(values, skipped, count));
    sink({cut(block.points, skipped, count), cut(block.rgba, skipped, count), cut(block.intensity, skipped, count),
          block.station, cut(block.normals, skipped, count), fields});
  };
}

void LookedScan::for_each_block(const PointSink& sink, Progress& progress, bool shared) const {
  const bool part = shared && share.kind == FileShare::Kind::part;
  if (valid == 0 || (shared && !share.reads)) return;
  std::uint64_t seen = 0;
  const PointSink kept = without_empty_returns(sink);
  const PointSink use = shared && share.kind == FileShare::Kind::whole_by_all ? share_of_points(kept) : kept;
  const std::uint64_t expected = part ? own : delivered;
  const auto changed = [&] {
    return input_error(file.string(), "the file changed while it was read", "a file that nobody writes to");
  };
  const auto counted = [&](const PointBlock& block) {
    progress.throw_if_cancelled();
    seen += block.points.size();
    if (seen > expected) throw changed();
    use(block);
  };
  if (streamed) {
    ReadOptions again = options;
    again.tally = ReadOptions::Tally::none;
    if (part) {
      again.from = share.from;
      again.to = share.to;
    }
    (void)stream_scan(file, counted, &progress, again);
  } else {
    const std::vector<std::span<const float>> fields(raw.values.begin(), raw.values.end());
    counted({raw.points, raw.rgba, raw.intensity, {}, raw.normals, fields});
  }
  if (seen != expected) throw changed();
}

double LookedScan::scale(const scene::ScanConfig& config, Progress& progress) const {
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
bool LookedScan::has_chosen_unit(const scene::ScanConfig& config) const {
  const scene::LengthUnit unit = config.units.unit;
  return unit != scene::LengthUnit::automatic && unit != scene::LengthUnit::longest_side && unit != raw.unit;
}
double LookedScan::away() const {
  const std::vector<Eigen::Vector3d> points = looked.sample.points();
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double rank : {0.01, 0.99})
      farthest = std::max(farthest, std::abs(coordinate_quantile(points, axis, rank)));
  }
  return farthest;
}

void LookedScan::prepare(const scene::ScanConfig& config, const std::vector<std::string>& wanted,
                         const ScanPart& part) {
  file = config.file;
  posed = !config.pose.isIdentity(0.0);
  options.columns = config.columns;
  options.fields = wanted;
  if (part.box) options.region = region_of(config, *part.box);
  options.enough = part.enough;
  options.whole_chunks_only = part.whole_chunks_only;
  streamed = true;
}

std::unique_ptr<LookedScan> LookedScan::read(const scene::ScanConfig& config, const std::vector<std::string>& fields,
                                             bool streamed, Progress& progress, const MeshRefusal& mesh_refusal,
                                             const ScanPart& part, const FileShare& share) {
  auto scan = std::make_unique<LookedScan>();
  scan->prepare(config, fields, part);
  scan->options.mesh_refusal = mesh_refusal;
  scan->streamed = streamed;
  scan->share = share;
  const bool bounds = config.units.unit == scene::LengthUnit::longest_side;
  if (streamed) {
    ReadOptions options = scan->options;
    if (share.kind == FileShare::Kind::part) {
      options.from = share.from;
      options.to = share.to;
    }
    scan->raw = stream_scan(
        config.file,
        [&](const PointBlock& block) {
          progress.throw_if_cancelled();
          scan->look(block, bounds);
        },
        &progress, options);
  } else {
    scan->raw = read_scan(config.file, &progress, scan->options);
    drop_what_is_no_surface(scan->raw);
    const std::vector<std::span<const float>> values(scan->raw.values.begin(), scan->raw.values.end());
    scan->look({scan->raw.points, scan->raw.rgba, scan->raw.intensity, {}, scan->raw.normals, values}, bounds);
    add_to_stations(scan->raw, scan->from);
  }
  scan->options.mesh_refusal = {};
  scan->faces = scan->raw.faces.size();
  scan->own = scan->looked.count + scan->at_scanner.count;
  return scan;
}

std::unique_ptr<LookedScan> LookedScan::look_at(const scene::ScanConfig& config, const std::vector<std::string>& fields,
                                                bool streamed, Progress& progress, const MeshRefusal& mesh_refusal,
                                                const ScanPart& part) {
  std::unique_ptr<LookedScan> scan = read(config, fields, streamed, progress, mesh_refusal, part);
  scan->decide_empty_returns();
  // A stream cannot know where a polygon is hollow, nor which points are corners: a mesh is looked at in memory.
  if (streamed && scan->faces > 0) {
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
  scan->settle(config, progress);
  return scan;
}

void LookedScan::settle(const scene::ScanConfig& config, Progress& progress) {
  if (!config.pose.isIdentity(0.0)) take_pose_for_viewpoint(config);
  add_doubts(raw, looked.sample, looked.count,
             [&](const auto& use) { for_each_block([&](const PointBlock& block) { use(block.points); }, progress); });
  const std::string name = config.file.string();
  for (const std::string& warning : raw.warnings) progress.warn(name + ": " + warning);
  if (valid == 0) {
    throw EmptyScan(
        name, raw.records == 0 ? "the scan has no points" : fmt::format("none of the {} points is valid", raw.records),
        "at least one finite point");
  }
  placement = place(config, scale(config, progress));
}

void LookedScan::write(MessageWriter& message) const {
  message.put(raw.format);
  message.put(raw.fields);
  message.put(raw.warnings);
  message.put(raw.unit);
  message.put(raw.viewpoint);
  message.put(std::array{raw.several_units, raw.degrees, raw.guessed_degrees, raw.needs_whole});
  message.put(std::array<std::uint64_t, 4>{raw.records, raw.invalid, raw.unread, faces});
  message.put(std::uint64_t{raw.tallies.size()});
  for (const FieldTally& tally : raw.tallies) tally.write(message);
  message.put(std::array{colour, intensity, normals});
  message.put(std::uint64_t{has_field.size()});
  for (const bool has : has_field) message.put(has);
  looked.write(message);
  at_scanner.write(message);
  with_normal.write(message);
  normal_at_scanner.write(message);
  message.put(std::uint64_t{from.size()});
  for (const SeenStation& seen : from) {
    for (const double coordinate : seen.place) message.put(coordinate);
    seen.sample.write(message);
    seen.at_scanner.write(message);
    seen.steps.write(message);
  }
  about_origin.write(message);
}

/// `first`: what is the same of all parts of a file is taken from this one.
void LookedScan::add(MessageReader& message, bool first) {
  RawScan header;
  header.format = message.text();
  header.fields = message.texts();
  header.warnings = message.texts();
  header.unit = message.get<decltype(raw.unit)>();
  header.viewpoint = message.get<decltype(raw.viewpoint)>();
  const auto flags = message.get<std::array<bool, 4>>();
  header.several_units = flags[0];
  header.degrees = flags[1];
  header.guessed_degrees = flags[2];
  header.needs_whole = flags[3];
  if (first) {
    raw = std::move(header);
  } else {
    raw.needs_whole = raw.needs_whole || header.needs_whole;
  }
  const auto counts = message.get<std::array<std::uint64_t, 4>>();
  raw.records += counts[0];
  raw.invalid += counts[1];
  raw.unread += counts[2];
  faces += counts[3];
  const auto tallies = message.get<std::uint64_t>();
  for (std::uint64_t k = 0; k < tallies; ++k) {
    if (k == raw.tallies.size()) raw.tallies.emplace_back(std::string());
    raw.tallies[k].add(message);
  }
  const auto attributes = message.get<std::array<bool, 3>>();
  colour = colour || attributes[0];
  intensity = intensity || attributes[1];
  normals = normals || attributes[2];
  const auto known = static_cast<std::size_t>(message.get<std::uint64_t>());
  if (has_field.size() < known) has_field.resize(known);
  for (std::size_t k = 0; k < known; ++k) has_field[k] = message.get<bool>() || has_field[k];
  looked.add(message);
  at_scanner.add(message);
  with_normal.add(message);
  normal_at_scanner.add(message);
  const auto stations = message.get<std::uint64_t>();
  for (std::uint64_t k = 0; k < stations; ++k) {
    Eigen::Vector3d place;
    for (double& coordinate : place) coordinate = message.get<double>();
    if (k == from.size()) from.push_back({place, PointSample(), PointSample(), {}});
    from[k].sample.add(message);
    from[k].at_scanner.add(message);
    from[k].steps.add(message);
  }
  about_origin.add(message);
}

}  // namespace sparsha::pipeline

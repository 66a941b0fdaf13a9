#include "pipeline/scan/writer.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "pipeline/scan/triangulate.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// Faces after which it is asked again whether so many may be read.
constexpr std::size_t kFacesBetween = 1U << 15U;

/// Adds a block's values to those of the `points` before it; blocks without get `none`, unless none has any.
template <typename T>
void append(std::vector<T>& values, std::span<const T> block, std::size_t points, T none) {
  if (block.empty() && values.empty()) return;
  values.resize(points, none);
  values.insert(values.end(), block.begin(), block.end());
}

}  // namespace

std::string unused_face_colours(std::uint64_t faces) {
  return faces == 1 ? "the colour of 1 face is not used"
                    : "the colours of " + std::to_string(faces) + " faces are not used";
}

ScanWriter::ScanWriter(RawScan& scan, const PointSink& sink, const ReadOptions& options)
    : scan_(scan),
      sink_(sink),
      points_(kBlock),
      rgba_(kBlock, kWhite),
      intensity_(kBlock),
      normals_(kBlock),
      kept_names_(options.fields),
      tally_(options.tally),
      mesh_refusal_(options.mesh_refusal),
      region_(options.region),
      enough_(options.enough),
      whole_chunks_only_(options.whole_chunks_only),
      from_(options.from),
      to_(options.to) {
  scan_.values.resize(kept_names_.size());
  if (mesh_refusal_) face_room_ = kFacesBetween;
}

void ScanWriter::begin(std::uint64_t records, bool colour, bool intensity, bool normals) {
  colour_ = colour;
  has_intensity_ = intensity;
  has_normals_ = normals;
  if (sink_) return;
  const auto count = static_cast<std::size_t>(records);
  scan_.points.reserve(count);
  if (colour) scan_.rgba.reserve(count);
  if (intensity) scan_.intensity.reserve(count);
  if (normals) scan_.normals.reserve(count);
}

void ScanWriter::set_station(const std::optional<Eigen::Vector3d>& place) {
  flush();
  station_ = place && place->allFinite() ? place : std::nullopt;
  if (!sink_) scan_.stations.push_back({scan_.points.size(), station_});
}

void ScanWriter::set_attributes(bool colour, bool intensity, bool normals) {
  if (colour == colour_ && intensity == has_intensity_ && normals == has_normals_) return;
  flush();
  colour_ = colour;
  has_intensity_ = intensity;
  has_normals_ = normals;
}

int ScanWriter::want(std::string_view name, bool counted) {
  constexpr std::size_t kMost = 64;
  const std::string key = field_key(name);
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (fields_[k].key == key) return static_cast<int>(k);
  }
  WantedField field{key};
  const auto kept = std::find(kept_names_.begin(), kept_names_.end(), key);
  if (kept != kept_names_.end()) field.kept = static_cast<std::size_t>(kept - kept_names_.begin());
  const bool shown = tally_ == ReadOptions::Tally::all     ? !is_known_otherwise(key)
                     : tally_ == ReadOptions::Tally::worth ? tells_worth(key)
                                                           : false;
  if (counted && shown && scan_.tallies.size() < kMost) {
    field.tally = scan_.tallies.size();
    scan_.tallies.emplace_back(key);
  }
  if (!field.kept && !field.tally) return kUnwanted;
  fields_.push_back(std::move(field));
  return static_cast<int>(fields_.size()) - 1;
}

void ScanWriter::add_invalid() {
  if (may_have_faces_) dropped_.push_back(records());
  ++scan_.invalid;
}

void ScanWriter::add_polygon(std::span<const std::uint32_t> corners) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    add_triangle(corners[0], corners[1], corners[2]);
    return;
  }
  if (triangles() >= face_room_ && !make_room_for_faces()) {
    counted_ += corners.size() - 2;
    return;
  }
  polygon_triangles_ += corners.size() - 2;
  polygons_.push_back(static_cast<std::uint32_t>(corners.size()));
  polygons_.insert(polygons_.end(), corners.begin(), corners.end());
}

void ScanWriter::count_faces_from_zero() {
  for (std::array<std::uint32_t, 3>& face : scan_.faces) {
    for (std::uint32_t& corner : face) ++corner;
  }
  for (std::size_t at = 0; at < polygons_.size();) {
    const std::size_t end = at + 1 + polygons_[at];
    for (++at; at < end; ++at) ++polygons_[at];
  }
}

void ScanWriter::expect_mesh(std::uint64_t vertices, std::uint64_t triangles) const {
  if (!mesh_refusal_ || triangles == 0) return;
  if (const std::optional<Error> refusal = mesh_refusal_(vertices, triangles)) throw *refusal;
}

std::uint64_t ScanWriter::triangles() const { return scan_.faces.size() + polygon_triangles_ + counted_; }

bool ScanWriter::make_room_for_faces() {
  refused_ = refused_ || mesh_refusal_(records(), triangles()).has_value();
  if (!refused_) {
    face_room_ = static_cast<std::size_t>(triangles()) + kFacesBetween;
    return true;
  }
  counted_ = triangles();
  polygon_triangles_ = 0;
  face_room_ = 0;
  scan_.faces = {};
  polygons_ = {};
  return false;
}

void ScanWriter::add_beyond_room(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (make_room_for_faces()) {
    scan_.faces.push_back({a, b, c});
  } else {
    ++counted_;
  }
}

FieldTally& ScanWriter::tally_of(const std::string& key) {
  for (FieldTally& tally : scan_.tallies) {
    if (tally.name() == key) return tally;
  }
  return scan_.tallies.emplace_back(key);
}

void ScanWriter::flush() {
  if (filled_ == 0) return;
  for (const WantedField& field : fields_) {
    if (field.tally) scan_.tallies[*field.tally].add(std::span(field.values).first(filled_));
  }
  if (has_intensity_ && tally_ == ReadOptions::Tally::all) {
    tally_of(kIntensityField).add(std::span(intensity_).first(filled_));
  }
  hand_over();
  for (WantedField& field : fields_) std::fill_n(field.values.begin(), filled_, kNoValue);
  valid_ += filled_;
  filled_ = 0;
}

void ScanWriter::hand_over() {
  if (refused_) return;
  const std::span points(points_.data(), filled_);
  const std::span rgba(rgba_.data(), colour_ ? filled_ : 0);
  const std::span intensity(intensity_.data(), has_intensity_ ? filled_ : 0);
  const std::span normals(normals_.data(), has_normals_ ? filled_ : 0);
  std::vector<std::span<const float>> values(kept_names_.size());
  for (const WantedField& field : fields_) {
    if (field.kept) values[*field.kept] = std::span(field.values).first(filled_);
  }
  if (sink_) {
    sink_({points, rgba, intensity, station_, normals, values});
  } else {
    for (std::size_t k = 0; k < values.size(); ++k) {
      append<float>(scan_.values[k], values[k], scan_.points.size(), kNoValue);
    }
    append<std::uint32_t>(scan_.rgba, rgba, scan_.points.size(), kNoColour);
    append<float>(scan_.intensity, intensity, scan_.points.size(), kNoIntensity);
    append<Eigen::Vector3f>(scan_.normals, normals, scan_.points.size(), Eigen::Vector3f::Zero());
    scan_.points.insert(scan_.points.end(), points.begin(), points.end());
  }
}

void ScanWriter::finish() {
  flush();
  // The last blocks may have had none.
  if (!scan_.rgba.empty()) scan_.rgba.resize(scan_.points.size(), kNoColour);
  if (!scan_.intensity.empty()) scan_.intensity.resize(scan_.points.size(), kNoIntensity);
  if (!scan_.normals.empty()) scan_.normals.resize(scan_.points.size(), Eigen::Vector3f::Zero());
  for (std::vector<float>& values : scan_.values) {
    if (!values.empty()) values.resize(scan_.points.size(), kNoValue);
  }
  scan_.records = records();
  if (mesh_refusal_) {
    expect_mesh(scan_.records, triangles());
    if (refused_) throw *mesh_refusal_(scan_.records, triangles());
  }
  renumber_faces();
  triangulate_polygons();
}

/// Faces name records; what is kept are the valid ones.
void ScanWriter::renumber_faces() {
  if (scan_.faces.empty() && polygons_.empty()) return;
  std::vector<std::uint32_t> place;
  if (!dropped_.empty()) {
    place.resize(static_cast<std::size_t>(scan_.records));
    std::size_t gone = 0;
    for (std::size_t record = 0; record < place.size(); ++record) {
      const bool drop = gone < dropped_.size() && dropped_[gone] == record;
      place[record] = drop ? kGone : static_cast<std::uint32_t>(record - gone);
      if (drop) ++gone;
    }
  }
  std::uint64_t missing = 0;
  std::uint64_t holes = 0;
  const auto renumber = [&](std::span<std::uint32_t> corners) {
    bool exists = true;
    bool valid = true;
    for (std::uint32_t& corner : corners) {
      if (corner >= scan_.records) {
        exists = false;
        break;
      }
      if (!place.empty()) corner = place[corner];
      valid = valid && corner != kGone;
    }
    if (!exists) ++missing;
    if (exists && !valid) ++holes;
    return exists && valid;
  };
  std::erase_if(scan_.faces, [&](std::array<std::uint32_t, 3>& face) { return !renumber(face); });
  std::size_t write = 0;
  for (std::size_t read = 0; read < polygons_.size();) {
    const std::size_t corners = polygons_[read];
    if (renumber(std::span(polygons_).subspan(read + 1, corners))) {
      std::copy_n(polygons_.begin() + static_cast<std::ptrdiff_t>(read), corners + 1,
                  polygons_.begin() + static_cast<std::ptrdiff_t>(write));
      write += corners + 1;
    }
    read += corners + 1;
  }
  polygons_.resize(write);
  if (holes > 0) {
    scan_.warnings.push_back(std::to_string(holes) + (holes == 1 ? " face lies" : " faces lie") +
                             " on vertices that are not valid; left out, which leaves holes");
  }
  if (missing > 0) {
    scan_.warnings.push_back(std::to_string(missing) + (missing == 1 ? " face names" : " faces name") +
                             " vertices that the file does not have; left out");
  }
}

void ScanWriter::triangulate_polygons() {
  std::uint64_t doubtful = 0;
  for (std::size_t at = 0; at < polygons_.size(); at += polygons_[at] + std::size_t{1}) {
    const std::span<const std::uint32_t> corners = std::span(polygons_).subspan(at + 1, polygons_[at]);
    if (sink_) {
      // Only counted: who streams a mesh reads it again with its points.
      triangulate_as_fan(corners, scan_.faces);
    } else if (!triangulate(corners, scan_.points, scan_.faces)) {
      ++doubtful;
    }
  }
  polygons_.clear();
  if (doubtful > 0) {
    scan_.warnings.push_back(fmt::format(
        "{} or {} more than {} corners without being convex: triangles may cover notches and holes; export the mesh as "
        "triangles",
        doubtful == 1 ? "1 polygon crosses itself" : fmt::format("{} polygons cross themselves", doubtful),
        doubtful == 1 ? "has" : "have", kMostCornersCut));
  }
}

}  // namespace sparsha::pipeline

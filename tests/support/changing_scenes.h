// A stone that is scanned anew and whose parts are edited while it is touched, and such runs recorded and read.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "haptics/device/simulated/simulated_device.h"
#include "haptics/session/session.h"
#include "scene/folder/folder.h"
#include "tests/support/scenes.h"

namespace sparsha::test {

/// Hills with texture, friction, invented touch and cues, one part that is touched otherwise; a scan of known bytes.
inline scene::ScenePointer stone(int nodes = 401, const EditDescription& adjust = {},
                                 const Eigen::Vector3d& origin_m = {2.0, -3.0, 0.5}) {
  const auto height_m = [origin_m](double x, double y) {
    const double across_m = x - origin_m.x();
    const double along_m = y - origin_m.y();
    return origin_m.z() + hills_m(across_m, along_m) + 0.0003 * std::sin(900.0 * across_m) * std::sin(700.0 * along_m);
  };
  return scene_of(height_m, nodes, 0.1, 101, origin_m, [&](scene::SceneDescription& d) {
    d.config.scans.resize(1);
    d.config.scans[0].file = "scan.ply";
    d.sources = {{"scan.ply", std::string(64, 'a'), 77}};
    d.config.friction = scene::FrictionConfig{};
    d.config.friction->law = scene::FrictionConfig::Law::constant;
    d.config.haptics.impact = true;
    d.config.haptics.grain = true;
    d.config.haptics.tip_radius_m = 0.00037;
    d.config.cues = scene::CuesConfig{};
    scene::PartConfig part;
    part.name = "middle";
    part.say = "The middle of it";
    part.box_m = {2.03, -2.97, 2.07, -2.93};
    part.touch.material = scene::Material::wood;
    part.touch.mu_dynamic = 0.3;
    d.config.parts = {part};
    if (adjust) adjust(d);
  });
}

/// The same stone from another side: other nodes in another frame, its parts where they were on the object.
inline scene::ScenePointer scanned_anew(int nodes, double turned_rad) {
  const Eigen::Vector3d origin_m(5.1, -7.3, 2.2);
  return stone(
      nodes,
      [&](scene::SceneDescription& d) {
        Eigen::Isometry3d regions = Eigen::Isometry3d::Identity();
        regions.translate(Eigen::Vector3d(2.05, -2.95, 0.5));
        regions.rotate(Eigen::AngleAxisd(turned_rad, Eigen::Vector3d(0.1, -0.2, 1.0).normalized()));
        regions.translate(-(origin_m + Eigen::Vector3d(0.05, 0.05, 0.0)));
        d.scan_from_grid =
            Eigen::Affine3d(Eigen::Translation3d(0.3, 0.7, -1.1) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()))
                .matrix();
        d.config.orientation.regions_scan_to_grid = regions.matrix() * d.scan_from_grid.inverse();
        d.region_from_grid = *d.config.orientation.regions_scan_to_grid * d.scan_from_grid;
      },
      origin_m);
}

/// The same layers with one part more, the left half and a little of the first part, which is soft and smooth.
inline scene::ScenePointer with_a_soft_part(const scene::ScenePointer& scene) {
  scene::SceneDescription description = scene->description();
  scene::PartConfig part;
  part.name = "soft";
  part.say = "The soft side";
  part.box_m = {2.0, -3.0, 2.053, -2.9};
  part.touch.stiffness_n_per_m = 350.0;
  part.touch.mu_dynamic = 0.05;
  part.touch.material = scene::Material::marble;
  description.config.parts.insert(description.config.parts.begin(), part);
  return scene::with_description(scene, std::move(description));
}

/// Written and opened again.
inline scene::ScenePointer in_folder(const scene::ScenePointer& scene, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  scene::write_scene(*scene, folder);
  return scene::open_scene(folder);
}

/// What `explore` makes of a scene's configuration.
inline haptics::SessionOptions options_of(const scene::ScenePointer& scene, const std::filesystem::path& record) {
  haptics::SessionOptions options;
  options.haptics = scene->description().config.haptics;
  options.record = record;
  options.longest_gap_s = 1.0;  // pauses of the machine are other tests' matter
  return options;
}

/// A simulated hand on `first`, and every 0.8 s another scene under it, with a zoom in between. The run ends 0.8 s
/// after the last.
inline haptics::SessionSummary record_on(const scene::ScenePointer& first,
                                         const std::vector<scene::ScenePointer>& others,
                                         const std::filesystem::path& file, std::uint64_t seed = 4) {
  constexpr double kEach_s = 0.8;
  const double duration_s = 2.0 + kEach_s * static_cast<double>(others.size() + 1);
  haptics::Session session(first, haptics::make_simulated_device(seed, duration_s), options_of(first, file));
  session.start();
  std::size_t given = 0;
  std::size_t zoomed = 0;
  while (!session.finished()) {
    session.poll();
    const double time_s = session.state().read().time_s - 2.0;  // the first touch comes meanwhile
    if (given < others.size() && time_s > kEach_s * static_cast<double>(given + 1)) session.set_scene(others[given++]);
    if (zoomed <= others.size() && time_s > kEach_s * (static_cast<double>(zoomed) + 0.5)) {
      ++zoomed;
      session.requests().post({haptics::Request::Kind::zoom_in});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return session.stop();
}

/// A CSV file as text, read by nothing of the program's own.
class Table {
 public:
  explicit Table(const std::filesystem::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
      rows_.emplace_back();
      std::stringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) rows_.back().push_back(field);
    }
    if (rows_.empty()) return;
    names_ = rows_.front();
    rows_.erase(rows_.begin());
  }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const std::string& at(std::size_t row, const std::string& name) const {
    return rows_.at(row).at(place(name));
  }
  [[nodiscard]] double number(std::size_t row, const std::string& name) const { return std::stod(at(row, name)); }

  /// Fields of `other` that are other texts than here; times of computing aside. -1 when rows or columns are missing.
  [[nodiscard]] long differing(const Table& other) const {
    if (other.rows_.size() != rows_.size()) return -1;
    long count = 0;
    for (const std::string& name : other.names_) {
      if (name == "tick_ns" || name == "late_ns") continue;
      const std::size_t here = place(name);
      const std::size_t there = other.place(name);
      if (here == names_.size()) return -1;
      for (std::size_t row = 0; row < rows_.size(); ++row)
        if (rows_[row].at(here) != other.rows_[row].at(there)) ++count;
    }
    return count;
  }

 private:
  [[nodiscard]] std::size_t place(const std::string& name) const {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  }

  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace sparsha::test

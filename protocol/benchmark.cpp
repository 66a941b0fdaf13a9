#include "protocol/benchmark.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/csv.h"

namespace sparsha::protocol {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kTicks = 2000;       // of the way at constant depth
constexpr int kUp = 50;            // ticks
constexpr double kAbove_m = 0.01;  // at the end
constexpr double kMm = 1000.0;     // per metre, for .traj
constexpr std::string_view kCasesHeader =
    "case,surface,stiffness_n_per_m,speed_m_per_s,depth_m,ticks,path_sha256,truth_sha256\n";
constexpr const char* kMetrics =
    "metric,unit,meaning\n"
    "error,1,length of force minus true force over the true force; median 99 % and largest over judged ticks\n"
    "size,1,difference of the lengths over the true force; median and 99 %\n"
    "angle,deg,angle between force and true force; median and 99 %\n"
    "lost,share of judged ticks,error of 1 or more\n"
    "felt,share of judged ticks,error above 0.07\n"
    "jumps,share of judged ticks,change of the error vector from tick to tick above 0.07 of the true force\n"
    "ghost,share of ticks not judged,error above 0.01 (hand above the surface) or 0.07 (below it) of the case's "
    "largest "
    "true force\n";

OpenCase make_case(const std::string& name, const Ground& ground, double speed, double depth) {
  OpenCase c{name, ground, speed, depth, make_course(ground, kOpenTick_s * speed, depth, kTicks), 0};
  c.last = c.course.hands.size();
  const Vector3d foot = c.course.feet.back();
  const Vector3d normal = (foot - c.course.hands.back()).normalized();
  for (int tick = 1; tick <= kUp; ++tick) {
    const double share = static_cast<double>(tick) / kUp;
    c.course.feet.push_back(foot);
    c.course.hands.push_back(foot + (kAbove_m * share - depth * (1.0 - share)) * normal);
  }
  return c;
}

template <typename T>
void append_bytes(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

std::string ply_of(const Ground& ground) {
  constexpr int kCells = kOpenNodes - 1;
  std::string ply = "ply\nformat binary_little_endian 1.0\ncomment " + ground.name +
                    ", sparsha bench\nelement vertex " + std::to_string(kOpenNodes * kOpenNodes) +
                    "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                    std::to_string(2 * kCells * kCells) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int j = 0; j < kOpenNodes; ++j)
    for (int i = 0; i < kOpenNodes; ++i) {
      const double x = static_cast<double>(i) / kCells;
      const double y = static_cast<double>(j) / kCells;
      for (const double value : {x, y, ground.height(x, y)}) append_bytes(ply, value);
    }
  const auto add_triangle = [&ply](std::array<std::int32_t, 3> corners) {
    ply.push_back(3);
    for (const std::int32_t corner : corners) append_bytes(ply, corner);
  };
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const std::int32_t node = j * kOpenNodes + i;
      add_triangle({node, node + 1, node + kOpenNodes});
      add_triangle({node + 1, node + kOpenNodes + 1, node + kOpenNodes});
    }
  return ply;
}

std::array<double, 3> numbers_of(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string path_csv(const OpenCase& c) {
  std::string text = "t_s,x_m,y_m,z_m\n";
  for (std::size_t tick = 0; tick < c.course.hands.size(); ++tick) {
    csv::append(text, kOpenTick_s * static_cast<double>(tick));
    csv::append(text, numbers_of(c.course.hands[tick]));
    csv::end_row(text);
  }
  return text;
}

std::string truth_csv(const OpenCase& c) {
  std::string text = "t_s,proxy_x_m,proxy_y_m,proxy_z_m,force_x_n,force_y_n,force_z_n,contact,judged\n";
  for (std::size_t tick = 0; tick < c.course.hands.size(); ++tick) {
    csv::append(text, kOpenTick_s * static_cast<double>(tick));
    csv::append(text, numbers_of(c.contact(tick) ? c.course.feet[tick] : c.course.hands[tick]));
    csv::append(text, numbers_of(c.true_force(tick)));
    csv::append(text, std::uint64_t{c.contact(tick) ? 1U : 0U});
    csv::append(text, std::uint64_t{tick >= c.course.first && tick < c.last ? 1U : 0U});
    csv::end_row(text);
  }
  return text;
}

/// Columns between blanks: time, position in mm, force, normal force (1 or 0: contact or none).
std::string traj_of(const OpenCase& c, bool rendered) {
  std::string text;
  for (std::size_t tick = 0; tick < c.course.hands.size(); ++tick) {
    const bool contact = rendered && c.contact(tick);
    csv::append(text, kOpenTick_s * static_cast<double>(tick));
    csv::append(text, numbers_of(kMm * (contact ? c.course.feet[tick] : c.course.hands[tick])));
    csv::append(text, numbers_of(rendered ? c.true_force(tick) : Vector3d::Zero()));
    csv::append(text, std::uint64_t{contact ? 1U : 0U});
    csv::end_row(text);
  }
  std::replace(text.begin(), text.end(), ',', ' ');
  return text;
}

std::string hash_of(const std::string& text) { return sha256(std::as_bytes(std::span(text))); }

/// The first file in `folder` that no export wrote, or a folder that cannot be read; empty when there is none. An older
/// export may have had other cases: its names are those that its own cases.csv gives.
fs::path foreign_file(const fs::path& folder) {
  constexpr std::size_t kMostBytes = 1 << 20;
  const fs::path table = folder / "cases.csv";
  std::error_code code;
  const bool small = fs::is_regular_file(table, code) && fs::file_size(table, code) <= kMostBytes;
  std::string names = small ? read_file(table, kMostBytes) : std::string();
  const bool ours = names.starts_with(kCasesHeader);
  std::replace(names.begin(), names.end(), '\n', ',');
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    const bool parts = name == "surfaces" || name == "paths" || name == "truth";
    const bool file = name == "protocol.md" || name == "cases.csv" || name == "metrics.csv";
    if (!ours || !(parts ? entry.is_directory() : file && entry.is_regular_file())) return entry.path();
    if (!parts) continue;
    for (const fs::directory_entry& part : fs::directory_iterator(entry.path(), code)) {
      const std::string end = part.path().extension().string();
      const bool written = name == "surfaces" ? end == ".ply" : end == ".csv" || end == ".traj";
      if (!written || !part.is_regular_file() ||
          names.find(',' + part.path().stem().string() + ',') == std::string::npos)
        return part.path();
    }
    if (code) return entry.path();
  }
  return code ? folder : fs::path();
}

void require_replaceable(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) return;
  if (!fs::is_directory(folder, code)) throw usage_error(folder.string() + " is no folder", "a new or empty folder");
  const fs::path foreign = foreign_file(folder);
  if (!foreign.empty())
    throw usage_error(folder.string() + " holds other files: " + foreign.lexically_relative(folder).string(),
                      "a new or empty folder, or an older export");
}

/// take(case, share of all that were taken before).
template <typename Take>
void each_case(const Take& take) {
  const std::vector<Ground> grounds = all_grounds();
  for (std::size_t n = 0; n < grounds.size(); ++n) {
    const Ground& ground = grounds[n];
    const auto share = [&](double part) {
      return (static_cast<double>(n) + part) / static_cast<double>(grounds.size());
    };
    take(make_case(ground.name, ground, 0.25, 0.002), share(0.0));
    if (ground.name != "sinusoid") continue;
    take(make_case("sinusoid-fast", ground, 1.0, 0.002), share(1.0 / 3.0));
    take(make_case("sinusoid-deep", ground, 0.25, 0.02), share(2.0 / 3.0));
  }
}

}  // namespace

bool OpenCase::contact(std::size_t tick) const {
  const Vector3d& hand = course.hands[tick];
  return hand.z() < ground.height(hand.x(), hand.y());
}

Vector3d OpenCase::true_force(std::size_t tick) const {
  return contact(tick) ? Vector3d(kOpenStiffness_n_per_m * (course.feet[tick] - course.hands[tick])) : Vector3d::Zero();
}

std::vector<OpenCase> open_cases() {
  std::vector<OpenCase> cases;
  each_case([&](OpenCase c, double) { cases.push_back(std::move(c)); });
  return cases;
}

fs::path path_file(const std::string& case_name) { return fs::path("paths") / (case_name + ".csv"); }
fs::path truth_file(const std::string& case_name) { return fs::path("truth") / (case_name + ".csv"); }

void export_benchmark(const fs::path& folder, Progress* progress) {
  Progress unheard;
  Progress& told = progress != nullptr ? *progress : unheard;
  told.begin("export");
  require_replaceable(folder);
  AtomicPath target(folder, AtomicPath::Kind::folder);
  target.naming_target([&] {
    const fs::path& out = target.temporary();
    for (const char* part : {"surfaces", "paths", "truth"}) fs::create_directories(out / part);
    std::string table(kCasesHeader);
    for (const Ground& ground : all_grounds()) {
      told.throw_if_cancelled();
      write_file(out / "surfaces" / (ground.name + ".ply"), ply_of(ground));
    }
    each_case([&](const OpenCase& c, double share) {
      told.at(share);
      const std::string path = path_csv(c);
      const std::string truth = truth_csv(c);
      write_file(out / path_file(c.name), path);
      write_file(out / truth_file(c.name), truth);
      write_file(out / "paths" / (c.name + ".traj"), traj_of(c, false));
      write_file(out / "truth" / (c.name + ".traj"), traj_of(c, true));
      table += c.name + "," + c.ground.name + ",";
      for (const double value : {kOpenStiffness_n_per_m, c.speed_m_per_s, c.depth_m}) csv::append(table, value);
      csv::append(table, std::uint64_t{c.course.hands.size()});
      table += hash_of(path) + "," + hash_of(truth) + "\n";
    });
    write_file(out / "cases.csv", table);
    write_file(out / "metrics.csv", kMetrics);
    write_file(out / "protocol.md", protocol_text());
  });
  told.finish();
  told.throw_if_cancelled();
  target.commit();
}

}  // namespace sparsha::protocol

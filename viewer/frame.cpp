// Layout and the small geometry that several parts of the picture share.
#include "viewer/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <system_error>

#include <fmt/chrono.h>

#include <Eigen/Geometry>

#include "base/text/text.h"
#include "scene/frame/workspace.h"
#include "scene/scene.h"

namespace sparsha::viewer {

ViewSettings settings_of(const scene::ViewerConfig& config) {
  ViewSettings settings;
  settings.colour = config.colour;
  settings.stereo.mode = config.stereo;
  settings.overview_left = config.overview == scene::ViewerConfig::Side::left;
  return settings;
}

Window window_of(const haptics::State& state, const scene::SceneDescription& description) {
  Window window;
  const scene::Lattice& whole = description.levels.front();
  const Stage stage = stage_of(description);
  const Eigen::Vector3d centre(state.centre_m[0], state.centre_m[1], state.centre_m[2]);
  if (is_whole(description)) {
    const double width_m = state.workspace_m / state.scale;
    window.meant = state.tick != 0 && centre.allFinite() && std::isfinite(width_m) && width_m > 0.0;
    window.centre_m = window.meant ? centre : stage.anchor_m;
    window.width_m = window.meant ? width_m : stage.unit_m;
    return window;
  }
  if (state.tick == 0 || !centre.allFinite()) {
    window.centre_m = stage.anchor_m;
    window.width_m = (std::max(whole.nx, whole.ny) - 1) * whole.spacing_m;
    window.width_m = std::max(window.width_m, whole.spacing_m);
    return window;
  }
  const std::size_t level = std::min<std::size_t>(state.level, description.levels.size() - 1);
  window.centre_m = centre;
  const scene::Lattice& lattice = description.levels[level];
  window.width_m = scene::window_width_m(static_cast<int>(state.window[2]), static_cast<int>(state.window[3]), lattice);
  window.meant = true;
  return window;
}

Stage stage_of(const scene::SceneDescription& description, const haptics::State& state) {
  Stage stage = stage_of(description);
  const auto& [x, y, z, w] = state.turn;
  const Eigen::Quaterniond turn(w, x, y, z);
  if (is_whole(description) && std::abs(turn.norm() - 1.0) < 1e-3) stage.turn = turn.normalized().toRotationMatrix();
  return stage;
}

namespace {

/// FNV-1a over values in steps.
class Fingerprint {
 public:
  void add(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 1099511628211ULL;
    hash_ ^= hash_ >> 29U;
  }
  void add(double value, double step) {
    constexpr double kMost = 1e15;
    const double steps = value / step;
    add(std::isfinite(steps)
            ? static_cast<std::uint64_t>(static_cast<std::int64_t>(std::lround(std::clamp(steps, -kMost, kMost))))
            : 0x7FF0ULL);
  }
  void add(const std::string& words) {
    for (const char c : words) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
    add(std::uint64_t{0x100});
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 1469598103934665603ULL;
};

void add_state(const haptics::State& state, Fingerprint& look) {
  constexpr double kPixel = 1.0 / 8000.0;  // of the workspace
  constexpr std::uint64_t kSeen = haptics::kFlagSticking | haptics::kFlagUnknownArea | haptics::kFlagOutside |
                                  haptics::kFlagSaturated | haptics::kFlagStale | haptics::kFlagFault |
                                  haptics::kFlagFilledArea | haptics::kFlagTexture | haptics::kFlagFriction |
                                  haptics::kFlagImpact | haptics::kFlagGrain;
  look.add(std::uint64_t{state.tick != 0});
  look.add(state.flags & kSeen);
  look.add(state.contact);
  look.add(state.level);
  look.add(state.surface_id);
  const double grid = kPixel * state.workspace_m / state.scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    look.add(state.proxy_m[axis], grid);
    look.add(state.contact != 0 ? state.hip_m[axis] : 0.0, grid);
    look.add(state.centre_m[axis], grid);
    look.add(state.commanded_force_n[axis], 0.01);
    look.add(state.normal[axis], 0.01);
  }
  for (const double part : state.turn) look.add(part, 1e-4);
  look.add(state.contact != 0 ? state.penetration_m : 0.0, 1e-5);
  look.add(state.contact != 0 ? state.friction_coefficient : 0.0, 0.01);
  look.add(state.share_in_time, 0.001);
}

}  // namespace

std::uint64_t look_of(const Frame& frame) {
  Fingerprint look;
  add_state(frame.state, look);
  const Camera& camera = frame.camera;
  for (const double value : {camera.target.x(), camera.target.y(), camera.target.z(), camera.turn_rad, camera.tilt_rad,
                             camera.distance, camera.field_rad, camera.half_height})
    look.add(std::bit_cast<std::uint64_t>(value));
  const ViewSettings& s = frame.settings;
  look.add(static_cast<std::uint64_t>(s.colour));
  look.add(static_cast<std::uint64_t>(s.look));
  look.add(std::bit_cast<std::uint64_t>(s.contour_m));
  look.add(frame.marks.version);
  look.add(static_cast<std::uint64_t>(s.stereo.mode));
  for (const double value : {s.stereo.separation, s.stereo.convergence, s.light.azimuth_rad, s.light.elevation_rad})
    look.add(std::bit_cast<std::uint64_t>(value));
  for (const bool on : {s.stereo.swapped, s.mark_filled, s.outline, s.high_contrast, s.large_type, s.help, s.figures,
                        s.kiosk, s.parts, frame.asks_rescan, frame.looks})
    look.add(std::uint64_t{on});
  look.add(static_cast<std::uint64_t>(frame.focused + 1));
  look.add(static_cast<std::uint64_t>(frame.hovered + 1));
  look.add(static_cast<std::uint64_t>(frame.help_page));
  for (const Toast& toast : frame.toasts) {
    look.add(toast.announcement.text);
    look.add(std::min(1.0, toast.left * 6.0), 0.05);  // it fades at its end only
  }
  look.add(frame.title);
  look.add(frame.part);
  if (frame.strip.moves()) look.add(frame.strip.samples().back().time_s, 1e-3);
  look.add(std::uint64_t{frame.strip.paused()});
  if (s.figures) look.add(frame.time_s, 0.5);
  return look.value();
}

namespace {

/// In proportion to the window, but for letters of 11 pixels where there is room for those: smaller ones are hard to
/// read. An exhibit has words for one look from afar alone.
double scale_of(int width, int height, const ViewSettings& settings) {
  constexpr double kReadable = 0.85, kLeast = 0.6, kMost = 4.0;
  const double proportional = std::min(width / 1280.0, height / 720.0);
  const double room = kReadable * std::min(width / 800.0, height / 600.0);
  const double readable = settings.kiosk ? 0.0 : std::min(kReadable, room);
  return std::clamp(std::max(proportional, readable), kLeast, kMost) * (settings.large_type ? 1.3 : 1.0);
}

}  // namespace

Layout layout_of(int width, int height, const ViewSettings& settings) {
  Layout layout;
  width = std::max(width, 64);
  height = std::max(height, 64);
  layout.scale = scale_of(width, height, settings);
  const auto px = [&](double value) { return static_cast<int>(std::lround(value * layout.scale)); };
  if (settings.kiosk) {
    layout.detail = {0, 0, width, std::max(height - px(110), 32)};
    layout.bar = {0, layout.detail.height, width, height - layout.detail.height};
    const int side = std::min(px(240), width / 4);
    layout.overview = {width - side - px(24), px(24), side, side};
    return layout;
  }
  const int panel = std::min(px(372), width / 2);
  constexpr int kBar = 54;
  layout.detail = {0, 0, width - panel, std::max(height - px(kBar), 32)};
  layout.bar = {0, layout.detail.height, width - panel, height - layout.detail.height};
  layout.panel = {width - panel, 0, panel, height};
  if (settings.overview_left) {
    layout.panel.x = 0;
    layout.detail.x = layout.bar.x = panel;
  }
  const int margin = px(18), inside = panel - 2 * margin;
  // From below: a line, the strip where there is room for it, figures and words; the overview has the rest.
  constexpr int kHead = 62, kFigures = 252, kStrip = 96, kFooter = 40, kLeastForStrip = 660;
  const int left = layout.panel.x + margin;
  int bottom = height - px(kFooter);
  layout.footer = {left, bottom, inside, px(kFooter)};
  if (height >= px(kLeastForStrip)) {
    bottom -= px(kStrip);
    layout.strip = {left, bottom, inside, px(kStrip) - px(10)};
  }
  layout.overview = {left, px(kHead), inside, std::max(bottom - px(kHead + kFigures), px(40))};
  return layout;
}

double next_contour_m(double step_m, double range_m, bool finer) {
  constexpr double kFirst = 12.0, kFinest = 2000.0;  // lines over the whole range
  if (!(range_m > 0.0)) return 0.0;
  if (step_m <= 0.0) return finer ? round_number(range_m / kFirst) : 0.0;
  // The neighbours in the series 1, 2, 5 are between 2 and 2.5 times apart.
  if (finer) return std::max(round_number(0.6 * step_m), std::min(step_m, round_number(range_m / kFinest)));
  const double coarser = round_number(2.6 * step_m);
  return coarser > 0.5 * range_m ? 0.0 : coarser;
}

std::string dated_name(const std::string& stem, const std::string& extension) {
  const std::string dated = fmt::format("{}-{:%Y%m%d-%H%M%S}", stem, fmt::localtime(std::time(nullptr)));
  std::string name = dated + extension;
  std::error_code ignored;
  for (int k = 2; std::filesystem::exists(name, ignored); ++k) name = fmt::format("{}-{}{}", dated, k, extension);
  return name;
}

Camera overview_camera(const scene::SceneDescription& description, const Stage& stage, const Rect& rect) {
  const scene::Lattice& whole = description.levels.front();
  const double longer = std::max({whole.nx - 1, whole.ny - 1, 1});
  double half_x = 0.5 * (whole.nx - 1) / longer, half_y = 0.5 * (whole.ny - 1) / longer;
  if (is_whole(description)) {
    const ObjectBox bounds = bounds_of(*description.charts);
    const Eigen::Vector3d half = stage.turn.cwiseAbs() * (bounds.high_m - bounds.low_m) / (2.0 * stage.unit_m);
    half_x = half.x();
    half_y = half.y();
  }
  const double aspect = static_cast<double>(std::max(rect.width, 1)) / std::max(rect.height, 1);
  Camera camera;
  camera.field_rad = 0.0;
  camera.distance = 3.0;
  camera.half_height = 1.03 * std::max({half_y, half_x / aspect, 1e-3});
  return camera;
}

}  // namespace sparsha::viewer

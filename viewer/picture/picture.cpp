// The stone is drawn into cached pictures, at full quality once camera and data rest; each frame copies them and draws
// the hand.
#include "viewer/picture/picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <string>
#include <utility>

#include <epoxy/gl.h>

#include "base/error.h"
#include "scene/scene.h"
#include "viewer/camera/orbit.h"
#include "viewer/gl/shaders.h"
#include "viewer/object/paint.h"

namespace sparsha::viewer {
namespace {

constexpr int kWholeNodes = 2048;     // longer side of the piece that shows the whole scene
constexpr int kPieceNodes = 1536;     // and of the finer piece around the window
constexpr int kSoftwareNodes = 1024;  // of both without a graphics card, where light costs by the node
constexpr double kRest_s = 0.20;      // a camera that has not moved for so long rests

bool same(const View& a, const View& b) {
  return a.width == b.width && a.height == b.height && a.projection == b.projection;
}

bool same(const ReliefStyle& a, const ReliefStyle& b) {
  return a.high_contrast == b.high_contrast && a.mark_filled == b.mark_filled && a.outline == b.outline &&
         a.window_world == b.window_world && a.hole_world == b.hole_world && a.look == b.look &&
         a.contour_m == b.contour_m && a.section == b.section;
}

}  // namespace

struct Picture::Surface {
  View view;
  ReliefStyle style;
  std::uint64_t version = 0;
  double changed_s = 0.0;
  int supersampling = 0;  ///< of the picture that is there; 0: none
  bool fine = false;
  gl::Target large;     ///< as drawn, with depth
  gl::Target resolved;  ///< one pixel each; not used when large already is what is shown
  bool is_resolved = false;

  [[nodiscard]] const gl::Target& picture() const { return is_resolved ? resolved : large; }
};

struct Picture::DetailPiece {
  int level = 0;
  std::array<int, 4> nodes{};  ///< i0, j0, nx, ny
  bool envelope = false;
  std::future<ReliefData> data;
};

Picture::Picture()
    : software_(gl::is_software()),
      stone_program_(gl::kWholeVertex, std::string(gl::kVersion) + gl::kStoneLight + gl::kStoneFragment),
      backdrop_program_(gl::kWholeVertex, gl::kBackdropFragment),
      resolve_program_(gl::kWholeVertex, std::string(gl::kVersion) + gl::kResolveFragment),
      dome_program_(gl::kWholeVertex, std::string(gl::kVersion) + "#define EYE_DOME\n" + gl::kResolveFragment),
      anaglyph_program_(gl::kWholeVertex, gl::kAnaglyphFragment),
      vertex_array_(gl::make_vertex_array()),
      hand_painter_(std::make_unique<HandPainter>()) {
  for (auto& surface : surfaces_) surface = std::make_unique<Surface>();
}

Picture::~Picture() = default;

void Picture::set_scene(scene::ScenePointer scene) {
  const scene::SceneDescription& description = scene->description();
  const int level =
      level_within(description, std::min(software_ ? kSoftwareNodes : kWholeNodes, gl::max_texture_size()));
  ReliefData data = prepare_relief(scene->read_level(level), level, envelope_, description.noise_m, pool_);
  std::optional<ReliefData> coarse;
  if (const int next = level + 1; software_ && next < static_cast<int>(description.levels.size()))
    coarse = prepare_relief(scene->read_level(next), next, envelope_, description.noise_m, pool_);
  scene_ = std::move(scene);
  stage_ = stage_of(description);
  loading_.reset();
  piece_.reset();
  whole_ = std::make_unique<ReliefView>(std::move(data), stage_);
  coarse_ = coarse ? std::make_unique<ReliefView>(std::move(*coarse), stage_) : nullptr;
  for (ReliefView* view : {whole_.get(), coarse_.get()})
    if (view != nullptr) view->set_light(light_, pool_, true);
  set_object();
  paint_whole();
}

bool Picture::waits(double time_s) const {
  if (loading_ && loading_->data.valid() &&
      loading_->data.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    return true;
  if (!light_fine_ && time_s - light_changed_s_ >= kRest_s) return true;
  return std::ranges::any_of(surfaces_, [&](const auto& surface) {
    return surface->supersampling != 0 && !surface->fine && time_s - surface->changed_s >= kRest_s;
  });
}

bool Picture::any_filled() const { return whole_ && whole_->data().any_filled; }

void Picture::prepare_style(const Frame& frame) {
  const scene::SceneDescription& description = scene_->description();
  // The hand feels the envelope when texture is off: show what it feels.
  const bool envelope =
      frame.state.tick != 0 && (frame.state.flags & haptics::kFlagTexture) == 0 && description.has_envelope;
  if (envelope != envelope_) {
    envelope_ = envelope;
    set_scene(scene_);
  }
  const KeyLight& light = frame.settings.light;
  if (light.azimuth_rad != light_.azimuth_rad || light.elevation_rad != light_.elevation_rad) {
    light_ = light;
    light_changed_s_ = frame.time_s;
    set_light(frame.finished || !software_);
  } else if (!light_fine_ && (frame.finished || frame.time_s - light_changed_s_ >= kRest_s)) {
    set_light(true);
  }
  const ColourMode wanted = has_mode(description, frame.settings.colour) ? frame.settings.colour : ColourMode::relief;
  const double workspace_m = frame.state.tick != 0 ? frame.state.workspace_m : workspace_m_;
  const bool other_hand = workspace_m != workspace_m_ && wanted == ColourMode::friction;
  workspace_m_ = workspace_m;
  if (wanted != colour_ || other_hand) {
    colour_ = wanted;
    paint_whole();
    if (piece_) piece_->set_paint(paint_relief(piece_->data(), description, colour_, workspace_m_, &legend_));
  }
}

void Picture::follow_window(const Frame& frame, const Window& window) {
  const scene::SceneDescription& description = scene_->description();
  if (loading_ && loading_->data.valid()) {
    const bool ready = frame.finished || loading_->data.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    try {
      if (ready) {
        piece_ = std::make_unique<ReliefView>(loading_->data.get(), stage_);
        piece_->set_light(light_, pool_, true);
        piece_->set_paint(paint_relief(piece_->data(), description, colour_, workspace_m_, &legend_));
        stones_lit_ = false;
      }
    } catch (const Error&) {
      piece_.reset();  // tiles that cannot be read: the coarse stone stays, and the servo says why
    }
  }
  const int whole_level = whole_->data().level;
  if (whole_level == 0 || object_) return;
  // The finest level of which twice the window's width fits a piece.
  int level = 0;
  const double width_m = 2.0 * window.width_m;
  while (level < whole_level && width_m / description.levels[static_cast<std::size_t>(level)].spacing_m >
                                    (software_ ? kSoftwareNodes : kPieceNodes))
    ++level;
  if (level == whole_level) {
    if (piece_) stones_lit_ = false;
    piece_.reset();
    loading_.reset();
    return;
  }
  const scene::Lattice& lattice = description.levels[static_cast<std::size_t>(level)];
  const auto first = [&](double centre_m, double origin_m) {
    // Snapped to 64 nodes, so that a hand that drifts does not load for ever.
    return 64 * static_cast<int>(std::floor((centre_m - 0.5 * width_m - origin_m) / lattice.spacing_m / 64.0));
  };
  const int count = static_cast<int>(std::ceil(width_m / lattice.spacing_m)) + 64;
  const int i0 = std::clamp(first(window.centre_m.x(), lattice.origin_m.x()), 0, lattice.nx - 1);
  const int j0 = std::clamp(first(window.centre_m.y(), lattice.origin_m.y()), 0, lattice.ny - 1);
  const std::array<int, 4> nodes{i0, j0, std::min(count, lattice.nx - i0), std::min(count, lattice.ny - j0)};
  if (nodes[2] < 2 || nodes[3] < 2) return;
  if (loading_ && loading_->level == level && loading_->nodes == nodes && loading_->envelope == envelope_) return;
  if (loading_ && loading_->data.valid()) return;  // the next one when this one has come
  loading_ = std::make_unique<DetailPiece>();
  loading_->level = level;
  loading_->nodes = nodes;
  loading_->envelope = envelope_;
  loading_->data = std::async(std::launch::async, [scene = scene_, level, nodes, envelope = envelope_,
                                                   noise_m = description.noise_m] {
    ThreadPool own(1);
    return prepare_relief(scene->read(level, nodes[0], nodes[1], nodes[2], nodes[3]), level, envelope, noise_m, own);
  });
  if (frame.finished) follow_window(frame, window);
}

void Picture::draw_surface(Surface& surface, const View& view, ReliefStyle style, int supersampling, bool overview,
                           const Frame& frame) {
  const int width = view.width * supersampling, height = view.height * supersampling;
  if (surface.large.width() != width || surface.large.height() != height)
    surface.large = gl::Target(width, height, true, gl::Filter::nearest);
  glBindFramebuffer(GL_FRAMEBUFFER, surface.large.framebuffer());
  glViewport(0, 0, width, height);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  style.supersampling = supersampling;
  if (piece_ && !overview) {
    ReliefStyle fine = style;
    fine.walls = false;
    piece_->draw(relief_programs_, view, fine);
    style.hole_world = piece_->box_world();
  }
  // While it moves, of a scene that is finer than the picture: rims and steps are drawn node by node.
  constexpr double kFiner = 0.75;  // pixels per node
  const double node_pixels = view.pixels_per_unit(view.focus) * whole_->data().lattice.spacing_m / stage_.unit_m;
  if (object_)
    object_->draw(view, stage_, style, light_);
  else
    (coarse_ && style.moving && node_pixels < kFiner ? coarse_ : whole_)->draw(relief_programs_, view, style);
  if (style.section && !object_) draw_section(view, style, supersampling);
  // The backdrop fills what stone left free.
  backdrop_program_.use();
  const bool dark = frame.settings.high_contrast;
  const Eigen::Vector3f upper = dark ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(0.150F, 0.145F, 0.142F);
  const Eigen::Vector3f lower = dark ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(0.075F, 0.071F, 0.068F);
  backdrop_program_.set("upper", overview ? Eigen::Vector3f(0.6F * lower) : upper);
  backdrop_program_.set("lower", overview ? Eigen::Vector3f(0.6F * lower) : lower);
  glBindVertexArray(vertex_array_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_DEPTH_TEST);
  ++redraws_;
  surface.supersampling = supersampling;
  surface.is_resolved = supersampling != 1 || style.look == Look::eye_dome;
  if (surface.is_resolved) resolve(surface, view, style, supersampling, supersampling != 1);
}

// To one pixel each, with the eye-dome shade where it is asked for.
void Picture::resolve(Surface& surface, const View& view, const ReliefStyle& style, int supersampling, bool rests) {
  if (surface.resolved.width() != view.width || surface.resolved.height() != view.height)
    surface.resolved = gl::Target(view.width, view.height, false, gl::Filter::nearest);
  glBindFramebuffer(GL_FRAMEBUFFER, surface.resolved.framebuffer());
  glViewport(0, 0, view.width, view.height);
  const bool dome = style.look == Look::eye_dome;
  const gl::Program& program = dome ? dome_program_ : resolve_program_;
  program.use();
  program.set("source", 0);
  if (dome) {
    program.set("depths", 1);
    program.set("scale", supersampling);
    program.set("rings", rests ? 3 : 1);
    program.set("depth", Eigen::Vector2f(view.depth.cast<float>()));
    program.set("parallel", view.parallel ? 1 : 0);
    const double deep = object_ ? 0.5 : std::max(whole_->high_world() - whole_->low_world(), 0.01);
    program.set("relief", static_cast<float>(deep));
  }
  surface.large.colour().bind(0);
  surface.large.depth().bind(1);
  glBindVertexArray(vertex_array_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Picture::draw_section(const View& view, const ReliefStyle& style, int supersampling) {
  const auto height = [&](double x, double y) {
    const Eigen::Vector3d place_m = stage_.to_grid_m({x, y, 0.0});
    if (!known_at(place_m.x(), place_m.y())) return std::numeric_limits<double>::quiet_NaN();
    return (height_at(place_m.x(), place_m.y()) - stage_.anchor_m.z()) / stage_.unit_m;
  };
  section_wall_.draw(*style.section, whole_->box_world(), style.floor_z, height, view, style.high_contrast,
                     supersampling);
}

void Picture::refresh(Surface& surface, const View& view, const ReliefStyle& style, bool overview, const Frame& frame) {
  const bool changed = surface.supersampling == 0 || surface.version != version_ || !same(surface.view, view) ||
                       !same(surface.style, style);
  if (changed) surface.changed_s = frame.time_s;
  const bool there = surface.supersampling != 0 && same(surface.view, view);
  const bool rests =
      frame.finished || !software_ || (overview && !there) || frame.time_s - surface.changed_s >= kRest_s;
  if (!changed && (surface.fine || !rests)) return;
  if (overview && !rests) {  // the old one does until all rests
    surface.fine = false;
    surface.version = version_;
    surface.style = style;
    return;
  }
  surface.view = view;
  surface.style = style;
  surface.version = version_;
  surface.fine = rests;
  ReliefStyle used = style;
  used.node_pixels = !software_ ? 1.0 : rests ? 2.5 : 7.0;
  used.moving = software_ && !rests;
  draw_surface(surface, view, used, rests ? 2 : 1, overview, frame);
}

void Picture::draw(const Frame& frame, unsigned framebuffer, int width, int height) {
  if (!scene_) return;
  stage_ = stage_of(scene_->description(), frame.state);
  prepare_style(frame);
  const Window window = window_of(frame.state, scene_->description());
  follow_window(frame, window);
  follow_touch(frame.state, frame.finished);
  light_stones(frame.settings.high_contrast, frame.settings.look);
  hand_ = hand_of(frame.state, window);
  const Layout layout = layout_of(width, height, frame.settings);

  ReliefStyle style;
  style.high_contrast = frame.settings.high_contrast;
  style.mark_filled = frame.settings.mark_filled;
  style.outline = frame.settings.outline;
  const double thick = std::max(0.035, 0.12 * (whole_->high_world() - whole_->low_world()));
  style.floor_z = whole_->low_world() - thick;
  style.look = frame.settings.look;
  style.contour_m = frame.settings.contour_m;
  style.datum_z = (scene_->description().height_min_m - stage_.anchor_m.z()) / stage_.unit_m;
  ReliefStyle framed = style;
  if (const auto& section = frame.marks.notes.section; section && !frame.settings.kiosk)
    framed.section = CutPlane{section->out, section->out.dot(stage_.to_world(section->at_m))};
  if (window.meant && !object_) {
    const Eigen::Vector3d centre = stage_.to_world(window.centre_m);
    const double half = 0.5 * window.width_m / stage_.unit_m;
    framed.window_world = Box(centre.x() - half, centre.y() - half, centre.x() + half, centre.y() + half);
  }

  draw_detail(frame, layout, framed, framebuffer, height);
  // The ground of panel and bar: clearing is far cheaper than blended rectangles.
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glEnable(GL_SCISSOR_TEST);
  const float ground = frame.settings.high_contrast ? 0.0F : 1.0F;
  glClearColor(0.094F * ground, 0.086F * ground, 0.078F * ground, 1.0F);
  for (const Rect& rect : {layout.panel, layout.bar}) {
    glScissor(rect.x, height - rect.y - rect.height, rect.width, rect.height);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  glDisable(GL_SCISSOR_TEST);
  if (layout.overview.width > 0 && layout.overview.height > 0) draw_overview(frame, layout, style, framebuffer, height);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width, height);
}

void Picture::draw_side(double turn_rad, double tilt_rad, unsigned framebuffer, int side) {
  if (!scene_) return;
  Frame frame;
  stage_ = stage_of(scene_->description());
  prepare_style(frame);
  light_stones(false, Look::stone);
  const Window whole = window_of({}, scene_->description());
  const Rect rect{0, 0, side, side};
  const Camera camera = object_ ? camera_around(whole, stage_, turn_rad, tilt_rad, 1.0, Eigen::Vector3d::Zero(), rect)
                                : camera_for(whole, {whole.centre_m.z(), whole.centre_m.z()}, stage_, turn_rad,
                                             tilt_rad, 1.0, Eigen::Vector2d::Zero(), rect);
  ReliefStyle style;
  style.floor_z = whole_->low_world() - 0.035;
  Surface surface;
  refresh(surface, make_view(camera, side, side), style, false, frame);
  surface.picture().copy_to(framebuffer, 0, 0);
}

// One picture, or two that go into one: the eyes are drawn into pictures of their own first.
void Picture::draw_detail(const Frame& frame, const Layout& layout, const ReliefStyle& style, unsigned framebuffer,
                          int height) {
  const Stereo& stereo = frame.settings.stereo;
  const Rect& detail = layout.detail;
  const bool beside = stereo.mode == StereoMode::side_by_side;
  const bool merged = stereo.on() && !beside;
  const int eye_width = beside ? std::max(detail.width / 2, 1) : detail.width;
  const int bottom = height - detail.y - detail.height;
  detail_view_ = make_view(frame.camera, eye_width, detail.height);
  // A whole object's light turns with the camera.
  const Eigen::Vector3d from = object_ ? Eigen::Vector3d(frame.camera.axes() * light_.direction()) : light_.direction();
  const Eigen::Vector3f light = from.cast<float>();
  for (int eye = 0; eye < (stereo.on() ? 2 : 1); ++eye) {
    const double side = !stereo.on() ? 0.0 : (eye == 0) != stereo.swapped ? -0.5 : 0.5;
    const View view = make_view(frame.camera, eye_width, detail.height,
                                side * stereo.separation * frame.camera.distance, stereo.convergence);
    Surface& surface = *surfaces_[static_cast<std::size_t>(eye)];
    gl::Target& own = eyes_[static_cast<std::size_t>(eye)];
    refresh(surface, view, style, false, frame);
    if (merged && (own.width() != view.width || own.height() != view.height))
      own = gl::Target(view.width, view.height, false, gl::Filter::nearest);
    const int at_left = merged ? 0 : detail.x + eye * eye_width, at_bottom = merged ? 0 : bottom;
    surface.picture().copy_to(merged ? own.framebuffer() : framebuffer, at_left, at_bottom);
    glViewport(at_left, at_bottom, view.width, view.height);
    if (hand_)
      hand_painter_->draw(*hand_, view, surface.large.depth(), surface.supersampling, at_left, at_bottom, light,
                          layout.scale);
  }
  if (!merged) return;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  merge_eyes(frame, detail, bottom);
}

void Picture::merge_eyes(const Frame& frame, const Rect& detail, int bottom) {
  glViewport(detail.x, bottom, detail.width, detail.height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  anaglyph_program_.use();
  eyes_[0].colour().bind(0);
  eyes_[1].colour().bind(1);
  anaglyph_program_.set("left", 0);
  anaglyph_program_.set("right", 1);
  anaglyph_program_.set("grey", frame.settings.stereo.mode == StereoMode::grey ? 1 : 0);
  anaglyph_program_.set("origin", Eigen::Vector2f(static_cast<float>(detail.x), static_cast<float>(bottom)));
  glBindVertexArray(vertex_array_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Picture::draw_overview(const Frame& frame, const Layout& layout, ReliefStyle style, unsigned framebuffer,
                            int height) {
  const Rect& rect = layout.overview;
  const View view = make_view(overview_camera(scene_->description(), stage_, rect), rect.width, rect.height);
  style.walls = false;
  style.contour_m = 0.0;  // too many for so small a picture
  refresh(*surfaces_[2], view, style, true, frame);
  surfaces_[2]->picture().copy_to(framebuffer, rect.x, height - rect.y - rect.height);
}

}  // namespace sparsha::viewer

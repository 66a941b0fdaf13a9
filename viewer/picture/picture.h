// Draws stone, hand and overview of one frame; the interface's text and buttons are gui/'s.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "scene/frame/workspace.h"
#include "viewer/frame.h"
#include "viewer/gl/objects.h"
#include "viewer/object/view.h"
#include "viewer/overlay/overlay.h"
#include "viewer/surface/relief_view.h"
#include "viewer/surface/section_wall.h"
#include "viewer/surface/touch_ground.h"

namespace sparsha::viewer {

/// Needs a current context for its whole life. One thread.
class Picture {
 public:
  Picture();
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  /// Reads and prepares the scene. Throws Error{input} when its layers cannot be read.
  void set_scene(scene::ScenePointer scene);
  [[nodiscard]] const scene::ScenePointer& scene() const { return scene_; }

  /// Draws detail view and overview into `framebuffer`, `width` x `height` pixels. Surfaces are drawn again only when
  /// camera or data changed since the last call.
  void draw(const Frame& frame, unsigned framebuffer, int width, int height);

  /// Draws the scene alone, whole and at full quality, into a square framebuffer, as a visitor sees it who has walked
  /// round it by `turn_rad` to the right and then looks from `tilt_rad` below.
  void draw_side(double turn_rad, double tilt_rad, unsigned framebuffer, int side);

  /// Reads what the hand touches now, also when nothing is drawn.
  void follow_touch(const haptics::State& state, bool finished) { touch_ground_.follow(scene_, state, finished); }
  /// Height of the surface that the hand touches, grid frame: the servo's where it is known, else the drawn one.
  [[nodiscard]] double touch_height_at(double x_m, double y_m) const;
  /// Height of the drawn surface, grid frame.
  [[nodiscard]] double height_at(double x_m, double y_m) const;
  /// False where neither measured nor filled, and outside.
  [[nodiscard]] bool known_at(double x_m, double y_m) const;
  [[nodiscard]] const Legend& legend() const { return legend_; }
  [[nodiscard]] bool any_filled() const;
  /// The detail view of the last draw() in its rectangle (middle of both eyes).
  [[nodiscard]] const View& detail_view() const { return detail_view_; }
  [[nodiscard]] const Stage& stage() const { return stage_; }
  /// How often surfaces have been drawn; for tests of the cache.
  [[nodiscard]] int surface_redraws() const { return redraws_; }
  /// True when draw() of the same frame at `time_s` would give another picture: a finer one, or of data that has come.
  [[nodiscard]] bool waits(double time_s) const;
  /// The whole object that is drawn, or null.
  [[nodiscard]] const ObjectView* object() const { return object_.get(); }
  /// The hand of the last draw(), or nothing.
  [[nodiscard]] const std::optional<Hand>& hand() const { return hand_; }

 private:
  struct Surface;      // a cached picture of the stone from one eye
  struct DetailPiece;  // a finer piece around the window, read by a worker

  void prepare_style(const Frame& frame);
  void follow_window(const Frame& frame, const Window& window);
  void refresh(Surface& surface, const View& view, const ReliefStyle& style, bool overview, const Frame& frame);
  void draw_surface(Surface& surface, const View& view, ReliefStyle style, int supersampling, bool overview,
                    const Frame& frame);
  void set_light(bool fine);
  void paint_whole();
  void light_stones(bool high_contrast, Look look);
  void resolve(Surface& surface, const View& view, const ReliefStyle& style, int supersampling, bool rests);
  void draw_section(const View& view, const ReliefStyle& style, int supersampling);
  void draw_detail(const Frame& frame, const Layout& layout, const ReliefStyle& style, unsigned framebuffer,
                   int height);
  void merge_eyes(const Frame& frame, const Rect& detail, int bottom);
  void draw_overview(const Frame& frame, const Layout& layout, ReliefStyle style, unsigned framebuffer, int height);
  void set_object();
  [[nodiscard]] std::optional<Hand> hand_of(const haptics::State& state, const Window& window) const;

  scene::ScenePointer scene_;
  Stage stage_;
  ThreadPool pool_;
  bool software_ = false;
  int redraws_ = 0;
  std::uint64_t version_ = 0;  ///< counts changes of data, light and paint

  gl::Program stone_program_, backdrop_program_, resolve_program_, dome_program_, anaglyph_program_;
  ReliefPrograms relief_programs_;
  gl::Name vertex_array_;
  std::unique_ptr<HandPainter> hand_painter_;
  std::unique_ptr<ObjectView> object_;           ///< what is drawn in place of the relief, or none
  std::shared_ptr<const scene::Charts> charts_;  ///< of the object
  std::unique_ptr<ReliefView> whole_;
  std::unique_ptr<ReliefView> coarse_;  ///< the same at half its nodes, for pictures that move; or none
  std::unique_ptr<ReliefView> piece_;
  std::unique_ptr<DetailPiece> loading_;
  TouchGround touch_ground_;
  KeyLight light_;
  bool light_fine_ = true;
  double light_changed_s_ = 0.0;
  ColourMode colour_ = ColourMode::relief;
  double workspace_m_ = scene::kDeskWorkspace_m;  ///< of the hand
  bool envelope_ = false;
  bool high_contrast_ = false;
  Look look_ = Look::stone;
  SectionWall section_wall_;
  bool stones_lit_ = false;
  Legend legend_;
  std::array<std::unique_ptr<Surface>, 3> surfaces_;  ///< one or left eye, right eye, overview
  std::array<gl::Target, 2> eyes_;
  View detail_view_;
  std::optional<Hand> hand_;
};

}  // namespace sparsha::viewer

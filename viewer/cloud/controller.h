// Keys and mouse while the object is turned for the depth scan: to orientation, crop, picture and requests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viewer/actions/actions.h"
#include "viewer/camera/camera.h"
#include "viewer/cloud/orientation.h"
#include "viewer/cloud/point_view.h"
#include "viewer/cloud/preview.h"
#include "viewer/cloud/splat.h"

namespace sparsha::viewer {

enum class CloudColour { scan, intensity, height, stations };
[[nodiscard]] const char* name_of(CloudColour colour);
[[nodiscard]] bool has_colour(const PointView& points, CloudColour colour);

/// Everything a visitor can do here. Keys, buttons and the help page come from one table.
enum class CloudAction {
  scan,
  save,
  save_scene,
  back,
  front,
  rear,
  left,
  right,
  top,
  bottom,
  flat_face,
  broad_side,
  as_scanned,
  upright,
  up_axis,
  undo,
  turn_left,
  turn_right,
  tilt_up,
  tilt_down,
  roll_left,
  roll_right,
  fine_left,
  fine_right,
  fine_up,
  fine_down,
  closer,
  farther,
  fit,
  free_ball,
  colour,
  crop,
  help,
  contrast,
  large_type,
  quit
};

struct CloudActionInfo {
  CloudAction action;
  const char* keys;
  const char* label;
  const char* what;
};
[[nodiscard]] std::span<const CloudActionInfo> all_cloud_actions();
[[nodiscard]] const CloudActionInfo& info_of(CloudAction action);
[[nodiscard]] std::optional<CloudAction> cloud_action_of(const KeyPress& press);

/// True when the key has an action with some modifiers.
[[nodiscard]] bool is_cloud_key(int key);

/// Everything one picture of the raw cloud shows, as plain values.
struct CloudFrame {
  OrientingStatus status;
  ScanSetup setup;
  SplatView view;  ///< of the rectangle that the cloud is drawn in
  DepthPreview preview;
  std::uint64_t previews = 0;  ///< counts changes of `preview`
  CloudColour colour = CloudColour::scan;
  bool free_ball = false;
  bool edits_crop = false;
  bool help = false;
  bool can_go_back = false;  ///< there is a scene to go back to
  int held = -1;             ///< the handle of the crop box that the mouse holds: 2 * axis + (0 low, 1 high)
  std::optional<UpAxis> up;  ///< that was chosen; else by the custom of the scans' format
  std::string unit;          ///< of the scans, for its field
  double time_s = 0.0;
  bool finished = true;  ///< draw every point, whatever it costs
};

/// Knows neither windows nor graphics.
class CloudController {
 public:
  explicit CloudController(Orienting orienting);

  void press(const KeyPress& press);
  void act(CloudAction action);
  /// Pixels of the picture's rectangle.
  void mouse_move(double x, double y);
  void mouse_button(int button, bool down, int modifiers);  ///< 0 left, 1 right, 2 middle
  void mouse_wheel(double steps);

  // What fields and lists of the panel set.
  void set_euler(const Eigen::Vector3d& angles_deg);
  void set_crop(const std::optional<scene::CropConfig>& crop);
  void set_unit(scene::LengthUnit unit);
  /// The object stands on the other end from now on, its front to the viewer.
  void set_up(UpAxis up);
  /// One of status.sides to the viewer.
  void choose_side(std::size_t side);
  void cancel();

  /// One step of time; `width` and `height` of the rectangle that the cloud is drawn in.
  void update(double time_s, int width, int height, bool can_go_back);
  [[nodiscard]] const CloudFrame& frame() const { return frame_; }
  [[nodiscard]] CloudFrame& frame() { return frame_; }

  /// What only the window can do, in order, each once; none when that is all.
  enum class Wish { none, back, quit, contrast, large_type };
  [[nodiscard]] Wish take_wish();
  /// New words for the visitor, once each.
  [[nodiscard]] std::vector<std::string> take_words();

  /// True while the next update() would change nothing.
  [[nodiscard]] bool rests() const;

  /// Middle of a crop handle in pixels of the rectangle; nothing when its axis points at the viewer.
  [[nodiscard]] std::optional<Eigen::Vector2d> crop_handle(int handle) const;

 private:
  [[nodiscard]] UpAxis up() const;
  void take_status();
  void take_proposal();
  void tell_look();
  void turn(const Eigen::Matrix4d& scan_to_grid, bool keep_fit);
  void turn_by(double about_x, double about_y, double about_z);
  void drag_crop(const Eigen::Vector2d& moved);
  void fit();
  void start_scan();
  void save(bool as_scene);
  bool set_side(CloudAction action);
  bool turn_step(CloudAction action);

  Orienting orienting_;
  CloudFrame frame_;
  std::vector<Eigen::Matrix4d> before_;  ///< orientations to go back to
  Eigen::Vector2d mouse_ = Eigen::Vector2d::Zero();
  bool left_down_ = false, right_down_ = false, middle_down_ = false;
  bool fits_ = true, preview_due_ = true, touched_ = false;
  double preview_s_ = -1e9, turned_s_ = -1e9;
  double ended_s_ = -1e9;  ///< work on the scans
  bool preview_full_ = false;
  std::uint64_t work_ = 0, proposals_ = 0, notes_ = 0;
  const PointView* shown_ = nullptr;
  const PointView* looked_at_ = nullptr;  ///< when Orienting::look was told last, and with what
  SplatView looked_;
  std::optional<scene::CropConfig> looked_crop_;
  double metres_per_unit_ = 0.0;
  std::vector<Wish> wishes_;
  std::vector<std::string> words_;
};

}  // namespace sparsha::viewer

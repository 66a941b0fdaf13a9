// Keys and clicks to marks: measures, pins, the section plane, the boxes of parts; keeps them with the scene.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/state/requests.h"
#include "scene/config/parts.h"
#include "scene/solid/sight.h"
#include "viewer/actions/actions.h"
#include "viewer/camera/camera.h"
#include "viewer/hand.h"
#include "viewer/marks/marks.h"

namespace sparsha::viewer {

/// One thread, the window's.
class Marking {
 public:
  using Tell = std::function<void(const std::string& words, haptics::Announcement::Priority priority)>;
  /// Parts that were edited, for the scene; false: they stay as they were. Empty: parts are drawn and not edited.
  using SaveParts = std::function<bool(const std::vector<scene::PartConfig>& parts)>;

  Marking(Tell tell, SaveParts save_parts) : tell_(std::move(tell)), save_parts_(std::move(save_parts)) {}

  /// Reads the scene's notes. A scene without a folder, such as a new depth scan, keeps those of the same scans that
  /// are there already; they are written to the folder that they came from.
  void set_scene(scene::ScenePointer scene);

  /// What the mouse points at, for the actions and clicks that follow. `height_at`: of the drawn surface.
  struct Aim {
    std::optional<Eigen::Vector3d> at_m;              ///< on the stone, grid frame
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< within the view
    std::optional<View> view;
    Stage stage;
    HeightAt height_at;
  };
  /// What is met first of a whole object; null of one view. Made when it is asked for first.
  [[nodiscard]] const scene::Sight* sight();
  /// True when the action is one of the marks'. `window`: that the hand reaches.
  bool act(Action action, const Aim& aim, const std::optional<Eigen::Vector3d>& touched_m,
           const Eigen::Vector3d& centre_m, double width_m, bool shows_parts);
  /// True when a left click is the marks' own: a point of a measure, a corner of a part.
  bool grip(const Aim& aim, bool shows_parts);
  /// The mouse moved while it holds a corner; true then.
  bool drag(const Aim& aim);
  void release();

  /// While words are written, keys are theirs: true.
  bool press(const KeyPress& press);
  void type(char32_t character);
  /// Closes what is open; false when nothing was.
  bool escape();
  void set_parallel(bool on);

  [[nodiscard]] const Marks& marks() const { return marks_; }

 private:
  /// What the words that are being written belong to.
  enum class Writing { pin, part };
  struct Held {
    static constexpr int kFixed = 5;
    std::size_t part = 0;
    int corner = 0;  ///< as in corners_of(); 4: the middle, which moves the box; kFixed: of a part that is no box
    Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
    std::array<double, 4> box_m{};
  };

  void changed() { ++marks_.version; }
  void next_tool();
  void face_pins();
  void add_point(const Eigen::Vector3d& at_m);
  void add_pin(const Eigen::Vector3d& at_m);
  void add_part(const Eigen::Vector3d& centre_m, double width_m);
  void finish_words(bool keep);
  void erase(const Aim& aim, bool shows_parts);
  void switch_section(const Eigen::Vector3d& centre_m);
  bool move_section(Action action, double width_m);
  void save();
  void save_parts();
  void save_files();
  void read_parts();
  void follow_profile();
  [[nodiscard]] std::optional<Held> held_at(const Aim& aim) const;

  Tell tell_;
  SaveParts save_parts_;
  scene::ScenePointer scene_;
  std::shared_ptr<const scene::Charts> seen_;  ///< of sight_
  std::unique_ptr<const scene::Sight> sight_;
  scene::ScenePointer home_;  ///< the last scene of these scans with a folder, where notes are kept; null: none
  std::vector<scene::PartConfig> parts_;
  Marks marks_;
  Writing writing_ = Writing::pin;
  std::optional<Held> held_;
  bool unreadable_ = false;  ///< the file cannot be read: it is not written over
  bool told_ = false;        ///< that nothing is kept
};

}  // namespace sparsha::viewer

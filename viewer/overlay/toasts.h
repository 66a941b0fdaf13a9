// Announcements on the picture: each is shown once, for as long as it takes to read; what belongs to a place, no longer
// than a second after the hand has left it. Scripts that the fonts do not
// write are spoken only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/frame.h"

namespace sparsha::viewer {

class Toasts {
 public:
  /// Words of the viewer itself.
  void tell(const std::string& text, haptics::Announcement::Priority priority) { own_.push_back({text, priority, 0}); }
  /// Words that a dialog shows already: they are spoken only.
  void hide(std::string text) { hidden_ = std::move(text); }
  /// Nobody looks who could do anything about faults and warnings: they are not shown, nor those any more that are.
  void hide_faults(bool on) { faults_hidden_ = on; }
  /// Whether the hand is still at the place of an announcement.
  using Holds = std::function<bool(const haptics::Announcement& announcement)>;
  /// What is shown at `time_s`, oldest first. `board` may be null. Without `holds` the hand stays where it is.
  [[nodiscard]] std::vector<Toast> update(double time_s, const haptics::AnnouncementBoard* board,
                                          const Holds& holds = {});

 private:
  struct Shown {
    haptics::Announcement announcement;
    double until_s = 0.0, length_s = 1.0;
    double held_s = 0.0;  ///< when the hand was last at its place
  };
  std::vector<Shown> shown_;
  std::vector<haptics::Announcement> own_;
  std::string hidden_;
  bool faults_hidden_ = false;
  std::uint64_t seen_ = 0;
};

}  // namespace sparsha::viewer

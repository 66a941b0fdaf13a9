// What viewer, speech and app ask of the session, and what the session has to say.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sparsha::haptics {

/// A wish; Session decides. Values in the unit that the comment names.
struct Request {
  enum class Kind {
    zoom_in,          ///< one level finer
    zoom_out,         ///< one level coarser
    pan,              ///< x, y: in window widths
    move_to,          ///< x, y: new window centre, grid frame, metres
    scroll,           ///< x, y: of the window, in window widths per second, until told otherwise
    set_texture,      ///< on
    set_friction,     ///< on
    set_stiffness,    ///< x: N/m
    scale_stiffness,  ///< x: factor, within 50 to 5000 N/m
    whole_scene,      ///< the overview, with the scene's middle in the middle
    next_part,        ///< the window goes to the next named part; on: by a button that is held, which ends a guide
    previous_part,    ///< likewise
    turn,             ///< a whole object, about its middle; x, y, z: axis times degrees, device frame; on: one of many
                      ///< small turns, said only when the side that it shows changes
    turn_back,        ///< a whole object, to the front that it began with
    drag,             ///< on: the stone moves with the hand, without force, until this is asked for with off
    guide,            ///< the hand is led along an outline, or no longer; on: by a button that is held on
    describe,         ///< say where the hand is; again, more about the part that it is on
    help,             ///< say what the buttons do
    help_keys,        ///< say what the keys of a terminal do
    tour,             ///< a minute in which the buttons are learnt
    repeat,           ///< say the last words again
    speak_slower,
    speak_faster,
    next_voice,
    toggle_speech,
    set_speech,     ///< on
    fresh_visitor,  ///< what a visitor has left on or turned down is as it was at the start; nothing is said
    quit
  };
  Kind kind = Kind::describe;
  double x = 0.0;
  double y = 0.0;
  bool on = false;
  double z = 0.0;
};

/// Words for the visitor: shown by the viewer, spoken by speech.
struct Announcement {
  enum class Priority { information, warning, fault };
  /// What speech is to become before it says the words; none of anyone else's business.
  /// `reset`: on or off, rate and voice as at the start; comes without words.
  enum class Control { none, slower, faster, next_voice, toggle, reset };
  std::string text;
  Priority priority = Priority::information;
  std::uint64_t sequence = 0;  ///< counts from 1
  Control control = Control::none;
  /// Of what the hand is at: the words are out of date when it is elsewhere.
  enum class Place { anywhere, part, unmeasured, edge };
  Place place = Place::anywhere;
};

/// Many writers, one reader; a mutex is fine, the servo never comes here.
class RequestQueue {
 public:
  void post(const Request& request) {
    const std::lock_guard lock(mutex_);
    if (requests_.size() < kLimit) requests_.push_back(request);
  }
  [[nodiscard]] std::optional<Request> take() {
    const std::lock_guard lock(mutex_);
    if (requests_.empty()) return std::nullopt;
    const Request request = requests_.front();
    requests_.pop_front();
    return request;
  }

 private:
  static constexpr std::size_t kLimit = 1024;
  std::mutex mutex_;
  std::deque<Request> requests_;
};

/// The last announcements, for any number of readers, each of which keeps the sequence number it has seen.
class AnnouncementBoard {
 public:
  void say(std::string text, Announcement::Priority priority = Announcement::Priority::information,
           Announcement::Control control = Announcement::Control::none,
           Announcement::Place place = Announcement::Place::anywhere) {
    const std::lock_guard lock(mutex_);
    announcements_.push_back({std::move(text), priority, ++sequence_, control, place});
    if (announcements_.size() > kLimit) announcements_.pop_front();
  }
  /// Those newer than `seen`, oldest first.
  [[nodiscard]] std::vector<Announcement> since(std::uint64_t seen) const {
    const std::lock_guard lock(mutex_);
    std::vector<Announcement> result;
    for (const Announcement& announcement : announcements_)
      if (announcement.sequence > seen) result.push_back(announcement);
    return result;
  }
  /// Sequence number of the last one; 0: none yet.
  [[nodiscard]] std::uint64_t newest() const {
    const std::lock_guard lock(mutex_);
    return sequence_;
  }

 private:
  static constexpr std::size_t kLimit = 64;
  mutable std::mutex mutex_;
  std::deque<Announcement> announcements_;
  std::uint64_t sequence_ = 0;
};

}  // namespace sparsha::haptics

// Chooses the announcements that are on the picture.
#include "viewer/overlay/toasts.h"

#include <algorithm>
#include <utility>

#include "viewer/gui/fonts.h"

namespace sparsha::viewer {

using haptics::Announcement;

namespace {

bool is_trouble(const Announcement& announcement) {
  return announcement.priority == Announcement::Priority::fault ||
         announcement.priority == Announcement::Priority::warning;
}

}  // namespace

std::vector<Toast> Toasts::update(double time_s, const haptics::AnnouncementBoard* board, const Holds& holds) {
  constexpr double kLag_s = 1.0;
  std::vector<Announcement> fresh = std::exchange(own_, {});
  if (board != nullptr) {
    const std::vector<Announcement> said = board->since(seen_);
    if (!said.empty()) seen_ = said.back().sequence;
    fresh.insert(fresh.end(), said.begin(), said.end());
  }
  for (Announcement& announcement : fresh) {
    if (announcement.text.empty() || announcement.text == hidden_ || !can_show(announcement.text)) continue;
    if (faults_hidden_ && is_trouble(announcement)) continue;
    double length_s = 2.0 + 0.06 * static_cast<double>(announcement.text.size());
    if (announcement.priority == Announcement::Priority::warning) length_s *= 1.5;
    if (announcement.priority == Announcement::Priority::fault) length_s *= 2.0;
    // What the viewer says is spoken by way of the board: the same words come back.
    std::erase_if(shown_, [&](const Shown& shown) { return shown.announcement.text == announcement.text; });
    shown_.push_back({std::move(announcement), time_s + length_s, length_s, time_s});
  }
  for (Shown& shown : shown_) {
    if (!holds || shown.announcement.place == Announcement::Place::anywhere || holds(shown.announcement))
      shown.held_s = time_s;
    else
      shown.until_s = std::min(shown.until_s, shown.held_s + kLag_s);
  }
  std::erase_if(shown_, [&](const Shown& shown) {
    return shown.until_s <= time_s || (faults_hidden_ && is_trouble(shown.announcement));
  });
  constexpr std::size_t kMost = 2;
  if (shown_.size() > kMost) shown_.erase(shown_.begin(), shown_.end() - kMost);
  std::vector<Toast> toasts;
  for (const Shown& shown : shown_) toasts.push_back({shown.announcement, (shown.until_s - time_s) / shown.length_s});
  return toasts;
}

}  // namespace sparsha::viewer

// One frame of the raw cloud.
#include "viewer/cloud/mode.h"

#include <algorithm>
#include <utility>

#include "viewer/cloud/panel.h"
#include "viewer/gui/parts.h"

namespace sparsha::viewer {

CloudMode::CloudMode(Orienting orienting, std::function<void(const std::string&)> speak)
    : controller_(std::move(orienting)), speak_(std::move(speak)) {}

void CloudMode::press(const KeyPress& press) { controller_.press(press); }

bool CloudMode::rests() const {
  const bool drawn = !controller_.frame().status.points || picture_.complete();
  return said_.empty() && drawn && controller_.rests();
}

CloudController::Wish CloudMode::take_wish(ViewSettings& settings) {
  using Wish = CloudController::Wish;
  for (Wish wish = controller_.take_wish(); wish != Wish::none; wish = controller_.take_wish()) {
    if (wish == Wish::contrast) settings.high_contrast = !settings.high_contrast;
    if (wish == Wish::large_type) settings.large_type = !settings.large_type;
    if (wish == Wish::back || wish == Wish::quit) return wish;
  }
  return Wish::none;
}

void CloudMode::draw(Gui& gui, const ViewSettings& settings, unsigned framebuffer, int width, int height, double time_s,
                     bool can_go_back) {
  const Layout layout = layout_of(width, height, settings);
  controller_.update(time_s, layout.detail.width, layout.detail.height, can_go_back);
  picture_.draw(controller_.frame(), framebuffer, layout.detail, height, settings.high_contrast);
  for (std::string& words : controller_.take_words()) {
    const bool note = words == controller_.frame().status.note;  // which the program announces itself
    if (speak_ && !note) speak_(words);
    const bool problem = note && controller_.frame().status.problem;
    const double length_s = (problem ? 4.0 : 2.0) + 0.06 * static_cast<double>(words.size());
    std::erase_if(said_, [&](const Said& said) { return said.text == words; });
    said_.push_back({std::move(words), problem, time_s + length_s});
  }
  std::erase_if(said_, [&](const Said& said) { return said.until_s <= time_s; });
  constexpr std::size_t kMost = 2;
  if (said_.size() > kMost) said_.erase(said_.begin(), said_.end() - kMost);

  Frame words;  // what the two modes have in common is drawn by the same functions
  words.settings = settings;
  for (const Said& said : said_)
    words.toasts.push_back(
        {{said.text,
          said.problem ? haptics::Announcement::Priority::warning : haptics::Announcement::Priority::information, 0},
         std::min(1.0, said.until_s - time_s)});
  gui.draw_pieces(settings, width, height, time_s - before_s_, [&](const Brush& over, const Brush& above) {
    draw_cloud_marks(over, controller_, layout);
    draw_cloud_panel(over, controller_, layout, {picture_.preview_texture(), picture_.sides_texture()});
    draw_toasts(above, words, layout, nullptr);
    if (controller_.frame().help) draw_cloud_help(above, width, height);
  });
  before_s_ = time_s;
}

}  // namespace sparsha::viewer

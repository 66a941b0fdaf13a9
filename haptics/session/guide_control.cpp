#include "haptics/session/guide_control.h"

#include <chrono>
#include <exception>
#include <string>
#include <utility>

#include "base/error.h"

namespace sparsha::haptics {

void GuideControl::look(GuideWish wish) {
  dropped_ = false;
  looking_ = std::async(std::launch::async, [wish = std::move(wish)] { return find_guide(wish); });
}

void GuideControl::ask(GuideWish wish) {
  if (looking_.valid())
    next_ = std::move(wish);
  else
    look(std::move(wish));
}

Command GuideControl::stop(bool silent) {
  on_ = false;
  next_.reset();
  dropped_ = looking_.valid();
  if (!silent) announcer_.say("guide_off");
  Command command;
  command.kind = Command::Kind::guide;
  return command;
}

std::optional<Command> GuideControl::poll() {
  std::erase_if(given_, [](const auto& guide) { return guide.use_count() == 1; });
  if (!looking_.valid() || looking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  GuideAnswer answer;
  std::string failure;
  try {
    answer = looking_.get();
  } catch (const Error& error) {
    failure = error.wrong();
  } catch (const std::exception& error) {
    failure = error.what();
  }
  if (next_) {
    look(*std::exchange(next_, std::nullopt));
    return std::nullopt;
  }
  if (std::exchange(dropped_, false)) return std::nullopt;
  if (!failure.empty()) {
    announcer_.say("window_unreadable", {{"reason", failure}}, Announcement::Priority::fault);
    return std::nullopt;
  }
  on_ = answer.guide != nullptr;
  Command command;
  command.kind = Command::Kind::guide;
  command.guide = answer.guide;
  if (answer.guide) {
    given_.push_back(answer.guide);
    say_way(answer);
  } else {
    announcer_.say(answer.why);
  }
  return command;
}

void GuideControl::say_way(const GuideAnswer& answer) {
  if (answer.part.empty())
    announcer_.say_way("guide_on", "guide_on_here", answer.way_m);
  else
    announcer_.say_way("guide_part", "guide_part_here", answer.way_m, {{"part", answer.part}});
}

void GuideControl::watch(const State& state) {
  if (on_ && state.guide != phase_) {
    if (state.guide == GuidePhase::leading) announcer_.say("guide_leads");
    if (state.guide == GuidePhase::let_go) announcer_.say("guide_let_go");
  }
  if (on_ && state.guide_rounds > rounds_) announcer_.say("guide_round");
  phase_ = state.guide;
  rounds_ = state.guide_rounds;
}

}  // namespace sparsha::haptics

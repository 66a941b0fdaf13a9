// What keys of a terminal ask of a session, among them the four of a pad.
#pragma once

#include <cstddef>
#include <vector>

#include "app/terminal/typed_keys.h"
#include "haptics/state/requests.h"

namespace sparsha::app {

/// Letters and arrows act at once. The digits 1 to 4 are the grip's buttons from the front, right, forward, centre and
/// left, for a pad of four keys: terminals do not tell when a key is let go, so pressed once they click, and pressed
/// twice, or held until they repeat, they do what the grip's button does when it is held.
class TerminalKeys {
 public:
  /// What has been typed by `time_s`; call at least ten times a second, also with nothing.
  [[nodiscard]] std::vector<haptics::Request> take(const std::vector<TypedKey>& typed, double time_s);

 private:
  void letter(char key, std::vector<haptics::Request>& requests);
  void digit(std::size_t button, double time_s, std::vector<haptics::Request>& requests);
  void end(std::vector<haptics::Request>& requests);

  enum class Pad { idle, pressed, held };
  Pad pad_ = Pad::idle;
  std::size_t button_ = 0;
  double last_s_ = 0.0;   // when its key came last
  double since_s_ = 0.0;  // when it was pressed first
  bool longer_ = false;   // held so long that it means something else
  bool longest_ = false;  // and longer still
  bool dragging_ = false;
};

}  // namespace sparsha::app

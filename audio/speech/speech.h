// Announcements as speech: espeak-ng as a child process, when present.
#pragma once

#include <memory>
#include <string>

#include "haptics/shared/requests.h"

namespace sparsha::audio {

/// Newer words interrupt older ones; faults come first. Never blocks the caller.
class Speech {
 public:
  Speech();
  ~Speech();
  Speech(const Speech&) = delete;
  Speech& operator=(const Speech&) = delete;
  /// False when no speech program is installed.
  [[nodiscard]] bool available() const;
  void say(const haptics::Announcement& announcement);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::audio

// The scenes that were kept with a recording, for `explore --device playback:` and `trace --live`.
#pragma once

#include <optional>

#include "app/commands/commands.h"
#include "app/terminal/terminal.h"
#include "haptics/replay/recorded_scenes.h"

namespace sparsha::app {

/// Opens them and says so on the terminal; nothing for a recording of one scene, which is played on the one that the
/// user names. Throws as haptics::open_kept_scenes().
[[nodiscard]] std::optional<haptics::RecordedScenes> kept_scenes_of(const haptics::Recording& recording,
                                                                    const CommonOptions& common,
                                                                    const Terminal& terminal);

}  // namespace sparsha::app

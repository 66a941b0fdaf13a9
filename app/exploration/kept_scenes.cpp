#include "app/exploration/kept_scenes.h"

#include "base/phrases/phrases.h"
#include "haptics/replay/kept_folder.h"

namespace sparsha::app {

std::optional<haptics::RecordedScenes> kept_scenes_of(const haptics::Recording& recording, const CommonOptions& common,
                                                      const Terminal& terminal) {
  std::optional<haptics::RecordedScenes> kept = haptics::open_kept_scenes(recording, common.trusted());
  if (!kept) return kept;
  const Phrases phrases = Phrases::of("en");
  const PhraseValues values{{"folder", haptics::kept_folder_of(recording.file()).filename().string()}};
  terminal.message(phrases.text("played_on_kept", values));
  if (kept->of_another_recording()) terminal.message("warning: " + phrases.text("kept_of_another", values));
  return kept;
}

}  // namespace sparsha::app

// What leads and tells, and what is shown: `speech`, `guide`, `cues`, `viewer`.
#include "scene/config/guide.h"
#include "scene/config/viewer.h"
#include "scene/keys/forms.h"

namespace sparsha::scene::keys {
namespace {

template <typename Names>
Form names_of(const Names& names) {
  return word({names.begin(), names.end()});
}

Form cue() { return word({"both", "sound", "tick", "off"}); }

}  // namespace

std::vector<Key> guidance_keys() {
  return {
      {"speech", {toggle(), block()}, "", "false", "What is announced is spoken"},
      {"speech.language", {word({"en", "hi"})}, "", "en", "Language of the announcements"},
      {"speech.voice",
       {text()},
       "",
       "",
       "A voice of espeak-ng (column Language of `espeak-ng --voices`); absent: the language's own"},
      {"speech.words_per_minute", {whole(80, 450)}, "1/min", "170", "Speed of speech"},
      {"guide", {block(), nothing()}, "", "", "How a hand is led that asks for it"},
      {"guide.path",
       {names_of(GuideConfig::kPathNames)},
       "",
       "outline",
       "Along what: lines of the relief, a part's border, `line_m`"},
      {"guide.force_n", {number(0.1, 4.0)}, "N", "1", "Largest force"},
      {"guide.speed_mm_per_s", {number(5.0, 200.0)}, "mm/s", "40", "Speed at the hand"},
      {"guide.line_m",
       {points(2, 10000), places(2, 10000)},
       "m",
       "",
       "Of `path: drawn`: the line, grid frame, or in space on a whole object, frame of the scans; closed where it "
       "ends "
       "in its first point"},
      {"cues",
       {toggle(), block(), nothing()},
       "",
       "false",
       "Short sounds and ticks that say what the hand has come to"},
      {"cues.level", {cue()}, "", "both", "Another level of detail"},
      {"cues.edge", {cue()}, "", "both", "The edge of the region"},
      {"cues.unmeasured", {cue()}, "", "both", "A place that was not measured"},
      {"cues.part_entered", {cue()}, "", "both", "A part begins"},
      {"cues.part_left", {cue()}, "", "both", "A part ends"},
      {"cues.lost", {toggle()}, "", "true", "A tone leads back to the stone"},
      {"viewer", {block()}, "", "", "How the picture begins"},
      {"viewer.colour", {names_of(ViewerConfig::kColourNames)}, "", "relief", "What the colours show"},
      {"viewer.stereo", {names_of(ViewerConfig::kStereoNames)}, "", "off", "For glasses or a screen of two pictures"},
      {"viewer.overview",
       {names_of(ViewerConfig::kSideNames)},
       "",
       "right",
       "Where the overview lies, beside the selected region"},
  };
}

}  // namespace sparsha::scene::keys

// What is heard: `audio`.
#include "scene/keys/forms.h"
#include "scene/material/sound_limits.h"

namespace sparsha::scene::keys {
namespace {

Form frequency() { return number(kLeastFrequency_hz, kMostFrequency_hz); }
Form decay() { return number(kLeastDecay_s, kMostDecay_s); }
Form damping() { return number(kLeastDamping, kMostDamping); }

}  // namespace

std::vector<Key> sound_keys() {
  return {
      {"audio", {block(), nothing()}, "", "", "Places that sound; absent: none"},
      {"audio.regions", {list()}, "", "", "Places and their sounds; the first match wins"},
      {"audio.regions[].name", {text()}, "", "", "By what it is known", true},
      {"audio.regions[].box_m",
       {numbers(4), numbers(6)},
       "m",
       "",
       "xmin, ymin, xmax, ymax, grid frame; of a whole object (around) also xmin, ymin, zmin, xmax, ymax, zmax, scan "
       "frame"},
      {"audio.regions[].polygon_m", {points(3, 1000)}, "m", "", "Corners in their order, grid frame"},
      {"audio.regions[].label", {whole(1, 65535)}, "", "", "Pixels of this value of the image `audio.labels`"},
      {"audio.regions[].modal",
       {block(), nothing()},
       "",
       "",
       "A note, or the modes of a recorded strike (`sparsha sound fit`)"},
      {"audio.regions[].modal.frequency_hz", {frequency()}, "Hz", "240", "The note"},
      {"audio.regions[].modal.decay_s", {decay()}, "s", "1.2", "Time to fall by 60 dB"},
      {"audio.regions[].modal.modes", {list(1.0, kMostModes)}, "", "", "1 to 32 modes in place of the note"},
      {"audio.regions[].modal.modes[].frequency_hz", {frequency()}, "Hz", "", "Frequency of the mode", true},
      {"audio.regions[].modal.modes[].decay_s", {decay()}, "s", "", "Time to fall by 60 dB", true},
      {"audio.regions[].modal.modes[].level_db", {number(-200.0, 60.0)}, "dB", "0", "Level relative to the others"},
      {"audio.regions[].clip", {file()}, "", "", "A recording: WAV, FLAC, Ogg"},
      {"audio.regions[].loop",
       {word({"none", "one_period"})},
       "",
       "none",
       "Of a clip: one period of it is repeated while it decays"},
      {"audio.regions[].material", {material(), block()}, "", "", "The sound of a material"},
      {"audio.regions[].material.name", {material()}, "", "", "Whose table is taken", true},
      {"audio.regions[].material.frequency_hz", {frequency()}, "Hz", "", "First mode; absent: the table's"},
      {"audio.regions[].material.damping", {damping()}, "", "", "Loss factor; absent: the table's"},
      {"audio.regions[].material.brightness", {number(0.0, 1.0)}, "", "", "Share of high modes; absent: the table's"},
      {"audio.labels",
       {file(), block()},
       "",
       "",
       "An image of whole numbers over the grid, for `label` of regions and parts"},
      {"audio.labels.file", {file()}, "", "", "PNG, grey or palette; the top row is the largest y", true},
      {"audio.labels.bounds_m", {numbers(4)}, "m", "", "xmin, ymin, xmax, ymax that it covers; absent: the whole grid"},
      {"audio.find", {word({"pillars"})}, "", "", "Regions without a place lie on the pillars of the scan"},
      {"audio.material", {material(), block()}, "", "", "The sound of all other places; absent: these are mute"},
      {"audio.material.name", {material()}, "", "", "Whose table is taken", true},
      {"audio.material.frequency_hz", {frequency()}, "Hz", "", "First mode; absent: the table's"},
      {"audio.material.damping", {damping()}, "", "", "Loss factor; absent: the table's"},
      {"audio.material.brightness", {number(0.0, 1.0)}, "", "", "Share of high modes; absent: the table's"},
      {"audio.friction_sound", {block(), nothing()}, "", "", "A stroke over the surface is heard; absent: not"},
      {"audio.friction_sound.gain", {number(0.0, 10.0)}, "", "0.5", "Loudness"},
      {"audio.friction_sound.grain",
       {toggle()},
       "",
       "true",
       "What lies between the nodes is heard as the grain continues it"},
  };
}

}  // namespace sparsha::scene::keys

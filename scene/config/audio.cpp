// The block `audio`: where a scene sounds, and what.
#include "scene/config/reader.h"
#include "scene/material/sound_limits.h"

namespace sparsha::scene {
namespace {

using yaml::MapReader;
using yaml::Node;

constexpr double kQuietest_db = -200.0;
constexpr double kLoudest_db = 60.0;

ModalConfig parse_modal(const Node& node) {
  ModalConfig modal;
  if (node.kind == Node::Kind::null) return modal;
  MapReader keys(node, "modal");
  const Node* modes = keys.optional("modes");
  if (modes != nullptr && node.entries.size() > 1) {
    throw yaml::error_at(node, "'modes' and other keys of a note contradict", "modes, or frequency_hz and decay_s");
  }
  keys.read("frequency_hz", modal.frequency_hz, kLeastFrequency_hz, kMostFrequency_hz);
  keys.read("decay_s", modal.decay_s, kLeastDecay_s, kMostDecay_s);
  keys.finish();
  if (modes == nullptr) return modal;
  if (!modes->is_sequence() || modes->items.empty() || modes->items.size() > kMostModes) {
    throw yaml::error_at(*modes, "modes is not a list of 1 to 32 modes", "{frequency_hz, decay_s, level_db} each");
  }
  for (const Node& item : modes->items) {
    ModeConfig mode;
    MapReader reader(item, "a mode");
    static_cast<void>(reader.required("frequency_hz"));
    static_cast<void>(reader.required("decay_s"));
    reader.read("frequency_hz", mode.frequency_hz, kLeastFrequency_hz, kMostFrequency_hz);
    reader.read("decay_s", mode.decay_s, kLeastDecay_s, kMostDecay_s);
    reader.read("level_db", mode.level_db, kQuietest_db, kLoudest_db);
    reader.finish();
    modal.modes.push_back(mode);
  }
  return modal;
}

// A name, or a map with the name and what differs from the table.
MaterialSoundConfig parse_material(MapReader& reader, const Node& node) {
  MaterialSoundConfig sound;
  if (!node.is_map()) {
    read_material(reader, "material", sound.material);
    return sound;
  }
  MapReader keys(node, "material");
  static_cast<void>(keys.required("name"));
  read_material(keys, "name", sound.material);
  read_number(keys, "frequency_hz", sound.frequency_hz, kLeastFrequency_hz, kMostFrequency_hz);
  read_number(keys, "damping", sound.damping, kLeastDamping, kMostDamping);
  read_number(keys, "brightness", sound.brightness, 0.0, 1.0);
  keys.finish();
  return sound;
}

void read_place(AudioRegionConfig& region, int where, const Node& node) {
  if (where == 0) region.solid_m = read_solid_box(*node.find("box_m"));
  if (where == 0 && !region.solid_m) region.box_m = read_box(*node.find("box_m"));
  if (where == 1) region.polygon_m = read_polygon(*node.find("polygon_m"));
  if (where == 2) region.label = read_label(*node.find("label"));
}

AudioRegionConfig parse_region(const Node& node, const std::filesystem::path& folder, bool pillars) {
  AudioRegionConfig region;
  MapReader reader(node, "an audio region");
  region.name = yaml::to_text(reader.required("name"));
  const int where = exclusive(reader, {"box_m", "polygon_m", "label"});
  const int what = exclusive(reader, {"modal", "clip", "material"});
  if (where < 0 && !pillars) {
    throw yaml::error_at(node, "region '" + region.name + "' has no place",
                         "box_m, polygon_m or label; or find: pillars beside the regions");
  }
  if (what < 0) throw yaml::error_at(node, "region '" + region.name + "' has no sound", "modal, clip or material");
  read_place(region, where, node);
  if (what == 0) region.sound = parse_modal(*node.find("modal"));
  if (what == 1) region.sound = resolved(*node.find("clip"), folder);
  if (what == 2) region.sound = parse_material(reader, *node.find("material"));
  if (const Node* loop = reader.optional("loop")) {
    if (what != 1) throw yaml::error_at(*loop, "'loop' belongs to 'clip'", "leave it out");
    int kind = 0;
    reader.read_choice("loop", kind, {"none", "one_period"});
    region.loop = static_cast<AudioRegionConfig::Loop>(kind);
  }
  reader.finish();
  return region;
}

void parse_friction_sound(const Node& node, AudioConfig& audio) {
  double gain = 0.5;
  if (node.kind != Node::Kind::null) {
    MapReader keys(node, "friction_sound");
    keys.read("gain", gain, 0.0, 10.0);
    keys.read("grain", audio.friction_sound_grain);
    keys.finish();
  }
  audio.friction_sound_gain = gain;
}

LabelImageConfig parse_labels(const Node& node, const std::filesystem::path& folder) {
  LabelImageConfig labels;
  if (!node.is_map()) {
    labels.file = resolved(node, folder);
    return labels;
  }
  MapReader reader(node, "labels");
  labels.file = resolved(reader.required("file"), folder);
  if (const Node* bounds = reader.optional("bounds_m")) labels.bounds_m = read_box(*bounds);
  reader.finish();
  return labels;
}

}  // namespace

AudioConfig parse_audio(const Node& node, const std::filesystem::path& folder) {
  AudioConfig audio;
  if (node.kind == Node::Kind::null) return audio;
  MapReader reader(node, "audio");
  if (reader.optional("find") != nullptr) {
    int found = 0;
    reader.read_choice("find", found, {"pillars"});
    audio.find_pillars = true;
  }
  if (const Node* regions = reader.optional("regions")) {
    if (!regions->is_sequence()) throw yaml::error_at(*regions, "regions is not a list", "a list of regions");
    for (const Node& item : regions->items) audio.regions.push_back(parse_region(item, folder, audio.find_pillars));
  }
  if (const Node* labels = reader.optional("labels")) audio.labels = parse_labels(*labels, folder);
  if (const Node* material = reader.optional("material")) audio.material = parse_material(reader, *material);
  if (const Node* friction = reader.optional("friction_sound")) parse_friction_sound(*friction, audio);
  reader.finish();
  return audio;
}

}  // namespace sparsha::scene

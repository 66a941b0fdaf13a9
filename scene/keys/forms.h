// Short names for the table of scene/keys; for its files alone.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "scene/keys/keys.h"

namespace sparsha::scene::keys {

inline Form nothing() { return {.kind = Form::Kind::nothing}; }
inline Form block() { return {.kind = Form::Kind::block}; }
inline Form list(double least = 0.0, double most = 0.0) {
  return {.kind = Form::Kind::list, .least = least, .most = most};
}
inline Form number(double least, double most) { return {.kind = Form::Kind::number, .least = least, .most = most}; }
inline Form length() { return number(kNoLeast, kNoMost); }
inline Form whole(double least, double most) { return {.kind = Form::Kind::whole, .least = least, .most = most}; }
inline Form toggle() { return {.kind = Form::Kind::toggle}; }
inline Form text() { return {.kind = Form::Kind::text}; }
/// Not empty; `seen`: not of white space alone either.
inline Form name(bool seen = false) { return {.kind = Form::Kind::text, .pattern = seen ? "\\S" : "[\\s\\S]"}; }
inline Form file() { return {.kind = Form::Kind::file, .pattern = "[\\s\\S]"}; }
inline Form word(std::vector<std::string_view> words) { return {.kind = Form::Kind::word, .words = std::move(words)}; }
inline Form words(double least, std::vector<std::string_view> words) {
  return {.kind = Form::Kind::words, .least = least, .words = std::move(words)};
}
inline Form wholes(double least, double most) { return {.kind = Form::Kind::wholes, .least = least, .most = most}; }
inline Form numbers(double count) { return {.kind = Form::Kind::numbers, .least = count, .most = count}; }
inline Form matrix() { return {.kind = Form::Kind::matrix}; }
inline Form points(double least, double most) { return {.kind = Form::Kind::points, .least = least, .most = most}; }
inline Form places(double least, double most) { return {.kind = Form::Kind::places, .least = least, .most = most}; }
/// A name of the table of materials.
Form material();

std::vector<Key> scan_keys();
std::vector<Key> filter_keys();
std::vector<Key> layer_keys();
std::vector<Key> touch_keys();
std::vector<Key> sound_keys();
std::vector<Key> guidance_keys();

}  // namespace sparsha::scene::keys

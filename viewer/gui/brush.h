// Small vocabulary for drawing the interface: colours of the theme, text at a place, rounded shapes. Seen by gui/ only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/gui/fonts.h"

struct ImDrawList;
struct ImFont;
struct ImVec2;

namespace sparsha::viewer {

/// All colours of the interface. High contrast: white, yellow and a light red on black, words 7:1 or more.
struct Theme {
  std::uint32_t panel, card, line, text, dim, accent, accent_text, warning, fault, key;
};
[[nodiscard]] Theme theme_of(bool high_contrast);

/// Words as they were drawn, for tests of the layout.
struct DrawnText {
  std::string words;
  float x = 0.0F, y = 0.0F, width = 0.0F, height = 0.0F;
  int layer = 0;      ///< 0 under, 1 announcements, 2 a page or question over everything, 3 marks on the stone
  float room = 0.0F;  ///< the width that a button or panel has for them; 0: they are not cut off
};

/// Draws on one ImGui draw list; positions in pixels.
struct Brush {
  ImDrawList* list = nullptr;
  Fonts fonts;
  Theme theme{};
  float scale = 1.0F;
  std::vector<DrawnText>* drawn = nullptr;
  int layer = 0;

  [[nodiscard]] float px(float value) const { return value * scale; }
  [[nodiscard]] ImVec2 size(const ImFont* font, const std::string& words) const;
  /// Top left at (x, y). Returns the width.
  float text(const ImFont* font, float x, float y, std::uint32_t colour, const std::string& words) const;
  void text_right(const ImFont* font, float x, float y, std::uint32_t colour, const std::string& words) const;
  void text_centred(const ImFont* font, float x, float y, std::uint32_t colour, const std::string& words) const;
  /// The largest of large, medium, strong, text and small type, from `first` on, in which the words fit.
  [[nodiscard]] const ImFont* fitting(const ImFont* first, const std::string& words, float width) const;
  /// The words, or as much of them as fits and an ellipsis.
  [[nodiscard]] std::string elided(const ImFont* font, const std::string& words, float width) const;
  void card(float x, float y, float width, float height, std::uint32_t colour, float radius) const;
  /// A key's cap with its name; returns its width.
  float key_cap(float x, float y, const std::string& name) const;
  [[nodiscard]] float key_cap_width(const std::string& name) const;
};

}  // namespace sparsha::viewer

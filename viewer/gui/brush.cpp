// Drawing helpers of the interface.
#include "viewer/gui/brush.h"

#include <imgui.h>

#include <algorithm>
#include <array>

namespace sparsha::viewer {

Theme theme_of(bool high_contrast) {
  if (high_contrast) {
    const ImU32 white = IM_COL32(255, 255, 255, 255), yellow = IM_COL32(255, 255, 0, 255);
    const ImU32 black = IM_COL32(0, 0, 0, 255);
    return {black,
            black,
            white,
            white,
            white,
            yellow,
            black,
            yellow,
            IM_COL32(255, 112, 112, 255),
            IM_COL32(60, 60, 60, 255)};
  }
  return {IM_COL32(24, 22, 20, 255),    IM_COL32(18, 16, 14, 225),    IM_COL32(255, 240, 220, 34),
          IM_COL32(244, 236, 224, 255), IM_COL32(178, 166, 150, 255), IM_COL32(246, 166, 58, 255),
          IM_COL32(28, 18, 6, 255),     IM_COL32(246, 206, 90, 255),  IM_COL32(255, 122, 104, 255),
          IM_COL32(255, 240, 220, 30)};
}

ImVec2 Brush::size(const ImFont* font, const std::string& words) const {
  return font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
}

float Brush::text(const ImFont* font, float x, float y, ImU32 colour, const std::string& words) const {
  list->AddText(font, font->FontSize, ImVec2(x, y), colour, words.c_str());
  const ImVec2 extent = size(font, words);
  if (drawn != nullptr && !words.empty()) drawn->push_back({words, x, y, extent.x, extent.y, layer});
  return extent.x;
}

const ImFont* Brush::fitting(const ImFont* first, const std::string& words, float width) const {
  const std::array<const ImFont*, 5> all{fonts.large, fonts.medium, fonts.strong, fonts.text, fonts.small};
  for (auto font = std::ranges::find(all, first); font != all.end(); ++font)
    if (size(*font, words).x <= width) return *font;
  return fonts.small;
}

std::string Brush::elided(const ImFont* font, const std::string& words, float width) const {
  if (size(font, words).x <= width) return words;
  std::string shorter = words;
  while (!shorter.empty()) {
    // Whole characters: continuation bytes of UTF-8 go with their first.
    while (!shorter.empty() && (static_cast<unsigned char>(shorter.back()) & 0xC0U) == 0x80U) shorter.pop_back();
    if (!shorter.empty()) shorter.pop_back();
    if (size(font, shorter + "\xE2\x80\xA6").x <= width) return shorter.empty() ? shorter : shorter + "\xE2\x80\xA6";
  }
  return shorter;
}

void Brush::text_right(const ImFont* font, float x, float y, ImU32 colour, const std::string& words) const {
  text(font, x - size(font, words).x, y, colour, words);
}

void Brush::text_centred(const ImFont* font, float x, float y, ImU32 colour, const std::string& words) const {
  text(font, x - 0.5F * size(font, words).x, y, colour, words);
}

void Brush::card(float x, float y, float width, float height, ImU32 colour, float radius) const {
  list->AddRectFilled(ImVec2(x, y), ImVec2(x + width, y + height), colour, radius);
}

float Brush::key_cap_width(const std::string& name) const {
  return std::max(size(fonts.small, name).x + px(12.0F), px(22.0F));
}

float Brush::key_cap(float x, float y, const std::string& name) const {
  const float width = key_cap_width(name), height = fonts.small->FontSize + px(6.0F);
  card(x, y, width, height, theme.key, px(4.0F));
  list->AddRect(ImVec2(x, y), ImVec2(x + width, y + height), theme.line, px(4.0F));
  text_centred(fonts.small, x + 0.5F * width, y + px(3.0F), theme.text, name);
  return width;
}

}  // namespace sparsha::viewer

// Fonts come from where systems keep DejaVu or their own sans serif.
#include "viewer/gui/fonts.h"

#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include <imgui.h>

namespace sparsha::viewer {
namespace {

// Latin with the diacritics of Indic transliteration, combining accents, Greek with its accents and breathings,
// Cyrillic, dashes and quotes, arrows, minus.
constexpr std::array<ImWchar, 17> kRanges{0x0020, 0x017F, 0x0300, 0x036F, 0x0370, 0x052F, 0x1E00, 0x1FFF, 0x2010,
                                          0x2026, 0x2190, 0x2193, 0x2212, 0x2212, 0x25CF, 0x25CF, 0};

std::string first_of(const std::array<const char*, 4>& files) {
  for (const char* file : files) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) return file;
  }
  return {};
}

bool in_ranges(std::uint32_t character) {
  for (std::size_t k = 0; k + 1 < kRanges.size(); k += 2)
    if (character >= kRanges[k] && character <= kRanges[k + 1]) return true;
  return false;
}

}  // namespace

bool can_show(std::string_view text) {
  int drawn = 0, missing = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto first = static_cast<unsigned char>(text[at]);
    if (first < 0x80) {
      drawn += std::isalpha(first) != 0 ? 1 : 0;
      continue;
    }
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
    if (more == 0) continue;  // within a letter, or no UTF-8
    std::uint32_t character = first & (0x3FU >> more);
    for (int k = 0; k < more && at + 1 < text.size(); ++k)
      character = (character << 6U) | (static_cast<unsigned char>(text[++at]) & 0x3FU);
    ++(in_ranges(character) ? drawn : missing);
  }
  return missing <= drawn;
}

Fonts load_fonts(double scale) {
  static const std::string plain =
      first_of({"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                "/System/Library/Fonts/Helvetica.ttc", "C:/Windows/Fonts/segoeui.ttf"});
  static const std::string bold = first_of({"/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
                                            "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf",
                                            "/System/Library/Fonts/Helvetica.ttc", "C:/Windows/Fonts/segoeuib.ttf"});
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.Flags |= ImFontAtlasFlags_NoMouseCursors;
  const auto load = [&](const std::string& file, double size) {
    ImFontConfig config;
    const auto pixels = static_cast<float>(std::round(size * scale));
    constexpr float kLarge_px = 32.0F;  // between pixels such letters need no place, and their texture is large
    config.OversampleH = pixels < kLarge_px ? 2 : 1;
    config.OversampleV = 1;
    ImFont* font = file.empty() ? nullptr : atlas.AddFontFromFileTTF(file.c_str(), pixels, &config, kRanges.data());
    if (font != nullptr) return font;
    config.SizePixels = pixels;
    return atlas.AddFontDefault(&config);
  };
  Fonts fonts;
  fonts.text = load(plain, 16.0);
  fonts.small = load(plain, 13.0);
  fonts.strong = load(bold, 16.0);
  fonts.medium = load(bold, 20.0);
  fonts.large = load(bold, 27.0);
  return fonts;
}

}  // namespace sparsha::viewer

#include "pipeline/scan/formats/text/table_header.h"

#include <algorithm>
#include <initializer_list>

#include "base/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLongestHeader = 1 << 14;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Letters and digits of a name, and bytes beyond ASCII: "Coord. X" and "coord_x" are the same.
std::string letters_of(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if ((c >= 'a' && c <= 'z') || is_digit(c) || (static_cast<unsigned char>(c) & 0x80) != 0) result += c;
  }
  return result;
}

int find(const std::vector<std::string>& names, std::initializer_list<std::string_view> wanted) {
  for (const std::string_view word : wanted) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found != names.end()) return static_cast<int>(found - names.begin());
  }
  return -1;
}

/// Counts commas between digits and others of one word between blanks.
struct WordCommas {
  int within = 0;  ///< between two digits
  int others = 0;  ///< elsewhere, one at the end left out
  bool point = false;
};

WordCommas commas_of_word(std::string_view word) {
  WordCommas commas;
  if (!word.empty() && word.back() == ',') word.remove_suffix(1);
  for (std::size_t i = 0; i < word.size(); ++i) {
    commas.point = commas.point || word[i] == '.';
    if (word[i] != ',') continue;
    const bool within = i > 0 && i + 1 < word.size() && is_digit(word[i - 1]) && is_digit(word[i + 1]);
    ++(within ? commas.within : commas.others);
  }
  return commas;
}

/// A number in quotes with a comma between its digits.
bool has_quoted_comma(std::string_view line) {
  for (std::size_t open = line.find('"'); open != std::string_view::npos; open = line.find('"', open + 1)) {
    const std::size_t close = line.find('"', open + 1);
    if (close == std::string_view::npos) return false;
    const std::string_view word = line.substr(open + 1, close - open - 1);
    if (word.find_first_not_of("0123456789+-,") == std::string_view::npos && commas_of_word(word).within == 1)
      return true;
    open = close;
  }
  return false;
}

}  // namespace

std::vector<std::string> header_names(std::string_view line) {
  if (line.size() > kLongestHeader) return {};
  while (!line.empty() && (is_blank(line.front()) || line.front() == '#' || line.front() == '/' ||
                           line.front() == '%' || line.front() == '!')) {
    line.remove_prefix(1);
  }
  std::vector<std::string> names;
  const bool commas = line.find_first_of(",;") != std::string_view::npos;
  std::string name;
  const auto keep = [&] {
    while (!name.empty() && is_blank(name.back())) name.pop_back();
    const std::size_t bracket = name.find_first_of("([");
    if (bracket != std::string::npos && bracket > 0) name.resize(bracket);
    while (!name.empty() && is_blank(name.back())) name.pop_back();
    names.push_back(lower_case(name));
    name.clear();
  };
  for (const char c : line) {
    if (c == '"') continue;
    if (commas ? (c == ',' || c == ';') : is_blank(c)) {
      if (commas || !name.empty()) keep();
    } else if (!(name.empty() && is_blank(c))) {
      name += c;
    }
  }
  if (!name.empty()) keep();
  return names;
}

NamedCoordinates name_coordinates(const std::vector<std::string>& names) {
  std::vector<std::string> plain;
  plain.reserve(names.size());
  for (const std::string& name : names) plain.push_back(letters_of(name));
  NamedCoordinates named;
  // English, German, French, Italian, Spanish and Portuguese, as surveyors and their programs write them.
  const int x = find(plain, {"x",         "xcoord",     "xcoordinate", "coordx",  "coordinatex", "xpos",    "posx",
                             "positionx", "px",         "pointx",      "xm",      "points0",     "easting", "east",
                             "e",         "rechtswert", "rechts",      "ostwert", "ost",         "est",     "este"});
  const int y = find(plain, {"y",         "ycoord",   "ycoordinate", "coordy",   "coordinatey", "ypos",     "posy",
                             "positiony", "py",       "pointy",      "ym",       "points1",     "northing", "north",
                             "n",         "hochwert", "hoch",        "nordwert", "nord",        "norte"});
  const int z = find(plain, {"z",         "zcoord",   "zcoordinate", "coordz",  "coordinatez", "zpos",      "posz",
                             "positionz", "pz",       "pointz",      "zm",      "points2",     "elevation", "elev",
                             "height",    "altitude", "alt",         "h",       "h\xC3\xB6he", "h\xF6he",   "hoehe",
                             "hauteur",   "quota",    "cota",        "altezza", "altura"});
  if (x >= 0 && y >= 0 && z >= 0) {
    named.columns = {x, y, z};
    return named;
  }
  const int longitude = find(plain, {"longitude", "lon", "long", "lng"});
  const int latitude = find(plain, {"latitude", "lat"});
  if (longitude >= 0 && latitude >= 0 && z >= 0) {
    named.columns = {longitude, latitude, z};
    named.degrees = true;
  }
  return named;
}

Commas commas_of_row(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return Commas::none_or_separators;
  if (has_quoted_comma(line)) return Commas::decimal;
  if (line.find(';') != std::string_view::npos) {
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (line[i] == ',' && is_digit(line[i - 1]) && is_digit(line[i + 1])) return Commas::decimal;
    }
    return Commas::none_or_separators;
  }
  // Blanks part the values when every word holds one comma at most, and that between digits.
  int words = 0;
  int within = 0;
  bool point = false;
  bool both = false;
  std::string_view rest = line;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    const WordCommas commas = commas_of_word(word);
    if (commas.within > 1 || commas.others > 0) return Commas::none_or_separators;
    ++words;
    within += commas.within;
    point = point || commas.point;
    both = both || (commas.within == 1 && commas.point);
  }
  if (words < 3 || within == 0) return Commas::none_or_separators;
  if (both) return Commas::thousands;
  return point ? Commas::none_or_separators : Commas::decimal;
}

}  // namespace sparsha::pipeline

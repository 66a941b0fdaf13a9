#include "pipeline/scan/formats/text/table_header.h"

#include <algorithm>
#include <initializer_list>

#include "base/lower_case.h"
#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kLongestHeader = 1 << 14;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

template <typename Words>
bool is_one_of(std::string_view word, const Words& words) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// Letters and digits of a name, and bytes beyond ASCII: "Coord. X" and "coord_x" are the same.
std::string letters_of(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if ((c >= 'a' && c <= 'z') || is_digit(c) || (static_cast<unsigned char>(c) & 0x80) != 0) result += c;
  }
  return result;
}

void trim(std::string& text) {
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  text.erase(0, static_cast<std::size_t>(skip_blanks(text.data(), text.data() + text.size()) - text.data()));
}

// ---- units ----

enum class NamedUnit : std::uint8_t { none, metre, centimetre, millimetre, foot, us_foot, degree, unknown };

NamedUnit unit_named(std::string_view text) {
  struct Spelling {
    std::string_view letters;
    NamedUnit unit;
  };
  static constexpr Spelling kSpellings[] = {
      {"m", NamedUnit::metre},
      {"meter", NamedUnit::metre},
      {"metre", NamedUnit::metre},
      {"meters", NamedUnit::metre},
      {"metres", NamedUnit::metre},
      {"mtr", NamedUnit::metre},
      {"metri", NamedUnit::metre},
      {"metros", NamedUnit::metre},
      {"cm", NamedUnit::centimetre},
      {"centimeter", NamedUnit::centimetre},
      {"centimetre", NamedUnit::centimetre},
      {"centimeters", NamedUnit::centimetre},
      {"centimetres", NamedUnit::centimetre},
      {"mm", NamedUnit::millimetre},
      {"millimeter", NamedUnit::millimetre},
      {"millimetre", NamedUnit::millimetre},
      {"millimeters", NamedUnit::millimetre},
      {"millimetres", NamedUnit::millimetre},
      {"ft", NamedUnit::foot},
      {"feet", NamedUnit::foot},
      {"foot", NamedUnit::foot},
      {"ift", NamedUnit::foot},
      {"intft", NamedUnit::foot},
      {"usft", NamedUnit::us_foot},
      {"ftus", NamedUnit::us_foot},
      {"usfeet", NamedUnit::us_foot},
      {"usfoot", NamedUnit::us_foot},
      {"ussurveyfoot", NamedUnit::us_foot},
      {"ussurveyfeet", NamedUnit::us_foot},
      {"sft", NamedUnit::us_foot},
      {"deg", NamedUnit::degree},
      {"degree", NamedUnit::degree},
      {"degrees", NamedUnit::degree},
      {"dd", NamedUnit::degree},
      {"\xC2\xB0", NamedUnit::degree},
      {"\xB0", NamedUnit::degree},
      {"in", NamedUnit::unknown},
      {"inch", NamedUnit::unknown},
      {"inches", NamedUnit::unknown},
      {"km", NamedUnit::unknown},
      {"dm", NamedUnit::unknown},
      {"um", NamedUnit::unknown},
      {"\xC2\xB5m", NamedUnit::unknown},
      {"\xCE\xBCm", NamedUnit::unknown},
      {"nm", NamedUnit::unknown},
      {"yd", NamedUnit::unknown},
      {"px", NamedUnit::unknown},
      {"pixel", NamedUnit::unknown},
  };
  const std::string letters = letters_of(text);
  for (const Spelling& spelling : kSpellings) {
    if (spelling.letters == letters) return spelling.unit;
  }
  return NamedUnit::none;
}

// ---- names ----

constexpr std::string_view kEast[] = {"easting", "eastings",   "east",      "e",      "rechtswert",
                                      "rechts",  "ostwert",    "ost",       "est",    "este",
                                      "utme",    "utmeasting", "eastcoord", "ecoord", "ecoordinate"};
constexpr std::string_view kNorth[] = {"northing",    "northings",  "north",  "n",          "hochwert",
                                       "hoch",        "nordwert",   "nord",   "norte",      "utmn",
                                       "utmnorthing", "northcoord", "ncoord", "ncoordinate"};
constexpr std::string_view kHeight[] = {"elevation",
                                        "elev",
                                        "height",
                                        "altitude",
                                        "alt",
                                        "h",
                                        "h\xC3\xB6he",
                                        "h\xC3\x96he",
                                        "h\xF6he",
                                        "h\xD6he",
                                        "hoehe",
                                        "hohe",
                                        "hauteur",
                                        "quota",
                                        "cota",
                                        "cote",
                                        "kote",
                                        "altezza",
                                        "altura",
                                        "hoogte",
                                        "hojd",
                                        "h\xC3\xB6jd",
                                        "rl",
                                        "reducedlevel",
                                        "elevaci\xC3\xB3n",
                                        "elevacion",
                                        "elevazione",
                                        "ellipsoidalheight",
                                        "ellipsoidheight",
                                        "orthometricheight",
                                        "orthoheight"};
constexpr std::string_view kLongitude[] = {"longitude", "lon", "long", "lng", "longitud", "longitudine"};
constexpr std::string_view kLatitude[] = {"latitude", "lat", "latitud", "latitudine"};

/// Words that go with an axis, in front of it or behind it.
constexpr std::string_view kAxisWords[] = {"coord", "coordinate", "coordinates", "coords", "koordinate", "koord",
                                           "pos",   "position",   "point",       "points", "wert",       "value",
                                           "val",   "location",   "loc",         "local",  "world",      "global",
                                           "utm",   "vertex",     "center",      "centre", "cartesian",  "xyz"};
/// Words before the number of a coordinate: ParaView's "Points:0".
constexpr std::string_view kVectorWords[] = {"points",   "point",      "coordinates", "coord",
                                             "position", "pointsmxyz", "xyz"};

/// Whether a name says that its column is the one along an axis: 'x', 'y' or 'z'.
bool is_axis(std::string_view letters, char axis) {
  if (letters.empty()) return false;
  if (letters == std::string_view(&axis, 1) || letters == std::string{'p', axis}) return true;
  if (letters.back() == axis && is_one_of(letters.substr(0, letters.size() - 1), kAxisWords)) return true;
  if (letters.front() == axis && is_one_of(letters.substr(1), kAxisWords)) return true;
  return letters.back() == static_cast<char>('0' + (axis - 'x')) &&
         is_one_of(letters.substr(0, letters.size() - 1), kVectorWords);
}

bool names_coordinate(std::string_view name) {
  const std::string letters = letters_of(name);
  return is_axis(letters, 'x') || is_axis(letters, 'y') || is_axis(letters, 'z') || is_one_of(letters, kEast) ||
         is_one_of(letters, kNorth) || is_one_of(letters, kHeight);
}

/// Splits "x_mm", "x / mm", "x in mm", "x mm" and "xmm" into name and unit.
void split_unit(std::string& name, std::string& unit) {
  if (!unit.empty() || name.size() < 2) return;
  const std::size_t at = name.find_last_of(" _/,\t");
  const std::size_t begin = at == std::string::npos ? 1 : at + 1;
  if (unit_named(name.substr(begin)) == NamedUnit::none) return;
  std::string base = name.substr(0, begin);
  const auto ends_between = [&] { return std::string_view(" _/,\t").find(base.back()) != std::string_view::npos; };
  while (!base.empty() && ends_between()) base.pop_back();
  if (base.ends_with(" in")) base.resize(base.size() - 3);
  if (!names_coordinate(base)) return;
  unit = name.substr(begin);
  name = base;
}

/// What a name may be read as: "x/easting" is both.
using Forms = std::vector<std::string>;

Forms forms_of(const std::string& name) {
  Forms forms{letters_of(name)};
  for (std::size_t begin = 0; name.find('/') != std::string::npos && begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    forms.push_back(letters_of(std::string_view(name).substr(begin, end - begin)));
    begin = end + 1;
  }
  return forms;
}

class Finder {
 public:
  explicit Finder(const std::vector<std::string>& names) {
    for (const std::string& name : names) forms_.push_back(forms_of(name));
  }
  /// The first column with a form that passes; -1 without any.
  template <typename Test>
  [[nodiscard]] int find_if(const Test& test) const {
    for (std::size_t k = 0; k < forms_.size(); ++k) {
      if (std::any_of(forms_[k].begin(), forms_[k].end(), test)) return static_cast<int>(k);
    }
    return -1;
  }
  /// By the words in their order.
  template <typename Words>
  [[nodiscard]] int find(const Words& words) const {
    for (const std::string_view word : words) {
      const int found = find_if([&](const std::string& form) { return form == word; });
      if (found >= 0) return found;
    }
    return -1;
  }
  [[nodiscard]] int find(std::initializer_list<std::string_view> words) const {
    return find<std::initializer_list<std::string_view>>(words);
  }
  [[nodiscard]] int axis(char axis) const {
    const int plain = find({std::string_view(&axis, 1)});
    return plain >= 0 ? plain : find_if([&](const std::string& form) { return is_axis(form, axis); });
  }
  template <typename Words>
  [[nodiscard]] bool is(int column, const Words& words) const {
    const Forms& forms = forms_[static_cast<std::size_t>(column)];
    return std::any_of(forms.begin(), forms.end(), [&](const std::string& form) { return is_one_of(form, words); });
  }
  /// Whether another column has the same name.
  [[nodiscard]] bool is_repeated(int column) const {
    return std::count(forms_.begin(), forms_.end(), forms_[static_cast<std::size_t>(column)]) > 1;
  }

 private:
  std::vector<Forms> forms_;
};

bool all_found(const std::array<int, 3>& columns) {
  return std::all_of(columns.begin(), columns.end(), [](int column) { return column >= 0; });
}

std::array<int, 3> coordinates(const Finder& finder) {
  const int height = finder.find(kHeight);
  const int z = finder.axis('z') >= 0 ? finder.axis('z') : height;
  const std::array<int, 3> axes = {finder.axis('x'), finder.axis('y'), z};
  if (all_found(axes) && finder.axis('z') >= 0) return axes;
  const std::array<int, 3> survey = {finder.find(kEast), finder.find(kNorth), z};
  if (all_found(survey)) return survey;
  if (all_found(axes)) return axes;
  return {finder.find(kLongitude), finder.find(kLatitude), z};
}

// ---- splitting ----

/// Whether a name is that of a place, of which brackets choose a coordinate.
bool is_vector(std::string_view name) {
  const std::string letters = letters_of(name);
  return letters == "p" || is_one_of(letters, kAxisWords);
}

/// Adds a name and what it says of its unit.
void add_name(TableHeader& header, std::string name) {
  trim(name);
  std::string unit;
  const std::size_t open = name.find_first_of("([{<");
  if (open != std::string::npos) {
    const std::size_t close = std::min(name.find_first_of(")]}>", open), name.size());
    unit = name.substr(open + 1, close - open - 1);
    trim(unit);
    const bool is_axis_number = unit.size() == 1 && std::string_view("xyz012").find(unit) != std::string_view::npos;
    if (is_axis_number && is_vector(name.substr(0, open))) {
      name.resize(open);  // "P[x]"
      name += unit;
      unit.clear();
    } else if (open > 0) {
      name.resize(open);
      trim(name);
    }
  }
  split_unit(name, unit);
  header.names.push_back(std::move(name));
  header.units.push_back(std::move(unit));
}

/// A line of a header, split at a separator (0: blanks).
TableHeader split(std::string_view line, char separator) {
  TableHeader header;
  header.separator = separator;
  std::string name;
  const auto keep = [&] {
    add_name(header, std::move(name));
    name.clear();
  };
  const std::string text = lower_case(line);
  bool quoted = false;
  int depth = 0;  // in brackets, where separators part nothing
  bool any = false;
  for (const char c : text) {
    if (c == '"') {
      quoted = !quoted;
      any = true;
      continue;
    }
    if (c == '(' || c == '[') ++depth;
    if ((c == ')' || c == ']') && depth > 0) --depth;
    const bool parts = !quoted && (separator == 0 ? is_blank(c) : c == separator);
    if (parts && (separator != 0 || depth == 0)) {
      if (separator != 0 || !name.empty() || any) keep();
      any = false;
    } else {
      name += c;
    }
  }
  if (!name.empty() || any || separator != 0) keep();
  return header;
}

/// Words that make one name of two: "point no.", "x coordinate", "x (m)".
bool belong_together(std::string_view first, std::string_view second) {
  constexpr std::string_view kThings[] = {"point", "pt", "pnt", "pts", "punkt", "pkt"};
  constexpr std::string_view kNumbers[] = {"no", "nr", "id", "number", "nummer", "num", "name"};
  constexpr std::string_view kAxes[] = {"x", "y", "z", "east", "north", "easting", "northing", "height", "elevation"};
  constexpr std::string_view kBefore[] = {"coord", "coordinate", "koordinate", "pos", "position", "local", "global"};
  const std::string a = letters_of(first);
  const std::string b = letters_of(second);
  return (is_one_of(a, kThings) && is_one_of(b, kNumbers)) || (is_one_of(a, kAxes) && is_one_of(b, kAxisWords)) ||
         (is_one_of(a, kBefore) && is_one_of(b, kAxes));
}

/// Units in brackets go to the name before them; with `join`, names whose words belong together become one.
void join_words(TableHeader& header, bool join) {
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (std::size_t k = 0; k < header.names.size(); ++k) {
    const std::string& name = header.names[k];
    const bool bracket = !name.empty() && (name.front() == '(' || name.front() == '[' || name.front() == '{');
    if (bracket && !names.empty()) {
      units.back() = header.units[k];
    } else if (join && !names.empty() && belong_together(names.back(), name)) {
      names.back() += " " + name;
      if (!header.units[k].empty()) units.back() = header.units[k];
    } else {
      names.push_back(name);
      units.push_back(header.units[k]);
    }
  }
  constexpr std::string_view kLabels[] = {"columns", "column", "fields", "field", "format", "variables", "cols"};
  if (names.size() > 3 && is_one_of(letters_of(names.front()), kLabels)) {
    names.erase(names.begin());
    units.erase(units.begin());
  }
  header.names = std::move(names);
  header.units = std::move(units);
}

bool is_prose(const std::vector<std::string>& words) {
  constexpr std::string_view kWords[] = {"the", "of",  "with",     "and", "is",   "are", "this", "file", "from",
                                         "by",  "for", "contains", "has", "have", "as",  "per",  "each", "to",
                                         "und", "mit", "der",      "die", "von",  "et",  "avec", "des"};
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return is_one_of(word, kWords); });
}

/// Takes "variables =", "columns:" and the like off; a column's own name stays.
std::string_view without_label(std::string_view line) {
  const std::size_t at = line.find_first_of(":=");
  if (at == std::string_view::npos || at + 1 >= line.size()) return line;
  const std::string_view label = line.substr(0, at);
  if (label.find_first_of(",;\t\"([") != std::string_view::npos) return line;
  if (line[at] == ':' && !is_blank(line[at + 1])) return line;
  const std::string letters = letters_of(lower_case(label));
  if (names_coordinate(letters)) return line;
  const std::ptrdiff_t blanks = std::count_if(label.begin(), label.end(), is_blank);
  if (letters.size() < 2 && line[at] == ':') return line;
  return blanks > 3 ? line : line.substr(at + 1);
}

}  // namespace

NamedColumns name_columns(const std::vector<std::string>& names, const std::vector<std::string>& units) {
  const Finder finder(names);
  NamedColumns named;
  const std::array<int, 3> found = coordinates(finder);
  if (!all_found(found)) return named;
  named.xyz = found;
  const auto unit = [&](int column) { return unit_named(units[static_cast<std::size_t>(column)]); };
  const auto is_degree = [&](int column) {
    return finder.is(column, kLongitude) || finder.is(column, kLatitude) || unit(column) == NamedUnit::degree;
  };
  named.degrees = is_degree(found[0]) && is_degree(found[1]);
  constexpr std::string_view kInitials[] = {"e", "n", "h"};
  named.by_initials =
      finder.is(found[0], kInitials) || finder.is(found[1], kInitials) || finder.is(found[2], kInitials);
  named.repeated = std::any_of(found.begin(), found.end(), [&](int column) { return finder.is_repeated(column); });
  const std::array<int, 3> colour = {finder.find({"red", "r", "rf", "colorr", "colourr", "rgbr", "diffusered"}),
                                     finder.find({"green", "g", "gf", "colorg", "colourg", "rgbg", "diffusegreen"}),
                                     finder.find({"blue", "b", "bf", "colorb", "colourb", "rgbb", "diffuseblue"})};
  if (all_found(colour)) named.colour = colour;
  named.intensity =
      finder.find({"intensity", "scalarintensity", "i", "reflectance", "reflectivity", "scalarreflectance"});
  const std::array<int, 3> normal = {finder.find({"nx", "normalx", "xnormal", "normals0", "normal0"}),
                                     finder.find({"ny", "normaly", "ynormal", "normals1", "normal1"}),
                                     finder.find({"nz", "normalz", "znormal", "normals2", "normal2"})};
  if (all_found(normal)) named.normal = normal;
  return named;
}

namespace {

/// Takes the signs of a comment off the front; `comment` tells whether there were any.
std::string_view without_comment_signs(std::string_view line, bool& comment) {
  std::string_view text = line;
  const auto is_sign = [&](char c) {
    return c == '#' || c == '/' || c == '%' || c == '!' || c == '*' ||
           (c == ';' && text.find(';', 1) == std::string_view::npos);
  };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  comment = false;
  while (!text.empty() && (is_sign(text.front()) || (comment && is_blank(text.front())))) {
    comment = true;
    text.remove_prefix(1);
  }
  return comment ? text : line;
}

}  // namespace

TableHeader parse_header(std::string_view line, bool join) {
  if (line.size() > kLongestHeader) return {};
  bool comment = false;
  const std::string_view text = without_label(without_comment_signs(line, comment));
  const bool gap = !line.empty() && is_blank(line.front());
  TableHeader best;
  for (const char separator : {'\t', ';', ',', '|', '\0'}) {
    if (separator != 0 && text.find(separator) == std::string_view::npos) continue;
    TableHeader header = split(text, separator);
    header.comment = comment;
    if (separator == 0) {
      header.gap = gap && !comment;
      header.prose = is_prose(header.names);
      join_words(header, join);
    }
    if (header.names.size() < 3) continue;
    header.columns = name_columns(header.names, header.units);
    if (header.columns.complete()) return header;
    if (best.names.empty()) best = std::move(header);
  }
  return best;
}

TableHeader header_of_lines(const std::vector<std::string_view>& lines) {
  TableHeader header;
  for (const std::string_view line : lines) {
    std::string name = lower_case(line.substr(0, kLongestHeader));
    std::erase(name, '"');
    add_name(header, std::move(name));
  }
  header.columns = name_columns(header.names, header.units);
  return header;
}

HeaderUnit unit_of(const TableHeader& header) {
  HeaderUnit result;
  NamedUnit first = NamedUnit::none;
  bool differ = false;
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string& text = header.units[static_cast<std::size_t>(header.columns.xyz[axis])];
    const NamedUnit unit = unit_named(text);
    if (unit == NamedUnit::none || unit == NamedUnit::degree) continue;
    if (unit == NamedUnit::unknown) result.unknown = text;
    if (first == NamedUnit::none) first = unit;
    differ = differ || unit != first;
    words += (words.empty() ? "" : ", ") + std::string(1, "xyz"[axis]) + " in " + text;
  }
  if (header.columns.degrees) return {};
  if (differ) result.several = words;
  constexpr std::pair<NamedUnit, LengthUnit> kLengths[] = {{NamedUnit::metre, LengthUnit::m},
                                                           {NamedUnit::centimetre, LengthUnit::cm},
                                                           {NamedUnit::millimetre, LengthUnit::mm},
                                                           {NamedUnit::foot, LengthUnit::ft},
                                                           {NamedUnit::us_foot, LengthUnit::us_ft}};
  for (const auto& [unit, length] : kLengths) {
    if (!differ && first == unit) result.unit = length;
  }
  return result;
}

bool add_units_row(std::string_view line, TableHeader& header) {
  if (line.size() > kLongestHeader) return false;
  bool comment = false;
  const std::string_view text = without_comment_signs(line, comment);
  for (const char separator : {header.separator, '\0'}) {
    TableHeader row = split(text, separator);
    if (row.names.size() != header.names.size()) continue;
    for (std::size_t k = 0; k < row.names.size(); ++k) {
      if (row.names[k].empty() || row.names[k].front() == '[' || row.names[k].front() == '(')
        row.names[k] = row.units[k];
    }
    const auto is_unit = [&](int column) {
      return unit_named(row.names[static_cast<std::size_t>(column)]) != NamedUnit::none;
    };
    if (!std::all_of(header.columns.xyz.begin(), header.columns.xyz.end(), is_unit)) continue;
    header.units = row.names;
    header.columns = name_columns(header.names, header.units);
    return true;
  }
  return false;
}

}  // namespace sparsha::pipeline

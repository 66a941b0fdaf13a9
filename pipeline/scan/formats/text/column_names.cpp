#include "pipeline/scan/formats/text/column_names.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "pipeline/scan/text.h"

namespace sparsha::pipeline {
namespace {

// Lists of words, the likeliest first. Names are compared by their letters.
constexpr std::string_view kEast =
    " easting eastings east e rechtswert rechts ostwert ost est este utme eutm utmeasting eastcoord ecoord "
    "ecoordinate ";
constexpr std::string_view kNorth =
    " northing northings north n hochwert hoch nordwert nord norte utmn nutm utmnorthing northcoord ncoord "
    "ncoordinate ";
constexpr std::string_view kHeight =
    " elevation elev height altitude alt h h\xC3\xB6he h\xC3\x96he h\xF6he h\xD6he hoehe hohe hauteur quota cota cote "
    "kote altezza altura hoogte hojd h\xC3\xB6jd rl reducedlevel elevaci\xC3\xB3n elevacion elevazione "
    "ellipsoidalheight "
    "ellipsoidheight orthometricheight orthoheight ortho zort orto hgt quotaslm ";
constexpr std::string_view kLongitude = " longitude lon long lng longitud longitudine ";
constexpr std::string_view kLatitude = " latitude lat latitud latitudine ";
/// Words that are no others': "est" may be "estimated", "long" a length.
constexpr std::string_view kSurelyEast = " easting eastings east rechtswert ostwert este eastcoord longitude ";
constexpr std::string_view kSurelyNorth = " northing northings north hochwert nordwert norte northcoord latitude ";
constexpr std::string_view kSurelyDegrees = " longitude lon lng longitud longitudine latitude latitud latitudine ";
/// What is no length along an axis: angles and distances of polar coordinates.
constexpr std::string_view kAngles =
    " theta phi hz v ha va az azimuth azimut azi zenith zen vertical horizontal bearing inclination polar pan tilt "
    "elevationangle winkel hzwinkel vwinkel ";
/// Angles where a distance stands beside them, else other things: "elevation" is a height as well.
constexpr std::string_view kAnglesBesideDistance =
    " alpha beta gamma elevation elev el ele lambda yaw pitch angle ang angle1 angle2 scanangle ";
constexpr std::string_view kPolarDistances =
    " range rho distance dist sd slopedistance slopedist slantrange slantdistance radius ";
/// What is measured at a place and is no place.
constexpr std::string_view kNoHeights =
    " intensity scalarintensity i reflectance reflectivity amplitude range distance time timestamp gpstime class "
    "classification label id nr red green blue r g b nx ny nz confidence quality ";
/// Words before the name of a survey's coordinate: "Grid Northing".
constexpr std::string_view kSystems = " grid ground local global site project map wgs84 ";

/// Words that go with an axis, in front of it or behind it.
constexpr std::string_view kAxisWords =
    " coord coordinate coordinates coords koordinate koord pos position point points wert value val location loc local "
    "world global utm vertex center centre cartesian field xyz ";
/// Words before the number of a coordinate: ParaView's "Points:0".
constexpr std::string_view kVectorWords = " points point coordinates coord position pointsmxyz xyz ";

/// Whether a name says that its column is the one along an axis: 'x', 'y' or 'z'.
bool is_axis(std::string_view letters, char axis) {
  if (letters.empty()) return false;
  if (letters == std::string_view(&axis, 1) || letters == std::string{'p', axis}) return true;
  if (letters.back() == axis && is_one_of(letters.substr(0, letters.size() - 1), kAxisWords)) return true;
  if (letters.front() == axis && is_one_of(letters.substr(1), kAxisWords)) return true;
  return letters.back() == static_cast<char>('0' + (axis - 'x')) &&
         is_one_of(letters.substr(0, letters.size() - 1), kVectorWords);
}

bool says_east(std::string_view word) { return is_one_of(word, kEast) || is_one_of(word, kLongitude); }
bool says_north(std::string_view word) { return is_one_of(word, kNorth) || is_one_of(word, kLatitude); }

/// The axis and the direction of a name that is both: "xnorth", "eastingx". Initials may be other words': "nx".
std::optional<std::pair<char, std::string_view>> axis_and_direction(std::string_view letters) {
  const auto is_direction = [](std::string_view word, char axis) {
    return (word.size() > 1 && (says_east(word) || says_north(word) || is_one_of(word, kHeight))) ||
           (word == "up" && axis == 'z');
  };
  if (letters.size() < 3) return std::nullopt;
  constexpr std::string_view kAxes = "xyz";
  const char front = letters.front(), back = letters.back();
  const std::string_view behind = letters.substr(1), before = letters.substr(0, letters.size() - 1);
  if (kAxes.find(front) != std::string_view::npos && is_direction(behind, front)) return {{front, behind}};
  if (kAxes.find(back) != std::string_view::npos && is_direction(before, back)) return {{back, before}};
  return std::nullopt;
}

/// "x" of "field.points0.x": the member of something that is a place. Normals, turns and speeds have such members, too.
std::string axis_of_member(std::string_view name) {
  const std::size_t dot = name.find_last_of('.');
  if (dot == std::string_view::npos || dot + 2 != name.size() || name.back() < 'x' || name.back() > 'z') return {};
  const std::size_t before = name.substr(0, dot).find_last_of('.');
  std::string_view owner = name.substr(0, dot).substr(before == std::string_view::npos ? 0 : before + 1);
  while (!owner.empty() && owner.back() >= '0' && owner.back() <= '9') owner.remove_suffix(1);
  return is_one_of(letters_of(owner), kAxisWords) ? std::string(1, name.back()) : std::string();
}

/// What a name may be read as: "x/easting" is both.
using Forms = std::vector<std::string>;

Forms forms_of(const std::string& name) {
  Forms forms{letters_of(name)};
  if (const std::size_t blank = name.find_first_of(" _"); blank != std::string::npos) {
    const std::string rest = letters_of(std::string_view(name).substr(blank));
    const bool survey = is_one_of(rest, kEast) || is_one_of(rest, kNorth) || is_one_of(rest, kHeight);
    if (survey && is_one_of(letters_of(std::string_view(name).substr(0, blank)), kSystems)) forms.push_back(rest);
  }
  const std::string letters = forms.front();
  if (const auto both = axis_and_direction(letters)) {
    forms.emplace_back(1, both->first);
    forms.emplace_back(both->second);
  }
  if (const std::string axis = axis_of_member(name); !axis.empty()) forms.push_back(axis);
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
  /// The first column, from one on, with a form that passes; -1 without any.
  template <typename Test>
  [[nodiscard]] int find_if(const Test& test, int from = 0) const {
    for (auto k = static_cast<std::size_t>(from); k < forms_.size(); ++k) {
      if (std::any_of(forms_[k].begin(), forms_[k].end(), test)) return static_cast<int>(k);
    }
    return -1;
  }
  /// By the words of a list in their order.
  [[nodiscard]] int find(std::string_view words) const {
    for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
      const int found = find_if([&](const std::string& form) { return form == word; });
      if (found >= 0) return found;
    }
    return -1;
  }
  [[nodiscard]] int axis(char axis) const {
    const auto whole = std::find_if(forms_.begin(), forms_.end(),
                                    [axis](const Forms& forms) { return forms.front() == std::string(1, axis); });
    if (whole != forms_.end()) return static_cast<int>(whole - forms_.begin());
    const int plain = find(std::string_view(&axis, 1));
    return plain >= 0 ? plain : find_if([&](const std::string& form) { return is_axis(form, axis); });
  }
  [[nodiscard]] bool is(int column, std::string_view words) const {
    return any(column, [&](const std::string& form) { return is_one_of(form, words); });
  }
  template <typename Test>
  [[nodiscard]] bool any(int column, const Test& test) const {
    const Forms& forms = forms_[static_cast<std::size_t>(column)];
    return std::any_of(forms.begin(), forms.end(), test);
  }
  /// A name that is nothing else.
  [[nodiscard]] bool is_plain(int column) const { return forms_[static_cast<std::size_t>(column)].size() == 1; }
  /// Whether another column has the same name.
  [[nodiscard]] bool is_repeated(int column) const {
    return std::count(forms_.begin(), forms_.end(), forms_[static_cast<std::size_t>(column)]) > 1;
  }

 private:
  std::vector<Forms> forms_;
};

/// Whether a name is that of an angle, perhaps with its unit: "azimuth_deg", "sphericalazimuth", "horizontalangle".
bool is_angle(std::string_view letters) {
  constexpr std::array<std::string_view, 7> kEnds = {"degrees", "degree", "deg", "gon", "grad", "rad", "angle"};
  constexpr std::array<std::string_view, 2> kFronts = {"spherical", "scan"};
  for (const std::string_view front : kFronts)
    if (letters.size() > front.size() && letters.starts_with(front)) letters.remove_prefix(front.size());
  if (is_one_of(letters, kAngles)) return true;
  for (const std::string_view end : kEnds)
    if (letters.size() > end.size() && letters.ends_with(end)) letters.remove_suffix(end.size());
  return is_one_of(letters, kAngles);
}

bool all_found(const std::array<int, 3>& columns) {
  return std::all_of(columns.begin(), columns.end(), [](int column) { return column >= 0; });
}

/// The columns of a second set of names of the axes; incomplete without one.
std::array<int, 3> other_axes(const Finder& finder, const std::array<int, 3>& taken) {
  const auto other = [&](std::size_t k) {
    return finder.find_if([&](const std::string& form) { return is_axis(form, "xyz"[k]); }, taken[k] + 1);
  };
  return {other(0), other(1), other(2)};
}

/// The columns of x, y and z, with x and y exchanged where their names say that x is north or y is east.
std::array<int, 3> turned(const Finder& finder, const std::array<int, 3>& axes) {
  const auto north = [&](int column) { return finder.any(column, says_north); };
  const auto east = [&](int column) { return finder.any(column, says_east); };
  const bool as_they_are = east(axes[0]) || north(axes[1]);
  const bool both = north(axes[0]) && east(axes[1]);
  const bool one = finder.is(axes[0], kSurelyNorth) || finder.is(axes[1], kSurelyEast);
  if (as_they_are || !(both || one)) return axes;
  return {axes[1], axes[0], axes[2]};
}

/// Where east and north stand beside each other and no height is known by its name, the column behind them, if its name
/// may be that of one: "north, east, up". Else incomplete.
std::array<int, 3> height_behind(const Finder& finder, const std::array<int, 3>& survey) {
  const auto [east, north, none] = survey;
  constexpr std::array<int, 3> kNone = {-1, -1, -1};
  if (east < 0 || north < 0 || std::abs(east - north) != 1) return kNone;
  const int behind = std::max(east, north) + 1;
  constexpr std::string_view kUps = " up u level z ";
  const auto is_height = [&](const std::string& form) {
    return is_one_of(form, kUps) || form.starts_with("elev") || form.starts_with("height") ||
           form.starts_with("hoehe") || form.starts_with("alt") || (form.size() > 1 && form.front() == 'z');
  };
  if (finder.find_if(is_height, behind) != behind || finder.find(" v ") >= 0) return kNone;
  return {east, north, behind};
}

/// The first set of axes with a number from `from` on: x1, y1 and z1; incomplete without one.
std::array<int, 3> numbered_axes(const Finder& finder, char from) {
  for (char digit = from; digit <= '9'; ++digit) {
    const auto column = [&](char axis) {
      return finder.find_if([&](const std::string& form) { return form == std::string{axis, digit}; });
    };
    const std::array<int, 3> set = {column('x'), column('y'), column('z')};
    if (all_found(set)) return set;
  }
  return {-1, -1, -1};
}

std::array<int, 3> coordinates(const Finder& finder) {
  const int height = finder.find(kHeight);
  const int z = finder.axis('z') >= 0 ? finder.axis('z') : height;
  const std::array<int, 3> axes = {finder.axis('x'), finder.axis('y'), z};
  if (all_found(axes) && finder.axis('z') >= 0) return turned(finder, axes);
  const std::array<int, 3> survey = {finder.find(kEast), finder.find(kNorth), z};
  if (all_found(survey)) return survey;
  if (all_found(axes)) return turned(finder, axes);
  if (const std::array<int, 3> up = height_behind(finder, survey); all_found(up)) return up;
  if (const std::array<int, 3> set = numbered_axes(finder, '0'); all_found(set)) return set;
  return {finder.find(kLongitude), finder.find(kLatitude), z};
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
    if (unit(column) == NamedUnit::degree) return true;
    return finder.is_plain(column) ? finder.is(column, kLongitude) || finder.is(column, kLatitude)
                                   : finder.is(column, kSurelyDegrees);
  };
  named.degrees = is_degree(found[0]) && is_degree(found[1]);
  named.exchanged = finder.is(found[0], " y ") && finder.is(found[1], " x ");
  constexpr std::string_view kInitials = " e n h ";
  const auto is_initial = [&](int column) { return finder.is(column, kInitials) && !finder.is(column, " x y z "); };
  named.by_initials = std::any_of(found.begin(), found.end(), is_initial);
  named.other_set = !finder.is(found[0], " x y ") && all_found(other_axes(finder, found));
  const std::array<int, 3> numbered = numbered_axes(finder, '0');
  if (found == numbered) {
    const std::string& name = names[static_cast<std::size_t>(found[0])];
    const char digit = letters_of(name).back();
    named.other_set =
        named.other_set || (digit < '9' && all_found(numbered_axes(finder, static_cast<char>(digit + 1))));
  }
  named.repeated = std::any_of(found.begin(), found.end(), [&](int column) { return finder.is_repeated(column); });
  const std::array<int, 3> colour = {finder.find("red r rf colorr colourr rgbr diffusered r1"),
                                     finder.find("green g gf colorg colourg rgbg diffusegreen g1"),
                                     finder.find("blue b bf colorb colourb rgbb diffuseblue b1")};
  if (all_found(colour)) named.colour = colour;
  named.intensity = finder.find("intensity scalarintensity i reflectance reflectivity scalarreflectance");
  const std::array<int, 3> normal = {finder.find("nx normalx xnormal normals0 normal0"),
                                     finder.find("ny normaly ynormal normals1 normal1"),
                                     finder.find("nz normalz znormal normals2 normal2")};
  if (all_found(normal)) named.normal = normal;
  return named;
}

NamedUnit unit_named(std::string_view text) {
  constexpr std::pair<NamedUnit, std::string_view> kSpellings[] = {
      {NamedUnit::metre, " m meter metre meters metres mtr metri metros "},
      {NamedUnit::centimetre, " cm centimeter centimetre centimeters centimetres "},
      {NamedUnit::millimetre, " mm millimeter millimetre millimeters millimetres "},
      {NamedUnit::foot, " ft feet foot ift intft internationalfeet internationalfoot "},
      {NamedUnit::us_foot, " usft ftus usfeet usfoot ussurveyfoot ussurveyfeet surveyfeet surveyfoot sft "},
      {NamedUnit::degree, " deg degree degrees dd \xC2\xB0 \xB0 "},
      {NamedUnit::unknown, " in inch inches km dm um \xC2\xB5m \xCE\xBCm nm yd px pixel "},
  };
  const std::string letters = letters_of(text);
  for (const auto& [unit, words] : kSpellings) {
    if (is_one_of(letters, words)) return unit;
  }
  return NamedUnit::none;
}

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

bool names_coordinate(std::string_view name) {
  const std::string letters = letters_of(name);
  return is_axis(letters, 'x') || is_axis(letters, 'y') || is_axis(letters, 'z') || is_one_of(letters, kEast) ||
         is_one_of(letters, kNorth) || is_one_of(letters, kHeight) || is_one_of(letters, kLongitude) ||
         is_one_of(letters, kLatitude) || axis_and_direction(letters);
}

bool names_direction(std::string_view word) {
  const std::string letters = letters_of(word);
  return says_east(letters) || says_north(letters) || is_one_of(letters, kHeight);
}

bool names_axis(std::string_view name) {
  const std::string letters = letters_of(name);
  return is_axis(letters, 'x') || is_axis(letters, 'y') || is_axis(letters, 'z');
}

std::string why_no_coordinates(const std::vector<std::string>& names, const std::vector<std::string>& units) {
  const Finder finder(names);
  // Beside places, angles are something that was measured there.
  const bool axes = finder.axis('x') >= 0 && finder.axis('y') >= 0;
  const bool survey = finder.find(kEast) >= 0 && finder.find(kNorth) >= 0;
  const bool place = axes || survey || (finder.find(kLongitude) >= 0 && finder.find(kLatitude) >= 0);
  std::string angles;
  std::size_t count = 0;
  const bool polar = finder.find(kPolarDistances) >= 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto column = static_cast<int>(k);
    const bool angle =
        !place && (finder.any(column, is_angle) || is_one_of(letters_of(units[k]), " deg rad gon grad ") ||
                   (polar && finder.is(column, kAnglesBesideDistance)));
    if (!angle) continue;
    angles += (angles.empty() ? "'" : ", '") + names[k] + "'";
    ++count;
  }
  if (count >= 2) return "angles " + angles + " in place of x, y and z";
  if (finder.axis('x') < 0 || finder.axis('y') < 0 || names.size() < 3) return {};
  for (std::size_t k = 0; k < 3; ++k) {
    if (finder.is(static_cast<int>(k), kNoHeights)) return "x and y and no z, but '" + names[k] + "'";
  }
  return {};
}

bool names_place(std::string_view name) {
  const std::string letters = letters_of(name);
  return letters == "p" || is_one_of(letters, kAxisWords);
}

bool belong_together(std::string_view first, std::string_view second) {
  constexpr std::string_view kThings = " point pt pnt pts punkt pkt ";
  constexpr std::string_view kNumbers = " no nr id number nummer num name ";
  constexpr std::string_view kAxes = " x y z east north easting northing height elevation ";
  constexpr std::string_view kBefore = " coord coordinate koordinate pos position local global ";
  const std::string a = letters_of(first);
  const std::string b = letters_of(second);
  return (is_one_of(a, kThings) && is_one_of(b, kNumbers)) || (is_one_of(a, kAxes) && is_one_of(b, kAxisWords)) ||
         (is_one_of(a, kBefore) && is_one_of(b, kAxes));
}

std::string letters_of(std::string_view name) {
  std::string result;
  for (const char c : name) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (letter || (static_cast<unsigned char>(c) & 0x80) != 0) result += c;
  }
  return result;
}

}  // namespace sparsha::pipeline

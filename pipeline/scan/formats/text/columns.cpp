#include "pipeline/scan/formats/text/columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "pipeline/scan/formats/text/column_shapes.h"

namespace sparsha::pipeline {
namespace {

int find(const std::vector<std::string>& names, const char* wanted) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  return found != names.end() ? static_cast<int>(found - names.begin()) : -1;
}

std::size_t index(int column) { return static_cast<std::size_t>(column); }

void set_normals(TableColumns& columns, int first) {
  columns.nx = first;
  columns.ny = first + 1;
  columns.nz = first + 2;
}

void set_colour(TableColumns& columns, int first) {
  columns.red = first;
  columns.green = first + 1;
  columns.blue = first + 2;
}

/// Not of a column of labels.
void set_intensity(TableColumns& columns, const std::vector<TableRow>& sample, int column) {
  const auto has_word = [&](const TableRow& row) { return row.has_word(column); };
  if (columns_of_numbers(sample)[index(column)] || std::none_of(sample.begin(), sample.end(), has_word))
    columns.intensity = column;
}

/// Says where the first three columns, taken as coordinates, look like something else.
void doubt_first_three(TableColumns& columns, const std::vector<TableRow>& sample) {
  const std::size_t usual = columns.usual;
  constexpr std::size_t kFewest = 16;
  if (sample.size() < kFewest || !are_rows_alike(sample, usual)) return;
  if (usual >= 6 && look_like_normals(sample, usual, 0) && !look_like_normals(sample, usual, 3)) {
    columns.warnings.emplace_back(
        "the first three columns are of length 1 in all rows, as normals are, and are taken as x, y and z; if the "
        "coordinates stand behind them, 'columns: [nx, ny, nz, x, y, z]' of the scan says so");
  } else if (usual >= 6 && look_like_bytes_as_shares(sample, usual, 0)) {
    columns.warnings.emplace_back(
        "the first three columns are steps of 1/255 from 0 to 1, as colours are, and are taken as x, y and z; if the "
        "coordinates stand behind them, 'columns: [red, green, blue, x, y, z]' of the scan says so");
  } else if (may_be_north_first(sample, 0, 1)) {
    columns.warnings.emplace_back(
        "the first column has the size of northings and the second that of eastings, and they are taken as x and y; if "
        "north stands first, 'columns: [y, x, z]' of the scan says so, else the object is mirrored");
  }
}

/// Whether normals stand behind the coordinates. Zeros and ones alone are normals where they never change, as those of
/// a floor, or stand before colours.
bool begins_with_normals(const std::vector<TableRow>& sample, std::size_t usual) {
  if (usual < 6 || !are_unit_vectors(sample, usual, 3)) return false;
  if (are_normals(sample, usual, 3)) return true;
  if (usual >= 9 && look_like_colours(sample, usual, 6) && !are_unit_vectors(sample, usual, 6)) return true;
  return usual == 6 && is_constant(sample, usual, 3) && is_constant(sample, usual, 4) && is_constant(sample, usual, 5);
}

/// What stands behind coordinates without names, as scanners' programs write it.
void guess_attributes(TableColumns& columns, const std::vector<TableRow>& sample, bool pts) {
  const std::size_t usual = columns.usual;
  const bool normals_behind_seven = usual >= 10 && are_normals(sample, usual, 7);
  const bool seven = usual == 7 || normals_behind_seven;
  const bool either = seven && look_like_colours(sample, usual, 3) && look_like_colours(sample, usual, 4);
  if (normals_behind_seven) set_normals(columns, 7);
  if (usual >= 7 && pts && look_like_colours(sample, usual, 4)) {
    set_colour(columns, 4);
    set_intensity(columns, sample, 3);
  } else if (begins_with_normals(sample, usual)) {
    set_normals(columns, 3);
    const bool first = usual >= 9 && look_like_colours(sample, usual, 6);
    const bool second = usual == 10 && look_like_colours(sample, usual, 7);
    if (first) set_colour(columns, 6);
    if (second) {
      if (!first) set_colour(columns, 7);
      set_intensity(columns, sample, first ? 9 : 6);
    }
    if (first && second) {
      columns.notes.emplace_back(
          "without a header columns 7 to 9 are taken as red, green and blue and column 10 as the intensity; if it is "
          "the "
          "other way round, 'columns: [x, y, z, nx, ny, nz, intensity, red, green, blue]' of the scan says so");
    }
  } else if ((usual == 7 || (usual == 10 && look_like_colours(sample, usual, 7))) && are_normals(sample, usual, 4)) {
    set_normals(columns, 4);
    set_intensity(columns, sample, 3);
    if (usual == 10) set_colour(columns, 7);
  } else if (either && is_constant(sample, usual, 3) && !is_constant(sample, usual, 4) &&
             !is_constant(sample, usual, 5) && !is_constant(sample, usual, 6)) {
    set_colour(columns, 4);
    set_intensity(columns, sample, 3);
    columns.notes.emplace_back(
        "without a header column 4, which never changes, is taken as the intensity and columns 5 to 7 as red, green "
        "and blue; if it is the other way round, 'columns: [x, y, z, red, green, blue, intensity]' of the scan says "
        "so");
  } else if (usual >= 6 && look_like_colours(sample, usual, 3)) {
    set_colour(columns, 3);
    if (seven) set_intensity(columns, sample, 6);
    if (either && !is_constant(sample, usual, 6)) {
      columns.notes.emplace_back(
          "without a header columns 4 to 6 are taken as red, green and blue and column 7 as the intensity; if it is "
          "the other way round, 'columns: [x, y, z, intensity, red, green, blue]' of the scan says so");
    }
    if (!seven && usual >= 9 && are_unit_vectors(sample, usual, 6)) set_normals(columns, 6);  // a measure may follow
  } else if (usual >= 7 && look_like_colours(sample, usual, 4)) {
    set_colour(columns, 4);
    set_intensity(columns, sample, 3);
  } else if (usual == 4) {
    set_intensity(columns, sample, 3);
  } else if (usual == 6 && look_like_words(sample, usual, 3)) {
    columns.warnings.emplace_back(
        "columns 4 to 6 hold whole numbers up to 65535, as colours of 16 bits are, and are not used; 'columns: [x, y, "
        "z, red, green, blue]' of the scan says that they are");
  }
}

/// Names for columns that have none.
void label_fields(TableColumns& columns) {
  const std::vector<std::string> words = columns.words();
  for (std::size_t i = columns.fields.size(); i < words.size(); ++i) {
    columns.fields.push_back(words[i] != "skip" ? words[i] : "column " + std::to_string(i + 1));
  }
}

/// Where COLMAP's names and rows have tracks, which are as long as they are.
void take_track(TableColumns& columns, int track) {
  columns.track = track;
  columns.fields.resize(std::max(columns.fields.size(), index(track) + 1));
  columns.fields[index(track)] = "track_length";
  columns.rows_vary = true;
}

std::array<int, 3> moved(const std::array<int, 3>& columns, int by) {
  return {columns[0] + by, columns[1] + by, columns[2] + by};
}

/// Those of the coordinates' columns that are none when they are moved.
std::vector<int> left_by_move(const std::array<int, 3>& columns, int by) {
  const std::array<int, 3> others = moved(columns, by);
  std::vector<int> left;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(left),
               [&](int column) { return std::find(others.begin(), others.end(), column) == others.end(); });
  return left;
}

std::string place_text(const TableColumns& columns) {
  return "columns " + std::to_string(columns.x + 1) + ", " + std::to_string(columns.y + 1) + " and " +
         std::to_string(columns.z + 1);
}

}  // namespace

std::size_t TableColumns::needed() const {
  const int coordinates = std::max({x, y, z});
  const int all = std::max({coordinates, red, green, blue, intensity});
  switch (by) {
    case TextTable::By::names:
      return index(coordinates) + 1;
    case TextTable::By::configuration:
      return index(std::max({all, nx, ny, nz})) + 1;
    default:
      return index(all) + 1;
  }
}

bool TableColumns::wants_numbers(std::size_t column) const {
  const std::array<int, 7> attributes = {red, green, blue, intensity, nx, ny, nz};
  return numbers[column] ||
         std::find(attributes.begin(), attributes.end(), static_cast<int>(column)) != attributes.end();
}

std::vector<std::string> TableColumns::words() const {
  std::vector<std::string> words(
      std::max(usual, index(std::max({x, y, z, red, green, blue, intensity, nx, ny, nz})) + 1), "skip");
  const std::pair<int, const char*> named[] = {
      {x, "x"},   {y, "y"},   {z, "z"},  {red, "red"}, {green, "green"}, {blue, "blue"}, {intensity, "intensity"},
      {nx, "nx"}, {ny, "ny"}, {nz, "nz"}};
  for (const auto& [column, word] : named) {
    if (column >= 0) words[index(column)] = word;
  }
  return words;
}

TableColumns configured_columns(const std::vector<std::string>& words, const std::vector<TableRow>& sample) {
  TableColumns columns;
  columns.by = TextTable::By::configuration;
  columns.rows_vary = true;
  columns.x = find(words, "x");
  columns.y = find(words, "y");
  columns.z = find(words, "z");
  columns.red = find(words, "red");
  columns.green = find(words, "green");
  columns.blue = find(words, "blue");
  columns.intensity = find(words, "intensity");
  columns.nx = find(words, "nx");
  columns.ny = find(words, "ny");
  columns.nz = find(words, "nz");
  columns.usual = std::max(usual_count(sample), columns.needed());
  label_fields(columns);
  columns.numbers = columns_of_numbers(sample);
  return columns;
}

bool hold_coordinates(const TableColumns& columns, const std::vector<TableRow>& sample) {
  return are_coordinates(sample, {columns.x, columns.y, columns.z}, 0.0);
}

std::optional<HeaderPlace> place_header(const TableHeader& header, const std::vector<TableRow>& sample, char separator,
                                        double damaged) {
  const std::size_t usual = usual_count(sample);
  const int more = static_cast<int>(usual) - static_cast<int>(header.names.size());
  const std::array<int, 3>& xyz = header.columns.xyz;
  const bool fits = are_coordinates(sample, xyz, damaged);
  HeaderPlace place;
  place.exact = more == 0;
  if (more == 0) return fits ? std::optional(place) : std::nullopt;
  if (header.prose) return std::nullopt;
  const bool alike = are_rows_alike(sample, usual);
  const bool fits_moved = alike && xyz[0] + more >= 0 && xyz[1] + more >= 0 && xyz[2] + more >= 0 &&
                          are_coordinates(sample, moved(xyz, more), damaged);
  // Tables of data frames give the column of row names no name.
  if (more == 1 && fits_moved &&
      ((header.gap && may_be_row_names(sample)) || counts_rows(sample, static_cast<std::size_t>(xyz[0])))) {
    place.shift = 1;
    return place;
  }
  // A sign before the first separator opens a comment.
  if (more == -1 && fits_moved && header.separator == ';' && header.names.front().empty()) {
    place.shift = -1;
    place.exact = true;
    return place;
  }
  const bool same_separator = header.separator == separator && separator != 0;
  if (fits) {
    const int first = std::min({xyz[0], xyz[1], xyz[2]});
    const auto names_row = [&](const TableRow& row) {
      for (int k = 0; k < first; ++k) {
        if (row.has_word(k)) return true;
      }
      return false;
    };
    place.ambiguous = more > 0 && !same_separator && fits_moved && std::any_of(sample.begin(), sample.end(), names_row);
    return place;
  }
  if (!fits_moved) return std::nullopt;
  // A few damaged rows are no reason to look for the coordinates in other columns.
  const bool damaged_rows = are_coordinates(sample, xyz, kDamagedRows);
  if (damaged_rows && !may_be_numbers_of_points(sample, left_by_move(xyz, more))) return std::nullopt;
  place.shift = more;
  return place;
}

TableColumns named_columns(const TableHeader& header, const HeaderPlace& place, const std::vector<TableRow>& sample) {
  TableColumns columns;
  const NamedColumns& named = header.columns;
  columns.by = TextTable::By::names;
  columns.usual = usual_count(sample);
  columns.degrees = named.degrees;
  const auto at = [&](int column) {
    const bool there =
        column >= 0 && column + place.shift >= 0 && column + place.shift < static_cast<int>(kMostColumns);
    return there ? column + place.shift : -1;
  };
  columns.x = at(named.xyz[0]);
  columns.y = at(named.xyz[1]);
  columns.z = at(named.xyz[2]);
  const auto three = [&](const std::array<int, 3>& from, int& a, int& b, int& c) {
    if (at(from[0]) < 0 || at(from[1]) < 0 || at(from[2]) < 0) return;
    a = at(from[0]);
    b = at(from[1]);
    c = at(from[2]);
  };
  three(named.colour, columns.red, columns.green, columns.blue);
  three(named.normal, columns.nx, columns.ny, columns.nz);
  columns.intensity = at(named.intensity);
  for (int k = 0; k < place.shift; ++k) columns.fields.push_back("column " + std::to_string(k + 1));
  const std::size_t left_out = place.shift < 0 ? index(-place.shift) : 0;
  for (std::size_t k = left_out; k < header.names.size(); ++k) {
    std::string name = header.names[k];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string letter(1, "xyz"[axis]);
      if (index(named.xyz[axis]) == k && name != letter) name += " (" + letter + ")";
    }
    columns.fields.push_back(name.empty() ? "column " + std::to_string(columns.fields.size() + 1) : name);
  }
  const bool alike = are_rows_alike(sample, columns.usual);
  columns.rows_vary = !alike;
  if (!alike) columns.usual = std::min(columns.usual, header.names.size());
  const bool in_place = columns.x == 0 && columns.y == 1 && columns.z == 2;
  if (in_place && header.names.size() == 3) guess_attributes(columns, sample, false);
  if (const int track = find(columns.fields, "track"); track > 0 && columns.fields.front() == "point3d_id")
    take_track(columns, track);
  label_fields(columns);
  if (!place.exact && columns.track < 0 && alike && !in_place && !header.gap) {
    columns.warnings.push_back("the header names " + std::to_string(header.names.size()) + " columns, the rows have " +
                               std::to_string(columns.usual) + "; x, y and z are taken from " + place_text(columns));
  } else if (named.by_initials) {
    const auto name = [&](std::size_t axis) { return "'" + header.names[index(named.xyz[axis])] + "'"; };
    columns.warnings.push_back("x, y and z are its columns " + name(0) + ", " + name(1) + " and " + name(2));
  }
  if (columns.red < 0) {
    for (const char* name : {"rgb", "rgba", "packedrgb", "rgbpacked", "packed_rgb", "rgb_packed", "color", "colour"}) {
      if (find(header.names, name) < 0) continue;
      columns.warnings.push_back("colours are in one column, '" + std::string(name) +
                                 "', and are not read; columns of their own for red, green and blue are");
      break;
    }
  }
  const bool plain = find(header.names, "qx") >= 0 && find(header.names, "qw") >= 0;
  if (plain || (find(header.names, "q_x") >= 0 && find(header.names, "q_w") >= 0)) {
    columns.warnings.emplace_back(
        "the header names a quaternion for each row, as of the path of a scanner: its places are taken as the points "
        "of a "
        "surface");
  }
  if (named.exchanged) {
    columns.warnings.push_back("the header says which of its x and y is north: x, to the east, is its column '" +
                               header.names[index(named.xyz[0])] + "', and y '" + header.names[index(named.xyz[1])] +
                               "'");
  }
  if (!named.exchanged && may_be_north_first(sample, columns.x, columns.y)) {
    columns.warnings.emplace_back(
        "x has the size of northings and y that of eastings, as where surveyors call north X; if they are that, "
        "'columns' of the scan with x and y exchanged says so, else the object is mirrored");
  }
  if (header.units[index(named.xyz[2])] == "down") {
    columns.warnings.emplace_back(
        "the header says that z points down, and z is taken as it is: hollows and raised places are exchanged; a "
        "'pose' of the scan with -1 for z turns it over");
  }
  if (named.other_set) {
    columns.warnings.push_back("the header names several sets of coordinates; " + place_text(columns) +
                               " are taken; if that is wrong, 'columns' of the scan names them");
  }
  columns.numbers = columns_of_numbers(sample);
  return columns;
}

TableColumns columns_by_position(const std::vector<TableRow>& sample, bool pts) {
  TableColumns columns;
  columns.usual = usual_count(sample);
  guess_attributes(columns, sample, pts);
  doubt_first_three(columns, sample);
  label_fields(columns);
  columns.numbers = columns_of_numbers(sample);
  return columns;
}

TableColumns guess_columns(const std::vector<TableRow>& sample, bool pts) {
  TableColumns columns = columns_by_position(sample, pts);
  const std::size_t usual = columns.usual;
  const bool points3d = look_like_points3d(sample);
  if (!points3d && !look_numbered(sample, usual)) return columns;
  columns = {};
  columns.usual = usual;
  columns.by = TextTable::By::shape;
  columns.x = 1;
  columns.y = 2;
  columns.z = 3;
  columns.rows_vary = points3d;
  columns.numbered = !points3d;
  if (points3d) {
    columns.usual = 8;
    set_colour(columns, 4);
    columns.fields = {"point3d_id", "x", "y", "z", "red", "green", "blue", "error"};
    take_track(columns, 8);
    columns.warnings.emplace_back("without a header it looks like COLMAP's points3D.txt, and is read as that");
  } else {
    const std::size_t numbers = leading_numbers(sample, usual);
    if (numbers >= 7 && !are_normals(sample, usual, 4)) {
      if (look_like_colours(sample, usual, 4)) set_colour(columns, 4);
      if (numbers == 8 && !columns.has_colour() && look_like_colours(sample, usual, 5)) {
        set_colour(columns, 5);
        columns.intensity = 4;
      }
    } else if (numbers >= 7) {
      set_normals(columns, 4);
    }
    columns.warnings.emplace_back(
        "without a header its first column counts the rows; x, y and z are taken from columns 2, 3 and 4; if that is "
        "wrong, 'columns' of the scan names them");
  }
  label_fields(columns);
  columns.numbers = columns_of_numbers(sample);
  return columns;
}

TableColumns columns_behind_indices(const std::vector<TableRow>& sample, std::size_t indices) {
  std::vector<TableRow> behind(sample);
  for (TableRow& row : behind) {
    std::shift_left(row.values.begin(), row.values.begin() + static_cast<std::ptrdiff_t>(row.count),
                    static_cast<std::ptrdiff_t>(indices));
    std::shift_left(row.words.begin(), row.words.begin() + static_cast<std::ptrdiff_t>(row.count),
                    static_cast<std::ptrdiff_t>(indices));
    row.count -= std::min(row.count, indices);
  }
  TableColumns columns = columns_by_position(behind, false);
  for (int* column : {&columns.x, &columns.y, &columns.z, &columns.red, &columns.green, &columns.blue,
                      &columns.intensity, &columns.nx, &columns.ny, &columns.nz}) {
    if (*column >= 0) *column += static_cast<int>(indices);
  }
  columns.usual += indices;
  columns.numbers = columns_of_numbers(sample);
  columns.by = TextTable::By::shape;
  columns.fields.clear();
  label_fields(columns);
  columns.warnings.push_back(
      "without a header its first two columns count along the rows and columns of a grid; x, y "
      "and z are taken from " +
      place_text(columns) + "; if that is wrong, 'columns' of the scan names them");
  return columns;
}

}  // namespace sparsha::pipeline

// What the first rows of a text table look like, whatever its columns are called.
#pragma once

#include <array>
#include <bitset>
#include <vector>

#include "pipeline/scan/formats/text/rows.h"

namespace sparsha::pipeline {

/// Columns of most rows; one that is empty in all of them comes from separators at the ends of lines.
[[nodiscard]] std::size_t usual_count(const std::vector<TableRow>& sample);

/// Columns in which half of the rows or more have numbers.
[[nodiscard]] std::bitset<kMostColumns> columns_of_numbers(const std::vector<TableRow>& sample);

/// True when all rows are of one length, but for an empty end.
[[nodiscard]] bool are_rows_alike(const std::vector<TableRow>& sample, std::size_t usual);

/// Three neighbouring columns that look like colours: whole numbers of a byte, or fractions of one.
[[nodiscard]] bool look_like_colours(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);

/// Whether three columns hold whole numbers up to 65535, each of them with more than 10 bits.
[[nodiscard]] bool look_like_words(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);

/// Whether three columns hold steps of 1/255 from 0 to 1.
[[nodiscard]] bool look_like_bytes_as_shares(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);

/// Whether a column holds the same value in all rows.
[[nodiscard]] bool is_constant(const std::vector<TableRow>& sample, std::size_t usual, std::size_t column);

/// Whether what is taken as x has the size of a northing, and what is taken as y that of an easting: of UTM, of
/// Gauss-Krueger with the zone's number or of the Swiss LV95, in metres.
[[nodiscard]] bool may_be_north_first(const std::vector<TableRow>& sample, int x, int y);

/// Unit vectors, not all of which point one way: as programs write normals behind coordinates.
/// Behind colours that are enough: a flat wall's normals may all have the same side.
[[nodiscard]] bool are_unit_vectors(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);
[[nodiscard]] bool look_like_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);

/// Unit vectors of which one at least has a fraction or a negative part: no colours from the corners of their cube.
[[nodiscard]] bool are_normals(const std::vector<TableRow>& sample, std::size_t usual, std::size_t first);

/// Numbers in every row before the first word of any.
[[nodiscard]] std::size_t leading_numbers(const std::vector<TableRow>& sample, std::size_t usual);

/// True when the values of a column rise by one from row to row.
[[nodiscard]] bool counts_rows(const std::vector<TableRow>& sample, std::size_t column);

/// True when the first column may be the names of rows in a data frame: rising whole numbers, or words.
[[nodiscard]] bool may_be_row_names(const std::vector<TableRow>& sample);

/// A number, then coordinates and nothing else, or colours or normals at their distance behind them. A surface whose x
/// counted its points would have one point on each line of its grid.
[[nodiscard]] bool look_numbered(const std::vector<TableRow>& sample, std::size_t usual);

/// COLMAP's points3D.txt without its comments: id, x, y, z, r, g, b, error, then pairs of whole numbers, two or more.
[[nodiscard]] bool look_like_points3d(const std::vector<TableRow>& sample);

/// How many whole columns, one to three, stand before three columns with fractions that are neither normals nor
/// colours, where the whole ones are no coordinates of a raster: 0 when all may be as it is. A single column counts
/// where its values go to and fro, as neither a raster's nor a scanner's lines do.
[[nodiscard]] std::size_t whole_before_fractions(const std::vector<TableRow>& sample, std::size_t usual);

/// A time that rises from row to row, a place and a unit quaternion, as programs write the path of a scanner.
[[nodiscard]] bool look_like_poses(const std::vector<TableRow>& sample, std::size_t usual);

/// True for eight columns and more whose values go on smoothly from each to the next: heights of a grid.
[[nodiscard]] bool looks_like_matrix(const std::vector<TableRow>& sample, std::size_t usual);

/// True for whole numbers, beside words of which one at least is more than a number with wrong characters: "1964",
/// "1965A". So points are numbered, and no coordinates are damaged.
[[nodiscard]] bool may_be_numbers_of_points(const std::vector<TableRow>& sample, const std::vector<int>& columns);

/// True when most rows have numbers in the three columns, and no larger share than `damaged` a word.
[[nodiscard]] bool are_coordinates(const std::vector<TableRow>& sample, const std::array<int, 3>& xyz, double damaged);

}  // namespace sparsha::pipeline

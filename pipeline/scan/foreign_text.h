// Kinds of text that are told by their form rather than by their first characters.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace sparsha::pipeline {

/// Lines of 80 characters with the section's letter and a number at their end: IGES.
[[nodiscard]] bool is_iges(std::string_view text);
/// Pairs of lines, a code and a value, the first pair that is no remark being 0 and SECTION: DXF.
[[nodiscard]] bool is_dxf(std::string_view text);
/// A line with the number of points and 2 or 3, then as many rows that begin with their number: Triangle's and TetGen's
/// .node.
[[nodiscard]] bool is_node_list(std::string_view text);
/// A line with the number of rows and of corners, then rows of their number and as many numbers of points, each once:
/// Triangle's and TetGen's .ele.
[[nodiscard]] bool is_element_list(std::string_view text);
/// Two rows or more of twelve numbers: the three rows of the matrix of a turn, each with a coordinate of a place behind
/// it.
[[nodiscard]] bool is_pose_list(std::string_view text);
/// Lines of keys, one of them `scans`.
[[nodiscard]] bool is_sparsha_config(std::string_view text);
/// Whether one of its lines begins with that.
[[nodiscard]] bool has_line(std::string_view text, std::string_view begin);
/// A line between bars above one of bars and dashes.
[[nodiscard]] bool is_markdown_table(std::string_view text);
/// Two lines a picture, the first with a number, a unit quaternion, three numbers, a number and a name: COLMAP's
/// images.txt.
[[nodiscard]] bool is_colmap_images(std::string_view text);
/// A number of lists, and for each its length and as many numbers of pictures, to the file's end: COLMAP's list of
/// which pictures show each point of a dense cloud (fused.ply.vis).
[[nodiscard]] bool is_colmap_visibility(std::string_view bytes);
/// A chunk 4D4D as long as the file, with a version or a mesh editor's chunk in it: 3DS.
[[nodiscard]] bool is_3ds(std::string_view bytes);
/// A Tecplot file whose first zone is of finite elements or holds a column behind the other: rows of its zones are not
/// points alone.
[[nodiscard]] bool is_tecplot_mesh(std::string_view text);
/// A list or an object of JSON, as far as its first characters tell.
[[nodiscard]] bool is_json(std::string_view text);
/// The same, where the first 64 kB hold all of those words.
[[nodiscard]] bool is_object_of_json(std::string_view text, std::initializer_list<std::string_view> words);
/// The name of the first element of XML or HTML, lower case, without its namespace; "!doctype html" counts as html.
/// Nothing for other texts; empty when there is none among the first 4096 characters.
[[nodiscard]] std::optional<std::string> first_element(std::string_view text);

/// What the encoding of a text is called that is neither ASCII nor UTF-8: "UTF-16" or "UTF-32", with a byte order mark
/// or, where most characters are ASCII, without; null for others.
[[nodiscard]] const char* wide_encoding(std::string_view bytes);

}  // namespace sparsha::pipeline

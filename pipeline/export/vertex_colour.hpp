// A vertex's colour as each format has it. 0xAABBGGRR; 0, which is no colour, becomes white: the formats have no other
// way to say so.
#pragma once

#include <cstdint>

#include "pipeline/export/output.hpp"

namespace sparsha::pipeline {

inline constexpr const char* kPlyColours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
void put_ply_colour(Output& output, std::uint32_t rgba);
/// Behind the place in a line that begins with `v`, without the line's end.
void print_obj_colour(Output& output, std::uint32_t rgba);
/// Four 16-bit numbers, of light: glTF's colours of vertices are not sRGB.
void put_glb_colour(Output& output, std::uint32_t rgba);

}  // namespace sparsha::pipeline

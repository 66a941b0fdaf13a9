#include "pipeline/export/vertex_colour.hpp"

#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t shown(std::uint32_t rgba) { return rgba == 0 ? 0xFFFFFFFFU : rgba; }

/// IEC 61966-2-1.
std::uint16_t light_of(std::uint32_t byte) {
  const double stored = byte / 255.0;
  const double light = stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535.0 * light));
}

}  // namespace

void put_ply_colour(Output& output, std::uint32_t rgba) {
  for (const unsigned shift : {0U, 8U, 16U}) output.put(static_cast<std::uint8_t>(shown(rgba) >> shift));
}

void print_obj_colour(Output& output, std::uint32_t rgba) {
  for (const unsigned shift : {0U, 8U, 16U}) output.print(" {:.4f}", (shown(rgba) >> shift & 0xFFU) / 255.0);
}

void put_glb_colour(Output& output, std::uint32_t rgba) {
  for (const unsigned shift : {0U, 8U, 16U}) output.put(light_of(shown(rgba) >> shift & 0xFFU));
  output.put(std::uint16_t{0xFFFF});
}

}  // namespace sparsha::pipeline

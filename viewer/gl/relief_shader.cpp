// The stone. Its light does not depend on where it is seen from: it is computed once into a texture (in linear RGB,
// encoded at the end), and the relief's own shader only looks it up. Without a graphics card that is the difference
// between 20 and 200 ms a picture. What a picture does not need is compiled out, as software renderers run both
// sides of every branch.
#include "viewer/gl/shaders.h"

namespace sparsha::viewer::gl {

const char* const kReliefVertex = R"(
uniform sampler2D heights;
uniform ivec2 nodes;          // nx, ny
uniform int stride;           // nodes between two vertices of the slab's sides
uniform vec2 corner;          // world x, y of node (0, 0)
uniform float spacing;        // world
uniform vec2 rise;            // world z of height 0, and world units per metre
uniform float floor_z;        // world z of the slab's underside
uniform mat4 projection;
out vec2 place;               // texture coordinates
out vec3 world;
#ifdef WALL                   // the slab's sides: two vertices for each border node
out vec3 wall_normal;
#endif

void main() {
  ivec2 node;
  bool low = false;
#ifdef WALL
  int k = gl_VertexID / 2;
  low = (gl_VertexID & 1) == 1;
  ivec2 last = nodes - 1;
  ivec2 cells = (last + stride - 1) / stride;
  if (k <= cells.x) { node = ivec2(k * stride, 0); wall_normal = vec3(0, -1, 0); }
  else if (k <= cells.x + 1 + cells.y) { node = ivec2(last.x, (k - cells.x - 1) * stride); wall_normal = vec3(1, 0, 0); }
  else if (k <= 2 * cells.x + cells.y + 2) { node = ivec2(last.x - (k - cells.x - cells.y - 2) * stride, last.y); wall_normal = vec3(0, 1, 0); }
  else { node = ivec2(0, last.y - (k - 2 * cells.x - cells.y - 3) * stride); wall_normal = vec3(-1, 0, 0); }
  node = clamp(node, ivec2(0), last);
#else
  int count = nodes.x * nodes.y;
  bool far = gl_VertexID >= count;   // the ground behind a depth step
  int id = far ? gl_VertexID - count : gl_VertexID;
  node = ivec2(id % nodes.x, id / nodes.x);
#endif
  vec2 both = texelFetch(heights, node, 0).rg;
#ifdef WALL
  float h = both.r;
#else
  float h = far ? both.g : both.r;
#endif
  world = vec3(corner + vec2(node) * spacing, low ? floor_z : rise.x + rise.y * h);
  place = (vec2(node) + 0.5) / vec2(nodes);
  gl_Position = projection * vec4(world, 1.0);
}
)";

const char* const kStoneLight = R"(
vec3 encode(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

// Encoded colour of a place that faces `normal`. `up`: out of the picture's plane; `light`: unit, towards the key light,
// of which the share `lit` comes here; `sky`, `ridge` (-1 to 1): sky light and curvature; `paint`: colour and whether there
// is one; `plain`: high contrast, no warm stone, more light and dark; `look`: 0 stone, 1 sky light alone, 3 even light.
vec3 stone_light(vec3 normal, vec3 up, vec3 light, float lit, float sky, float ridge, vec4 paint, bool painted,
                 bool plain, int look) {
  vec3 stone = vec3(0.52, 0.325, 0.185);
  if (plain) stone = vec3(0.46);
  // Grooves keep old dirt and shade: darker and redder; ridges are worn: lighter.
  vec3 albedo = ridge < 0.0 ? mix(stone, stone * vec3(0.50, 0.40, 0.34), -ridge)
                          : mix(stone, stone * vec3(1.30, 1.28, 1.22), ridge);
  if (plain) albedo = stone * (1.0 + (ridge < 0.0 ? 0.65 : 0.45) * ridge);
  if (painted) albedo = mix(vec3(0.20), paint.rgb, paint.a) * (1.0 + 0.25 * ridge);

  float facing = max(dot(normal, light), 0.0);
  // A little more contrast than Lambert's law: raking light is read by its shades.
  facing = mix(facing, facing * facing, 0.20);
  float open = sky * sky * sky, out_of = dot(normal, up);
  vec3 key = vec3(2.05, 1.70, 1.25) * facing * lit;
  vec3 fill = vec3(0.15, 0.20, 0.30) * open * (0.62 + 0.38 * out_of);
  vec3 opposite = normalize(dot(light, up) * up - light + 0.55 * up);
  vec3 side = vec3(0.13, 0.11, 0.09) * max(dot(normal, opposite), 0.0) * open;
  vec3 bounce = vec3(0.085, 0.05, 0.03) * (1.0 - open);
  if (painted) { key = key * 0.8 + 0.22 * lit; fill *= 1.35; }
  vec3 c = albedo * (key + fill + side + bounce);
  if (look == 1) c = albedo * vec3(1.62, 1.56, 1.46) * mix(0.10, 1.0, open) * (0.55 + 0.45 * out_of);
  if (look == 3) c = albedo * vec3(0.86, 0.82, 0.77) * (0.25 + 0.75 * out_of);
  // Highlights roll off instead of clipping.
  c = 1.22 * c * (1.0 + 0.40 * c) / (1.0 + c);
  c = mix(c, c * c * (3.0 - 2.0 * c), 0.35);
  return encode(c);
}

// Encoded brightness by the direction that the surface faces in the picture, as if lit by a lamp beside the camera;
// `n`: the normal along the camera's axes.
vec3 clay_light(vec3 n, float sky, vec3 clay) {
  vec3 lamp = normalize(vec3(-0.55, 0.60, 0.58));
  float wrapped = 0.5 + 0.5 * dot(n, lamp);
  float shine = pow(max(dot(n, normalize(lamp + vec3(0.0, 0.0, 1.0))), 0.0), 30.0);
  float rim = pow(1.0 - clamp(n.z, 0.0, 1.0), 3.0);
  vec3 c = clay * (0.03 + 1.05 * wrapped * wrapped * wrapped) * mix(0.35, 1.0, sky * sky) + 0.16 * shine + 0.07 * rim;
  return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2));
}
)";

const char* const kStoneFragment = R"(
uniform sampler2D slopes;
uniform sampler2D tones;      // sky light, curvature, known, filled
uniform sampler2D shadows;
uniform sampler2D paint;
uniform bool painted;
uniform bool plain;
uniform float relief_gain;    // slopes are lit as if this much steeper
uniform vec3 light;           // unit, towards the key light
uniform int look;
in vec2 place;
out vec4 colour;              // encoded; alpha: known

void main() {
  vec4 tone = textureLod(tones, place, 0.0);
  vec2 slope = textureLod(slopes, place, 0.0).rg * relief_gain;
  float lit = textureLod(shadows, place, 0.0).r;
  vec4 p = painted ? textureLod(paint, place, 0.0) : vec4(0.0);
  vec3 c = stone_light(normalize(vec3(-slope, 1.0)), vec3(0.0, 0.0, 1.0), light, lit, tone.r, 2.0 * tone.g - 1.0, p,
                       painted, plain, look);
  colour = vec4(c, tone.b);
}
)";

const char* const kReliefFragment = R"(
uniform sampler2D stone;      // lit colour, encoded; alpha: known
uniform sampler2D tones;
uniform bool plain;
uniform vec3 light;
uniform vec4 window;          // world x, y of two corners
uniform vec4 hole;            // a finer piece is drawn there
uniform float pixel;          // framebuffer pixels per pixel of the final picture
#ifdef WITH_SECTION
uniform vec4 section;         // what lies where dot(section.xyz, p) > section.w is left out
#endif
#ifdef WITH_CONTOUR
uniform sampler2D heights;
uniform ivec2 nodes;
uniform vec2 contour;         // height of line 0, lines per metre
#endif
#ifdef WITH_CLAY
uniform sampler2D slopes;
uniform sampler2D paint;
uniform bool painted;
uniform float relief_gain;
uniform vec3 right;           // the camera's axes
uniform vec3 up;
uniform vec3 back;
#endif
in vec2 place;
in vec3 world;
#ifdef WALL
in vec3 wall_normal;
#endif
out vec4 colour;

void main() {
#ifdef WITH_HOLE
  if (all(greaterThan(world.xy, hole.xy)) && all(lessThan(world.xy, hole.zw))) discard;
#endif
#ifdef WITH_SECTION
  if (dot(section.xyz, world) > section.w) discard;
#endif
  vec4 lit = texture(stone, place);
  vec3 c = lit.rgb;
#ifdef WITH_CLAY
  {
    vec3 normal = normalize(vec3(-texture(slopes, place).rg * relief_gain, 1.0));
    vec3 n = vec3(dot(normal, right), dot(normal, up), dot(normal, back));
    vec3 clay = painted ? texture(paint, place).rgb : plain ? vec3(0.60) : vec3(0.62, 0.37, 0.25);
    c = clay_light(n, texture(tones, place).r, clay);
  }
#endif
#ifdef WALL
  float facing = 0.25 + 0.75 * max(dot(wall_normal, light), 0.0);
  c = (plain ? vec3(0.55) : vec3(0.60, 0.46, 0.33)) * facing * mix(1.0, 0.45, clamp(-world.z * 5.0, 0.0, 1.0));
#endif
#ifdef WITH_UNKNOWN
#ifdef WITH_OUTLINE
  // A thin line beside what was measured.
  float away = (0.5 - lit.a) / max(fwidth(lit.a), 1e-5);
  if (lit.a < 0.5 && away > 1.6 * pixel) discard;
  if (lit.a < 0.5) c = plain ? vec3(1.0) : vec3(0.62, 0.58, 0.52);
#else
  if (lit.a < 0.5) discard;
#endif
#endif
#ifdef WITH_CONTOUR
  {
    // Heights between nodes, bilinear: as finely as they are known, however coarse the mesh.
    vec2 at = place * vec2(nodes) - 0.5;
    ivec2 cell = clamp(ivec2(floor(at)), ivec2(0), max(nodes - 2, ivec2(0)));
    vec2 share = clamp(at - vec2(cell), 0.0, 1.0);
    ivec2 beyond = min(cell + 1, nodes - 1);
    float height = mix(mix(texelFetch(heights, cell, 0).r, texelFetch(heights, ivec2(beyond.x, cell.y), 0).r, share.x),
                       mix(texelFetch(heights, ivec2(cell.x, beyond.y), 0).r, texelFetch(heights, beyond, 0).r, share.x),
                       share.y);
    float lines = (height - contour.x) * contour.y;
    float wide = max(length(vec2(dFdx(lines), dFdy(lines))), 1e-9);
    float nearest = round(lines);
    bool fifth = abs(nearest - 5.0 * round(nearest / 5.0)) < 0.5;
    float away = abs(lines - nearest) / (wide * pixel);
    float line = 1.0 - smoothstep(fifth ? 0.6 : 0.25, fifth ? 1.5 : 1.1, away);
    // None where lines would run into each other, on level ground, which is no line, and at the lowest height.
    line *= (fifth ? 0.85 : 0.55) * (1.0 - smoothstep(0.15, 0.40, wide * pixel / (fifth ? 5.0 : 1.0)));
    line *= step(0.5, abs(nearest)) * smoothstep(5e-5, 5e-4, wide * pixel);
    c = mix(c, plain ? vec3(1.0) : vec3(0.02, 0.05, 0.10), line);
  }
#endif
#ifdef WITH_FILLED
  {
    float filled = texture(tones, place).a;
    vec2 cell = fract(gl_FragCoord.xy / (8.0 * pixel)) - 0.5;
    float dot_share = smoothstep(0.24, 0.16, length(cell));
    if (filled > 0.4) c = mix(c, vec3(0.10, 0.50, 0.72), 0.35 + 0.50 * dot_share);
  }
#endif
#ifdef WITH_WINDOW
  {
    vec2 away = abs(world.xy - 0.5 * (window.xy + window.zw)) - 0.5 * (window.zw - window.xy);
    float outside = max(away.x, away.y);
    float width = max(length(vec2(dFdx(outside), dFdy(outside))), 1e-9);
    float share = clamp(outside / width + 0.5, 0.0, 1.0);
    float grey = dot(c, vec3(0.30, 0.59, 0.11));
    c = mix(c, mix(vec3(grey), c, 0.85) * 0.72, share);
    float line = 1.0 - smoothstep(1.0 * pixel, 1.8 * pixel, abs(outside) / width);
    c = mix(c, plain ? vec3(1.0, 1.0, 0.0) : vec3(1.0, 0.80, 0.44), line);
  }
#endif
  colour = vec4(c, 1.0);
}
)";

}  // namespace sparsha::viewer::gl

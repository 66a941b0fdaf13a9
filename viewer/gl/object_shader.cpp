// A whole object. Its light turns with the camera, so that every side is seen in it: it is computed pixel by pixel.
#include "viewer/gl/shaders.h"

namespace sparsha::viewer::gl {

const char* const kObjectVertex = R"(
uniform mat4 projection;
uniform mat4 object;          // of a vertex' place to the world's
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 facing;
layout(location = 2) in vec2 shades;   // sky light, curvature (0.5 flat)
layout(location = 3) in vec4 coat;     // encoded colour and whether there is one
out vec3 world;
out vec3 normal;
out vec2 tone;
out vec4 paint;
void main() {
  world = (object * vec4(position, 1.0)).xyz;
  normal = mat3(object) * facing;
  tone = shades;
  paint = coat;
  gl_Position = projection * vec4(world, 1.0);
}
)";

const char* const kObjectFragment = R"(
uniform vec3 eye;             // world; of a parallel view the direction to it
uniform bool parallel;
uniform vec3 light;           // unit, towards the key light
uniform vec3 right;           // the camera's axes
uniform vec3 up;
uniform vec3 back;
uniform bool painted;
uniform bool plain;
uniform int look;
uniform float pixel;          // framebuffer pixels per pixel of the final picture
#ifdef WITH_SECTION
uniform vec4 section;         // what lies where dot(section.xyz, p) > section.w is left out
#endif
#ifdef WITH_CONTOUR
uniform vec4 contour;         // world: the direction across the lines, and where line 0 is along it
uniform float contour_step;
#endif
in vec3 world;
in vec3 normal;
in vec2 tone;
in vec4 paint;
out vec4 colour;

vec3 decode(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }

void main() {
#ifdef WITH_SECTION
  if (dot(section.xyz, world) > section.w) discard;
#endif
  vec3 n = normalize(normal);
  vec4 coat = vec4(decode(paint.rgb), paint.a);
#ifdef WITH_CLAY
  vec3 clay = painted ? mix(vec3(0.20), coat.rgb, coat.a) : plain ? vec3(0.60) : vec3(0.62, 0.37, 0.25);
  vec3 c = clay_light(vec3(dot(n, right), dot(n, up), dot(n, back)), tone.x, clay);
#else
  vec3 c = stone_light(n, back, light, 1.0, tone.x, 2.0 * tone.y - 1.0, coat, painted, plain, look);
#endif
#ifdef WITH_CONTOUR
  {
    float lines = (dot(world, contour.xyz) - contour.w) / contour_step;
    float wide = max(length(vec2(dFdx(lines), dFdy(lines))), 1e-9);
    float nearest = round(lines);
    bool fifth = abs(nearest - 5.0 * round(nearest / 5.0)) < 0.5;
    float away = abs(lines - nearest) / (wide * pixel);
    float line = 1.0 - smoothstep(fifth ? 0.6 : 0.25, fifth ? 1.5 : 1.1, away);
    line *= (fifth ? 0.85 : 0.55) * (1.0 - smoothstep(0.15, 0.40, wide * pixel / (fifth ? 5.0 : 1.0)));
    c = mix(c, plain ? vec3(1.0) : vec3(0.02, 0.05, 0.10), line);
  }
#endif
  // Through a gap of the scan the inside is seen.
  float inside = smoothstep(0.10, 0.35, -dot(n, parallel ? eye : normalize(eye - world)));
  c = mix(c, plain ? vec3(0.16) : vec3(0.17, 0.15, 0.14), inside);
  colour = vec4(c, 1.0);
}
)";

}  // namespace sparsha::viewer::gl

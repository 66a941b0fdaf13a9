// Everything that is drawn around and over the stone.
#include "viewer/gl/shaders.h"

namespace sparsha::viewer::gl {

const char* const kVersion = "#version 330 core\n";

const char* const kWholeVertex = R"(#version 330 core
out vec2 place;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  place = 0.5 * p + 0.5;
  gl_Position = vec4(p, 0.9999, 1.0);
}
)";

const char* const kBackdropFragment = R"(#version 330 core
uniform vec3 upper;           // encoded
uniform vec3 lower;
in vec2 place;
out vec4 colour;
void main() {
  vec2 from = place - vec2(0.38, 0.62);
  float glow = exp(-2.2 * dot(from, from));
  vec3 c = mix(lower, upper, place.y) * (0.72 + 0.55 * glow);
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  colour = vec4(c + noise / 255.0, 1.0);
}
)";

const char* const kResolveFragment = R"(
uniform sampler2D source;     // twice as wide and high
out vec4 colour;
vec3 decode(vec3 c) { return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878); }
vec3 encode(vec3 c) { return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
#ifdef EYE_DOME               // `source` may be as wide and high as the picture, too
uniform sampler2D depths;
uniform int scale;            // 1 or 2
uniform int rings;
uniform vec2 depth;           // View::depth
uniform bool parallel;
uniform float relief;         // world: the depth of forms
float away(ivec2 p) {
  float z = 2.0 * texelFetch(depths, clamp(p, ivec2(0), textureSize(depths, 0) - 1), 0).r - 1.0;
  return parallel ? (depth.y - z) / depth.x : depth.y / (z + depth.x);
}
// How much deeper the place lies than the means of opposite neighbours: a slope makes no difference.
float shade(ivec2 p) {
  float here = away(p), sum = 0.0;
  for (int ring = 1; ring <= rings; ++ring) {
    int reach = scale * (3 * ring - 2);
    for (int k = 0; k < 4; ++k) {
      ivec2 by = reach * ivec2(k == 1 ? 0 : 1, k == 0 ? 0 : k == 3 ? -1 : 1);
      sum += clamp((here - 0.5 * (away(p + by) + away(p - by))) / relief, -0.012 * float(ring), 0.10);
    }
  }
  return exp2(-9.0 * sum / float(rings));
}
#endif
void main() {
#ifdef EYE_DOME
  ivec2 p = scale * ivec2(gl_FragCoord.xy);
  ivec2 q = p + scale - 1;
#else
  ivec2 p = 2 * ivec2(gl_FragCoord.xy);
  ivec2 q = p + 1;
#endif
  vec3 c = 0.25 * (decode(texelFetch(source, p, 0).rgb) + decode(texelFetch(source, ivec2(q.x, p.y), 0).rgb) +
                   decode(texelFetch(source, ivec2(p.x, q.y), 0).rgb) + decode(texelFetch(source, q, 0).rgb));
#ifdef EYE_DOME
  if (texelFetch(depths, p, 0).r < 0.9999) c *= shade(p);
#endif
  colour = vec4(encode(clamp(c, 0.0, 1.0)), 1.0);
}
)";

const char* const kSectionVertex = R"(#version 330 core
uniform mat4 projection;
layout(location = 0) in vec4 corner;   // world x y z, and the height of the surface above
out float below;                       // world, under the surface
void main() {
  below = corner.w - corner.z;
  gl_Position = projection * vec4(corner.xyz, 1.0);
}
)";

const char* const kSectionFragment = R"(#version 330 core
uniform float pixel;
uniform bool plain;
in float below;
out vec4 colour;
void main() {
  float stripe = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / (9.0 * pixel)) - 0.5);
  vec3 c = plain ? vec3(0.22) : vec3(0.36, 0.27, 0.20);
  c = mix(c, plain ? vec3(0.5) : vec3(0.50, 0.39, 0.30), smoothstep(0.40, 0.47, stripe));
  float edge = below / max(fwidth(below), 1e-9);
  c = mix(plain ? vec3(1.0, 1.0, 0.0) : vec3(1.0, 0.80, 0.44), c, smoothstep(1.6 * pixel, 2.4 * pixel, edge));
  colour = vec4(c, 1.0);
}
)";

const char* const kAnaglyphFragment = R"(#version 330 core
uniform sampler2D left;
uniform sampler2D right;
uniform vec2 origin;
uniform bool grey;
out vec4 colour;
vec3 decode(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 encode(vec3 c) { return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy - origin);
  vec3 l = decode(texelFetch(left, p, 0).rgb);
  vec3 r = decode(texelFetch(right, p, 0).rgb);
  if (grey) {
    // Hues that only one eye sees cause binocular rivalry.
    l = vec3(dot(l, vec3(0.2126, 0.7152, 0.0722)));
    r = vec3(dot(r, vec3(0.2126, 0.7152, 0.0722)));
  }
  vec3 c = vec3(dot(l, vec3(0.456100, 0.500484, 0.176381)) + dot(r, vec3(-0.043470, -0.087939, -0.001555)),
                dot(l, vec3(-0.040082, -0.037825, -0.015759)) + dot(r, vec3(0.378476, 0.733640, -0.018450)),
                dot(l, vec3(-0.015216, -0.020597, -0.005469)) + dot(r, vec3(-0.072153, -0.112961, 1.226400)));
  colour = vec4(encode(clamp(c, 0.0, 1.0)), 1.0);
}
)";

const char* const kRectVertex = R"(#version 330 core
uniform vec4 rect;            // pixels from the viewport's bottom left: x, y, width, height
uniform vec2 size;            // of the viewport
void main() {
  vec2 p = rect.xy + rect.zw * vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(2.0 * p / size - 1.0, 0.0, 1.0);
}
)";

const char* const kDecalFragment = R"(#version 330 core
uniform sampler2D depths;     // of the surface
uniform int depth_scale;      // its pixels per pixel
uniform vec2 origin;
uniform vec2 size;
uniform mat4 inverse_projection;
uniform vec3 hand;            // world: the ball's middle
uniform vec3 up;              // out of the stone
uniform vec3 touch;           // world: the proxy
uniform float radius;         // of the ball, world
uniform float press;          // 0 free, 1 strong contact
out vec4 colour;              // premultiplied
void main() {
  vec2 p = gl_FragCoord.xy - origin;
  float d = texelFetch(depths, ivec2(p * float(depth_scale)), 0).r;
  if (d >= 1.0) discard;
  vec4 w = inverse_projection * vec4(2.0 * p / size - 1.0, 2.0 * d - 1.0, 1.0);
  vec3 world = w.xyz / w.w;
  vec3 from = world - hand;
  float over = -dot(from, up);
  float above = max(over - radius, 0.0);
  float reach = radius * 1.05 + 0.12 * above;
  float far = length(from + over * up) / reach;
  float shade = 0.80 * exp(-1.3 * far * far * far) / (1.0 + 0.06 * above / radius);
  float ring = length(world - touch) / radius;
  float line = exp(-pow((ring - 2.35) * 3.4, 2.0));
  float glow = press * (0.90 * line + 0.30 * exp(-0.30 * ring * ring));
  colour = vec4(vec3(0.62, 0.93, 1.0) * glow, clamp(shade * (1.0 - glow) + 0.5 * glow, 0.0, 1.0));
}
)";

const char* const kBallFragment = R"(#version 330 core
uniform sampler2D depths;
uniform int depth_scale;
uniform vec2 origin;
uniform vec2 size;
uniform mat4 projection;
uniform mat4 inverse_projection;
uniform vec3 centre;          // world
uniform float radius;
uniform vec3 tint;            // linear
uniform float solid;          // 1 opaque
uniform vec3 light;
out vec4 colour;              // premultiplied
vec3 at(vec2 p, float z) {
  vec4 w = inverse_projection * vec4(2.0 * p / size - 1.0, z, 1.0);
  return w.xyz / w.w;
}
void main() {
  vec2 p = gl_FragCoord.xy - origin;
  vec3 from = at(p, -1.0);
  vec3 dir = normalize(at(p, 1.0) - from);
  vec3 beside = at(p + vec2(1.0, 0.0), -1.0);
  vec3 beside_dir = normalize(at(p + vec2(1.0, 0.0), 1.0) - beside);
  float along = dot(centre - from, dir);
  float off = length(from + along * dir - centre);
  float footprint = max(length(beside + along * beside_dir - from - along * dir), 1e-9);
  float cover = clamp((radius - off) / footprint + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  vec3 hit = from + (along - sqrt(max(radius * radius - off * off, 0.0))) * dir;
  vec3 normal = normalize(hit - centre);
  vec4 clip = projection * vec4(hit, 1.0);
  float depth = 0.5 * clip.z / clip.w + 0.5;
  float surface = texelFetch(depths, ivec2(p * float(depth_scale)), 0).r;
  float seen = depth <= surface ? 1.0 : 0.30;
  float facing = max(dot(normal, light), 0.0);
  vec3 reflected = reflect(dir, normal);
  float shine = pow(max(dot(reflected, light), 0.0), 48.0) + 0.25 * pow(max(dot(reflected, light), 0.0), 8.0);
  float rim = pow(1.0 - max(dot(normal, -dir), 0.0), 3.0);
  vec3 c = tint * (0.20 + 1.05 * facing + 0.25 * max(normal.z, 0.0)) + vec3(0.9) * shine + (tint * 0.5 + 0.12) * rim;
  c = clamp(c / (1.0 + 0.25 * c), 0.0, 1.0);
  float alpha = cover * seen * solid;
  colour = vec4(pow(c, vec3(1.0 / 2.2)) * alpha, alpha);
}
)";

const char* const kInkVertex = R"(#version 330 core
uniform vec2 size;
layout(location = 0) in vec2 position;   // pixels from the viewport's top left
layout(location = 1) in vec4 ink;        // encoded, not premultiplied
out vec4 shade;
void main() {
  shade = vec4(ink.rgb * ink.a, ink.a);
  gl_Position = vec4(2.0 * position.x / size.x - 1.0, 1.0 - 2.0 * position.y / size.y, 0.0, 1.0);
}
)";

const char* const kInkFragment = R"(#version 330 core
in vec4 shade;
out vec4 colour;
void main() { colour = shade; }
)";

}  // namespace sparsha::viewer::gl

#include "main_view/app/shading_glsl.hpp"

#include "common/gl/gpu_scene.hpp"

namespace sightline {
namespace {

const char* const k_vertex_body = R"(
layout(location = 1) uniform vec3 u_eye;
out vec3 v_from_eye;
out vec3 v_normal;
out vec2 v_uv;
flat out uint v_material;
flat out uint v_object;
void main() {
  // Relative to the eye while still at the vertices: the fragment's derivatives then stay exact close up, however far
  // the scene's origin is.
  v_from_eye = scene_position().xyz - u_eye;
  // The cofactor matrix carries normals through any linear map; its sign repairs mirrored ones.
  mat3 m = mat3(scene_from_object());
  mat3 cofactors = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
  v_normal = cofactors * in_normal * sign(determinant(m));
  v_uv = in_uv;
  v_material = in_material;
  v_object = in_object;
  gl_Position = clip_position();
}
)";

// Colours are linear until the last line.
const char* const k_sky_functions = R"(
const vec3 k_horizon = vec3(0.60, 0.71, 0.83);
vec3 sky_color(vec3 direction) {
  const vec3 zenith = vec3(0.10, 0.25, 0.56);
  const vec3 ground = vec3(0.20, 0.20, 0.19);
  float up = max(direction.y, 0.0);
  float down = clamp(-direction.y * 4.0, 0.0, 1.0);
  return mix(mix(k_horizon, zenith, up * (2.0 - up)), ground, down * (2.0 - down));
}
vec3 displayed(vec3 linear_color) {
  // Filmic curve after Narkowicz, "ACES Filmic Tone Mapping Curve", 2015; a gamma of 2 is near enough to sRGB's.
  vec3 x = linear_color * 0.62;
  return sqrt(clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0));
}
)";

const char* const k_fragment_inputs = R"(
in vec3 v_from_eye;
in vec3 v_normal;
in vec2 v_uv;
flat in uint v_material;
flat in uint v_object;
layout(location = 0) out vec4 out_color;
layout(location = 1) uniform vec3 u_eye;
layout(location = 2) uniform vec3 u_sun;
layout(location = 3) uniform float u_haze_per_m;
layout(location = 16) uniform vec4 u_light_position[4];
layout(location = 24) uniform vec4 u_light_color[4];
uniform int u_textured;
)";

// A software rasterizer executes both sides of every branch, so what a kind of scene does not need is left
// out when the program is made: STYLE is 0 for a thing, 1 for a building seen from within, 2 for a town.
const char* const k_pattern_functions = R"(
float finished(uint x) {
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return float(x >> 8) * (1.0 / 16777216.0);
}
const uvec3 k_primes = uvec3(0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du);
float hash(ivec3 cell) {
  uvec3 mixed = uvec3(cell) * k_primes;
  return finished(mixed.x ^ mixed.y ^ mixed.z);
}
// Noise that is random at whole coordinates and smooth between.
float value_noise(vec3 p) {
  vec3 cell = floor(p);
  vec3 f = p - cell;
  f = f * f * (3.0 - 2.0 * f);
  uvec3 low = uvec3(ivec3(cell)) * k_primes;
  uvec3 high = low + k_primes;
  uint ll = low.y ^ low.z, hl = high.y ^ low.z, lh = low.y ^ high.z, hh = high.y ^ high.z;
  vec4 left = vec4(finished(low.x ^ ll), finished(low.x ^ hl), finished(low.x ^ lh), finished(low.x ^ hh));
  vec4 right = vec4(finished(high.x ^ ll), finished(high.x ^ hl), finished(high.x ^ lh), finished(high.x ^ hh));
  vec4 x = mix(left, right, f.x);
  vec2 y = mix(x.xz, x.yw, f.y);
  return mix(y.x, y.y, f.z);
}
// Share of a pixel `pixel` wide around `x` that lies inside low..high of every unit cell: the exact box filter,
// as the difference of two integrals.
float integral(float x, float low, float high) {
  float cell = floor(x);
  return cell * (high - low) + clamp(x - cell - low, 0.0, high - low);
}
float covered(float x, float low, float high, float pixel) {
  float width = max(pixel, 0.004);
  return (integral(x + 0.5 * width, low, high) - integral(x - 0.5 * width, low, high)) / width;
}
// Which way a wall runs, and how far along it `position` lies. Directions are taken in steps of two degrees, or the
// rounding of a plane's normal would shake what lies kilometres from the origin.
float along_wall(vec3 position, vec3 normal) {
  const float step_rad = 0.034906585;
  float angle = round(atan(normal.x, normal.z) / step_rad) * step_rad;
  return position.x * cos(angle) - position.z * sin(angle);
}
vec3 patterned(vec3 color, vec3 position, vec3 normal, float pixel_m, out float glass) {
  glass = 0.0;
  float grain = value_noise(position * 19.0) - 0.5;
  color *= 1.0 + 0.13 * grain * clamp(1.4 - 19.0 * pixel_m, 0.0, 1.0);
#if STYLE == 0
  color *= 1.0 + 0.12 * (value_noise(position * 1.7) - 0.5);
#elif STYLE == 1
  // Floors and ceilings in tiles, walls in large blocks half a block apart.
  bool level = abs(normal.y) > 0.7;
  vec2 at = level ? position.xz / 0.6 : vec2(along_wall(position, normal) / 1.2, position.y / 0.6);
  vec2 pixel = vec2(pixel_m) / (level ? vec2(0.6) : vec2(1.2, 0.6));
  at.x += level ? 0.0 : 0.5 * mod(floor(at.y), 2.0);
  vec2 joint = level ? vec2(0.010) : vec2(0.004, 0.008);
  float inside = covered(at.x, joint.x, 1.0 - joint.x, pixel.x) * covered(at.y, joint.y, 1.0 - joint.y, pixel.y);
  float tile = hash(ivec3(floor(at), int(v_object)));
  float seen = clamp(1.5 - 3.0 * max(pixel.x, pixel.y), 0.0, 1.0);
  color *= mix(0.70, 1.0, inside) * (1.0 + (tile - 0.5) * (level ? 0.10 : 0.035) * seen);
#else
  if (normal.y > 0.3 && normal.y < 0.97) {
    // A pitched roof: tiles in courses, each house its own red or slate.
    float hue = finished(v_object * 2654435761u + 17u);
    vec3 tiles = mix(vec3(0.36, 0.17, 0.12), vec3(0.21, 0.21, 0.23), smoothstep(0.45, 0.55, hue));
    float course = covered(position.y / 0.18, 0.0, 0.8, pixel_m / 0.18);
    return tiles * mix(0.80, 1.08, course) * (1.0 + 0.2 * grain);
  }
  if (abs(normal.y) <= 0.3) {
    const vec2 cell_m = vec2(2.6, 3.1);
    vec2 wall = vec2(along_wall(position, normal), position.y);
    vec2 at = wall / cell_m;
    vec2 pixel = vec2(pixel_m) / cell_m;
    // Courses of brick, half a brick apart.
    vec2 brick = wall / vec2(0.42, 0.16);
    brick.x += 0.5 * mod(floor(brick.y), 2.0);
    float joint = 1.0 - covered(brick.x, 0.03, 0.97, pixel_m / 0.42) * covered(brick.y, 0.08, 0.92, pixel_m / 0.16);
    float tone = hash(ivec3(floor(brick), int(v_object))) - 0.5;
    float seen = clamp(1.2 - 9.0 * pixel_m, 0.0, 1.0);
    color *= (1.0 + 0.22 * tone * seen) * (1.0 + 0.35 * joint * seen);
    float window = covered(at.x, 0.25, 0.75, pixel.x) * covered(at.y, 0.30, 0.80, pixel.y);
    float frame = covered(at.x, 0.22, 0.78, pixel.x) * covered(at.y, 0.26, 0.83, pixel.y);
    float bar = covered(at.x, 0.48, 0.52, pixel.x) + covered(at.y, 0.60, 0.62, pixel.y);
    window *= 1.0 - clamp(bar, 0.0, 1.0);
    color = mix(color, vec3(0.72, 0.70, 0.66), frame - window);
    float room = hash(ivec3(floor(at), int(v_object)));
    glass = window;
    color = mix(color, mix(vec3(0.03, 0.04, 0.05), vec3(0.16, 0.13, 0.09), room * room), window);
  }
#endif
  return color;
}
)";

const char* const k_fragment_main = R"(
void main() {
  ALPHA_TEST
  vec3 position = u_eye + v_from_eye;
  float squared_distance = dot(v_from_eye, v_from_eye);
  vec3 to_eye = -v_from_eye * inversesqrt(squared_distance);
  vec3 across = dFdx(v_from_eye), down = dFdy(v_from_eye);
  float pixel_m = sqrt(0.5 * (dot(across, across) + dot(down, down)));

  // A file without normals gets the triangle's own plane, turned towards the eye.
  vec3 plane = cross(across, down);
  plane *= dot(plane, to_eye) < 0.0 ? -1.0 : 1.0;
  bool has_normal = dot(v_normal, v_normal) > 1e-20;
  vec3 normal = has_normal ? (gl_FrontFacing ? v_normal : -v_normal) : plane;
  float squared = dot(normal, normal);
  normal = squared > 0.0 ? normal * inversesqrt(squared) : to_eye;

  vec4 base = materials[v_material].base_color;
  float glass = 0.0;
  vec4 texel = texture(u_texture, v_uv);
  if (u_textured != 0) {
    base *= texel;
  } else {
    // Neighbours of one colour stay told apart.
    base.rgb *= 0.88 + 0.24 * finished(v_object * 2654435761u);
    base.rgb = patterned(base.rgb, position, normal, pixel_m, glass);
  }

  // Light from the sky above and from the ground below, the sun, and a lamp at the eye so that no corner is black.
  float facing_eye = max(dot(normal, to_eye), 0.0);
  vec3 mirrored = reflect(-to_eye, normal);
  vec3 light = mix(vec3(0.17, 0.16, 0.15), vec3(0.36, 0.41, 0.48), 0.5 + 0.5 * normal.y);
  light += SUN_LIGHT * max(dot(normal, u_sun), 0.0);
  light += 0.20 * facing_eye;
  float shine = max(dot(mirrored, u_sun), 0.0);
  shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  vec3 gloss = 0.5 * SUN_LIGHT * shine;
  for (int i = 0; i < 4; ++i) {
    vec3 offset = u_light_position[i].xyz - position;
    float squared_offset = dot(offset, offset);
    vec3 to_light = offset * inversesqrt(max(squared_offset, 1e-8));
    float fade = max(1.0 - squared_offset * u_light_position[i].w, 0.0);
    vec3 arriving = u_light_color[i].rgb * (fade * fade);
    light += arriving * max(dot(normal, to_light), 0.0);
    float spot = max(dot(mirrored, to_light), 0.0);
    spot *= spot; spot *= spot; spot *= spot; spot *= spot;
    gloss += arriving * spot;
  }
  vec3 color = base.rgb * light + 0.16 * gloss;

#if BLENDED || STYLE == 2
  float rim = 1.0 - facing_eye;
  rim *= rim * rim;
  vec3 reflected = sky_color(mirrored);
#endif
#if STYLE == 2
  color = mix(color, reflected, glass * (0.22 + 0.6 * rim));
#endif
#if BLENDED
  color += reflected * (0.06 + 0.4 * rim);
  base.a = mix(base.a, 1.0, 0.5 * rim);
#endif
#if STYLE == 2
  color = mix(k_horizon, color, exp(-u_haze_per_m * sqrt(squared_distance)));
#endif
  out_color = vec4(displayed(color), base.a);
}
)";

const char* const k_sky_vertex = R"(#version 450 core
out vec2 v_clip;
void main() {
  // One triangle over the image, at the depth of the background.
  v_clip = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(v_clip, 0.0, 1.0);
}
)";

const char* const k_sky_fragment_main = R"(
in vec2 v_clip;
layout(location = 0) out vec4 out_color;
layout(location = 5) uniform vec3 u_ray_center;
layout(location = 6) uniform vec3 u_ray_right;
layout(location = 7) uniform vec3 u_ray_up;
void main() {
  out_color = vec4(displayed(sky_color(normalize(u_ray_center + v_clip.x * u_ray_right + v_clip.y * u_ray_up))), 1.0);
}
)";

}  // namespace

std::string shading_vertex_glsl() {
  return std::string(gl::k_transform_glsl) + k_vertex_body;
}

std::string shading_fragment_glsl(SceneStyle style, bool masked, bool blended) {
  const auto define = [](const char* name, const std::string& value) {
    return std::string("#define ") + name + " " + value + "\n";
  };
  return std::string(gl::k_material_glsl) + define("STYLE", std::to_string(static_cast<int>(style))) +
         define("BLENDED", blended ? "1" : "0") +
         define("SUN_LIGHT",
                style == SceneStyle::building ? "vec3(0.55, 0.52, 0.47)" : "vec3(1.25, 1.16, 1.0)") +
         define("ALPHA_TEST", masked ? "if (!alpha_passes(v_uv, v_material)) discard;" : "") +
         k_fragment_inputs + k_sky_functions + k_pattern_functions + k_fragment_main;
}

std::string sky_vertex_glsl() {
  return k_sky_vertex;
}

std::string sky_fragment_glsl() {
  return std::string("#version 450 core\n") + k_sky_functions + k_sky_fragment_main;
}

}  // namespace sightline

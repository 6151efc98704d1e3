#pragma once
// Every shader of the renderer. Light is computed in view space (x right, y up, z towards the eye) and in linear light.

namespace seldinger::shaders {

// A triangle that covers the picture; no buffers needed.
inline constexpr const char* cover_vertex = R"(#version 450 core
out vec2 place;  // 0 ... 1, y up
void main()
{
    place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}
)";

inline constexpr const char* background_fragment = R"(#version 450 core
in vec2 place;
uniform vec3 top, bottom;
out vec4 colour;
void main() { colour = vec4(mix(bottom, top, smoothstep(0.0, 1.0, place.y)), 1.0); }
)";

inline constexpr const char* wall_vertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;  // into the lumen
layout(location = 2) in float value;  // 0 ... 1 of the wall's scale
uniform mat4 view, projection;
out vec3 view_position, view_normal;
out float share;
void main()
{
    vec4 p = view * vec4(position, 1.0);
    view_position = p.xyz;
    view_normal = mat3(view) * normal;
    share = value;
    gl_Position = projection * p;
}
)";

// The far wall, seen from inside the lumen: opaque. A key light from the upper left, a fill from the right, one at the eye.
// Grazing view darkens towards `deep`: the wall there lies between the eye and more wall, as in an ambient-occlusion pass.
inline constexpr const char* wall_fragment = R"(#version 450 core
in vec3 view_position, view_normal;
uniform vec3 tissue, deep;
out vec4 colour;
void main()
{
    vec3 n = normalize(view_normal), eye = normalize(-view_position);
    float facing = clamp(dot(n, eye), 0.0, 1.0);
    float key = max(dot(n, normalize(vec3(-0.55, 0.65, 0.55))), 0.0);
    float fill = max(dot(n, normalize(vec3(0.7, -0.1, 0.5))), 0.0);
    vec3 base = mix(deep, tissue, smoothstep(0.0, 0.95, facing));
    vec3 light = vec3(0.34) + 0.50 * key * vec3(1.0, 0.97, 0.92) + 0.16 * fill * vec3(0.85, 0.92, 1.0) + 0.24 * facing;
    vec3 half_way = normalize(eye + normalize(vec3(-0.55, 0.65, 0.55)));
    float sheen = 0.05 * pow(max(dot(n, half_way), 0.0), 24.0);
    colour = vec4(base * light + sheen, 1.0);
}
)";

// The same coloured by a quantity: shaded so little that its colours are the legend's. [wall_colour at even steps]
inline constexpr const char* coloured_fragment = R"(#version 450 core
in vec3 view_position, view_normal;
in float share;
uniform vec3 ramp[33];
out vec4 colour;
void main()
{
    vec3 n = normalize(view_normal), eye = normalize(-view_position);
    float facing = clamp(dot(n, eye), 0.0, 1.0), at = 32.0 * clamp(share, 0.0, 1.0);
    int step = min(int(at), 31);
    colour = vec4(mix(ramp[step], ramp[step + 1], at - step) * (0.62 + 0.38 * facing), 1.0);
}
)";

// The near wall coloured: where little happens it is glass, where much does it is stained. And, outline 1, the rim of where it
// was.
inline constexpr const char* stained_fragment = R"(#version 450 core
in vec3 view_position, view_normal;
in float share;
uniform vec3 ramp[33];
uniform vec3 line;
uniform float outline;
layout(location = 0) out vec4 sum;
layout(location = 1) out float cover;
void main()
{
    vec3 n = -normalize(view_normal), eye = normalize(-view_position);
    float facing = clamp(dot(n, eye), 0.0, 1.0), at = 32.0 * clamp(share, 0.0, 1.0);
    int step = min(int(at), 31);
    vec3 own = mix(ramp[step], ramp[step + 1], at - step) * (0.7 + 0.3 * facing);
    float rim = pow(1.0 - facing, 3.0), was = 0.75 * (1.0 - smoothstep(0.10, 0.30, facing));
    float alpha = mix(clamp(0.02 + 0.6 * clamp(share, 0.0, 1.0) + 0.35 * rim, 0.0, 0.9), was, outline);
    sum = vec4(alpha * mix(own, line, max(outline, 0.35 * rim)), alpha);
    cover = alpha;
}
)";

// The near wall: glass with a Fresnel rim (Schlick's power law on the view angle). Weighted blended transparency with equal
// weights [McGuire, Bavoil 2013, JCGT 2(2)]: sums and products, so the order of triangles does not matter.
inline constexpr const char* glass_fragment = R"(#version 450 core
in vec3 view_position, view_normal;
uniform vec3 glass;
layout(location = 0) out vec4 sum;        // sum of alpha * colour, and of alpha
layout(location = 1) out float cover;     // product of (1 - alpha) by blending
void main()
{
    vec3 n = -normalize(view_normal), eye = normalize(-view_position);
    float facing = clamp(dot(n, eye), 0.0, 1.0);
    float rim = pow(1.0 - facing, 3.0);
    vec3 half_way = normalize(eye + normalize(vec3(-0.55, 0.65, 0.55)));
    float glint = pow(max(dot(n, half_way), 0.0), 45.0);
    float alpha = clamp(0.05 + 0.85 * rim + 0.42 * glint, 0.0, 0.95);
    vec3 c = mix(glass * (0.8 + 0.2 * facing), vec3(1.0), glint / (glint + 0.15 + rim));
    sum = vec4(alpha * c, alpha);
    cover = alpha;
}
)";

// Wire, contacts and pins. Depth, and depth alone, is taken `pull` nearer to the eye.
inline constexpr const char* solid_vertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour_in;
layout(location = 3) in float pull;
uniform mat4 view, projection;
out vec3 view_position, view_normal, base;
void main()
{
    vec4 p = view * vec4(position, 1.0);
    view_position = p.xyz;
    view_normal = mat3(view) * normal;
    base = colour_in;
    gl_Position = projection * p;
    vec4 nearer = projection * vec4(p.xyz - normalize(p.xyz) * min(pull, 0.5 * length(p.xyz)), 1.0);
    gl_Position.z = nearer.z / nearer.w * gl_Position.w;
}
)";

inline constexpr const char* solid_fragment = R"(#version 450 core
in vec3 view_position, view_normal, base;
uniform float opacity;  // below 1: the ghost of what a wall hides
uniform float flat_share;  // 1: base colour as it is
out vec4 colour;
void main()
{
    vec3 n = normalize(view_normal), eye = normalize(-view_position);
    vec3 key_direction = normalize(vec3(-0.55, 0.65, 0.55));
    float facing = clamp(dot(n, eye), 0.0, 1.0);
    float key = max(dot(n, key_direction), 0.0);
    float shine = pow(max(dot(n, normalize(eye + key_direction)), 0.0), 40.0);
    vec3 lit = base * (0.45 + 0.40 * key + 0.30 * facing) + 0.35 * shine;
    colour = vec4(mix(lit, base, flat_share), opacity);
}
)";

// Glass over the solid picture, then sRGB, sample by sample. Averaging comes last, so that a dark edge on a light ground is as
// smooth as the reverse. (Averaged in linear light, the light side eats the dark one and thin dark lines look jagged.)
inline constexpr const char* compose_fragment = R"(#version 450 core
layout(binding = 0) uniform sampler2DMS solid;
layout(binding = 1) uniform sampler2DMS glass_sum;
layout(binding = 2) uniform sampler2DMS glass_through;
uniform int samples;
out vec4 colour;
vec3 encode(vec3 c)
{
    vec3 low = 12.92 * c, high = 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(c, vec3(0.0031308)));
}
void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 mean = vec3(0.0);
    for (int i = 0; i < samples; ++i) {
        vec4 sum = texelFetch(glass_sum, at, i);
        float through = texelFetch(glass_through, at, i).r;
        vec3 c = texelFetch(solid, at, i).rgb * through + sum.rgb / max(sum.a, 1e-4) * (1.0 - through);
        mean += encode(clamp(c, 0.0, 1.0));
    }
    colour = vec4(mean / float(samples), 1.0);
}
)";

}  // namespace seldinger::shaders

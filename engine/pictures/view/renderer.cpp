// The passes of a picture: far walls, wire and contacts, ghosts, near walls as glass, sheet, read-back, legend.
#include "view/renderer.h"

#include "core/check.h"
#include "core/error.h"
#include "view/egl_context.h"
#include "view/force_load.h"
#include "view/gl_objects.h"
#include "view/legend.h"
#include "view/shaders.h"
#include "view/solids.h"

#include <fmt/format.h>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace seldinger {
namespace {

constexpr int largest_side = 16384, smallest_side = 16;
constexpr int wanted_samples = 8;

/// One camera on one part of the sheet.
struct View {
    Camera camera;
    Viewport viewport;
    double nearest = 0;  // what is nearer to the eye is cut away [m]
    double farthest = 1;
    double mark_scale = 1;  // contacts are drawn this much larger
};

glm::vec3 to_glm(const Vec3& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}; }

constexpr GLsizei wall_stride = 7 * sizeof(float);
constexpr Attribute wall_attributes[] = {{0, 3, 0}, {1, 3, 3 * sizeof(float)}, {2, 1, 6 * sizeof(float)}};

double strongest(const WireFrame& frame)
{
    double force = 0;
    for (const ContactMark& c : frame.contacts) force = std::max(force, c.force);
    return force;
}

/// Smallest radius of several wires; 0: there is one.
double thinnest_radius(const WireFrame& frame)
{
    if (frame.wires.size() < 2) return 0;
    double radius = std::numeric_limits<double>::infinity();
    for (const WireLine& wire : frame.wires)
        if (!wire.radius.empty()) radius = std::min(radius, *std::min_element(wire.radius.begin(), wire.radius.end()));
    return radius;
}

void set_colour(GLuint program, const char* name, const Rgb& c)
{
    glProgramUniform3f(program, glGetUniformLocation(program, name), c.r, c.g, c.b);
}

void set_matrix(GLuint program, const char* name, const glm::mat4& m)
{
    glProgramUniformMatrix4fv(program, glGetUniformLocation(program, name), 1, GL_FALSE, glm::value_ptr(m));
}

void set_number(GLuint program, const char* name, float value)
{
    glProgramUniform1f(program, glGetUniformLocation(program, name), value);
}

}  // namespace

struct Renderer::Impl {
    int width, height;
    Look look;
    Layout layout;
    EglContext context;
    std::optional<Font> font;
    WallMesh mesh;
    Vec3 origin = Vec3::Zero();  // subtracted before coordinates become float
    bool aimed = false;
    Camera camera;
    double force_scale = 0;  // of the picture being drawn [N]; 0: it has no contact force
    std::vector<std::uint8_t> pixels;

    WallScale wall_scale;
    bool moved = false;  // the picture being drawn has a wall that has moved
    FrameLoads loads;    // of the picture being drawn

    GlName background, wall, glass, coloured, stained, solid, compose;  // programs
    GlName empty_vao, wall_vao, moved_vao, solid_vao, wall_vertices, moved_vertices, wall_indices;
    GlName solid_colour, glass_sum, glass_through, depth, solid_frame, glass_frame;  // several samples per pixel
    GlName sheet, sheet_frame;                                                       // one

    Impl(int w, int h, const Look& l) : width(w), height(h), look(l), layout(lay_out_sheet(w, h, l))
    {
        pixels.assign(3 * static_cast<std::size_t>(w) * h, 255);
        look.legend = look.legend && !layout.panel_dropped;
        if (look.legend) font.emplace();
        make_programs();
        make_targets();
    }
    ~Impl() { context.make_current(); }  // members delete their names after this

    void make_programs();
    void make_targets();
    void upload_wall();
    void upload_moved(const MovedWall& now);
    [[nodiscard]] View main_view() const;
    [[nodiscard]] std::optional<View> inset_view(const WireFrame& frame) const;
    std::vector<TubeStation> drawn_line(const WireFrame& frame, std::size_t k, const View& view, bool& widened) const;
    bool build_solids(const WireFrame& frame, const View& view, Solids& body, Solids& halo) const;
    [[nodiscard]] std::vector<Rgb> wire_colours(const WireFrame& frame, std::size_t k, std::size_t stations) const;
    void use(const View& view);
    void draw_background();
    bool draw_opaque(const WireFrame& frame, const std::vector<View>& views);
    void draw_glass(const std::vector<View>& views);
    void draw_solid_pass(const Solids& body, const Solids& halo);
    void draw_wall(const GlName& program, const GlName& vertices, GLenum culled);
    void compose_sheet();
    void read_back();
    void write_legend(const WireFrame& frame, const std::vector<View>& views, bool widened);
};

void Renderer::Impl::make_programs()
{
    background = make_program(shaders::cover_vertex, shaders::background_fragment);
    wall = make_program(shaders::wall_vertex, shaders::wall_fragment);
    glass = make_program(shaders::wall_vertex, shaders::glass_fragment);
    coloured = make_program(shaders::wall_vertex, shaders::coloured_fragment);
    stained = make_program(shaders::wall_vertex, shaders::stained_fragment);
    solid = make_program(shaders::solid_vertex, shaders::solid_fragment);
    compose = make_program(shaders::cover_vertex, shaders::compose_fragment);
    set_colour(background, "top", rgb_from_hex(look.background_top));
    set_colour(background, "bottom", rgb_from_hex(look.background_bottom));
    set_colour(wall, "tissue", rgb_from_hex(palette::tissue));
    set_colour(wall, "deep", rgb_from_hex(palette::tissue_deep));
    set_colour(glass, "glass", rgb_from_hex(palette::glass));
    set_colour(stained, "line", rgb_from_hex(palette::outline));
    for (int k = 0; k <= 32; ++k)
        for (const GlName* program : {&coloured, &stained})
            set_colour(*program, fmt::format("ramp[{}]", k).c_str(), wall_colour(k / 32.0));
    empty_vao = make_vertex_array();
    wall_vao = make_vertex_array();
    moved_vao = make_vertex_array();
    solid_vao = make_vertex_array();
}

void Renderer::Impl::make_targets()
{
    GLint most = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    const int samples = std::clamp<int>(most, 2, wanted_samples);  // OpenGL 4.5 promises 4
    solid_colour = make_target(GL_RGBA16F, width, height, samples);
    glass_sum = make_target(GL_RGBA16F, width, height, samples);
    glass_through = make_target(GL_R16F, width, height, samples);
    depth = make_target(GL_DEPTH_COMPONENT32F, width, height, samples);
    sheet = make_target(GL_RGBA8, width, height, 1);

    const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    solid_frame = make_framebuffer();
    glNamedFramebufferTexture(solid_frame, GL_COLOR_ATTACHMENT0, solid_colour, 0);
    glNamedFramebufferTexture(solid_frame, GL_DEPTH_ATTACHMENT, depth, 0);
    glass_frame = make_framebuffer();
    glNamedFramebufferTexture(glass_frame, GL_COLOR_ATTACHMENT0, glass_sum, 0);
    glNamedFramebufferTexture(glass_frame, GL_COLOR_ATTACHMENT1, glass_through, 0);
    glNamedFramebufferTexture(glass_frame, GL_DEPTH_ATTACHMENT, depth, 0);
    glNamedFramebufferDrawBuffers(glass_frame, 2, both);
    glProgramUniform1i(compose, glGetUniformLocation(compose, "samples"), samples);
    sheet_frame = make_framebuffer();
    glNamedFramebufferTexture(sheet_frame, GL_COLOR_ATTACHMENT0, sheet, 0);
    for (GLuint frame : {GLuint(solid_frame), GLuint(glass_frame), GLuint(sheet_frame)}) {
        if (glCheckNamedFramebufferStatus(frame, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            throw Error(ErrorKind::NoDevice,
                        fmt::format("{} cannot draw a picture of {} x {} with {} samples: try a smaller --size",
                                    context.renderer_name(), width, height, samples));
        }
    }
}

void Renderer::Impl::upload_wall()
{
    context.make_current();
    origin = Vec3::Zero();
    for (const Vec3& v : mesh.vertices) origin += v;
    if (!mesh.vertices.empty()) origin /= static_cast<double>(mesh.vertices.size());
    if (mesh.triangles.empty()) return;
    const std::vector<float> interleaved = interleaved_wall(mesh.vertices, mesh.triangles, {}, origin);
    wall_vertices = make_buffer(static_cast<GLsizeiptr>(interleaved.size() * sizeof(float)), interleaved.data());
    wall_indices = make_buffer(static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(mesh.triangles[0])), mesh.triangles.data());
    describe(wall_vao, wall_vertices, wall_stride, wall_attributes);
    glVertexArrayElementBuffer(wall_vao, wall_indices);
}

void Renderer::Impl::upload_moved(const MovedWall& now)
{
    moved = wall_scale.top > 0 && !now.vertices.empty() && !mesh.triangles.empty();
    if (!moved) return;
    SEL_ASSERT(now.vertices.size() == mesh.vertices.size() && now.value.size() == mesh.vertices.size());
    std::vector<float> share(now.value.size());
    for (std::size_t i = 0; i < share.size(); ++i) share[i] = static_cast<float>(now.value[i] / wall_scale.top);
    const std::vector<float> interleaved = interleaved_wall(now.vertices, mesh.triangles, share, origin);
    moved_vertices = make_buffer(static_cast<GLsizeiptr>(interleaved.size() * sizeof(float)), interleaved.data());
    describe(moved_vao, moved_vertices, wall_stride, wall_attributes);
    glVertexArrayElementBuffer(moved_vao, wall_indices);
}

View Renderer::Impl::main_view() const
{
    View view;
    view.camera = camera;
    view.viewport = layout.main;
    const double reach = (camera.target - camera.eye).norm();
    view.nearest = camera.nearest > 0 ? camera.nearest : 0.02 * reach;
    view.farthest = 4 * reach;
    return view;
}

/// The tip magnified so that the wire is 9 pixels (at 720 rows) wide, looking the same way. Tubes well in front are cut away.
std::optional<View> Renderer::Impl::inset_view(const WireFrame& frame) const
{
    if (!look.legend || !look.inset || frame.wires.empty() || frame.wires[0].nodes.size() < 2) return std::nullopt;
    const WireLine& wire = frame.wires[0];
    const double radius = *std::max_element(wire.radius.begin(), wire.radius.end());
    const Projected tip = project(camera, layout.main, wire.nodes[0]);
    const double main_scale = pixels_per_metre(camera, layout.main, tip.depth), wide = 9 * layout.unit;
    if (!(radius > 0) || !(tip.depth > 0) || 2 * radius * main_scale > 4 * layout.unit) return std::nullopt;

    const double side = std::min(2 * radius * layout.inset.height / wide, 0.5 * layout.main.height / main_scale);
    // centred between the tip and the point 1/3 of the view behind it, so that the shaft is seen too
    Vec3 behind = wire.nodes[0];
    double walked = 0;
    for (std::size_t i = 1; i < wire.nodes.size() && walked < side / 3; ++i) {
        walked += (wire.nodes[i] - wire.nodes[i - 1]).norm();
        behind = wire.nodes[i];
    }
    if (walked > side / 3) behind = wire.nodes[0] + (behind - wire.nodes[0]) * (side / 3 / walked);
    View view;
    view.camera = camera;
    view.camera.target = 0.5 * (wire.nodes[0] + behind);
    const double reach = 0.5 * side / std::tan(0.5 * camera.fov_y);
    view.camera.eye = view.camera.target - reach * camera.forward();
    view.viewport = layout.inset;
    view.nearest = std::max(reach - side, 0.1 * reach);
    view.farthest = reach + 20 * side;
    view.mark_scale = 1.8;
    return view;
}

/// A wire's own colour, or where it is coloured by load one for each station of its smooth line.
std::vector<Rgb> Renderer::Impl::wire_colours(const WireFrame& frame, std::size_t k, std::size_t stations) const
{
    const Rgb own = rgb_from_hex(instrument_colour(frame, k));
    std::vector<Rgb> colours(stations, own);
    if (!(look.load_scale > 0) || moved || loads.nodes.empty()) return colours;
    const std::vector<TubeStation> line = smooth_line(frame.wires[k].nodes, loads.nodes);  // its radius is the load
    for (std::size_t i = 0; i < stations; ++i) colours[i] = load_colour(load_share(line[i].radius, look.load_scale));
    return colours;
}

/// Metres that a pixel is wide at a point.
double pixel_at(const View& view, const Vec3& p)
{
    const double depth_there = project(view.camera, view.viewport, p).depth;
    return 1.0 / pixels_per_metre(view.camera, view.viewport, std::max(depth_there, view.nearest));
}

/// Wire k as it is drawn. @param widened  set when it is drawn wider than it is
std::vector<TubeStation> Renderer::Impl::drawn_line(const WireFrame& frame, std::size_t k, const View& view, bool& widened) const
{
    const WireLine& wire = frame.wires[k];
    const double thinnest = thinnest_radius(frame);
    std::vector<TubeStation> line = smooth_line(wire.nodes, wire.radius);
    for (TubeStation& s : line) {
        // a wire that is drawn wider still encloses its contents
        const double px = pixel_at(view, s.position), share = thinnest > 0 ? std::min(s.radius / thinnest, 3.0) : 1.0;
        const double least = 0.5 * look.least_pixels * px * share;
        widened = widened || s.radius < least;
        s.radius = std::max(s.radius, least);
        s.pull = 2.5 * s.radius + 2 * px;
    }
    return line;
}

/// @return true when a wire had to be drawn wider than it is
bool Renderer::Impl::build_solids(const WireFrame& frame, const View& view, Solids& body, Solids& halo) const
{
    body.clear(), halo.clear();
    bool widened = false;
    const double unit = std::max(layout.unit, 0.7);  // marks stay visible on small pictures
    const auto pixel = [&](const Vec3& p) { return pixel_at(view, p); };
    const auto grown = [](TubeStation s, double by) { return s.radius += by, s; };
    for (std::size_t k = 0; k < frame.wires.size(); ++k) {
        const std::vector<TubeStation> line = drawn_line(frame, k, view, widened);
        std::vector<TubeStation> outline;
        for (const TubeStation& s : line) outline.push_back(grown(s, 1.1 * unit * pixel(s.position)));
        add_tube(body, line, wire_colours(frame, k, line.size()), origin);
        add_tube(halo, outline, rgb_from_hex(palette::halo), origin);
    }
    const bool by_load = look.load_scale > 0 && !loads.contacts.empty();
    const double top = force_scale > 0 ? force_scale : 1;
    const std::vector<ContactMark> none;  // on a coloured wall
    for (const ContactMark& c : moved ? none : frame.contacts) {
        const double load = by_load ? loads.contacts[&c - frame.contacts.data()] : 0;
        const double share = by_load ? load_share(load, look.load_scale) : std::clamp(c.force / top, 0.0, 1.0);
        const double px = pixel(c.point) * unit * view.mark_scale;
        const Rgb colour = force_colour(share);
        const TubeStation ball = {c.point, (2.8 + 2.4 * share) * px, 12 * px};
        add_ball(body, ball, colour, origin);
        add_ball(halo, grown(ball, 0.8 * px / view.mark_scale), rgb_from_hex(palette::halo), origin);
        if (c.normal.squaredNorm() > 0) {
            const Vec3 end = c.point + (6 + 24 * share) * px * c.normal.normalized();
            add_cone(body, {c.point, 0.85 * ball.radius, ball.pull}, end, colour, origin);
            add_cone(halo, {c.point, 0.85 * ball.radius + 0.8 * px / view.mark_scale, ball.pull}, end,
                     rgb_from_hex(palette::halo), origin);
        }
    }
    return widened;
}

void Renderer::Impl::use(const View& view)
{
    const Viewport& v = view.viewport;
    glViewport(v.x, height - v.y - v.height, v.width, v.height);
    glScissor(v.x, height - v.y - v.height, v.width, v.height);
    const glm::mat4 look_at =
        glm::lookAt(to_glm(view.camera.eye - origin), to_glm(view.camera.target - origin), to_glm(view.camera.up));
    const glm::mat4 lens =
        glm::perspective(static_cast<float>(view.camera.fov_y), static_cast<float>(v.width) / static_cast<float>(v.height),
                         static_cast<float>(view.nearest), static_cast<float>(view.farthest));
    for (const GlName* program : {&wall, &glass, &coloured, &stained, &solid}) {
        set_matrix(*program, "view", look_at);
        set_matrix(*program, "projection", lens);
    }
}

void Renderer::Impl::draw_wall(const GlName& program, const GlName& vertices, GLenum culled)
{
    if (mesh.triangles.empty()) return;
    glEnable(GL_CULL_FACE);
    glCullFace(culled);
    glUseProgram(program);
    glBindVertexArray(vertices);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

/// Ghost of what the far walls hide, then the light outline (an inverted hull), then the bodies.
void Renderer::Impl::draw_solid_pass(const Solids& body, const Solids& halo)
{
    const Attribute attributes[] = {{0, 3, offsetof(SolidVertex, position)},
                                    {1, 3, offsetof(SolidVertex, normal)},
                                    {2, 3, offsetof(SolidVertex, colour)},
                                    {3, 1, offsetof(SolidVertex, pull)}};
    const auto draw_solids = [&](const Solids& s) {
        if (s.indices.empty()) return;
        const GlName vertices = make_buffer(static_cast<GLsizeiptr>(s.vertices.size() * sizeof(SolidVertex)), s.vertices.data());
        const GlName indices = make_buffer(static_cast<GLsizeiptr>(s.indices.size() * sizeof(s.indices[0])), s.indices.data());
        describe(solid_vao, vertices, sizeof(SolidVertex), attributes);
        glVertexArrayElementBuffer(solid_vao, indices);
        glBindVertexArray(solid_vao);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(s.indices.size()), GL_UNSIGNED_INT, nullptr);
    };
    glUseProgram(solid);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    set_number(solid, "opacity", 0.38f);
    set_number(solid, "flat_share", 0.0f);
    draw_solids(body);
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    set_number(solid, "opacity", 1.0f);
    set_number(solid, "flat_share", 1.0f);
    glCullFace(GL_FRONT);
    draw_solids(halo);
    set_number(solid, "flat_share", 0.0f);
    glCullFace(GL_BACK);
    draw_solids(body);
}

void Renderer::Impl::draw_background()
{
    glBindFramebuffer(GL_FRAMEBUFFER, solid_frame);
    glViewport(0, 0, width, height);
    glEnable(GL_MULTISAMPLE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    glUseProgram(background);
    glBindVertexArray(empty_vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

/// Far walls, then wire and contacts. @return true when a wire of the main view had to be drawn wider than it is
bool Renderer::Impl::draw_opaque(const WireFrame& frame, const std::vector<View>& views)
{
    bool widened = false;
    Solids body, halo;
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    for (const View& view : views) {
        use(view);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        draw_wall(moved ? coloured : wall, moved ? moved_vao : wall_vao, GL_BACK);
        const bool wider = build_solids(frame, view, body, halo);
        if (&view == &views.front()) widened = wider;
        draw_solid_pass(body, halo);
    }
    return widened;
}

/// Near walls, tested against the depth of opaque objects but hiding nothing of each other.
void Renderer::Impl::draw_glass(const std::vector<View>& views)
{
    const float nothing[] = {0, 0, 0, 0}, all[] = {1, 1, 1, 1};
    glBindFramebuffer(GL_FRAMEBUFFER, glass_frame);
    glDisable(GL_SCISSOR_TEST);
    glClearNamedFramebufferfv(glass_frame, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(glass_frame, GL_COLOR, 1, all);
    glEnable(GL_SCISSOR_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunci(0, GL_ONE, GL_ONE);
    glBlendFunci(1, GL_ZERO, GL_ONE_MINUS_SRC_COLOR);
    for (const View& view : views) {
        use(view);
        if (!moved) {
            draw_wall(glass, wall_vao, GL_FRONT);
            continue;
        }
        set_number(stained, "outline", 0.0f);
        draw_wall(stained, moved_vao, GL_FRONT);
        set_number(stained, "outline", 1.0f);
        draw_wall(stained, wall_vao, GL_FRONT);
    }
}

void Renderer::Impl::compose_sheet()
{
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_FRAMEBUFFER, sheet_frame);
    glViewport(0, 0, width, height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glUseProgram(compose);
    glBindTextureUnit(0, solid_colour);
    glBindTextureUnit(1, glass_sum);
    glBindTextureUnit(2, glass_through);
    glBindVertexArray(empty_vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::Impl::read_back()
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, sheet_frame);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
    const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(width);  // OpenGL's row 0 is the bottom
    for (int y = 0; y < height / 2; ++y) {
        std::swap_ranges(pixels.begin() + y * row, pixels.begin() + (y + 1) * row, pixels.begin() + (height - 1 - y) * row);
    }
}

void Renderer::Impl::write_legend(const WireFrame& frame, const std::vector<View>& views, bool widened)
{
    LegendFacts facts;
    facts.frame = &frame;
    facts.layout = layout;
    facts.main_camera = camera;
    facts.inset = views.size() > 1;
    if (facts.inset) facts.inset_camera = views[1].camera;
    facts.force_scale = moved ? 0 : force_scale;
    facts.load_scale = moved ? 0 : look.load_scale;
    facts.ruler = look.ruler;
    if (look.target) facts.target = &*look.target;
    if (look.cube) facts.cube = {look.back.cross(look.head), look.back, look.head};
    if (moved) facts.wall_scale = wall_scale;
    facts.least_pixels = look.least_pixels;
    facts.widened = widened;
    Canvas canvas(pixels, width, height);
    draw_legend(canvas, *font, facts);
}

Renderer::Renderer(int width, int height, const Look& look)
{
    if (std::min(width, height) < smallest_side || std::max(width, height) > largest_side) {
        throw Error(ErrorKind::BadScene,
                    fmt::format("--size {}x{}: both must be {} to {} pixels", width, height, smallest_side, largest_side));
    }
    impl_ = std::make_unique<Impl>(width, height, look);
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::set_wall(const WallMesh& mesh)
{
    impl_->mesh = mesh;
    impl_->aimed = false;
    impl_->upload_wall();
}

void Renderer::set_camera(const Camera& camera)
{
    impl_->camera = camera;
    impl_->aimed = true;
}

void Renderer::aim(const std::vector<Vec3>& points)
{
    const Viewport& main = impl_->layout.main;
    set_camera(automatic_camera(impl_->mesh, points, static_cast<double>(main.width) / main.height));
}

const Camera& Renderer::camera() const { return impl_->camera; }
const Viewport& Renderer::main_view() const { return impl_->layout.main; }
std::vector<std::vector<TubeStation>> Renderer::drawn_lines(const WireFrame& frame) const
{
    std::vector<std::vector<TubeStation>> lines;
    bool widened = false;
    for (std::size_t k = 0; k < frame.wires.size(); ++k)
        lines.push_back(impl_->drawn_line(frame, k, impl_->main_view(), widened));
    return lines;
}
void Renderer::set_force_scale(double newton) { impl_->look.force_scale = newton; }
void Renderer::set_background(std::uint32_t top, std::uint32_t bottom)
{
    impl_->context.make_current();
    set_colour(impl_->background, "top", rgb_from_hex(top));
    set_colour(impl_->background, "bottom", rgb_from_hex(bottom));
}
void Renderer::set_wall_scale(const WallScale& scale) { impl_->wall_scale = scale; }
const std::vector<std::uint8_t>& Renderer::pixels() const { return impl_->pixels; }
int Renderer::width() const { return impl_->width; }
int Renderer::height() const { return impl_->height; }
void Renderer::release() { impl_->context.release(); }
std::string Renderer::device_name() const { return impl_->context.renderer_name(); }

void Renderer::draw(const WireFrame& frame)
{
    Impl& r = *impl_;
    r.context.make_current();
    if (!r.aimed) {
        std::vector<Vec3> points;
        for (const WireLine& wire : frame.wires) points.insert(points.end(), wire.nodes.begin(), wire.nodes.end());
        aim(points);
    }
    r.force_scale = r.look.force_scale;
    if (!(r.force_scale > 0)) r.force_scale = strongest(frame) > 0 ? round_force_up(strongest(frame)) : 0;

    r.loads = r.look.load_scale > 0 ? loads_of(frame) : FrameLoads{};
    r.upload_moved(frame.wall);
    std::vector<View> views = {r.main_view()};
    if (const auto inset = r.inset_view(frame)) views.push_back(*inset);
    r.draw_background();
    const bool widened = r.draw_opaque(frame, views);
    r.draw_glass(views);
    r.compose_sheet();
    r.read_back();
    if (r.look.legend) r.write_legend(frame, views, widened);
}

}  // namespace seldinger

#pragma once
// OpenGL names that delete themselves, and the few ways this renderer makes them. The owner's context must be current.

#include <epoxy/gl.h>

#include <span>
#include <utility>

namespace seldinger {

/// Owns one OpenGL name.
class GlName {
public:
    GlName() = default;
    GlName(GLuint id, void (*destroy)(GLuint)) : id_(id), destroy_(destroy) {}
    ~GlName()
    {
        if (id_ != 0) destroy_(id_);
    }
    GlName(GlName&& other) noexcept : id_(std::exchange(other.id_, 0)), destroy_(other.destroy_) {}
    GlName& operator=(GlName&& other) noexcept
    {
        std::swap(id_, other.id_);
        std::swap(destroy_, other.destroy_);
        return *this;
    }
    operator GLuint() const { return id_; }  // NOLINT: an OpenGL name is an integer

private:
    GLuint id_ = 0;
    void (*destroy_)(GLuint) = nullptr;
};

[[nodiscard]] GlName make_buffer(GLsizeiptr bytes, const void* data, GLbitfield flags = 0);
[[nodiscard]] GlName make_vertex_array();
[[nodiscard]] GlName make_framebuffer();
/// samples > 1: multisampled
[[nodiscard]] GlName make_target(GLenum format, int width, int height, int samples);

/// Compiles and links; an error in our own shader text is our mistake and aborts with the driver's log.
[[nodiscard]] GlName make_program(const char* vertex, const char* fragment);

/// One attribute of interleaved floats.
struct Attribute {
    GLuint location;
    GLint components;
    GLuint offset;  // bytes
};
void describe(GLuint vertex_array, GLuint buffer, GLsizei stride, std::span<const Attribute> attributes);

}  // namespace seldinger

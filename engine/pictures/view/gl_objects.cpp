// Makes buffers, vertex arrays, framebuffers, render targets and programs by direct state access.
#include "view/gl_objects.h"

#include <array>
#include <cstdio>
#include <cstdlib>

namespace seldinger {
namespace {

GLuint compile(GLenum stage, const char* text)
{
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
        std::array<char, 4096> log{};
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
        std::fprintf(stderr, "seldinger: internal error: shader does not compile:\n%s\n%s\n", log.data(), text);
        std::abort();
    }
    return shader;
}

}  // namespace

GlName make_buffer(GLsizeiptr bytes, const void* data, GLbitfield flags)
{
    GLuint id = 0;
    glCreateBuffers(1, &id);
    glNamedBufferStorage(id, bytes, data, flags);
    return {id, [](GLuint name) { glDeleteBuffers(1, &name); }};
}

GlName make_vertex_array()
{
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    return {id, [](GLuint name) { glDeleteVertexArrays(1, &name); }};
}

GlName make_framebuffer()
{
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    return {id, [](GLuint name) { glDeleteFramebuffers(1, &name); }};
}

GlName make_target(GLenum format, int width, int height, int samples)
{
    GLuint id = 0;
    glCreateTextures(samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D, 1, &id);
    if (samples > 1) {
        glTextureStorage2DMultisample(id, samples, format, width, height, GL_TRUE);
    } else {
        glTextureStorage2D(id, 1, format, width, height);
    }
    return {id, [](GLuint name) { glDeleteTextures(1, &name); }};
}

GlName make_program(const char* vertex, const char* fragment)
{
    const GLuint vs = compile(GL_VERTEX_SHADER, vertex), fs = compile(GL_FRAGMENT_SHADER, fragment);
    GlName program(glCreateProgram(), [](GLuint name) { glDeleteProgram(name); });
    glAttachShader(program, vs);
    glAttachShader(program, fs);
    glLinkProgram(program);
    glDeleteShader(vs);
    glDeleteShader(fs);
    GLint ok = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (!ok) {
        std::array<char, 4096> log{};
        glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
        std::fprintf(stderr, "seldinger: internal error: shaders do not link:\n%s\n", log.data());
        std::abort();
    }
    return program;
}

void describe(GLuint vertex_array, GLuint buffer, GLsizei stride, std::span<const Attribute> attributes)
{
    glVertexArrayVertexBuffer(vertex_array, 0, buffer, 0, stride);
    for (const Attribute& a : attributes) {
        glEnableVertexArrayAttrib(vertex_array, a.location);
        glVertexArrayAttribFormat(vertex_array, a.location, a.components, GL_FLOAT, GL_FALSE, a.offset);
        glVertexArrayAttribBinding(vertex_array, a.location, 0);
    }
}

}  // namespace seldinger

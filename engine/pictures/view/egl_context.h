#pragma once
// An OpenGL context without a display or a window.

#include <memory>
#include <string>

namespace seldinger {

/// OpenGL 4.5 core through EGL: the surfaceless platform first, then the first EGL device that gives a context.
/// Every context of the process shares one EGL display, which lives until the process ends.
class EglContext {
public:
    /// @throws Error NoDevice, with the failed attempts and the package to install
    EglContext();
    ~EglContext();
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    /// Makes the context current on the calling thread.
    void make_current();
    /// Takes it from the calling thread, so that another may use or destroy it.
    void release();
    /// What draws, for example "llvmpipe (LLVM 15.0.6, 256 bits)".
    [[nodiscard]] std::string renderer_name();

private:
    void* context_ = nullptr;  // EGLContext
};

}  // namespace seldinger

// Tries EGL's surfaceless platform and then every device until one gives an OpenGL 4.5 context.
#include "view/egl_context.h"

#include "core/error.h"
#include "core/system_needs.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

namespace seldinger {
namespace {

struct Display {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLConfig config = nullptr;
};

/// Every way to ask for a display, best first, each with a name for the error message.
std::vector<EGLDisplay> candidate_displays(std::string& tried)
{
    std::vector<EGLDisplay> displays;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
        tried += "surfaceless platform";
    }
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        std::array<EGLDeviceEXT, 32> devices{};
        EGLint count = 0;
        if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) {
            for (EGLint i = 0; i < count; ++i) {
                displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
            }
        }
        tried += (tried.empty() ? "" : ", ") + std::to_string(count) + " EGL device(s)";
    }
    return displays;
}

EGLContext create_context(const Display& d)
{
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    return eglCreateContext(d.display, d.config, EGL_NO_CONTEXT, attributes);
}

/// A display that is initialised, draws desktop OpenGL 4.5 and needs no surface; otherwise display is EGL_NO_DISPLAY.
Display usable(EGLDisplay display)
{
    Display d;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return d;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context")) return d;
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint count = 0;
    if (!eglChooseConfig(display, wanted, &d.config, 1, &count) || count < 1) return d;
    d.display = display;
    const EGLContext probe = create_context(d);
    if (probe == EGL_NO_CONTEXT) return {};
    eglDestroyContext(display, probe);
    return d;
}

/// Mesa 22.3's llvmpipe: 760 MB as it draws, a thread for each core up to 32, five more. Without them it hangs or ends the
/// process by a signal.
SystemNeeds needs_of_opengl() { return {"OpenGL", std::size_t{700} << 20, std::min(library_threads("LP_NUM_THREADS"), 32) + 5}; }

constexpr const char* how_to_install =
    "; install Mesa's software renderer, on Debian: apt-get install libegl1 libopengl0 libgl1-mesa-dri";

/// epoxy opens the libraries at their first use, and ends the process if one is missing.
void require_libraries()
{
    const auto present = [](const char* name) { return ::dlopen(name, RTLD_LAZY | RTLD_LOCAL) != nullptr; };
    const char* missing = !present("libEGL.so.1")                                ? "libEGL.so.1"
                          : !present("libOpenGL.so.0") && !present("libGL.so.1") ? "libOpenGL.so.0"
                                                                                 : nullptr;
    if (missing)
        throw Error(ErrorKind::NoDevice, std::string("no off-screen OpenGL: ") + missing + " is not installed" + how_to_install);
}

Display open_display()
{
    require_libraries();
    try_system_needs(needs_of_opengl());
    ::setenv("EGL_LOG_LEVEL", "fatal", 0);  // what a driver that is not there says in many lines is said below in one
    std::string tried;
    for (EGLDisplay candidate : candidate_displays(tried)) {
        const Display d = usable(candidate);
        if (d.display != EGL_NO_DISPLAY) return d;
    }
    throw Error(ErrorKind::NoDevice, "no off-screen OpenGL 4.5 through EGL (tried: " +
                                        (tried.empty() ? std::string("nothing is offered") : tried) + ")" + how_to_install);
}

/// Opened once; a failure is tried again next time. Never terminated: other contexts and libraries may share it.
const Display& shared_display()
{
    static const Display display = open_display();
    return display;
}

}  // namespace

EglContext::EglContext()
{
    context_ = create_context(shared_display());
    if (context_ == EGL_NO_CONTEXT)
        throw Error(ErrorKind::NoDevice, "EGL gave no OpenGL 4.5 context; the memory may be exhausted");
    make_current();
}

EglContext::~EglContext()
{
    release();
    eglDestroyContext(shared_display().display, context_);
}

void EglContext::release()
{
    if (eglGetCurrentContext() == context_)
        eglMakeCurrent(shared_display().display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void EglContext::make_current()
{
    if (eglGetCurrentContext() == context_) return;
    // the API binding is per thread, and this may be a new one
    if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(shared_display().display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
        throw Error(ErrorKind::NoDevice, "EGL cannot make its context current; another thread may use the renderer");
    }
}

std::string EglContext::renderer_name()
{
    make_current();
    return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

}  // namespace seldinger

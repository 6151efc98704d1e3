// Opens a plugin, checks that it is one for this engine, and names it in all that goes wrong in it.
#include "setup/force_plugin.h"

#include "core/error.h"

#include <fmt/format.h>

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <type_traits>

namespace seldinger {
namespace {

[[noreturn]] void refuse(const SceneForce& from, std::string_view why)
{
    throw Error(ErrorKind::BadFile, fmt::format("plugin {}: {}", from.plugin, why));
}

/// The plugin's force under the engine's name for it: what it throws becomes a message.
class PluginForce final : public Force {
public:
    PluginForce(const SceneForce& from, std::unique_ptr<const Force> own) : Force(*own), from_(from), own_(std::move(own))
    {
        if (!from.name.empty()) name = from.name;
    }
    void forces(const ForcePoints& at, std::span<PointForce> out) const override
    {
        named("forces", [&] { own_->forces(at, out); });
    }
    bool tangents(const ForcePoints& at, std::span<PointTangent> out) const override
    {
        return named("tangents", [&] { return own_->tangents(at, out); });
    }
    double energy(const ForcePoints& at) const override
    {
        return named("energy", [&] { return own_->energy(at); });
    }
    void accept(const ForcePoints& at, std::span<double> next) const override
    {
        named("accept", [&] { own_->accept(at, next); });
    }

private:
    template <class F>
    std::invoke_result_t<F> named(const char* call, const F& f) const
    {
        try {
            return f();
        } catch (const std::exception& error) {
            refuse(from_, fmt::format("{}: {}", call, error.what()));
        } catch (...) {
            refuse(from_, fmt::format("{}: got something thrown that is no std::exception", call));
        }
    }

    SceneForce from_;
    std::unique_ptr<const Force> own_;
};

/// @throws Error BadFile: it is in none of the folders
std::filesystem::path find_plugin(const SceneForce& from)
{
    const char* const set = std::getenv("SELDINGER_PLUGINS");
    const std::string folders = set ? set : "";
    if (from.plugin.find('/') != std::string::npos)
        refuse(from, "got a path; expected a file's name. Fix: name its folder in SELDINGER_PLUGINS");
    for (std::size_t at = 0; at < folders.size();) {
        const std::size_t end = std::min(folders.find(':', at), folders.size());
        std::error_code ignored;
        const auto file = std::filesystem::absolute(folders.substr(at, end - at), ignored) / from.plugin;
        if (end > at && std::filesystem::is_regular_file(file, ignored)) return file;
        at = end + 1;
    }
    refuse(from, fmt::format("got no such file in the folders of SELDINGER_PLUGINS ({}); expected one. Fix: "
                             "SELDINGER_PLUGINS=FOLDER before the command, a folder with plugins that you trust",
                             set ? folders : "which is not set"));
}

/// A symbol of the library; null: it has none.
template <class T>
T* symbol(void* library, const char* name)
{
    return reinterpret_cast<T*>(dlsym(library, name));
}

}  // namespace

std::shared_ptr<const Force> load_force(const SceneForce& from)
{
    void* library = dlopen(find_plugin(from).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) refuse(from, fmt::format("got no library that can be opened ({}); expected a plugin", dlerror()));
    const char* version = symbol<const char>(library, "seldinger_force_version");
    const auto make = symbol<Force*(const ForceKeys&)>(library, "seldinger_make_force");
    if (!version || !make)
        refuse(from, "got a library without a force; expected a plugin. Fix: end its source with SELDINGER_FORCE(class)");
    if (std::string_view(version) != SELDINGER_FORCE_VERSION)
        refuse(from, fmt::format("got a plugin for \"{:.60}\"; expected \"{}\". Fix: compile it with this version's headers",
                                 version, SELDINGER_FORCE_VERSION));
    std::unique_ptr<const Force> own;
    try {
        own.reset(make(from.keys));
    } catch (const std::exception& error) {
        refuse(from, error.what());
    } catch (...) {
        refuse(from, "got something thrown that is no std::exception; expected a force");
    }
    if (!own) refuse(from, "got no force from seldinger_make_force; expected one");
    const auto refuse_unknown = [&](const auto& given) {
        for (const auto& [key, value] : given)
            if (!from.keys.asked.contains(key)) refuse(from, fmt::format("{}: unknown key; the plugin does not ask for it", key));
    };
    refuse_unknown(from.keys.lists);
    refuse_unknown(from.keys.texts);
    return std::make_shared<PluginForce>(from, std::move(own));
}

}  // namespace seldinger

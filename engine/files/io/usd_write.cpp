// USD as text: one stage with a mesh, curves and points, sampled in time.
#include "core/error.h"
#include "core/file_io.h"
#include "io/animated_model.h"

#include <fmt/format.h>

#include <iterator>

namespace seldinger {
namespace {

constexpr double codes_per_second = 1000;  // time codes are milliseconds

class Usd {
public:
    explicit Usd(const AnimatedModel& model) : model_(model)
    {
        axes_ = Mat3::rows(model.left, model.back, model.head);
    }

    std::string file()
    {
        const double first = model_.times.empty() ? 0 : model_.times.front(),
                     last = model_.times.empty() ? 0 : model_.times.back();
        say("#usda 1.0\n(\n    defaultPrim = \"run\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n    timeCodesPerSecond = {}\n   "
            " startTimeCode = {:.10g}\n"
            "    endTimeCode = {:.10g}\n)\n\ndef Xform \"run\"\n{{\n",
            codes_per_second, codes_per_second * first, codes_per_second * last);
        if (!model_.triangles.empty()) vessel();
        for (const AnimatedTube& tube : model_.tubes) curves(tube);
        contacts();
        say("}}\n");
        return std::move(text_);
    }

private:
    template <class... T>
    void say(fmt::format_string<T...> form, T&&... values)
    {
        fmt::format_to(std::back_inserter(text_), form, std::forward<T>(values)...);
    }
    void point(const Vec3& p, bool first)
    {
        const Vec3 q = axes_ * p;
        say("{}({:.7g}, {:.7g}, {:.7g})", first ? "" : ", ", q.x(), q.y(), q.z());
    }
    template <class List, class Get>
    void points(const List& list, const Get& get)
    {
        say("[");
        for (std::size_t i = 0; i < list.size(); ++i) point(get(list[i]), i == 0);
        say("]");
    }

    void vessel()
    {
        say("    def Mesh \"vessel\"\n    {{\n        uniform token subdivisionScheme = \"none\"\n        uniform bool "
            "doubleSided = 1\n"
            "        color3f[] primvars:displayColor = [(0.95, 0.73, 0.66)]\n        float[] primvars:displayOpacity = [0.35]\n"
            "        int[] faceVertexCounts = [");
        for (std::size_t i = 0; i < model_.triangles.size(); ++i) say("{}3", i == 0 ? "" : ", ");
        say("]\n        int[] faceVertexIndices = [");
        for (std::size_t i = 0; i < model_.triangles.size(); ++i)  // outwards
            say("{}{}, {}, {}", i == 0 ? "" : ", ", model_.triangles[i][0], model_.triangles[i][2], model_.triangles[i][1]);
        say("]\n        point3f[] points = ");
        points(model_.vertices, [](const Vec3& v) { return v; });
        say("\n    }}\n");
    }

    /// A name that USD takes: letters, digits and underscores, no digit first.
    static std::string identifier(std::string name)
    {
        for (char& c : name)
            if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
        return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) ? "_" + name : name;
    }

    void curves(const AnimatedTube& tube)
    {
        say("    def BasisCurves \"{}\"\n    {{\n        uniform token type = \"linear\"\n        int[] curveVertexCounts = "
            "[{}]\n        float[] widths = [",
            identifier(tube.name), tube.radius.size());
        for (std::size_t i = 0; i < tube.radius.size(); ++i) say("{}{:.7g}", i == 0 ? "" : ", ", 2 * tube.radius[i]);
        say("] (\n            interpolation = \"vertex\"\n        )\n        color3f[] primvars:displayColor = [(0.08, 0.19, "
            "0.31)]\n"
            "        point3f[] points.timeSamples = {{\n");
        for (std::size_t f = 0; f < tube.poses.size(); ++f) {
            say("            {:.10g}: ", codes_per_second * model_.times[f]);
            points(tube.poses[f], [](const AnimatedTube::Pose& p) { return p.place; });
            say(",\n");
        }
        say("        }}\n    }}\n");
    }

    void contacts()
    {
        if (model_.contacts.empty()) return;
        say("    def Points \"contacts\"\n    {{\n        point3f[] points.timeSamples = {{\n");
        for (std::size_t f = 0; f < model_.contacts.size(); ++f) {
            say("            {:.10g}: ", codes_per_second * model_.times[f]);
            points(model_.contacts[f], [](const Vec3& p) { return p; });
            say(",\n");
        }
        say("        }}\n        float[] widths = [0.002] (\n            interpolation = \"constant\"\n        )\n"
            "        custom float[] primvars:normalForce.timeSamples = {{\n");
        for (std::size_t f = 0; f < model_.contact_forces.size(); ++f) {
            say("            {:.10g}: [", codes_per_second * model_.times[f]);
            for (std::size_t i = 0; i < model_.contact_forces[f].size(); ++i)
                say("{}{:.7g}", i == 0 ? "" : ", ", model_.contact_forces[f][i]);
            say("],\n");
        }
        say("        }}\n    }}\n");
    }

    const AnimatedModel& model_;
    Mat3 axes_;
    std::string text_;
};

}  // namespace

void write_usd(const std::filesystem::path& path, const AnimatedModel& model)
{
    if (path.extension() != ".usda")
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got the ending \"{}\"; expected .usda (USD as text). Fix: rename the file", path.string(),
                                path.extension().string()));
    make_folder_of(path);
    write_file(path, Usd(model).file());
}

}  // namespace seldinger

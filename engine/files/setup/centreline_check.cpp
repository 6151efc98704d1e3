// Measures how a centreline fits its mesh, in the axes and units that its file may be in.
#include "setup/centreline_check.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "io/centreline_file.h"
#include "io/file_remarks.h"
#include "io/mesh_file.h"
#include "scene/scene_names.h"
#include "vessel/enclosure.h"
#include "vessel/mesh_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace seldinger {
namespace {

constexpr double most_off = 0.1;  // share of its length that may lie off: a smoothed line cuts a corner, a mesh ends earlier
constexpr double least_in = 0.25;          // and that must lie in the mesh at all: the line may go on beyond openings
// median ratio of distance and radius: mean radii of oval lumens are 1.4 times as large, diameters 2
constexpr double alike_low = 0.6, alike_high = 1.7;
constexpr double like_low = 1.0 / 3, like_high = 3;  // the same at one point
constexpr double most_aside = 0.15;  // of the radius, median: axes that are found in patients stay below
constexpr std::size_t most_points = 400;   // that are looked at in axes and units that nobody has named

std::string place(const Vec3& p) { return fmt::format("[{:.2f}, {:.2f}, {:.2f}] mm", 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z()); }

/// From the file's axes and unit to the mesh's.
struct Cure {
    std::string unit;
    bool turned = false;  // x and y
    bool operator==(const Cure&) const = default;
};

struct Fit {
    double in = 0, off = 0, all = 0;  // lengths; the rest lies beyond openings [m]
    double ratio = 0;                 // median of distance to the wall over radius
    double aside = 0, share = 0;      // medians: distance to the middle between the nearest wall and the one across [m, radii]
    std::size_t points_off = 0;
    Vec3 first = Vec3::Zero();        // point that is off
    std::string why;                  // it is
    [[nodiscard]] bool lies_in() const { return in >= least_in * all && off <= most_off * (in + off); }
    [[nodiscard]] bool is_good() const { return lies_in() && ratio > alike_low && ratio < alike_high; }
};

Centreline cured(const Centreline& metres, const Cure& cure)
{
    Centreline line = metres;
    const double scale = metres_per_unit(cure.unit);
    for (Vec3& p : line.points) p = scale * Vec3(cure.turned ? -p.x() : p.x(), cure.turned ? -p.y() : p.y(), p.z());
    for (double& r : line.radius) r *= scale;
    return line;
}

class FitMeter {
public:
    explicit FitMeter(const LoadedVessel& vessel)
        : mesh_(vessel.mesh),
          openings_(vessel.report.loops),
          lumen_(vessel.mesh, openings_, LumenQuery::Expect::Few),
          enclosure_(vessel.mesh, openings_, lumen_)
    {
    }

    /// Where a line may leave the mesh: a given one may go on beyond openings, a found one ends at them.
    enum class Ends { Beyond, AtOpenings };

    /// @param every  looks at each so manyth point
    [[nodiscard]] Fit measure(const Centreline& line, std::size_t every, Ends ends = Ends::Beyond) const
    {
        Fit fit;
        std::vector<double> ratios, asides, shares;
        const std::vector<double> to_end = from_ends(line);
        for (std::size_t i = 0; i < line.points.size(); i += every) {
            const Vec3& p = line.points[i];
            const double length = line.parent[i] < 0 ? 0 : (p - line.points[static_cast<std::size_t>(line.parent[i])]).norm(),
                         r = line.radius[i];
            fit.all += length;
            const LumenPlace at = lumen_.locate(p);
            if (ends == Ends::Beyond ? at.opening >= 0 || is_beside_opening(p) : enclosure_.is_at_opening(p)) continue;
            const bool in = enclosure_.holds(p), near_end = to_end[i] < r;
            const double ratio = std::abs(at.signed_distance) / r;
            if (in && !near_end) {
                ratios.push_back(ratio);
                const Vec3 across = p - at.nearest;
                const double near = across.norm(), far = first_hit(lumen_.tree(), p, across / std::max(near, 1e-300));
                if (std::isfinite(far)) asides.push_back(0.5 * (far - near)), shares.push_back((far - near) / (far + near));
            }
            const bool like = near_end || (ratio > like_low && ratio < like_high);
            // points are half a radius apart: one that falls so far has gone into a cleft between folded triangles
            const double before = length > 0 ? line.radius[static_cast<std::size_t>(line.parent[i])] : 0;
            // a lumen has three sides at least: one so much narrower than the triangles beside it is a cleft between two of them
            const double height = 0.1 * least_height(at.triangle);
            const bool falls = r < 0.1 * before && to_end[i] > before, cleft = r < height && to_end[i] > 10 * height;
            const bool clings = ends == Ends::AtOpenings && (falls || cleft);
            (in && like ? fit.in : fit.off) += length;
            if ((in && like && !clings) || fit.points_off++ > 0) continue;
            const double away = 1e3 * std::abs(at.signed_distance);
            fit.first = p;
            fit.why = !in      ? fmt::format("lies {:.3g} mm outside of the lumen", away)
                      : !clings ? fmt::format("has a radius of {:.3g} mm, {:.3g} mm from the wall", 1e3 * r, away)
                      : falls   ? fmt::format("clings to the wall, at {:.3g} mm, beside one at {:.3g} mm", away, 1e3 * before)
                                : fmt::format("clings to the wall, at {:.3g} mm, between triangles of {:.3g} mm", away,
                                              1e4 * height);
        }
        fit.ratio = median(ratios), fit.aside = median(asides), fit.share = median(shares);
        return fit;
    }

private:
    static double median(std::vector<double>& values)
    {
        if (values.empty()) return 0;
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    /// Lines of a mesh with longer ends go on straight beyond an opening, or stop just before a lid.
    [[nodiscard]] bool is_beside_opening(const Vec3& p) const
    {
        return std::any_of(openings_.begin(), openings_.end(), [&](const BoundaryLoop& loop) {
            const double out = -(p - loop.centre).dot(loop.inward), aside = (p - loop.centre + out * loop.inward).norm();
            return out > -1e-3 * loop.radius && out < 10 * loop.radius && aside < loop.radius + 0.5 * std::max(0.0, out);
        });
    }

    /// Path from each point to the end behind it, or to the root before it where that is nearer [m].
    static std::vector<double> from_ends(const Centreline& line)
    {
        const std::vector<double> from_root = line.lengths();
        std::vector<double> to_end(from_root.size(), -1);
        std::vector<bool> inner(from_root.size(), false);
        for (const int parent : line.parent)
            if (parent >= 0) inner[static_cast<std::size_t>(parent)] = true;
        for (std::size_t leaf = 0; leaf < to_end.size(); ++leaf) {
            if (inner[leaf]) continue;
            for (int at = static_cast<int>(leaf); at >= 0; at = line.parent[static_cast<std::size_t>(at)]) {
                const auto k = static_cast<std::size_t>(at);
                const double length = from_root[leaf] - from_root[k];
                if (to_end[k] >= 0 && to_end[k] <= length) break;
                to_end[k] = length;
            }
        }
        for (std::size_t i = 0; i < to_end.size(); ++i) to_end[i] = std::min(to_end[i], from_root[i]);
        return to_end;
    }

    /// Of a triangle [m].
    [[nodiscard]] double least_height(std::int64_t triangle) const
    {
        const auto& corner = mesh_.triangles[static_cast<std::size_t>(triangle)];
        const auto at = [&](std::size_t k) { return mesh_.vertices[static_cast<std::size_t>(corner[k])]; };
        const Vec3 a = at(1) - at(0), b = at(2) - at(1), c = at(0) - at(2);
        return a.cross(b).norm() / std::max({a.norm(), b.norm(), c.norm(), 1e-300});
    }

    const WallMesh& mesh_;
    const std::vector<BoundaryLoop>& openings_;
    LumenQuery lumen_;
    Enclosure enclosure_;
};

const char* word_of(FileAxes axes) { return axes == FileAxes::Ras ? "RAS" : axes == FileAxes::Lps ? "LPS" : ""; }

/// The key that makes a file be read so, and what it means. @param mesh_space  what the mesh's header says, or ""
std::string fix_of(const Cure& cure, const Cure& tried, const std::string& mesh_space)
{
    std::string keys, words;
    if (cure.turned != tried.turned) {
        const bool mesh_ras = mesh_space == "RAS";
        keys = fmt::format("vessel.centreline_space = \"{}\"", cure.turned != mesh_ras ? "RAS" : "LPS");
        words = cure.turned ? "with x and y turned round" : "without turning x and y";
    }
    if (cure.unit != tried.unit) {
        keys += fmt::format("{}vessel.centreline_units = \"{}\"", keys.empty() ? "" : ", ", cure.unit);
        words += fmt::format("{}in {}", words.empty() ? "" : " and ", cure.unit);
    }
    return fmt::format("It fits {}. Fix: {}", words, keys);
}

void note_points_off(const Fit& fit, const std::string& line, std::vector<std::string>& notes)
{
    if (fit.points_off == 0) return;
    notes.push_back(fmt::format("{} of {} {} not fit the mesh, the first near {}: it {}.",
                                count_of(fit.points_off, "point", "points"), line, fit.points_off == 1 ? "does" : "do",
                                place(fit.first), fit.why));
}

class GivenCentreline {
public:
    GivenCentreline(const VesselSpec& spec, const LoadedVessel& vessel) : spec_(spec), meter_(vessel)
    {
        const std::string bytes = read_file(spec.centreline);
        raw_ = parse_centreline(bytes, spec.centreline.string(), "m");  // its own numbers
        const FileRemarks own = remarks_in(bytes, spec.centreline);
        own_space_ = word_of(own.axes), own_unit_ = own.units;
        mesh_space_ = word_of(remarks_of_file(spec.mesh).axes);
    }

    Centreline read(std::vector<std::string>& notes)
    {
        const std::vector<Cure> said = cures_said();
        for (const Cure& cure : said) {
            const Centreline line = cured(raw_, cure);
            const Fit fit = meter_.measure(line, 1);
            if (!fit.is_good()) continue;
            describe(cure, fit, notes);
            return line;
        }
        refuse(said.front());
    }

private:
    /// What the scene says; else what headers say. Where only one of them names its axes, both ways count, as it stands first.
    [[nodiscard]] std::vector<Cure> cures_said() const
    {
        const bool by_key = !spec_.centreline_space.empty();
        const std::string space = by_key ? spec_.centreline_space : own_space_;
        const std::string mesh = mesh_space_.empty() ? "LPS" : mesh_space_;
        const Cure header = {!spec_.centreline_units.empty() ? spec_.centreline_units
                             : !own_unit_.empty()            ? own_unit_
                                                             : spec_.units,
                             !space.empty() && space != mesh};
        if (by_key) return {header};
        std::vector<Cure> list = {header};
        const auto add = [&](const Cure& cure) {
            if (std::find(list.begin(), list.end(), cure) == list.end()) list.push_back(cure);
        };
        add({header.unit, false});
        if (mesh_space_.empty() && list.size() > 1) std::swap(list[0], list[1]);
        if (spec_.centreline_units.empty()) {
            add({spec_.units, header.turned});
            add({spec_.units, false});
        }
        return list;
    }

    void describe(const Cure& cure, const Fit& fit, std::vector<std::string>& notes) const
    {
        const std::string name = spec_.centreline.filename().string();
        const bool keys = !spec_.centreline_space.empty() || !spec_.centreline_units.empty();
        if (cure.turned || cure.unit != spec_.units)
            notes.push_back(
                fmt::format("{} is read{}{}, as {}.", name, cure.turned ? " with x and y turned round" : "",
                            cure.unit != spec_.units ? fmt::format("{} in {}", cure.turned ? " and" : "", cure.unit) : "",
                            keys ? "the scene says" : "its header says"));
        if (!keys && ((!own_space_.empty() && !mesh_space_.empty() && own_space_ != mesh_space_ && !cure.turned) ||
                      (!own_unit_.empty() && own_unit_ != cure.unit)))
            notes.push_back(fmt::format("{} says{}{} in its header, but it fits the mesh as it stands, and is read so.", name,
                                        own_space_.empty() ? "" : " SPACE=" + own_space_,
                                        own_unit_.empty() ? "" : " unit " + own_unit_));
        note_points_off(fit, name, notes);
        if (fit.share > most_aside)
            notes.push_back(fmt::format("{} lies {:.2g} mm beside the middle of the lumen, {:.0f} % of its radius (medians). "
                                        "Fix: export it from this very mesh, or leave vessel.centreline out.",
                                        name, 1e3 * fit.aside, 100 * fit.share));
    }

    [[noreturn]] void refuse(const Cure& tried) const
    {
        const Fit fit = meter_.measure(cured(raw_, tried), 1);
        std::string got =
            fmt::format("{}: got a centreline of which {:.0f} % does not fit the mesh: the first point, near {}, {}",
                        spec_.centreline.string(), 100 * (1 - fit.in / std::max(fit.all, 1e-300)), place(fit.first), fit.why);
        if (fit.lies_in())
            got = fmt::format("{}: got radii of {:.2g} times the distance to the wall (median)", spec_.centreline.string(),
                              1 / fit.ratio);
        else if (fit.points_off == 0)
            got = fmt::format("{}: got a centreline that lies beyond the openings of the mesh", spec_.centreline.string());
        constexpr const char* expected = "expected points in its lumen, with the distance to the wall as radius";
        const std::size_t every = raw_.points.size() / most_points + 1;
        std::optional<Cure> best;
        double least = 2;
        for (const bool turned : {tried.turned, !tried.turned})
            for (const std::string_view unit : unit_words) {
                const Cure cure = {std::string(unit), turned};
                if (cure == tried) continue;
                const Fit other = meter_.measure(cured(raw_, cure), every);
                const double off = other.off / std::max(other.in + other.off, 1e-300);
                if (other.is_good() && off < least) best = cure, least = off;
            }
        if (best) throw Error(ErrorKind::BadScene, fmt::format("{}; {}. {}", got, expected, fix_of(*best, tried, mesh_space_)));
        if (fit.lies_in())
            throw Error(
                ErrorKind::BadFile,
                fmt::format(
                    "{}; {}. Fix: name an array of diameters \"Diameter\", or leave vessel.centreline out: the axis is found "
                    "from the mesh",
                    got, expected));
        throw Error(
            ErrorKind::BadFile,
            fmt::format("{}; {}. No usual change of axes or unit makes it fit. Fix: export it from this very mesh, or leave "
                        "vessel.centreline out: the axis is found from the mesh",
                        got, expected));
    }

    const VesselSpec& spec_;
    FitMeter meter_;
    Centreline raw_;
    std::string own_space_, own_unit_, mesh_space_;
};

/// Rims that are no ring: a flap of triangles left over from a cut.
void note_flaps(LoadedVessel& vessel)
{
    constexpr std::size_t most = 4;  // with a sentence of its own
    std::size_t ragged = 0;
    for (const BoundaryLoop& loop : vessel.report.loops) {
        std::int32_t vertex = 0;
        const double height = rim_height(vessel.mesh, loop, &vertex);
        if (height < 0.75 * loop.radius || ++ragged > most) continue;
        vessel.report.notes.push_back(
            fmt::format("The opening near {} has a ragged rim: triangles stand out of it by {:.3g} mm, near {}. Fix: cut the "
                        "vessel there anew.",
                        place(loop.centre), 1e3 * height, place(vessel.mesh.vertices[static_cast<std::size_t>(vertex)])));
    }
    if (ragged > most) vessel.report.notes.push_back(fmt::format("{} more openings have ragged rims.", ragged - most));
}

/// Rims with a flap, openings and branches that the centreline does not reach.
void note_reach(LoadedVessel& vessel)
{
    constexpr double reached = 4;  // radii from an opening to the line: a line may stop short of its end
    const Centreline& line = vessel.centreline;
    RepairReport& report = vessel.report;
    note_flaps(vessel);
    if (line.empty()) return;
    const std::size_t fine = report.unreached.size();
    if (fine > 0)
        report.notes.push_back(
            fmt::format("The centreline does not reach {}, the first near {}: too few triangles for the lumen there. They are no "
                        "targets, no inlets, and "
                        "no contrast comes into them. Fix: a finer mesh there (two edges to a lumen radius).",
                        count_of(fine, "stretch of narrow lumen", "stretches of narrow lumen"), place(report.unreached.front())));
    std::string places;
    std::size_t openings = 0;
    for (const BoundaryLoop& loop : report.loops) {
        const double away = (line.points[static_cast<std::size_t>(line.nearest(loop.centre))] - loop.centre).norm();
        if (away <= reached * loop.radius) continue;
        if (++openings <= 8) places += (places.empty() ? "" : ", ") + place(loop.centre);
        report.unreached.push_back(loop.centre);
    }
    if (openings > 0)
        report.notes.push_back(fmt::format("The centreline does not reach {}: near {}{}.",
                                           count_of(openings, "opening of the mesh", "openings of the mesh"), places,
                                           openings > 8 ? " and others" : ""));
}

}  // namespace

void read_given_centreline(const VesselSpec& spec, LoadedVessel& vessel)
{
    vessel.centreline = GivenCentreline(spec, vessel).read(vessel.report.notes);
    vessel.report.unreached.clear();
    note_reach(vessel);
}

void check_found_centreline(LoadedVessel& vessel)
{
    if (!vessel.centreline.empty())
        note_points_off(FitMeter(vessel).measure(vessel.centreline, 1, FitMeter::Ends::AtOpenings), "the centreline",
                        vessel.report.notes);
    note_reach(vessel);
}

}  // namespace seldinger

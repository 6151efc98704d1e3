// Sizes decide: a vessel's lumen is millimetres wide and its tree decimetres long, whatever numbers a file has.
#include "setup/first_scene.h"

#include "core/error.h"
#include "core/printable.h"
#include "io/mesh_file.h"
#include "scene/instruments.h"
#include "scene/scene_names.h"
#include "scene/toml_table.h"
#include "scene/toml_parse.h"
#include "vessel/inside.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double least_lumen = 0.3e-3, most_lumen = 20e-3, least_extent = 5e-3, most_extent = 1.5;  // [m]
// What costs nothing: from a cerebral artery to an aorta, from a piece of carotid artery to an aorta with its legs.
constexpr double low_usual = 1.2e-3, high_usual = 13e-3, small_usual = 18e-3,
                 large_usual = 0.5;  // median lumen radius, extent [m]
constexpr double usual_ratio = 80;  // of a vessel's extent to its lumen radius, where nothing else is known
constexpr double in_doubt = 2.5;    // difference of misfits below which the second unit is worth naming
// A wire's diameter in lumen radii where it still turns and passes freely.
constexpr double free_share = 0.7;
constexpr double feed_speed = 0.02;  // [m/s], a steady hand's
// What a hand has ready, thick before thin: a supple wire for any vessel, then for narrower ones.
constexpr const char* usual_wires[] = {"terumo-angled-035", "control-018", "coronary-soft-014"};

/// Radii along the axis in the file's unit, each with the length that it represents, the smallest first.
std::vector<std::pair<double, double>> lumen_sizes(const LoadedVessel& vessel, double metre)
{
    std::vector<std::pair<double, double>> sizes;
    const Centreline& line = vessel.centreline;
    for (std::size_t i = 0; i < line.points.size(); ++i) {
        if (line.parent[i] < 0) continue;
        const auto up = static_cast<std::size_t>(line.parent[i]);
        sizes.emplace_back(0.5 * (line.radius[i] + line.radius[up]) / metre, (line.points[i] - line.points[up]).norm() / metre);
    }
    if (sizes.empty())
        for (const BoundaryLoop& loop : vessel.report.loops) sizes.emplace_back(loop.radius / metre, 1.0);
    std::sort(sizes.begin(), sizes.end());
    return sizes;
}

/// The radius that this share of the axis stays below.
double quantile(const std::vector<std::pair<double, double>>& sizes, double share)
{
    double all = 0, sum = 0;
    for (const auto& [radius, length] : sizes) all += length;
    for (const auto& [radius, length] : sizes)
        if ((sum += length) >= share * all) return radius;
    return sizes.empty() ? 0 : sizes.back().first;
}

double diagonal_of(const WallMesh& mesh)
{
    Box3 box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    return box.isEmpty() ? 0 : box.diagonal().norm();
}

double outside(double value, double least, double most)
{
    return std::max({0.0, std::log(least / std::max(value, 1e-12)), std::log(std::max(value, 1e-12) / most)});
}

double habit(std::string_view unit)
{
    return unit == "mm" ? 0 : unit == "cm" ? 1 : unit == "m" ? 1.5 : 3;
}

/// @param sizes  in the file's unit, as the extent
std::vector<UnitGuess> guesses_of(const std::vector<std::pair<double, double>>& sizes, double extent_in_file)
{
    std::vector<UnitGuess> all;
    for (const std::string_view word : unit_words) {
        const double metre = metres_per_unit(std::string(word));
        UnitGuess guess{std::string(word), quantile(sizes, 0.5) * metre, extent_in_file * metre, quantile(sizes, 0.1) * metre,
                        quantile(sizes, 0.9) * metre};
        double length = 0, within = 0;
        for (const auto& [radius, step] : sizes) {
            length += step;
            if (radius * metre >= least_lumen && radius * metre <= most_lumen) within += step;
        }
        guess.plausible = within > 0.5 * length && guess.extent >= least_extent && guess.extent <= most_extent;
        guess.misfit = 2 * (outside(guess.low, least_lumen, most_lumen) + outside(guess.high, least_lumen, most_lumen) +
                            outside(guess.lumen, low_usual, high_usual) + outside(guess.extent, small_usual, large_usual)) +
                       habit(word) + (guess.plausible ? 0 : 100);
        all.push_back(guess);
    }
    std::stable_sort(all.begin(), all.end(), [](const UnitGuess& a, const UnitGuess& b) { return a.misfit < b.misfit; });
    return all;
}

}  // namespace

std::vector<UnitGuess> guess_units(const std::filesystem::path& mesh, LoadedVessel& vessel, const std::string& said,
                                   const std::string& label)
{
    VesselSpec spec;
    spec.shape = VesselShape::Mesh;
    spec.mesh = std::filesystem::absolute(mesh);
    spec.units = said;
    spec.label_name = label;
    if (!said.empty()) {
        vessel = load_vessel(spec);
        const double metre = metres_per_unit(said);
        return guesses_of(lumen_sizes(vessel, metre), diagonal_of(vessel.mesh) / metre);
    }
    // the axis takes no unit but for a vessel's usual size: so in the one in which the box is nearest to that
    // (micrometres: a reader refuses positions kilometres away)
    const double box = diagonal_of(read_mesh(mesh, "um")) / metres_per_unit("um");
    if (!(box > 0)) throw Error(ErrorKind::BadFile, mesh.string() + ": all of it is in one place");
    spec.units = guesses_of({{box / usual_ratio, 1.0}}, box).front().unit;
    vessel = load_vessel(spec);
    const double metre = metres_per_unit(spec.units);
    std::vector<UnitGuess> all = guesses_of(lumen_sizes(vessel, metre), diagonal_of(vessel.mesh) / metre);
    if (all.front().unit != spec.units) {
        spec.units = all.front().unit;
        vessel = load_vessel(spec);
    }
    return all;
}

std::string describe_unit(const std::vector<UnitGuess>& guesses, const UnitGuess& taken, const std::string& source)
{
    const auto sizes = [](const UnitGuess& g) {
        return fmt::format(
            "a lumen of {:.3g} mm radius (median along the axis; 10 to 90 %: {:.3g} to {:.3g} mm) in {:.4g} mm from corner to "
            "corner",
            1e3 * g.lumen, 1e3 * g.low, 1e3 * g.high, 1e3 * g.extent);
    };
    std::string text = fmt::format("{}: {}", source, sizes(taken));
    if (!taken.plausible) text += "; no vessel in the body is like that";
    std::string others;
    for (const UnitGuess& other : guesses)
        if (other.plausible && other.unit != taken.unit && other.misfit < taken.misfit + in_doubt)
            others += fmt::format("{}in {} it would be {:.3g} mm in {:.4g} mm", others.empty() ? "" : ", ",
                                  other.unit == "in" ? "inches" : other.unit, 1e3 * other.lumen, 1e3 * other.extent);
    if (!others.empty()) text += fmt::format("; in doubt: {}; --units decides", others);
    return text;
}

std::string describe_no_vessel(const LoadedVessel& vessel)
{
    // An opening is where a vessel was cut: three of its radii in, the lumen is about as wide as the opening. Behind a hole in
    // the side of a body the nearest wall there is the hole's own rim, 3.2 radii away.
    const std::vector<BoundaryLoop>& loops = vessel.report.loops;
    std::size_t holes = 0;
    if (loops.size() > 1) {
        const LumenQuery lumen(vessel.mesh, loops, LumenQuery::Expect::Few);
        for (const BoundaryLoop& loop : loops)
            holes += lumen.locate(loop.centre + 3 * loop.radius * loop.inward).signed_distance > 2.2 * loop.radius;
    }
    // nearly all: an aorta whose branches were cut off flush has such holes, too, but also ends
    if (holes > 1 && 10 * holes >= 9 * loops.size())
        return fmt::format("{} of its {} openings are holes in the side of something wide, not ends of a lumen", holes,
                           loops.size());
    std::vector<double> radius = vessel.centreline.radius;
    if (radius.empty()) return {};
    std::nth_element(radius.begin(), radius.begin() + static_cast<std::ptrdiff_t>(radius.size() / 2), radius.end());
    const double ratio = vessel.centreline.total_length() / radius[radius.size() / 2];
    constexpr double least_ratio = 5;  // a ball has 2, a tube as long as it is thick 2 to 4
    return ratio < least_ratio ? fmt::format("its axis is only {:.2g} times as long as its lumen is wide in radius", ratio) : "";
}

double WayThrough::reach(double diameter) const
{
    for (std::size_t i = 0; i < at.size(); ++i)
        if (radius[i] * free_share < diameter) return at[i];
    return length;
}

WayThrough way_through(const Centreline& line, const Inlet& inlet)
{
    WayThrough way;
    const int start = line.nearest(inlet.point);
    if (start < 0) return way;
    const std::size_t count = line.points.size();
    std::vector<std::vector<std::size_t>> links(count);
    for (std::size_t i = 0; i < count; ++i)
        if (line.parent[i] >= 0) {
            links[i].push_back(static_cast<std::size_t>(line.parent[i]));
            links[static_cast<std::size_t>(line.parent[i])].push_back(i);
        }
    std::vector<double> length(count, -1);
    std::vector<std::size_t> order = {static_cast<std::size_t>(start)}, before(count, count);
    length[order[0]] = 0;
    std::size_t far = order[0];
    for (std::size_t k = 0; k < order.size(); ++k)
        for (const std::size_t next : links[order[k]]) {
            if (length[next] >= 0) continue;
            const Vec3 step = line.points[next] - line.points[order[k]];
            // not back out of the end that lies behind the inlet
            if (order[k] == order[0] && step.dot(inlet.direction) < 0 && links[order[0]].size() > 1) continue;
            length[next] = length[order[k]] + step.norm();
            before[next] = order[k];
            order.push_back(next);
            if (length[next] > length[far]) far = next;
        }
    way.length = length[far];
    std::vector<Vec3> place;
    for (std::size_t p = far; p < count; p = before[p]) {
        const double left = way.length - length[p];
        if (left < 2 * line.radius[p] && way.length > 4 * line.radius[p]) continue;  // a closed end narrows to nothing
        way.at.push_back(length[p]);
        way.radius.push_back(line.radius[p]);
        place.push_back(line.points[p]);
    }
    std::reverse(way.at.begin(), way.at.end());
    std::reverse(way.radius.begin(), way.radius.end());
    std::reverse(place.begin(), place.end());
    // an opening's centre may lie on the rim's mean plane, nearer to the wall than the lumen is wide
    if (!way.radius.empty()) way.radius.front() = std::max(way.radius.front(), inlet.radius);
    if (!way.at.empty()) way.length = way.at.back();
    way.narrowest = inlet.radius, way.narrowest_place = inlet.point;
    if (way.radius.empty()) return way;
    const auto least = static_cast<std::size_t>(std::min_element(way.radius.begin(), way.radius.end()) - way.radius.begin());
    way.narrowest = way.radius[least], way.narrowest_at = way.at[least], way.narrowest_place = place[least];
    return way;
}

namespace {

std::string narrowest_words(const WayThrough& way)
{
    // parts of a mesh that merely touch, or a wall left between them: no vessel is as narrow as 0.1 of the thinnest wire
    constexpr double closed = 1.5e-5;
    if (way.narrowest >= closed)
        return fmt::format("the narrowest lumen on the longest way has a radius of {:.2g} mm", 1e3 * way.narrowest);
    const Vec3 at = 1e3 * way.narrowest_place;
    return fmt::format(
        "the longest way is as good as closed {:.0f} mm from its beginning, at [{:.2f}, {:.2f}, {:.2f}] mm, where the lumen has "
        "a "
        "radius of {:.2g} mm: look whether two parts of the mesh only touch there",
        1e3 * way.narrowest_at, at.x(), at.y(), at.z(), 1e3 * way.narrowest);
}

}  // namespace

WireChoice choose_wire(const WayThrough& way, const std::string& asked)
{
    const std::vector<Instrument> all = instruments();
    const auto with = [&](const std::string& name) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const Instrument& i) { return i.name == name; });
        if (at == all.end()) {
            std::vector<std::string_view> names;
            for (const Instrument& i : all) names.push_back(i.name);
            throw Error(ErrorKind::BadScene,
                        fmt::format("--instrument {}: no such instrument; the nearest is {} (`seldinger instruments` "
                                    "lists them)",
                                    name, nearest_word(name, names)));
        }
        WireChoice choice;
        choice.name = name;
        choice.diameter = 2 * at->wire.shaft.radius;
        choice.reach = way.reach(choice.diameter);
        return choice;
    };
    const auto size = [](const WireChoice& c) { return fmt::format("{} is {:.2f} mm thick", c.name, 1e3 * c.diameter); };
    const std::string lumen = narrowest_words(way);
    WireChoice choice;
    if (!asked.empty()) {
        choice = with(asked);
        choice.why = fmt::format("asked for: {}, {}", size(choice), lumen);
    } else {
        std::string too_thick;
        for (const char* name : usual_wires) {
            choice = with(name);
            const bool thinnest = name == *std::rbegin(usual_wires), passes = choice.reach >= 0.9 * way.length;
            choice.why = fmt::format("{}{}, {}", size(choice), too_thick, lumen);
            if (passes || thinnest) break;
            too_thick = fmt::format(" (thicker ones, from {:.2f} mm on, do not pass)", 1e3 * choice.diameter);
        }
    }
    if (choice.reach < 0.9 * way.length)
        choice.why += fmt::format("; it gets {:.0f} mm far before that is too narrow for it", 1e3 * choice.reach);
    if (choice.reach < 0.002)
        throw Error(
            ErrorKind::BadScene,
            fmt::format(
                "{}: too thick for this vessel, {}; choose a thinner one with --instrument, or the right unit with --units",
                size(choice), lumen));
    return choice;
}

namespace {

std::string inlets_comment(const FirstScene& first)
{
    std::string text;
    for (std::size_t i = 0; i < first.inlets.size() && i < 20; ++i) {
        const Inlet& inlet = first.inlets[i];
        text += fmt::format("#   {}: [{:.1f}, {:.1f}, {:.1f}] mm, radius {:.2f} mm{}{}\n", i + 1, 1e3 * inlet.point.x(),
                            1e3 * inlet.point.y(), 1e3 * inlet.point.z(), 1e3 * inlet.radius,
                            inlet.opening >= 0 ? ", an opening" : ", a closed end",
                            static_cast<int>(i) + 1 == first.inlet ? "  <- this one" : "");
    }
    if (first.inlets.size() > 20) text += fmt::format("#   and {} more (`seldinger vessel`)\n", first.inlets.size() - 20);
    return text;
}

}  // namespace

std::string first_scene_text(const FirstScene& first)
{
    // whole millimetres, a little short of where it would end
    const double advance = std::max(1e-3, 1e-3 * std::floor(1e3 * 0.95 * std::min(first.wire.reach, first.way.length)));
    const double duration = advance / feed_speed;
    const double length = 0.01 * std::ceil(100 * (advance + 0.05));
    std::error_code ignored;
    const auto folder = std::filesystem::weakly_canonical(std::filesystem::absolute(first.file), ignored).parent_path();
    const auto path_of = [&](const std::filesystem::path& file) {
        const auto whole = std::filesystem::weakly_canonical(std::filesystem::absolute(file), ignored);
        return toml_quoted(whole.lexically_proximate(folder).generic_string());
    };
    std::string centreline;
    if (!first.centreline.empty()) centreline = "centreline = " + path_of(first.centreline) + "\n";
    if (!first.centreline_units.empty()) centreline += fmt::format("centreline_units = \"{}\"\n", first.centreline_units);
    if (!first.centreline_space.empty()) centreline += fmt::format("centreline_space = \"{}\"\n", first.centreline_space);
    const bool digits = first.label.find_first_not_of("0123456789") == std::string::npos;
    const std::string label =
        first.label.empty() ? "" : fmt::format("label = {}\n", digits ? first.label : toml_quoted(first.label));
    std::string text = fmt::format("# {}: a first scene, as `seldinger init` proposes it. Every key: docs/scene-file.md.\n\n",
                                   one_line(first.mesh.filename().string()));
    const auto list = [](const Vec3& v) {
        return fmt::format("[{:.12g}, {:.12g}, {:.12g}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
    };
    text += fmt::format(
        "[scene]\nname = {}\ngravity = {}  # m/s^2: the patient lies on the back (docs/axes.md)\nduration_s = {:.2f}\n"
        "dt_s = 0.001\n\n",
        toml_quoted(one_line(first.mesh.stem().string())), list(9.81 * first.back), duration);
    text += fmt::format(
        "[vessel]\nmesh = {}\n{}units = \"{}\"  # {}\n{}wall = \"rigid\"  # as hard as the instrument needs; \"elastic\": "
        "it gives way, with youngs_pa = 1e6 unless given (docs/wall.md)\nthickness_m = 0.001\n\n",
        path_of(first.mesh), label, first.unit, first.unit_why, centreline);
    text += fmt::format("# {}.\n# Another one: `seldinger instruments` lists them.\n[wire]\npreset = \"{}\"\nlength_m = {:.2f}\n"
                        "nodes = \"adaptive\"\n\n",
                        first.wire.why, first.wire.name, length);
    text += fmt::format(
        "# Inlets, numbered as `seldinger vessel` lists them:\n{}# {}: {}.\n[feed]\ninlet = {}\n"
        "# Pushed at {:.0f} mm/s without turning; the longest way from here is {:.0f} mm.\n"
        "keys = [\n    {{ t_s = 0.0, advance_m = 0.0, turn_rad = 0.0 }},\n"
        "    {{ t_s = {:.2f}, advance_m = {:.3f}, turn_rad = 0.0 }},\n]\n",
        inlets_comment(first), first.inlet, first.inlet_why, first.inlet, 1e3 * feed_speed, 1e3 * first.way.length, duration,
        advance);
    text += fmt::format("\n# {}.\n[carm]\nhead = {}\nback = {}\n", first.axes_why, list(first.head), list(first.back));
    return text;
}

}  // namespace seldinger

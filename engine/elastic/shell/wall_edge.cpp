// The default control edge, and the memory that an edge needs.
#include "contact/wall_body.h"
#include "core/error.h"
#include "surface/control_mesh.h"
#include "surface/edge_field.h"
#include "wall/wall_model.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace seldinger {
namespace {

constexpr double most_vertices = 2000;  // below it a column of the compliance costs less than a millisecond
constexpr double least_share = 0.6, most_share = 1.0;
// where it is known where instruments touch
constexpr double most_elsewhere = 700, most_along_path = 3000;
constexpr double most_for_dent = 6000;                 // where edges would else be longer than a dent is resolved by
constexpr double path_share = 0.5,
                 reach_share = 1.0;  // of the decay length: an edge there, and how far from a contact it is wanted
constexpr double dent_share = 0.9;                     // of the decay length: the longest that is taken for less vertices
const double vertex_area = 0.5 * std::sqrt(3.0);       // of equilateral triangles, per square of their edge

double vertices_at(const WallSamples& wall, const Centreline& centreline, double edge, double share)
{
    return expected_vertices(wall, EdgeField(edge, share, centreline));
}

/// Where the falling f(x) comes down to `goal`, between low and high, to 0.1 %.
template <class F>
double solve_falling(double low, double high, double goal, F f)
{
    while (high > 1.001 * low) {
        const double middle = std::sqrt(low * high);
        (f(middle) > goal ? low : high) = middle;
    }
    return high;
}

/// Two digits, thousands set apart: "2,000".
std::string about(double count)
{
    const double unit = std::pow(10, std::floor(std::log10(count)) - 1);
    std::string text = fmt::format("{}", std::llround(std::round(count / unit) * unit));
    for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<std::size_t>(at), ",");
    return text;
}

std::string millimetres(double length) { return fmt::format("{:.2g} mm", 1e3 * length); }

/// One edge length everywhere but in narrow branches, for at most `most` vertices.
WallEdge even_edge(const WallModel& wall, const WallSamples& samples, double most)
{
    const double radius = wall.typical_lumen_radius, third = radius / 3;
    const double half_decay = 0.5 * decay_length(wall.spec, radius);
    const bool by_radius = third < half_decay;
    const double wanted = std::min(third, half_decay);
    const char* reason = by_radius ? "a third of the lumen's radius" : "half the decay length";
    const auto vertices = [&](double edge, double share) { return vertices_at(samples, wall.centreline, edge, share); };

    WallEdge choice{wanted, least_share, {}, 0, ""};
    if (std::isfinite(wanted)) choice.vertices = vertices(wanted, least_share);
    if (std::isfinite(wanted) && choice.vertices <= most) {
        choice.why = fmt::format("{} ({})", millimetres(wanted), reason);
        return choice;
    }
    // longer edges, up to those that the widest lumen allows; then longer ones in narrow branches too
    const auto& radii = wall.centreline.radius;
    const double widest = radii.empty() ? std::sqrt(samples.area) : *std::max_element(radii.begin(), radii.end());
    const double low = std::isfinite(wanted) ? wanted : 1e-3 * widest;
    const auto longest = [&](double share) { return std::max(low, share * widest); };
    if (vertices(longest(least_share), least_share) > most)
        choice.share = solve_falling(least_share, most_share, most, [&](double s) { return vertices(longest(s), s); });
    choice.edge = choice.share > least_share ? longest(choice.share)
                                             : solve_falling(low, longest(least_share), most,
                                                             [&](double e) { return vertices(e, least_share); });
    choice.vertices = vertices(choice.edge, choice.share);
    choice.why = fmt::format("{} ({} vertices", millimetres(choice.edge), about(choice.vertices));
    if (choice.share > least_share) choice.why += fmt::format(", edges {:.2g} of the local radius", choice.share);
    choice.why += std::isfinite(wanted) ? fmt::format("; {} would be {})", reason, millimetres(wanted)) : ")";
    return choice;
}

/// Short where instruments touch. Two path edges give fields that differ by the same length everywhere along the path: one look
/// at each sample is enough for all of them.
void add_path(const WallModel& wall, WallEdge& choice)
{
    const double decay = decay_length(wall);
    const double wanted = path_share * decay;
    if (!std::isfinite(decay) || !(wanted < choice.edge)) return;
    EdgePath path{wall.spec.touched, 0, reach_share * decay};
    for (const WallLoad& load : wall.spec.loads)
        if (!load.force.isZero()) path.points.push_back(load.at);
    const WallSamples samples = spread_over_wall(wall.mesh);
    const EdgeField even(choice.edge, choice.share, wall.centreline);
    const EdgeField beyond(std::numeric_limits<double>::max(), choice.share, {}, path);
    std::vector<double> of_even, of_path;
    for (const Vec3& p : samples.points) of_even.push_back(even.at(p)), of_path.push_back(beyond.at(p));
    const double each = samples.area / static_cast<double>(samples.points.size());
    const auto vertices = [&](double edge) {
        double sum = 0;
        for (std::size_t k = 0; k < of_even.size(); ++k)
            sum += each / (vertex_area * std::pow(std::min(of_even[k], edge + of_path[k]), 2));
        return sum;
    };
    const auto edge_for = [&](double most) {
        return vertices(wanted) <= most ? wanted : solve_falling(wanted, choice.edge, most, vertices);
    };
    path.edge = edge_for(most_along_path);
    if (path.edge > dent_share * decay) path.edge = std::max(dent_share * decay, edge_for(most_for_dent));
    if (!(path.edge < 0.9 * choice.edge)) return;
    choice.vertices = vertices(path.edge);
    choice.why = fmt::format("{} where instruments touch in a trial run with a rigid wall, {} elsewhere ({} vertices{})",
                             millimetres(path.edge), millimetres(choice.edge), about(choice.vertices),
                             path.edge > wanted ? fmt::format("; {} would be wanted", millimetres(wanted)) : "");
    choice.path = std::move(path);
}

}  // namespace

WallEdge choose_wall_edge(const WallModel& wall)
{
    const bool known = !wall.spec.touched.empty();
    WallEdge choice = even_edge(wall, sample_wall(wall.mesh), known ? most_elsewhere : most_vertices);
    if (known) add_path(wall, choice);
    return known && choice.path.points.empty() ? even_edge(wall, sample_wall(wall.mesh), most_vertices) : choice;
}

WallMechanics expected_mechanics(const VesselSpec& spec, const WallMesh& mesh, const Centreline& centreline)
{
    if (!spec.elastic || mesh.triangles.empty()) return {};
    const WallModel wall(spec, mesh, centreline);
    WallMechanics made;
    made.decay = decay_length(wall);
    const WallSamples samples = sample_wall(mesh);
    const double vertices = spec.wall_edge > 0
                                ? expected_vertices(samples, EdgeField(spec.wall_edge, ControlMeshSpec{}.share, centreline))
                                : choose_wall_edge(wall).vertices;
    made.vertices = static_cast<int>(std::lround(vertices));
    made.edge = made.edge_touched = std::sqrt(samples.area / (vertex_area * vertices));
    return made;
}

double factor_bytes(double vertices)
{
    // Blocks of 3 x 3 per vertex in the factor after approximate minimum degree, for a tube, a plane and an aortic arch. They
    // are 29 to 38 at 600 to 1,200 vertices, 61 at 2,500, 95 at 7,000, 104 at 14,000. They grow like log V, as nested
    // dissection says [George 1973, doi:10.1137/0710032]. Each entry has 8 bytes and its row's index 4.
    const double blocks = std::max(30.0, 16 * std::log2(std::max(vertices, 2.0)) - 110);
    return 9 * 12 * vertices * blocks;
}

void check_control_edge(double area, double edge)
{
    const double vertices = area / (0.5 * std::sqrt(3.0) * edge * edge), bytes = factor_bytes(vertices);
    const double most = 0.5 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes <= most) return;
    throw Error(
        ErrorKind::BadScene,
        fmt::format(
            "vessel.wall_edge_m: {:.3g} m makes about {:.2g} vertices, whose matrix factor takes {:.3g} GB, more than half "
            "of this machine's memory; make it longer, or take it out to have it chosen",
            edge, vertices, 1e-9 * bytes));
}

}  // namespace seldinger

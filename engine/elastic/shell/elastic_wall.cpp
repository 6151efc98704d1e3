// The wall as a body, made from the vessel's mesh, and its readings.
#include "shell/elastic_wall.h"
#include "contact/wall_body.h"
#include "core/clock.h"
#include "shell/large_shell.h"
#include "shell/wall_compliance.h"

#include "vessel/triangle_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

// Shares of the lumen's radius and of the wall's thickness up to which linear theory does: displacements are then within 2 % of
// those under large displacements (docs/wall.md). What a triangle leaves out below `still` of slope are strains of 5e-5.
constexpr double linear_radius = 0.01, linear_thickness = 0.1, still = 0.01;

ShellSpec shell_spec(const VesselSpec& vessel)
{
    return {.youngs = vessel.youngs,
            .poisson = vessel.poisson,
            .thickness = vessel.thickness,
            .support = vessel.support,
            .support_damping = vessel.support_damping,
            .relaxation = vessel.relaxation,
            .pressure = vessel.pressure,
            .rims_held = vessel.rims_held};
}

/// Direction and radius of the vessel near a place of its wall.
PrestressAt along(const Centreline& centreline)
{
    if (centreline.points.size() < 2) return {};
    return [&centreline, hint = -1](const Vec3& position) mutable {
        hint = centreline.nearest(position, hint);
        int from = centreline.parent[hint], to = hint;
        if (from < 0) {
            from = hint;
            to =
                static_cast<int>(std::find(centreline.parent.begin(), centreline.parent.end(), hint) - centreline.parent.begin());
        }
        Prestress here;
        here.axis = to < static_cast<int>(centreline.points.size()) ? Vec3(centreline.points[to] - centreline.points[from])
                                                                    : Vec3(Vec3::UnitZ());
        here.radius = centreline.radius[hint];
        return here;
    };
}

WallMesh control_mesh(const WallModel& wall, std::string& reason, double& off, double& edge_touched)
{
    ControlMeshSpec spec;
    spec.centreline = &wall.centreline;
    if (wall.spec.wall_edge > 0) {
        spec.edge = wall.spec.wall_edge;
        reason = fmt::format("{:.3g} mm (asked for)", 1e3 * spec.edge);
    } else {
        const WallEdge chosen = choose_wall_edge(wall);
        spec.edge = chosen.edge;
        spec.share = chosen.share;
        spec.path = chosen.path;
        edge_touched = chosen.path.edge;
        reason = chosen.why;
    }
    ControlMeshReport report;
    WallMesh made = make_control_mesh(wall.mesh, spec, &report);
    off = report.distance;
    return made;
}

/// Virtual work of a force at a place of the surface.
void add_force(const LoopSurface& surface, std::int32_t triangle, double u, double v, const Vec3& force, std::vector<double>& to)
{
    LoopStencil at;
    surface.basis(triangle, u, v, at);
    for (int k = 0; k < at.size; ++k) add_to(&to[3 * static_cast<std::size_t>(at.vertex[k])], at.n[k] * force);
}

/// @param at  gets the places where they act
std::vector<double> loads_on(const LoopSurface& surface, const Shell& shell, std::span<const WallLoad> loads,
                             std::vector<LoopFoot>& at)
{
    constexpr std::size_t of_pressure = 16;  // places to look at
    if (loads.empty()) return {};
    std::vector<double> to(3 * surface.control().vertices.size(), 0.0);
    for (const WallLoad& load : loads) {
        if (load.pressure != 0)
            for (const ShellPoint& q : shell.points())
                add_force(surface, q.triangle, q.u, q.v, -load.pressure * q.area * q.normal, to);
        for (std::size_t k = 0; load.pressure != 0 && k < of_pressure; ++k) {
            const ShellPoint& q = shell.points()[k * shell.points().size() / of_pressure];
            LoopFoot foot;
            foot.triangle = q.triangle, foot.u = q.u, foot.v = q.v;
            at.push_back(foot);
        }
        if (load.force.isZero()) continue;
        LoopFoot foot;
        surface.closest(load.at, foot);
        at.push_back(foot);
        add_force(surface, foot.triangle, foot.u, foot.v, load.force, to);
    }
    return to;
}

}  // namespace

void check_wall_body(const WallModel& wall)
{
    std::string reason;
    double off = 0, edge_touched = 0;
    const LoopSurface surface(control_mesh(wall, reason, off, edge_touched));
}

ElasticWall::~ElasticWall() = default;

ElasticWall::ElasticWall(const WallModel& wall)
{
    const auto start = Clock::now();
    WallMesh control = control_mesh(wall, edge_reason_, off_, edge_touched_);
    const std::vector<Vec3> through = control.vertices;
    surface_ = std::make_unique<LoopSurface>(std::move(control));
    edge_ = surface_->mean_edge();
    if (edge_touched_ == 0) edge_touched_ = edge_;
    plane_ = wall.spec.shape == VesselShape::Plane;
    decay_ = decay_length(wall);
    surface_->interpolate(through);
    shell_ = std::make_unique<Shell>(*surface_, shell_spec(wall.spec));
    compliance_ = std::make_unique<WallCompliance>(*shell_, wall.spec.pressure != 0 ? along(wall.centreline) : PrestressAt{});
    load_ = loads_on(*surface_, *shell_, wall.spec.loads, loaded_);
    const auto vertices = static_cast<std::int32_t>(surface_->control().vertices.size());
    limits_.resize(static_cast<std::size_t>(vertices));
    for (std::int32_t v = 0; v < vertices; ++v) surface_->limit_of_vertex(v, limits_[static_cast<std::size_t>(v)]);
    for (const Vec3& p : surface_->control().vertices) largest_move_.push_back(0.2 * lumen_radius_at(wall, p));
    made_in_ = seconds_since(start);
}

double ElasticWall::largest_move(const LoopStencil& place) const
{
    double sum = 0, weight = 0;
    for (int k = 0; k < place.size; ++k) {
        sum += place.n[k] * largest_move_[static_cast<std::size_t>(place.vertex[k])];
        weight += place.n[k];
    }
    return weight > 0 ? sum / weight : sum;
}

double ElasticWall::edge_of(std::int32_t triangle) const
{
    const double area = 0.5 * double_area(triangle_of(surface_->control(), static_cast<std::size_t>(triangle))).norm();
    return std::sqrt(4 / std::sqrt(3.0) * area);
}

WallMeshBand ElasticWall::band_of(std::int32_t triangle) const { return wall_mesh_band(edge_of(triangle), decay_, plane_); }

double ElasticWall::left_out(double move) const { return linear_theory_band(move, shell_->spec().thickness, plane_); }

LostPeak ElasticWall::lost_peak(std::int32_t triangle, double load) const
{
    const ShellSpec& spec = shell_->spec();
    return seldinger::lost_peak(load, edge_of(triangle), decay_, spec.thickness, spec.poisson);
}

WallMechanics ElasticWall::mechanics() const
{
    const WallCounts counts = compliance_->counts();
    return {compliance_->vertex_count(), edge_,          edge_touched_, decay_, made_in_,
            counts.factor_seconds,       counts.columns, counts.bytes};
}

ElasticWall::MemorySplit ElasticWall::memory_split(double h) const
{
    const ShellSpec& spec = shell_->spec();
    return {spec.relaxation / (h + spec.relaxation),
            (spec.support_damping - spec.relaxation * spec.support) / (h + spec.relaxation)};
}

void ElasticWall::add_memory_force(double h, std::span<const double> w, std::span<double> y) const
{
    const auto [s, b] = memory_split(h);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const auto vertices = static_cast<Eigen::Index>(w.size() / 3);
    const Eigen::Map<const Rows> from(w.data(), vertices, 3);
    Eigen::Map<Rows>(y.data(), vertices, 3) += b * (compliance_->matrices().area * from);
    const SparseMatrix& pressure = compliance_->matrices().pressure;
    if (pressure.rows() == 0) return;
    const auto size = static_cast<Eigen::Index>(w.size());
    Eigen::Map<Eigen::VectorXd>(y.data(), size) -= s * (pressure * Eigen::Map<const Eigen::VectorXd>(w.data(), size));
}

const LargeShell* ElasticWall::large_for(std::span<const double> w) const
{
    bool large = false;
    for (std::size_t v = 0; v < largest_move_.size() && !large; ++v) {
        const double radius = 5 * largest_move_[v];
        large = Vec3(&w[3 * v]).norm() > std::min(linear_radius * radius, linear_thickness * shell_->spec().thickness);
    }
    if (!large) return nullptr;
    std::call_once(large_made_, [&] { large_ = std::make_unique<LargeShell>(*shell_); });
    return large_.get();
}

void ElasticWall::take_excess_force(const LargeShell& large, std::span<const double> w, std::span<double> y, bool all) const
{
    std::vector<double> excess(y.size(), 0.0);
    large.add_excess(w, excess, all ? 0 : still);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] -= excess[i];
}

double ElasticWall::memory_share(double h) const
{
    const ShellSpec& spec = shell_->spec();
    return memory_split(h).left / (spec.support + spec.support_damping / h);
}

namespace {

double move_at(const LoopStencil& at, std::span<const double> w)
{
    Vec3 move = Vec3::Zero();
    for (int k = 0; k < at.size; ++k) move += at.n[k] * Vec3(&w[3 * static_cast<std::size_t>(at.vertex[k])]);
    return move.norm();
}

/// Where a place of the surface is while the wall has not moved [m].
void put_place(const ElasticWall& wall, const LoopStencil& at, double (&to)[3])
{
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < at.size; ++k)
        place += at.n[k] * wall.surface().control().vertices[static_cast<std::size_t>(at.vertex[k])];
    for (int c = 0; c < 3; ++c) to[c] = place[c];
}

/// Largest move: limit positions of control vertices, and points between them about the largest one.
/// @param now  of which move_max, its place and move_share are set
void read_move(const ElasticWall& wall, std::span<const double> w, WallReadings& now)
{
    const LoopSurface& surface = wall.surface();
    LoopStencil at;
    std::int32_t farthest = -1;
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(surface.control().vertices.size()); ++v) {
        const double move = move_at(wall.limit(v), w);
        now.move_share = std::max(now.move_share, move / wall.largest_move(wall.limit(v)));
        if (move > now.move_max) now.move_max = move, farthest = v;
    }
    if (farthest >= 0) put_place(wall, wall.limit(farthest), now.move_at);
    constexpr int parts = 6;
    for (std::int32_t t = 0; farthest >= 0 && t < surface.topology().triangle_count(); ++t) {
        const auto& corners = surface.control().triangles[static_cast<std::size_t>(t)];
        if (std::find(corners.begin(), corners.end(), farthest) == corners.end()) continue;
        now.move_band.mesh = std::max(now.move_band.mesh, wall.band_of(t).move);
        for (int i = 0; i <= parts; ++i)
            for (int j = 0; i + j <= parts; ++j) {
                surface.basis(t, double(i) / parts, double(j) / parts, at);
                const double move = move_at(at, w);
                if (!(move > now.move_max)) continue;
                now.move_max = move;
                put_place(wall, at, now.move_at);
            }
    }
    now.move_band.mesh *= now.move_max;
}

}  // namespace

void add_geometry(const ElasticWall& wall, double farthest, WallReadings& now)
{
    const double share = wall.left_out(farthest);
    now.move_band.geometry = share * now.move_max;
    now.stress_band.geometry = share * now.stress_max;
}

WallReadings read_wall(const ElasticWall& wall, std::span<const double> displaced, double work, std::vector<double>* stress)
{
    WallReadings now;
    if (std::all_of(displaced.begin(), displaced.end(), [](double move) { return move == 0; })) {  // it has not been touched yet
        now.loss = work;
        if (stress) stress->assign(displaced.size() / 3, 0.0);
        return now;
    }
    read_move(wall, displaced, now);
    const Eigen::Map<const Eigen::VectorXd> w(displaced.data(), static_cast<Eigen::Index>(displaced.size()));
    now.energy = 0.5 * w.dot(wall.compliance().stiffness() * w);
    const LargeShell* large = wall.large_for(displaced);
    double excess = 0;  // in one pass with the stress: a run reads both for every row of its tables
    const ShellStress at = wall.shell().stress(displaced, large, &excess);
    now.energy += excess;
    for (std::size_t i = 0; i < wall.load().size(); ++i) work += wall.load()[i] * displaced[i];
    now.loss = work - now.energy;
    if (stress) stress->resize(at.mises_inner.size());
    for (std::size_t v = 0; stress && v < at.mises_inner.size(); ++v)
        (*stress)[v] = std::max(at.mises_inner[v], at.mises_outer[v]);
    now.stress_max = at.mises_max;
    const ShellPoint& highest = wall.shell().points()[at.highest];
    highest.position.store(now.stress_at);
    now.stress_band.mesh = now.stress_max * wall.band_of(highest.triangle).stress;
    if (!large) add_geometry(wall, now.move_max, now);
    return now;
}

}  // namespace seldinger

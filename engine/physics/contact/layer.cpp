// The published layer method: pairs found, evaluated and carried from step to step.
#include "contact/layer.h"

#include "contact/point_states.h"
#include "contact/programs.h"
#include "contact/wall_law.h"
#include "core/clock.h"
#include "core/error.h"
#include "core/state_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double pair_length = 1e-3;  // stiffness of one pair = line stiffness x 1 mm [m]
constexpr device::Queue light = device::Queue::Inline;

double pair_distance(const ContactSpec& contact, double radius)
{
    return contact.pair_distance > 0 ? contact.pair_distance : radius / 2;
}

double layer_height(const ContactSpec& contact, double radius)
{
    return contact.layer_height > 0 ? contact.layer_height : radius + pair_distance(contact, radius);
}

}  // namespace

double layer_width(double radius, double lumen_radius) { return radius * (0.25 + 1.75 * std::min(1.0, radius / lumen_radius)); }

LayerContact::LayerContact(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree)
    : ContactMethod(context, setup, rods, tree),
      setup_(setup),
      typical_radius_(setup.wall.typical_lumen_radius),
      find_(context, programs::layer, "layer_find"),
      evaluate_(context, programs::layer, "layer_evaluate"),
      reduce_(context, programs::layer, "contact_reduce")
{
    params_.slots = 64;
    params_.friction = kernel_law(setup.method().friction);
    params_.smooth_speed = smooth_friction_speed;
    const std::size_t n = rods.total_capacity();
    edges_.reserve(n);
    sums_.edges.resize(n);
    sums_.wire_edges.assign(rods.wire_count() + 1, 0);
    epochs_.assign(rods.wire_count(), 2);  // see WireQuadrature::epoch
    edge_list_ = device::Buffer(context, n * sizeof(LayerEdge));
    count_buffer_ = device::Buffer(context, n * sizeof(std::uint32_t));
    touching_buffer_ = device::Buffer(context, n * sizeof(real));
    first_buffer_ = device::Buffer(context, (n + 1) * sizeof(std::uint32_t));
    edge_sums_ = device::Buffer(context, n * sizeof(EdgeForce));
    candidates_ = device::Buffer(context, n * params_.slots * sizeof(std::uint32_t));
    warm_up();
}

// See CapsuleContact::warm_up.
void LayerContact::warm_up()
{
    ContactParams none = params_;
    none.item_count = 0;
    context_.enter(light);
    find_.launch(light, 1, none, edge_list_, nodes_, wall_, candidates_, count_buffer_, touching_buffer_);
    evaluate_.launch(light, 1, none, pair_list_, edge_list_, wall_, nodes_, nodes_before(), states_t0_, states_, forces_, barys_);
    reduce_.launch(light, 1, cl_uint{0}, first_buffer_, forces_, barys_, edge_sums_);
    context_.finish(light);
}

void LayerContact::begin(RodArrays& rods)
{
    for (int w = 0; w < rods.wire_count(); ++w) {
        const RodView rod = rods.view(w);
        for (int i = 0; i < rod.n; ++i)
            nodes_t0_.set(rods.node_begin(w) + i, rod.x[i], rod.y[i], rod.z[i], i + 1 < rod.n ? rod.theta[i] : 0.0, wall_.centre);
    }
}

double LayerContact::lumen_radius_at(const Vec3& p)
{
    if (setup_.wall.centreline.empty()) return typical_radius_;
    centreline_hint_ = setup_.wall.centreline.nearest(p, centreline_hint_);
    return setup_.wall.centreline.radius[centreline_hint_];
}

void LayerContact::list_edges(std::span<const std::uint8_t> live)
{
    edges_.clear();
    edge_wire_.clear();
    centreline_hint_ = -1;  // within a step only: a restored run must find the same point
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!live[w]) continue;
        const RodView rod = rods_.view(w);
        const WireSpec& wire = setup_.wires[w];
        const ContactSpec& contact = setup_.contacts[w];
        for (int j = 0; j + 1 < rod.n; ++j) {
            const WireSection& section = wire.at((rod.material_s[j] + rod.material_s[j + 1]) / 2);
            LayerEdge edge{};
            edge.node = static_cast<uint>(rods_.node_begin(w) + j);
            edge.epoch = epochs_[w];
            edge.reach = pair_distance(contact, section.radius);
            edge.height = layer_height(contact, section.radius);
            edge.width = layer_width(section.radius, lumen_radius_at((rod.pos(j) + rod.pos(j + 1)) / 2));
            edge.model = line_model(section, contact, setup_.wall.spec, typical_radius_, pair_length);
            edge.model.length = 0;
            edge.model.depth_limit = 0;  // as published: no hardening
            edges_.push_back(edge);
            edge_wire_.push_back(static_cast<std::uint32_t>(w));
        }
    }
}

void LayerContact::prepare(RodArrays& rods, std::span<const std::uint8_t> live)
{
    const auto start = Clock::now();
    for (int w = 0; w < rods.wire_count(); ++w) {
        const RodView rod = rods.view(w);
        for (int i = 0; i < rod.n; ++i)
            nodes_.set(rods.node_begin(w) + i, rod.x[i], rod.y[i], rod.z[i], i + 1 < rod.n ? rod.theta[i] : 0.0, wall_.centre);
    }
    list_edges(live);
    counts_.assign(edges_.size(), 0);
    if (!edges_.empty()) {
        context_.enter(light);
        nodes_.upload(context_, light);
        nodes_t0_.upload(context_, light);
        context_.write(light, edge_list_, edges_.data(), edges_.size() * sizeof(LayerEdge));
        for (bool again = true; again;) {
            params_.item_count = static_cast<uint>(edges_.size());
            find_.launch(light, edges_.size(), params_, edge_list_, nodes_, wall_, candidates_, count_buffer_, touching_buffer_);
            context_.read(light, count_buffer_, counts_.data(), counts_.size() * sizeof(std::uint32_t));
            const std::uint32_t most = *std::max_element(counts_.begin(), counts_.end());
            again = most > params_.slots;
            if (again) {
                params_.slots = (most + most / 2 + 7) / 8 * 8;
                candidates_ = device::Buffer(context_, rods.total_capacity() * params_.slots * sizeof(std::uint32_t));
            }
        }
        touching_.resize(edges_.size());
        context_.read(light, touching_buffer_, touching_.data(), touching_.size() * sizeof(real));
        candidates_host_.resize(edges_.size() * params_.slots);
        context_.read(light, candidates_, candidates_host_.data(), candidates_host_.size() * sizeof(std::uint32_t));
    }
    list_pairs();
    times.detect += seconds_since(start);
}

// Pairs ordered by wire, edge and triangle, each with its record of the last step where it had one.
void LayerContact::list_pairs()
{
    pairs_.clear();
    keys_.clear();
    first_.clear();
    sums_.edge_node.clear();
    paired_edges_.clear();
    std::fill(sums_.wire_edges.begin(), sums_.wire_edges.end(), 0);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        if (counts_[e] == 0) continue;
        std::uint32_t* found = &candidates_host_[e * params_.slots];
        std::sort(found, found + counts_[e]);
        first_.push_back(static_cast<std::uint32_t>(pairs_.size()));
        sums_.edge_node.push_back(edges_[e].node);
        paired_edges_.push_back(static_cast<std::uint32_t>(e));
        for (std::size_t w = edge_wire_[e] + 1; w < sums_.wire_edges.size(); ++w) sums_.wire_edges[w]++;
        for (std::uint32_t k = 0; k < counts_[e]; ++k) {
            const Key key{edge_wire_[e], edges_[e].node, found[k]};
            const auto last = std::lower_bound(last_keys_.begin(), last_keys_.end(), key);
            const bool known = last != last_keys_.end() && *last == key;
            keys_.push_back(key);
            pairs_.push_back(
                {static_cast<uint>(e), found[k], known ? static_cast<uint>(last - last_keys_.begin()) : SEL_NO_EDGE, 0});
        }
    }
    first_.push_back(static_cast<std::uint32_t>(pairs_.size()));
    const std::size_t n = std::max<std::size_t>(pairs_.size(), 1);
    if (forces_.bytes() < n * sizeof(ContactForce)) {  // grows in a few jumps at the start of a run
        const std::size_t room = 2 * n;
        forces_ = device::Buffer(context_, room * sizeof(ContactForce));
        barys_ = device::Buffer(context_, room * sizeof(real));
        pair_list_ = device::Buffer(context_, room * sizeof(LayerPair));
        states_ = device::Buffer(context_, room * sizeof(ContactState));
    }
    context_.write(light, pair_list_, pairs_.data(), pairs_.size() * sizeof(LayerPair));
    context_.write(light, first_buffer_, first_.data(), first_.size() * sizeof(std::uint32_t));
    context_.finish(light);
}

void LayerContact::evaluate_forces(const TermTrial& trial)
{
    const auto start = Clock::now();
    if (!pairs_.empty()) {
        set_nodes(nodes_, trial.at);
        context_.enter(light);
        upload_nodes(light);
        params_.item_count = static_cast<uint>(pairs_.size());
        params_.inv_dt = trial.h > 0 ? 1 / trial.h : 0;
        if (states_t0_.bytes() == 0) states_t0_ = device::Buffer(context_, sizeof(ContactState));
        const DeviceNodes& before = nodes_before();
        evaluate_.launch(light, pairs_.size(), params_, pair_list_, edge_list_, wall_, nodes_, before, states_t0_, states_,
                         forces_, barys_);
        const std::size_t edges = sums_.edge_node.size();
        reduce_.launch(light, edges, static_cast<cl_uint>(edges), first_buffer_, forces_, barys_, edge_sums_);
        context_.read(light, edge_sums_, sums_.edges.data(), edges * sizeof(EdgeForce));
        // a pair represents no length of wire; its edge's layer does
        for (std::size_t e = 0; e < edges; ++e)
            if (sums_.edges[e].contacts > 0) sums_.edges[e].length = touching_[paired_edges_[e]];
    }
    times.evaluate += seconds_since(start);
}

TermAnswer LayerContact::answer(int wire, Ask what)
{
    TermAnswer answer = ContactMethod::answer(wire, what);
    answer.admissible = true;  // as published: nothing refuses a trial
    return answer;
}

void LayerContact::commit(std::span<const std::uint8_t> active)
{
    if (std::all_of(active.begin(), active.end(), [](std::uint8_t on) { return on != 0; })) {
        std::swap(states_t0_, states_);
        if (states_.bytes() < states_t0_.bytes()) states_ = device::Buffer(context_, states_t0_.bytes());
        last_keys_ = keys_;
    } else {
        merge_records(active);
    }
    for (std::size_t w = 0; w < epochs_.size(); ++w)
        if (active[w]) epochs_[w]++;
}

// New records for the wires that took the trial, the last ones for the others (which did not converge, or had no part in this
// sub-step). Both lists are ordered by wire. Rare, so on the host.
void LayerContact::merge_records(std::span<const std::uint8_t> active)
{
    std::vector<ContactState> now(keys_.size()), before(last_keys_.size()), merged;
    context_.enter(light);
    context_.read(light, states_, now.data(), now.size() * sizeof(ContactState));
    context_.read(light, states_t0_, before.data(), before.size() * sizeof(ContactState));
    std::vector<Key> keys;
    for (std::size_t w = 0; w < active.size(); ++w) {
        const std::vector<Key>& from = active[w] ? keys_ : last_keys_;
        for (std::size_t k = 0; k < from.size(); ++k) {
            if (from[k].wire != w) continue;
            keys.push_back(from[k]);
            merged.push_back((active[w] ? now : before)[k]);
        }
    }
    last_keys_ = std::move(keys);
    if (states_t0_.bytes() < merged.size() * sizeof(ContactState))
        states_t0_ = device::Buffer(context_, 2 * merged.size() * sizeof(ContactState));
    context_.write(light, states_t0_, merged.data(), merged.size() * sizeof(ContactState));
    context_.finish(light);
}

namespace {

/// Where on the wire a point of the wall is nearest to an edge [m].
double along_edge(const RodView& rod, int edge, const Vec3& point)
{
    if (edge > rod.n - 2) return rod.material_s[rod.n - 1];  // nodes may have changed since
    const Vec3 from = rod.pos(edge), to = rod.pos(edge + 1);
    const double share = std::clamp((point - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (1 - share) * rod.material_s[edge] + share * rod.material_s[edge + 1];
}

}  // namespace

std::vector<ContactRow> LayerContact::rows(RodArrays& rods)
{
    std::vector<ContactState> states(last_keys_.size());
    context_.enter(light);
    context_.read(light, states_t0_, states.data(), states.size() * sizeof(ContactState));
    std::vector<ContactRow> rows;
    for (std::size_t k = 0; k < states.size(); ++k) {
        const ContactState& state = states[k];
        if (!(state.flags & SEL_CONTACT_ACTIVE)) continue;
        ContactRow row;
        const int wire = static_cast<int>(last_keys_[k].wire);
        row.a = {BodyKind::Rod, wire, static_cast<int>(last_keys_[k].edge) - rods.node_begin(wire)};
        row.b = {BodyKind::Wall, 0, static_cast<int>(wall_.original[last_keys_[k].triangle])};
        row.point = wall_.centre + Vec3(state.point[0], state.point[1], state.point[2]);
        row.normal = {state.normal[0], state.normal[1], state.normal[2]};
        row.gap = state.gap;
        row.normal_force = state.normal_force;
        row.friction = {state.friction[0], state.friction[1], state.friction[2]};
        row.rolling_moment = state.moment;
        row.stuck = state.flags & SEL_CONTACT_STUCK;
        row.along_a = along_edge(rods.view(wire), row.a.element, row.point);
        rows.push_back(row);
    }
    std::stable_sort(rows.begin(), rows.end(), [](const ContactRow& x, const ContactRow& y) {
        return std::tie(x.a.body, x.a.element, x.b.element) < std::tie(y.a.body, y.a.element, y.b.element);
    });
    return rows;
}

std::vector<std::pair<std::string, std::string>> LayerContact::describe() const
{
    const WireSection& section = setup_.wires[0].shaft;
    const ContactSpec& contact = setup_.method();
    const QuadratureModel m = line_model(section, contact, setup_.wall.spec, typical_radius_, pair_length);
    return {{"layer", fmt::format("L' by {} halvings, w = r (1/4 + 7/4 r/R), h {:.3g} mm, H {:.3g} mm", SEL_LAYER_HALVINGS,
                                  1e3 * layer_height(contact, section.radius), 1e3 * pair_distance(contact, section.radius))},
            {"pair stiffness", fmt::format("{:.4g} N/m^{:.3g} (line stiffness x 1 mm), exponent {}", m.stiffness * m.weight,
                                           m.exponent, m.exponent)}};
}

void LayerContact::check_keys(std::span<const Key> keys, int wire) const
{
    const auto begin = static_cast<std::uint32_t>(rods_.node_begin(wire));
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const Key& key = keys[k];
        if ((k > 0 && !(keys[k - 1] < key)) || key.edge < begin ||
            key.edge - begin >= static_cast<std::uint32_t>(rods_.capacity(wire)) || key.triangle >= wall_.original.size())
            throw Error(ErrorKind::BadFile, "the saved state has contacts on edges or triangles that this scene does not have");
    }
}

void LayerContact::walk_state(StateWalk& walk, int wire)
{
    const Key of{static_cast<std::uint32_t>(wire), 0, 0}, behind{of.wire + 1, 0, 0};
    const auto first = std::lower_bound(last_keys_.begin(), last_keys_.end(), of);
    const auto end = std::lower_bound(first, last_keys_.end(), behind);
    const auto at = first - last_keys_.begin(), count = end - first;
    std::vector<Key> keys(first, end);
    const auto node = static_cast<std::uint32_t>(rods_.node_begin(wire));
    for (Key& key : keys) key = {0, key.edge - node, key.triangle};  // as in a world of this wire alone
    std::vector<ContactState> own(keys.size());
    context_.enter(light);
    context_.read(light, states_t0_, own.data(), own.size() * sizeof(ContactState),
                  static_cast<std::size_t>(at) * sizeof(ContactState));
    walk.list<std::uint64_t>({"a contact's edge", "", "accept"}, keys);
    own.resize(keys.size());
    walk({"a contact", "", "accept"}, std::span(own));
    walk({"the number of a step", "", "accept"}, epochs_[static_cast<std::size_t>(wire)]);
    if (!walk.reads()) return;
    for (Key& key : keys) key = {of.wire, key.edge + node, key.triangle};
    check_keys(keys, wire);
    check_contact_states(own, wall_.original.size());
    std::vector<ContactState> states(last_keys_.size());
    context_.read(light, states_t0_, states.data(), states.size() * sizeof(ContactState));
    last_keys_.insert(last_keys_.erase(first, end), keys.begin(), keys.end());
    states.insert(states.erase(states.begin() + at, states.begin() + at + count), own.begin(), own.end());
    states_t0_ = device::Buffer(context_, std::max<std::size_t>(states.size(), 1) * sizeof(ContactState));
    context_.write(light, states_t0_, states.data(), states.size() * sizeof(ContactState));
    context_.finish(light);
}

}  // namespace seldinger

// Residuals of steps cut short, from one step to the next.

#include "world/carried.h"

#include "core/bytes.h"
#include "core/error.h"
#include "solve/solver.h"

#include <algorithm>

namespace seldinger {

namespace {

constexpr std::uint32_t most_carried = 1u << 20;  // places of one wire, in a file

}  // namespace

void add_left(const ConstRodView& rod, const Solver& solver, int wire, double h, std::vector<CarriedImpulse>& left)
{
    double s = 0;
    for (int i = 0; i < rod.n; ++i) {
        const Vec3 force = solver.force_left(wire, i);
        if (!force.isZero()) left.push_back({s, -h * force});
        if (i + 1 < rod.n) s += rod.rest_length[i];
    }
}

void carry(const ConstRodView& rod, const std::vector<CarriedImpulse>& left, double dt, WireConstraints& constraints)
{
    int edge = 0;
    double begin = 0;
    for (const CarriedImpulse& at : left) {  // from the tip on, but for those of several sub-steps
        if (at.s < begin) edge = 0, begin = 0;
        while (edge + 2 < rod.n && at.s >= begin + rod.rest_length[edge]) begin += rod.rest_length[edge++];
        const double bary = std::clamp((at.s - begin) / rod.rest_length[edge], 0.0, 1.0);
        constraints.carried.push_back({edge, bary, (1 / dt) * at.impulse, Vec3::Zero()});
    }
}

void put_carried(std::vector<std::uint8_t>& bytes, const std::vector<std::vector<CarriedImpulse>>& carried, std::span<const int> wires)
{
    const auto has = [&](int w) { return !carried[static_cast<std::size_t>(w)].empty(); };
    if (std::none_of(wires.begin(), wires.end(), has)) return;
    for (const int w : wires) {
        const std::vector<CarriedImpulse>& of = carried[static_cast<std::size_t>(w)];
        const auto count = static_cast<std::uint32_t>(of.size());
        put_bytes(bytes, &count, 1);
        for (const CarriedImpulse& at : of) {
            put_bytes(bytes, &at.s, 1);
            put_bytes(bytes, at.impulse.data(), 3);
        }
    }
}

void take_carried(const std::uint8_t*& bytes, const std::uint8_t* end, std::vector<std::vector<CarriedImpulse>>& carried,
                  std::span<const int> wires)
{
    for (const int w : wires) carried[static_cast<std::size_t>(w)].clear();
    if (bytes == end) return;
    for (const int w : wires) {
        std::uint32_t count = 0;
        take_bytes(bytes, end, &count, 1);
        if (count > most_carried) throw Error(ExitCode::BadFile, "the saved state is damaged: more forces are carried than a wire can have");
        for (std::uint32_t k = 0; k < count; ++k) {
            CarriedImpulse at;
            take_bytes(bytes, end, &at.s, 1);
            take_bytes(bytes, end, at.impulse.data(), 3);
            if (!(at.s >= 0) || !at.impulse.allFinite())
                throw Error(ExitCode::BadFile, "the saved state is damaged: a force that is carried into the next step is not a number");
            carried[static_cast<std::size_t>(w)].push_back(at);
        }
    }
}

}  // namespace seldinger

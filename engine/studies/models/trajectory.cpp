// Cumulative contact forces on the common grid, and trajectories as checksummed binary files.
#include "models/trajectory.h"

#include "core/bytes.h"
#include "core/file_io.h"
#include "core/fnv1a.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace seldinger {
namespace {

constexpr std::uint64_t magic = 0x33'4a'41'52'54'4c'45'53ull;  // "SELTRAJ3"

template <class S>
void each_field(S& s, auto& take)
{
    take(s.t), take(s.inserted), take(s.hand_force), take(s.friction), take(s.normal), take(s.shape), take(s.contact_up_to);
}

/// As a run makes them; the checksum says nothing of who wrote the file.
bool are_sound(const std::vector<Sample>& samples)
{
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (samples[k].shape.size() < 2 || !std::isfinite(samples[k].t)) return false;
        if (k > 0 && samples[k].t <= samples[k - 1].t) return false;
    }
    return true;
}

}  // namespace

std::vector<double> accumulate_forces(const std::vector<ForceAt>& forces, double wire_length)
{
    std::vector<double> up_to(contact_grid, 0.0);
    const double cells = contact_grid - 1;
    for (const ForceAt& at : forces) {
        const double place = std::clamp(at.s / wire_length, 0.0, 1.0) * cells;
        const auto cell = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(contact_grid - 2));
        const double right = place - static_cast<double>(cell);
        up_to[cell] += (1 - right) * at.force;
        up_to[cell + 1] += right * at.force;
    }
    for (std::size_t k = 1; k < up_to.size(); ++k) up_to[k] += up_to[k - 1];
    return up_to;
}

void save_trajectory(const FilePlace& file, const Trajectory& trajectory)
{
    std::vector<std::uint8_t> bytes;
    ByteWriter put{bytes};
    put(magic), put(trajectory.wire_length), put(trajectory.peaks);
    put(std::uint64_t{trajectory.samples.size()});
    for (const Sample& sample : trajectory.samples) each_field(sample, put);
    const std::uint64_t sum = fnv1a(bytes.data(), bytes.size());
    put_bytes(bytes, &sum, 1);
    write_file(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

bool load_trajectory(const FilePlace& file, Trajectory& trajectory)
{
    try {
        const std::string text = read_file(file);
        const auto* at = reinterpret_cast<const std::uint8_t*>(text.data());
        std::uint64_t sum = 0, found = 0;
        if (text.size() < 4 * sizeof sum) return false;
        const std::uint8_t* end = at + text.size() - sizeof sum;
        std::memcpy(&sum, end, sizeof sum);
        if (sum != fnv1a(at, text.size() - sizeof sum)) return false;
        ByteReader take{at, end};
        take(found);
        if (found != magic) return false;
        Trajectory read;
        take(read.wire_length), take(read.peaks);
        for (std::size_t left = take.count(sizeof(double)); left > 0; --left) each_field(read.samples.emplace_back(), take);
        if (take.at != end || !are_sound(read.samples)) return false;
        trajectory = std::move(read);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace seldinger

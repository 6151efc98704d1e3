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

constexpr std::uint64_t magic = 0x32'4a'41'52'54'4c'45'53ull;  // "SELTRAJ2"

void put_numbers(std::vector<std::uint8_t>& bytes, const double* data, std::size_t count)
{
    const std::uint64_t size = count;
    put_bytes(bytes, &size, 1);
    put_bytes(bytes, data, count);
}

template <class Number>
std::vector<Number> take_numbers(const std::uint8_t*& at, const std::uint8_t* end)
{
    std::uint64_t size = 0;
    take_bytes(at, end, &size, 1);
    if (size > static_cast<std::uint64_t>(end - at) / sizeof(Number)) throw Error(ErrorKind::BadFile, "cut short");
    std::vector<Number> numbers(size);
    take_bytes(at, end, numbers.data(), numbers.size());
    return numbers;
}

Sample take_sample(const std::uint8_t*& at, const std::uint8_t* end)
{
    Sample sample;
    for (double* value : {&sample.t, &sample.inserted, &sample.hand_force, &sample.friction, &sample.normal})
        take_bytes(at, end, value, 1);
    const std::vector<double> xyz = take_numbers<double>(at, end);
    sample.shape.resize(xyz.size() / 3);
    for (std::size_t i = 0; i < sample.shape.size(); ++i) sample.shape[i] = Vec3(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    sample.contact_up_to = take_numbers<double>(at, end);
    return sample;
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
    put_bytes(bytes, &magic, 1);
    put_bytes(bytes, &trajectory.wire_length, 1);
    put_bytes(bytes, trajectory.peaks.data(), trajectory.peaks.size());
    const std::uint64_t count = trajectory.samples.size();
    put_bytes(bytes, &count, 1);
    for (const Sample& sample : trajectory.samples) {
        for (const double value : {sample.t, sample.inserted, sample.hand_force, sample.friction, sample.normal})
            put_bytes(bytes, &value, 1);
        put_numbers(bytes, sample.shape.empty() ? nullptr : sample.shape.front().data(), 3 * sample.shape.size());
        put_numbers(bytes, sample.contact_up_to.data(), sample.contact_up_to.size());
    }
    const std::uint64_t sum = fnv1a(bytes.data(), bytes.size());
    put_bytes(bytes, &sum, 1);
    write_file(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

bool load_trajectory(const FilePlace& file, Trajectory& trajectory)
{
    try {
        const std::string text = read_file(file);
        const auto* at = reinterpret_cast<const std::uint8_t*>(text.data());
        std::uint64_t sum = 0, found = 0, count = 0;
        if (text.size() < 4 * sizeof sum) return false;
        const std::uint8_t* end = at + text.size() - sizeof sum;
        std::memcpy(&sum, end, sizeof sum);
        if (sum != fnv1a(at, text.size() - sizeof sum)) return false;
        take_bytes(at, end, &found, 1);
        if (found != magic) return false;
        Trajectory read;
        take_bytes(at, end, &read.wire_length, 1);
        take_bytes(at, end, read.peaks.data(), read.peaks.size());
        take_bytes(at, end, &count, 1);
        for (std::uint64_t k = 0; k < count; ++k) read.samples.push_back(take_sample(at, end));
        if (at != end || !are_sound(read.samples)) return false;
        trajectory = std::move(read);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace seldinger

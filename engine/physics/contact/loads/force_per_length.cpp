// The load that contact samples put on a wire, and its readings.
#include "contact/force_per_length.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

void WireLoads::add(const LoadSample& sample, double rubs)
{
    samples.push_back(sample);
    normal += sample.force;
    friction += rubs;
}

void WireLoads::clear()
{
    samples.clear();
    normal = friction = 0;
}

LoadAlong::LoadAlong(std::span<const LoadSample> samples)
{
    struct Change {
        double s, jump, slope;
    };
    std::vector<Change> changes;
    changes.reserve(2 * samples.size());
    for (const LoadSample& sample : samples) {
        if (sample.length > 0) {
            const double per_metre = sample.force / sample.length;
            changes.push_back({sample.s - sample.length / 2, 0, per_metre});
            changes.push_back({sample.s + sample.length / 2, 0, -per_metre});
        } else {
            changes.push_back({sample.s, sample.force, 0});
        }
    }
    std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.s < b.s; });
    double borne = 0, slope = 0;
    for (const Change& change : changes) {
        if (!knots_.empty()) borne += slope * (change.s - knots_.back().s);
        if (!knots_.empty() && knots_.back().s == change.s) {
            knots_.back().jump += change.jump;
            knots_.back().slope += change.slope;
        } else {
            knots_.push_back({change.s, borne, change.jump, slope + change.slope});
        }
        borne += change.jump;
        slope += change.slope;
    }
    // beyond the last stretch nothing is borne, not what rounding left of sums and differences
    if (!knots_.empty()) knots_.back().slope = 0;
}

double LoadAlong::upto(double x, bool closed) const
{
    const auto after = std::upper_bound(knots_.begin(), knots_.end(), x, [](double at, const Knot& knot) { return at < knot.s; });
    return upto(x, closed, static_cast<std::size_t>(after - knots_.begin()));
}

double LoadAlong::upto(double x, bool closed, std::size_t after) const
{
    if (after == 0) return 0;
    const Knot& knot = knots_[after - 1];
    if (knot.s == x) return knot.before + (closed ? knot.jump : 0);
    return knot.before + knot.jump + knot.slope * (x - knot.s);
}

// N(a, a + length) is linear in a between places where one of its ends is at a knot.
LoadAlong::Place LoadAlong::most_on(double length) const
{
    Place most;
    const auto consider = [&](double borne, double from) {
        if (borne > most.value) most = {borne, from + length / 2};
    };
    std::size_t ahead = 0, behind = 0;  // the first knots beyond the other ends, which go along with the knot
    for (std::size_t k = 0; k < knots_.size(); ++k) {
        // each end is the knot itself: what a point bears there counts
        const double here = knots_[k].s;
        while (ahead < knots_.size() && knots_[ahead].s <= here + length) ++ahead;
        while (behind < knots_.size() && knots_[behind].s <= here - length) ++behind;
        consider(upto(here + length, true, ahead) - upto(here, false, k + 1), here);
        consider(upto(here, true, k + 1) - upto(here - length, false, behind), here - length);
    }
    return most;
}

std::vector<ContactRegion> contact_regions(std::span<const LoadSample> samples, double window)
{
    std::vector<ContactRegion> regions;
    std::vector<ContactRegion> stretches;
    for (const LoadSample& sample : samples)
        stretches.push_back({sample.s - sample.length / 2, sample.s + sample.length / 2});
    std::sort(stretches.begin(), stretches.end(),
              [](const ContactRegion& a, const ContactRegion& b) { return a.begin < b.begin; });
    for (const ContactRegion& stretch : stretches) {
        if (regions.empty() || stretch.begin - regions.back().end > window) regions.push_back(stretch);
        else regions.back().end = std::max(regions.back().end, stretch.end);
    }
    return regions;
}

namespace {

/// Length of a region; where points alone touch, at least the window that their force is spread over.
double length_of(const ContactRegion& region, std::span<const LoadSample> samples, double window)
{
    const bool points = std::none_of(samples.begin(), samples.end(), [&](const LoadSample& sample) {
        return sample.length > 0 && sample.s >= region.begin && sample.s <= region.end;
    });
    return points ? std::max(window, region.end - region.begin) : region.end - region.begin;
}

/// One of the two sides of a row, on a wire.
struct Touch {
    LoadSample sample;
    double area;      // [m^2]
    ContactRow* row;  // whose reading it is; null: side b, told of by side a
};

ContactAlong greatest(const LoadAlong& load, const AlongSpec& spec)
{
    ContactAlong along;
    along.patch = spec.patch;
    along.window = std::max(spec.window, 2 * spec.spacing);
    along.widened = along.window > 1.01 * spec.window;  // a wire is divided into whole samples: a spacing of r is r to 0.1 %
    const LoadAlong::Place peak = load.most_on(along.window), patch = load.most_on(spec.patch);
    along.per_length_max = peak.value / along.window;
    along.per_length_at = peak.at;
    along.patch_force = patch.value;
    along.patch_at = patch.at;
    return along;
}

ContactAlong read_wire(std::span<const Touch> touches, const AlongSpec& spec)
{
    std::vector<LoadSample> samples, areas;
    for (const Touch& touch : touches) {
        samples.push_back(touch.sample);
        areas.push_back({touch.sample.s, touch.sample.length, touch.area});
    }
    const LoadAlong load(samples), area(areas);
    ContactAlong along = greatest(load, spec);
    const std::vector<ContactRegion> regions = contact_regions(samples, along.window);
    along.regions = static_cast<int>(regions.size());
    for (const ContactRegion& region : regions) along.extent += length_of(region, samples, along.window);
    for (const Touch& touch : touches) {
        if (!touch.row) continue;
        touch.row->per_length = load.per_length(touch.sample.s, along.window);
        const double lain_on = area.per_length(touch.sample.s, along.window);
        touch.row->pressure = lain_on > 0 ? touch.row->per_length / lain_on : 0;
        const auto of = std::find_if(regions.begin(), regions.end(), [&](const ContactRegion& region) {
            return touch.sample.s >= region.begin && touch.sample.s <= region.end;
        });
        touch.row->region = 1 + static_cast<int>(of - regions.begin());
    }
    return along;
}

}  // namespace

ContactAlong greatest_loads(std::span<const LoadSample> samples, const AlongSpec& spec)
{
    return greatest(LoadAlong(samples), spec);
}

void read_along(std::span<ContactRow> rows, std::span<const AlongSpec> specs, std::span<ContactAlong> wall,
                std::span<ContactAlong> instruments)
{
    std::vector<std::vector<Touch>> on_wall(specs.size()), on_others(specs.size());
    for (ContactRow& row : rows) {
        const LoadSample sample{row.along_a, row.length, row.normal_force};
        const auto a = static_cast<std::size_t>(row.a.body);
        if (row.b.kind == BodyKind::Wall) {
            on_wall[a].push_back({sample, row.area, &row});
            continue;
        }
        on_others[a].push_back({sample, row.area, &row});
        on_others[static_cast<std::size_t>(row.b.body)].push_back(
            {{row.along_b, row.length, row.normal_force}, row.area, nullptr});
    }
    for (std::size_t w = 0; w < specs.size(); ++w) {
        wall[w] = read_wire(on_wall[w], specs[w]);
        AlongSpec exact = specs[w];
        exact.spacing = 0;  // a cell says which part of it touches
        instruments[w] = read_wire(on_others[w], exact);
    }
}

}  // namespace seldinger

// The path of a hub between its keys; a separate file, since scenes need it and no other part of feeding.
#include "solve/feed.h"

#include <algorithm>

namespace seldinger {

FeedKey HubPath::at(double t) const
{
    if (t <= keys_.front().t) return {t, keys_.front().advance, keys_.front().turn, keys_.front().force};
    for (std::size_t k = 1; k < keys_.size(); ++k) {
        const FeedKey &a = keys_[k - 1], &b = keys_[k];
        if (t >= b.t) continue;
        const double weight = (t - a.t) / (b.t - a.t);
        return {t, a.advance + weight * (b.advance - a.advance), a.turn + weight * (b.turn - a.turn),
                a.force + weight * (b.force - a.force)};
    }
    return {t, keys_.back().advance, keys_.back().turn, keys_.back().force};
}

double HubPath::travel(double from, double until, int sign) const
{
    double travelled = 0, last = at(from).advance;
    const auto go_to = [&](double advance) {
        travelled += std::max(0.0, sign * (advance - last));
        last = advance;
    };
    for (const FeedKey& key : keys_)
        if (key.t > from && key.t < until) go_to(key.advance);
    go_to(at(until).advance);
    return travelled;
}

}  // namespace seldinger

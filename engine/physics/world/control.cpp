// Gathers the input of each hub, and loads.
#include "control.h"

#include "core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger {
namespace {

void check_index(int instrument)
{
    if (instrument < 0)
        throw Error(ErrorKind::BadScene,
                    fmt::format("control: instrument {}: expected an index of WorldSetup::wires", instrument));
}

}  // namespace

Control::Hub& Control::hub(int instrument)
{
    check_index(instrument);
    if (hubs_.size() <= static_cast<std::size_t>(instrument)) hubs_.resize(static_cast<std::size_t>(instrument) + 1);
    return hubs_[static_cast<std::size_t>(instrument)];
}

Control& Control::move_to(int instrument, double advance, double turn)
{
    hub(instrument) = {Hub::Kind::MoveTo, advance, turn, 0, 0, {}};
    return *this;
}

Control& Control::push(int instrument, double force, double turn, double spring)
{
    hub(instrument) = {Hub::Kind::Push, 0, turn, force, spring, {}};
    return *this;
}

Control& Control::follow(int instrument, std::span<const FeedKey> keys)
{
    if (keys.empty())
        throw Error(ErrorKind::BadScene,
                    fmt::format("control: instrument {}: a path without keys; expected at least one", instrument));
    hub(instrument) = {Hub::Kind::Follow, 0, 0, 0, 0, keys};
    return *this;
}

Control& Control::load(int instrument, double at, const Vec3& force, const Vec3& moment)
{
    check_index(instrument);
    if (!std::isfinite(at) || !force.allFinite() || !moment.allFinite())
        throw Error(ErrorKind::BadScene,
                    fmt::format("control: instrument {}: load: got a place, force or moment that is not finite; expected numbers",
                                instrument));
    LoadSpec spec{.at = {WirePoint::Kind::Distance, at}, .force = force, .moment = moment};
    loads_.push_back({instrument, spec});
    return *this;
}

}  // namespace seldinger

// Plugins for setup/test_force_plugin.cpp: one that does as its keys say, one for another version, and a library that is none.

#include <seldinger/solve/force.h>

#include <cmath>

namespace {

class Pull final : public seldinger::Force {
public:
    explicit Pull(const seldinger::ForceKeys& keys)
        : pull_(keys.vector("pull_n")), fails_(keys.has("fails") ? keys.text("fails") : "")
    {
        name = "pull";
        places = {keys.number("at_m", 0.0)};
        state = {0, 1};
        record = {"time_s", "part"};
        if (fails_ == "when made") throw std::runtime_error("pull_n: got a bad day; expected a good one");
        if (fails_ == "with a number") throw 3;
    }
    void forces(const seldinger::ForcePoints& at, std::span<seldinger::PointForce> out) const override
    {
        out[0].force = at.state[1] * pull_;
        if (at.time > 0.0045 && fails_ == "in a step") throw std::runtime_error("got enough");
        if (at.time > 0.0045 && fails_ == "in a step with a number") throw 3;
        if (at.time > 0.0045 && fails_ == "without numbers") out[0].force[1] = NAN;
    }
    void accept(const seldinger::ForcePoints& at, std::span<double> next) const override
    {
        next[0] = at.time > 0.0025 ? at.time : 0;
        next[1] = 1 - 10 * at.position[0].norm();
    }

private:
    seldinger::Vec3 pull_;
    std::string fails_;
};

}  // namespace

#ifdef OTHER_VERSION
#undef SELDINGER_FORCE_VERSION
#define SELDINGER_FORCE_VERSION "force 0, C++ ABI 1"
#endif
#ifndef NO_FORCE
SELDINGER_FORCE(Pull)
#endif

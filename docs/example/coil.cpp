// A plugin: an electromagnetic position sensor, which measures where the tip is, so many times a second, with noise. It writes
// sensor_coil.csv, and exerts no force.

#include <seldinger/engine.h>

#include <cmath>
#include <random>

using namespace seldinger;

namespace {

class Coil final : public Force {
public:
    explicit Coil(const ForceKeys& keys)
        : rate_(keys.number("rate_hz")), noise_(keys.number("noise_m", 0.0)), seed_(static_cast<unsigned>(keys.number("seed", 0)))
    {
        name = "coil";
        places = {keys.number("at_m", 0.0)};
        state = {0, 0, 0, 0, 0};  // a row of the record, and the number of the sample
        record = {"time_s", "x_m", "y_m", "z_m"};
    }
    void forces(const ForcePoints&, std::span<PointForce>) const override {}
    bool tangents(const ForcePoints&, std::span<PointTangent>) const override { return true; }
    void accept(const ForcePoints& at, std::span<double> next) const override
    {
        const double sample = std::floor(at.time * rate_ + 1e-6);
        if (sample <= next[4]) return;
        std::seed_seq seeds{seed_, static_cast<unsigned>(sample)};  // noise by number: the same after --resume
        std::mt19937 random(seeds);
        std::normal_distribution<double> noise(0, noise_);
        next[0] = at.time;
        for (int c = 0; c < 3; ++c) next[1 + c] = at.position[0][c] + (noise_ > 0 ? noise(random) : 0);
        next[4] = sample;
    }

private:
    double rate_, noise_;
    unsigned seed_;
};

}  // namespace

SELDINGER_FORCE(Coil)

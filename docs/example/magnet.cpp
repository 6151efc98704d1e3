// A plugin: a magnet in the wire, in the field of another one outside. [[force]] plugin = "libmagnet.so", with the keys below.

#include <seldinger/engine.h>

#include <cmath>

using namespace seldinger;

namespace {

class Magnet final : public Force {
public:
    explicit Magnet(const ForceKeys& keys)
        : strength_(keys.number("moment_am2")), source_(keys.vector("source_m")), source_moment_(keys.vector("source_am2"))
    {
        name = "magnet";
        places = {keys.number("at_m", 0.0)};
    }
    void forces(const ForcePoints& at, std::span<PointForce> out) const override
    {
        for (std::size_t k = 0; k < out.size(); ++k) {
            const Vec3 away = at.position[k] - source_, r = away.normalized(), m = strength_ * at.axis[k], &n = source_moment_;
            const double mr = m.dot(r), nr = n.dot(r), scale = 1e-7 / std::pow(away.norm(), 3);  // mu_0/4 pi
            out[k].force = 3 * scale / away.norm() * (mr * n + nr * m + (m.dot(n) - 5 * mr * nr) * r);
            out[k].moment = scale * m.cross(3 * nr * r - n);
        }
    }
    double energy(const ForcePoints& at) const override
    {
        double sum = 0;
        for (std::size_t k = 0; k < at.position.size(); ++k) {
            const Vec3 away = at.position[k] - source_, r = away.normalized();
            const Vec3 field = 1e-7 / std::pow(away.norm(), 3) * (3 * source_moment_.dot(r) * r - source_moment_);
            sum -= strength_ * at.axis[k].dot(field);
        }
        return sum;
    }

private:
    double strength_;
    Vec3 source_, source_moment_;
};

}  // namespace

SELDINGER_FORCE(Magnet)

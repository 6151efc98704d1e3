// Sums the beam's energies, one after another over all rays of a row.
#include "xray/beam.h"

#include "xray/pixel_math.h"

#include <cmath>

namespace seldinger {

Beam::Beam(std::vector<SpectrumLine> lines) : lines_(std::move(lines)), mu_pieces_(lines_.size())
{
    for (const SpectrumLine& line : lines_) {
        mean_energy_ += line.photons * line.energy;
        mu_.push_back({static_cast<float>(attenuation(materials::soft_tissue(), line.energy)),
                       static_cast<float>(attenuation(materials::blood(), line.energy)),
                       static_cast<float>(attenuation(materials::cortical_bone(), line.energy)),
                       static_cast<float>(mass_attenuation(53, line.energy))});
    }
}

void Beam::set_instruments(const std::vector<Material>& of)
{
    for (std::size_t line = 0; line < lines_.size(); ++line) {
        mu_pieces_[line].clear();
        for (const Material& m : of) mu_pieces_[line].push_back(static_cast<float>(attenuation(m, lines_[line].energy)));
    }
}

void Beam::exponents(std::size_t line, const Rays& rays, std::vector<float>& out) const
{
    const int count = rays.count();
    out.resize(count);
    const float soft = mu_[line][Soft], blood = mu_[line][Blood], bone = mu_[line][Bone], iodine = mu_[line][Iodine];
    const float *a = rays.amount[Soft].data(), *b = rays.amount[Blood].data(), *c = rays.amount[Bone].data(),
                *d = rays.amount[Iodine].data();
    float* to = out.data();
    for (int i = 0; i < count; ++i) to[i] = soft * a[i] + blood * b[i] + bone * c[i] + iodine * d[i];
    for (const Rays::Piece& p : rays.pieces) to[p.ray] += mu_pieces_[line][p.material] * p.length;
}

void Beam::arrive(const Rays& rays, float* signal, float* second) const
{
    const int count = rays.count();
    std::fill_n(signal, count, 0.0f);
    std::fill_n(second, count, 0.0f);
    std::vector<float> x;
    for (std::size_t line = 0; line < lines_.size(); ++line) {
        exponents(line, rays, x);
        const auto share = static_cast<float>(lines_[line].signal);
        const auto square = static_cast<float>(lines_[line].signal * lines_[line].energy / mean_energy_);
        const float* from = x.data();
        for (int i = 0; i < count; ++i) {
            const float through = exp_minus(from[i]);
            signal[i] += share * through;
            second[i] += square * through;
        }
    }
}

void Beam::line_integrals(const Rays& rays, float* out) const
{
    std::vector<float> x;
    if (lines_.size() == 1) {
        exponents(0, rays, x);
        std::copy(x.begin(), x.end(), out);
        return;
    }
    std::vector<double> sum(rays.count());
    for (std::size_t line = 0; line < lines_.size(); ++line) {
        exponents(line, rays, x);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += lines_[line].signal * std::exp(-static_cast<double>(x[i]));
    }
    for (std::size_t i = 0; i < sum.size(); ++i) out[i] = static_cast<float>(-std::log(std::max(sum[i], 1e-300)));
}

}  // namespace seldinger

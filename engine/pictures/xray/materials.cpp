// Compositions, and xraylib's cross-sections summed over elements.
#include "xray/materials.h"

#include "core/check.h"
#include "core/error.h"

#include <fmt/format.h>
#include <xraylib.h>

#include <algorithm>
#include <map>

namespace seldinger {

double mass_attenuation(int atomic_number, double energy)
{
    xrl_error* problem = nullptr;
    const double cm2_g = CS_Total(atomic_number, energy, &problem);
    if (problem) {
        const std::string what = problem->message;
        xrl_error_free(problem);
        throw Error(ErrorKind::BadScene, fmt::format("no attenuation of element {} at {} keV: {}", atomic_number, energy, what));
    }
    return 0.1 * cm2_g;
}

double attenuation(const Material& material, double energy)
{
    double sum = 0;
    for (const auto& [element, share] : material.elements) sum += share * mass_attenuation(element, energy);
    return material.density * sum;
}

Material mixed_by_volume(const Material& first, const Material& second, double share, const std::string& name)
{
    const double mass_first = (1 - share) * first.density, mass_second = share * second.density, mass = mass_first + mass_second;
    std::map<int, double> shares;
    for (const auto& [element, w] : first.elements) shares[element] += w * mass_first / mass;
    for (const auto& [element, w] : second.elements) shares[element] += w * mass_second / mass;
    return {name, mass, {shares.begin(), shares.end()}};
}

namespace materials {

const Material& water()
{
    static const Material m{"water", 1000, {{1, 0.111907}, {8, 0.888093}}};
    return m;
}
const Material& blood()
{
    static const Material m{"blood",
                            1060,
                            {{1, 0.102},
                             {6, 0.110},
                             {7, 0.033},
                             {8, 0.745},
                             {11, 0.001},
                             {15, 0.001},
                             {16, 0.002},
                             {17, 0.003},
                             {19, 0.002},
                             {26, 0.001}}};
    return m;
}
const Material& soft_tissue()
{
    static const Material m{
        "soft tissue",
        1060,
        {{1, 0.102}, {6, 0.143}, {7, 0.034}, {8, 0.708}, {11, 0.002}, {15, 0.003}, {16, 0.003}, {17, 0.002}, {19, 0.003}}};
    return m;
}
const Material& cortical_bone()
{
    static const Material m{
        "cortical bone",
        1920,
        {{1, 0.034}, {6, 0.155}, {7, 0.042}, {8, 0.435}, {11, 0.001}, {12, 0.002}, {15, 0.103}, {16, 0.003}, {20, 0.225}}};
    return m;
}
const Material& stainless_steel()
{
    static const Material m{"stainless steel", 7950, {{24, 0.19}, {25, 0.01}, {26, 0.70}, {28, 0.10}}};
    return m;
}
const Material& nitinol()
{
    static const Material m{"nitinol", 6450, {{22, 0.442}, {28, 0.558}}};
    return m;
}
const Material& platinum_alloy()
{
    static const Material m{"platinum alloy", 21300, {{74, 0.08}, {78, 0.92}}};
    return m;
}
const Material& polyurethane()
{
    static const Material m{"polyurethane", 1120, {{1, 0.082}, {6, 0.655}, {7, 0.037}, {8, 0.226}}};
    return m;
}
const Material& barium_polymer()
{
    // 30 % of the mass: 30/4500 of 30/4500 + 70/1120 of the volume
    static const Material sulphate{"barium sulphate", 4500, {{8, 0.2742}, {16, 0.1374}, {56, 0.5884}}};
    static const Material m = mixed_by_volume(polyurethane(), sulphate, 0.09639, "polymer with barium sulphate");
    return m;
}
const Material& tungsten_polymer()
{
    static const Material tungsten{"tungsten", 19300, {{74, 1.0}}};
    static const Material m = mixed_by_volume(polyurethane(), tungsten, 0.05485, "polymer with tungsten");
    return m;
}

}  // namespace materials

Material instrument_material(double density, bool has_lumen)
{
    SEL_ASSERT(density > 0);
    Material m;
    if (density >= 15000) m = materials::platinum_alloy();
    else if (density >= 7000) m = materials::stainless_steel();
    else if (density >= 5500) m = materials::nitinol();
    else if (has_lumen) m = materials::barium_polymer();
    else {
        const Material &core = materials::nitinol(), &jacket = materials::tungsten_polymer();
        const double share = std::clamp((density - jacket.density) / (core.density - jacket.density), 0.0, 1.0);
        m = mixed_by_volume(jacket, core, share, "nitinol in polymer with tungsten");
    }
    m.density = density;
    return m;
}

}  // namespace seldinger

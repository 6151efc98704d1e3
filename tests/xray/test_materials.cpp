// Attenuation against the reference's NIST values and against the edges; the tube's spectrum.
#include "core/error.h"
#include "support/approx.h"
#include "support/shared_folder.h"
#include "xray/materials.h"
#include "xray/spectrum.h"

#include <nlohmann/json.hpp>

#include <fstream>

namespace seldinger::test::test_materials {

TEST_SUITE("xray/materials")
{
    TEST_CASE("analytic: coefficients of the public reference [17_xray/coefficients]")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        const auto reference = nlohmann::json::parse(std::ifstream(*shared / "reference/17_xray.json"));
        const std::map<std::string, const Material*> ours = {
            {"water", &materials::water()},
            {"blood (ICRU-44)", &materials::blood()},
            {"soft tissue (ICRU-44)", &materials::soft_tissue()},
            {"cortical bone (ICRU-44)", &materials::cortical_bone()},
            {"stainless steel (Fe 70 Cr 19 Ni 10 Mn 1)", &materials::stainless_steel()},
            {"nickel-titanium (Ni 55.8 wt%)", &materials::nitinol()}};
        const std::map<std::string, int> elements = {{"iron", 26}, {"platinum", 78}, {"tungsten", 74}, {"iodine (element)", 53}};
        int checked = 0;
        for (const auto& c : reference["cases"]) {
            if (c["kind"] != "coefficients") continue;
            for (const auto& m : c["expected"]["materials"]) {
                const std::string name = m["material"];
                CAPTURE(name);
                Material own{name, 1000 * m["density_g_cm3"].get<double>(), {}};
                if (ours.count(name)) own = *ours.at(name);
                else if (elements.count(name)) own.elements = {{elements.at(name), 1.0}};
                else {
                    const std::map<std::string, int> numbers = {{"C", 6}, {"H", 1}, {"I", 53}, {"N", 7}, {"O", 8}};
                    for (const auto& [symbol, share] : m["mass_fractions"].items())
                        own.elements.push_back({numbers.at(symbol), share});
                }
                for (std::size_t k = 0; k < 3; ++k) {
                    const double energy = c["expected"]["keV"][k], expected = m["mu_1_m"][k];
                    CHECK(attenuation(own, energy) == test::about(expected).epsilon(0.005));  // allowed: 0.02; seen: 0.0008
                    ++checked;
                }
            }
        }
        REQUIRE(checked == 36);
    }

    TEST_CASE("analytic: 60 keV, in 1/cm: platinum alloy 91, blood with 50 mg/ml of iodine 0.597")
    {
        CHECK(attenuation(materials::platinum_alloy(), 60) == test::about(9100).epsilon(0.01));
        CHECK(attenuation(materials::blood(), 60) + 50 * mass_attenuation(53, 60) == test::about(59.7).epsilon(0.005));
    }

    TEST_CASE("property: a mixture attenuates as its parts do, and an instrument keeps its density")
    {
        const Material half = mixed_by_volume(materials::water(), materials::nitinol(), 0.5, "half");
        CHECK(
            attenuation(half, 60) ==
            test::about(0.5 * (attenuation(materials::water(), 60) + attenuation(materials::nitinol(), 60))).epsilon(1e-12));
        CHECK(instrument_material(7900, false).density == 7900);
        CHECK(instrument_material(7900, false).name == "stainless steel");
        CHECK(instrument_material(6450, false).name == "nitinol");
        CHECK(instrument_material(21300, false).name == "platinum alloy");
        CHECK(instrument_material(1300, true).name == "polymer with barium sulphate");
    }

    TEST_CASE("property: shares of a spectrum sum to one, and no bin spans a K edge")
    {
        for (const double kvp : {40.0, 75.0, 150.0}) {
            double photons = 0, signal = 0, before = 0;
            for (const SpectrumLine& line : tube_spectrum(kvp)) {
                photons += line.photons, signal += line.signal;
                CHECK(line.energy > before);
                before = line.energy;
            }
            CHECK(photons == test::about(1).epsilon(1e-12));
            CHECK(signal == test::about(1).epsilon(1e-12));
            CHECK(before < kvp);
        }
        CHECK_THROWS_AS((void)tube_spectrum(39), Error);
        CHECK_THROWS_AS((void)tube_spectrum(151), Error);
    }
}

}  // namespace seldinger::test::test_materials

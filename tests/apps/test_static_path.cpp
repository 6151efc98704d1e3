// What a static run passes on its way counts, and is in its trace.

#include "apps/app_fixture.h"
#include "support/approx.h"

namespace test_static_path {

using namespace seldinger::test;

TEST_SUITE("apps/static_path")
{
    // A cantilever whose tip is moved aside and back: force 3 B d/L^3 on the way, none at the end. d/L is 0.02, and terms of its
    // square 0.1 %; 20 nodes add (h/L)^2/2.
    TEST_CASE("analytic: the largest forces are those of the whole path, with the time of the keys")
    {
        const ScratchFolder folder;
        folder.write("s.toml",
                     "[scene]\nrecord_every = 1\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n"
                     "[wire]\nlength_m = 0.1\nradius_m = 0.0005\ndensity = 7900.0\nbend_nm2 = 1.0e-4\ntwist_nm2 = 8.0e-5\nstretch_n = 1.0e4\nnodes = 41\n"
                     "place = { shape = \"straight\", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }\n"
                     "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n"
                     "[[hold]]\nat = \"tip\"\nposition = [\"y\", \"z\"]\n"
                     "move = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.002, 0.0], [2.0, 0.0, 0.0, 0.0]]\n");
        const AppResult result = run_app(folder, "run s.toml -o A --quiet");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        const auto summary = summary_of(folder.path / "A");
        const double force = 3 * 1e-4 * 0.002 / 1e-3;
        CHECK(std::abs(summary["base_force_n"][1].get<double>()) < 1e-6 * force);
        CHECK(summary["hand_force_max_at_s"].get<double>() == about(1.0));
        const auto rows = csv_rows(folder.path / "A/trace.csv");
        REQUIRE(rows.size() > 6);
        const auto column = [&](const char* name) { return std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin(); };
        double most = 0, at = 0, last = -1;
        for (std::size_t k = 1; k < rows.size(); ++k) {
            const double t = std::stod(rows[k][column("time_s")]), now = std::abs(std::stod(rows[k][column("base_force_y_n")]));
            CHECK(t > last);
            last = t;
            if (now > most) most = now, at = t;
        }
        CHECK(at == about(1.0));
        CHECK(last == about(2.0));
        CHECK(most == about(force).epsilon(0.003));
    }
}

}  // namespace test_static_path

// What a static run passes on its way counts, and is in its trace.

#include "apps/app_fixture.h"
#include "support/approx.h"

namespace seldinger::test::test_static_path {

namespace {

/// A wire without weight, clamped at its base, that stands still at each moment.
std::string swept_wire(int nodes)
{
    return "[scene]\nrecord_every = 1\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n" +
           wire_text(0.1, 1e-4, 8e-5, nodes, 5e-4) + placed_along_x + held_base;
}

}  // namespace

TEST_SUITE("apps/static_path")
{
    // A cantilever whose tip is moved aside and back: force 3 B d/L^3 on the way, none at the end. d/L is 0.02, and terms of its
    // square 0.1 %; 20 nodes add (h/L)^2/2.
    TEST_CASE("analytic: the largest forces are those of the whole path, with the time of the keys")
    {
        const ScratchFolder folder;
        folder.write("s.toml", swept_wire(41) +
                                   "[[hold]]\nat = \"tip\"\nposition = [\"y\", \"z\"]\n"
                                   "move = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.002, 0.0], [2.0, 0.0, 0.0, 0.0]]\n");
        run_ok(folder, "run s.toml -o A --quiet");
        const auto summary = summary_of(folder.path / "A");
        const double force = 3 * 1e-4 * 0.002 / 1e-3;
        CHECK(std::abs(summary["base_force_n"][1].get<double>()) < 1e-6 * force);
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
        // the tip goes out and comes back: work F d/2, and none
        const auto worked = [&](std::size_t row) { return std::stod(rows[row][column("outside_work_j")]); };
        const auto turned_back =
            std::find_if(rows.begin() + 1, rows.end(), [&](const auto& row) { return std::stod(row[column("time_s")]) == 1; });
        REQUIRE(turned_back != rows.end());
        CHECK(worked(static_cast<std::size_t>(turned_back - rows.begin())) == about(force * 0.002 / 2).epsilon(0.003));
        CHECK(std::abs(worked(rows.size() - 1)) < 1e-6 * force * 0.002);
    }

    // A wire is wound by 3 rad at the hub and pulled by 10 um at the tip, and goes back. Torque and tension are in proportion to
    // these, and so trapezoids are exact; with C a^2/(2 L) from the hand and EA d^2/(2 L) from the tip's hold. Newton's tolerance
    // leaves 1e-6, the strain of 1e-4 as much of the tension.
    TEST_CASE(
        "analytic: work along a path of equilibria is the energy that is there, and the largest force is that of the whole path")
    {
        const ScratchFolder folder;
        folder.write("t.toml",
                     swept_wire(21) +
                         "turn = [[0.0, 0.0], [1.0, 3.0], [2.0, 0.0]]\n"
                         "[[hold]]\nat = \"tip\"\nposition = true\ndirection = true\nspin = true\nmove = [[0.0, 0.0, 0.0, 0.0], "
                         "[1.0, 1e-5, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]]\n");
        run_ok(folder, "run t.toml -o A --quiet");
        const auto summary = summary_of(folder.path / "A");
        const auto rows = csv_rows(folder.path / "A/trace.csv");
        const auto at = [&](std::size_t row, const char* name) {
            return std::stod(
                rows[row][static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin())]);
        };
        std::size_t far = 1;
        while (far + 1 < rows.size() && at(far, "time_s") < 1) ++far;
        REQUIRE(at(far, "time_s") == 1);
        const double wound = 8e-5 * 9 / (2 * 0.1), pulled = 1e4 * 1e-10 / (2 * 0.1);
        CHECK(at(far, "hand_work_j") == about(wound).epsilon(1e-4));
        CHECK(at(far, "outside_work_j") == about(pulled).epsilon(1e-3));
        CHECK(at(far, "hand_work_j") + at(far, "outside_work_j") == about(at(far, "elastic_j")).epsilon(1e-5));
        CHECK(std::abs(summary["hand_work_j"].get<double>()) < 1e-5 * wound);
        CHECK(std::abs(summary["scheme_loss_j"].get<double>()) < 1e-5 * wound);
        CHECK(summary["hand_force_max_at_s"].get<double>() == about(1.0));
        CHECK(summary["hand_force_max_n"].get<double>() == about(1.0).epsilon(1e-3));  // EA d/L
    }
}

}  // namespace seldinger::test::test_static_path

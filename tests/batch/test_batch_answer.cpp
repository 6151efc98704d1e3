// The answer of a batch: counts, ranking, resolved differences, and digits.
#include "bands/error_band.h"
#include "batch/batch_answer.h"
#include "support/approx.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace seldinger::test::test_batch_answer {

namespace {

const Sweep sweep =
    read_sweep_text("[vary]\n\"wire.preset\" = [\"bentson-035\", \"terumo-angled-035\", \"amplatz\"]\n", "v.toml", 0);

BatchRow row(std::int64_t run, bool reached, bool passed, double peak, int branch = 1)
{
    BatchRow row;
    row.run = run;
    row.state_hash.fill('0');
    const auto set = [&](std::string_view name, double value) { row.numbers[column_index(name)] = value; };
    set("reached", reached), set("passed", passed), set("until_patch_force_max_n", peak), set("branch", branch);
    set("reached_at_s", 2.0), set("until_patch_force_max_s", 1.0);  // the peak is over when the target is reached
    return row;
}

BatchLayout layout(bool bands, bool limits = false)
{
    BatchLayout made;
    made.task = true, made.bands = bands, made.limits = limits;
    made.runs = 3, made.target = "left subclavian", made.patch = 0.005;
    return made;
}

std::string line(const BatchLayout& of, const std::vector<BatchRow>& rows) { return answer_line(sweep, of, answer_of(of, rows)); }

}  // namespace

TEST_SUITE("batch/batch_answer")
{
    TEST_CASE("property: the least peak of those that reached the target, whatever the order of the rows")
    {
        const std::vector<BatchRow> rows = {row(2, true, true, 0.20), row(0, true, true, 0.10), row(1, false, false, 0.01, 3)};
        CHECK(line(layout(false), rows) ==
              "2 of 3 reached left subclavian, the others ended in branch 3 (1 run); least peak on 5 mm of wall: run 0 "
              "(bentson-035), 0.1 N (--bands computes its band)");
        const BatchAnswer answer = answer_of(layout(false), rows);
        CHECK(answer.ends.branches.at(1) == 2);
        CHECK(answer.ends.branches.at(3) == 1);
        REQUIRE(answer.ranking.size() == 2);
        CHECK(std::isnan(answer.ranking[0].band));
    }

    TEST_CASE("analytic: a band is three times what half the step changes; two whose bands meet are not told apart")
    {
        // items 3 to 5 are the runs with half the step
        std::vector<BatchRow> rows = {row(0, true, true, 0.10),  row(1, true, true, 0.13),  row(2, true, true, 0.30),
                                      row(3, true, true, 0.096), row(4, true, true, 0.122), row(5, true, true, 0.299)};
        CHECK(line(layout(true), rows) ==
              "3 of 3 reached left subclavian; least peak on 5 mm of wall: run 0 (bentson-035), 0.100 ± 0.012 N; not told apart "
              "from "
              "run 1 (terumo-angled-035), 0.13 ± 0.02 N (± by the step; `run` adds nodes and facets)");
        rows[4].numbers[column_index("until_patch_force_max_n")] = 0.1295;
        CHECK(line(layout(true), rows) ==
              "3 of 3 reached left subclavian; least peak on 5 mm of wall: run 0 (bentson-035), 0.100 ± 0.012 N "
              "(± by the step; `run` adds nodes and facets)");
        CHECK(answer_of(layout(true), rows).ranking[0].band == test::about(0.012));
        // with half the step it misses: its readings until then are not comparable
        rows[3] = row(3, false, false, 0.05);
        CHECK(std::isnan(answer_of(layout(true), rows).ranking[0].band));
    }

    TEST_CASE("property: whose force still rises at the target is named, since a target farther in has another order")
    {
        std::vector<BatchRow> rows = {row(0, true, true, 0.10), row(1, true, true, 0.13), row(2, true, true, 0.30)};
        const auto rises = [&](std::size_t k) { rows[k].numbers[column_index("until_patch_force_max_s")] = 2.0; };
        const std::string best = "3 of 3 reached left subclavian; least peak on 5 mm of wall: run 0 (bentson-035), 0.1 N";
        const std::string end = " (--bands computes its band)";
        rises(1);
        CHECK(line(layout(false), rows) == best + "; still rising at the target: run 1 (terumo-angled-035)" + end);
        rises(0);
        CHECK(line(layout(false), rows) ==
              best + "; still rising at the target: run 0 (bentson-035), run 1 (terumo-angled-035)" + end);
        rises(2);
        CHECK(line(layout(false), rows) == best + "; still rising at the target: all of them" + end);
    }

    TEST_CASE("property: limits leave out of the ranking, and runs that stopped are of no outcome")
    {
        std::vector<BatchRow> rows = {row(0, true, false, 0.10), row(1, true, true, 0.15), row(2, true, true, 0.01)};
        rows[2].status = RunStatus::Stopped;
        CHECK(line(layout(false, true), rows) ==
              "2 of 3 reached left subclavian, 1 within the limits; least peak on 5 mm of wall: run 1 (terumo-angled-035), 0.15 "
              "N (--bands computes its band)");
        rows[0] = rows[1] = row(0, false, false, 0.1);
        rows[1].run = 1;
        rows[0].numbers[column_index("distance_m")] = 0.031, rows[1].numbers[column_index("distance_m")] = 0.0124;
        CHECK(line(layout(false), rows) ==
              "0 of 3 reached left subclavian; they ended in branch 1 (2 runs); nearest at the end: run 1 (terumo-angled-035), "
              "12.4 mm from it");
    }

    TEST_CASE("property: without a task the line says where the tips ended, and nothing where there is no centreline")
    {
        BatchLayout free = layout(false);
        free.task = false;
        CHECK(line(free, {row(0, false, false, 0, 1), row(1, false, false, 0, 0), row(2, false, false, 0, 1)}) ==
              "tips ended before any branch (1 run), in branch 1 (2 runs)");
        CHECK(line(free, {row(0, false, false, 0, 0)}).empty());
    }

    TEST_CASE("property: a tip that left the vessel ended in no branch, and the line says by which inlet")
    {
        std::vector<BatchRow> rows = {row(0, true, true, 0.10), row(1, false, false, 0.1, 3), row(2, false, false, 0.1, 3)};
        rows[2].numbers[column_index("left_through")] = 2;
        CHECK(line(layout(false), rows)
                  .starts_with("1 of 3 reached left subclavian, the others ended in branch 3 (1 run), "
                               "left the vessel through inlet 2 (1 run); least peak"));
        BatchLayout free = layout(false);
        free.task = false;
        CHECK(line(free, {rows[2]}) == "tips left the vessel through inlet 2 (1 run)");
    }

    TEST_CASE("analytic: as many digits as the band leaves")
    {
        CHECK(newtons(0.10347, 0.0134) == "0.103 ± 0.013 N");
        CHECK(newtons(0.10347, 0.034) == "0.10 ± 0.03 N");
        CHECK(newtons(0.0034, 0.0002) == "3.4 ± 0.2 mN");
        CHECK(newtons(12.3, 2.2) == "12 ± 2 N");
        CHECK(newtons(0.10347, std::nan("")) == "0.103 N");
        CHECK(newtons(0.5, 0) == "0.5 N");
    }

    TEST_CASE("property: the table has bands beside their columns, the task's columns where there is one, and a unit for each")
    {
        const std::vector<BatchRow> rows = {row(0, true, true, 0.10), row(3, true, true, 0.096)};
        const std::string csv = batch_csv(sweep, layout(true), rows), plain = batch_csv(
                                                                          sweep,
                                                                          [] {
                                                                              BatchLayout l = layout(false);
                                                                              l.task = false;
                                                                              return l;
                                                                          }(),
                                                                          rows);
        CHECK(csv.starts_with("run,wire.preset,status,branch,branch_depth_m,branch_depth_m_band,left_through,reached,passed,"));
        CHECK(csv.find(",until_patch_force_max_n,until_patch_force_max_n_band,") != std::string::npos);
        CHECK(plain.starts_with("run,wire.preset,status,branch,branch_depth_m,left_through,patch_force_max_n,"));
        CHECK(std::count(csv.begin(), csv.end(), '\n') == 2);  // the half step's row is no row
        const std::string units = batch_units_csv(sweep, layout(true));
        for (const char* said :
             {"wire.preset,,varied\n", "until_patch_force_max_n,N,outcome\n", "until_patch_force_max_n_band,N,outcome\n",
              "force_per_length_max_n_per_m,N/m,largest\n", "hand_torque_nm,N m,last\n", "newton_max,,effort\n"})
            CHECK_MESSAGE(units.find(said) != std::string::npos, said);
        // as many rows as columns, in their order
        const std::string head = csv.substr(0, csv.find('\n'));
        CHECK(std::count(units.begin(), units.end(), '\n') == std::count(head.begin(), head.end(), ',') + 2);
    }

    TEST_CASE("regression: a list of forty sections is named by its run, not by its 5,000 letters")
    {
        std::string list = "[";
        for (int k = 0; k < 40; ++k) list += std::string(k ? ", " : "") + "{from_tip_m = [0.0, 0.01], bend_nm2 = 1e-5}";
        const Sweep sections = read_sweep_text(
            "[vary]\n\"wire.section\" = [" + list + "], " + list + "]]\n\"wire.mu_sliding\" = [0.1]\n", "v.toml", 0);
        std::vector<BatchRow> rows = {row(0, true, true, 0.10), row(1, true, true, 0.13)};
        rows[0].numbers[column_index("until_patch_force_max_s")] = rows[1].numbers[column_index("until_patch_force_max_s")] = 2.0;
        BatchLayout of = layout(false);
        of.runs = 2;
        const std::string answer = answer_line(sections, of, answer_of(of, rows));
        CHECK(answer.size() < 500);
        CHECK(answer.find("least peak on 5 mm of wall: run 0 (wire.section=[{") != std::string::npos);
        CHECK(answer.find(" ..., wire.mu_sliding=0.1), 0.1 N; still rising at the target: run 0 (wire.section=") !=
              std::string::npos);
    }
}

}  // namespace seldinger::test::test_batch_answer

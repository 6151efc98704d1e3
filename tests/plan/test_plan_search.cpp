// The search of `seldinger plan` on made-up models whose cost and error are known for every place of the grid.

#include "plan/plan_search.h"
#include "support/approx.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace seldinger::test::test_plan_search {

namespace {

/// A scene whose models all go through the scene reader.
Scene small_scene()
{
    return read_scene_text(scene_text(1) + wire_text(0.1, 1e-5, 1e-5, 101) + tube_text(0.003, 0.2, 1000) +
                               "[contact]\nrolling = true\n[feed]\npoint = [0.01, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n"
                               "keys = [ {t_s = 0.0, advance_m = 0.0} ]\n",
                           "small.toml");
}

/// Error a h^2 + b dt + what the choices cost; seconds (c + nodes) / dt times what the choices save.
struct Law {
    double a = 40, b = 2e-2;  // [m per (1/edges)^2], [m/s]
    double fixed = 30;
    std::function<double(const Model&)> extra_error = [](const Model&) { return 0.0; };
    std::function<double(const Model&)> share = [](const Model&) { return 1.0; };
};

/// Two instruments, a rod each.
Scene coaxial_scene(std::string_view more = {})
{
    const auto instrument = [](std::string_view name, double radius, std::string_view lumen) {
        return "[[instrument]]\nname = \"" + std::string(name) + "\"\nlength_m = 0.1\nradius_m = " + std::to_string(radius) +
               "\ndensity = 7900.0\nbend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = 1e4\nnodes = 101\n" + std::string(lumen) +
               "[instrument.feed]\nkeys = [ {t_s = 0.0, advance_m = 0.0} "
               "]\n" +
               (lumen.empty() ? "" : "point = [0.01, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n");
    };
    return read_scene_text("[scene]\nduration_s = 1.0\ndt_s = 0.001\n" + instrument("out", 0.0008, "lumen_radius_m = 0.0006\n") +
                               instrument("in", 0.0004, "") + "[coaxial]\norder = [\"out\", \"in\"]\nmodel = \"separate\"\n" +
                               std::string(more),
                           "pair.toml");
}

class MadeUpTrialRuns final : public TrialRunSource {
public:
    MadeUpTrialRuns(Law law, double limit) : law_(std::move(law)), limit_(limit) {}
    const TrialRun* look_at(const Model& model) override
    {
        const auto [at, fresh] = known_.try_emplace(label(model));
        if (!fresh) return &at->second;
        TrialRun& trial = at->second;
        trial.model = model;
        trial.complete = trial.sound = true;
        const double edges = model.nodes.value_or(0) > 0 ? *model.nodes - 1 : 60;  // adaptive: as good as 60, as dear as 40
        trial.error = 1e-4 * law_.a / (edges * edges) + law_.b * *model.dt + law_.extra_error(model);
        trial.seconds = 1e-6 * (law_.fixed + (model.nodes == 0 ? 40 : edges)) / *model.dt * law_.share(model);
        trial.meets = trial.error <= limit_;
        return &trial;
    }
    double limit() const override { return limit_; }
    std::size_t count() const { return known_.size(); }
    std::vector<Model> models() const
    {
        std::vector<Model> all;
        for (const auto& [key, trial] : known_) all.push_back(trial.model);
        return all;
    }

private:
    Law law_;
    double limit_;
    std::map<std::string, TrialRun> known_;
};

Reference reference_with(int nodes, double dt)
{
    Reference reference;
    reference.model.nodes = nodes;
    reference.model.dt = dt;
    return reference;
}

Model start_model(int nodes, double dt)
{
    return {.nodes = nodes, .dt = dt, .scheme = Scheme::Newton, .detection = Detection::Swept};
}

/// The cheapest of all places of the grid, in one family.
double cheapest(MadeUpTrialRuns trials, const SearchGrid& grid, const Model& family)
{
    double least = INFINITY;
    for (const int nodes : grid.nodes)
        for (const double dt : grid.steps) {
            Model model = family;
            model.nodes = nodes;
            model.dt = dt;
            const TrialRun* trial = trials.look_at(model);
            if (trial->meets) least = std::min(least, trial->seconds);
        }
    return least;
}

const std::function<bool()> always = [] { return true; };

}  // namespace

TEST_SUITE("plan/plan_search")
{
    TEST_CASE(
        "property: neighbours on the grid are at most a factor of 1.3 apart, or neighbouring whole numbers, from the reference "
        "to what is asked for")
    {
        for (const int nodes : {17, 43, 101, 337, 1282})
            for (const double finest : {1e-4, 2.6e-4, 1e-3, 7e-3})
                for (const double interval : {0.1, 1.0 / 30, 0.034})
                    for (const double longest : {1.0 / 30, 1.0 / 60, 1.0 / 500}) {
                        if (finest > longest) continue;
                        INFO("nodes " << nodes << " finest " << finest << " interval " << interval << " longest " << longest);
                        const double reference_step = interval / std::ceil(interval / finest);
                        const SearchGrid grid = search_grid(reference_with(nodes, reference_step), interval, longest);
                        REQUIRE(grid.nodes.size() > 1);
                        REQUIRE(!grid.steps.empty());
                        CHECK(grid.nodes.front() == nodes);
                        CHECK(grid.nodes.back() == 5);
                        for (std::size_t k = 1; k < grid.nodes.size(); ++k) {
                            const int fine = grid.nodes[k - 1] - 1, coarse = grid.nodes[k] - 1;
                            CHECK(coarse < fine);
                            CHECK((fine <= 1.3 * coarse || fine == coarse + 1));
                        }
                        CHECK(grid.steps.front() == about(reference_step).epsilon(1e-9));
                        // the longest that divides the interval and is not too long
                        CHECK(grid.steps.back() == about(interval / std::ceil(interval / longest - 1e-9)).epsilon(1e-9));
                        for (std::size_t k = 0; k < grid.steps.size(); ++k) {
                            const double parts = interval / grid.steps[k];
                            CHECK(std::abs(parts - std::round(parts)) < 1e-9 * parts);
                            if (k == 0) continue;
                            const double before = interval / grid.steps[k - 1];
                            CHECK(parts < before);
                            CHECK((before <= 1.3 * parts * (1 + 1e-9) || before < parts + 1 + 1e-9));
                        }
                    }
    }

    // On a law that is monotone in nodes and steps the whole grid can be computed. The walk gives up after three dearer corners
    // and takes 3 % for noise, so that its result may be a little dearer than the cheapest. The planner promises 10 %.
    TEST_CASE("property: in one family the search finds a place that costs at most 1.1 times the cheapest of the whole grid")
    {
        const Scene scene = small_scene();
        int cases = 0;
        std::size_t most_trials = 0;
        for (const double interval : {0.1, 1.0 / 30})
            for (const double a : {0.4, 4.0, 40.0, 400.0})
                for (const double b : {1e-3, 5e-3, 2e-2, 2e-1})
                    for (const double fixed : {3.0, 30.0, 300.0})
                        for (const double limit : {1e-5, 5e-5, 2e-4, 1e-3}) {
                            const SearchGrid grid = search_grid(reference_with(577, interval / 384), interval, 1.0 / 30);
                            Law law{a, b, fixed};
                            // one family only: every other one is dearer
                            law.share = [](const Model& m) {
                                return label(m).find("tolerance") == std::string::npos && m.scheme == Scheme::Newton &&
                                               m.detection == Detection::Swept && m.nodes != 0 && !m.rolling && !m.friction &&
                                               !m.normal && !m.trapezoid
                                           ? 1.0
                                           : 100.0;
                            };
                            const Model family = start_model(385, interval / 384);
                            const double least = cheapest(MadeUpTrialRuns(law, limit), grid, family);
                            if (!std::isfinite(least)) continue;
                            ++cases;
                            INFO("interval " << interval << " a " << a << " b " << b << " fixed " << fixed << " limit " << limit);
                            MadeUpTrialRuns trials(law, limit);
                            const SearchResult found =
                                search_models(scene, start_model(577, interval / 384), grid, false, trials, always);
                            CHECK(found.complete);
                            REQUIRE(found.best);
                            CHECK(trials.look_at(*found.best)->seconds <= 1.1 * least);
                            most_trials = std::max(most_trials, trials.count());
                        }
        CHECK(cases > 200);
        MESSAGE("at most " << most_trials << " trials");
        CHECK(most_trials < 100);  // a fifth of the grid's places
    }

    TEST_CASE("property: a coarser tolerance is never answered with a dearer model")
    {
        const Scene scene = small_scene();
        for (const double a : {4.0, 40.0, 400.0})
            for (const double b : {5e-3, 2e-2, 2e-1}) {
                CAPTURE(a);
                CAPTURE(b);
                const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
                double finer = INFINITY;
                for (const double limit : {5e-5, 1e-4, 2e-4, 1e-3, 1e-2}) {
                    MadeUpTrialRuns trials({a, b, 30}, limit);
                    const SearchResult found = search_models(scene, start_model(577, 2.6e-4), grid, true, trials, always);
                    if (!found.best) continue;
                    const double cost = trials.look_at(*found.best)->seconds;
                    CHECK(cost <= 1.1 * finer);  // each is within 1.1 of the cheapest, see above
                    finer = std::min(finer, cost);
                }
            }
    }

    TEST_CASE("property: a choice that saves more than its error costs is made, one that ruins the result is not")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        Law law;
        law.share = [](const Model& m) {
            return (m.precision == Precision::Float32 ? 0.5 : 1.0) * (m.detection == Detection::Nodes ? 0.1 : 1.0) *
                   (m.rolling == false ? 0.8 : 1.0) * (m.nodes == 0 ? 100.0 : 1.0);
        };
        law.extra_error = [](const Model& m) {
            return (m.precision == Precision::Float32 ? 1e-5 : 0.0) + (m.detection == Detection::Nodes ? 1.0 : 0.0);
        };
        MadeUpTrialRuns trials(law, 2e-4);
        const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always);
        REQUIRE(found.best);
        CHECK(found.best->precision == Precision::Float32);
        CHECK(found.best->rolling == false);
    }

    TEST_CASE("property: an elastic wall is rigid where that meets the goals, on a coarser mesh where only that does")
    {
        Scene scene = small_scene();
        scene.vessel.elastic = true;
        SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        grid.walls = {8e-3, 5.6e-3, 4e-3};
        grid.finest_wall = 2e-3;
        const double limit = 2e-4;
        double rigid_error = 0, edge_error = 0;  // of a rigid wall; of an edge of 4 mm, going with its square
        Law law;
        law.share = [](const Model& m) {
            const double edge = m.wall_edge.value_or(4e-3);
            return (m.elastic_wall == false ? 1.0 : 2 + 2 * std::pow(4e-3 / edge, 2)) * (m.nodes == 0 ? 100.0 : 1.0);
        };
        law.extra_error = [&](const Model& m) {
            return m.elastic_wall == false ? rigid_error : edge_error * std::pow(m.wall_edge.value_or(4e-3) / 4e-3, 2);
        };
        const auto search = [&](Model start) {
            MadeUpTrialRuns trials(law, limit);
            const SearchResult found = search_models(scene, start, grid, true, trials, always);
            for (const Model& model : trials.models()) CHECK((model.elastic_wall.value_or(true) || !model.wall_edge));
            REQUIRE(found.best);
            CHECK(trials.look_at(*found.best)->error <= limit);
            return *found.best;
        };
        Model start = start_model(385, 2.6e-4);
        start.wall_edge = 2.7e-3;
        CHECK(search(start).elastic_wall == false);
        rigid_error = 1;
        CHECK(search(start).wall_edge == 8e-3);
        edge_error = 0.3 * limit;  // four times as much at 8 mm, twice at 5.6
        CHECK(search(start).wall_edge == 5.6e-3);
        edge_error = 0.6 * limit;
        const Model own = search(start);
        CHECK(own.elastic_wall.value_or(true));
        CHECK_FALSE(own.wall_edge);  // as `run` has it
        edge_error = 3 * limit;      // at 4 mm nothing meets them
        start.wall_edge.reset();
        CHECK(search(start).wall_edge == 2e-3);
    }

    TEST_CASE("property: what is left out of a wall is named once, and a rigid one leaves nothing to choose")
    {
        Scene scene = small_scene();
        const auto of_wall = [](const std::vector<PlanChoice>& all) {
            return std::count_if(all.begin(), all.end(), [](const PlanChoice& choice) { return choice.of_wall; });
        };
        CHECK(of_wall(choices_in(scene)) == 0);
        scene.vessel.elastic = true;
        const std::vector<double> walls = {8e-3, 5.6e-3, 4e-3};
        const std::vector<PlanChoice> all = choices_in(scene, walls);
        CHECK(of_wall(all) == 4);
        CHECK(all.front().of_wall);  // first: it decides what every later trial costs
        // of the choices that are made already, those whose way back leads elsewhere: what a plan lists as left out
        const auto left_out = [&](const Model& chosen) {
            std::vector<std::string> names;
            for (const PlanChoice& choice : all) {
                Model made = chosen, undone = chosen;
                choice.make(made);
                choice.undo(undone);
                if (choice.of_wall && label(made) == label(chosen) && label(undone) != label(chosen))
                    names.push_back(choice.fuller);
            }
            return names;
        };
        Model model;
        CHECK(left_out(model).empty());
        model.elastic_wall = false;
        CHECK(left_out(model) == std::vector<std::string>{"the elastic wall"});
        model.elastic_wall.reset();
        model.wall_edge = 8e-3;
        CHECK(left_out(model) == std::vector<std::string>{"control edges of 4 mm"});
    }

    // A rod each costs as much as five centrelines. What hands feel is within the goals with friction only where they ask for
    // that.
    TEST_CASE("property: one centreline is tried with friction in the lumen and without; whichever is chosen, the other is named")
    {
        const SearchGrid grid = search_grid(reference_with(201, 1e-3), 1.0 / 30, 1.0 / 30);
        const auto named = [](const Scene& scene, const Model& chosen) {  // as the planner does it
            std::vector<std::pair<std::string, Model>> names;
            for (const PlanChoice& choice : choices_in(scene)) {
                Model made = chosen, fuller = chosen;
                choice.make(made);
                if (label(made) != label(chosen)) continue;
                choice.undo(fuller);
                if (label(fuller) != label(chosen)) names.emplace_back(choice.fuller, fuller);
            }
            return names;
        };
        for (const bool hands : {false, true}) {
            const Scene scene = coaxial_scene();
            const auto rubs = [](const Model& m) { return m.lumen_friction.value_or(false); };
            const auto merged = [](const Model& m) { return m.coaxial == CoaxialSpec::Model::Merged; };
            Law law;
            law.share = [=](const Model& m) { return !merged(m) ? 5.0 : rubs(m) ? 1.15 : 1.0; };
            law.extra_error = [=](const Model& m) { return merged(m) && !rubs(m) && hands ? 1.0 : 0.0; };
            MadeUpTrialRuns trials(law, 1e-3);
            Model start = start_model(201, 1e-3);
            start.detection.reset();  // there is no vessel
            const SearchResult result = search_models(scene, start, grid, false, trials, always);
            REQUIRE(result.best);
            CHECK(merged(*result.best));
            CHECK(rubs(*result.best) == hands);
            CHECK(apply(*result.best, scene).coaxial->lumen_friction == hands);
            const auto names = named(scene, *result.best);
            REQUIRE(names.size() == 2);
            CHECK(names[0].first == "a rod for each instrument");
            CHECK(!merged(names[0].second));
            CHECK(names[1].first == (hands ? "no friction between the instruments"
                                           : "friction between the instruments from contact force (coaxial.lumen_friction)"));
            CHECK(rubs(names[1].second) == !hands);
            for (const Model& model : trials.models()) CHECK(why_not(model, scene).empty());
        }
        Model one_step;  // what a world of several instruments refuses is none of the trials
        one_step.scheme = Scheme::Linearised;
        CHECK(why_not(one_step, coaxial_scene()).find("newton or static") != std::string::npos);
        one_step.coaxial = CoaxialSpec::Model::Merged;
        CHECK(!why_not(one_step, coaxial_scene()).empty());
        const Scene smooth = coaxial_scene("mu_static = 0.0\nmu_sliding = 0.0\n");
        for (const PlanChoice& choice : choices_in(smooth)) {
            CHECK(choice.simpler.find("lumen_friction") == std::string::npos);
            CHECK(choice.fuller.find("lumen_friction") == std::string::npos);
        }
    }

    TEST_CASE("property: choices that do not go together are never tried together, whichever was made first")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        // each pays on its own, the pairs most of all: what the search would take if it did not ask
        Law law;
        law.share = [](const Model& m) {
            return (m.detection == Detection::Layer ? 0.5 : 1.0) * (m.precision == Precision::Float32 ? 0.5 : 1.0) *
                   (m.scheme == Scheme::Linearised ? 0.5 : 1.0) * (m.normal == NormalLaw::Impulse ? 0.5 : 1.0);
        };
        MadeUpTrialRuns trials(law, 2e-4);
        const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always);
        REQUIRE(found.best);
        for (const Model& model : trials.models()) {
            CAPTURE(label(model));
            CHECK(why_not(model, scene) == "");
        }
    }

    TEST_CASE("property: what changes nothing is left out even if that saves nothing")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        Law law;
        law.share = [](const Model& m) { return m.nodes == 0 ? 100.0 : 1.0; };
        MadeUpTrialRuns trials(law, 2e-4);
        const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always);
        REQUIRE(found.best);
        CHECK(found.best->rolling == false);
        law.extra_error = [](const Model& m) { return m.rolling == false ? 4e-5 : 0.0; };
        MadeUpTrialRuns rolls(law, 2e-4);
        const SearchResult kept = search_models(scene, start_model(385, 2.6e-4), grid, true, rolls, always);
        REQUIRE(kept.best);
        CHECK(kept.best->rolling != false);
    }

    TEST_CASE("property: a choice that needs finer steps is made where it pays even then")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        Law law;
        law.share = [](const Model& m) { return (m.precision == Precision::Float32 ? 0.2 : 1.0) * (m.nodes == 0 ? 100.0 : 1.0); };
        law.extra_error = [b = law.b](const Model& m) {
            return m.precision == Precision::Float32 ? b * *m.dt : 0.0;
        };  // twice the error of steps
        MadeUpTrialRuns trials(law, 2e-4);
        const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always);
        REQUIRE(found.best);
        CHECK(found.best->precision == Precision::Float32);
    }

    TEST_CASE("property: what nothing vouches for is never tried, however cheap: a linearised step, the trapezoid in contact")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        Law law;
        law.share = [](const Model& m) {
            return (m.scheme == Scheme::Linearised ? 0.1 : 1.0) * (m.trapezoid == true ? 0.2 : 1.0);
        };
        for (const bool touches : {true, false}) {
            CAPTURE(touches);
            MadeUpTrialRuns trials(law, 2e-4);
            const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, touches, trials, always);
            REQUIRE(found.best);
            CHECK(found.best->trapezoid.value_or(false) == !touches);  // it swings freely: nothing is wrong with it there
            for (const Model& model : trials.models()) {
                CHECK(model.scheme != Scheme::Linearised);
                if (touches) CHECK_FALSE(model.trapezoid.value_or(false));
            }
        }
    }

    TEST_CASE("property: a scene's own choice of a scheme is no voucher for it")
    {
        Scene scene = small_scene();
        CHECK(not_vouched_for({}, scene, true) == "");
        scene.integrator.newmark = true;
        CHECK(not_vouched_for({}, scene, true) != "");
        CHECK(not_vouched_for({}, scene, false) == "");
        Model model;
        model.trapezoid = false;
        CHECK(not_vouched_for(model, scene, true) == "");
        scene.integrator.newmark = false;
        scene.integrator.scheme = Scheme::Linearised;
        CHECK(not_vouched_for({}, scene, false) != "");
    }

    TEST_CASE("property: adaptive nodes are chosen where they are cheaper at the same error")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        Law law{720, 2e-3, 3};  // edges matter: a uniform wire needs some 60
        MadeUpTrialRuns trials(law, 2.2e-5 + 2e-3 / 30);
        const SearchResult found = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always);
        REQUIRE(found.best);
        CHECK(found.best->nodes == 0);
    }

    TEST_CASE("property: a search that is cut short says so and keeps what it has")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        MadeUpTrialRuns trials(Law{}, 2e-4);
        int asked = 0;
        const SearchResult cut = search_models(scene, start_model(385, 2.6e-4), grid, true, trials, [&] { return ++asked <= 5; });
        CHECK_FALSE(cut.complete);
        REQUIRE(cut.best);
        CHECK(trials.look_at(*cut.best)->meets);
    }

    TEST_CASE("property: nothing that meets the goals is nothing, not the nearest")
    {
        const Scene scene = small_scene();
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        MadeUpTrialRuns trials(Law{}, 1e-9);
        CHECK_FALSE(search_models(scene, start_model(385, 2.6e-4), grid, true, trials, always).best);
    }

    TEST_CASE("property: what meets a rate is the most accurate that does")
    {
        const SearchGrid grid = search_grid(reference_with(577, 2.6e-4), 0.1, 1.0 / 30);
        MadeUpTrialRuns trials(Law{}, 2e-4);
        const Model from = start_model(385, 2.6e-4);
        const double rate = 0.02;  // seconds per second
        REQUIRE(trials.look_at(from)->seconds > rate);
        const std::optional<Model> fast = search_rate(from, grid, rate, trials, always);
        REQUIRE(fast);
        CHECK(trials.look_at(*fast)->seconds <= rate);
        Model coarsest = from;
        coarsest.nodes = grid.nodes.back();
        coarsest.dt = grid.steps.back();
        CHECK(trials.look_at(*fast)->error < 0.2 * trials.look_at(coarsest)->error);
        CHECK_FALSE(search_rate(from, grid, 1e-9, trials, always));
    }
}

}  // namespace seldinger::test::test_plan_search

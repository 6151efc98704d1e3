// [[instrument]] and [coaxial]: the scene that is read, that it is written back to the same scene, and one line for whatever is
// wrong.
#include "core/error.h"
#include "scene/scene.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"
#include "support/refusal.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace seldinger::test::test_scene_instruments {

namespace {

const std::string head = "[scene]\nduration_s = 1.0\ndt_s = 0.001\n";
const std::string stiff = "density = 7900.0\nbend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = 1e4\n";
const std::string inlet = "point = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";

std::string instrument(const std::string& name, const std::string& more)
{
    return "[[instrument]]\nname = \"" + name + "\"\n" + stiff + more;
}
std::string feed(const std::string& where, const std::string& keys)
{
    return "[instrument.feed]\n" + where + "keys = [" + keys + "]\n";
}

std::string catheter_and_wire(const std::string& more = {})
{
    return head +
           instrument("catheter",
                      "length_m = 0.5\nradius_m = 8.5e-4\nlumen_radius_m = 5e-4\n[[instrument.section]]\nfrom_tip_m = [0.0, "
                      "0.01]\nrest_curvature_1_m = [50.0, 0.0]\n") +
           feed(inlet, "{t_s = 0.0, advance_m = 0.05}") + instrument("wire", "length_m = 0.6\nradius_m = 4.4e-4\n") +
           feed("", "{t_s = 0.0, advance_m = 0.06}, {t_s = 0.5, advance_m = 0.1}") +
           (more.empty() ? "[coaxial]\norder = [\"catheter\", \"wire\"]\nmodel = \"separate\"\n" : more);
}

Scene read(const std::string& text, const std::vector<std::string>& set = {}) { return read_scene_text(text, "two.toml", set); }

std::string error_of(const std::string& text, const std::vector<std::string>& set = {})
{
    return refusal([&] { return make_setup(read(text, set)); });
}

}  // namespace

TEST_SUITE("scene/scene_instruments")
{
    TEST_CASE("analytic: a catheter and the wire in it become one system, outer first, fed at one inlet")
    {
        const Scene scene = read(catheter_and_wire());
        REQUIRE(scene.instrument_count() == 2);
        CHECK(scene.instrument(1).label == "wire");
        CHECK(scene.instrument(0).wire.sections.size() == 1);
        CHECK(scene.instrument(1).wire.sections.empty());
        const WorldSetup setup = make_setup(scene);
        REQUIRE(setup.wires.size() == 2);
        CHECK(setup.systems == std::vector<int>{2});
        REQUIRE(setup.coaxial.size() == 1);
        CHECK(setup.coaxial[0].order == std::vector<int>{0, 1});
        CHECK(setup.coaxial[0].model == CoaxialSpec::Model::Separate);
        CHECK(setup.wires[1].feed.point == setup.wires[0].feed.point);
        CHECK(setup.wires[1].feed.advance == 0.06);
        CHECK(prescribed_until(scene) == 0.5);
        const KeyFrames keys(scene);
        REQUIRE(keys.control().hubs().size() == 2);
        CHECK(keys.control().hubs()[1].keys.size() == 2);
    }

    TEST_CASE("property: written back it is the same scene")
    {
        const std::string held =
            "[contact]\ninstruments = true\n[[load]]\ninstrument = \"wire\"\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\n";
        const Scene scene = read(catheter_and_wire() + held);
        CHECK(scene.instruments_touch);
        CHECK(scene.instrument(0).loads.empty());
        CHECK(scene.instrument(1).loads.size() == 1);
        const std::string text = write_scene(scene, ".");
        CHECK(write_scene(read(text), ".") == text);
    }

    TEST_CASE("property: scenes side by side keep their instruments together")
    {
        const std::vector<Scene> scenes = {read(catheter_and_wire()), read(catheter_and_wire(), {"instrument.1.radius_m=4e-4"})};
        const WorldSetup setup = make_setup(scenes, {}, -1);
        CHECK(setup.systems == std::vector<int>{2, 2});
        REQUIRE(setup.coaxial.size() == 2);
        CHECK(setup.coaxial[1].order == std::vector<int>{2, 3});
        CHECK(setup.wires[3].wire.shaft.radius == 4e-4);
    }

    TEST_CASE("property: the length behind the inlet is one of merged instruments")
    {
        const std::vector<std::string> sets = {"coaxial.model=merged", "instrument.1.feed.behind_m=0.2"};
        const Scene scene = read(catheter_and_wire(), sets);
        const WorldSetup setup = make_setup(scene);
        CHECK(setup.wires[0].feed.behind == 0);
        CHECK(setup.wires[1].feed.behind == 0.2);
        const std::string text = write_scene(scene, ".");
        CHECK(says(text, "behind_m = 0.2"));
        CHECK(write_scene(read(text), ".") == text);
        const auto error_with = [&](const std::string& behind, const std::string& model = "merged") {
            return error_of(catheter_and_wire(), {"coaxial.model=" + model, "instrument.1.feed.behind_m=" + behind});
        };
        for (const char* wrong : {"-0.1", "inf", "nan", "long"}) {
            const std::string error = error_with(wrong);
            CHECK_MESSAGE(says(error, "instrument.1.feed.behind_m: expected a number, 0 or above"), error);
        }
        const std::string separate = error_with("0.2", "separate"), longer = error_with("0.9");
        CHECK_MESSAGE(says(separate, "instrument.1.feed.behind_m: is of instruments in one centreline only"), separate);
        CHECK_MESSAGE(says(longer, "instrument.1.feed.behind_m: 0.9 m behind the inlet and 0.06 m inside"), longer);
        CHECK(error_with("0.0", "separate").empty());
        for (const std::string& error : {separate, longer}) CHECK(!says(error, "\n"));
        const std::string alone = error_of(head + "[wire]\nlength_m = 0.3\nradius_m = 5e-4\n" + stiff +
                                           "[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nbehind_m = 0.1\n"
                                           "keys = [{t_s = 0.0, advance_m = 0.0}]\n");
        CHECK_MESSAGE(says(alone, "feed.behind_m: is of instruments in one centreline only"), alone);
    }

    TEST_CASE("property: friction of merged instruments, and what holds them")
    {
        const std::vector<std::string> sets = {"coaxial.model=merged", "coaxial.drag_n_m=0.3", "coaxial.viscous_pa_s=2.5",
                                               "coaxial.lumen_friction=true"};
        const Scene scene = read(catheter_and_wire(), sets);
        const WorldSetup setup = make_setup(scene);
        CHECK(setup.coaxial[0].drag == 0.3);
        CHECK(setup.coaxial[0].viscous == 2.5);
        CHECK(setup.coaxial[0].lumen_friction);
        const std::string text = write_scene(scene, ".");
        CHECK(says(text, "lumen_friction = true"));
        CHECK(write_scene(read(text), ".") == text);
        const Scene none = read(catheter_and_wire());
        CHECK(none.coaxial->drag == 0);
        CHECK(none.coaxial->viscous == 0);
        CHECK(!none.coaxial->lumen_friction);
        CHECK(!says(write_scene(none, "."), "drag_n_m"));
        for (const std::string key : {"drag_n_m", "viscous_pa_s"})
            for (const char* wrong : {"-0.1", "inf", "nan", "much"}) {
                const std::string error = error_of(catheter_and_wire(), {"coaxial." + key + "=" + wrong});
                CHECK_MESSAGE(says(error, "coaxial." + key + ": expected a number, 0 or above"), error);
                CHECK(!says(error, "\n"));
            }
        CHECK(
            says(error_of(catheter_and_wire(), {"coaxial.lumen_friction=1"}), "coaxial.lumen_friction: expected true or false"));
        const std::string hold = "[[hold]]\ninstrument = \"wire\"\nat = \"tip\"\nposition = true\n";
        CHECK(error_of(catheter_and_wire() + hold, {"coaxial.model=separate"}).empty());
        CHECK(error_of(catheter_and_wire() + hold, {"coaxial.model=merged"}).empty());
        const std::string tied = "[[link]]\ninstrument = \"wire\"\nat = \"tip\"\nanchor = [0.1, 0.0, 0.0]\nstiffness_n_m = 1.0\n";
        CHECK(error_of(catheter_and_wire() + tied, {"coaxial.model=merged"}).empty());
    }

    TEST_CASE("property: a friction between merged instruments that has no effect is a warning, and none where it has one")
    {
        const std::string merged = "[coaxial]\norder = [\"catheter\", \"wire\"]\n";
        const auto warned = [](const std::string& coaxial) {
            for (const std::string& warning : read(catheter_and_wire(coaxial)).warnings)
                if (warning.find("coaxial.mu_sliding: got 0.1") != std::string::npos) {
                    CHECK(has(warning, "coaxial.lumen_friction = true"));
                    CHECK(has(warning, "model = \"separate\""));
                    return true;
                }
            return false;
        };
        CHECK(warned(merged + "mu_static = 0.2\nmu_sliding = 0.1\n"));
        CHECK(warned(merged + "model = \"merged\"\nmu_static = 0.2\nmu_sliding = 0.1\n"));
        CHECK_FALSE(warned(merged + "lumen_friction = true\nmu_static = 0.2\nmu_sliding = 0.1\n"));
        CHECK_FALSE(warned(merged + "model = \"separate\"\nmu_static = 0.2\nmu_sliding = 0.1\n"));
        CHECK(read(catheter_and_wire(merged)).warnings.empty());
        // what the scene that a run writes says: every default
        CHECK(read(catheter_and_wire(merged + "mu_static = 0.06\nmu_sliding = 0.05\n")).warnings.empty());
    }

    TEST_CASE("error: what instruments cannot be joined with is named by file and key")
    {
        const std::string hold = "[[hold]]\ninstrument = \"wire\"\nat = \"tip\"\nposition = true\n";
        const std::string tube = "[vessel]\nshape = \"tube\"\nradius_m = 0.004\nlength_m = 0.5\norigin = [-0.01, 0.0, 0.0]\n";
        const std::pair<const char*, const char*> merged[] = {
            {"integrator.scheme", "linearised"}, {"integrator.scheme", "explicit"},
            {"integrator.conserve", "true"},     {"integrator.damping_stiffness_s", "0.01"},
            {"contact.instruments", "true"},     {"contact.detection", "nodes"},
            {"integrator.beta", "0.25"}};
        for (const auto& [key, value] : merged) {
            const std::string error =
                error_of(catheter_and_wire() + hold + tube, {"coaxial.model=merged", std::string(key) + "=" + value});
            CHECK_MESSAGE(says(error, fmt::format("--set {}={}: {}: ", key, value, key)), error);
        }
        const std::pair<const char*, const char*> separate[] = {{"integrator.scheme", "explicit"},
                                                                {"contact.precision", "float32"}};
        for (const auto& [key, value] : separate) {
            const std::string error = error_of(catheter_and_wire() + tube, {std::string(key) + "=" + value});
            CHECK_MESSAGE(says(error, fmt::format("--set {}={}: {}: ", key, value, key)), error);
        }
        const std::string error = error_of(catheter_and_wire() + "[integrator]\nscheme = \"linearised\"\n");
        CHECK_MESSAGE(says(error, "two.toml:"), error);
    }

    const std::string three =
        catheter_and_wire("\n") + "[[instrument]]\nname = \"second\"\n" + stiff + "length_m = 0.6\nradius_m = 4.9e-4\n" +
        feed("", "{t_s = 0.0, advance_m = 0.0}, {t_s = 2.0, advance_m = 0.0}, {t_s = 3.0, advance_m = 0.1}") +
        "[coaxial]\norder = [\"catheter\", \"wire\"]\nexchange = [\"second\"]\nmodel = \"separate\"\n";
    const std::string out_again = "instrument.1.feed.keys=[{t_s = 0.0, advance_m = 0.06}, {t_s = 2.0, advance_m = 0.0}]";

    TEST_CASE(
        "property: a wire may come out of its catheter, and a thicker one take its place; written and read back it is the same")
    {
        const Scene scene = read(three, {out_again});
        REQUIRE(scene.coaxial);
        CHECK(scene.coaxial->order == std::vector<int>{0, 1, 2});
        CHECK(scene.coaxial->exchanged == 2);
        CHECK(scene.coaxial->around(2) == 0);
        CHECK(make_setup(scene).coaxial[0].exchanged == 2);
        const std::string written = write_scene(scene, ".");
        CHECK(write_scene(read(written), ".") == written);
        CHECK(says(written, "exchange = [\"second\"]"));
        CHECK(error_of(catheter_and_wire(), {out_again}).empty());
    }

    TEST_CASE("error: a force drives one hub of a scene")
    {
        const std::vector<std::string> both{
            "instrument.0.feed.hub_mass_kg=0.1", "instrument.0.feed.keys=[{t_s = 0.0, force_n = 0.1}]",
            "instrument.1.feed.hub_mass_kg=0.1", "instrument.1.feed.keys=[{t_s = 0.0, force_n = 0.1}]"};
        CHECK(error_of(catheter_and_wire(), {both[0], both[1]}).empty());
        const std::string error = error_of(catheter_and_wire(), both);
        CHECK_MESSAGE(says(error, "instrument.1.feed.hub_mass_kg: a force drives the hub of \"catheter\" already"), error);
    }

    TEST_CASE("error: instruments that take each other's place are inside one at a time, and fit")
    {
        CHECK_MESSAGE(says(error_of(three), "instrument.2.feed: is inside after 2 s, as \"wire\" is"), error_of(three));
        const std::string thick = error_of(three, {out_again, "instrument.2.radius_m=6e-4"});
        CHECK_MESSAGE(says(thick, "instrument.2.radius_m: 0.0006 m is not below the lumen of \"catheter\""), thick);
    }

    TEST_CASE("error: one line for what contradicts itself")
    {
        const std::pair<std::string, std::string> wrong[] = {
            {"instrument.1.radius_m=6e-4", "instrument.1.radius_m: 0.0006 m is not below the lumen of \"catheter\", 0.0005 m"},
            {"instrument.0.lumen_radius_m=0.0", "instrument.1.radius_m: is inside \"catheter\", which has no lumen"},
            {"instrument.1.name=catheter", "instrument.1.name: \"catheter\" is instrument 0 already"},
            {"instrument.1.name=contacts", "instrument.1.name: \"contacts\" is the name of a run's own file"},
            {"instrument.1.name=\"a b\"", "instrument.1.name: expected 1 to 40 letters"},
            {"instrument.1.name=trace_catheter", "instrument.1.name: \"trace_catheter\" beside instrument 0, \"catheter\""},
            {"coaxial.order=[\"catheter\", \"wier\"]", "coaxial.order: no instrument is called \"wier\""},
            {"coaxial.order=[\"catheter\", \"catheter\"]", "coaxial.order: \"catheter\" is listed twice"},
            {"coaxial.order=[\"catheter\"]", "coaxial.order: expected two names"},
            {"coaxial.model=glued", "coaxial.model: expected one of"},
            {"instrument.1.feed.point=[0.0, 0.0, 0.0]", "instrument.1.feed.point: is that of the outer instrument"},
            {"instrument.1.feed.keys=[{t_s = 0.0, advance_m = -0.01}]",
             "instrument.1.feed.keys.advance_m: expected a number, 0 or above"},
            {"instrument.0.feed.hub_mass_kg=0.1", "instrument.0.feed.keys.force_n: is missing"},
            {"coaxial.exchange=[\"wier\"]", "coaxial.exchange: no instrument is called \"wier\""},
            {"coaxial.exchange=[\"wire\"]", "coaxial.exchange: \"wire\" is listed twice"},
            {"coaxial.exchange=[]", "coaxial.exchange: expected one name"},
            {"instrument.1.feed.keys=[{t_s = 0.0, advance_m = 0.7}]",
             "instrument.1.feed.keys.advance_m: 0.7 m is more than the whole wire"},
        };
        for (const auto& [set, line] : wrong) {
            const std::string error = error_of(catheter_and_wire(), {set}), asked = set;
            CHECK_MESSAGE(says(error, line), asked << " gave: " << error);
            CHECK(!says(error, "\n"));
        }
        std::string nest = head, order;
        for (int k = 0; k < 5; ++k) {
            nest += instrument(fmt::format("n{}", k),
                               fmt::format("length_m = 0.5\nradius_m = {}\n{}", 5e-3 - 1e-3 * k,
                                           k < 4 ? fmt::format("lumen_radius_m = {}\n", 4.5e-3 - 1e-3 * k) : "")) +
                    feed(k == 0 ? inlet : "", "{t_s = 0.0, advance_m = 0.05}");
            order += fmt::format("{}\"n{}\"", k ? ", " : "", k);
        }
        nest += "[coaxial]\norder = [" + order + "]\n";
        CHECK_MESSAGE(says(error_of(nest), "coaxial.order: got 5 instruments; expected at most 4"), error_of(nest));
        CHECK_MESSAGE(error_of(nest, {"coaxial.model=separate"}).empty(), error_of(nest, {"coaxial.model=separate"}));
        CHECK(says(error_of(catheter_and_wire() + "[wire]\nlength_m = 0.1\n"), "wire: is the one-instrument form"));
        CHECK(says(error_of(catheter_and_wire() + "[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\n"),
                   "load.0.instrument: is missing"));
        CHECK(says(error_of(head + "[wire]\nlength_m = 0.1\nradius_m = 5e-4\n" + stiff + "[coaxial]\norder = [\"a\", \"b\"]\n"),
                   "coaxial: joins several [[instrument]]"));
    }

    TEST_CASE("error: two instruments at one place")
    {
        const std::string beside = "[contact]\ninstruments = true\n";
        const std::string crossing =
            head + instrument("a", "length_m = 0.1\nradius_m = 5e-4\nplace = {base = [0.0, 0.0, 0.0]}\n") +
            instrument("b", "length_m = 0.1\nradius_m = 5e-4\nplace = {base = [0.05, -0.05, Z], direction = [0.0, 1.0, 0.0]}\n") +
            beside;
        const auto at = [&](const std::string& z) { return std::string(crossing).replace(crossing.find('Z'), 1, z); };
        CHECK(says(error_of(at("0.0")), "instrument.1.place: coincides with \"a\""));
        CHECK(error_of(at("0.001")).empty());
        const std::string fed =
            head + instrument("a", "length_m = 0.1\nradius_m = 5e-4\n") + feed(inlet, "{t_s = 0.0, advance_m = 0.05}") +
            instrument("b", "length_m = 0.1\nradius_m = 5e-4\n") + feed(inlet, "{t_s = 0.0, advance_m = 0.05}");
        CHECK(says(error_of(fed), "instrument.1.feed: coincides with \"a\""));
    }
}

}  // namespace seldinger::test::test_scene_instruments

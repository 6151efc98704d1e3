// Every way to get a scene wrong: one line that says where, names the key, and carries the right exit code.
#include "core/error.h"
#include "scene/scene.h"
#include "scene/toml_table.h"
#include "support/refusal.h"
#include "support/scenes.h"

#include <fmt/format.h>

#include <array>

namespace seldinger::test::test_scene_errors {

namespace {

const std::string good = scene_text(2) + wire_text(0.3, 1e-4, 8e-5);

const std::string fed =
    good + "[feed]\npoint = [0, 0, 0]\ndirection = [1, 0, 0]\nkeys = [{t_s = 0, advance_m = 0}, {t_s = 1, advance_m = 0.1}]\n";
const std::string held = good + "[[hold]]\nat = \"base\"\nposition = true\n";

/// @param sets  --set     @param says  part of the message
void check_mistake(const std::string& text, const std::vector<std::string>& sets, const std::string& says,
                   ErrorKind kind = ErrorKind::BadScene)
{
    CAPTURE(text);
    check_refused([&] { return read_scene_text(text, "bad.toml", sets); }, {says}, kind);
}

void check_mistake(const std::string& text, const std::string& says, ErrorKind kind = ErrorKind::BadScene)
{
    check_mistake(text, {}, says, kind);
}

}  // namespace

TEST_SUITE("scene/scene_errors")
{
    TEST_CASE("property: the scenes that the mistakes start from are good")
    {
        for (const auto& text : {good, fed, held}) CHECK_NOTHROW((void)read_scene_text(text, "good.toml"));
    }

    TEST_CASE("property: an unknown key is named with its place and the nearest known key")
    {
        check_mistake("[scene]\nduration_s = 1\ndt_s = 1e-3\n[wire]\nlenght_m = 1\n",
                      "bad.toml:5:1: wire.lenght_m: unknown key; the nearest known one is wire.length_m");
        check_mistake(good + "[contacts]\n", "contacts: unknown key; the nearest known one is contact");
        check_mistake(good + "[contact]\nmu_statik = 0.1\n",
                      "bad.toml:12:1: contact.mu_statik: unknown key; the nearest known one is contact.mu_static");
        check_mistake(
            good, {"contact.detektion=layer"},
            "--set contact.detektion=layer: contact.detektion: unknown key; the nearest known one is contact.detection");
        check_mistake(good, {"conntact.detection=layer"},
                      "--set conntact.detection=layer: conntact: unknown key; the nearest known one is contact");
        check_mistake(held + "bending = true\n", "hold.0.bending: unknown key");
        check_mistake(good + "place = { bas = [0, 0, 0] }\n",
                      "wire.place.bas: unknown key; the nearest known one is wire.place.base");
        check_mistake(fed, {"feed.keys.1.advanced_m=0.2"},
                      "feed.keys.advanced_m: unknown key; the nearest known one is feed.keys.advance_m");
    }

    TEST_CASE("property: UTF-16 and paths with backslashes are answered with what to do")
    {
        std::string wide = "\xFF\xFE";
        for (const char c : good) wide += c, wide += '\0';
        for (const std::string& text : {wide, wide.substr(2)})
            CHECK(refusal([&] { return read_scene_text(text, "bad.toml", {}); }) ==
                  "bad.toml: got text in UTF-16; expected UTF-8. Fix: save the file again with the encoding UTF-8");
        check_mistake(good + "[vessel]\nmesh = \"C:\\vessels\\a.stl\"\n", "write paths with /, or in single quotes");
        // \t and \b are escapes: TOML, but no path
        check_mistake(good + "[vessel]\nmesh = \"C:\\temp\\b.stl\"\n", "write paths with /, or in single quotes",
                      ErrorKind::BadFile);
        check_mistake(good + "[vessel]\nmesh = 'meshes\\a.stl'\n", "write paths with /", ErrorKind::BadFile);
    }

    TEST_CASE("property: syntax errors carry file, line and column")
    {
        check_mistake("[scene]\nduration_s = = 1\n", "bad.toml:2:14: is not TOML");
        check_mistake("[scene\n", "bad.toml:1");
        check_mistake(good + "density = 1\n", "bad.toml:11");
        check_mistake(good + "[wire]\n", "bad.toml:11");
        check_mistake("\xff\xfe", "got text in UTF-16; expected UTF-8");
        check_mistake("", "wire: is missing");
        check_mistake("[wire]\n", "scene: is missing");
        check_mistake("[[wire]]\nlength_m = 1\n", "wire: expected one table [wire]");
        check_mistake("wire = 3\n", "wire: expected one table [wire]");
        check_mistake(good + "[hold]\nat = \"base\"\n", "hold: expected tables [[hold]]");
    }

    TEST_CASE("property: what is needed is asked for by name")
    {
        for (const auto key : {"length_m", "radius_m", "density", "bend_nm2", "twist_nm2", "stretch_n", "duration_s", "dt_s"}) {
            std::string text = good;
            const auto at = text.find(key);
            REQUIRE(at != std::string::npos);
            text.erase(at, text.find('\n', at) + 1 - at);
            check_mistake(text, std::string(key) + ": is missing");
        }
        check_mistake(good + "place = { shape = \"arc\" }\n", "wire.place.bend_radius_m: is missing");
        check_mistake(good + "place = { shape = \"points\" }\n", "wire.place.points: is missing");
        check_mistake(good + "[vessel]\nunits = \"mm\"\n", "vessel.mesh: is missing");
        check_mistake(good + "[vessel]\nshape = \"tube\"\nlength_m = 1\n", "vessel.radius_m: is missing");
        check_mistake(good + "[vessel]\nshape = \"arc\"\nradius_m = 0.01\nbend_radius_m = 1\n", "vessel.angle_deg: is missing");
        check_mistake(good + "[feed]\npoint = [0, 0, 0]\n", "feed.direction: is missing");
        check_mistake(good + "[feed]\npoint = [0, 0, 0]\ndirection = [1, 0, 0]\n", "feed.keys: is missing");
        check_mistake(good + "[[load]]\nforce_n = [0, 0, 1]\n", "load.0.at: is missing");
        check_mistake(good + "[[load]]\nat = \"tip\"\n", "load.0.force_n: is missing");
        check_mistake(good + "[[link]]\nat = \"tip\"\nanchor = [0, 0, 0]\n", "link.0.stiffness_n_m: is missing");
        check_mistake(good + "[[wire.section]]\nbend_nm2 = 1\n", "wire.section.0.from_tip_m: is missing");
        check_mistake(fed, {"feed.keys=[{t_s=0}]"}, "feed.keys.advance_m: is missing");
        check_mistake(fed, {"feed.hub_mass_kg=0.1"}, "feed.keys.force_n: is missing");
        check_mistake(fed, {"feed.keys=[{t_s=0, force_n=1.0}]"},
                      "feed.keys.force_n: is of a hub that a force drives; give hub_mass_kg");
        check_mistake(fed, {"feed.hub_friction_n=0.1"}, "feed.hub_friction_n: is of a hub that a force drives");
        check_mistake(fed, {"feed.hub_mass_kg=0.1", "feed.keys=[{t_s=0, force_n=0.1}, {t_s=1, force_n=0.1, advance_m=0.1}]"},
                      "feed.keys.advance_m: got 0.1 m after 0 m, of a hub that a force drives");
        check_mistake(fed, {"feed.hub_mass_kg=0.1", "feed.keys=[{t_s=0, force_n=0.1}]", "integrator.conserve=true"},
                      "feed.hub_mass_kg: a hub that a force drives is solved with integrator.scheme = \"newton\"");
    }

    TEST_CASE("property: zero, negative, NaN, infinite and mistyped quantities are refused")
    {
        for (const auto key :
             {"wire.length_m", "wire.radius_m", "wire.density", "wire.bend_nm2", "wire.twist_nm2", "wire.stretch_n",
              "scene.duration_s", "scene.dt_s", "contact.stiffness", "contact.restitution", "integrator.tolerance",
              "contact.rolling_hardness_pa", "contact.layer_height_m", "contact.pair_distance_m", "integrator.beta"})
            for (const auto value : {"0", "-1", "nan", "inf", "-inf", "true", "[1]"})
                check_mistake(good, {std::string(key) + "=" + value}, std::string(key) + ": ");
        for (const auto key : {"contact.mu_static", "contact.mu_sliding", "wire.mu_static", "integrator.damping_mass_1_s",
                               "contact.rolling_alpha"})
            for (const auto value : {"-0.1", "nan", "inf", "yes"})
                check_mistake(good, {std::string(key) + "=" + value}, std::string(key) + ": expected");
        for (const auto key : {"wire.nodes", "scene.record_every", "contact.samples_per_edge"})
            for (const auto value : {"0", "-3", "1.5", "many", "99999999999"})
                check_mistake(good, {std::string(key) + "=" + value}, std::string(key) + ": expected");
        for (const auto value : {"[1, 2]", "3", "[0, 0, nan]", "[0, 0, \"a\"]", "down"})
            check_mistake(good, {std::string("scene.gravity=") + value}, "scene.gravity: expected");
        check_mistake(good, {"scene.seed=-1"}, "scene.seed: expected");
        check_mistake(good, {"contact.rolling=1"}, "contact.rolling: expected true or false");
        check_mistake(good, {"scene.name=3"}, "scene.name: expected a text");
        check_mistake(fed, {"feed.direction=[0, 0, 0]"}, "feed.direction: expected a direction");
        check_mistake(good, {"integrator.gamma=0.6"}, "integrator.gamma: got 0.6; expected 0.5, the trapezoid rule");
        check_mistake(good, {"output.wire_every=-1"}, "output.wire_every: expected");
        check_mistake(good, {"integrator.conserve=1"}, "integrator.conserve: expected true or false");
        check_mistake(good, {"integrator.conserve=true", "integrator.beta=0.25"}, "integrator.beta: belongs to Newmark's scheme");
        check_mistake(good, {"integrator.conserve=true", "integrator.scheme=linearised"},
                      "integrator.conserve: energy is conserved");
    }

    TEST_CASE(
        "property: sizes whose powers are no numbers, or that make more places than there is memory for, are refused by their "
        "key")
    {
        for (const char* key : {"wire.density", "wire.radius_m", "wire.bend_nm2", "wire.length_m"})
            for (const char* value : {"1e-308", "1e-31"})
                check_mistake(good, {fmt::format("{}={}", key, value)},
                              fmt::format("{}: expected a number above 0, at least 1e-30", key));
        CHECK_NOTHROW((void)read_scene_text(good, "good.toml", std::vector<std::string>{"wire.density=1e-30"}));
        // contact is looked for once a radius: of 0.3 m half a million times at most
        const std::string walled = good + "[vessel]\nshape = \"tube\"\nradius_m = 0.005\nlength_m = 0.3\n";
        const std::vector<std::string> thin = {"wire.radius_m=5e-7"}, just = {"wire.radius_m=7e-7"};
        check_mistake(walled, thin, "wire.radius_m: 5e-07 m is thinner than 2e-06 to the wire's length, 0.3 m");
        CHECK_NOTHROW((void)read_scene_text(walled, "good.toml", just));
        CHECK_NOTHROW((void)read_scene_text(good, "good.toml", thin));  // nothing to touch
        check_mistake(walled + "[[wire.section]]\nfrom_tip_m = [0.0, 0.01]\nradius_m = 1e-12\n",
                      "wire.section.0.radius_m: 1e-12 m is thinner");
        check_mistake(walled, {"wire.length_m=9999.0"}, "wire.radius_m: 0.0004 m is thinner");
    }

    TEST_CASE("property: a text that ends before it ends names no file")
    {
        const std::string mesh = good + "[vessel]\nmesh = \"a.stl\\u0000.obj\"\n";
        check_mistake(mesh, "vessel.mesh: expected a text without \\u0000");
        check_mistake("include = \"a.toml\\u0000b\"\n" + good, "include: expected a file's path");
    }

    TEST_CASE("property: a word that is none of the choices is answered with the choices")
    {
        check_mistake(good, {"contact.detection=rays"},
                      "got 'rays'; expected one of \"swept\", \"layer\", \"nodes\", \"capsule\"");
        for (const auto key : {"scene.until", "scene.start", "wire.rest", "wire.curvature", "integrator.scheme",
                               "integrator.spins", "contact.normal", "contact.friction", "vessel.shape"})
            check_mistake(good, {std::string(key) + "=nonsense"}, std::string(key) + ": expected one of");
        check_mistake(good, {"contact.stiffness=soft"}, "contact.stiffness: expected \"from-wall\" or a number");
        check_mistake(good, {"wire.nodes=some"}, "wire.nodes: expected \"adaptive\" or a whole number");
        check_mistake(good, {"wire.place.shape=knot"}, "wire.place.shape: expected one of");
        check_mistake(held, {"hold.0.at=middle"}, "hold.0.at: expected \"base\", \"tip\" or metres");
    }

    TEST_CASE("property: keys that contradict each other are refused")
    {
        check_mistake(good + "youngs_pa = 1e9\n", "bend_nm2: contradicts youngs_pa");
        check_mistake(good + "poisson = 0.3\n", "wire.poisson: needs youngs_pa");
        check_mistake(good + "[vessel]\nmesh = \"bad.toml\"\nshape = \"tube\"\n", "vessel.shape: contradicts mesh");
        check_mistake(good + "[vessel]\nshape = \"plane\"\nsize_m = 1\nradius_m = 1\n",
                      "vessel.radius_m: is not used by shape = \"plane\"");
        check_mistake(good + "[vessel]\nshape = \"tube\"\nradius_m = 0.1\nlength_m = 1\nunits = \"mm\"\n",
                      "vessel.units: is not used by");
        check_mistake(good + "[vessel]\nshape = \"arc\"\nradius_m = 0.1\nbend_radius_m = 0.1\nangle_deg = 90\n",
                      "vessel.bend_radius_m: expected more than radius_m");
        check_mistake(good + "[vessel]\nshape = \"tube\"\nradius_m = 0.1\nlength_m = 1\naxis = [0, 0, 1]\nnormal = [0, 0, -2]\n",
                      "vessel.normal: is parallel to axis");
        check_mistake(good, {"contact.exponent=2"}, "contact.exponent: stiffness = \"from-wall\" fixes it at 1.5");
        check_mistake(good + "place = { shape = \"straight\", twist_rad = 1 }\n",
                      "wire.place.twist_rad: is not used by shape = \"straight\"");
        check_mistake(good + "place = { direction = [0, 0, 1], normal = [0, 0, -2] }\n",
                      "wire.place.normal: is parallel to direction");
        check_mistake(good + "place = { shape = \"points\", points = [[0, 0, 0], [0.1, 0, 0]] }\n",
                      "wire.place.points: the points are 0.1 m long, the wire 0.3 m");
        check_mistake(good + "place = { shape = \"points\", points = [[0, 0, 0], [0, 0, 0]] }\n",
                      "wire.place.points: expected no point twice");
        check_mistake(fed, {"wire.place.shape=straight"}, "wire.place: a fed wire starts at rest at the inlet");
        check_mistake(fed, {"wire.rest=placed"}, "wire.rest: a fed wire is not placed");
        check_mistake(fed + "[[hold]]\nat = \"base\"\nposition = true\n", "hold.0.at: the base is held by [feed]");
        check_mistake(fed, {"feed.inlet=auto"}, "feed.point: contradicts inlet");
        check_mistake(good + "[feed]\ninlet = \"auto\"\nkeys = [{t_s = 0, advance_m = 0}]\n", "feed.inlet: needs a [vessel]");
        check_mistake(good + "[[hold]]\nat = \"base\"\n", "hold.0.position: fixes nothing");
        check_mistake(held, {"hold.0.turn=[[0, 0]]"}, "hold.0.turn: needs spin = true");
        check_mistake(good + "[[hold]]\nat = \"tip\"\nspin = true\nmove = [[0, 0, 0, 0]]\n",
                      "hold.0.move: needs position = true");
        check_mistake(good, {"wire.min_edge_m=0.02", "wire.nodes=adaptive"}, "wire.min_edge_m: expected less than max_edge_m");
        check_mistake(good, {"wire.radius_m=0.2"}, "wire.radius_m: expected a wire longer than it is thick");
    }

    TEST_CASE("property: times that do not increase and lengths beyond the wire are refused")
    {
        check_mistake(fed, {"feed.keys=[{t_s=0, advance_m=0}, {t_s=0, advance_m=0.1}]"},
                      "feed.keys.t_s: expected times that increase");
        check_mistake(fed, {"feed.keys=[{t_s=-1, advance_m=0}]"}, "feed.keys.t_s: expected");
        check_mistake(fed, {"feed.keys=[]"}, "feed.keys: expected");
        check_mistake(fed, {"feed.keys.1.advance_m=0.31"},
                      "--set feed.keys.1.advance_m=0.31: feed.keys.advance_m: 0.31 m is more than the whole wire, 0.3 m");
        check_mistake(fed, {"feed.keys.1.advance_m=-0.1"}, "feed.keys.advance_m: expected");
        check_mistake(held, {"hold.0.move=[[0, 0, 0, 0], [0, 1, 0, 0]]"}, "hold.0.move: expected times from 0 on that increase");
        check_mistake(held, {"hold.0.move=[[0, 0, 0]]"}, "hold.0.move: expected a row [t_s, dx, dy, dz]");
        check_mistake(held, {"hold.0.at=0.4"}, "hold.0.at: expected at most the wire's length");
        check_mistake(good, {"wire.section.0.from_tip_m=[0.1, 0.4]"}, "wire.section.0.from_tip_m: expected 0 <= from < to");
        check_mistake(good, {"wire.section.0.from_tip_m=[0.1, 0.1]"}, "wire.section.0.from_tip_m: expected 0 <= from < to");
        check_mistake(good, {"scene.dt_s=5"}, "scene.duration_s: expected at least one step");
        check_mistake(good, {"scene.dt_s=1e-12"}, "scene.dt_s: makes 2e+12 steps");
    }

    TEST_CASE("property: an elastic wall is a thin shell, and something holds it")
    {
        const std::string tube = good + "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 0.3\n";
        const std::string elastic = tube + "wall = \"elastic\"\n";
        CHECK_NOTHROW((void)read_scene_text(elastic, "good.toml"));
        check_mistake(good, {"vessel.wall=elastic"}, "vessel.mesh: is missing");
        check_mistake(elastic, {"vessel.youngs_pa=0"}, "vessel.youngs_pa: expected");
        check_mistake(elastic, {"vessel.poisson=0.5"}, "vessel.poisson: expected");
        check_mistake(elastic, {"vessel.poisson=-0.1"}, "vessel.poisson: expected");
        check_mistake(elastic, {"vessel.thickness_m=0"}, "vessel.thickness_m: expected");
        check_mistake(elastic, {"vessel.thickness_m=0.011"}, "vessel.thickness_m: expected at most radius_m, 0.01 m");
        for (const auto key : {"support_pa_m", "support_pa_s_m", "relaxation_s", "wall_edge_m"})
            for (const auto value : {"-1", "nan", "inf", "soft"})
                check_mistake(elastic, {std::string("vessel.") + key + "=" + value}, std::string(key) + ": expected");
        for (const auto value : {"nan", "inf", "high"})
            check_mistake(elastic, {std::string("vessel.pressure_pa=") + value}, "vessel.pressure_pa: expected");
        check_mistake(elastic, {"vessel.rims=loose"}, "vessel.rims: expected one of");
        check_mistake(elastic, {"vessel.rims=free", "vessel.support_pa_m=0"}, "vessel.support_pa_m: expected more than 0");
        // each of the two is enough, and a rigid wall needs neither
        CHECK_NOTHROW((void)read_scene_text(elastic + "support_pa_m = 0\n", "good.toml"));
        CHECK_NOTHROW((void)read_scene_text(elastic + "rims = \"free\"\n", "good.toml"));
        CHECK_NOTHROW((void)read_scene_text(tube + "rims = \"free\"\nsupport_pa_m = 0\nthickness_m = 0.1\n", "good.toml"));
    }

    TEST_CASE("property: a normal law says what it cannot be joined with")
    {
        for (const std::string law : {"augmented", "constraint", "impulse", "barrier"}) {
            const std::string asked = "contact.normal=" + law, key = "contact.normal: \"" + law + "\"";
            check_mistake(good, {asked, "contact.detection=layer"}, key + " needs material samples");
            for (const std::string scheme : {"linearised", "explicit"})
                check_mistake(good, {asked, "integrator.scheme=" + scheme}, key + " is solved by Newton's method");
        }
        check_mistake(good, {"contact.overlap_m=0"}, "contact.overlap_m: expected a number above 0");
        check_mistake(good, {"contact.overlap_m=0.001"},
                      "contact.overlap_m: 0.001 m is more than a quarter of the wire's radius");
        check_mistake(good, {"contact.barrier_distance_m=0.001"},
                      "contact.barrier_distance_m: 0.001 m is more than a tenth of the wire's radius");
    }

    TEST_CASE("property: a --set that cannot be understood is named whole")
    {
        check_mistake(good, {"wire"}, "--set wire: expected table.key=value");
        check_mistake(good, {"nodes=3"}, "--set nodes=3: expected table.key=value");
        check_mistake(good, {"wire..nodes=3"}, "--set wire..nodes=3: expected table.key=value");
        check_mistake(good, {"wire.nodes="}, "--set wire.nodes=: expected a TOML value");
        check_mistake(good, {"scene.gravity=[0, 0"}, "--set scene.gravity=[0, 0: expected a TOML value");
        check_mistake(good, {"wire.length_m.x=1"}, "--set wire.length_m.x=1: wire.length_m");
        check_mistake(good, {"hold.1.position=true"}, "--set hold.1.position=true: there are only 0 of hold");
        check_mistake(good, {"wire.nodes=3\nscene.dt_s=1"}, "expected a value on one line");
        // quotes make no text of a path: each dot is a level
        std::string quoted = "wire.\"a";
        for (int k = 0; k < 32; ++k) quoted += ".a";
        check_mistake(good, {quoted + "\"=1"}, "is nested deeper than 32 levels");
    }

    TEST_CASE("property: missing files are files' mistakes")
    {
        check_mistake(good + "[vessel]\nmesh = \"nowhere/a.stl\"\n", "bad.toml:12:8: vessel.mesh: no file at",
                      ErrorKind::BadFile);
        check_mistake(good, {"vessel.shape=tube", "vessel.radius_m=1", "vessel.length_m=1", "vessel.centreline=none.vtp"},
                      "vessel.centreline: no file at", ErrorKind::BadFile);
        for (const auto file : {"no-such-scene.toml", "/"})
            check_refused([&] { return read_scene(file); }, {file}, ErrorKind::BadFile);
    }

    TEST_CASE("analytic: edit distance counts inserts, deletions, replacements and swaps")
    {
        CHECK(edit_distance("", "") == 0);
        CHECK(edit_distance("abc", "abc") == 0);
        CHECK(edit_distance("", "abc") == 3);
        CHECK(edit_distance("lenght", "length") == 1);
        CHECK(edit_distance("kitten", "sitting") == 3);  // [Levenshtein66]
        constexpr std::array<std::string_view, 3> words = {"mu_static", "mu_sliding", "normal"};
        CHECK(nearest_word("mu_slide", words) == "mu_sliding");
    }
}

}  // namespace seldinger::test::test_scene_errors

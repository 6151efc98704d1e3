// Scene files: the contract's defaults, every documented key, overrides, and the way back to text.
#include "core/error.h"
#include "scene/scene.h"
#include "scene/scene_keys.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/shared_folder.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

namespace seldinger::test::test_scene {

using keys::Key;

namespace {

const std::string minimal = scene_text(2) + wire_text(0.3, 1e-4, 8e-5);

// every table and every key that can stand in one scene; generated shapes and placements have cases of their own
const std::string full = R"([scene]
name = "a \"full\" scene, with µ"
gravity = [0.1, -0.2, -9.80665]
duration_s = 3.3333333333333335
dt_s = 0.0005
until = "rest"
record_every = 7
seed = 42
start = "settled"
[wire]
length_m = 0.1
radius_m = 0.000178
density = 6450.0
youngs_pa = 60.0e9
poisson = 0.33
nodes = 55
min_edge_m = 0.0011
max_edge_m = 0.0099
edge_error_m = 3.1e-6
mu_static = 0.3
mu_sliding = 0.25
curvature = "tangent"
place = { shape = "arc", base = [0.1, 0.2, 0.3], direction = [1.0, 0.3, 0.0], normal = [0.0, 0.0, 2.0], bend_radius_m = 0.7 }
rest = "placed"
velocity_m_s = [0.01, 0.02, 0.03]
spin_rad_s = 1.5
[[wire.section]]
from_tip_m = [0.0, 0.03]
bend_nm2 = 1.0e-6
rest_curvature_1_m = [20.0, -3.0]
mu_sliding = 0.05
[[wire.section]]
from_tip_m = [0.03, 0.05]
radius_m = 0.00015
poisson = 0.2
[integrator]
scheme = "linearised"
beta = 0.25
gamma = 0.5
spins = "kept"
tolerance = 1e-8
damping_mass_1_s = 0.7
damping_stiffness_s = 1e-5
[vessel]
shape = "arc"
radius_m = 0.002
bend_radius_m = 0.04
angle_deg = 77.7
lead_in_m = 0.03
lead_out_m = 0.09
origin = [1.0, 2.0, 3.0]
axis = [0.0, 1.0, 0.0]
normal = [1.0, 0.0, 0.0]
triangles = 1234
wall = "rigid"
youngs_pa = 2e6
poisson = 0.4
thickness_m = 0.0015
[contact]
detection = "layer"
normal = "lankarani-nikravesh"
friction = "smooth"
stiffness = 1e7
exponent = 1.2
restitution = 0.7
mu_static = 0.2
mu_sliding = 0.15
rolling = true
rolling_alpha = 0.1
rolling_sigma_b_pa = 10.0
rolling_sigma_s_pa = 20.0
rolling_hardness_pa = 3e6
layer_height_m = 0.001
pair_distance_m = 0.0005
samples_per_edge = 4
[[hold]]
at = "base"
position = true
direction = true
spin = true
move = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.01, 0.0, 0.0]]
turn = [[0.0, 0.0], [1.0, 3.1]]
velocity_m_s = [0.0, 0.0, 0.001]
until_s = 2.5
[[hold]]
at = "tip"
position = ["y", "z"]
move = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.01, 0.0]]
[[load]]
at = "tip"
force_n = [0.0, 0.0, -0.005519095775070086]
moment_nm = [1e-9, 0.0, 0.0]
ramp_s = 0.5
until_s = 1.25
[[link]]
at = 0.02
anchor = [0.1, 0.1, 0.1]
stiffness_n_m = 12.5
move = [[0.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.1, 0.0]]
[output]
wire_every = 11
contacts_every = 0
)";

void check_same(const std::vector<Key>& a, const std::vector<Key>& b);

/// Of values of keys: whether another one is the same to the bit. (Special ones are compared as they are written.)
struct Same {
    const keys::Value& other;
    template <class V>
    bool operator()(const V& value) const
    {
        return same(value, std::get<V>(other));
    }
    static bool same(const keys::Number& a, const keys::Number& b) { return *a.value == *b.value; }
    static bool same(const keys::Count& a, const keys::Count& b) { return *a.value == *b.value; }
    static bool same(const keys::Numbers& a, const keys::Numbers& b)
    {
        return std::ranges::equal(a.values, b.values, [](const double* v, const double* w) { return *v == *w; });
    }
    static bool same(const keys::Rows& a, const keys::Rows& b) { return a.get() == b.get(); }
    static bool same(const keys::Words& a, const keys::Words& b) { return a.get() == b.get(); }
    static bool same(const keys::Special& a, const keys::Special& b) { return a.text == b.text; }
    static bool same(const keys::Tables& a, const keys::Tables& b)
    {
        REQUIRE(a.tables.size() == b.tables.size());
        for (std::size_t k = 0; k < a.tables.size(); ++k) check_same(a.tables[k], b.tables[k]);
        return true;
    }
    template <class T>
    static bool same(T* a, T* b)
    {
        return *a == *b;
    }
};

void check_same(const std::vector<Key>& a, const std::vector<Key>& b)
{
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
        const std::string key(a[k].name);
        CAPTURE(key);
        REQUIRE(key == b[k].name);
        REQUIRE(a[k].value.index() == b[k].value.index());
        CHECK(std::visit(Same{b[k].value}, a[k].value));
    }
}

/// Every key of every table.
void check_same(Scene a, Scene b)
{
    const std::vector<keys::Table> first = keys::tables(a), second = keys::tables(b);
    REQUIRE(first.size() == second.size());
    for (std::size_t k = 0; k < first.size(); ++k) {
        CAPTURE(first[k].name);
        check_same(first[k].keys, second[k].keys);
    }
    CHECK(a.feed.on == b.feed.on);
}

/// Writes the scene for another folder, reads it from there, and compares everything.
void check_round_trip(const Scene& scene)
{
    const TemporaryFolder folder;
    const std::string text = write_scene(scene, folder.path());
    const Scene again = read_scene_text(text, folder.path() / "scene.toml");
    check_same(scene, again);
    CHECK(write_scene(again, folder.path()) == text);
}

Scene read(const std::string& text, std::vector<std::string> overrides = {})
{
    return read_scene_text(text, "test.toml", overrides);
}

}  // namespace

TEST_SUITE("scene/scene")
{
    TEST_CASE("property: what a scene leaves out has the contract's default")
    {
        const Scene s = read(minimal);
        CHECK(s.name == "test");
        CHECK(s.gravity == Vec3(0, 0, -9.81));
        CHECK(s.steps() == 2000);
        CHECK(s.until == Until::Time);
        CHECK(s.record_every == 10);
        CHECK_FALSE(s.start_settled);
        CHECK(s.wire.nodes == 101);
        CHECK(s.wire.place.shape == PlaceShape::Straight);
        CHECK_FALSE(s.wire.place.rest_is_placed);
        CHECK(s.wire.shaft.mu_static == 0.12);
        CHECK(s.wire.shaft.mu_sliding == 0.10);
        CHECK(s.integrator.scheme == Scheme::Newton);
        CHECK_FALSE(s.integrator.newmark);
        CHECK_FALSE(s.integrator.conserve);
        CHECK(s.integrator.spins == Spins::Auto);
        CHECK(s.wire.curvature == CurvatureMeasure::Angle);
        CHECK(s.integrator.damping_mass == 0);
        CHECK(s.vessel.shape == VesselShape::None);
        CHECK(s.contact.detection == Detection::Swept);
        CHECK(s.contact.normal == NormalLaw::HuntCrossley);
        CHECK(s.contact.friction == FrictionLaw::StickSlip);
        CHECK(s.contact.stiffness_from_wall);
        CHECK(s.contact.restitution == 0.5);
        CHECK_FALSE(s.contact.rolling);
        CHECK(s.wire_every == 20);  // 2000 steps, about 100 frames
        CHECK_FALSE(s.feed.on);
    }

    TEST_CASE("property: every documented key arrives where it belongs")
    {
        const Scene s = read(full);
        CHECK(s.name == "a \"full\" scene, with µ");
        CHECK(s.steps() == 6667);
        CHECK(s.until == Until::Rest);
        CHECK(s.seed == 42);
        CHECK(s.start_settled);
        CHECK(s.wire.place.bend_radius == 0.7);
        CHECK(s.wire.place.rest_is_placed);
        CHECK(s.wire.place.velocity == Vec3(0.01, 0.02, 0.03));
        CHECK(s.integrator.scheme == Scheme::Linearised);
        CHECK(s.integrator.newmark);
        CHECK(s.integrator.spins == Spins::Kept);
        CHECK(s.wire.curvature == CurvatureMeasure::Tangent);
        CHECK(s.vessel.shape == VesselShape::Arc);
        CHECK(s.vessel.angle == 77.7 * std::numbers::pi / 180);
        CHECK(s.contact.detection == Detection::Layer);
        CHECK(s.contact.stiffness == 1e7);
        CHECK(s.contact.samples_per_edge == 4);
        CHECK(s.contact.mu_static == 0.2);
        CHECK(s.wire.shaft.mu_static == 0.3);  // [wire] wins over [contact]
        REQUIRE(s.holds.size() == 2);
        CHECK(s.holds[0].until == 2.5);
        CHECK(s.holds[1].axes == std::array<bool, 3>{false, true, true});
        CHECK(s.loads.at(0).until == 1.25);
        CHECK(s.holds[0].turn[1][1] == 3.1);
        REQUIRE(s.links.size() == 1);
        CHECK(s.links[0].at.kind == WirePoint::Kind::Distance);
        CHECK(s.contacts_every == 0);
    }

    // a solid round wire, by hand: r = 178 um, E = 60 GPa (reference/13_materials gives 4.70943e-05 for this wire's EI)
    TEST_CASE("analytic: a material gives the stiffness of a round solid wire")
    {
        WireSection s{.radius = 0.000178, .youngs = 60e9, .poisson = 0.3};
        set_stiffness_from_material(s);
        CHECK(s.bend_stiffness == test::about(4.7307e-5).epsilon(1e-4));
        CHECK(s.twist_stiffness == test::about(s.bend_stiffness / 1.3).epsilon(1e-12));                      // C/B = 1/(1 + nu)
        CHECK(s.stretch_stiffness == test::about(4 * s.bend_stiffness / (178e-6 * 178e-6)).epsilon(1e-12));  // EA = 4 B / r^2
    }

    TEST_CASE("property: a section inherits what it does not give, and its own stiffness wins over its material")
    {
        const Scene s = read(full);
        REQUIRE(s.wire.sections.size() == 2);
        const WireSection &shaft = s.wire.shaft, &tip = s.wire.sections[0].section, &thin = s.wire.sections[1].section;
        CHECK(tip.bend_stiffness == 1e-6);
        CHECK(tip.twist_stiffness == shaft.twist_stiffness);
        CHECK(tip.youngs == shaft.youngs);
        CHECK(tip.mu_static == 0.3);
        CHECK(tip.mu_sliding == 0.05);
        CHECK(tip.rest_curvature == Vec2(20, -3));
        // same material, thinner and of another Poisson's ratio: B ~ r^4, C/B = 1/(1 + nu)
        CHECK(thin.bend_stiffness == test::about(shaft.bend_stiffness * std::pow(150.0 / 178.0, 4)).epsilon(1e-12));
        CHECK(thin.twist_stiffness == test::about(thin.bend_stiffness / 1.2).epsilon(1e-12));
    }

    TEST_CASE("property: a scene written out reads back to the same bits")
    {
        check_round_trip(read(minimal));
        check_round_trip(read(full));
    }

    TEST_CASE("property: every placement and every generated vessel survives the round trip")
    {
        const std::string vessels[] = {
            "shape = \"tube\"\nradius_m = 0.01\nlength_m = 0.333333333333333314829616256247\naxis = [0, 0, 1]\n",
            "shape = \"plane\"\nsize_m = 1\nnormal = [0.1, 0, 1]\n", "shape = \"aortic-arch\"\n",
            "shape = \"arc\"\nradius_m = 0.01\nbend_radius_m = 0.1\nangle_deg = 180\n"};
        const std::string places[] = {"{ shape = \"ring\", twist_rad = 9.42 }", "{ shape = \"straight\", direction = [0, 0, 3] }",
                                      "{ shape = \"centreline\", from_m = 0.1 }",
                                      "{ shape = \"points\", points = [[0, 0, 0], [0.1, 0, 0], [0.1, 0.2, 0]] }",
                                      "{ shape = \"arc\", bend_radius_m = 0.05 }"};
        for (const auto& vessel : vessels)
            for (const auto& place : places) {
                CAPTURE(vessel);
                CAPTURE(place);
                check_round_trip(read(minimal + "place = " + place + "\n[vessel]\n" + vessel));
            }
    }

    TEST_CASE("property: an elastic wall is read, and survives the round trip")
    {
        const std::string tube = minimal + "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 0.2\n";
        const Scene plain = read(tube);
        CHECK_FALSE(plain.vessel.elastic);
        CHECK(plain.vessel.rims_held);
        // of a rigid wall nothing is written that only an elastic one has
        CHECK(write_scene(plain, ".").find("support_pa_m") == std::string::npos);
        const Scene s =
            read(tube, {"vessel.wall=elastic", "vessel.support_pa_m=3e5", "vessel.support_pa_s_m=0", "vessel.rims=free",
                        "vessel.relaxation_s=0.01", "vessel.pressure_pa=-13e3", "vessel.wall_edge_m=0.002"});
        CHECK(s.vessel.elastic);
        CHECK(s.vessel.support == 3e5);
        CHECK(s.vessel.support_damping == 0);
        CHECK(s.vessel.relaxation == 0.01);
        CHECK(s.vessel.pressure == -13e3);
        CHECK(s.vessel.wall_edge == 0.002);
        CHECK_FALSE(s.vessel.rims_held);
        check_round_trip(s);
        check_round_trip(read(tube, {"vessel.wall=elastic"}));
        check_round_trip(read(tube, {"vessel.rims=free"}));
    }

    TEST_CASE("property: any angle in degrees comes back to the same radians")
    {
        for (int i = 1; i <= 3600; ++i) {
            const Scene s = read(minimal, {"vessel.shape=arc", "vessel.radius_m=0.01", "vessel.bend_radius_m=0.1",
                                           "vessel.angle_deg=" + std::to_string(i * 0.1)});
            const Scene again = read_scene_text(write_scene(s, "."), "again.toml");
            REQUIRE(s.vessel.angle == again.vessel.angle);
        }
    }

    TEST_CASE("property: a fed wire round-trips with its keys, and a turn left out stays as it was")
    {
        const Scene s =
            read(minimal +
                 "[feed]\npoint = [0, 0, 0]\ndirection = [1, 0, 0.1]\nkeys = [{t_s = 0, advance_m = 0.01, turn_rad = 1}, "
                 "{t_s = 1.1, advance_m = 0.2}, {t_s = 2, advance_m = 0.3, turn_rad = 2}]\n");
        REQUIRE(s.feed.keys.size() == 3);
        CHECK(s.feed.keys[1].turn == 1);
        check_round_trip(s);
        check_round_trip(read(minimal + "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 1\n[feed]\ninlet = "
                                        "\"auto\"\nkeys = [{t_s = 0, advance_m = 0}]\n"));
    }

    TEST_CASE("property: mesh paths are re-based to where the scene is written")
    {
        const TemporaryFolder folder;
        std::filesystem::create_directories(folder.path() / "meshes");
        std::filesystem::create_directories(folder.path() / "scenes");
        std::filesystem::create_directories(folder.path() / "runs/one");
        std::ofstream(folder.path() / "meshes/a b.stl") << "solid\nendsolid\n";
        std::ofstream(folder.path() / "scenes/s.toml") << minimal << "[vessel]\nmesh = \"../meshes/a b.stl\"\nunits = \"cm\"\n";
        const Scene s = read_scene(folder.path() / "scenes/s.toml");
        const std::string text = write_scene(s, folder.path() / "runs/one");
        CHECK(text.find("mesh = \"../../meshes/a b.stl\"") != std::string::npos);
        const Scene again = read_scene_text(text, folder.path() / "runs/one/scene.toml");
        CHECK(again.vessel.mesh == s.vessel.mesh);
        CHECK(again.vessel.units == "cm");
    }

    TEST_CASE("property: --set changes numbers, words, lists and tables, and makes what is absent")
    {
        const Scene s = read(minimal, {"wire.nodes=33", "contact.detection = layer", "scene.gravity=[0, 0, 1]",
                                       "vessel.shape=tube", "vessel.radius_m=0.01", "vessel.length_m=0.2", "hold.0.position=true",
                                       "hold.0.at=tip", "wire.section.0.from_tip_m=[0, 0.1]", "wire.section.0.bend_nm2=1e-6",
                                       "scene.name=two words", "wire.place.shape=ring", "wire.nodes=34"});
        CHECK(s.wire.nodes == 34);
        CHECK(s.contact.detection == Detection::Layer);
        CHECK(s.gravity == Vec3(0, 0, 1));
        CHECK(s.vessel.shape == VesselShape::Tube);
        REQUIRE(s.holds.size() == 1);
        CHECK(s.holds[0].at.kind == WirePoint::Kind::Tip);
        REQUIRE(s.wire.sections.size() == 1);
        CHECK(s.wire.sections[0].section.bend_stiffness == 1e-6);
        CHECK(s.name == "two words");
        CHECK(s.wire.place.shape == PlaceShape::Ring);
        const Scene turned = read(full, {"hold.0.spin=false", "hold.0.turn=[[0, 0]]", "hold.0.spin=true", "link.0.anchor.1=0.7"});
        CHECK(turned.holds[0].turn.size() == 1);
        CHECK(turned.links[0].anchor == Vec3(0.1, 0.7, 0.1));
    }

    TEST_CASE("property: sliding friction above the static one raises it, and says so")
    {
        const Scene s = read(minimal, {"contact.mu_sliding=0.3"});
        CHECK(s.contact.mu_static == 0.3);
        CHECK(s.wire.shaft.mu_static == 0.3);
        REQUIRE(s.notes.size() == 1);
        CHECK(s.notes[0].first == "contact.mu_static");
        check_round_trip(s);
    }

    TEST_CASE("property: every scene that ships with the project reads, and round-trips")
    {
        const TemporaryFolder folder;
        std::ofstream(folder.path() / "any.stl") << "solid\nendsolid\n";  // patients' meshes are not part of the project
        const std::vector<std::string> any_mesh = {"vessel.mesh=" + (folder.path() / "any.stl").string()};
        int read_count = 0;
        const auto scenes = std::filesystem::path(SEL_SOURCE_DIR) / "assets/scenes";
        for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes)) {
            if (entry.path().extension() != ".toml") continue;
            CAPTURE(entry.path().string());
            const bool patient = entry.path().parent_path().filename() == "patients";
            check_round_trip(patient ? read_scene(entry.path(), any_mesh) : read_scene(entry.path()));
            ++read_count;
        }
        CHECK(read_count >= 3);
    }

    TEST_CASE("property: the contract's own example scenes read, and round-trip")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        int read_count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(*shared / "scenes")) {
            if (entry.path().extension() != ".toml") continue;
            CAPTURE(entry.path().string());
            check_round_trip(read_scene(entry.path()));
            ++read_count;
        }
        CHECK(read_count >= 6);
    }
}

}  // namespace seldinger::test::test_scene

// Models: their changes of a scene, `like`, and refusals of this build.

#include "models/model.h"
#include "support/scenes.h"

#include <doctest/doctest.h>

#include <algorithm>

namespace seldinger::test::test_model {

namespace {

const std::string tube_scene =
    scene_text(1) + wire_text(0.1, 1e-5, 1e-5, 11) + tube_text(0.005, 0.2, 1000) +
    "[feed]\ninlet = \"auto\"\n"
    "keys = [ {t_s = 0.0, advance_m = 0.0, turn_rad = 0.0}, {t_s = 1.0, advance_m = 0.05, turn_rad = 0.0} ]\n";

Model everything_else()
{
    return {.nodes = 0,
            .min_edge = 0.002,
            .max_edge = 0.02,
            .dt = 1.0 / 60,
            .scheme = Scheme::Linearised,
            .trapezoid = true,
            .tolerance = 1e-8,
            .detection = Detection::Nodes,
            .normal = NormalLaw::LankaraniNikravesh,
            .friction = FrictionLaw::Sign,
            .rolling = true,
            .elastic_wall = true,
            .wall_edge = 0.003};
}

}  // namespace

TEST_SUITE("models/model")
{
    TEST_CASE("property: a model does to a parsed scene what its --set texts do to the file")
    {
        const Scene scene = read_scene_text(tube_scene, "tube.toml");
        const Model model = everything_else();
        const std::vector<std::string> texts = set_texts(model, scene);
        Scene by_model = apply(model, scene);
        const Scene by_text = read_scene_text(tube_scene, "tube.toml", texts);
        by_model.wire_every = by_text.wire_every;  // how often frames are written follows from the step on reading
        by_model.contacts_every = by_text.contacts_every;
        CHECK(texts.size() == 14);  // thirteen choices; the trapezoid is two keys
        CHECK(write_scene(by_model, ".") == write_scene(by_text, "."));
        CHECK(write_scene(by_model, ".") != write_scene(scene, "."));
        CHECK(write_scene(apply(Model{}, scene), ".") == write_scene(scene, "."));
    }

    TEST_CASE("property: labels name what was chosen, and only that")
    {
        CHECK(label(Model{}) == "as the scene");
        Model model{.nodes = 101, .dt = 1.0 / 60, .scheme = Scheme::Linearised};
        CHECK(label(model) == "101 nodes, 16.67 ms, linearised");
        model.name = "mine";
        CHECK(label(model) == "mine");
    }

    TEST_CASE("property: a scene's own model laid over another of its versions gives the scene back")
    {
        const Scene scene = read_scene_text(tube_scene, "tube.toml");
        const Scene other = apply(everything_else(), scene);
        REQUIRE(write_scene(other, "") != write_scene(scene, ""));
        CHECK(write_scene(apply(model_of(scene), other), "") == write_scene(scene, ""));
        CHECK(write_scene(apply(model_of(other), scene), "") == write_scene(other, ""));
        Model adaptive{.nodes = 0, .min_edge = 3e-3, .spin = true};
        const Scene third = apply(adaptive, scene);
        CHECK(write_scene(apply(model_of(third), scene), "") == write_scene(third, ""));
    }

    TEST_CASE("property: what cannot be run is refused in one sentence, what can is listed")
    {
        const Scene scene = read_scene_text(tube_scene, "tube.toml");
        CHECK(why_not(everything_else(), scene).empty());
        Model elastic;
        elastic.elastic_wall = true;
        CHECK(why_not(elastic, scene).empty());
        Model wrong;
        wrong.dt = 5.0;
        CHECK(why_not(wrong, scene).find("scene.dt_s") == std::string::npos);  // no place of a text that nobody wrote
        CHECK(why_not(wrong, scene).find("expected at least one step") != std::string::npos);
        Model single;
        single.precision = Precision::Float32;
        CHECK(why_not(single, scene).empty());
        Model hard = single;
        hard.normal = NormalLaw::Barrier;
        CHECK(why_not(hard, scene).find("float32") != std::string::npos);
    }
}

}  // namespace seldinger::test::test_model

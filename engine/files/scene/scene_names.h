#pragma once
// The words of the scene file for every choice, in the contract's order: the first of each list is the default.
// One list serves reading, writing and error messages.

#include "scene/scene.h"

#include <array>
#include <span>
#include <string_view>
#include <type_traits>

namespace seldinger {

template <class Enum>
struct Choice {
    std::string_view word;
    Enum value;
};

inline constexpr Choice<Until> until_words[] = {{"time", Until::Time}, {"rest", Until::Rest}, {"reached", Until::Reached}};
inline constexpr Choice<bool> start_words[] = {{"placed", false}, {"settled", true}};
inline constexpr Choice<CurvatureMeasure> curvature_words[] = {{"angle", CurvatureMeasure::Angle},
                                                               {"tangent", CurvatureMeasure::Tangent}};
inline constexpr Choice<bool> rest_words[] = {{"straight", false}, {"placed", true}};
inline constexpr std::array<std::string_view, 3> axis_names = {"x", "y", "z"};
inline constexpr Choice<bool> feed_start_words[] = {{"straight", false}, {"centreline", true}};
inline constexpr Choice<bool> stretch_words[] = {{"none", false}, {"as-placed", true}};
inline constexpr Choice<CoaxialSpec::Model> coaxial_words[] = {{"merged", CoaxialSpec::Model::Merged},
                                                               {"separate", CoaxialSpec::Model::Separate}};
inline constexpr Choice<bool> wall_words[] = {{"rigid", false}, {"elastic", true}};
inline constexpr Choice<bool> rims_words[] = {{"held", true}, {"free", false}};
inline constexpr Choice<bool> branches_words[] = {{"inlet", false}, {"root", true}};
inline constexpr Choice<Scheme> scheme_words[] = {
    {"newton", Scheme::Newton}, {"linearised", Scheme::Linearised}, {"static", Scheme::Static}, {"explicit", Scheme::Explicit}};
inline constexpr Choice<Spins> spins_words[] = {{"auto", Spins::Auto}, {"kept", Spins::Kept}};
inline constexpr Choice<PlaceShape> place_words[] = {{"straight", PlaceShape::Straight},
                                                     {"arc", PlaceShape::Arc},
                                                     {"ring", PlaceShape::Ring},
                                                     {"points", PlaceShape::Points},
                                                     {"centreline", PlaceShape::Centreline}};
inline constexpr Choice<VesselShape> vessel_words[] = {
    {"tube", VesselShape::Tube}, {"arc", VesselShape::Arc}, {"plane", VesselShape::Plane}, {"aortic-arch", VesselShape::Arch}};
inline constexpr Choice<Detection> detection_words[] = {
    {"swept", Detection::Swept}, {"layer", Detection::Layer}, {"nodes", Detection::Nodes}, {"capsule", Detection::Swept}};
inline constexpr Choice<NormalLaw> normal_words[] = {{"hunt-crossley", NormalLaw::HuntCrossley},
                                                     {"lankarani-nikravesh", NormalLaw::LankaraniNikravesh},
                                                     {"augmented", NormalLaw::Augmented},
                                                     {"constraint", NormalLaw::Constraint},
                                                     {"impulse", NormalLaw::Impulse},
                                                     {"barrier", NormalLaw::Barrier}};
inline constexpr Choice<FrictionLaw> friction_words[] = {{"stick-slip", FrictionLaw::StickSlip},
                                                         {"smooth", FrictionLaw::Smooth},
                                                         {"sign", FrictionLaw::Sign},
                                                         {"none", FrictionLaw::None}};
inline constexpr Choice<Precision> precision_words[] = {{"float64", Precision::Float64}, {"float32", Precision::Float32}};
inline constexpr Choice<BodyShape> body_words[] = {{"ellipsoid", BodyShape::Ellipsoid}, {"none", BodyShape::None}};
inline constexpr std::string_view unit_words[] = {"mm", "m", "cm", "um", "in"};
inline constexpr std::string_view space_words[] = {"LPS", "RAS"};

/// The word of a value.
template <class Enum, std::size_t N>
[[nodiscard]] std::string_view word_of(const Choice<Enum> (&words)[N], Enum value)
{
    for (const auto& choice : words)
        if (choice.value == value) return choice.word;
    return words[0].word;
}

}  // namespace seldinger

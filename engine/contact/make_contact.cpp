// Chooses the detection method of a world by name.

#include "contact/capsule.h"
#include "contact/layer.h"
#include "core/error.h"

#include <algorithm>
#include <limits>

namespace seldinger {

namespace {

// Half of the lumen is wider than this. The effective radius of (D6b) needs one number for the law to be a function of depth
// alone; a quarter more or less of R changes the stiffness of a 0.035 inch wire in a 10 mm lumen by half a percent.
double typical_lumen_radius(const WorldSetup& setup)
{
    std::vector<double> radius = setup.centreline.radius;
    if (radius.empty()) return std::numeric_limits<double>::infinity();
    std::nth_element(radius.begin(), radius.begin() + radius.size() / 2, radius.end());
    return radius[radius.size() / 2];
}

}  // namespace

std::unique_ptr<ContactMethod> make_contact(device::Context& context, const WorldSetup& setup, RodArrays& rods)
{
    const WallTree tree = build_wall_tree(setup.mesh);
    const double lumen_radius = typical_lumen_radius(setup);
    const ContactSpec& contact = setup.wires[0].contact;
    if (is_hard(contact.normal) && contact.detection == Detection::Layer)
        throw Error(ExitCode::BadScene,
                    "contact.normal: this law lives on material samples, which detection = \"layer\" has not");
    if (context.float32() && (is_hard(contact.normal) || contact.detection == Detection::Layer))
        throw Error(ExitCode::BadScene,
                    "contact.precision: float32 is there for detection \"swept\", \"capsule\" and \"nodes\" with normal "
                    "\"hunt-crossley\" and \"lankarani-nikravesh\"; take it out");
    switch (contact.detection) {
        case Detection::Swept:
        case Detection::Capsule:
        case Detection::Nodes:
            return std::make_unique<CapsuleContact>(context, setup, rods, tree, lumen_radius);
        case Detection::Layer:
            return std::make_unique<LayerContact>(context, setup, rods, tree, lumen_radius);
    }
    throw Error(ExitCode::BadScene, "contact.detection: unknown method");
}

}  // namespace seldinger

// Chooses the detection method of a world by name.
#include "contact/capsule.h"
#include "contact/layer.h"
#include "core/error.h"
#include "vessel/shared_tree.h"

namespace seldinger {

std::unique_ptr<ContactMethod> make_contact(device::Context& context, const ContactSetup& setup, RodArrays& rods)
{
    const std::shared_ptr<const WallTree> shared = shared_wall_tree(setup.wall.mesh);
    shrink_kept_wall_tree();  // the device has it from here on
    const WallTree& tree = *shared;
    const ContactSpec& contact = setup.method();
    if (is_nonpenetrating(contact.normal) && contact.detection == Detection::Layer)
        throw Error(ErrorKind::BadScene,
                    "contact.normal: this law needs material samples, which detection = \"layer\" does not have");
    if (context.float32() && (is_nonpenetrating(contact.normal) || contact.detection == Detection::Layer))
        throw Error(ErrorKind::BadScene,
                    "contact.precision: float32 is supported for detection \"swept\" and \"nodes\" with normal "
                    "\"hunt-crossley\" and \"lankarani-nikravesh\"; take it out");
    switch (contact.detection) {
        case Detection::Swept:
        case Detection::Nodes: return std::make_unique<CapsuleContact>(context, setup, rods, tree);
        case Detection::Layer: return std::make_unique<LayerContact>(context, setup, rods, tree);
    }
    throw Error(ErrorKind::BadScene, "contact.detection: unknown method");
}

}  // namespace seldinger

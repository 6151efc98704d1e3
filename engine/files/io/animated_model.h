#pragma once
// A vessel and moving tubes for other programs: glTF (Blender, browsers) and USD (Omniverse, Houdini).

#include "math/vec3.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// A tube through the same number of stations at every time.
struct AnimatedTube {
    std::string name;
    std::vector<double> radius;  // [M] stations, tip to hub [m]
    struct Pose {
        Vec3 place = Vec3::Zero();                   // [m]
        std::array<double, 4> turn = {0, 0, 0,
                                      1};  // unit quaternion x, y, z, w: takes z to the tube's axis; near its neighbours in time
    };
    std::vector<std::vector<Pose>> poses;  // [F][M]
};

struct AnimatedModel {
    std::vector<double> times;   // [F] increasing [s]
    std::vector<Vec3> vertices;  // of the vessel; normals into the lumen. Empty: none
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<AnimatedTube> tubes;
    std::vector<std::vector<Vec3>> contacts;          // [F] places [m]
    std::vector<std::vector<double>> contact_forces;  // [F] [N]
    // What the files' axes are in the model's: x, y, z. glTF has y up and looks at things from +z, USD here z up.
    Vec3 left = {1, 0, 0}, back = {0, 1, 0}, head = {0, 0, 1};
};

/// Binary glTF 2.0 (.glb): the vessel as a translucent mesh, each tube as a mesh with one joint for each station, one animation.
/// x is the patient's left, y the head, z the front. The file appears when it is complete. @throws Error BadFile
void write_gltf(const std::filesystem::path& path, const AnimatedModel& model);

/// USD as text (.usda): mesh, curves and contact points with time samples in seconds. x is the patient's left, y the back, z the
/// head; metres. The file appears when it is complete. @throws Error BadFile
void write_usd(const std::filesystem::path& path, const AnimatedModel& model);

}  // namespace seldinger

#pragma once
// Contents of the web server: the page's files, the scene and its wall for the browser, and frames of the newest step.

#include "scene/scene.h"
#include "session/score.h"
#include "session/snapshot.h"

#include <map>
#include <string>
#include <string_view>

namespace seldinger {

struct WebFile {
    std::string type, body;
};

/// Everything that can be asked for, by its path; read once. @throws Error BadFile: the page or three.js is not there
[[nodiscard]] std::map<std::string, WebFile, std::less<>> web_files(const Scene& scene, const WorldSetup& setup,
                                                                    const TaskTarget& target, const Branches& branches,
                                                                    double rate);

/// three.js as Debian's libjs-three has it. @throws Error BadFile: not installed
[[nodiscard]] std::string three_js();

/// The wall as a browser takes it: u32 vertices, u32 triangles, f32 x y z ..., u32 a b c ..., little-endian.
[[nodiscard]] std::string mesh_bytes(const WallMesh& mesh);

/// One frame: u32 length of the JSON, padded to four, the JSON, then per instrument u32 nodes and f32 x y z force of each.
void put_frame(const ViewFrame& frame, double wall_clock, int clients, std::string& into);

}  // namespace seldinger

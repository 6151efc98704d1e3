#pragma once
// Draws a vessel with the wire inside it, without a screen. For files see render.h; this is the part that needs none.
//
// How the wire stays visible: of each tube of the vessel only the far wall is opaque (its lumen side faces the eye); the near
// wall is glass with a rim. What another tube's far wall still hides is drawn through it as a ghost.

#include "view/camera.h"
#include "view/view_from.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

struct WireLine {
    std::vector<Vec3> nodes;     // tip to hub [m]
    std::vector<double> radius;  // [m], one per node
    std::string name;            // of an instrument among several
    std::vector<double> force;   // of contact, one per node [N]; empty: not recorded
    // at the hub: along the wire, + pushes [N]; about it, + as it is turned [N m]; NaN: not recorded
    double hand_force = std::numeric_limits<double>::quiet_NaN(), hand_torque = std::numeric_limits<double>::quiet_NaN();
};

/// One contact of the picture.
struct ContactMark {
    Vec3 point = Vec3::Zero();   // on the wall [m]
    Vec3 normal = Vec3::Zero();  // unit, into the lumen; zero: no pin
    double force = 0;            // [N] >= 0
    double per_length = std::numeric_limits<double>::quiet_NaN();  // load on the wire there [N/m]; NaN: not known
    int place = 0;                                                 // which of the places in contact it belongs to
    Vec3 friction = Vec3::Zero();     // on `instrument` [N]
    int instrument = 0, other = -1;   // indices into WireFrame::wires: what lies on what, -1: the wall (`other`), not recorded
};

/// A wall where it has moved to.
struct MovedWall {
    std::vector<Vec3> vertices;  // of set_wall's mesh, in its order [m]; empty: it is where that has it, and not coloured
    std::vector<double> value;   // there, [m] or [Pa]
};

/// How values become colours; the same for every picture that is to be compared.
struct WallScale {
    WallQuantity quantity = WallQuantity::Displacement;
    double top = 0;       // of the scale [m] or [Pa]; 0: no moved wall is drawn
    bool beyond = false;  // some wall of the run is beyond the top, and the legend says so
};

/// What changes from picture to picture. NaN: not known, and left out of the legend.
struct WireFrame {
    std::vector<WireLine> wires;
    std::vector<ContactMark> contacts;
    bool contacts_known = true;  // false: none were recorded at this time
    std::int64_t step = -1;      // -1: not known
    MovedWall wall;                                                // drawn when there is a scale for it (set_wall_scale)
    double time = std::numeric_limits<double>::quiet_NaN();        // [s]
    double inserted = std::numeric_limits<double>::quiet_NaN();    // [m]
    double hand_force = std::numeric_limits<double>::quiet_NaN();  // [N]
    double per_length = std::numeric_limits<double>::quiet_NaN();  // largest load on the wire; else the contacts' largest [N/m]
};

/// Where a tip is to go.
struct TargetMark {
    Vec3 at = Vec3::Zero();  // [m]
    double radius = 0;       // [m]
    std::string name;
};

/// Constant data.
struct Look {
    bool legend = true;       // text, scale bars, force scale; needs a font (canvas.h); left out below about 290 rows
    bool inset = true;        // magnified view of the tip where the whole view shows the wire under 4 pixels wide
    double force_scale = 0;   // force at the top of the scale [N]; 0: a round number above the strongest contact drawn
    // contact force per length at the top of a scale that colours the wire [N/m]; 0: it has its own colour
    double load_scale = 0;
    std::uint32_t background_top = 0xfdfdfd, background_bottom = 0xdfe4ea;
    bool ruler = true;             // scale bar and tip mark
    bool cube = false;             // which way the patient lies
    Vec3 head = {0, 0, 1}, back = {0, 1, 0};  // of the patient, for the cube
    std::optional<TargetMark> target;  // ringed, and named in the legend
    double least_pixels = 3;  // the wire is drawn at least this wide, and the legend says so
};

struct TubeStation;

class Renderer {
public:
    /// @throws Error NoDevice (no off-screen OpenGL), BadScene (a size no picture can have), BadFile (no font)
    Renderer(int width, int height, const Look& look = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// @param mesh  normals into the lumen; copied. Empty: no vessel
    void set_wall(const WallMesh& mesh);
    void set_camera(const Camera& camera);
    /// Aims the camera so that the vessel and these points are in view; draw() does so with the wire if nobody has.
    void aim(const std::vector<Vec3>& points);
    [[nodiscard]] const Camera& camera() const;
    /// Where in the picture the camera's view lies: all of it without a legend.
    [[nodiscard]] const Viewport& main_view() const;
    /// The wires' lines with the radii that they are drawn with, from the camera as it stands.
    [[nodiscard]] std::vector<std::vector<TubeStation>> drawn_lines(const WireFrame& frame) const;
    void set_force_scale(double newton);
    /// Colours of the ground from now on, sRGB.
    void set_background(std::uint32_t top, std::uint32_t bottom);
    /// From now on moved walls are drawn, coloured, over a faint outline of where they were; contacts, whose colours mean
    /// something else, are not.
    void set_wall_scale(const WallScale& scale);

    void draw(const WireFrame& frame);
    /// Lets another thread call, or destroy it; the thread that drew last has to.
    void release();
    /// The last picture: rows from the top, 3 bytes (sRGB) per pixel.
    [[nodiscard]] const std::vector<std::uint8_t>& pixels() const;
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// The OpenGL device that draws.
    [[nodiscard]] std::string device_name() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace seldinger

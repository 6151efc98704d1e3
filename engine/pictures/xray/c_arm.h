#pragma once
// The C-arm: places of source and detector, and the projection of a point.
//
// Patient axes (L, P, H) = left, back, head, origin at the isocentre. p primary angle (LAO +), s secondary (CRA +), both of the
// detector's position [DICOM PS3.3 C.8.7.5.1.2]:
//   detector direction  d = (sin p cos s, -cos p cos s, sin s),  right = (cos p, sin p, 0),  up = d x right
//   source at -SOD d, detector's plane at (SID - SOD) d
//   column = (columns - 1)/2 + SID (x.right) / ((SOD + x.d) pixel),  row = (rows - 1)/2 - SID (x.up) / ((SOD + x.d) pixel)

#include "math/vec3.h"

#include <string>

namespace seldinger {

struct CArm {
    double primary = 0, secondary = 0;                // [rad]
    double sid = 1.2, sod = 0.8;                      // [m]
    double field = 0.3;                               // width of the detector [m]
    int columns = 1024, rows = 1024;                  // pixels are square
    Vec3 isocentre = Vec3::Zero();                    // scene axes [m]
    Vec3 head = Vec3::UnitZ(), back = Vec3::UnitY();  // the patient in scene axes, unit, at right angles

    [[nodiscard]] double pixel() const { return field / columns; }
};

/// A C-arm in place: everything in scene axes.
struct CArmView {
    Vec3 source, direction, right, up;  // direction: from source to detector
    double sid = 0, sod = 0, pixel = 0;
    int columns = 0, rows = 0;

    explicit CArmView(const CArm& arm);
    /// Offset of a pixel's place from the central ray per metre along it: a ray is source + t (direction + u right + v up),
    /// t the depth along the central ray.
    [[nodiscard]] double u(double column) const { return (column - 0.5 * (columns - 1)) * pixel / sid; }
    [[nodiscard]] double v(double row) const { return (0.5 * (rows - 1) - row) * pixel / sid; }
};

struct CArmPoint {
    double column = 0, row = 0, magnification = 0;
    double depth = 0;  // along the central ray from the source [m]; nothing else is meant where it is <= 0
};

[[nodiscard]] CArmPoint project(const CArmView& view, const Vec3& point);

/// "LAO 30, CRA 15", "RAO 20 CAU 10", "CRA 15", "30, 15" (primary, secondary [deg]) into the two angles.
/// @throws Error BadScene
void set_angles(CArm& arm, const std::string& text);

/// "LAO 30, CRA 15" of the angles.
[[nodiscard]] std::string angle_words(const CArm& arm);

/// @throws Error BadScene: SOD not below SID, a size that no picture has
void check(const CArm& arm);

}  // namespace seldinger

#pragma once
// The project's own vessel: a thoracic aorta from the diaphragm over the arch to the root, with the three supra-aortic
// branches. Every dimension is a published mean, so it describes no patient and may be published anywhere.
//
// [Hager 2002]     Hager et al., J Thorac Cardiovasc Surg 123(6):1060-1066, doi:10.1067/mtc.2002.122310: diameters of the aorta
//                  at seven levels, helical CT, 70 adults.
// [Boufi 2017]     "The apex of the aortic arch backshifts with aging", PMID 27921138: the arch in 344 CT scans; men: length
//                  146.2 mm, height 49.3 mm, width 83.6 mm. A half ellipse of that height and width is 143 mm long.
// [Girsowicz 2017] "Anatomical study of healthy aortic arches", Ann Vasc Surg: distances between the branches, 61 CTs.
// [Yan 2017]       Chinese CTA study of 217 normal arches (in Chinese; Yan Yu et al.): diameters of the branches at their
// origins, and
//                  the arch's plane at 50.3 degrees to the sagittal plane.
// Lengths of the straight parts, branch directions and fillets are ours.

#include "shapes/shapes.h"

namespace seldinger {

/// Lengths in metres, angles in radians.
struct ArchSpec {
    Vec3 origin = Vec3::Zero();     // centre of the descending aorta's opening, at the diaphragm
    Vec3 superior = Vec3::UnitX();  // towards the head; with gravity along -z the patient lies supine
    Vec3 anterior = Vec3::UnitZ();
    int triangles = 30000;  // about, within 5 %

    // aortic diameters, upstream from the diaphragm [Hager 2002]
    double diameter_diaphragm = 0.0243, diameter_isthmus = 0.0247, diameter_distal_arch = 0.0261, diameter_proximal_arch = 0.0277,
           diameter_before_innominate = 0.0294, diameter_ascending = 0.0309, diameter_root = 0.0298;
    double arch_height = 0.0493, arch_width = 0.0836;        // of its axis [Boufi 2017]
    double plane_angle = 0.8779;                             // 50.3 degrees from the sagittal plane [Yan 2017]
    double descending_length = 0.16;                         // opening to the arch's foot
    double ascending_length = 0.045, ascending_tilt = 0.35;  // arch's foot to the root; inwards from the vertical

    // brachiocephalic, left common carotid, left subclavian [Yan 2017]; distances of their axes along the arch [Girsowicz 2017]
    double diameter_innominate = 0.0125, diameter_carotid = 0.00828, diameter_subclavian = 0.01041;
    double innominate_to_carotid = 0.0218, carotid_to_subclavian = 0.0143;
    double branch_length = 0.06;  // from the aorta's axis
    double fillet = 0.004;        // width of the blend where a branch leaves
};

/// Smooth, watertight but for five flat openings, genus 0, normals into the lumen; the same bits every time. Centreline: the
/// axes that the wall was made from, root at the descending opening. @throws Error BadScene for impossible sizes
[[nodiscard]] GeneratedVessel make_aortic_arch(const ArchSpec& spec);

/// origin, axis (superior), normal (anterior) and triangles of a scene's vessel; all else published means.
[[nodiscard]] GeneratedVessel make_aortic_arch(const VesselSpec& spec);

}  // namespace seldinger

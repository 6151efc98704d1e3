// Keys of [vessel], [[wall_load]], [task], [carm] and [contrast].
#include "scene/scene_keys.h"

#include <tuple>

namespace seldinger::keys {

std::vector<Key> vessel(VesselSpec& v)
{
    const bool mesh = v.shape == VesselShape::Mesh, tube = v.shape == VesselShape::Tube, arc = v.shape == VesselShape::Arc,
               plane = v.shape == VesselShape::Plane, arch = v.shape == VesselShape::Arch;  // its branches need some triangles
    const bool given = mesh && !v.centreline.empty();
    // a rigid wall says nothing of what only an elastic one has, unless it was given
    const auto of_elastic = [](const VesselSpec& s) {
        return std::tuple(s.support, s.support_damping, s.relaxation, s.pressure, s.wall_edge, s.rims_held);
    };
    const Use elastic = quiet_if(!v.elastic && of_elastic(v) == of_elastic(VesselSpec()));
    return {
        {"mesh", "", &v.mesh,
         "STL, OBJ, PLY, VTP or legacy VTK file, or a label map (NIfTI, NRRD, MetaImage), relative to the scene file's folder",
         "*needed* without `shape`", only_if(mesh)},
        {"label", "",
         keys::Count{&v.label, 1, 2'000'000'000, {}, "a label's number, or its name in quotes, as \"aorta\"", &v.label_name},
         "which label of a map is the vessel: its number, or its name in quotes", "the only one",
         mesh ? quiet_if(v.label_text().empty()) : Use::Unused},
        {"units", "", words(v.units, unit_words), "unit of the mesh", "what the file's header says, else `\"mm\"`", only_if(mesh)},
        {"shape", "", words(v.shape, vessel_words),
         "a generated wall with an exact centreline, open at both ends", "*needed* without `mesh`", only_if(!mesh)},
        {"radius_m", "m", number(v.radius, positive), "radius of the lumen", needed, only_if(tube || arc)},
        {"length_m", "m", number(v.length, positive), "length of the tube", needed, only_if(tube)},
        {"bend_radius_m", "m", number(v.bend_radius, positive), "bend radius of the arc's axis, above `radius_m`", needed, only_if(arc)},
        {"angle_deg", "degrees", degrees(v.angle, {0, 360, true, false, "an angle above 0, at most 360"}), "angle of the arc", needed, only_if(arc)},
        {"lead_in_m", "m", number(v.lead_in, not_negative), "straight piece before the arc", {}, only_if(arc)},
        {"lead_out_m", "m", number(v.lead_out, not_negative), "straight piece after the arc", {}, only_if(arc)},
        {"size_m", "m", number(v.size, positive), "side of the square", needed, only_if(plane)},
        {"axis", "", direction(v.axis), "direction of the axis at its start; of an aortic arch, towards the head", {}, only_if(!mesh && !plane)},
        {"origin", "m", vector(v.origin), "start of the axis; centre of a plane", {}, only_if(!mesh)},
        {"normal", "", direction(v.normal),
         "direction towards which an arc bends; upper side of a plane; front of an aortic arch. Not parallel to `axis`",
         "z; x where the axis is along z", only_if(!mesh)},
        {"triangles", "", count(v.triangles, arch ? 2'000 : 2, arch ? 1'000'000 : 20'000'000),
         "approximate number of triangles; 2,000 to 1,000,000 for `aortic-arch`", "20000; 30000 for `aortic-arch`", only_if(!mesh)},
        {"close_holes", "", &v.close_holes, "whether small holes of the mesh are closed; `false`: each is an opening", {}, quiet_if(!mesh || v.close_holes)},
        {"wall", "", words(v.elastic, wall_words), "`elastic`: [elastic wall](#elastic-wall)"},
        {"youngs_pa", "Pa", number(v.youngs, positive),
         "Young's modulus of the wall. It also sets the stiffness of contact ([normal laws](#normal-laws)). For a rigid wall the default is "
         "a fortieth of the hardest instrument's 4 B/(π r⁴), to a power of ten between 1e6 and 1e9: 1e8 or 1e9 for guidewires "
         "([overlap](readings.md#outside-the-wall-and-out-of-openings))", "rigid: by the instrument; elastic: `1e6`"},
        {"poisson", "", number(v.poisson, {0, 0.5, false, true, "a Poisson's ratio from 0 to below 0.5"}), "Poisson's ratio of the wall"},
        {"thickness_m", "m", number(v.thickness, positive), "thickness of the wall; for an elastic wall, at most the median lumen radius"},
        {"support_pa_m", "Pa/m", number(v.support, not_negative),
         "stiffness of the tissue around an elastic wall, per area; above 0 if no rim is held", {}, elastic},
        {"support_pa_s_m", "Pa s/m", number(v.support_damping, not_negative), "damping of that tissue, per area", {}, elastic},
        {"relaxation_s", "s", number(v.relaxation, not_negative),
         "relaxation time of the wall's own stress: the viscous part is this times the rate of the elastic part", {}, elastic},
        {"pressure_pa", "Pa", number(v.pressure, any_number), "mean internal pressure in the given shape", {}, elastic},
        {"wall_edge_m", "m", number(v.wall_edge, not_negative),
         "edge length of the shell's control mesh; 0: chosen by the program", {}, quiet_if(v.wall_edge == 0)},
        {"rims", "", words(v.rims_held, rims_words), "whether the rims of openings are held in position", {}, elastic},
        {"centreline", "", &v.centreline,
         "polylines with the lumen's radius at each point, .vtp or legacy .vtk ([given centrelines](#given-centrelines))", "found from the mesh"},
        {"centreline_units", "", words(v.centreline_units, unit_words), "unit of `centreline`", "what its header says, else `units`",
         given ? quiet_if(v.centreline_units.empty()) : Use::Unused},
        {"centreline_space", "", words(v.centreline_space, space_words),
         "axes of `centreline`: x to the patient's left and y to the back (`LPS`), or right and front (`RAS`)",
         "what its header says, else the mesh's",
         given ? quiet_if(v.centreline_space.empty()) : Use::Unused},
        {"branches_from", "", words(v.branches_from_root, branches_words),
         "where branches count from: the inlet in use, or the root of the centreline, as up to version 0.2", {},
         quiet_if(!v.branches_from_root)},
    };
}

std::vector<Key> wall_load(WallLoad& l)
{
    return {
        {"pressure_pa", "Pa", number(l.pressure, any_number), "pressure on the whole wall, outward"},
        {"at", "m", vector(l.at),
         "`force_n` acts on the point of the wall nearest to this one; only with `force_n`", "*needed* with `force_n`", quiet_if(l.force.isZero())},
        {"force_n", "N", vector(l.force), "force", none, quiet_if(l.force.isZero())},
    };
}

std::vector<Key> task(TaskSpec& t)
{
    return {
        {"text", "", &t.text, "text beside the picture", none},
        {"wall_force_n", "N", number(t.wall_force, positive),
         "limit of the sum of all normal contact forces; time above it is counted", none, quiet_if(t.wall_force == 0)},
        {"patch_force_n", "N", number(t.patch_force, positive),
         "limit of the largest [force on a patch](readings.md#along-the-wire) of the wall, a measure of possible injury; time above the "
         "limit is counted", none, quiet_if(t.patch_force == 0)},
        {"time_s", "s", number(t.time, positive), "time limit for reaching the target, from the first push or turn", none, quiet_if(t.time == 0)},
        {"fluoroscopy_s", "s", number(t.fluoroscopy, positive),
         "limit of the time with the fluoroscopy pedal down", none, quiet_if(t.fluoroscopy == 0)},
        {"target", "", Tables{{target(t)}, false},
         "[`task.target`](#tasktarget), which the tip has to reach; without it there is no target",
         none, quiet_if(t.target == TaskSpec::Target::None)},
    };
}

std::vector<Key> target(TaskSpec& t)
{
    const bool branch = t.target == TaskSpec::Target::Branch;
    return {
        {"name", "", &t.target_name, "what answers call the target; without it `branch 1` or `the point`", none},
        {"point", "m", vector(t.point), "the tip comes within `radius_m` of it", "*needed* without `branch`", only_if(!branch)},
        {"radius_m", "m", number(t.radius, positive), "radius about `point`", {}, only_if(!branch)},
        {"branch", "",
         keys::Count{&t.branch, 1, 1000, {}, "a whole number from 1 to 1000; or a branch's path or name in quotes, as \"2.1\"", &t.branch_path},
         "number of the branch, in the order in which branches leave on the path from the inlet in use; the last is the end of the trunk. Or its "
         "path in quotes, as `\"2.1\"`, which vessels between forks have, too; or its name in the centreline's file. "
         "`seldinger run` prints the branch of its tip",
         "*needed* without `point`", only_if(branch)},
        {"beyond_m", "m", number(t.beyond, not_negative),
         "distance of the tip behind the mouth of the branch, along its axis, as `branch_depth_m` of the results. The mouth lies where the "
         "branch has left the ball of the lumen about its fork", "`0.01` for `branch`", only_if(branch)},
    };
}

std::vector<Key> carm(SceneCArm& c)
{
    constexpr Range reach{0, 10, true, false, "a distance above 0, at most 10 m"};
    return {
        {"isocentre", "m", vector(c.isocentre), "centre of rotation of the arm", "the middle of the vessel's box", quiet_if(c.isocentre_auto)},
        {"head", "", direction(c.head), "direction of the patient's head, in scene axes"},
        {"back", "", direction(c.back),
         "direction of the patient's back, at right angles to `head` ([axes](axes.md))",
         "`[0.0, 1.0, 0.0]`; `[0.0, -1.0, 0.0]` for a mesh that says `SPACE=RAS`"},
        {"sid_m", "m", number(c.sid, reach), "source to detector"},
        {"sod_m", "m", number(c.sod, reach), "source to isocentre, below `sid_m`"},
        {"field_m", "m", number(c.field, {0, 2, true, false, "a detector's width above 0, at most 2 m"}), "width of the detector"},
        {"kvp", "kV", number(c.kvp, {40, 150, false, false, "a tube voltage from 40 to 150 kV"}), "tube voltage"},
        {"photons", "", number(c.photons, {1, 1e12, false, false, "photons per pixel from 1 to 1e12"}),
         "photons per pixel in the open beam; sets the quantum noise"},
        {"blur_m", "m", number(c.blur, {0, 0.01, false, false, "a length from 0 to 0.01 m"}), "standard deviation of a point on the detector"},
        {"body", "", words(c.body, body_words), "soft tissue around the vessel"},
        {"body_m", "m", vector(c.body_axes, positive), "half axes to the left, back and head; enlarged in proportion if the vessel lies outside"},
        {"bone_units", "", words(c.bone_units, unit_words), "unit of that mesh"},
        {"bone", "", &c.bone, "mesh of a bone", none},
        {"keys", "", list_of(c.keys, carm_key), "[`carm.keys`](#carmkeys)", "LAO 0, CRA 0"},
    };
}

std::vector<Key> carm_key(CArmKey& k)
{
    return {
        {"t_s", "s", number(k.t, not_negative), "time, increasing from key to key", needed},
        {"lao_deg", "°", number(k.lao_deg, {-180, 180, false, false, "degrees from -180 (RAO) to 180 (LAO)"}),
         "angle towards the patient's left; RAO negative", "0, or as in the last key"},
        {"cra_deg", "°", number(k.cra_deg, {-90, 90, false, false, "degrees from -90 (CAU) to 90 (CRA)"}),
         "angle towards the head; CAU negative", "0, or as in the last key"},
    };
}

std::vector<Key> contrast(SceneContrast& c)
{
    return {
        {"at", "m", vector(c.at), "point of injection", "the centreline's root", quiet_if(c.at_auto)},
        {"inflow", "m", vector(c.inflow),
         "where blood flows in; contrast reaches only vessels downstream of the injection", "the point of injection", quiet_if(c.inflow_auto)},
        {"speed_m_s", "m/s", number(c.speed, {0, 10, true, false, "a speed above 0, at most 10 m/s"}), "speed of the blood at the injection"},
        {"spread", "", number(c.spread, {0, 1, false, false, "a number from 0 to 1"}), "standard deviation of the arrival time over the travel time"},
        {"keys", "", list_of(c.keys, contrast_key), "[`contrast.keys`](#contrastkeys)", needed},
    };
}

std::vector<Key> contrast_key(ContrastKey& k)
{
    return {
        {"t_s", "s", number(k.t, not_negative), "time, increasing from key to key", needed},
        {"iodine_mg_ml", "mg/ml", number(k.iodine, {0, 500, false, false, "milligrams of iodine per millilitre from 0 to 500"}),
         "iodine in the blood at the injection; linear between keys, constant before and after", "0, or as in the last key"},
    };
}

}  // namespace seldinger::keys

// Reads [task]: where the tip is to go, and within which limits.
#include "scene/scene_read.h"

namespace seldinger {

namespace {

void read_target(const toml::table& table, TaskSpec& task)
{
    const TableReader t(table, "task.target", {"name", "point", "radius_m", "branch", "beyond_m"});
    t.text("name", task.target_name);
    if (t.has("branch")) {
        task.target = TaskSpec::Target::Branch;
        t.count("branch", task.branch, 1, 1000);
        for (const auto key : {"point", "radius_m"}) t.refuse(key, "is of a point, and the target is a branch; take one of the two out");
    } else {
        task.target = TaskSpec::Target::Point;
        t.need("point", "[x, y, z], or branch = 1, 2, ...");
        t.refuse("beyond_m", "is of a branch, and the target is a point; take one of the two out");
    }
    t.vector("point", task.point);
    t.number("radius_m", task.radius, positive);
    t.number("beyond_m", task.beyond, not_negative);
}

}  // namespace

void read_task_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "task", {"text", "target", "wall_force_n", "patch_force_n", "time_s", "fluoroscopy_s"});
    TaskSpec& task = scene.task;
    task.on = true;
    t.text("text", task.text);
    t.number("wall_force_n", task.wall_force, positive);
    t.number("patch_force_n", task.patch_force, positive);
    t.number("time_s", task.time, positive);
    t.number("fluoroscopy_s", task.fluoroscopy, positive);
    const toml::node* target = t.node("target");
    if (!target) return;
    if (!target->is_table()) t.fail("target", "expected { point = [x, y, z], radius_m = 0.005 } or { branch = 1, beyond_m = 0.01 }");
    read_target(*target->as_table(), task);
    if (task.target == TaskSpec::Target::Branch && scene.vessel.shape == VesselShape::None)
        t.fail("target", "a branch is of a vessel, and the scene has none; give a point");
}

}  // namespace seldinger

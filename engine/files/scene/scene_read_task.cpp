// Reads [task]: where the tip is to go, and within which limits.
#include "scene/scene_read.h"

namespace seldinger {
namespace {

void read_target(const toml::table& table, TaskSpec& task)
{
    task.target = table.contains("branch") ? TaskSpec::Target::Branch : TaskSpec::Target::Point;
    const bool branch = task.target == TaskSpec::Target::Branch;
    const TableReader t(table, "task.target", keys::target(task));
    t.refuse_unused(keys::target(task), branch ? "is of a point, and the target is a branch; take one of the two out"
                                               : "is of a branch, and the target is a point; take one of the two out");
    if (!branch) t.need("point", "[x, y, z], or branch = 1, 2, ...");
    t.read(keys::target(task));
}

}  // namespace

void read_task_table(const toml::table& table, Scene& scene)
{
    TaskSpec& task = scene.task;
    task.on = true;
    const TableReader t(table, "task", keys::task(task));
    t.read(keys::task(task));
    const toml::node* target = t.node("target");
    if (!target) return;
    if (!target->is_table())
        t.fail("target", "expected { point = [x, y, z], radius_m = 0.005 } or { branch = 1, beyond_m = 0.01 }");
    read_target(*target->as_table(), task);
    if (task.target == TaskSpec::Target::Branch && scene.vessel.shape == VesselShape::None)
        t.fail("target", "a branch is of a vessel, and the scene has none; give a point");
}

}  // namespace seldinger

// Which of two wires, one softer than the other, gets round the arch with less force on the wall: a batch; its better run alone.

#include <seldinger/batch/run_batch.h>
#include <seldinger/engine.h>

#include <cstdio>
#include <string>
#include <vector>

using namespace seldinger;

int main()
{
    try {
        const std::vector<std::string> overrides = {"scene.dt_s=0.002",
                                                    "task.target={name = \"the ascending aorta\", branch = 4}"};
        const std::string sweep = "[vary]\n\"wire.bend_scale\" = [0.7, 1.0]\n";
        const BatchResult batch = run_batch("aortic-arch", sweep, overrides);
        for (const BatchRun& run : batch.runs)
            std::printf("%s: %s, %.1f mN, state %s\n", run.overrides.front().c_str(), run.status.c_str(),
                        1e3 * run.numbers.at("until_patch_force_max_n"), run.state_hash.c_str());
        std::printf("%s\n", batch.answer.c_str());
        if (batch.ranking.empty()) return 1;

        // a run of a batch has the bits of the scene alone
        const BatchRun& best = batch.runs[batch.ranking.front()];
        std::vector<std::string> own = overrides;
        own.insert(own.end(), best.overrides.begin(), best.overrides.end());
        const LoadedScene scene = load_scene("aortic-arch", own);
        World world(scene.setup);
        Control control;
        control.follow(0, scene.keys[0]);
        while (world.time() < scene.duration - 0.5 * scene.dt)
            if (step(world, control, scene.dt).failed()) return 1;
        std::printf("alone: state %s\n", world.state_hash().c_str());
        return world.state_hash() == best.state_hash ? 0 : 1;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.kind());
    }
}

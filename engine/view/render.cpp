// Picks the frames that were asked for, one camera and force scale for all, and writes their pictures.
#include "view/render.h"

#include "core/error.h"
#include "io/png_write.h"
#include "view/legend.h"
#include "view/run_folder.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

struct Range {
    std::size_t first, last;
};

Range frames_asked(const RenderOptions& options, std::size_t count)
{
    if (options.first < 0 && options.last < 0) return {count - 1, count - 1};
    if (options.first < 0 || options.last < options.first || static_cast<std::size_t>(options.last) >= count) {
        throw Error(ExitCode::BadScene, fmt::format("--frames {}:{}: expected A:B with 0 <= A <= B <= {}, the run has {} frame{}",
                                                    options.first, options.last, count - 1, count, count == 1 ? "" : "s"));
    }
    return {static_cast<std::size_t>(options.first), static_cast<std::size_t>(options.last)};
}

WallScale wall_scale(const RunFolder& run, const std::filesystem::path& dir, const RenderOptions& options)
{
    const double most = largest_on_wall(run, dir, *options.wall);
    // of a wall that never moved: something small, so that all of it has the colour of nothing
    const double least = *options.wall == WallQuantity::Stress ? 1.0 : 1e-6;
    const double top = options.wall_max > 0 ? options.wall_max : round_force_up(std::max(most, least));
    return {*options.wall, top, most > top};
}

}  // namespace

std::vector<std::filesystem::path> render_run(const std::filesystem::path& dir, const RenderOptions& options)
{
    const RunFolder run = read_run_folder(dir);
    const Range range = frames_asked(options, run.frames.size());

    // one camera and one scale of force for all: look at every frame once before drawing
    std::vector<WireFrame> frames;
    std::vector<Vec3> reached;
    double strongest = 0;
    for (std::size_t i = range.first; i <= range.last; ++i) {
        frames.push_back(read_frame(run, i));
        for (const WireLine& wire : frames.back().wires) reached.insert(reached.end(), wire.nodes.begin(), wire.nodes.end());
        for (const ContactMark& c : frames.back().contacts) strongest = std::max(strongest, c.force);
    }
    const WallScale scale = options.wall ? wall_scale(run, dir, options) : WallScale{};
    Renderer renderer(options.width, options.height);
    renderer.set_wall(run.wall);
    renderer.aim(reached);
    if (strongest > 0) renderer.set_force_scale(round_force_up(strongest));
    renderer.set_wall_scale(scale);

    std::vector<std::filesystem::path> written;
    for (std::size_t i = range.first; i <= range.last; ++i) {
        WireFrame& frame = frames[i - range.first];
        if (options.wall) frame.wall = read_moved_wall(run, i, *options.wall);
        renderer.draw(frame);
        frame.wall = {};  // large, and of no use any more
        written.push_back(dir / (options.first < 0 ? std::string("picture.png") : fmt::format("frame_{:06}.png", i)));
        write_png(written.back(), options.width, options.height, renderer.pixels());
    }
    return written;
}

}  // namespace seldinger

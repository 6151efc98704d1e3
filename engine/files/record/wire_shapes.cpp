// Resamples polylines, and gathers the frames of a run.
#include "record/wire_shapes.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/npz_write.h"
#include "io/vtp_read.h"
#include "run/frames.h"

#include <algorithm>

namespace seldinger {

void put_stations(std::span<const Vec3> line, std::size_t count, std::vector<double>& to)
{
    const auto edge = [&](std::size_t i) { return (line[i + 1] - line[i]).norm(); };
    double length = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) length += edge(i);
    double before = 0;  // of point `i`, from the first
    std::size_t i = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double s = length * static_cast<double>(k) / static_cast<double>(count - 1);
        while (i + 2 < line.size() && s > before + edge(i)) before += edge(i), ++i;
        const bool is_edge = line.size() > 1 && edge(i) > 0;
        const double part = is_edge ? std::clamp((s - before) / edge(i), 0.0, 1.0) : 0;
        const Vec3 at = line.size() > 1 ? line[i] + part * (line[i + 1] - line[i]) : line[0];
        to.insert(to.end(), {at.x(), at.y(), at.z()});
    }
}

std::string wire_npz(const std::filesystem::path& dir, const std::vector<FrameMark>& frames,
                     const std::vector<std::string>& series, const std::vector<std::string>& names)
{
    const Folder folder(dir);
    NpzWriter file;
    std::vector<double> times;
    std::vector<std::int64_t> steps;
    for (const FrameMark& frame : frames) times.push_back(frame.time), steps.push_back(frame.step);
    file.add("time_s", times);
    file.add("step", steps);
    for (std::size_t k = 0; k < series.size(); ++k) {
        std::vector<double> positions;
        for (const FrameMark& frame : frames) {
            const std::string name = frame_name(series[k], frame.step);
            std::vector<Vec3> line;
            for (const auto& p : parse_poly_data(read_file(folder / name), name).points) line.emplace_back(p[0], p[1], p[2]);
            if (line.empty())
                throw Error(ErrorKind::BadFile,
                            name + ": got no points; expected the shape of an instrument. Fix: run again with --overwrite");
            put_stations(line, shape_stations, positions);
        }
        file.add(names[k].empty() ? "position_m" : names[k] + ".position_m", positions, {frames.size(), shape_stations, 3});
    }
    return file.finish();
}

}  // namespace seldinger

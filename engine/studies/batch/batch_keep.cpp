// Rows and frames of single runs of a batch.
#include "batch/batch_keep.h"

#include "core/error.h"
#include "core/file_io.h"
#include "run/frames.h"
#include "scene/scene.h"
#include "batch/batch_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace seldinger {
namespace {

constexpr const char* kept_folder = "runs";

/// 000012.csv, 000012_wire.vtp, and what a killed batch left of them.
bool is_kept(const std::string& name)
{
    const auto digits = static_cast<std::size_t>(
        std::find_if_not(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }) - name.begin());
    const std::string rest = name.substr(digits);
    return digits >= 6 && (rest == ".csv" || (rest.starts_with("_") && rest.ends_with(".vtp")) || rest.ends_with(".tmp"));
}

}  // namespace

std::vector<std::string> keep_settings(const std::string& words)
{
    std::vector<std::string> settings;
    std::istringstream list(words);
    for (std::string word; std::getline(list, word, ',');) {
        if (word == "traces") settings.emplace_back("output.keep_traces=true");
        else if (word == "last-frame") settings.emplace_back("output.keep_last_frame=true");
        else
            throw Error(ErrorKind::BadScene,
                        fmt::format("--keep: got \"{}\"; expected traces, last-frame or both with a comma between them", word));
    }
    if (settings.empty())
        throw Error(ErrorKind::BadScene, "--keep: got nothing; expected traces, last-frame or both with a comma between them");
    return settings;
}

std::string kept_header()
{
    return "step,time_s,inserted_m,turned_rad,nodes,contacts,normal_n,friction_n,hand_force_n,hand_torque_nm,contact_length_m,"
           "tip_x_m,tip_y_m,tip_z_m\n";
}

std::string kept_row(std::int64_t step, double time, const WireReadings& r, const Vec3& tip)
{
    std::string row = fmt::format("{}{}{}{},{},{}", step, number_field(time), number_field(r.inserted), number_field(r.turned),
                                  r.nodes, r.contacts);
    for (const double value : {r.normal, r.friction, r.hand_force, r.hand_torque, r.contact_length, tip.x(), tip.y(), tip.z()})
        row += number_field(value);
    return row + "\n";
}

KeptFiles kept_files(std::int64_t run, const Scene& scene, const std::string& trace, const std::vector<WireOutput>& wires)
{
    KeptFiles files;
    if (!trace.empty()) files.emplace_back(fmt::format("{:06}.csv", run), trace);
    for (std::size_t k = 0; k < wires.size(); ++k)
        files.emplace_back(fmt::format("{:06}_{}.vtp", run, series_of(scene, static_cast<int>(k))), wire_vtp(wires[k]));
    return files;
}

void write_kept(const Folder& folder, const KeptFiles& files)
{
    if (files.empty()) return;
    const Folder runs = folder.make(kept_folder);
    for (const auto& [name, content] : files) write_file(runs / name, content);
}

void copy_kept(const Folder& from, const Folder& to)
{
    if (!from.has(kept_folder)) return;
    const Folder there = from.inner(kept_folder), here = to.make(kept_folder);
    for (const std::string& name : there.names())
        if (is_kept(name) && !name.ends_with(".tmp") && !here.has(name)) write_file(here / name, read_file(there / name));
}

void remove_kept(const Folder& folder)
{
    if (!folder.has(kept_folder)) return;
    const Folder runs = folder.inner(kept_folder);
    for (const std::string& name : runs.names())
        if (is_kept(name)) (void)runs.remove(name);
    (void)folder.remove(kept_folder);  // fails where something else is in it
}

}  // namespace seldinger

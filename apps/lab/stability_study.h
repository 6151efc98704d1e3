#pragma once
// Runs the cells of the stability maps that are not in the folder's table yet, on several threads.

#include "lab/stability.h"
#include "models/result_table.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

struct StabilityOptions {
    std::filesystem::path dir = "stability";
    std::vector<std::string> rows, maps,
        methods;                  // names; empty: all rows and maps, the methods that are shown; "all": all methods
    std::filesystem::path scene;  // of the user's, swept instead of the maps
    std::string vary;             // its key and values, "wire.bend_nm2=1e-5,1e-4"
    bool quick = false, quiet = false;
    int jobs = 0;            // threads; 0: one per core
    double cell_limit = 30;  // [s] of steps
};

/// What of the study there is to run.
struct StabilityWork {
    std::vector<StabilityMap> maps;
    std::vector<Model> methods;
    std::vector<double> steps;
    bool quick = false;
    [[nodiscard]] const std::vector<double>& values(const StabilityMap& map) const
    {
        return quick ? map.quick_values : map.values;
    }
};

/// @throws Error BadScene: no row, map or method of that name; a scene that is unsuitable for a sweep
[[nodiscard]] StabilityWork select_work(const StabilityOptions& options);

inline constexpr const char* stability_table_file = "stability.csv";
[[nodiscard]] ResultTable open_stability_table(const std::filesystem::path& dir);

struct StabilityProgress {
    long asked = 0, left = 0;  // cells in the selection; of them not run yet
    bool interrupted = false;
};

/// @throws Error BadFile: the folder cannot be written
[[nodiscard]] StabilityProgress run_stability(const StabilityWork& work, const StabilityOptions& options);

/// Per map and method "hold of all". Then the limits of a map (nothing touched, nothing held, unfinished cells), and every cell
/// of the default method that does not hold with the command that repeats it.
[[nodiscard]] std::string stability_summary(const StabilityWork& work, const ResultTable& table,
                                            const std::filesystem::path& dir);
[[nodiscard]] std::string stability_json(const StabilityWork& work, const ResultTable& table, const std::filesystem::path& dir);

}  // namespace seldinger::apps

#pragma once
// A sweep file: keys of a scene with their values, and the runs that follow from it.
//
//   [vary]
//   "wire.bend_nm2" = [1e-5, 1e-4]                          # a list: every value, with every value of the other lists (grid)
//   "contact.mu_sliding" = {min = 0.02, max = 0.3, n = 50}  # a draw: n values, even between min and max (log = true: in their
//   logarithm)
//   [vary.design]                                           # a list, too: each value is a file with keys of the scene, and has a name
//   soft = "soft.toml"
//   stiff = "stiff.toml"
//
// Draws are made together: run k of n takes the k-th value of every drawn key, and each point of the grid sees the same n of
// them. A value depends on the scene's seed, its key and k alone, so that adding an axis leaves the others' values as they were.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

struct SweepAxis {
    std::string key;                  // "wire.bend_nm2"
    std::vector<std::string> values;  // as TOML, on one line each; of `design` the names
    std::vector<std::vector<std::string>> designs;  // of `design`: what each file sets, as texts of --set
    bool drawn = false;
    int line = 0;  // in the sweep file, from 1
};

struct Sweep {
    std::filesystem::path source;
    std::vector<SweepAxis> axes;  // in the file's order

    /// Product of the lists' lengths, times n of the draws.
    [[nodiscard]] std::size_t run_count() const;
    /// Which value of each axis a run takes. The first list varies slowest, the draws fastest.
    [[nodiscard]] std::vector<std::size_t> indices(std::size_t run) const;
    /// The run's values as texts of --set.
    [[nodiscard]] std::vector<std::string> overrides(std::size_t run) const;
    /// The same of one axis.
    [[nodiscard]] std::vector<std::string> overrides(const SweepAxis& axis, std::size_t value) const;
};

/// @param seed  of the draws: scene.seed  @throws Error BadFile (missing), BadScene: one line, "file:line:column: key: ..."
[[nodiscard]] Sweep read_sweep(const std::filesystem::path& file, std::int64_t seed);
[[nodiscard]] Sweep read_sweep_text(const std::string& text, const std::filesystem::path& file, std::int64_t seed);

/// The text with the files of its designs behind it, as [files], which read_sweep_text() takes in their place: a folder of
/// results keeps all that it came from. @throws Error as above
[[nodiscard]] std::string with_designs(const std::string& text, const std::filesystem::path& file);

}  // namespace seldinger

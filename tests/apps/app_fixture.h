#pragma once
// Runs the real `seldinger` command in a folder of its own, and small scenes for it.

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "support/refusal.h"
#include "support/scenes.h"

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace seldinger::test {

namespace fs = std::filesystem;

/// A folder with these files, or an empty one, that goes when the test ends.
struct ScratchFolder {
    fs::path path;
    ScratchFolder(std::initializer_list<std::pair<std::string, std::string>> files = {})
    {
        std::string form = (fs::temp_directory_path() / "seldinger_apps_XXXXXX").string();
        REQUIRE(mkdtemp(form.data()) != nullptr);
        path = form;
        for (const auto& [name, text] : files) write(name, text);
    }
    ~ScratchFolder()
    {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    fs::path write(const std::string& name, const std::string& text) const
    {
        std::ofstream(path / name, std::ios::binary) << text;
        return path / name;
    }
};

inline std::string slurp(const fs::path& path)
{
    std::ifstream stream(path, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// Every file below a folder by its path from there.
inline std::map<std::string, std::string> contents_of(const fs::path& dir)
{
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(dir))
        if (entry.is_regular_file()) all[fs::relative(entry.path(), dir).string()] = slurp(entry.path());
    return all;
}

struct AppResult {
    int code = -1;
    std::string out, err;
    bool compiled = false;  // it said that it compiles kernels; the line is not in `err`, as it comes with the first run of many
    [[nodiscard]] long error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

inline AppResult app_result(int status, std::string out, std::string err)
{
    AppResult result{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), std::move(out), std::move(err)};
    const std::size_t line = result.err.find("seldinger: compiling OpenCL kernels");
    result.compiled = line != std::string::npos;
    if (result.compiled) result.err.erase(line, result.err.find('\n', line) + 1 - line);
    return result;
}

/// The program that is tried: that of the build, or another of the same sources (./dev sanitize).
inline const char* app_path()
{
    const char* other = std::getenv("SELDINGER_APP");
    return other ? other : SEL_APP;
}

/// Runs `prefix seldinger arguments` by the shell, in `folder`.
inline AppResult run_app(const ScratchFolder& folder, const std::string& arguments, const std::string& prefix = "")
{
    const fs::path out = folder.path / ".out", err = folder.path / ".err";
    const std::string command = fmt::format("cd '{}' && {} '{}' {} >'{}' 2>'{}'", folder.path.string(), prefix, app_path(),
                                            arguments, out.string(), err.string());
    const int status = std::system(command.c_str());
    return app_result(status, slurp(out), slurp(err));
}

/// The same of what has to end well.
inline AppResult run_ok(const ScratchFolder& folder, const std::string& arguments, const std::string& prefix = "")
{
    AppResult result = run_app(folder, arguments, prefix);
    REQUIRE_MESSAGE(result.code == 0, arguments << ": " << result.err);
    return result;
}

/// The same of what has to end with this code and one line that says so.
inline AppResult check_refused(const ScratchFolder& folder, const std::string& arguments, int code, const std::string& says,
                               const std::string& prefix = "")
{
    AppResult result = run_app(folder, arguments, prefix);
    CAPTURE(arguments);
    CAPTURE(result.err);
    CHECK(result.code == code);
    CHECK(result.error_lines() == 1);
    CHECK(has(result.err, says));
    return result;
}

/// Starts `seldinger arguments` in `folder`, sends `signal` once the file `table` has more than `rows` lines, and waits. The
/// process has a low priority, so that the watcher sees it run on a busy machine.
/// @return code: the exit code, or minus the signal that ended it
inline AppResult run_and_signal(const fs::path& folder, const std::vector<std::string>& arguments, const fs::path& table,
                                long rows, int signal)
{
    const fs::path out = folder / ".out", err = folder / ".err";
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        if (nice(19) == -1 || !std::freopen(out.c_str(), "w", stdout) || !std::freopen(err.c_str(), "w", stderr) ||
            chdir(folder.c_str()) != 0)
            _exit(126);
        std::vector<char*> argv = {const_cast<char*>(app_path())};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        execv(app_path(), argv.data());
        _exit(127);
    }
    int status = 0;
    for (;;) {
        if (waitpid(child, &status, WNOHANG) == child) break;  // ended before it could be signalled: the caller sees code 0
        const std::string text = slurp(table);
        if (std::count(text.begin(), text.end(), '\n') > rows) {
            kill(child, signal);
            waitpid(child, &status, 0);
            break;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return app_result(status, slurp(out), slurp(err));
}

/// The same of `seldinger run scene -o dir`, by the rows of its trace. @return the exit code, or minus the signal that ended it
inline int run_and_signal(const fs::path& scene, const fs::path& dir, long rows, int signal, bool resume = false)
{
    std::vector<std::string> arguments = {"run", scene.string(), "-o", dir.string(), "--quiet"};
    if (resume) arguments.emplace_back("--resume");
    return run_and_signal(dir.parent_path(), arguments, dir / "trace.csv", rows, signal).code;
}

inline nlohmann::json summary_of(const fs::path& dir) { return nlohmann::json::parse(slurp(dir / "summary.json")); }

/// Rows of a CSV as text cells, header first.
inline std::vector<std::vector<std::string>> csv_rows(const fs::path& path)
{
    std::vector<std::vector<std::string>> rows;
    std::stringstream lines(slurp(path));
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> cells;
        std::stringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
        if (!line.empty() && line.back() == ',') cells.emplace_back();
        rows.push_back(cells);
    }
    return rows;
}

/// The same rows by the names of their columns.
using Row = std::map<std::string, std::string>;
inline std::vector<Row> table_rows(const fs::path& path)
{
    const auto cells = csv_rows(path);
    std::vector<Row> rows(cells.empty() ? 0 : cells.size() - 1);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        REQUIRE(cells[k + 1].size() == cells[0].size());
        for (std::size_t c = 0; c < cells[0].size(); ++c) rows[k][cells[0][c]] = cells[k + 1][c];
    }
    return rows;
}

/// A run's trace without the milliseconds of each step, which differ from run to run.
inline std::vector<Row> timeless_trace(const fs::path& dir)
{
    std::vector<Row> rows = table_rows(dir / "trace.csv");
    for (Row& row : rows) REQUIRE(row.erase("step_ms") == 1);
    return rows;
}

/// A wire held at its base, falling free: no vessel, so no OpenCL. 21 nodes, dt 1 ms.
inline std::string free_scene(double duration = 0.05, int record_every = 10)
{
    return shared_scene(
        fmt::format("[scene]\nname = \"falling\"\nduration_s = {}\ndt_s = 0.001\nrecord_every = {}\n", duration, record_every),
        "hanging");
}

/// A catheter and, inside it and farther on, a wire, both fed along a tube.
inline std::string two_instruments(const std::string& model)
{
    const std::string made = "length_m = 0.1\ndensity = 7900.0\nbend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = 1e4\nnodes = 21\n";
    const auto keys = [](double from, double to) {
        return fmt::format("keys = [ {{t_s = 0.0, advance_m = {}}}, {{t_s = 0.1, advance_m = {}}} ]\n", from, to);
    };
    return "[scene]\nname = \"two\"\nduration_s = 0.02\ndt_s = 0.002\nrecord_every = 2\n"
           "[[instrument]]\nname = \"catheter\"\nradius_m = 0.001\nlumen_radius_m = 0.0007\n" +
           made + "[instrument.feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n" + keys(0.01, 0.03) +
           "[[instrument]]\nname = \"wire\"\nradius_m = 0.0005\n" + made + "[instrument.feed]\n" + keys(0.02, 0.06) +
           "[coaxial]\norder = [\"catheter\", \"wire\"]\nmodel = \"" + model +
           "\"\n"
           "[vessel]\nshape = \"tube\"\nradius_m = 0.003\nlength_m = 0.1\ntriangles = 2000\n";
}

/// A wire fed into a tube of 5 mm radius and 0.1 m length, slanting to the floor. It touches after some 5 mm and slides along
/// it. 4 mm are inside at the start.
inline std::string tube_scene(double duration = 0.3)
{
    const std::string head = fmt::format("[scene]\nname = \"tube\"\nduration_s = {}\ndt_s = 0.001\nrecord_every = 5\n", duration);
    return shared_scene(head, "tube") +
           "keys = [ {t_s = 0.0, advance_m = 0.004, turn_rad = 0.0}, "
           "{t_s = 1.0, advance_m = 0.084, turn_rad = 1.0} ]\n";
}

}  // namespace seldinger::test

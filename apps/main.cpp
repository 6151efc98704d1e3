// seldinger: the command. Reads the command line, runs one subcommand, turns every error into one line and an exit code.

#include "commands.h"
#include "core/note.h"
#include "core/printable.h"
#include "engine.h"
#include "stop_signal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

namespace seldinger::apps {
namespace {

constexpr std::size_t longest_line = 4000, longest_shown_word = 400;

/// One line, whatever an exception's text holds: names and texts in it are others'.
int complain(std::string message, ExitCode code)
{
    // an argument or another library's exception may quote a file, too
    message = one_line(printable(with_short_words(message, longest_shown_word), longest_line));
    while (!message.empty() && message.back() == ' ') message.pop_back();
    note(fmt::format("seldinger: {}\n", message));
    return static_cast<int>(code);
}

int run_command_line(int argc, char** argv)
{
    CLI::App app("Guidewires pushed, pulled and turned inside blood vessels: fast, and with the error bar shown.", "seldinger");
    app.set_version_flag("--version", std::string("seldinger ") + version());
    app.require_subcommand(1);
    Command chosen;
    add_run(app, chosen);
    add_batch(app, chosen);
    add_check(app, chosen);
    add_init(app, chosen);
    add_vessel(app, chosen);
    add_render(app, chosen);
    add_labels(app, chosen);
    add_instruments(app, chosen);
    add_devices(app, chosen);
    add_chart(app, chosen);
    add_stability(app, chosen);
    add_plan(app, chosen);
    add_bench(app, chosen);
    add_live(app, chosen);
    add_choose_live_model(app, chosen);
    add_report(app, chosen);
    add_farm(app, chosen);
    const std::string first = argc > 1 ? argv[1] : "";
    const auto known = app.get_subcommands([&](CLI::App* command) { return command->get_name() == first; });
    if (!first.empty() && first[0] != '-' && known.empty())
        return complain(fmt::format("\"{}\": unknown subcommand; see `seldinger --help`", first), ExitCode::BadScene);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return complain(std::string(error.what()) + "; see `seldinger --help`", ExitCode::BadScene);
    }
    return static_cast<int>(chosen());
}

std::string limited(const std::exception& error)
{
    return fmt::format("the system refuses: {}; is memory or the number of processes limited (ulimit -a)?", error.what());
}

/// Where stdin, stdout or stderr is closed, the first file that is opened would get its number, and results or an error would be
/// written into it. What cannot be written to takes the place, so that they are refused instead.
void occupy_closed_streams()
{
    for (int fd = 0; fd <= 2; ++fd)
        if (::fcntl(fd, F_GETFD) < 0) (void)::open("/dev/null", O_RDONLY);  // the lowest number that is free
}

}  // namespace

void print(std::string_view given)
{
    std::string text;  // what scenes and files are called is others' text: no terminal escapes, but lines stay lines
    for (std::size_t at = 0; at < given.size();) {
        const std::size_t end = std::min(given.find_first_of("\n\t", at), given.size());
        text += printable(given.substr(at, end - at));
        if (end < given.size()) text += given[end];
        at = end + 1;
    }
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
        if (errno == EPIPE) return;  // who reads has read enough (`| head`)
        throw Error(ExitCode::BadFile, "stdout: cannot be written; is the disk full?");
    }
}

}  // namespace seldinger::apps

int main(int argc, char** argv)
{
    using namespace seldinger;
    // a limit on file sizes and a closed pipe are errors of a write, not the end of the process
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    apps::occupy_closed_streams();
    try {
        apps::watch_signals();
        return apps::run_command_line(argc, argv);
    } catch (const Error& error) {
        return apps::complain(error.what(), error.code());
    } catch (const std::filesystem::filesystem_error& error) {  // a name that is too long, a folder that one may not look into
        return apps::complain(
            fmt::format("{}: cannot be used: {}; check the path", error.path1().string(), error.code().message()),
            ExitCode::BadFile);
    } catch (const std::system_error& error) {  // no thread to be had
        return apps::complain(apps::limited(error), ExitCode::BadFile);
    } catch (const std::bad_alloc&) {
        return apps::complain("out of memory; take a coarser mesh or fewer nodes", ExitCode::BadFile);
    } catch (const std::exception& error) {
        // oneTBB has no type of its own for a thread that it does not get
        if (std::string_view(error.what()).starts_with("pthread_create"))
            return apps::complain(apps::limited(error), ExitCode::BadFile);
        return apps::complain(fmt::format("{}; please report the command that led here", error.what()), ExitCode::Stopped);
    } catch (...) {
        return apps::complain("unknown error; please report the command that led here", ExitCode::Stopped);
    }
}

// seldinger: the command. Reads the command line, runs one subcommand, turns every error into one line and an exit code.

#include "command_line.h"
#include "commands.h"
#include "core/exit_code.h"
#include "core/note.h"
#include "core/printable.h"
#include "device/kernel_cache.h"
#include "engine.h"
#include "setup/vessel_cache.h"
#include "stop_signal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

namespace seldinger::apps {
namespace {

constexpr std::size_t longest_line = 4000, longest_shown_word = 400;

/// One line, whatever an exception's text holds: names and texts in it are others'.
int complain(std::string message, ErrorKind code)
{
    // an argument or another library's exception may quote a file, too
    message = one_line(printable(with_short_words(message, longest_shown_word), longest_line));
    while (!message.empty() && message.back() == ' ') message.pop_back();
    note(fmt::format("seldinger: {}\n", message));
    return exit_code(code);
}

/// A mesh of millions of triangles passes through a dozen large arrays. To return each to the system and be given cleared memory
/// for the next takes a fifth of the time.
void keep_freed_memory()
{
#if defined(__GLIBC__)
    ::mallopt(M_MMAP_MAX, 0);
    ::mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

int run_command_line(int argc, char** argv)
{
    keep_freed_memory();
    CommandLine app("Simulates guidewires, catheters and sheaths in blood vessels, and estimates the error.", "seldinger");
    app.set_version_flag("--version", std::string("seldinger ") + version());
    app.require_subcommand(1, 1);
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
    add_plan(app, chosen);
    add_live(app, chosen);
    add_choose_live_model(app, chosen);
    add_report(app, chosen);
    add_farm(app, chosen);
    add_dataset(app, chosen);
    add_lab(app, chosen);
    for (const char* command : {"run", "batch", "check", "init", "vessel", "chart", "stability", "plan", "bench", "live", "farm",
                                "dataset"})
        app.subcommand(command)->add_flag_callback(
            "--no-vessel-cache", [] { ::setenv("SELDINGER_VESSEL_CACHE", "off", 1); },  // for processes of its own, too
            "do without the cache of prepared vessels (as SELDINGER_VESSEL_CACHE=off)");
    use_vessel_cache(true);
    const std::string first = argc > 1 ? argv[1] : "";
    if (!first.empty() && first[0] != '-' && !app.subcommand(first))
        return complain(fmt::format("\"{}\": unknown subcommand; see `seldinger --help`", first), ErrorKind::BadScene);
    const CommandLine::Parsed parsed = app.parse(argc, argv);
    if (parsed.printed) return 0;  // --help, --version
    if (!parsed.error.empty()) return complain(parsed.error + "; see `seldinger --help`", ErrorKind::BadScene);
    device::tell_compiling(!app.below_was_given("--quiet"));
    return exit_code(chosen());
}

std::string limited(const std::exception& error)
{
    return fmt::format("the system refuses: {}. Fix: raise the limits of memory and processes (ulimit -a)", error.what());
}

/// Memory that a library does not get where nothing can be caught: LLVM is built without exceptions.
[[noreturn]] void end_by_terminate()
{
    try {
        if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
        say_at_once("seldinger: out of memory inside a library; raise the limit of memory (ulimit -v), or take a coarser mesh\n");
        ::_exit(exit_code(ErrorKind::BadFile));
    } catch (...) {  // ours: a core dump tells more
    }
    std::abort();
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
        throw Error(ErrorKind::BadFile, "stdout: cannot be written. Fix: check that the disk is not full");
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
    std::set_terminate(apps::end_by_terminate);
    try {
        apps::watch_signals();
        return apps::run_command_line(argc, argv);
    } catch (const Error& error) {
        return apps::complain(error.what(), error.kind());
    } catch (const std::filesystem::filesystem_error& error) {  // a name that is too long, a folder that one may not look into
        return apps::complain(
            fmt::format("{}: cannot be used: {}; check the path", error.path1().string(), error.code().message()),
            ErrorKind::BadFile);
    } catch (const std::system_error& error) {  // no thread to be had
        return apps::complain(apps::limited(error), ErrorKind::BadFile);
    } catch (const std::bad_alloc&) {
        return apps::complain("out of memory; take a coarser mesh or fewer nodes", ErrorKind::BadFile);
    } catch (const std::exception& error) {
        // oneTBB has no separate exception type for a thread that it does not get
        if (std::string_view(error.what()).starts_with("pthread_create"))
            return apps::complain(apps::limited(error), ErrorKind::BadFile);
        return apps::complain(fmt::format("{}; please report the command that led here", error.what()), ErrorKind::Stopped);
    } catch (...) {
        return apps::complain("unknown error; please report the command that led here", ErrorKind::Stopped);
    }
}

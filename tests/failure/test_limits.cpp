// Limits of address space and of processes (ulimit -v, -u): a result, or exit 3 or 5 and a line, never a signal or a hang.
// Libraries that would end the process are not begun with.
#include "apps/app_fixture.h"
#include "core/error.h"
#include "core/system_needs.h"
#include "io/film_write.h"
#include "support/skip.h"

#include <sys/resource.h>

#include <array>
#include <functional>

namespace seldinger::test::test_limits {

namespace {

/// What `body` throws in a child process that has this limit; empty: nothing.
std::string said_under(int resource, rlim_t limit, const std::function<void()>& body)
{
    std::array<int, 2> ends{};
    REQUIRE(pipe(ends.data()) == 0);
    std::fflush(nullptr);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const rlimit limits{limit, limit};
        std::string text;
        if (setrlimit(static_cast<__rlimit_resource>(resource), &limits) != 0) text = "setrlimit";
        try {
            body();
        } catch (const std::exception& error) {
            text = error.what();
        }
        (void)!write(ends[1], text.data(), text.size());
        _exit(0);
    }
    close(ends[1]);
    std::array<char, 4096> text{};
    const ssize_t got = read(ends[0], text.data(), text.size());
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got))};
}

/// A folder with scenes, a run and a cache of kernels that every user may write to.
struct OpenFolder : ScratchFolder {
    OpenFolder()
    {
        write("t.toml", tube_scene(0.02));
        run_ok(*this, "run t.toml -o R --quiet --set output.wire_every=10", cache());
        REQUIRE(std::system(fmt::format("chmod -R a+rwX '{}'", path.string()).c_str()) == 0);
    }
    [[nodiscard]] std::string cache(const char* name = "cache") const
    {
        return fmt::format("POCL_CACHE_DIR='{}'", (path / name).string());
    }
};

/// A result, or one line. Notes (of the kernel cache) come before it.
void check_end(const AppResult& result)
{
    CAPTURE(result.err);
    CHECK((result.code == 0 || result.code == 3 || result.code == 5));
    if (result.code != 0) CHECK(has(result.err, "seldinger: "));
    CHECK(result.error_lines() <= 2);
    for (const char* of_a_library : {"terminate called", "PTHREAD ERROR", "LLVM ERROR", "no usable OpenCL"})
        CHECK_FALSE(has(result.err, of_a_library));
}

}  // namespace

TEST_SUITE("failure/limits")
{
    TEST_CASE("property: address space that is not there is said, and taken back where it is")
    {
        const auto tries = [] { try_system_needs({"A library", std::size_t{1} << 40, 0}); };
        CHECK(said_under(RLIMIT_AS, rlim_t{1} << 38, tries)
                  .find("A library: got less address space than it may need; expected 1048576 MB more") == 0);
        CHECK(said_under(RLIMIT_AS, RLIM_INFINITY, [] {
                  for (int k = 0; k < 1000; ++k)
                      try_system_needs({"A library", std::size_t{1} << 40, 4});  // 2^50 bytes and 4,000 threads
              }) == "");
    }

    TEST_CASE("property: threads that are not there are said")
    {
        if (getuid() != 0) return skip("needs root, to become a user without processes");
        const std::string said = said_under(RLIMIT_NPROC, 3, [] {
            REQUIRE(setuid(20000 + static_cast<uid_t>(getpid()) % 40000) == 0);
            try_system_needs({"A library", 0, 8});
        });
        CAPTURE(said);
        CHECK(said.find("A library: got 2 threads; expected 8.") == 0);
        CHECK(has(said, "ulimit -u"));
    }

    TEST_CASE("regression: whatever ulimit -v allows, commands end by themselves and say why")
    {
        if (std::getenv("ASAN_OPTIONS")) return skip("a program with the address sanitizer has no limit of addresses");
        const OpenFolder folder;
        int refused = 0, done = 0;
        for (int megabytes = 150; megabytes <= 1350; megabytes += 75) {
            CAPTURE(megabytes);
            const std::string limit =
                fmt::format("ulimit -c 0 && ulimit -v {} && {} timeout 120", megabytes * 1000, folder.cache());
            for (const char* command : {"run t.toml -o D --overwrite --quiet", "render R -o p.png --size 160x120 --quiet"}) {
                CAPTURE(command);
                const AppResult result = run_app(folder, command, limit);
                check_end(result);
                result.code == 0 ? ++done : ++refused;
            }
        }
        CHECK(refused > 0);
        CHECK(done > 0);
    }

    TEST_CASE("regression: kernels are compiled with the least memory that is taken for enough")
    {
        if (std::getenv("ASAN_OPTIONS")) return skip("a program with the address sanitizer has no limit of addresses");
        const OpenFolder folder;
        int megabytes = 700;
        const auto warm = [&] { return fmt::format("ulimit -c 0 && ulimit -v {} && {}", megabytes * 1000, folder.cache()); };
        while (megabytes < 4000 && run_app(folder, "run t.toml -o W --overwrite --quiet", warm()).code != 0) megabytes += 20;
        CAPTURE(megabytes);
        const AppResult result =
            run_app(folder, "run t.toml -o D --overwrite --quiet",
                    fmt::format("ulimit -c 0 && ulimit -v {} && {} timeout 300", megabytes * 1000, folder.cache("cold")));
        CAPTURE(result.err);
        CHECK(result.code == 0);
    }

    TEST_CASE("regression: whatever ulimit -u allows, commands end by themselves and say why")
    {
        if (getuid() != 0) return skip("needs root, to become a user without processes");
        const OpenFolder folder;
        const std::string user = std::to_string(20000 + getpid() % 40000);
        const std::string as_user = fmt::format("setpriv --reuid={0} --regid={0} --clear-groups", user);
        if (std::system(fmt::format("{} test -x '{}' 2>/dev/null", as_user, app_path()).c_str()) != 0)
            return skip("no setpriv, or other users may not run the program");
        int refused = 0, done = 0;
        for (int processes = 1; processes <= 16; ++processes) {
            CAPTURE(processes);
            for (const char* command : {"run t.toml -o D --overwrite --quiet", "render R -o p.png --size 160x120 --quiet"}) {
                CAPTURE(command);
                const std::string limited =
                    fmt::format("{} HOME='{}' {} timeout 120 bash -c 'ulimit -c 0; ulimit -u {}; exec \"$@\"' limited",
                                folder.cache(), folder.path.string(), as_user, processes);
                const AppResult result = run_app(folder, command, limited);
                check_end(result);
                result.code == 0 ? ++done : ++refused;
                REQUIRE(std::system(fmt::format("chmod -R a+rwX '{}'", folder.path.string()).c_str()) == 0);
            }
        }
        CHECK(refused > 0);
        CHECK(done > 0);
    }

    TEST_CASE("regression: no process left for ffmpeg is not said to be a missing ffmpeg")
    {
        const ScratchFolder folder;
        fs::permissions(folder.path, fs::perms::all);  // for another user
        const std::string film = (folder.path / "f.mp4").string();
        const auto begin = [&] { const FilmWriter writer(film, 160, 120, 25, FilmPixels::Rgb); };
        const std::string missing = said_under(RLIMIT_AS, RLIM_INFINITY, [&] {
            setenv("PATH", "/nowhere", 1);
            begin();
        });
        CAPTURE(missing);
        CHECK(has(missing, "ffmpeg is not installed"));
        if (getuid() != 0) return skip("needs root, to become a user without processes");
        const std::string none_left = said_under(RLIMIT_NPROC, 1, [&] {
            REQUIRE(setuid(20000 + static_cast<uid_t>(getpid()) % 40000) == 0);
            begin();
        });
        CAPTURE(none_left);
        CHECK(has(none_left, "ffmpeg cannot be started: Resource temporarily unavailable"));
        CHECK_FALSE(has(none_left, "not installed"));
    }
}

}  // namespace seldinger::test::test_limits

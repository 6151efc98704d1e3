// The folder of compiled kernels: cut-off files are taken out, whole ones stay.

#include "core/error.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "device/kernel_cache.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>

#include <elf.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

namespace seldinger::test::test_kernel_cache {

namespace {

/// A shared object of so many bytes as its header says.
std::string object(std::size_t bytes)
{
    Elf64_Ehdr header{};
    std::memcpy(header.e_ident, ELFMAG, SELFMAG);
    header.e_ident[EI_CLASS] = ELFCLASS64;
    header.e_shentsize = 64;
    header.e_shnum = 2;
    header.e_shoff = bytes - 128;
    std::string file(bytes, '\0');
    std::memcpy(file.data(), &header, sizeof header);
    return file;
}

/// Bitcode of one block of so many words.
std::string bitcode(std::uint32_t words)
{
    const std::uint32_t head[] = {0xdec04342u, 1u | 8u << 2 | 3u << 10, words};
    std::string file(sizeof head + 4 * words, 'x');
    std::memcpy(file.data(), head, sizeof head);
    return file;
}

}  // namespace

TEST_SUITE("device/kernel cache")
{
    TEST_CASE(
        "property: what one process compiles another waits for, until it ends, however it ends; nobody waits for another name")
    {
        const TemporaryFolder folder;
        const char* before = std::getenv("POCL_CACHE_DIR");
        const std::string kept = before ? before : "";
        ::setenv("POCL_CACHE_DIR", folder.path().c_str(), 1);
        int pipe[2];
        REQUIRE(::pipe(pipe) == 0);
        const pid_t child = ::fork();
        if (child == 0) {
            const device::CompilerTurn turn("one");
            (void)!::write(pipe[1], "x", 1);
            for (;;) ::pause();
        }
        char said = 0;
        REQUIRE(::read(pipe[0], &said, 1) == 1);
        { const device::CompilerTurn other("two"); }
        std::filesystem::path lock;
        for (const auto& at : std::filesystem::directory_iterator(folder.path())) lock = at.path();
        REQUIRE(lock.extension() == ".lock");
        const auto file = lock.parent_path() / lock.stem();
        CHECK_THROWS_AS((void)FileLock::of_file(file), Error);
        CHECK_THROWS_AS((void)FileLock::of_file(file, std::chrono::milliseconds(50)), Error);
        ::kill(child, SIGKILL);
        { const device::CompilerTurn turn("one"); }
        ::waitpid(child, nullptr, 0);
        CHECK_FALSE(std::filesystem::exists(lock));
        if (before) ::setenv("POCL_CACHE_DIR", kept.c_str(), 1);
        else ::unsetenv("POCL_CACHE_DIR");
        for (const int end : pipe) ::close(end);
    }

    TEST_CASE("property: a kernel is copied to where there is none, and whole; what is there stays")
    {
        const TemporaryFolder folder;
        const auto a = folder.path() / "a", b = folder.path() / "b";
        std::filesystem::create_directories(a / "kernel/1-1-1");
        std::filesystem::create_directories(b);
        write_file(a / "kernel/1-1-1/kernel.so", "code");
        device::copy_kernel(a, b, "other");
        CHECK(std::filesystem::is_empty(b));
        device::copy_kernel(a, b, "kernel");
        CHECK(read_file(b / "kernel/1-1-1/kernel.so") == "code");
        write_file(a / "kernel/1-1-1/kernel.so", "newer");
        device::copy_kernel(a, b, "kernel");
        CHECK(read_file(b / "kernel/1-1-1/kernel.so") == "code");
        CHECK(std::distance(std::filesystem::directory_iterator(b), {}) == 1);
    }

    TEST_CASE("regression: an empty POCL_CACHE_DIR is none")
    {
        const TemporaryFolder folder;
        const auto set = [](const char* name, const std::optional<std::string>& value) {
            if (value) ::setenv(name, value->c_str(), 1);
            else ::unsetenv(name);
        };
        const auto of = [](const char* name) -> std::optional<std::string> {
            const char* value = std::getenv(name);
            return value ? std::optional<std::string>(value) : std::nullopt;
        };
        const auto cache = of("POCL_CACHE_DIR"), caches = of("XDG_CACHE_HOME");
        set("POCL_CACHE_DIR", "");
        set("XDG_CACHE_HOME", folder.path().string());
        device::prepare_kernel_cache();
        CHECK_FALSE(of("POCL_CACHE_DIR").has_value());
        CHECK(device::kernel_cache_folder() == folder.path() / "pocl/kcache");
        set("POCL_CACHE_DIR", cache);
        set("XDG_CACHE_HOME", caches);
    }

    TEST_CASE("property: of kernels cut anywhere none is left, and whole ones are")
    {
        const TemporaryFolder folder;
        const auto hash = folder.path() / "AB/CDEFGHIJKLMNOPABCDEFGHIJKLMNOPABCDEFGH", dir = hash / "kernel/64-1-1";
        std::filesystem::create_directories(dir);
        write_file(dir / "whole.so", object(1000));
        write_file(hash / "program.bc", bitcode(25));
        CHECK(device::clean_kernel_cache(folder.path()).empty());
        for (const std::size_t size : {0, 1, 3, 40, 63, 64, 900, 999}) {
            CAPTURE(size);
            write_file(dir / "cut.so", object(1000).substr(0, size));
            CHECK(device::clean_kernel_cache(folder.path()).empty());
            CHECK_FALSE(std::filesystem::exists(dir / "cut.so"));
        }
        const std::string code = bitcode(25);
        for (std::size_t size = 0; size < code.size(); ++size) {
            if (size == 4) continue;  // the mark alone is a file of no block
            CAPTURE(size);
            write_file(hash / "cut.bc", code.substr(0, size));
            CHECK(device::clean_kernel_cache(folder.path()).empty());
            CHECK_FALSE(std::filesystem::exists(hash / "cut.bc"));
        }
        CHECK(std::filesystem::exists(dir / "whole.so"));
        CHECK(std::filesystem::exists(hash / "program.bc"));
    }

    TEST_CASE("regression: what PoCL has not put there is not removed, whatever it is called; links are not followed")
    {
        const TemporaryFolder folder, theirs;
        const auto hash = folder.path() / "AB/CDEFGHIJKLMNOPABCDEFGHIJKLMNOPABCDEFGH";
        const std::filesystem::path others[] = {"notes.so", "model.bc", "lib/notes.so", "AB/notes.so", "AB/other/notes.so",
                                                "AB/CDEFGHIJKLMNOPABCDEFGHIJKLMNOPABCDEFGH/kernel/64-1-1/deeper/notes.so"};
        for (const auto& name : others) {
            std::filesystem::create_directories((folder.path() / name).parent_path());
            write_file(folder.path() / name, "no ELF");
        }
        write_file(theirs.path() / "program.bc", "no bitcode");
        std::filesystem::create_directory_symlink(theirs.path(), folder.path() / "AC");
        std::filesystem::create_directory_symlink(theirs.path(), hash / "linked");
        std::filesystem::create_symlink(theirs.path() / "program.bc", hash / "program.bc");
        CHECK_FALSE(device::clean_kernel_cache(folder.path()).empty());
        for (const auto& name : others) CHECK(std::filesystem::exists(folder.path() / name));
        CHECK(std::filesystem::exists(theirs.path() / "program.bc"));
        CHECK(std::filesystem::is_symlink(hash / "program.bc"));
    }

    TEST_CASE("regression: what lies in the place of a kernel and is none is named and left there; what PoCL makes is not")
    {
        const TemporaryFolder folder, theirs;
        const std::filesystem::path hash = "AB/CDEFGHIJKLMNOPABCDEFGHIJKLMNOPABCDEFGH", inner = hash / "kernel/64-1-1";
        const auto make = [&] {
            std::filesystem::remove_all(folder.path() / "AB");
            std::filesystem::create_directories(folder.path() / inner);
            write_file(folder.path() / inner / "kernel.so", object(1000));
            write_file(folder.path() / hash / "program.bc", bitcode(25));
            write_file(folder.path() / hash / "last_accessed", "");
        };
        make();
        CHECK(device::clean_kernel_cache(folder.path()).empty());
        for (const std::filesystem::path& name :
             {std::filesystem::path("AB"), hash, hash / "kernel", inner, inner / "kernel.so", hash / "program.bc"}) {
            CAPTURE(name.string());
            make();
            const auto place = folder.path() / name;
            std::filesystem::remove_all(place);
            std::filesystem::create_symlink(theirs.path(), place);
            CHECK(device::clean_kernel_cache(folder.path()) == place);
            std::filesystem::remove(place);
            REQUIRE(::mkfifo(place.c_str(), 0600) == 0);
            CHECK(device::clean_kernel_cache(folder.path()) == place);
            std::filesystem::remove(place);
            if (place.has_extension()) std::filesystem::create_directory(place);
            else write_file(place, "a file for a folder");
            CHECK(device::clean_kernel_cache(folder.path()) == place);
            CHECK(std::filesystem::exists(place));
        }
        make();
        write_file(theirs.path() / "notes", "somebody's");
        const auto stamp = folder.path() / hash / "last_accessed";  // PoCL writes to it
        std::filesystem::remove(stamp);
        std::filesystem::create_hard_link(theirs.path() / "notes", stamp);
        CHECK(device::clean_kernel_cache(folder.path()) == stamp);
    }
}

}  // namespace seldinger::test::test_kernel_cache

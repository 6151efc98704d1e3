// Tests the cache's folder with a file of some size, checks its shared objects, and finds another folder if necessary.
#include "device/kernel_cache.h"

#include "core/error.h"
#include "core/folder.h"
#include "core/note.h"
#include "core/printable.h"

#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <system_error>
#include <vector>

namespace seldinger::device {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t room = 1 << 20;  // [bytes] what the kernels of a scene take, about

/// @return 0, or the errno of the failed operation
int try_to_write(const fs::path& dir)
{
    std::error_code error;
    fs::create_directories(dir, error);
    if (error) return error.value();
    std::string name = (dir / "seldinger-XXXXXX").string();
    const int fd = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd < 0) return errno;
    const std::vector<char> block(room);
    const ssize_t written = ::write(fd, block.data(), block.size());
    const int problem = written < 0 ? errno : static_cast<std::size_t>(written) < block.size() ? ENOSPC : 0;
    ::close(fd);
    ::unlink(name.c_str());
    return problem;
}

/// Bitcode of LLVM whose blocks do not end where the file does. [LLVM, bitstream format: a
/// block is 2 bits "enter", 8 of its kind, 4 of its inner width, then, aligned, its length in words of 32 bits]
bool is_cut_bitcode(int fd, const struct stat& status)
{
    std::uint32_t words[2] = {};
    bool sound = ::pread(fd, words, 4, 0) == 4 && words[0] == 0xdec04342u;
    const off_t size = status.st_size;
    for (off_t at = 4; sound && at < size; at += 8 + 4 * static_cast<off_t>(words[1]))
        sound = ::pread(fd, words, 8, at) == 8 && (words[0] & 3u) == 1 && 8 + 4 * static_cast<off_t>(words[1]) <= size - at;
    return !sound;
}

/// Shorter than its header says, or no shared object at all.
bool is_cut_object(int fd, const struct stat& status)
{
    Elf64_Ehdr header{};
    if (::pread(fd, &header, sizeof header, 0) != sizeof header || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return true;
    if (header.e_ident[EI_CLASS] != ELFCLASS64) return false;
    const auto size = static_cast<std::uint64_t>(status.st_size);  // the table of sections is the last thing in it
    const std::uint64_t table = std::uint64_t{header.e_shnum} * header.e_shentsize;
    return header.e_shoff > size || table > size - header.e_shoff;
}

bool is_cut(const FilePlace& file)
{
    const std::string kind = file.path().extension().string();
    if (kind != ".so" && kind != ".bc") return false;
    const int fd = ::openat(file.start(), file.name().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    struct stat status {};
    const bool looked = fd >= 0 && ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
    const bool cut = looked && (kind == ".so" ? is_cut_object(fd, status) : is_cut_bitcode(fd, status));
    if (fd >= 0) ::close(fd);
    return cut;
}

/// PoCL writes the digits of a hash as A to P: two for a folder, the rest of its 160 bits, less those that versions leave out,
/// for one in it (37 in PoCL 3.1).
bool is_hash(const std::string& name, std::size_t least, std::size_t most)
{
    return name.size() >= least && name.size() <= most && name.find_first_not_of("ABCDEFGHIJKLMNOP") == std::string::npos;
}

constexpr int depth_of_hash = 2, depth_of_kernel = 4;  // HH/HASH, HH/HASH/KERNEL/SIZE
constexpr const char* time_stamp = "last_accessed";    // in HH/HASH

/// Whether the entry is what PoCL keeps under such a name at such a depth: a folder or a file, no link and no device, which end
/// the process.
bool is_of_pocl(const FilePlace& place, int depth)
{
    const std::string& name = place.name();
    const bool is_stamp = name == time_stamp;
    const bool is_file =
        depth == depth_of_kernel || (depth >= depth_of_hash && (name.find('.') != std::string::npos || is_stamp));
    struct stat status {};
    if (::fstatat(place.start(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return true;  // another process has removed it
    if (is_stamp && status.st_nlink > 1) return false;  // is written to where it lies, which another name of it would show
    return is_file ? S_ISREG(status.st_mode) : S_ISDIR(status.st_mode);
}

fs::path clean(const Folder& folder, int depth)
{
    for (const std::string& name : folder.names()) {
        const bool is_place = depth == 0 ? is_hash(name, 2, 2) : depth > 1 || is_hash(name, 36, 38);
        // what the compiler is still writing has another name
        if (!is_place || name.starts_with("temp")) continue;
        const FilePlace place = folder / name;
        if (!is_of_pocl(place, depth)) return place.path();
        if (depth >= depth_of_hash && is_cut(place)) (void)folder.remove(name);
        if (depth == depth_of_kernel || name.find('.') != std::string::npos || name == time_stamp) continue;
        try {
            if (fs::path odd = clean(folder.inner(name), depth + 1); !odd.empty()) return odd;
        } catch (const Error&) {  // gone, or not to be read
        }
    }
    return {};
}

/// @return what keeps PoCL from using the folder; empty: nothing
std::string fault_of_cache(const fs::path& dir)
{
    const std::string shown = printable(dir.string());
    if (const int problem = try_to_write(dir); problem != 0)
        return fmt::format("the kernel cache {} cannot be written to: {}", shown, std::strerror(problem));
    const fs::path odd = clean_kernel_cache(dir);
    if (odd.empty()) return {};
    return fmt::format("the kernel cache {} has something else in place of a kernel: {}", shown,
                       printable(odd.lexically_relative(dir).string()));
}

fs::path own_folder;

void remove_own_folder()
{
    std::error_code ignored;
    fs::remove_all(own_folder, ignored);
}

/// In the places for such things, the first that takes it.
bool make_own_folder()
{
    const char* given = std::getenv("TMPDIR");
    for (const char* place : {given, "/tmp", "/dev/shm"}) {
        if (!place || !*place) continue;
        std::string name = std::string(place) + "/seldinger-kernels-XXXXXX";
        if (!::mkdtemp(name.data())) continue;
        own_folder = name;
        if (try_to_write(own_folder) == 0) return true;
        remove_own_folder();
    }
    return false;
}

std::atomic<bool> telling = false;

/// Says so once in a process. A build that may not be said, or was, asks for nothing of the folder.
void tell()
{
    if (!telling.exchange(false)) return;
    note(fmt::format("seldinger: compiling OpenCL kernels for this processor, up to half a minute; kept in {}\n",
                     printable(kernel_cache_folder().string())));
}

/// Programs in the folder that the compiler finished at `since` or later; all without it.
/// @param found  is called with each; true: no more are wanted     @return so it was
template <class Found>
bool find_program(const fs::path& dir, const timespec* since, const Found& found)
{
    std::error_code error;
    for (fs::recursive_directory_iterator at(dir, error), end; !error && at != end; at.increment(error)) {
        if (at->path().filename() != "program.bc") continue;  // in DIR/two letters/hash of source and options
        struct stat status {};
        if (since && ::stat(at->path().c_str(), &status) != 0) continue;
        const timespec& made = status.st_mtim;
        const bool is_new =
            !since || (made.tv_sec != since->tv_sec ? made.tv_sec > since->tv_sec : made.tv_nsec >= since->tv_nsec);
        if (is_new && found(at->path())) return true;
        if (at.depth() > 1) at.pop(error);  // its kernels tell nothing more
    }
    return false;
}

bool has_program(const fs::path& dir, const timespec* since)
{
    return find_program(dir, since, [](const fs::path&) { return true; });
}

constexpr std::chrono::minutes patience{2};  // with another process that compiles: ten times as long as any program takes

FileLock turn_of(const std::string& what)
{
    const fs::path place = kernel_cache_folder() / fmt::format("seldinger-{:016x}", std::hash<std::string>()(what));
    const auto asked = std::chrono::steady_clock::now();
    try {
        return FileLock::of_file(place, patience);
    } catch (const Error&) {
        static std::atomic<bool> said = false;
        if (std::chrono::steady_clock::now() - asked >= patience && !said.exchange(true))
            note(
                fmt::format("seldinger: another process has been compiling kernels for two minutes ({}.lock names it); compiling "
                            "without it\n",
                            printable(place.string())));
        return {};
    }
}

}  // namespace

void tell_compiling(bool on) { telling = on; }

CompilerCall::CompilerCall()
{
    if (!telling) return;
    // the clock of file dates, which advances by some milliseconds at a time
    ::clock_gettime(CLOCK_REALTIME_COARSE, &begun_);
    if (!has_program(kernel_cache_folder(), nullptr)) tell();
}

CompilerCall::~CompilerCall()
{
    if (!telling || begun_.tv_sec == 0) return;
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    constexpr double shortest = 0.1;  // [s] a program that is in the cache takes half of it; no compiler takes as little
    const double took =
        static_cast<double>(now.tv_sec - begun_.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec - begun_.tv_nsec);
    if (took >= shortest && has_program(kernel_cache_folder(), &begun_)) tell();
}

CompilerTurn::CompilerTurn(const std::string& what) : lock_(turn_of(what)) {}

std::vector<fs::path> new_programs(const timespec& since, const std::string& mark)
{
    std::vector<fs::path> found;
    (void)find_program(kernel_cache_folder(), &since, [&](const fs::path& file) {
        std::ifstream in(file, std::ios::binary);
        const std::string code{std::istreambuf_iterator<char>(in), {}};
        if (code.find(mark) != std::string::npos) found.push_back(file.parent_path());
        return false;
    });
    return found;
}

void copy_kernel(const fs::path& from, const fs::path& to, const std::string& kernel)
{
    std::error_code error;
    if (!fs::is_directory(from / kernel, error) || fs::exists(to / kernel, error)) return;
    const fs::path half = to / fmt::format("temp-{}", ::getpid());  // the check of the cache passes such a name over
    fs::copy(from / kernel, half, fs::copy_options::recursive, error);
    if (!error) fs::rename(half, to / kernel, error);
    if (error) fs::remove_all(half, error);  // it is compiled, then
}

fs::path kernel_cache_folder()
{
    const auto variable = [](const char* name) -> std::string {
        const char* value = std::getenv(name);
        return value ? value : "";
    };
    if (const std::string given = variable("POCL_CACHE_DIR"); !given.empty()) return given;
    if (const std::string caches = variable("XDG_CACHE_HOME"); !caches.empty()) return fs::path(caches) / "pocl/kcache";
    const std::string home = variable("HOME");
    return home.empty() ? fs::path("/tmp/pocl/kcache") : fs::path(home) / ".cache/pocl/kcache";
}

std::string kernel_cache_advice()
{
    return fmt::format(
        "if the disk is full or the kernel cache {} is damaged: delete that folder, or set "
        "POCL_CACHE_DIR to another one",
        printable(kernel_cache_folder().string()));
}

fs::path clean_kernel_cache(const fs::path& dir)
{
    try {
        return clean(Folder(dir), 0);
    } catch (const Error&) {  // not there, or not to be read: PoCL says so
        return {};
    }
}

void prepare_kernel_cache()
{
    // to everybody but PoCL 3.1 an empty one is none
    if (const char* given = std::getenv("POCL_CACHE_DIR"); given && !*given) ::unsetenv("POCL_CACHE_DIR");
    fs::path dir = kernel_cache_folder();
    if (dir.is_relative()) {  // PoCL's linker takes a name that begins with - for an option
        dir = fs::absolute(dir);
        ::setenv("POCL_CACHE_DIR", dir.c_str(), 1);
    }
    const std::string fault = fault_of_cache(dir);
    if (fault.empty()) return;
    if (!make_own_folder()) {
        note(fmt::format("seldinger: {}; set POCL_CACHE_DIR to another folder\n", fault));
        return;
    }
    ::setenv("POCL_CACHE_DIR", own_folder.c_str(), 1);
    std::atexit(remove_own_folder);
    note(fmt::format("seldinger: {}; kernels are built anew, for this run alone; set POCL_CACHE_DIR to another folder\n", fault));
}

}  // namespace seldinger::device

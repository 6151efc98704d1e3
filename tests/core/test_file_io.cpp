// Files that are never half written, and tables that can be cut back to a checkpoint.
#include "core/error.h"
#include "core/file_io.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>

#include <sys/resource.h>
#include <csignal>
#include <fstream>

namespace seldinger::test::test_file_io {

namespace {

/// While it lives, no file of this process may grow beyond `bytes`: what a full disk looks like to write().
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN))
    {
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit()
    {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit old_{};
    void (*handler_)(int);
};

template <class Action>
ErrorKind code_of(const Action& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::None;
}

}  // namespace

TEST_SUITE("core/file_io")
{
    TEST_CASE("property: a file is replaced whole, and no temporary stays")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "a.txt";
        write_file(path, "first");
        write_file(path, std::string("sec\0ond", 7), Durable::Yes);
        CHECK(read_file(path) == std::string("sec\0ond", 7));
        CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
    }

    TEST_CASE("property: what cannot be written is an error, and the old file stays")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "a.txt";
        write_file(path, "old");
        {
            const FileSizeLimit full(1000);
            CHECK(code_of([&] { write_file(path, std::string(5000, 'x')); }) == ErrorKind::BadFile);
        }
        CHECK(read_file(path) == "old");
        CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
        CHECK(code_of([&] { write_file(path / "below-a-file", "x"); }) == ErrorKind::BadFile);
        CHECK(code_of([&] { make_folder(path); }) == ErrorKind::BadFile);
        CHECK(code_of([&] { make_folder(path / "sub"); }) == ErrorKind::BadFile);
        CHECK(code_of([&] { (void)read_file(folder.path()); }) == ErrorKind::BadFile);
        CHECK(code_of([&] { (void)read_file(folder.path() / "none"); }) == ErrorKind::BadFile);
    }

    TEST_CASE("property: a table keeps whole rows when the disk fills up")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "trace.csv";
        AppendFile table(path, 0);
        table.append("step,time_s\n");
        {
            const FileSizeLimit full(30);
            table.append("1,0.1\n");
            CHECK(code_of([&] { table.append("2,0.200000000000000000001\n"); }) == ErrorKind::BadFile);
        }
        CHECK(read_file(path) == "step,time_s\n1,0.1\n");
        table.append("2,0.2\n");  // space again
        CHECK(read_file(path) == "step,time_s\n1,0.1\n2,0.2\n");
        CHECK(table.size() == 24);
    }

    TEST_CASE("property: a table goes on behind its checkpoint")
    {
        const TemporaryFolder folder;
        const auto path = folder.path() / "trace.csv";
        std::ofstream(path) << "head\nrow 1\nrow 2\nhalf a r";
        AppendFile table(path, 11);
        table.append("row 2 again\n");
        CHECK(read_file(path) == "head\nrow 1\nrow 2 again\n");
        CHECK(code_of([&] { AppendFile(path, 1000); }) == ErrorKind::BadFile);  // shorter than the checkpoint says
        CHECK(read_file(path) == "head\nrow 1\nrow 2 again\n");
    }
}

}  // namespace seldinger::test::test_file_io

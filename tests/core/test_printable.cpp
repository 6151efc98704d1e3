// Text from files on its way to a terminal.
#include "core/error.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <sys/stat.h>

namespace seldinger::test::test_printable {

namespace {

std::string reason_of(const std::filesystem::path& path)
{
    return refusal([&] { return read_file(path); }, ErrorKind::BadFile);
}

}  // namespace

TEST_SUITE("core/printable")
{
    TEST_CASE("property: a long word gives way to what is said of it, and is cut between characters")
    {
        CHECK(with_short_words("a b\nc", 64) == "a b\nc");
        const std::string word(64, 'w');
        CHECK(with_short_words(word + " is short", 64) == word + " is short");
        const std::string said = with_short_words("x " + std::string(1'000'000, 'w') + " is long", 100);
        CHECK(said.size() <= 2 + 100 + 8);
        CHECK(said.starts_with("x www"));
        CHECK(said.ends_with("www is long"));
        CHECK(has(said, "1000000"));
        std::string wide;
        for (int k = 0; k < 500; ++k) wide += "\xe8\xa1\x80";
        for (std::size_t most = 64; most < 70; ++most)  // every place of a cut in a character of three bytes
            CHECK(printable(with_short_words(wide, most)).find('?') == std::string::npos);
    }

    TEST_CASE("property: what a terminal would obey is shown as a question mark, what can be read stays")
    {
        CHECK(printable("aorta 5 mm\n\"f\"") == "aorta 5 mm\n\"f\"");
        CHECK(printable("\x1b[31mred\x07\r\b") == "?[31mred???");
        CHECK(printable("a\tb") == "a b");
        CHECK(printable("Gef\xc3\xa4\xc3\x9f \xe8\xa1\x80\xe7\xae\xa1") == "Gef\xc3\xa4\xc3\x9f \xe8\xa1\x80\xe7\xae\xa1");
        CHECK(printable("\xc2\x9b"
                        "31m") == "?31m");  // the one-character form of ESC [
        CHECK(printable("a\xe2\x80\xae"
                        "b") == "a?b");             // writing turned round
        CHECK(printable("\xff\xc3") == "??");       // no UTF-8, and cut short
        CHECK(printable("\xc0\x8a") == "??");       // a line's end, written too long
        CHECK(printable("\xed\xa0\x80") == "???");  // half of a pair
        CHECK(printable(std::string("a\0b", 3)) == "a?b");
    }

    TEST_CASE("property: every error is printable, whoever made it")
    {
        CHECK(std::string(Error(ErrorKind::BadFile, "x\x1b]0;owned\x07.vtk").what()) == "x?]0;owned?.vtk");
    }

    TEST_CASE("property: pipes and devices are refused at once, with or without a writer")
    {
        const TemporaryFolder folder;
        const auto pipe = folder.path() / "pipe.stl";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        CHECK(has(reason_of(pipe), "a pipe or a device"));
        CHECK(has(reason_of("/dev/zero"), "a pipe or a device"));
        CHECK(has(reason_of(folder.path()), "directory"));
    }
}

}  // namespace seldinger::test::test_printable

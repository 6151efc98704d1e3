// Every source file opens with a line that says its purpose, so that a listing of first lines is a map of the project.

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace test_first_lines {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t shortest = 20;  // characters of a line that says something

/// The comment with which a file opens: its first line but for `#pragma once`, an include guard and `#!`.
std::string opening_comment(const fs::path& file)
{
    std::ifstream in(file);
    std::string line;
    while (std::getline(in, line))
        if (!line.starts_with("#pragma once") && !line.starts_with("#ifndef") && !line.starts_with("#define") &&
            !line.starts_with("#!"))
            break;
    for (const std::string mark : {"//", "/*", "\"\"\"", "# "})
        if (line.starts_with(mark)) return line.substr(mark.size());
    return "";
}

}  // namespace

TEST_SUITE("core/first_lines")
{
    TEST_CASE("property: every source file opens with a comment that says what it is for")
    {
        const fs::path root = SEL_SOURCE_DIR;
        int seen = 0;
        for (const char* folder : {"engine", "kernels", "apps", "tests", "bench", "assets"})
            for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
                const std::string extension = entry.path().extension();
                if (extension != ".h" && extension != ".cpp" && extension != ".cl" && extension != ".py") continue;
                ++seen;
                const std::string name = fs::relative(entry.path(), root).generic_string();
                const bool has = opening_comment(entry.path()).size() >= shortest;
                CHECK_MESSAGE(has, name << " does not say what it is for");
            }
        REQUIRE(seen > 300);
    }
}

}  // namespace test_first_lines

// Every source file opens with a line that says its purpose, so that a listing of first lines is a map of the project; and the
// files that comments name exist.

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
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

const char* const folders[] = {"engine", "kernels", "apps", "tests", "bench", "assets"};

/// Each file's path, and all that it ends with: "engine/base/core/check.h", "base/core/check.h" ... "check.h".
std::set<std::string> names_of_files(const fs::path& root)
{
    std::set<std::string> names;
    const auto add = [&](const fs::path& file) {
        std::string name = fs::relative(file, root).generic_string();
        for (names.insert(name); name.find('/') != std::string::npos; names.insert(name)) name.erase(0, name.find('/') + 1);
    };
    for (const char* folder :
         {"engine", "kernels", "apps", "tests", "bench", "assets", "docs", "python", "examples", "cmake", "packaging"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.is_regular_file()) add(entry.path());
    for (const auto& entry : fs::directory_iterator(root))
        if (entry.is_regular_file()) add(entry.path());
    return names;
}

}  // namespace

TEST_SUITE("core/first_lines")
{
    TEST_CASE("property: every source file opens with a comment that says what it is for")
    {
        const fs::path root = SEL_SOURCE_DIR;
        int seen = 0;
        for (const char* folder : folders)
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

    TEST_CASE("property: every file that a comment names is there")
    {
        const fs::path root = SEL_SOURCE_DIR;
        const std::set<std::string> names = names_of_files(root);
        const std::regex name(R"((^|[^\w./*-])(\w[\w/-]*\.(h|cpp|cl|py|md|cmake))(?![\w.]))");
        int seen = 0;
        for (const char* folder : folders)
            for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
                const std::string extension = entry.path().extension();
                if (extension != ".h" && extension != ".cpp" && extension != ".cl") continue;
                std::ifstream in(entry.path());
                for (std::string line; std::getline(in, line);) {
                    const std::size_t comment = line.find("//");
                    if (comment == std::string::npos || line.find("#include") != std::string::npos) continue;
                    const std::string text = line.substr(comment + 2);
                    if (text.find('.') == std::string::npos) continue;
                    for (auto match = std::sregex_iterator(text.begin(), text.end(), name); match != std::sregex_iterator();
                         ++match) {
                        ++seen;
                        CHECK_MESSAGE(names.count((*match)[2]) == 1, fs::relative(entry.path(), root).generic_string()
                                                                         << " names " << (*match)[2].str()
                                                                         << ", which is not there");
                    }
                }
            }
        REQUIRE(seen > 300);
    }
}

}  // namespace test_first_lines

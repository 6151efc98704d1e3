// budget.txt: what the project may be in size. A count above its number fails; raising a number takes a reason in that file.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace test_budget {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t least_reason = 40;   // characters of a reason
constexpr std::size_t widest_line = 130;   // characters of a line of C++

struct Allowed {
    long most = 0;
    std::vector<std::string> reasons;  // of each raise
};

std::string trimmed(const std::string& text)
{
    const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Rows "count = number"; below one, "+ number: reason" raises it.
/// @param mistakes  lines that are neither, or whose reason is none
std::map<std::string, Allowed> read_budget(std::istream& in, std::vector<std::string>& mistakes)
{
    static const std::regex row(R"(^([^=+#][^=]*)=\s*(\d+)$)"), raise(R"(^\+\s*(\d+):\s*(.*)$)");
    std::map<std::string, Allowed> budget;
    Allowed* last = nullptr;
    for (std::string line; std::getline(in, line);) {
        line = trimmed(line);
        std::smatch match;
        if (line.empty() || line.front() == '#') continue;
        if (std::regex_match(line, match, row)) {
            const std::string name = trimmed(match[1]);
            if (budget.count(name)) mistakes.push_back("given twice: " + line);
            last = &budget[name];
            last->most = std::stol(match[2]);
        } else if (last && std::regex_match(line, match, raise) && match[2].length() >= static_cast<long>(least_reason)) {
            last->most += std::stol(match[1]);
            last->reasons.push_back(match[2]);
        } else {
            mistakes.push_back("neither \"count = number\" nor \"+ number: reason of " + std::to_string(least_reason) +
                               " characters\": " + line);
        }
    }
    return budget;
}

bool is_cpp(const fs::path& file)
{
    static const std::set<std::string> extensions = {".h", ".cpp", ".cl"};
    return extensions.count(file.extension()) > 0;
}

bool is_source(const fs::path& file) { return is_cpp(file) || file.extension() == ".py" || file.extension() == ".sh"; }

/// Calls `use` with each line of each file below `folder` that `chosen` names.
void for_each_line(const fs::path& folder, const std::function<bool(const fs::path&)>& chosen,
                   const std::function<void(const fs::path&, const std::string&)>& use)
{
    for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator(); ++entry) {
        if (entry->path().filename() == "__pycache__") entry.disable_recursion_pending();
        if (!entry->is_regular_file() || !chosen(entry->path())) continue;
        std::ifstream in(entry->path());
        for (std::string line; std::getline(in, line);) use(entry->path(), line);
    }
}

long lines_below(const fs::path& folder)
{
    long lines = 0;
    for_each_line(folder, is_source, [&](const fs::path&, const std::string&) { ++lines; });
    return lines;
}

long words_below(const fs::path& folder)
{
    long words = 0;
    for_each_line(folder, [](const fs::path& file) { return file.extension() == ".md"; },
                  [&](const fs::path&, const std::string& line) {
                      std::istringstream in(line);
                      for (std::string word; in >> word;) ++words;
                  });
    return words;
}

/// Lines of comment with which the header opens.
long opening_lines(const fs::path& header)
{
    std::ifstream in(header);
    long lines = 0;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("//")) ++lines;
        else if (!line.starts_with("#pragma once") && !line.starts_with("#ifndef") && !line.starts_with("#define")) break;
    }
    return lines;
}

/// Lines of opening comments beyond `most` lines, in all headers of the engine and the kernels.
long prose_beyond(const fs::path& root, long most)
{
    long beyond = 0;
    for (const char* folder : {"engine", "kernels"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.path().extension() == ".h") beyond += std::max(0L, opening_lines(entry.path()) - most);
    return beyond;
}

/// Characters, not bytes: continuation bytes of UTF-8 do not count.
std::size_t width(const std::string& line)
{
    return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

long wide_lines(const fs::path& root)
{
    long wide = 0;
    for (const char* folder : {"engine", "kernels", "apps", "tests", "bench", "python"})
        for_each_line(root / folder, is_cpp,
                      [&](const fs::path&, const std::string& line) { wide += width(line) > widest_line; });
    return wide;
}

long virtual_functions(const fs::path& header)
{
    std::ifstream in(header);
    long count = 0;
    for (std::string line; std::getline(in, line);)
        count +=
            line.find("virtual ") != std::string::npos && line.find('~') == std::string::npos && !trimmed(line).starts_with("//");
    return count;
}

long folders_in(const fs::path& folder)
{
    return std::count_if(fs::directory_iterator(folder), fs::directory_iterator(),
                         [](const auto& entry) { return entry.is_directory(); });
}

std::map<std::string, long> counted(const fs::path& root)
{
    const fs::path engine = root / "engine";
    std::map<std::string, long> counts;
    for (const char* room : {"base", "bodies", "physics", "files", "include", "elastic", "pictures", "studies", "live"})
        counts[std::string("lines of engine/") + room] = lines_below(engine / room);
    for (const char* folder : {"kernels", "apps", "tests", "bench", "python"})
        counts[std::string("lines of ") + folder] = lines_below(root / folder);
    counts["words of docs"] = words_below(root / "docs");
    counts["folders in engine"] = folders_in(engine);
    counts["virtual functions of ForceTerm"] = virtual_functions(engine / "physics/solve/force_term.h");
    counts["lines of headers' opening comments beyond 25"] = prose_beyond(root, 25);
    counts["C++ lines of more than 130 characters"] = wide_lines(root);
    return counts;
}

}  // namespace

TEST_SUITE("core/budget")
{
    TEST_CASE("property: nothing is larger than budget.txt allows, and the budget has a row for each count")
    {
        const fs::path root = SEL_SOURCE_DIR;
        std::ifstream in(root / "budget.txt");
        REQUIRE(in.good());
        std::vector<std::string> mistakes;
        const auto budget = read_budget(in, mistakes);
        for (const std::string& mistake : mistakes) FAIL_CHECK("budget.txt: " << mistake);
        const auto counts = counted(root);
        for (const auto& [name, count] : counts) {
            const auto row = budget.find(name);
            if (row == budget.end()) FAIL_CHECK("budget.txt has no row for " << name << ", which is " << count);
            else
                CHECK_MESSAGE(count <= row->second.most,
                              name << ": got " << count << "; expected " << row->second.most
                                   << " at most. Fix: take something out, or give a reason in budget.txt.");
        }
        for (const auto& [name, allowed] : budget)
            CHECK_MESSAGE(counts.count(name) == 1, "budget.txt: nothing is counted as " << name);
        CHECK(counts.at("lines of engine/physics") > 10000);  // it has looked
    }

    TEST_CASE("property: a budget is raised with a reason, and by nothing else")
    {
        std::vector<std::string> mistakes;
        std::istringstream raised(
            "# sizes\nlines of kernels = 100\n+ 20: Contact with a distance field has its own kernel since then.\n");
        const auto budget = read_budget(raised, mistakes);
        CHECK(mistakes.empty());
        CHECK(budget.at("lines of kernels").most == 120);
        for (const char* wrong : {"lines = 100\n+ 20: why not\n", "lines = 100\n+ 20\n", "lines = many\n",
                                  "+ 20: A reason without any row that it belongs to, here.\n", "lines = 100\nlines = 200\n"}) {
            CAPTURE(wrong);
            mistakes.clear();
            std::istringstream in(wrong);
            (void)read_budget(in, mistakes);
            CHECK(mistakes.size() == 1);
        }
    }

    TEST_CASE("property: words, opening comments and widths are counted as they are")
    {
        CHECK(width("ab\u00e9") == 3);
        CHECK(trimmed("  a b \t") == "a b");
        CHECK(opening_lines(fs::path(SEL_SOURCE_DIR) / "engine/base/core/check.h") >= 1);
        CHECK(virtual_functions(fs::path(SEL_SOURCE_DIR) / "engine/physics/solve/force_term.h") >= 4);
    }
}

}  // namespace test_budget

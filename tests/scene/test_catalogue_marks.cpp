// Every value of the catalogue says where it comes from.
#include "scene/instruments.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger::test::test_catalogue_marks {

namespace {

/// Whether a line of a file needs no mark, or has one: `key = value  # measured: ...`.
bool is_marked(std::string_view line)
{
    const auto equals = line.find(" = ");
    if (line.empty() || line.front() == '#' || line.front() == '[' || line.starts_with("title") || line.starts_with("kind") ||
        equals == std::string_view::npos)
        return true;
    const auto comment = line.find("  # ", equals);
    if (comment == std::string_view::npos) return false;
    constexpr std::array<std::string_view, 4> marks = {"measured: ", "derived: ", "assumed: ", "assumed"};
    const std::string_view said = line.substr(comment + 4);
    return std::ranges::any_of(marks,
                               [&](std::string_view mark) { return mark == "assumed" ? said == mark : said.starts_with(mark); });
}

}  // namespace

TEST_SUITE("scene/instruments")
{
    TEST_CASE("property: every value of the catalogue is marked as measured, derived or assumed")
    {
        CHECK(is_marked("bend_nm2 = 1.85e-3  # measured: 60.3 GPa"));
        CHECK_FALSE(is_marked("bend_nm2 = 1.85e-3"));
        CHECK_FALSE(is_marked("bend_nm2 = 1.85e-3  # 60.3 GPa"));
        const std::vector<std::string> names = instrument_names();
        REQUIRE(names.size() >= 13);
        for (const std::string& name : names) {
            std::ifstream file(std::filesystem::path(SEL_SOURCE_DIR) / "assets/instruments" / (name + ".toml"));
            REQUIRE(file);
            int values = 0;
            for (std::string line; std::getline(file, line);) {
                CAPTURE(name);
                CAPTURE(line);
                CHECK(is_marked(line));
                values += line.find(" = ") != std::string::npos && line.front() != '#';
            }
            CHECK(values >= 8);  // lines were read
        }
    }
}

}  // namespace seldinger::test::test_catalogue_marks

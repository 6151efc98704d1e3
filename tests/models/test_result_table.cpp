// The table with which a stopped study continues.

#include "models/result_table.h"

#include "core/error.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace seldinger::test::test_result_table {

TEST_SUITE("models/result_table")
{
    const std::vector<std::string> columns = {"scene", "model", "wall_s"};

    TEST_CASE("property: what was written is found again; a row with the same keys supersedes the old one")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "table.csv";
        {
            ResultTable table(file, columns, 2);
            CHECK(table.find({"a", "x"}) == nullptr);
            table.append({"a", "x, \"quoted\"", csv_number(0.1)});
            table.append({"a", "y", csv_number(std::nan(""))});
            table.append({"a", "y", csv_number(1.0 / 3)});
        }
        const ResultTable again(file, columns, 2);
        REQUIRE(again.rows().size() == 2);
        REQUIRE(again.find({"a", "x, \"quoted\""}));
        CHECK(number_in(again.find({"a", "x, \"quoted\""})->at(2)) == 0.1);
        CHECK(number_in(again.find({"a", "y"})->at(2)) == 1.0 / 3);
        CHECK(std::isnan(number_in("")));
    }

    TEST_CASE("property: a count that cannot be one is none")
    {
        CHECK(count_in("41.0") == 41);
        CHECK(count_in("2147483647") == 2147483647);
        for (const char* text : {"", "nan", "inf", "-1", "2147483648", "1e300", "x"}) {
            CAPTURE(text);
            CHECK(count_in(text) == 0);
        }
    }

    TEST_CASE("property: a table cut off anywhere keeps its whole rows and goes on")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "table.csv";
        {
            ResultTable(file, columns, 2).append({"a", "x", "1"});
        }
        const auto one_row = std::filesystem::file_size(file);
        {
            ResultTable(file, columns, 2).append({"b", "y", "2"});
        }
        const auto two_rows = std::filesystem::file_size(file);
        for (auto cut = one_row; cut <= two_rows; ++cut) {
            CAPTURE(cut);
            const auto copy = folder.path() / "cut.csv";
            std::filesystem::copy_file(file, copy, std::filesystem::copy_options::overwrite_existing);
            std::filesystem::resize_file(copy, cut);
            {
                ResultTable(copy, columns, 2).append({"c", "z", "3"});
            }
            const ResultTable again(copy, columns, 2);
            CHECK(again.find({"a", "x"}) != nullptr);
            CHECK((again.find({"b", "y"}) != nullptr) == (cut == two_rows));
            REQUIRE(again.find({"c", "z"}) != nullptr);
            CHECK(again.rows().size() == (cut == two_rows ? 3 : 2));
        }
    }

    TEST_CASE("property: a table with other columns is refused, not overwritten")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "table.csv";
        std::ofstream(file) << "something,else\n1,2\n";
        CHECK_THROWS_WITH_AS(ResultTable(file, columns, 2), doctest::Contains("choose another folder"), Error);
        CHECK(std::filesystem::file_size(file) == 19);
    }
}

}  // namespace seldinger::test::test_result_table

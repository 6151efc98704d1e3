// engine/studies/batch/farm.cpp: a farm's plan and results that were altered, and sealed anew, are refused in one line.

#include "core/error.h"
#include "core/file_io.h"
#include "batch/farm.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>

namespace test_farm_files {

using namespace seldinger;

namespace {

FarmPlan small_plan()
{
    FarmPlan plan;
    plan.source = "/s.toml";
    plan.sweep = "v.toml";
    plan.items = 5;
    plan.tasks = 2;
    plan.key = "0123456789abcdef";
    return plan;
}

/// Results of task 1, which has runs 2 to 4.
std::vector<BatchRow> rows_of_task()
{
    std::vector<BatchRow> rows(3);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].run = static_cast<std::int64_t>(k + 2), rows[k].state_hash.fill('a'), rows[k].instruments.resize(2), rows[k].shape.resize(2 * 3 * BatchRow::stations);
    return rows;
}

std::string refusal(const std::function<void()>& call)
{
    try {
        call();
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::BadFile);
        CHECK(std::string(error.what()).find('\n') == std::string::npos);
        return error.what();
    }
    return {};
}

}  // namespace

TEST_SUITE("batch/farm files")
{
    TEST_CASE("property: a plan of more tasks than can be is refused before anything is made for them")
    {
        const TemporaryFolder folder;
        write_farm(folder.path(), small_plan());
        const std::string good = read_file(folder.path() / "farm.json");
        CHECK(refusal([&] { (void)read_farm(folder.path()); }).empty());
        for (const char* key : {"runs", "tasks"})
            for (const char* count : {"1000000000000000000", "-1", "1e300", "0", "2.5", "[]"}) {
                CAPTURE(key);
                CAPTURE(count);
                const std::string start = std::string("\"") + key + "\": ";
                const std::size_t at = good.find(start) + start.size();
                write_file(folder.path() / "farm.json", std::string(good).replace(at, 1, count));
                CHECK(refusal([&] { (void)read_farm(folder.path()); }).find("make") != std::string::npos);
            }
    }

    TEST_CASE("property: results that no run can have are refused")
    {
        const TemporaryFolder folder;
        const FarmPlan plan = small_plan();
        write_farm(folder.path(), plan);
        const auto said = [&](const std::function<void(std::vector<BatchRow>&)>& change) {
            std::vector<BatchRow> rows = rows_of_task();
            change(rows);
            write_rows(folder.path(), plan, 1, rows);
            return refusal([&] {
                const auto read = read_rows(folder.path(), plan, 1, 2);
                CHECK(read->size() == 3);
            });
        };
        CHECK(said([](auto&) {}).empty());
        CHECK(said([](auto& rows) { rows[0].numbers[1] = std::numeric_limits<double>::quiet_NaN(); }).empty());  // an empty field
        const std::function<void(std::vector<BatchRow>&)> wrong[] = {
            [](auto& rows) { rows[0].run = 1; },
            [](auto& rows) { rows[0].run = -2; },
            [](auto& rows) { rows[0].run = 5; },
            [](auto& rows) { rows[0].run = 3; },  // twice
            [](auto& rows) { rows[1].status = static_cast<RunStatus>(77); },
            [](auto& rows) { rows[1].status = RunStatus::Running; },
            [](auto& rows) { rows[2].state_hash[3] = '\n'; },
            [](auto& rows) { rows[2].numbers[0] = 1e300; },
            [](auto& rows) { rows[2].instruments[1][2] = 1e300; },
            [](auto& rows) { rows[0].instruments.pop_back(); },
            [](auto& rows) { rows[1].instruments.resize(3); },
            [](auto& rows) { rows.pop_back(); },
            [](auto& rows) { rows[1].shape.pop_back(); },
            [](auto& rows) { rows[1].shape[7] = std::numeric_limits<float>::infinity(); },
        };
        for (const auto& change : wrong) CHECK(said(change).find("a value is out of range") != std::string::npos);
        // a farm whose key is longer than the file: the line names the file
        (void)said([](auto&) {});
        FarmPlan other = plan;
        other.key = std::string(100'000, 'a');
        CHECK(refusal([&] { (void)read_rows(folder.path(), other, 1, 2); }).find("000001.rows: is of another farm") != std::string::npos);
    }
}

}  // namespace test_farm_files

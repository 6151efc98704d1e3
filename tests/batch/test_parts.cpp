// engine/studies/batch/parts.cpp, batch_saved.cpp: a plan and parts that were altered, and sealed anew, are refused in one line.

#include "batch/parts.h"
#include "core/error.h"
#include "core/file_io.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <limits>
#include <string>

namespace seldinger::test::test_parts {

namespace {

PartPlan small_plan(bool frames = false)
{
    PartPlan plan;
    plan.frames = frames;
    plan.items = 5, plan.parts = 2;
    plan.key = "0123456789abcdef";
    if (frames) plan.first = 3, plan.rate = 15, plan.files = {"frame_######.png"};
    return plan;
}

/// Part 2, which has runs 2 to 4.
SavedBatch whole_part()
{
    SavedBatch saved;
    saved.scene = "0123456789abcdef", saved.name = "two", saved.device = "host";
    saved.layout.instruments = {"catheter", "wire"}, saved.layout.runs = 5;
    saved.instruments = 2, saved.begin = 2, saved.end = 5;
    saved.status = RunStatus::Done;
    saved.rows.resize(3);
    for (std::size_t k = 0; k < saved.rows.size(); ++k) {
        BatchRow& row = saved.rows[k];
        row.run = static_cast<std::int64_t>(k + 2), row.state_hash.fill('a');
        row.instruments.resize(2), row.shape.resize(2 * 3 * BatchRow::stations);
    }
    return saved;
}

std::string refusal(const auto& call) { return test::refusal(call, ErrorKind::BadFile); }

}  // namespace

TEST_SUITE("batch/parts")
{
    TEST_CASE("property: a plan of more than can be, or of files elsewhere, is refused before anything is made for it")
    {
        const TemporaryFolder folder;
        const auto said_of = [&](const PartPlan& plan, const std::string& key, const std::string& value) {
            std::filesystem::remove(folder.path() / "parts.json");
            write_plan(folder.path(), plan);
            CHECK(refusal([&] { (void)read_plan(folder.path()); }).empty());
            CHECK(read_plan(folder.path()).range(2).begin == 2);
            nlohmann::ordered_json altered = nlohmann::ordered_json::parse(read_file(folder.path() / "parts.json"));
            altered.at(key) = nlohmann::ordered_json::parse(value);
            write_file(folder.path() / "parts.json", altered.dump());
            return refusal([&] { (void)read_plan(folder.path()); });
        };
        for (const char* key : {"runs", "parts"})
            for (const char* value : {"1000000000000000000", "-1", "1e300", "0", "2.5", "[]", "null"}) {
                CAPTURE(key);
                CAPTURE(value);
                CHECK(has(said_of(small_plan(), key, value), "Fix: begin again"));
            }
        for (const char* value : {"1e-9", "-3", "1e300", "\"15\""}) CHECK(has(said_of(small_plan(true), "rate", value), "Fix: "));
        for (const char* value : {"[\"../written\"]", "[\"/written\"]", "[]", "[3]", "[\"a\", \"b/../../c\"]"})
            CHECK(has(said_of(small_plan(true), "files", value), "Fix: "));
        CHECK(has(said_of(small_plan(true), "first", "4000000000"), "first is out of range"));
    }

    TEST_CASE("property: parts that no batch can have are refused, and count as not there")
    {
        const TemporaryFolder folder;
        const PartPlan plan = small_plan();
        const auto said = [&](const std::function<void(SavedBatch&)>& change) {
            SavedBatch saved = whole_part();
            change(saved);
            write_saved(part_file(folder.path(), plan, 2), saved);
            const std::string text = refusal([&] { (void)read_part(folder.path(), plan, 2); });
            CHECK(is_done(folder.path(), plan, 2) == text.empty());
            return text;
        };
        CHECK_FALSE(is_done(folder.path(), plan, 2));
        CHECK(said([](auto&) {}).empty());
        CHECK(read_part(folder.path(), plan, 2)->layout.instruments == std::vector<std::string>{"catheter", "wire"});
        CHECK_FALSE(read_part(folder.path(), plan, 1));
        CHECK(said([](auto& saved) {
                  saved.rows[0].numbers[1] = std::numeric_limits<double>::quiet_NaN();
              }).empty());  // an empty field
        const std::function<void(SavedBatch&)> wrong[] = {
            [](auto& saved) { saved.rows[0].run = 1; },
            [](auto& saved) { saved.rows[0].run = -2; },
            [](auto& saved) { saved.rows[0].run = 5; },
            [](auto& saved) { saved.rows[0].run = 3; },  // twice
            [](auto& saved) { saved.rows[1].status = static_cast<RunStatus>(77); },
            [](auto& saved) { saved.rows[1].status = RunStatus::Running; },
            [](auto& saved) { saved.rows[2].state_hash[3] = '\n'; },
            [](auto& saved) { saved.rows[2].numbers[0] = 1e300; },
            [](auto& saved) { saved.rows[2].instruments[1][2] = 1e300; },
            [](auto& saved) { saved.rows[0].instruments.pop_back(); },
            [](auto& saved) { saved.rows[1].instruments.resize(3); },
            [](auto& saved) { saved.rows.pop_back(); },  // of a batch that says that it is done
            [](auto& saved) { saved.rows[1].shape.pop_back(); },
            [](auto& saved) { saved.rows[1].shape[7] = std::numeric_limits<float>::infinity(); },
            [](auto& saved) { saved.layout.instruments.emplace_back("sheath"); },
            [](auto& saved) { saved.begin = 6; },
            [](auto& saved) { saved.end = std::uint64_t{1} << 60; },
            [](auto& saved) { saved.status = static_cast<RunStatus>(-1); },
            [](auto& saved) { saved.totals.wall = -1; },
            [](auto& saved) { saved.totals.stages.solve = std::numeric_limits<double>::quiet_NaN(); },
        };
        for (const auto& change : wrong) CHECK(has(said(change), "a value is out of range"));
        for (const std::function<void(SavedBatch&)>& change : std::initializer_list<std::function<void(SavedBatch&)>>{
                 [](auto& saved) { saved.scene = std::string(100'000, 'a'); }, [](auto& saved) { saved.begin = 1; },
                 [](auto& saved) { saved.end = 6; }})
            CHECK(said([&](auto& saved) {
                      saved.status = RunStatus::Running, change(saved);
                  }).find("2-of-2.bin: is a part of another batch") != std::string::npos);
    }
}

}  // namespace seldinger::test::test_parts

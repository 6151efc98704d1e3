// The real `seldinger report`: what a page holds of a run with several instruments, merged or a rod each, and of a batch of them.

#include "apps/app_fixture.h"
#include "support/approx.h"
#include "support/skip.h"

#include <array>
#include <cmath>
#include <cstring>

namespace seldinger::test::test_report_command {

namespace {

bool has_three() { return fs::exists("/usr/share/javascript/three/three.min.js"); }

nlohmann::json data_of(const std::string& page)
{
    const std::string before = "<script type=\"application/json\" id=\"data\">";
    const std::size_t at = page.find(before);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = at + before.size();
    return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

std::vector<float> floats_of(const std::string& base64)
{
    static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned word = 0, bits = 0;
    for (const char c : base64) {
        if (c == '=') break;
        word = word << 6 | static_cast<unsigned>(digits.find(c));
        if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255);
    }
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
    return values;
}

/// Columns x_m, y_m, z_m of the final nodes of an instrument, tip first.
std::vector<std::array<double, 3>> nodes_in(const fs::path& csv)
{
    std::vector<std::array<double, 3>> nodes;
    for (const Row& row : table_rows(csv))
        nodes.push_back({std::stod(row.at("x_m")), std::stod(row.at("y_m")), std::stod(row.at("z_m"))});
    return nodes;
}

}  // namespace

TEST_SUITE("apps/report")
{
    TEST_CASE("property: every instrument of a run is played back, with its own nodes and its own trace, merged or a rod each")
    {
        if (!has_three()) return skip("libjs-three is not installed");
        for (const std::string model : {"merged", "separate"}) {
            CAPTURE(model);
            const ScratchFolder folder{{"two.toml", two_instruments(model)}};
            run_ok(folder, "run two.toml -o D --quiet");
            run_ok(folder, "report D");
            const auto data = data_of(slurp(folder.path / "D/report.html"));
            const auto& playback = data["playback"];
            REQUIRE(playback["instruments"].size() == 2);
            const double radius[] = {0.001, 0.0005};
            std::vector<float> last[2];
            for (std::size_t k = 0; k < 2; ++k) {
                const std::string name = k ? "wire" : "catheter";
                CAPTURE(name);
                CHECK(playback["instruments"][k]["name"] == name);
                CHECK(playback["instruments"][k]["radius"].get<double>() == about(radius[k]));
                for (const auto& frame : playback["frames"]) REQUIRE(frame["nodes"].size() == 2);
                last[k] = floats_of(playback["frames"].back()["nodes"][k]);
                const auto nodes = nodes_in(folder.path / "D" / (name + ".csv"));
                REQUIRE(last[k].size() == 4 * nodes.size());
                for (std::size_t i = 0; i < nodes.size(); ++i)
                    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(last[k][4 * i + c] - nodes[i][c]) < 1e-7);
                const auto& inserted = data["traces"][k]["inserted_m"];
                CHECK(inserted.back().get<double>() - inserted.front().get<double>() > (k ? 0.006 : 0.003) * 0.9);
            }
            CHECK(last[1][0] > last[0][0] + 0.005f);  // the wire's tip is ahead
        }
    }

    TEST_CASE("property: one instrument has no traces of its own beside the run's, and contact forces come with its nodes")
    {
        if (!has_three()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        run_ok(folder, "run t.toml -o D --quiet");
        run_ok(folder, "report D");
        const auto data = data_of(slurp(folder.path / "D/report.html"));
        CHECK(data["playback"]["instruments"].size() == 1);
        CHECK(data["traces"].empty());
        const std::vector<float> nodes = floats_of(data["playback"]["frames"].back()["nodes"][0]);
        double force = 0;
        for (std::size_t i = 3; i < nodes.size(); i += 4) force += nodes[i];
        const double normal = data["trace"]["normal_n"].back();
        REQUIRE(normal > 0);
        CHECK(force == about(normal).epsilon(0.1));  // friction's tenth at a right angle to it
    }

    TEST_CASE("property: a report's policy lets its own scripts run, by their hashes, and no others, and loads nothing")
    {
        if (!has_three()) return skip("libjs-three is not installed");
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        run_ok(folder, "run t.toml -o D --quiet");
        run_ok(folder, "report D");
        const std::string page = slurp(folder.path / "D/report.html");
        const std::string meta = "<meta http-equiv=\"Content-Security-Policy\" content=\"";
        const std::size_t at = page.find(meta);
        REQUIRE(at < page.find("<script"));  // it holds for what comes after it
        const std::string policy = page.substr(at + meta.size(), page.find('"', at + meta.size()) - at - meta.size());
        CAPTURE(policy);
        CHECK(policy.starts_with("default-src 'none'; script-src 'sha256-"));
        const std::string scripts =
            policy.substr(policy.find("script-src"), policy.find(';', policy.find("script-src")) - policy.find("script-src"));
        CHECK_FALSE(has(scripts, "unsafe"));
        int count = 0;
        for (std::size_t from = 0; (from = page.find("<script>", from)) != std::string::npos; ++count) {
            from += 8;
            const std::string script = page.substr(from, page.find("</script>", from) - from);
            CHECK(script.find('\r') == std::string::npos);  // a browser reads line ends as \n before it takes the hash
            folder.write("script", script);
            CHECK(std::system(
                      fmt::format("cd '{}' && python3 -c \"import base64, hashlib; print(base64.b64encode(hashlib.sha256(open("
                                  "'script', 'rb').read()).digest()).decode(), end='')\" >hash",
                                  folder.path.string())
                          .c_str()) == 0);
            CHECK(has(scripts, "'sha256-" + slurp(folder.path / "hash") + "'"));
        }
        CHECK(count == 5);
    }

    TEST_CASE(
        "property: a batch's columns, units, shapes and answer are in its page, in the files' order, and a value that holds "
        "commas stays one")
    {
        if (!has_three()) return skip("libjs-three is not installed");
        const ScratchFolder folder;
        folder.write("two.toml", two_instruments("merged"));
        folder.write("sweep.toml",
                     "[vary]\n\"instrument.1.feed.keys\" = [[{t_s = 0.0, advance_m = 0.02}, {t_s = 0.1, advance_m = 0.06}]]\n"
                     "\"instrument.1.bend_nm2\" = [1e-5, 2e-5]\n");
        const AppResult batch = run_ok(folder, "batch two.toml --vary sweep.toml -o B --quiet --bands");
        run_ok(folder, "report B");
        const auto data = data_of(slurp(folder.path / "B/report.html"));
        CHECK(data["kind"] == "batch");
        CHECK(data["table"]["run"].size() == 2);
        const std::string head = slurp(folder.path / "B/results.csv");
        std::string columns;
        for (const auto& name : data["columns"]) columns += (columns.empty() ? "" : ",") + name.get<std::string>();
        CHECK(columns == head.substr(0, head.find('\n')));
        CHECK(has(data["table"]["instrument.1.feed.keys"][1].get<std::string>(), "0.06"));
        CHECK(data["table"]["instrument.1.bend_nm2"][1] == 2e-5);
        CHECK(data["table"]["status"][0] == "done");
        CHECK(data["units"]["column"].size() == data["columns"].size());
        REQUIRE(data["shapes"]["run"].size() == 2 * 2 * 64);
        CHECK(data["shapes"]["instrument"][64] == "wire");
        CHECK(data["shapes"]["x_m"][64].get<double>() == about(data["table"]["wire.tip_x_m"][0].get<double>()).epsilon(1e-6));
        CHECK(data["vessel"].size() > 300);
        CHECK(data["summary"]["answer"] == summary_of(folder.path / "B")["answer"]);

        // the folder may be somebody else's: its scene may name any mesh, and the page shows none but the folder's own
        fs::remove(folder.path / "B/vessel.vtp");
        run_ok(folder, "report B");
        CHECK(data_of(slurp(folder.path / "B/report.html"))["vessel"].empty());
    }
}

}  // namespace seldinger::test::test_report_command

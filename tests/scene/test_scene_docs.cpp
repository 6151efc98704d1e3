// docs/scene-file.md held against the reader, both ways: every key that is read is in a table, every key in a table is read, with
// the default, the range and the words that the table gives. The reader itself says which keys it knows.
#include "core/error.h"
#include "scene/scene.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace test_scene_docs {

using namespace seldinger;

namespace {

namespace fs = std::filesystem;

struct DocumentedKey {
    std::string section, key, default_cell, range;
};

std::string text_of(const fs::path& file)
{
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

std::string trimmed(const std::string& text)
{
    const auto from = text.find_first_not_of(' '), to = text.find_last_not_of(' ');
    return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

/// Rows of the tables with the head "| key | unit | default | range | meaning |", by the heading above.
std::vector<DocumentedKey> documented_keys()
{
    std::vector<DocumentedKey> keys;
    std::istringstream lines(text_of(fs::path(SEL_SOURCE_DIR) / "docs/scene-file.md"));
    std::string section;
    bool in_table = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("## ")) section = line.substr(3);
        if (line.starts_with("| key | unit | default | range | meaning |")) in_table = true;
        else if (!line.starts_with("|")) in_table = false;
        else if (in_table && line.starts_with("| `")) {
            std::vector<std::string> cells;
            std::istringstream row(line.substr(1));
            for (std::string cell; std::getline(row, cell, '|');) cells.push_back(trimmed(cell));
            REQUIRE_MESSAGE(cells.size() == 5, line);
            keys.push_back({section, cells[0].substr(1, cells[0].size() - 2), cells[2], cells[3]});
        }
    }
    return keys;
}

/// Where --set finds a key of a section.
std::string path_of(const std::string& section, const std::string& key)
{
    static const std::map<std::string, std::string> lists = {{"wire.section", "wire.section.0"},
                                                             {"feed.keys", "feed.keys.0"},
                                                             {"instrument", "instrument.0"},
                                                             {"hold", "hold.0"},
                                                             {"load", "load.0"},
                                                             {"link", "link.0"},
                                                             {"wall_load", "wall_load.0"},
                                                             {"carm.keys", "carm.keys.0"},
                                                             {"contrast.keys", "contrast.keys.0"}};
    const auto found = lists.find(section);
    return (found == lists.end() ? section : found->second) + "." + key;
}

// between them every key may stand in one; none sets a key to anything but its default that has one
const std::string stiff = "bend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = 1e4\n";
const std::string head = "[scene]\nduration_s = 1.0\ndt_s = 0.001\n[wire]\nlength_m = 0.1\nradius_m = 0.0005\ndensity = 7900.0\n";
const std::string tube = "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 0.3\n";
const std::string two =
    "[scene]\nduration_s = 1.0\ndt_s = 0.001\n[[instrument]]\nname = \"outer\"\nlumen_radius_m = 0.0007\nlength_m = 0.2\n"
    "radius_m = 0.001\ndensity = 1100.0\n" +
    stiff +
    "[instrument.feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nkeys = [{t_s = 0.0, advance_m = 0.05}]\n"
    "[[instrument]]\nname = \"inner\"\nlength_m = 0.3\nradius_m = 0.0005\ndensity = 7900.0\n" +
    stiff + "[instrument.feed]\nkeys = [{t_s = 0.0, advance_m = 0.06}]\n[coaxial]\norder = [\"outer\", \"inner\"]\n";
const std::string bases[] = {
    two,
    head + stiff + "place = {}\n[[wire.section]]\nfrom_tip_m = [0.0, 0.05]\n" + tube +
        "[[hold]]\nposition = true\n[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\n"
        "[[link]]\nat = \"tip\"\nanchor = [0.0, 0.0, 0.0]\nstiffness_n_m = 1.0\n",
    head + "youngs_pa = 6e10\nplace = {shape = \"ring\"}\n[[wire.section]]\nfrom_tip_m = [0.0, 0.05]\n" +
        "[vessel]\nshape = \"arc\"\nradius_m = 0.01\nbend_radius_m = 0.03\nangle_deg = 90.0\n" +
        "[[hold]]\nspin = true\n[[load]]\nat = \"tip\"\nmoment_nm = [0.0, 0.0, 1.0]\n",
    head + stiff + tube + "[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nkeys = [{t_s = 0.0, advance_m = 0.0}]\n" +
        "[task]\ntarget = { point = [0.0, 0.0, 0.0] }\n",
    head + stiff + tube + "[task]\ntarget = { branch = 1 }\n",
    head + stiff + "place = {shape = \"centreline\"}\n[vessel]\nshape = \"plane\"\nsize_m = 1.0\n",
    head + stiff + "place = {}\n" + tube + "wall = \"elastic\"\n[[wall_load]]\nat = [0.0, 0.0, 0.0]\nforce_n = [0.0, 0.0, 1.0]\n",
    head + stiff + "place = {shape = \"points\", points = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]}\n",
    head + stiff + "place = {shape = \"arc\", bend_radius_m = 0.1}\n[vessel]\nmesh = \"wall.stl\"\n",
    head + stiff + "place = {}\n" + tube + "[carm]\nkeys = [{t_s = 0.0}]\n[contrast]\nkeys = [{t_s = 0.0}]\n",
};

struct Reading {
    std::string error;  // empty: read
    std::string scene;  // as written back
};

/// The scene `base` with `setting`, written back.
Reading read_with(const std::string& base, const std::string& setting)
{
    static const TemporaryFolder folder;
    static const bool has_mesh = static_cast<bool>(std::ofstream(folder.path() / "wall.stl") << "solid\nendsolid\n");
    REQUIRE(has_mesh);
    try {
        const std::vector<std::string> overrides(setting.empty() ? 0 : 1, setting);
        return {"", write_scene(read_scene_text(base, folder.path() / "docs.toml", overrides), folder.path())};
    } catch (const Error& error) {
        return {error.what(), ""};
    }
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Whether any base scene takes the key, whatever it says of the value: a date is no value of any key.
bool is_read(const std::string& section, const std::string& key)
{
    // the message names the table (by its last word, with or without a place in a list) and the key
    const std::regex named("\\b" + section.substr(section.rfind('.') + 1) + "(\\.[0-9]+)?\\." + key + ":");
    return std::any_of(std::begin(bases), std::end(bases), [&](const std::string& base) {
        const std::string error = read_with(base, path_of(section, key) + "=1979-05-27").error;
        return std::regex_search(error, named) && !says(error, "unknown key");
    });
}

/// Every word in quotes in the sources: whatever the reader knows is among them.
std::set<std::string> words_of_the_sources()
{
    std::set<std::string> words;
    const std::regex literal("\"([a-z][a-z0-9_]*)\"");
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SEL_SOURCE_DIR) / "engine")) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
        const std::string text = text_of(entry.path());
        for (std::sregex_iterator at(text.begin(), text.end(), literal), end; at != end; ++at) words.insert((*at)[1]);
    }
    return words;
}

/// Words in quotes in code font: `"a"`, `"b"`.
std::set<std::string> words_in(const std::string& cell)
{
    std::set<std::string> words;
    const std::regex word("`?\"([^\"`]+)\"`?");
    for (std::sregex_iterator at(cell.begin(), cell.end(), word), end; at != end; ++at) words.insert((*at)[1]);
    return words;
}

/// Values just outside the interval with which a range begins; none where it is no interval.
std::vector<std::string> values_outside(const std::string& range)
{
    static const std::regex interval(R"(^([\[(])(-?∞|-?[0-9.]+), (∞|[0-9.]+)([\])]))");
    std::smatch match;
    if (!std::regex_search(range, match, interval)) return {};
    std::vector<std::string> values;
    const auto add = [&](const std::string& bound, bool open, int out) {
        if (says(bound, "∞")) return;
        const bool whole = !says(bound, ".");
        if (open) values.push_back(bound);
        else values.push_back(whole ? std::to_string(std::stoll(bound) + out) : std::to_string(std::stod(bound) + 0.01 * out));
    };
    add(match[2], match[1] == "(", -1);
    add(match[3], match[4] == ")", +1);
    return values;
}

}  // namespace

TEST_SUITE("scene/scene_docs")
{
    TEST_CASE("property: the base scenes are read")
    {
        for (const std::string& base : bases) CHECK(read_with(base, "").error.empty());
    }

    TEST_CASE("property: every key in a table is read")
    {
        const auto keys = documented_keys();
        REQUIRE(keys.size() > 90);
        for (const DocumentedKey& k : keys) CHECK_MESSAGE(is_read(k.section, k.key), k.section << "." << k.key);
    }

    TEST_CASE("property: every key that is read is in a table, and every table of the file has a section")
    {
        std::map<std::string, std::set<std::string>> documented;
        for (const DocumentedKey& k : documented_keys()) documented[k.section].insert(k.key);
        documented["instrument"].merge(std::set<std::string>(documented["wire"]));  // has the keys of [wire]
        const auto words = words_of_the_sources();
        REQUIRE(words.size() > 200);
        for (const std::string& word : words) {
            for (const auto& section : documented)
                if (!section.second.contains(word))
                    CHECK_MESSAGE(!is_read(section.first, word), section.first << "." << word << " is not documented");
            const bool is_table = !says(read_with(bases[1], word + ".zz=1").error, ": " + word + ": unknown key");
            CHECK_MESSAGE(is_table == documented.contains(word), word);
        }
    }

    TEST_CASE("property: a default written out changes nothing")
    {
        const std::regex code("^`([^`]+)`$");
        int checked = 0;
        for (const DocumentedKey& k : documented_keys()) {
            std::smatch match;
            if (!std::regex_search(k.default_cell, match, code)) continue;
            const std::string setting = path_of(k.section, k.key) + "=" + match[1].str();
            CAPTURE(setting);
            bool accepted = false;
            for (const std::string& base : bases) {
                const Reading with = read_with(base, setting), without = read_with(base, "");
                // a key of a table that the base has not makes the table: only where it is there is nothing changed
                if (with.scene.empty() || without.scene.empty()) continue;
                // bases that say something else
                if (k.section == "wire.place" && says(base, "{" + k.key + " = ")) continue;
                if (k.section == "load" && says(base, k.key + " = ")) continue;
                if (k.section == "wall_load" && !says(base, "[[wall_load]]")) continue;
                if (k.section.find("feed") == 0 && !says(base, "[feed]")) continue;
                if (k.section == "coaxial" && !says(base, "[coaxial]")) continue;
                if (k.section.starts_with("carm") && !says(base, "[carm]")) continue;
                if (k.section.starts_with("contrast") && !says(base, "[contrast]")) continue;
                if (k.section == "hold" && !says(base, "[[hold]]")) continue;
                CHECK(with.scene == without.scene);
                accepted = true;
            }
            CHECK(accepted);
            ++checked;
        }
        REQUIRE(checked > 40);
    }

    TEST_CASE("property: values outside a range are refused")
    {
        int checked = 0;
        for (const DocumentedKey& k : documented_keys())
            for (const std::string& value : values_outside(k.range)) {
                const std::string setting = path_of(k.section, k.key) + "=" + value;
                CAPTURE(setting);
                CHECK(std::any_of(std::begin(bases), std::end(bases), [&](const std::string& base) {
                    return says(test::without_got(read_with(base, setting).error), "." + k.key + ": expected");
                }));
                ++checked;
            }
        REQUIRE(checked > 70);
    }

    TEST_CASE("property: the words of a choice are those of the reader")
    {
        int checked = 0;
        for (const DocumentedKey& k : documented_keys()) {
            const std::string path = path_of(k.section, k.key);
            for (const std::string& base : bases) {
                const std::string error = test::without_got(read_with(base, path + "=\"zz\"").error);
                const auto list = error.find("." + k.key + ": expected one of ");
                if (list == std::string::npos) continue;
                CAPTURE(path);
                CHECK(words_in(error.substr(error.find(" of ", list))) == words_in(k.range));
                ++checked;
                break;
            }
        }
        REQUIRE(checked >= 13);
    }
}

}  // namespace test_scene_docs

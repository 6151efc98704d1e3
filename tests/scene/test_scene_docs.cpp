// Every key of a scene (scene/scene_keys.h): the tables of docs/scene-file.md are made from the keys, and each key that is
// written is read back. A new key needs nothing here.
#include "core/error.h"
#include "scene/scene_keys.h"
#include "support/temporary_folder.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <list>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace seldinger::test::test_scene_docs {

namespace {

namespace fs = std::filesystem;

const fs::path page = fs::path(SEL_SOURCE_DIR) / "docs/scene-file.md";

// Between them every key stands in one, and every table is there first without a key that has a default.
const std::string stiff = "bend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = 1e4\n";
const std::string head = "[scene]\nduration_s = 1.0\ndt_s = 0.001\n[wire]\nlength_m = 0.1\nradius_m = 0.0005\ndensity = 7900.0\n";
const std::string tube = "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 0.3\n";
const std::string two =
    "[scene]\nduration_s = 1.0\ndt_s = 0.001\n[[instrument]]\nname = \"outer\"\nlumen_radius_m = 0.0007\nlength_m = 0.2\n"
    "radius_m = 0.001\ndensity = 1100.0\n" +
    stiff +
    "[instrument.feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nkeys = [{t_s = 0.0, advance_m = 0.05}]\n"
    "[[instrument]]\nname = \"inner\"\nlength_m = 0.3\nradius_m = 0.0005\ndensity = 7900.0\n" +
    stiff + "[instrument.feed]\nkeys = [{t_s = 0.0, advance_m = 0.06}]\n[coaxial]\norder = [\"outer\", \"inner\"]\n" +
    "[[hold]]\ninstrument = \"inner\"\nat = \"tip\"\nspin = true\n[[load]]\ninstrument = \"inner\"\nat = \"tip\"\nforce_n = "
    "[0.0, 0.0, 1.0]\n"
    "[[link]]\ninstrument = \"inner\"\nat = \"tip\"\nanchor = [0.0, 0.0, 0.0]\nstiffness_n_m = 1.0\n"
    "[[force]]\ninstrument = \"inner\"\nplugin = \"wall.stl\"\nname = \"pull\"\n";
const std::string bases[] = {
    head + stiff + "place = {}\n[[wire.section]]\nfrom_tip_m = [0.0, 0.05]\n" + tube +
        "[[hold]]\nposition = true\n[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\n"
        "[[link]]\nat = \"tip\"\nanchor = [0.0, 0.0, 0.0]\nstiffness_n_m = 1.0\n[[force]]\nplugin = \"wall.stl\"\n",
    head + "youngs_pa = 6e10\nplace = {shape = \"ring\"}\n[[wire.section]]\nfrom_tip_m = [0.0, 0.05]\n" +
        "[vessel]\nshape = \"arc\"\nradius_m = 0.01\nbend_radius_m = 0.03\nangle_deg = 90.0\n" +
        "[[hold]]\nspin = true\n[[load]]\nat = \"tip\"\nmoment_nm = [0.0, 0.0, 1.0]\n",
    head + stiff + tube +
        "[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nkeys = [{t_s = 0.0, advance_m = 0.0}]\n" +
        "[task]\ntarget = { point = [0.0, 0.0, 0.0] }\n",
    head + stiff + tube + "[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\nhub_mass_kg = 0.1\n" +
        "keys = [{t_s = 0.0, force_n = 0.1}]\n[task]\ntarget = { branch = 1 }\n",
    head + stiff + "place = {shape = \"centreline\"}\n[vessel]\nshape = \"plane\"\nsize_m = 1.0\n",
    head + stiff + "place = {}\n" + tube + "wall = \"elastic\"\n[[wall_load]]\nat = [0.0, 0.0, 0.0]\nforce_n = [0.0, 0.0, 1.0]\n",
    head + stiff + "place = {shape = \"points\", points = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]}\n",
    head + stiff + "place = {shape = \"arc\", bend_radius_m = 0.1}\n[vessel]\nmesh = \"wall.stl\"\n",
    head + stiff + "place = {}\n" + tube + "[carm]\nkeys = [{t_s = 0.0}]\n[contrast]\nkeys = [{t_s = 0.0}]\n",
    head + stiff + "place = {}\n[vessel]\nmesh = \"wall.stl\"\ncentreline = \"other.stl\"\n",
    // with keys that are written only where they are given
    head + stiff + tube + "[integrator]\nbeta = 0.25\n[contact]\nstiffness = 1e9\nexponent = 2.0\n" +
        "[feed]\ninlet = \"auto\"\nkeys = [{t_s = 0.0, advance_m = 0.01}]\n[carm]\nisocentre = [0.0, 0.0, 0.0]\n" +
        "[contrast]\nat = [0.0, 0.0, 0.0]\ninflow = [0.0, 0.0, 0.0]\nkeys = [{t_s = 0.0}]\n",
    two,
};

Scene read(const std::string& text)
{
    static const TemporaryFolder folder;
    for (const char* name : {"wall.stl", "other.stl"})
        if (!fs::exists(folder.path() / name)) std::ofstream(folder.path() / name) << "solid\nendsolid\n";
    return read_scene_text(text, folder.path() / "docs.toml");
}

std::string written(const Scene& scene) { return write_scene(scene, scene.source.parent_path()); }

struct Entry {
    std::string table;  // heading of the page
    Key key;
};

/// The keys of all tables of a scene, and of the tables within them. [[instrument]] has the keys of [wire] and two of its own.
std::vector<Entry> entries(Scene& scene)
{
    std::vector<Entry> all;
    for (const keys::Table& table : keys::tables(scene))
        for (const Key& key : table.keys) {
            const bool own = key.name == "name" || key.name == "feed",
                       shared = table.name == "wire" || table.name == "instrument";
            if (own && table.name == "wire") continue;
            const std::string name = shared ? (own ? "instrument" : "wire") : table.name;
            all.push_back({name, key});
            const auto* within = std::get_if<keys::Tables>(&key.value);
            for (std::size_t i = 0; within && i < within->tables.size(); ++i)
                for (const Key& inner : within->tables[i]) all.push_back({fmt::format("{}.{}", name, key.name), inner});
        }
    return all;
}

std::string bound(double v) { return std::abs(v) == range_end ? v < 0 ? "-∞" : "∞" : fmt::format("{:g}", v); }

std::string words_of(const std::vector<std::string_view>& list)
{
    std::string text;
    for (const std::string_view word : list) text += fmt::format("{}`\"{}\"`", text.empty() ? "" : ", ", word);
    return text;
}

/// The column "range" for each kind of value.
struct RangeText {
    static std::string with(const std::string& text, const keys::Words& words)
    {
        return words.list.empty() ? text : text + ", " + words_of(words.list);
    }
    std::string operator()(const keys::Number& n) const
    {
        const Range& r = n.range;
        return with(fmt::format("{}{}, {}{}", r.low_open || r.low == -range_end ? "(" : "[", bound(r.low), bound(r.high),
                                r.high_open || r.high == range_end ? ")" : "]"),
                    n.words);
    }
    std::string operator()(const keys::Count& c) const
    {
        return with(fmt::format("[{}, {}]{}", c.least, c.most, c.text ? " or text" : ""), c.words);
    }
    std::string operator()(const std::int64_t*) const { return "[0, ∞)"; }
    std::string operator()(const bool*) const { return "`true`, `false`"; }
    std::string operator()(const std::string*) const { return "text"; }
    std::string operator()(const fs::path*) const { return "path"; }
    std::string operator()(const keys::Numbers& n) const
    {
        return fmt::format("{} numbers{}", n.values.size(), n.nonzero ? ", not all 0" : n.range.low == 0 ? " above 0" : "");
    }
    std::string operator()(const keys::Rows& r) const { return fmt::format("{} or more {}", r.least, r.form); }
    std::string operator()(const keys::Words& w) const { return words_of(w.list); }
    std::string operator()(const keys::Tables& t) const { return t.list ? "tables" : "table"; }
    std::string operator()(const keys::Special& s) const { return s.range; }
};

std::string row(Key key)
{
    key.use = keys::Use::Written;
    const std::string text = keys::text_of(key, {});
    const std::string absent = !key.absent.empty() ? std::string(key.absent) : text.empty() ? "*none*" : "`" + text + "`";
    std::string line = "|";
    for (const std::string& cell : {fmt::format("`{}`", key.name), std::string(key.unit), absent,
                                    std::visit(RangeText(), key.value), std::string(key.meaning)})
        line += cell.empty() ? " |" : " " + cell + " |";
    return line;
}

/// The page with the rows of its tables of keys as the keys have them. @param missing  tables without a place on the page
std::string page_of_keys(std::set<std::string>& missing)
{
    std::map<std::string, std::string> rows;
    std::set<std::string> seen;
    std::list<Scene> scenes;
    for (const std::string& base : bases)
        for (const Entry& e : entries(scenes.emplace_back(read(base))))
            if (seen.insert(e.table + "." + std::string(e.key.name)).second) rows[e.table] += row(e.key) + "\n";
    std::ifstream in(page);
    std::string out, section;
    bool in_rows = false;
    for (std::string line; std::getline(in, line); in_rows = in_rows && line.starts_with("|")) {
        if (line.starts_with("## ")) section = line.substr(3);
        if (in_rows && line.starts_with("| `")) continue;
        out += line + "\n";
        if (in_rows && line.starts_with("|---")) out += rows[section], rows.erase(section);
        if (line.starts_with("| key | unit | default | range | meaning |")) in_rows = true;
    }
    for (const auto& table : rows) missing.insert(table.first);
    return out;
}

/// Gives a value another one, the n-th that comes to mind. @return false: there are no more
struct Change {
    std::size_t n;
    bool number(double& v, const Range& range) const
    {
        const double others[] = {1.25 * v, 0.75 * v, 1e-5, 1e-3, 0.5, 2};
        if (n >= std::size(others)) return false;
        if (range.contains(others[n])) v = others[n];
        return true;
    }
    bool operator()(keys::Number& k) const
    {
        k.words.set(-1);
        return number(*k.value, k.degrees ? any_number : k.range);
    }
    bool operator()(keys::Count& k) const
    {
        k.words.set(-1);
        *k.value = std::clamp(*k.value + 1, k.least, k.most);
        return n == 0;
    }
    bool operator()(std::int64_t* v) const { return ++*v, n == 0; }
    bool operator()(bool* v) const { return *v = !*v, n == 0; }
    bool operator()(std::string* v) const { return *v = "changed", n == 0; }
    bool operator()(fs::path* v) const { return *v = read(bases[0]).source.parent_path() / "other.stl", n == 0; }
    bool operator()(keys::Numbers& k) const
    {
        for (double* v : k.values)
            if (!number(*v, k.range)) return false;
        return true;
    }
    bool operator()(keys::Rows& k) const
    {
        auto rows = k.get();
        while (rows.size() < k.least) rows.emplace_back(k.width, 0.0).front() = static_cast<double>(rows.size());
        rows.back().back() += 1e-3;
        return k.set(rows), n == 0;
    }
    bool operator()(keys::Words& k) const
    {
        if (n + 1 >= k.list.size()) return false;
        return k.set(static_cast<int>((static_cast<std::size_t>(k.get()) + n + 1) % k.list.size())), true;
    }
    bool operator()(keys::Tables&) const { return false; }
    bool operator()(keys::Special&) const { return false; }
};

/// Stiffness goes with its material.
void follow_material(Scene& scene)
{
    for (int k = 0; k < scene.instrument_count(); ++k) {
        WireSpec& wire = scene.instrument(k).wire;
        if (wire.shaft.youngs > 0) set_stiffness_from_material(wire.shaft);
        for (WireSectionRange& range : wire.sections)
            if (range.section.youngs > 0) set_stiffness_from_material(range.section);
    }
}

/// Whether key i of the scene comes back from the file with some other value than it has.
bool comes_back(const Scene& base, std::size_t i)
{
    for (std::size_t n = 0;; ++n) {
        Scene changed = base;
        Entry e = entries(changed)[i];
        const fs::path folder = base.source.parent_path();
        Scene same = base;
        const std::string before = keys::text_of(entries(same)[i].key, folder);
        if (!std::visit(Change{n}, e.key.value)) return false;
        if (e.table.starts_with("wire") && (e.key.name == "youngs_pa" || e.key.name == "poisson")) {
            if (before.empty()) return false;  // stiffness is given
            follow_material(changed);
        }
        const std::string now = keys::text_of(entries(changed)[i].key, folder);
        if (now.empty() || now == before) continue;
        const std::string text = written(changed);
        try {
            Scene again = read(text);
            CHECK_MESSAGE(written(again) == text, text);
            const auto back = entries(again);
            if (i < back.size() && back[i].key.name == e.key.name && keys::text_of(back[i].key, folder) == now) return true;
        } catch (const Error&) {
            // a value that contradicts others: the next one
        }
    }
}

}  // namespace

TEST_SUITE("scene/scene_docs")
{
    TEST_CASE("property: the tables of the page are those of the keys")
    {
        std::ifstream in(page);
        std::stringstream now;
        now << in.rdbuf();
        std::set<std::string> missing;
        const std::string made = page_of_keys(missing);
        CHECK_MESSAGE(missing.empty(), fmt::format("{} have no heading with a table on the page", fmt::join(missing, ", ")));
        const bool same = now.str() == made;
        CHECK_MESSAGE(same,
                      "docs/scene-file.md is not up to date. Fix: seldinger_quick_tests -ns -tc='write docs/scene-file.md'");
    }

    TEST_CASE("write docs/scene-file.md" * doctest::skip())
    {
        std::set<std::string> missing;
        const std::string made = page_of_keys(missing);
        std::ofstream(page) << made;
    }

    TEST_CASE("property: every key with another value is written and read back")
    {
        std::set<std::string> all, back, written_by_hand;
        for (const std::string& text : bases) {
            const Scene base = read(text);
            Scene same = base;
            const std::vector<Entry> list = entries(same);
            for (std::size_t i = 0; i < list.size(); ++i) {
                const std::string name = fmt::format("{}.{}", list[i].table, list[i].key.name);
                CAPTURE(name);
                const auto* special = std::get_if<keys::Special>(&list[i].key.value);
                if (special && !special->text.empty()) written_by_hand.insert(name);
                if (special || std::holds_alternative<keys::Tables>(list[i].key.value)) continue;
                all.insert(name);
                if (!back.contains(name) && comes_back(base, i)) back.insert(name);
            }
        }
        REQUIRE(all.size() > 150);
        for (const std::string& name : all) CHECK_MESSAGE(back.contains(name), name);
        // tests/scene/test_scene.cpp and test_scene_instruments.cpp read these back
        CHECK(written_by_hand == std::set<std::string>{"coaxial.order", "hold.position", "integrator.beta", "integrator.gamma"});
    }
}

}  // namespace seldinger::test::test_scene_docs

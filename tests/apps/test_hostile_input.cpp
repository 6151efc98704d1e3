// Scenes, sweeps, run folders and caches that mean no good: one line, an exit code, and an end.

#include "apps/app_fixture.h"
#include "support/shared_folder.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <random>

namespace seldinger::test::test_hostile_input {

namespace {

/// One printable line on stderr, exit 2 or 3. A minute is no measure of speed: it catches endless loops.
void is_refused(const ScratchFolder& folder, const std::string& arguments, const std::string& names = "")
{
    CAPTURE(arguments);
    const AppResult result = run_app(folder, arguments, "timeout 60");
    CAPTURE(result.err);
    CHECK((result.code == 2 || result.code == 3));
    CHECK(result.error_lines() == 1);
    CHECK(has(result.err, names));
    for (const unsigned char c : result.err) CHECK((c == '\n' || c >= 0x20));
}

std::string with(std::string scene, const std::string& from, const std::string& to)
{
    const std::size_t at = scene.find(from);
    REQUIRE(at != std::string::npos);
    return scene.replace(at, from.size(), to);
}

}  // namespace

TEST_SUITE("apps/hostile input")
{
    TEST_CASE("property: one level too many is refused before it is parsed")
    {
        const ScratchFolder folder;
        std::string dotted = "a", arrays, tables;
        for (int k = 0; k < 33; ++k) dotted += ".a", arrays += "[", tables += "{a=";
        folder.write("dotted.toml", dotted + " = 1\n");
        folder.write("table.toml", "[" + dotted + "]\n");
        folder.write("arrays.toml", "a = " + arrays + "\n");
        folder.write("tables.toml", "a = " + tables + "\n");
        folder.write("s.toml", free_scene());
        for (const char* file : {"dotted.toml", "table.toml", "arrays.toml", "tables.toml"}) {
            is_refused(folder, std::string("check ") + file, "nested");
            is_refused(folder, std::string("batch s.toml -o D --vary ") + file, "nested");
        }
        is_refused(folder, "run s.toml --set " + dotted + "=1", "nested");
        // dots in texts and comments are no levels
        folder.write("dots.toml", "# " + dotted + "\n" + with(free_scene(), "\"falling\"", "\"" + std::string(200, '.') + "\""));
        run_ok(folder, "check dots.toml");
    }

    TEST_CASE("property: numbers that nothing can be computed from are refused with their key")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        const std::pair<const char*, const char*> all[] = {
            {"scene.gravity=[0,0,1e300]", "scene.gravity"},
            {"feed.keys.1.turn_rad=1e300", "turn_rad"},
            {"feed.keys.1.advance_m=1e308", "advance_m"},
            {"wire.length_m=1e308", "wire.length_m"},
            {"wire.density=1e300", "wire.density"},
            {"scene.duration_s=1e300", "scene.duration_s"},
            {"scene.dt_s=inf", "scene.dt_s"},
            {"wire.bend_nm2=nan", "wire.bend_nm2"},
            {"vessel.radius_m=1e200", "vessel.radius_m"},
            {"feed.point=[1e300,0,0]", "feed.point"},
            {"wire.length_m=-inf", "wire.length_m"},
            {"vessel.triangles=99999999999", "vessel.triangles"},
        };
        for (const auto& [set, key] : all) is_refused(folder, fmt::format("run t.toml -o D --set '{}'", set), key);
    }

    TEST_CASE("property: pipes, devices, folders and very large files are no scenes, sweeps, records or replays")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        REQUIRE(mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
        fs::create_directory(folder.path / "folder");
        folder.write("large", "");
        fs::resize_file(folder.path / "large", 1u << 30);  // sparse
        for (const char* file : {"pipe", "/dev/zero", "folder", "large"}) {
            is_refused(folder, fmt::format("check {}", file), file);
            is_refused(folder, fmt::format("run {} -o D", file), file);
            is_refused(folder, fmt::format("batch s.toml -o D --vary {}", file), file);
        }
        is_refused(folder, "run s.toml -o D --replay pipe", "pipe");
        is_refused(folder, "run s.toml -o D --replay /dev/zero", "/dev/zero");
        folder.write("i.toml", "include = \"pipe\"\n" + free_scene());
        is_refused(folder, "check i.toml", "pipe");
    }

    TEST_CASE("property: terminal escapes reach neither stderr nor a summary")
    {
        const ScratchFolder folder;
        const std::string escape =
            "\x1b[2J\x1b]0;owned\x07\xc2\x9b"
            "31m\xe2\x80\xae";
        folder.write("a" + escape + ".toml", "x");
        is_refused(folder, "check a*.toml");
        is_refused(folder, "check 'missing" + escape + ".toml'", "missing?[2J?]0;owned?");
        folder.write("key.toml", free_scene() + "[\"" + "\\u001b[2J" + "\"]\n");
        is_refused(folder, "check key.toml");
        folder.write("name.toml", with(free_scene(), "\"falling\"", "\"\\u001b[2J\""));
        const AppResult result = run_ok(folder, "run name.toml -o D");
        CHECK(result.out.find('\x1b') == std::string::npos);
    }

    TEST_CASE("property: a table that is a link is not written through, and frames that were deleted are not listed again")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.05, 1)}};
        REQUIRE(run_app(folder, "run s.toml -o D --time-limit 1e-6 --quiet --set output.wire_every=1").code == 75);
        folder.write("mine", slurp(folder.path / "D/trace.csv"));
        fs::remove(folder.path / "D/trace.csv");
        fs::create_symlink(folder.path / "mine", folder.path / "D/trace.csv");
        const std::string before = slurp(folder.path / "mine");
        is_refused(folder, "run s.toml -o D --resume --set output.wire_every=1", "trace.csv");
        CHECK(slurp(folder.path / "mine") == before);
        fs::remove(folder.path / "D/trace.csv");
        folder.write("D/trace.csv", before);
        fs::remove(folder.path / "D/wire_000000.vtp");
        run_ok(folder, "run s.toml -o D --resume --quiet --set output.wire_every=1");
        const std::string list = slurp(folder.path / "D/wire.pvd");
        CHECK_FALSE(has(list, "wire_000000.vtp"));
        CHECK(has(list, "wire_000001.vtp"));
    }

    TEST_CASE("property: a checkpoint of another scene is refused, also a finished one")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        const std::string other = " --set contact.stiffness=200";
        for (const char* limit : {"", " --time-limit 1e-6"}) {
            (void)run_app(folder, std::string("run t.toml -o A --overwrite --quiet") + limit);
            (void)run_app(folder, "run t.toml -o B --overwrite --quiet --time-limit 1e-6 --set scene.seed=5");
            fs::copy_file(folder.path / "A/checkpoint.bin", folder.path / "B/checkpoint.bin",
                          fs::copy_options::overwrite_existing);
            is_refused(folder, "run t.toml -o B --resume --set scene.seed=5", "seed");
        }
        if (const auto shared = seldinger::test::shared_folder()) {
            fs::copy_file(*shared / "hostile/ckpt-31-000106.bin", folder.path / "B/checkpoint.bin",
                          fs::copy_options::overwrite_existing);
            is_refused(folder, "run t.toml -o B --resume --set scene.seed=5", "checkpoint.bin");
            is_refused(folder, fmt::format("check '{}'", (*shared / "hostile/deepkey-scene.toml").string()), "nested");
        }
    }

    TEST_CASE("property: whatever a run folder holds, what reads it ends with a true answer or one line")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.03)}};
        run_ok(folder, "run t.toml -o D --quiet --set output.wire_every=10 --set output.contacts_every=10");
        const char* const files[] = {"summary.json", "trace.csv",  "wire.csv",        "contacts.csv", "wire.pvd",
                                     "scene.toml",   "vessel.vtp", "wire_000010.vtp", "contacts.pvd", "checkpoint.bin"};
        std::mt19937 random(3);
        const char* given = std::getenv("SELDINGER_MUTANTS");
        const int each = given ? std::max(1, std::atoi(given) / 20) : 3;
        for (const char* name : files)
            for (int k = 0; k < each; ++k) {
                const std::string good = slurp(folder.path / "D" / name);
                std::string bad = good;
                switch (random() % 4) {
                    case 0:
                        bad.resize(random() % bad.size());
                        break;
                    case 1:
                        bad.clear();
                        break;
                    case 2:
                        for (int flips = 0; flips < 5; ++flips) bad[random() % bad.size()] = static_cast<char>(random());
                        break;
                    default:
                        if (const std::size_t at = bad.find_first_of("123456789", random() % bad.size()); at != std::string::npos)
                            bad.insert(at, "99999999999999999999");
                }
                folder.write(std::string("D/") + name, bad);
                for (const char* command : {"report D -o r.html", "render D",
                                            "run t.toml -o D --resume --quiet --set "
                                            "output.wire_every=10 --set output.contacts_every=10"}) {
                    CAPTURE(name);
                    CAPTURE(command);
                    CAPTURE(k);
                    const AppResult result = run_app(folder, command, "timeout 60");
                    CAPTURE(result.err);
                    CHECK((result.code == 0 || result.code == 2 || result.code == 3));
                    CHECK(result.error_lines() <= 1);
                }
                folder.write(std::string("D/") + name, good);
            }
    }

    TEST_CASE("property: a kernel cache that cannot be written to costs time and no run")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        const fs::path cache = folder.path / "cache";
        run_ok(folder, "run t.toml -o whole --quiet", "env POCL_CACHE_DIR=cache");
        const auto hash = summary_of(folder.path / "whole")["state_hash"];
        if (!fs::exists(cache)) return;  // not PoCL
        folder.write("file", "");
        const AppResult result = run_ok(folder, "run t.toml -o A --quiet", "env POCL_CACHE_DIR=file/cache");
        CHECK(has(result.err, "POCL_CACHE_DIR"));
        CHECK(has(result.err, "file/cache"));
        CHECK(summary_of(folder.path / "A")["state_hash"] == hash);
        // where the loader knows two platforms, it used to count their devices before there was a usable cache
        const fs::path pocl = "/etc/OpenCL/vendors/pocl.icd";
        if (fs::exists(pocl)) {
            fs::create_directory(folder.path / "vendors");
            for (const char* name : {"vendors/first.icd", "vendors/second.icd"}) fs::copy_file(pocl, folder.path / name);
            const std::string vendors = "OCL_ICD_VENDORS=" + (folder.path / "vendors").string();
            const AppResult devices = run_ok(folder, "devices", "env POCL_CACHE_DIR=file/cache " + vendors);
            CHECK(has(devices.out, "Portable Computing Language"));
        }
    }
}

}  // namespace seldinger::test::test_hostile_input

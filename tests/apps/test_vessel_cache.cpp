// The cache of prepared vessels, as the command uses it: the same bits with and without, and never in the way.

#include "apps/background_app.h"

#include <sys/stat.h>

namespace seldinger::test::test_vessel_cache {

namespace {

const std::string with_cache = "env -u SELDINGER_VESSEL_CACHE XDG_CACHE_HOME=\"$PWD/cache\"";

std::vector<fs::path> entries(const ScratchFolder& folder)
{
    std::vector<fs::path> found;
    std::error_code ignored;
    for (const auto& at : fs::directory_iterator(folder.path / "cache/seldinger", ignored)) found.push_back(at.path());
    std::sort(found.begin(), found.end());
    return found;
}

/// A tube as a mesh file, closed by nothing: two openings, and a centreline that has to be found.
void write_mesh_file(const ScratchFolder& folder)
{
    folder.write("t.toml", tube_scene());
    run_ok(folder, "vessel t.toml -o V");
    fs::copy_file(folder.path / "V/vessel.stl", folder.path / "tube.stl");
}

std::string report(const ScratchFolder& folder, const std::string& prefix, const std::string& more = "")
{
    const AppResult result = run_app(folder, "vessel tube.stl --json " + more, prefix);
    CHECK(result.err == "");
    REQUIRE(result.code == 0);
    return result.out;
}

}  // namespace

TEST_SUITE("apps/vessel_cache")
{
    TEST_CASE("property: a vessel from the cache is the same to the bit, and the second start takes it from there")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        const std::string plain = report(folder, with_cache, "--no-vessel-cache");
        CHECK_FALSE(fs::exists(folder.path / "cache"));
        CHECK(report(folder, with_cache + " SELDINGER_VESSEL_CACHE=off") == plain);
        CHECK_FALSE(fs::exists(folder.path / "cache"));
        CHECK(has(report(folder, with_cache, "-o A"), "triangles_read"));
        REQUIRE(entries(folder).size() == 1);
        const fs::path entry = entries(folder)[0];
        const auto inode = [&] {
            struct stat status {};
            REQUIRE(::stat(entry.c_str(), &status) == 0);
            return status.st_ino;
        };
        const auto made = inode();
        CHECK(report(folder, with_cache) == plain);
        report(folder, with_cache, "-o B");
        CHECK(inode() == made);  // read, not made again
        CHECK(slurp(folder.path / "A/vessel.vtp") == slurp(folder.path / "B/vessel.vtp"));
        CHECK(slurp(folder.path / "A/centreline.vtp") == slurp(folder.path / "B/centreline.vtp"));
        // another unit, another content: entries of their own
        CHECK(report(folder, with_cache, "--units cm") != plain);
        CHECK(entries(folder).size() == 2);
        std::string bytes = slurp(folder.path / "tube.stl");
        bytes[0] ^= 1;  // of the header, which says nothing of the mesh
        folder.write("tube.stl", bytes);
        CHECK(report(folder, with_cache) == plain);
        CHECK(entries(folder).size() == 3);
    }

    TEST_CASE("property: a run has the same state hash by the cache as without")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        std::string scene = tube_scene();
        const std::size_t begin = scene.find("[vessel]"), end = scene.find("\n[", begin);
        scene.replace(begin, end - begin, "[vessel]\nmesh = \"tube.stl\"\nunits = \"mm\"\n");
        folder.write("m.toml", scene);
        std::vector<std::string> hashes;
        for (const char* more : {"--no-vessel-cache", "", ""}) {
            const AppResult result = run_app(folder, fmt::format("run m.toml -o D --overwrite --quiet {}", more), with_cache);
            CAPTURE(result.err);
            REQUIRE(result.code == 0);
            hashes.push_back(nlohmann::json::parse(slurp(folder.path / "D/summary.json"))["state_hash"]);
        }
        CHECK(entries(folder).size() == 1);
        CHECK(hashes[0] == hashes[1]);
        CHECK(hashes[1] == hashes[2]);
    }

    TEST_CASE("property: an entry that is damaged anywhere is made again with a note")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        const std::string plain = report(folder, with_cache);
        REQUIRE(entries(folder).size() == 1);
        const fs::path entry = entries(folder)[0];
        const std::string sound = slurp(entry);
        std::vector<std::string> damaged = {"", sound.substr(0, 10), sound.substr(0, sound.size() - 1), sound + "x"};
        for (const double share : {0.0, 0.001, 0.01, 0.3, 0.7, 0.999}) {
            damaged.push_back(sound);
            damaged.back()[static_cast<std::size_t>(share * static_cast<double>(sound.size() - 1))] ^= 4;
        }
        for (const std::string& bytes : damaged) {
            CAPTURE(bytes.size());
            std::ofstream(entry, std::ios::binary) << bytes;
            const AppResult result = run_ok(folder, "vessel tube.stl --json", with_cache);
            CHECK(result.out == plain);
            CHECK(result.error_lines() == 1);
            CHECK(has(result.err, "is damaged; preparing the vessel again"));
            CHECK(slurp(entry) == sound);
        }
    }

    TEST_CASE("property: links in the cache are followed neither for reading nor for writing")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        const std::string plain = report(folder, with_cache);
        REQUIRE(entries(folder).size() == 1);
        const fs::path entry = entries(folder)[0], elsewhere = folder.path / "elsewhere";
        fs::rename(entry, elsewhere);
        const std::string kept = slurp(elsewhere);
        fs::create_symlink(elsewhere, entry);
        const AppResult result = run_app(folder, "vessel tube.stl --json", with_cache);
        CHECK(result.out == plain);
        CHECK(has(result.err, "is a link or another user's"));
        CHECK(fs::symlink_status(entry).type() == fs::file_type::regular);
        CHECK(slurp(elsewhere) == kept);
        // the folder itself
        fs::rename(folder.path / "cache/seldinger", folder.path / "other");
        fs::remove(folder.path / "other" / entry.filename());
        fs::create_directory_symlink(folder.path / "other", folder.path / "cache/seldinger");
        CHECK(report(folder, with_cache) == plain);
        CHECK(fs::is_empty(folder.path / "other"));
    }

    TEST_CASE("property: without a home, with one that takes nothing, and beside other processes there is no error")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        const std::string plain = report(folder, with_cache, "--no-vessel-cache");
        CHECK(report(folder, "env -u SELDINGER_VESSEL_CACHE -u XDG_CACHE_HOME -u HOME") == plain);
        folder.write("file", "");
        CHECK(report(folder, "env -u SELDINGER_VESSEL_CACHE XDG_CACHE_HOME=\"$PWD/file\"") == plain);
        CHECK(report(folder, "env -u SELDINGER_VESSEL_CACHE XDG_CACHE_HOME=/proc") == plain);
        CHECK(report(folder, "env -u SELDINGER_VESSEL_CACHE XDG_CACHE_HOME=relative HOME=\"$PWD/home\"") == plain);
        CHECK_FALSE(fs::exists(folder.path / "relative"));
        CHECK(fs::exists(folder.path / "home/.cache/seldinger"));
        // a folder that exists and takes no file: a limit on files' sizes is a full disk to a process (root may write anywhere)
        const AppResult full = run_app(folder, "vessel tube.stl --json", "ulimit -f 16; " + with_cache);
        CHECK(full.code == 0);
        CHECK(entries(folder).empty());  // nothing half written either
        const std::string together = fmt::format(
            "for i in 1 2 3 4; do {} '{}' vessel tube.stl --json >out$i 2>err$i & done; wait; true", with_cache, app_path());
        REQUIRE(std::system(fmt::format("cd '{}' && {}", folder.path.string(), together).c_str()) == 0);
        for (int i = 1; i <= 4; ++i) {
            CHECK(slurp(folder.path / fmt::format("out{}", i)) == plain);
            CHECK(slurp(folder.path / fmt::format("err{}", i)) == "");
        }
        CHECK(entries(folder).size() == 1);
    }

    TEST_CASE("property: the cache keeps within its limit, the longest unused goes first, leftovers go after an hour")
    {
        const ScratchFolder folder;
        write_mesh_file(folder);
        report(folder, with_cache);
        REQUIRE(entries(folder).size() == 1);
        const auto old = fs::file_time_type::clock::now() - std::chrono::hours(2);
        const fs::path first = entries(folder)[0], other = folder.path / "cache/seldinger/other.vessel",
                       killed = folder.path / "cache/seldinger/x.vessel.1.tmp",
                       running = folder.path / "cache/seldinger/y.vessel.1.tmp";
        for (const fs::path& file : {other, killed, running}) std::ofstream(file) << "x";
        fs::resize_file(other, 950000);  // with `first` more than a megabyte
        fs::last_write_time(other, old - std::chrono::hours(1));
        fs::last_write_time(first, old);
        fs::last_write_time(killed, old);
        report(folder, with_cache + " SELDINGER_VESSEL_CACHE=1", "--units cm");
        CHECK_FALSE(fs::exists(other));
        CHECK(fs::exists(first));
        CHECK_FALSE(fs::exists(killed));
        CHECK(fs::exists(running));
        // used now, it is no longer the oldest
        fs::last_write_time(first, old);
        report(folder, with_cache);
        CHECK(fs::last_write_time(first) > old + std::chrono::hours(1));
        check_refused(folder, "vessel tube.stl", 2, "SELDINGER_VESSEL_CACHE: got \"yes\"; expected",
                      with_cache + " SELDINGER_VESSEL_CACHE=yes");
    }
}

}  // namespace seldinger::test::test_vessel_cache

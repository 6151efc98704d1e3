// Folders that somebody else has made or can write to: links, second names, locks and names that lead elsewhere. Files outside
// are unchanged afterwards, and are not shown. All names x commands: names_matrix.py.

#include "apps/app_fixture.h"
#include "batch/parts.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "io/film_write.h"
#include "support/refusal.h"
#include "support/skip.h"

#include <sys/stat.h>

#include <map>

namespace seldinger::test::test_links {

namespace {

constexpr const char* secret = "a-secret-of-somebody-else";

/// A farm of two parts that nobody has begun, and somebody's folder beside it with files by the names that a farm uses.
struct Shared : ScratchFolder {
    Shared()
    {
        write("s.toml", free_scene(0.01));
        write("v.toml", "[vary]\n\"wire.density\" = [6000.0, 7000.0]\n");
        run_ok(*this, "farm s.toml --vary v.toml -o f --tasks 2 --keep traces --dry-run");
        const char* const folders[] = {"theirs", "theirs/000000", "theirs/deeper"};
        for (const char* at : folders) fs::create_directories(path / at);
        for (const char* at : folders)
            for (const char* name : {"1-of-2.bin", "000000.csv", "results.csv", "sweep.toml", "scene.toml", "notes"})
                if (!fs::exists(path / at / name)) write(std::string(at) + "/" + name, secret);
    }
    [[nodiscard]] std::map<std::string, std::string> theirs() const
    {
        std::map<std::string, std::string> found;
        for (const auto& entry : fs::recursive_directory_iterator(path / "theirs"))
            found[entry.path().string()] = entry.is_regular_file() ? slurp(entry.path()) : "";
        return found;
    }
    void link(const std::string& name) const
    {
        fs::remove_all(path / name);
        fs::create_symlink(path / "theirs", path / name);
    }
};

std::string refusal(const auto& call) { return test::refusal(call, ErrorKind::BadFile); }

}  // namespace

TEST_SUITE("failure/links")
{
    TEST_CASE("regression: a farm's folder that is a link is refused, and nothing behind it is touched")
    {
        for (const char* name : {"parts", "runs"}) {
            CAPTURE(name);
            const Shared shared;
            shared.link(std::string("f/") + name);
            const auto before = shared.theirs();
            for (const char* words : {"farm s.toml --vary v.toml -o f --keep traces --quiet",
                                      "batch s.toml --vary v.toml --part 1/2 -o f --keep traces", "farm merge f"}) {
                const AppResult result = run_app(shared, words);
                CHECK(result.code > 0);
                CHECK(shared.theirs() == before);
                if (words[5] == 's') CHECK(has(result.err, "is a link or no folder"));
            }
        }
    }

    TEST_CASE("regression: a link in the place of a part is not read, and replaced by the part")
    {
        const Shared shared;
        const auto before = shared.theirs();
        for (const char* name : {"1-of-2.bin", "2-of-2.bin"}) {
            fs::create_symlink(shared.path / "theirs/notes", shared.path / "f/parts" / name);
            CHECK(run_app(shared, "farm merge f").code == 3);
        }
        run_ok(shared, "farm s.toml --vary v.toml -o f --keep traces --quiet");
        CHECK(fs::is_regular_file(fs::symlink_status(shared.path / "f/parts/1-of-2.bin")));
        CHECK(shared.theirs() == before);
    }

    TEST_CASE(
        "regression: neither a link nor a second name of a file is written to; the temporary name is not taken from anybody")
    {
        const ScratchFolder folder{{"theirs", secret}};
        fs::create_hard_link(folder.path / "theirs", folder.path / "trace.csv");
        CHECK(refusal([&] { AppendFile(folder.path / "trace.csv", 0); }).find("second name") != std::string::npos);
        const std::string own = fmt::format("out.{}.tmp", getpid());
        fs::create_hard_link(folder.path / "theirs", folder.path / own);
        fs::create_symlink(folder.path / "theirs", folder.path / fmt::format("out.1.{}.tmp", getpid()));
        write_file(folder.path / "out", "new");
        CHECK(slurp(folder.path / "out") == "new");
        CHECK(slurp(folder.path / own) == secret);
        REQUIRE(mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
        CHECK(refusal([&] { write_file(folder.path / "pipe", "new"); }).find("is a pipe or a device") != std::string::npos);
        CHECK(fs::is_fifo(folder.path / "pipe"));
        CHECK(slurp(folder.path / "theirs") == secret);
    }

    TEST_CASE("regression: what has a lock's name and is none is left as it is")
    {
        const ScratchFolder folder{{"theirs", ""}};
        fs::create_directories(folder.path / "d");
        const auto refused = [&] {
            return refusal([&] { (void)FileLock::of_folder(folder.path / "d"); }).find("is not a lock file") != std::string::npos;
        };
        fs::create_hard_link(folder.path / "theirs", folder.path / "d/.lock");
        CHECK(refused());
        CHECK(slurp(folder.path / "theirs") == "");
        fs::remove(folder.path / "d/.lock");
        fs::create_symlink(folder.path / "theirs", folder.path / "d/.lock");
        CHECK(refused());
        fs::remove(folder.path / "d/.lock");
        folder.write("d/.lock", "packages: 3\n");
        CHECK(refused());
        CHECK(slurp(folder.path / "d/.lock") == "packages: 3\n");
        folder.write("d/.lock", "123456\n");  // of a process that was killed
        CHECK_FALSE(refused());
    }

    TEST_CASE("regression: a film goes into a file of its own, whatever lies beside it and whatever it is called")
    {
        if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) return skip("no ffmpeg: apt-get install ffmpeg");
        const ScratchFolder folder{{"theirs", secret}};
        for (const char* place : {"run-10:00", "tcp:", "100%d", "a\nb", "a b'\"", "\xff\xfe"}) {
            CAPTURE(place);
            const fs::path dir = folder.path / place, film = dir / "film.mp4";
            fs::create_directories(dir);
            fs::create_symlink(folder.path / "theirs", dir / "film.mp4.part");
            FilmWriter writer(film, 32, 32, 10);
            for (int k = 0; k < 3; ++k) writer.add(std::vector<std::uint16_t>(32 * 32, static_cast<std::uint16_t>(1000 * k)));
            writer.finish();
            CHECK(slurp(film).substr(4, 4) == "ftyp");
            CHECK(std::distance(fs::directory_iterator(dir), fs::directory_iterator()) == 2);
        }
        CHECK(slurp(folder.path / "theirs") == secret);
        folder.write("file", "");
        const std::string said =
            refusal([&] { FilmWriter(folder.path / "file/film.mp4", 32, 32, 10); });  // a folder would be made
        CHECK(has(said, "file"));
        CHECK_FALSE(has(said, "disk full"));
    }

    TEST_CASE("regression: a report tells nothing that lies outside of its folder")
    {
        const ScratchFolder folder;
        folder.write("s.toml", free_scene(0.01, 1) + "[output]\nwire_every = 5\n");
        folder.write("v.toml", "[vary]\n\"wire.density\" = [6000.0, 7000.0]\n");
        folder.write("theirs", std::string("a,b\n1,") + secret + "\n");
        run_ok(folder, "run s.toml -o R --quiet");
        run_ok(folder, "batch s.toml --vary v.toml -o B --quiet");
        const bool reads = run_app(folder, "report R -o whole.html").code == 0;
        for (const char* name : {"B/results.csv", "B/scene.toml", "B/summary.json", "R/scene.toml", "R/trace.csv",
                                 "R/summary.json", "R/wire.pvd", "R/wire_000005.vtp"}) {
            CAPTURE(name);
            if (name[0] == 'R' && !reads) continue;  // a build that reads no frames
            const fs::path file = folder.path / name, kept = folder.path / "kept";
            REQUIRE(fs::exists(file));
            fs::rename(file, kept);
            fs::create_symlink(folder.path / "theirs", file);
            const AppResult result =
                check_refused(folder, fmt::format("report {} -o page.html", name[0] == 'B' ? "B" : "R"), 3, "is a link");
            CHECK_FALSE(has(result.err, secret));
            CHECK_FALSE(fs::exists(folder.path / "page.html"));
            fs::rename(kept, file);
        }
        if (!reads) return skip("this build reads no frames");
        folder.write("R/scene.toml", fmt::format("include = \"{}\"\n", (folder.path / "s.toml").string()));
        check_refused(folder, "report R -o page.html", 2, "includes nothing");
    }

    TEST_CASE(
        "regression: pictures of a farm are told how to look and nothing else; a parts.json that was altered shows no files "
        "elsewhere")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.01, 1) + "[output]\nwire_every = 5\n"}};
        run_ok(folder, "run s.toml -o R --quiet");
        const std::string words = "farm R --frames 0:1 -o f --tasks 1 --size 64x64 ";
        if (run_app(folder, words + "--dry-run").code != 0) return skip("no renderer");
        const std::string target = (folder.path / "written").string();
        for (const std::string word :
             {"--labels=" + target, "--labels " + target, std::string("--labels ../written"),
              std::string("--labels a/../../written"), "--gltf " + target, "--usd " + target, "--video " + target,
              "--raw " + target, "--dicom " + target, std::string("--fps 3"), "--farm " + target, "--preview " + target}) {
            CAPTURE(word);
            const AppResult result = run_app(folder, words + word);
            CHECK(result.code == 2);
            CHECK(result.error_lines() == 1);
            CHECK_FALSE(fs::exists(target));
            CHECK_FALSE(fs::exists(folder.path / "f/frame_000000.png"));
        }
        nlohmann::ordered_json plan = nlohmann::ordered_json::parse(slurp(folder.path / "f/parts.json"));
        plan["files"] = {"frame_######.png", "../written_######"};
        folder.write("f/parts.json", plan.dump());
        const AppResult result = run_app(folder, "farm status f");
        CHECK(result.code == 3);
        CHECK_MESSAGE(result.err.find("outside of its folder") != std::string::npos, result.err);
    }

    TEST_CASE("regression: labels of a farm's frames are written through no link, and lie below its folder")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.01, 1) + "[output]\nwire_every = 5\n"}};
        run_ok(folder, "run s.toml -o R --quiet");
        const std::string words = "farm R --frames 0:1 --tasks 1 --size 64x64 --labels a/truth -o ";
        if (run_app(folder, "render R --size 64x64 -o p.png").code != 0) return skip("no renderer");
        run_ok(folder, words + "f --dry-run");
        fs::create_directory(folder.path / "elsewhere");
        fs::create_symlink(folder.path / "elsewhere", folder.path / "f/a");
        const AppResult linked = run_app(folder, words + "f");
        CHECK(linked.code == 4);
        CHECK_MESSAGE(linked.err.find("f/a: is a link or no folder") != std::string::npos, linked.err);
        CHECK(fs::is_empty(folder.path / "elsewhere"));
        fs::remove(folder.path / "f/a");
        run_ok(folder, words + "f");
        CHECK(fs::exists(folder.path / "f/a/truth/frame_000001.json"));
        run_ok(folder, "farm merge f");
        CHECK(run_app(folder, "farm R --frames 0:1 --tasks 1 --size 64x64 --labels ./a/truth/ -o f --dry-run").code ==
              0);  // the same farm
        for (const char* path : {"../elsewhere", "/elsewhere", "."}) {
            const AppResult outside =
                run_app(folder, fmt::format("farm R --frames 0:1 --tasks 1 --labels {} -o g --dry-run", path));
            CHECK(outside.code == 2);
            CHECK_MESSAGE(outside.err.find("expected a folder below that of the farm") != std::string::npos, outside.err);
            CHECK_FALSE(fs::exists(folder.path / "g"));
        }
    }

    TEST_CASE("regression: a job's script has no command in it that is not the farm's, and names what cannot be said")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.01)}, {"v.toml", "[vary]\n\"wire.density\" = [6000.0, 7000.0]\n"}};
        const auto farm = [&](const std::string& words) {
            return run_app(folder, "farm s.toml --vary v.toml --tasks 2 --backend slurm " + words);
        };
        for (const char* words : {"-o 'a\ntouch owned\n'", "-o 'a\"b'", "-o 'a\\b'", "-o d '--sbatch=--time=60\ntouch owned'"}) {
            CAPTURE(words);
            const AppResult result = farm(words);
            CHECK(result.code == 2);
            CHECK(has(result.err, "Fix: "));
            for (const auto& entry : fs::recursive_directory_iterator(folder.path)) CHECK(entry.path().filename() != "job.sh");
        }
        REQUIRE(farm("-o 'a b%j #c'").code == 0);
        const std::string script = slurp(folder.path / "a b%j #c/job.sh");
        CHECK(has(script, "#SBATCH --output=\"" + (folder.path / "a b%%j #c/log/slurm-%A_%a.txt").string() + "\"\n"));
    }

    TEST_CASE("regression: assets beside a program are taken where nobody else can have put them")
    {
        const ScratchFolder folder;
        for (const char* inner : {"all/bin", "all/assets/scenes", "all/assets/instruments"})
            fs::create_directories(folder.path / inner);
        fs::copy_file(app_path(), folder.path / "all/bin/seldinger");
        folder.write("all/assets/instruments/theirs.toml",
                     "title = \"theirs\"\nkind = \"wire\"\n[wire]\nradius_m = 0.0002\ndensity = 6450.0\nbend_nm2 = "
                     "5.0e-5\ntwist_nm2 = 4.0e-5\nstretch_n = 7000.0\n");
        const auto lists_theirs = [&] {
            const std::string command =
                fmt::format("env -u SELDINGER_ASSETS '{}' instruments", (folder.path / "all/bin/seldinger").string());
            std::FILE* pipe = popen(command.c_str(), "r");
            std::string text;
            for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
            pclose(pipe);
            return text.find("theirs") != std::string::npos;
        };
        CHECK(lists_theirs());  // the owner's own
        for (const char* open : {"all", "all/assets"}) {
            CAPTURE(open);
            fs::permissions(folder.path / open, fs::perms::all);
            CHECK_FALSE(lists_theirs());
            fs::permissions(folder.path / open, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec);
        }
    }
}

}  // namespace seldinger::test::test_links

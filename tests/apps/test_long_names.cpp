// Names that are longer than a file system takes, and than a line shows: of instruments, files, folders, keys, words and options.

#include "apps/app_fixture.h"

namespace seldinger::test::test_long_names {

namespace {

// beyond NAME_MAX (255), beyond PATH_MAX (4096); what the command line itself takes ends at 131,071
constexpr std::size_t lengths[] = {300, 5000};
constexpr std::size_t longest_line = 4100;

/// Exit 2 or 3, and one line that comes to its end (`says`) however long the name is that it quotes.
void is_refused(const ScratchFolder& folder, const std::string& arguments, const std::string& says = "")
{
    CAPTURE(arguments.substr(0, 60));
    CAPTURE(arguments.size());
    const AppResult result = run_app(folder, arguments, "timeout 60");
    CAPTURE(result.err);
    CHECK((result.code == 2 || result.code == 3));
    CHECK(result.error_lines() == 1);
    CHECK(result.err.size() < longest_line);
    CHECK(has(result.err, says));
    CHECK_FALSE(has(result.err, "report the command"));
}

}  // namespace

TEST_SUITE("apps/long names")
{
    TEST_CASE("property: a name on the command line that no file can have is refused in one line by every command")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        run_ok(folder, "run s.toml -o R --quiet");
        for (const std::size_t length : lengths) {
            const std::string name(length, 'a');
            for (const char* command : {"run {}.toml",
                                        "run s.toml -o {}",
                                        "run s.toml -o Z --replay {}",
                                        "check {}",
                                        "vessel {}.stl --units mm",
                                        "vessel s.toml -o {}",
                                        "init {}.stl",
                                        "init {}.stl -o {}",
                                        "render {}",
                                        "render R --gltf {}.glb",
                                        "render R --usd {}.usda",
                                        "render R --view fluoro --raw {}.npy",
                                        "render R --view fluoro --dicom {}.dcm",
                                        "report {}",
                                        "report R -o {}.html",
                                        "batch s.toml --vary {}",
                                        "plan s.toml --tolerance 1mm -o {}.toml --budget 0.1",
                                        "farm s.toml --vary {} -o F",
                                        "farm {} --frames all -o F",
                                        "farm R --frames all -o {}",
                                        "chart --quick --scenes {} -o C",
                                        "chart --planned {} --scenes s.toml -o C",
                                        "bench --quick --scenes {}",
                                        "stability --row {}",
                                        "{}",
                                        "run s.toml --{}",
                                        "render R --view {}",
                                        "run s.toml -o Z --wire {}"})
                is_refused(folder, fmt::format(fmt::runtime(command), name, name));
        }
    }

    TEST_CASE("property: a word of a scene is as long as it likes, and the line that refuses it says why")
    {
        const ScratchFolder folder;
        for (const std::size_t length : {std::size_t{300}, std::size_t{5000}, std::size_t{1'000'000}}) {
            const std::string name(length, 'a');
            const auto refused = [&](const std::string& text, const char* says) {
                folder.write("x.toml", text);
                is_refused(folder, "check x.toml", says);
            };
            refused(free_scene() + "[contact]\n" + name + " = 1\n", "unknown key; the nearest known one is");
            refused(free_scene() + "[" + name + "]\nx = 1\n", "unknown key; the nearest known one is");
            refused("include = \"" + name + "\"\n" + free_scene(), "cannot be read: File name too long");
            refused(free_scene() + "[vessel]\nmesh = \"" + name + ".stl\"\n", "aaaa.stl; check the path");
            refused(free_scene() + "[carm]\nbone = \"" + name + ".stl\"\n", "aaaa.stl; check the path");
            std::string several = two_instruments("merged");
            for (std::size_t at = 0; (at = several.find("\"wire\"", at)) != std::string::npos; at += name.size() + 2)
                several.replace(at, 6, "\"" + name + "\"");
            refused(several, "instrument.1.name: expected 1 to 40");
            // a text that is only shown may have any length
            folder.write("name.toml", free_scene().replace(free_scene().find("falling"), 7, name));
            run_ok(folder, fmt::format("run name.toml -o N{} --quiet", length));
            run_ok(folder, fmt::format("report N{}", length));
        }
        folder.write("s.toml", free_scene());
        is_refused(folder, "check s.toml --set wire." + std::string(5000, 'a') + "=1", "unknown key; the nearest known one is");
        is_refused(folder, "check s.toml --set wire.radius_m=" + std::string(5000, 'a'), "expected a number above 0");
    }

    TEST_CASE("property: the longest name that an instrument may have becomes files, and no two names become one file")
    {
        const ScratchFolder folder;
        std::string scene = two_instruments("separate");
        const std::string name(40, 'n');
        const auto named = [&](const std::string& wire) {
            std::string text = scene;
            for (std::size_t at = 0; (at = text.find("\"wire\"", at)) != std::string::npos; at += wire.size() + 2)
                text.replace(at, 6, "\"" + wire + "\"");
            return text;
        };
        folder.write("n.toml", named(name));
        run_ok(folder, "run n.toml -o N --quiet --set output.wire_every=5");
        for (const std::string& file : {"trace_" + name + ".csv", name + ".csv", name + ".pvd", name + "_000005.vtp"})
            CHECK(fs::exists(folder.path / "N" / file));
        folder.write("trace.toml", named("trace_catheter"));  // NAME.csv of the one would be trace_NAME.csv of the other
        is_refused(folder, "check trace.toml", "instrument.1.name");
    }
}

}  // namespace seldinger::test::test_long_names

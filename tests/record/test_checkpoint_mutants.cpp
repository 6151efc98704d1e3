// Checkpoints and saved states that were altered and sealed anew: each is refused in one line or run, and the world that
// refused one is unchanged. SELDINGER_MUTANTS=N tries so many of each.

#include "core/bytes.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/fnv1a.h"
#include "record/checkpoint.h"
#include "record/recorder.h"
#include "scene/scene_difference.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "support/tries.h"

#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace seldinger::test::test_checkpoint_mutants {

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

/// Overwrites a place with what counts, sizes, indices and numbers should not be.
void spoil(Bytes& bytes, std::size_t at, std::mt19937& random)
{
    const auto put = [&](const auto& value) {
        for (std::size_t k = 0; k < sizeof value && at + k < bytes.size(); ++k)
            bytes[at + k] = reinterpret_cast<const std::uint8_t*>(&value)[k];
    };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    switch (random() % 14) {
        case 0:
            return put(std::numeric_limits<double>::quiet_NaN());
        case 1:
            return put(random() % 2 ? infinity : -infinity);
        case 2:
            return put(1e300);
        case 3:
            return put(-1e17);
        case 4:
            return put(9e3);  // within what a length may be
        case 5:
            return put(-1.0);
        case 6:
            return put(0.0);
        case 7:
            return put(1e-300);
        case 8:
            return put(~std::uint64_t{0});
        case 9:
            return put(std::int64_t{-1} << 62);
        case 10:
            return put(std::uint32_t{0x7fffffff});
        case 11:
            return put(static_cast<std::int32_t>(random() % 5) - 2);
        case 12:
            bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
            return;
        default:
            bytes[at] = static_cast<std::uint8_t>(random());
    }
}

fs::path source(const std::string& name) { return fs::path(SEL_SOURCE_DIR) / name; }

struct Case {
    std::string name;
    const char* scene;
    std::vector<std::string> set;
    int steps;
};

const std::vector<Case>& cases()
{
    static const std::vector<Case> all = {
        {"swept", "tests/golden/bend.toml", {}, 120},
        {"layer", "tests/golden/bend.toml", {"contact.detection=layer"}, 120},
        {"nodes that come and go", "tests/golden/bend.toml", {"wire.nodes=adaptive"}, 120},
        {"barrier", "tests/golden/bend.toml", {"contact.normal=barrier"}, 120},
        {"an elastic wall",
         "tests/golden/bend.toml",
         {"vessel.wall=elastic", "vessel.youngs_pa=1e6", "vessel.thickness_m=0.0008"},
         120},
        {"catheter over wire", "assets/scenes/catheter-over-wire.toml", {}, 3},
        {"two rods that touch", "assets/scenes/catheter-over-wire.toml", {"coaxial.model=separate"}, 300},
    };
    return all;
}

Scene read_case(const Case& one) { return read_scene(source(one.scene), one.set); }

void advance(World& world, KeyFrames& keys, const Scene& scene, int steps)
{
    for (int k = 0; k < steps; ++k) (void)step(world, keys.control(), scene.dt);
}

/// Tries to restore and to go on. @return whether it was taken
bool try_state(World& world, const Scene& scene, const Bytes& state)
{
    try {
        world.restore_state(state);
    } catch (const Error& error) {
        CHECK(error.kind() == ErrorKind::BadFile);
        CHECK(std::string(error.what()).find('\n') == std::string::npos);
        return false;
    }
    KeyFrames keys(scene);
    (void)world.output(Output::Everything);
    advance(world, keys, scene, 2);
    (void)world.output(Output::Everything);
    (void)world.state_hash();
    return true;
}

void seal(const fs::path& file, const Bytes& payload)
{
    Bytes bytes;
    put_bytes(bytes, "SELCKPT5", 8);
    const std::uint64_t size = payload.size(), hash = fnv1a(payload.data(), payload.size());
    put_bytes(bytes, &size, 1);
    put_bytes(bytes, payload.data(), payload.size());
    put_bytes(bytes, &hash, 1);
    write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

TEST_SUITE("record/checkpoint mutants")
{
    TEST_CASE("property: a saved state with any number altered is refused or run, and the world stays what it was")
    {
        for (const Case& one : cases()) {
            INFO(one.name);
            const Scene scene = read_case(one);
            World world(make_setup(scene));
            KeyFrames keys(scene);
            advance(world, keys, scene, one.steps);
            const Bytes good = world.save_state();
            const std::string hash = world.state_hash();
            advance(world, keys, scene, 3);
            const std::string later = world.state_hash();
            world.restore_state(good);
            std::mt19937 random(7);
            long taken = 0, refused = 0;
            for (long k = 0, n = test::tries("SELDINGER_MUTANTS", 250); k < n; ++k) {
                Bytes bad = good;
                CAPTURE(k);
                for (unsigned times = 1 + random() % 2; times > 0; --times) spoil(bad, random() % bad.size(), random);
                if (random() % 50 == 0) bad.resize(random() % bad.size());
                if (random() % 50 == 0) bad.resize(bad.size() + random() % 100);
                if (bad == good) continue;
                if (try_state(world, scene, bad)) {
                    ++taken;
                    world.restore_state(good);
                } else {
                    ++refused;
                    CHECK(world.state_hash() == hash);
                }
            }
            CHECK(refused > taken / 10);
            World again(make_setup(scene));
            KeyFrames fresh(scene);
            again.restore_state(good);
            advance(again, fresh, scene, 3);
            CHECK(again.state_hash() == later);
            MESSAGE(one.name << ": " << refused << " refused, " << taken << " run");
        }
    }

    TEST_CASE("property: a checkpoint with any byte of its own altered, and sealed anew, is refused or gone on from")
    {
        const TemporaryFolder folder;
        const Scene scene = read_case(cases()[0]);
        const RepairReport none;
        const fs::path dir = folder.path() / "run", file = dir / "checkpoint.bin";
        World world(make_setup(scene));
        {
            Recorder recorder(scene, none, world, dir);
            KeyFrames keys(scene);
            for (int k = 0; k < 60; ++k) {
                const StepReport report = step(world, keys.control(), scene.dt);
                recorder.stepped(world.output(), report, 0.001);
            }
            recorder.checkpoint(world, RunStatus::Interrupted, 0.1);
        }
        const std::string sealed = read_file(file), trace = read_file(dir / "trace.csv");
        const Bytes good(sealed.begin() + 16, sealed.end() - 8);
        const std::size_t head = good.size() - read_checkpoint(file).state.size();
        std::mt19937 random(11);
        long refused = 0, taken = 0;
        const long each = std::max(1l, test::tries("SELDINGER_MUTANTS", 250) / 250);
        for (std::size_t at = 0; at < head; ++at)
            for (long k = 0; k < each; ++k) {
                CAPTURE(at);
                Bytes bad = good;
                if (at + 1 < head && random() % 3) spoil(bad, at, random);
                else bad[at] ^= 0x81;
                seal(file, bad);
                try {
                    const Checkpoint saved = read_checkpoint(file);
                    check_checkpoint(file, saved, scene, write_scene(scene, dir));
                    Recorder recorder(scene, none, world, dir, saved);
                    (void)recorder.finish(world, RunStatus::Interrupted, 1.0);
                    ++taken;
                } catch (const Error& error) {
                    CHECK(error.kind() == ErrorKind::BadFile);
                    ++refused;
                }
                write_file(dir / "trace.csv", trace);
            }
        MESSAGE(refused << " refused, " << taken << " gone on from");
        CHECK(refused > 2 * taken);  // what remains are maxima and times, which no other field knows
    }

    TEST_CASE("property: a checkpoint is of one scene, and the error names what differs")
    {
        const TemporaryFolder folder;
        const Scene scene = read_case(cases()[0]);
        Checkpoint saved{.scene = write_scene(scene, folder.path()), .trace_bytes = {0}};
        const auto refusal = [&](const std::vector<std::string>& set) {
            const Scene other = read_scene(source(cases()[0].scene), set);
            return test::refusal([&] { check_checkpoint("D/checkpoint.bin", saved, other, write_scene(other, folder.path())); });
        };
        CHECK(refusal({}).empty());
        CHECK(refusal({"contact.mu_sliding=0.1"}).find("mu_sliding is 0.2 there and 0.1 here") != std::string::npos);
        CHECK(refusal({"scene.dt_s=0.002"}).find("[scene] dt_s") != std::string::npos);
        CHECK(refusal({"vessel.radius_m=0.005"}).find("[vessel] radius_m") != std::string::npos);
    }

    TEST_CASE("property: two checkpoints of one state are the same bytes, whatever lay in memory before")
    {
        const TemporaryFolder folder;
        const auto bytes_over = [&](unsigned char before) {
            alignas(Checkpoint) unsigned char memory[sizeof(Checkpoint)];
            std::memset(memory, before, sizeof memory);
            auto* saved = new (memory) Checkpoint;  // not (): that would make zeros of all of it first
            write_checkpoint(folder.path() / "c", *saved);
            saved->~Checkpoint();
            return read_file(folder.path() / "c");
        };
        CHECK(bytes_over(0xaa) == bytes_over(0x55));
    }

    TEST_CASE("property: a flag that is neither 0 nor 1 is refused")
    {
        Checkpoint saved;
        const Scene scene = read_case(cases()[0]);
        saved.trace_bytes = {0};
        CHECK_NOTHROW(check_checkpoint("D/checkpoint.bin", saved, scene, ""));
        saved.tally.on_wall.widened = 2;
        CHECK_THROWS_AS(check_checkpoint("D/checkpoint.bin", saved, scene, ""), Error);
    }

    TEST_CASE("analytic: the first difference of two scenes")
    {
        CHECK(first_difference("[a]\nx = 1\n", "[a]\nx = 1\n").empty());
        CHECK(first_difference("[a]\nx = 1\n", "[a]\nx = 2\n") == "[a] x is 1 there and 2 here");
        CHECK(first_difference("[a]\n", "[a]\nx = 2\n") == "[a] x is not there");
        CHECK(first_difference("[a]\nx = 1\ny = 2\n", "[a]\nx = 1\n") == "[a] y is not here");
        CHECK(first_difference("[a]\nx = \"\x1b[2J\"\n", "[a]\nx = 1\n") == "[a] x is \"?[2J\" there and 1 here");
    }
}

}  // namespace seldinger::test::test_checkpoint_mutants

// The folders' order (engine/README.md), kept true by reading every #include line.

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace test_includes {

namespace {

namespace fs = std::filesystem;

// folder -> folders it may include. "api" means the headers of engine/include/seldinger itself; its folders count as those of
// engine/. "step" is engine/step.cpp. No exceptions.
const std::map<std::string, std::set<std::string>> below = {
    {"shared", {}},
    {"core", {"shared"}},
    {"math", {"core", "shared"}},
    {"device", {"core", "shared"}},
    {"rod", {"device", "math", "core", "shared"}},
    {"nodes", {"rod", "math", "core"}},
    {"vessel", {"device", "math", "core", "shared"}},
    {"shapes", {"vessel", "math", "core"}},
    {"repair", {"vessel", "core"}},
    {"voxels", {"vessel", "math", "core"}},
    {"wall", {"vessel", "math", "core"}},
    {"solve", {"nodes", "rod", "math", "core", "shared"}},
    {"newton", {"solve", "rod", "math", "core"}},
    {"contact", {"solve", "wall", "rod", "vessel", "device", "math", "core", "shared"}},
    {"contact/rods", {"contact", "solve", "nodes", "rod", "vessel", "device", "math", "core", "shared"}},
    {"api", {"contact", "solve", "wall", "rod", "vessel", "device", "math", "core"}},
    {"world",
     {"api", "contact", "contact/rods", "newton", "solve", "wall", "nodes", "rod", "repair", "vessel", "device", "math", "core",
      "shared"}},
    {"stages", {"world", "api", "contact", "contact/rods", "rod", "repair", "device", "core"}},
    {"step", {"stages", "world", "core"}},
    {"algebra", {"math", "core"}},
    {"surface", {"vessel", "math", "core"}},
    {"shell", {"algebra", "surface", "contact", "wall", "vessel", "math", "core"}},
    {"coupling", {"shell", "surface", "contact", "solve", "wall", "rod", "vessel", "device", "math", "core", "shared"}},
    {"io", {"voxels", "vessel", "math", "core"}},
    {"scene", {"io", "world", "api", "contact", "solve", "rod", "math", "core"}},
    {"setup", {"scene", "io", "api", "wall", "rod", "repair", "shapes", "vessel", "math", "core"}},
    {"xray", {"vessel", "math", "core"}},
    {"view", {"io", "rod", "vessel", "math", "core"}},
    {"pictures", {"view", "xray", "scene", "io", "repair", "vessel", "core"}},
    {"bands", {"setup", "scene", "world", "api", "nodes", "vessel", "math", "core"}},
    {"run",
     {"bands", "setup", "scene", "io", "world", "api", "contact", "solve", "wall", "nodes", "rod", "repair", "vessel", "math",
      "core"}},
    {"record", {"run", "bands", "setup", "scene", "io", "api", "math", "core"}},
    {"batch", {"record", "run", "bands", "setup", "scene", "io", "api", "vessel", "core"}},
    {"models", {"run", "setup", "scene", "api", "contact", "solve", "wall", "math", "core"}},
    {"plan", {"models", "core"}},
    {"lab",
     {"models", "run", "setup", "scene", "io", "api", "contact", "solve", "wall", "rod", "repair", "shapes", "vessel", "device",
      "math", "core"}},
    {"session", {"record", "run", "scene", "io", "api", "core"}},
    {"report", {"session", "batch", "models", "view", "run", "scene", "io", "core"}},
};

// The rooms of engine/, and the folders of each. The first four are the engine; no folder of these may include the last four,
// which are optional libraries: the table above says so folder by folder.
const std::map<std::string, std::set<std::string>> rooms = {
    {"base", {"core", "math", "device"}},
    {"bodies", {"rod", "nodes", "vessel", "shapes", "repair", "voxels", "wall"}},
    {"physics", {"solve", "newton", "contact", "world", "stages"}},
    {"files", {"io", "scene", "setup", "bands", "run", "record"}},
    {"elastic", {"algebra", "surface", "shell", "coupling"}},
    {"pictures", {"xray", "view", "pictures", "report"}},
    {"studies", {"batch", "models", "plan", "lab"}},
    {"live", {"session"}},
};
const std::set<std::string> optional_rooms = {"elastic", "pictures", "studies", "live"};

// Path below engine/ -> path as an #include names it, without the room
fs::path as_included(const fs::path& from_root)
{
    const std::string first = from_root.begin()->string();
    if (first == "include") return fs::relative(from_root, "include/seldinger");
    return rooms.count(first) ? fs::relative(from_root, first) : from_root;
}

std::string folder_of(const fs::path& relative)
{
    // a room within a folder has a line of its own in the table
    const std::string parent = relative.parent_path().generic_string();
    if (below.count(parent)) return parent;
    if (relative.has_parent_path()) return relative.begin()->string();
    return relative.extension() == ".cpp" ? "step" : "api";
}

}  // namespace

TEST_SUITE("core/includes")
{
    TEST_CASE("property: folders include downwards only")
    {
        const fs::path root = fs::path(SEL_SOURCE_DIR) / "engine";
        const std::regex include(R"re(^\s*#\s*include\s+"([^"]+)")re");
        int seen = 0;
        for (const fs::path base : {root, fs::path(SEL_SOURCE_DIR) / "kernels"})
            for (const auto& entry : fs::recursive_directory_iterator(base)) {
                const std::string extension = entry.path().extension();
                if (extension != ".h" && extension != ".cpp" && extension != ".cl") continue;
                const fs::path from_root = fs::relative(entry.path(), base),
                               relative = base == root ? as_included(from_root) : from_root;
                // kernels/<folder>/*.cl and kernels/shared read kernels/shared alone
                const std::string folder = base == root ? folder_of(relative) : "shared";
                REQUIRE_MESSAGE(below.count(folder) == 1, "a new folder needs its place in the table: " << folder);
                std::ifstream in(entry.path());
                std::smatch match;
                for (std::string line; std::getline(in, line);) {
                    if (!std::regex_search(line, match, include)) continue;
                    ++seen;
                    const std::string target = match[1];
                    const std::string to = folder_of(target);
                    const bool allowed = to == folder || below.at(folder).count(to);
                    CHECK_MESSAGE(allowed, relative.string() << " includes " << target);
                }
            }
        REQUIRE(seen > 200);
    }

    TEST_CASE("property: a folder of engine/ lies in its room, and the engine includes no optional library")
    {
        const fs::path root = fs::path(SEL_SOURCE_DIR) / "engine";
        std::set<std::string> found;
        for (const auto& room : fs::directory_iterator(root)) {
            if (!room.is_directory() || room.path().filename() == "include") continue;
            const std::string name = room.path().filename();
            REQUIRE_MESSAGE(rooms.count(name) == 1, "engine/" << name << " is not a room");
            for (const auto& folder : fs::directory_iterator(room))
                CHECK_MESSAGE(rooms.at(name).count(folder.path().filename()) == 1, folder.path().string()
                                                                                       << ": not a folder of " << name);
            for (const std::string& folder : rooms.at(name)) {
                CHECK_MESSAGE(fs::is_directory(room.path() / folder), "engine/" << name << "/" << folder << " is not there");
                found.insert(folder);
            }
        }
        CHECK(found.size() == 34);
        for (const auto& [room, folders] : rooms) {
            if (optional_rooms.count(room)) continue;
            for (const std::string& folder : folders)
                for (const std::string& optional_room : optional_rooms)
                    for (const std::string& part : rooms.at(optional_room))
                        CHECK_MESSAGE(below.at(folder).count(part) == 0,
                                      folder << " may not include " << part << ", of an optional library");
        }
    }

    // what calls OpenCL must link it: the command and the Python extension link the engine alone
    TEST_CASE("property: OpenCL is named in engine/base/device alone, and called nowhere else")
    {
        const fs::path root = SEL_SOURCE_DIR;
        const std::regex included(R"(^\s*#\s*include\s*[<"](CL|OpenCL)/)"),
            named(R"(\b(cl_[a-z]+\w*|cl[A-Z]\w*\s*\(|CL_[A-Z]\w*))");
        int seen = 0;
        for (const char* folder : {"engine", "apps", "bench", "python/src", "tests", "docs/example"})
            for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
                const std::string extension = entry.path().extension(), file = fs::relative(entry.path(), root).generic_string();
                if ((extension != ".h" && extension != ".cpp") || file.starts_with("engine/base/device/")) continue;
                ++seen;
                const bool may_name =
                    file.starts_with("engine/") || file.starts_with("tests/");  // its numbers are arguments of kernels
                std::ifstream in(entry.path());
                std::smatch match;
                for (std::string line; std::getline(in, line);) {
                    CHECK_MESSAGE(!std::regex_search(line, match, included), file << ": " << line);
                    if (!may_name) CHECK_MESSAGE(!std::regex_search(line, match, named), file << ": names OpenCL: " << line);
                }
            }
        REQUIRE(seen > 500);
    }

    // that list is read by a build of its own, which plain builds never configure
    TEST_CASE("property: every source that the fuzz targets name exists")
    {
        const fs::path root = SEL_SOURCE_DIR;
        std::ifstream in(root / "tests/fuzz/CMakeLists.txt");
        REQUIRE(in.good());
        const std::regex source(R"(\$\{engine\}/([a-z0-9_/]+\.cpp))");
        int seen = 0;
        for (std::string line; std::getline(in, line);)
            for (auto match = std::sregex_iterator(line.begin(), line.end(), source); match != std::sregex_iterator(); ++match) {
                ++seen;
                const fs::path file = root / "engine" / (*match)[1].str();
                CHECK_MESSAGE(fs::exists(file), "tests/fuzz/CMakeLists.txt names "
                                                    << file.string() << ", which is gone: rename it there or take it out");
            }
        REQUIRE(seen > 20);
    }
}

}  // namespace test_includes

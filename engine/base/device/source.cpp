// Puts the text of a kernel file together from the embedded sources, or from SEL_KERNEL_DIR if that is set (to change kernels
// without a rebuild).
#include "core/error.h"
#include "device/device.h"
#include "device/kernel_sources.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <mutex>
#include <set>
#include <sstream>

namespace seldinger::device {
namespace {

std::mutex added_guard;
std::set<const std::vector<KernelSource>*> added;

const KernelSource* find_in(const std::vector<KernelSource>& sources, const std::string& name)
{
    for (const KernelSource& source : sources)
        if (source.name == name) return &source;
    return nullptr;
}

const KernelSource* find_added(const std::string& name)
{
    const std::lock_guard lock(added_guard);
    for (const auto* sources : added)
        if (const KernelSource* one = find_in(*sources, name)) return one;
    return nullptr;
}

std::string text_of_file(const std::string& name)
{
    if (const char* folder = std::getenv("SEL_KERNEL_DIR")) {
        std::ifstream in(std::string(folder) + "/" + name);
        std::stringstream text;
        if (in) return text << in.rdbuf(), text.str();
        if (const KernelSource* own = find_added(name)) return std::string(own->text);
        throw Error(ErrorKind::NoDevice, fmt::format("SEL_KERNEL_DIR: no kernel file {}/{}", folder, name));
    }
    if (const KernelSource* own = find_in(embedded_kernels(), name)) return std::string(own->text);
    if (const KernelSource* own = find_added(name)) return std::string(own->text);
    throw Error(ErrorKind::NoDevice, fmt::format("no kernel file \"{}\" in this build", name));
}

void append(const std::string& name, std::set<std::string>& seen, std::string& out)
{
    if (!seen.insert(name).second) return;
    std::istringstream in(text_of_file(name));
    std::string line;
    int number = 0;
    out += fmt::format("#line 1 \"kernels/{}\"\n", name);
    while (std::getline(in, line)) {
        ++number;
        const std::string key = "#include \"";
        if (line.rfind(key, 0) == 0) {
            append(line.substr(key.size(), line.find('"', key.size()) - key.size()), seen, out);
            out += fmt::format("#line {} \"kernels/{}\"\n", number + 1, name);
        } else {
            out += line + "\n";
        }
    }
}

}  // namespace

void add_kernel_sources(const std::vector<KernelSource>& sources)
{
    const std::lock_guard lock(added_guard);
    added.insert(&sources);
}

std::string assemble_source(const std::string& file)
{
    std::set<std::string> seen;
    std::string out;
    std::istringstream files(file);
    for (std::string one; std::getline(files, one, '+');) append(one, seen, out);
    return out;
}

}  // namespace seldinger::device

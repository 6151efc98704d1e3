// Puts the text of a kernel file together from the embedded sources, or from SEL_KERNEL_DIR when that is set (for people who
// work on kernels: no rebuild needed).

#include "core/error.h"
#include "device/device.h"
#include "device/kernel_sources.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

namespace seldinger::device {

namespace {

std::string text_of_file(const std::string& name)
{
    if (const char* folder = std::getenv("SEL_KERNEL_DIR")) {
        std::ifstream in(std::string(folder) + "/" + name);
        if (!in) throw Error(ExitCode::NoDevice, fmt::format("SEL_KERNEL_DIR: no kernel file {}/{}", folder, name));
        std::stringstream text;
        text << in.rdbuf();
        return text.str();
    }
    for (const KernelSource& source : embedded_kernels())
        if (source.name == name) return source.text;
    throw Error(ExitCode::NoDevice, fmt::format("no kernel file \"{}\" in this build", name));
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

std::string assemble_source(const std::string& file)
{
    std::set<std::string> seen;
    std::string out;
    append(file, seen, out);
    return out;
}

}  // namespace seldinger::device

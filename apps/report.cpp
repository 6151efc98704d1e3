// seldinger report DIR [-o report.html]

#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "report/report_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace seldinger::apps {

void add_report(CommandLine& app, Command& chosen)
{
    struct Options {
        std::filesystem::path dir, file;
    };
    auto options = std::make_shared<Options>();
    CommandLine* command = app.add_subcommand("report", "a run or a batch as one web page that needs nothing else");
    command->add_option("DIR", options->dir, "folder of a run or of a batch")->required();
    command->add_option("-o", options->file, "file to write (default: DIR/report.html)")->type_name("FILE");
    command->callback([options, &chosen] {
        chosen = [options] {
            if (options->file.empty()) options->file = options->dir / "report.html";
            const std::string page = report_page(options->dir);
            make_folder_of(options->file);
            write_file(options->file, page);
            print(fmt::format("{}\n", options->file.string()));
            return ErrorKind::None;
        };
    });
}

}  // namespace seldinger::apps

// seldinger instruments: what [wire] preset may name, one line each.

#include "command_line.h"
#include "scene/instruments.h"
#include "commands.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger::apps {
namespace {

/// As it is sold: wires in inches, catheters by their outer diameter in French (three to a millimetre), sheaths by what fits in.
std::string size_of(const Instrument& instrument)
{
    const double mm = 2e3 * instrument.wire.shaft.radius;
    if (instrument.kind == "wire") return fmt::format("{:.3f} in", mm / 25.4);
    return fmt::format("{:.1f} F", 3 * mm);
}

std::string line_of(const Instrument& instrument)
{
    const WireSpec& wire = instrument.wire;
    double low = wire.shaft.bend_stiffness, high = low;
    for (const WireSectionRange& range : wire.sections) {
        low = std::min(low, range.section.bend_stiffness);
        high = std::max(high, range.section.bend_stiffness);
    }
    const std::string lumen = wire.lumen_radius > 0 ? fmt::format("{:.2f}", 2e3 * wire.lumen_radius) : "-";
    return fmt::format("{:<24} {:<9} {:<9} {:>6.3f}  {:>5}  {:.1e} - {:.1e}  {}\n", instrument.name, instrument.kind,
                       size_of(instrument), 2e3 * wire.shaft.radius, lumen, low, high, instrument.title);
}

ErrorKind list_instruments()
{
    std::string text = fmt::format("{:<24} {:<9} {:<9} {:>6}  {:>5}  {:<17}  {}\n", "name", "kind", "outside", "mm", "lumen",
                                   "EI from - to, Nm2", "what");
    const std::vector<Instrument> all = instruments();
    for (const Instrument& instrument : all) text += line_of(instrument);
    text += fmt::format("{} instruments in {}\n", all.size(), instrument_file("").parent_path().string());
    print(text);
    return ErrorKind::None;
}

}  // namespace

void add_instruments(CommandLine& app, Command& chosen)
{
    CommandLine* command = app.add_subcommand("instruments", "list the wires, catheters and sheaths of the catalogue");
    command->callback([&chosen] { chosen = list_instruments; });
}

}  // namespace seldinger::apps

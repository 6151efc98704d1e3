// Finds headers, comments and field strings of each format, and the two words in them.
#include "io/file_remarks.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/label_map.h"
#include "io/mesh_file.h"
#include "io/text_words.h"
#include "io/vtp_read.h"

#include <algorithm>
#include <fstream>

namespace seldinger {
namespace {

constexpr std::size_t beginning = 1 << 16;  // longer than any header that programs write [bytes]

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// The word behind `key`, "=" or ":" in a text; empty: there is none.
std::string_view value_of(std::string_view text, std::string_view key)
{
    for (std::size_t k = 0; k + key.size() < text.size(); ++k) {
        if (!same_word(text.substr(k, key.size()), key) || (k > 0 && is_letter(text[k - 1]))) continue;
        std::size_t at = k + key.size();
        while (at < text.size() && text[at] == ' ') ++at;
        if (at == text.size() || (text[at] != '=' && text[at] != ':')) continue;
        for (++at; at < text.size() && (text[at] == ' ' || text[at] == '"');) ++at;
        std::size_t end = at;
        while (end < text.size() && (is_letter(text[end]) || text[end] == '-')) ++end;
        if (end > at) return text.substr(at, end - at);
    }
    return {};
}

FileAxes axes_in(std::string_view text)
{
    const std::string_view word = value_of(text, "space");
    if (same_word(word, "ras") || same_word(word, "right-anterior-superior")) return FileAxes::Ras;
    if (same_word(word, "lps") || same_word(word, "left-posterior-superior")) return FileAxes::Lps;
    return FileAxes::Unsaid;
}

std::string units_in(std::string_view text)
{
    constexpr std::pair<std::string_view, const char*> names[] = {
        {"mm", "mm"}, {"millimeter", "mm"}, {"millimeters", "mm"}, {"millimetre", "mm"}, {"millimetres", "mm"},
        {"cm", "cm"}, {"centimeter", "cm"}, {"centimeters", "cm"}, {"centimetre", "cm"}, {"centimetres", "cm"},
        {"m", "m"},   {"meter", "m"},       {"meters", "m"},       {"metre", "m"},       {"metres", "m"},
        {"um", "um"}, {"micrometer", "um"}, {"micrometers", "um"}, {"micron", "um"},     {"microns", "um"},
        {"in", "in"}, {"inch", "in"},       {"inches", "in"}};
    for (const char* key : {"units", "unit"})
        for (const auto& [name, unit] : names)
            if (same_word(value_of(text, key), name)) return unit;
    return {};
}

/// Lines that begin with `#`.
std::string obj_comments(std::string_view text)
{
    std::string comments;
    for (TextWords lines(text); !lines.at_end() && comments.size() < most_remarks;)
        if (const std::string_view line = lines.line(); line.starts_with('#')) comments.append(line).push_back('\n');
    return comments;
}

/// FieldData stand before the pieces; strings may lie in the appended data behind them.
std::string vtp_remarks(std::string_view bytes, const std::string& name)
{
    const std::size_t piece = bytes.find("<Piece"), appended = bytes.rfind("<AppendedData");
    if (piece == std::string_view::npos || bytes.find("<FieldData") > piece) return {};
    std::string file(bytes.substr(0, piece));
    file += "</PolyData>";
    if (file.find("\"appended\"") != std::string::npos && appended != std::string_view::npos && appended > piece)
        file.append(bytes.substr(appended));
    else file += "</VTKFile>";
    return parse_poly_data(file, name, PolyParts::Remarks).remarks;
}

std::string remark_text(std::string_view bytes, const std::filesystem::path& name)
{
    const std::string extension = lower_extension(name);
    const std::string_view front = without_mark(bytes.substr(0, beginning));
    if (extension == ".stl") {
        const bool text = same_word(TextWords(front).word().substr(0, 5), "solid");
        return std::string(text ? TextWords(front.substr(front.find_first_not_of(" \t\r\n"))).line() : front.substr(0, 80));
    }
    if (extension == ".ply") return std::string(front.substr(0, front.find("end_header")));
    if (extension == ".obj") return obj_comments(front);
    if (extension == ".vtk") return parse_legacy_vtk(std::string(front), name.string(), PolyParts::Remarks).remarks;
    if (extension == ".vtp") return vtp_remarks(bytes, name.string());
    return {};
}

}  // namespace

FileRemarks remarks_in(std::string_view bytes, const std::filesystem::path& name)
{
    if (is_label_map(name)) return {FileAxes::Lps, "mm", true};
    try {
        const std::string text = remark_text(bytes, name);
        return {axes_in(text), units_in(text)};
    } catch (const Error&) {  // whoever reads the mesh says what is wrong with it
        return {};
    }
}

FileRemarks remarks_of_file(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::string bytes(beginning, '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    const std::size_t piece = bytes.find("<Piece");
    const std::string_view before = std::string_view(bytes).substr(0, piece);
    if (lower_extension(path) != ".vtp" || before.find("\"appended\"") == std::string_view::npos) return remarks_in(bytes, path);
    try {
        return remarks_in(read_file(path), path);
    } catch (const Error&) {
        return {};
    }
}

}  // namespace seldinger

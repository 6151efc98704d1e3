// The C-arm's frame, projection and words.
#include "xray/c_arm.h"

#include "core/error.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace seldinger {
namespace {

constexpr double degree = std::numbers::pi / 180;

[[noreturn]] void refuse(const std::string& text)
{
    throw Error(
        ErrorKind::BadScene,
        fmt::format(
            "--c-arm: got \"{}\"; expected LAO or RAO (0 to 180) and CRA or CAU (0 to 90) in degrees, e.g. \"LAO 30, CRA 15\"",
            text));
}

/// Words and numbers in turn, commas taken as spaces.
std::vector<std::string> words_of(const std::string& text)
{
    std::vector<std::string> words;
    bool inside = false;
    for (const char c : text) {
        const bool gap = c == ',' || std::isspace(static_cast<unsigned char>(c));
        if (!gap && !inside) words.emplace_back();
        if (!gap) words.back() += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        inside = !gap;
    }
    return words;
}

bool number_of(const std::string& word, double& value)
{
    char* end = nullptr;
    value = std::strtod(word.c_str(), &end);
    return !word.empty() && *end == 0 && std::isfinite(value);
}

/// Angles of pairs such as LAO 30. @return false where the words are no such pairs
bool named_angles(const std::vector<std::string>& words, double& primary, double& secondary)
{
    bool seen[2] = {false, false};
    for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
        const std::string& word = words[i];
        const bool about_head = word == "LAO" || word == "RAO", minus = word == "RAO" || word == "CAU" || word == "CAUD";
        if (!about_head && word != "CRA" && word != "CRAN" && word != "CAU" && word != "CAUD") return false;
        double angle = 0;
        if (!number_of(words[i + 1], angle) || angle < 0 || seen[about_head]) return false;
        seen[about_head] = true;
        (about_head ? primary : secondary) = minus ? -angle : angle;
    }
    return !words.empty() && words.size() % 2 == 0;
}

}  // namespace

CArmView::CArmView(const CArm& arm) : sid(arm.sid), sod(arm.sod), pixel(arm.pixel()), columns(arm.columns), rows(arm.rows)
{
    const double cp = std::cos(arm.primary), sp = std::sin(arm.primary), cs = std::cos(arm.secondary),
                 ss = std::sin(arm.secondary);
    const Vec3 left = arm.back.cross(arm.head);
    const auto scene = [&](double l, double p, double h) -> Vec3 { return l * left + p * arm.back + h * arm.head; };
    direction = scene(sp * cs, -cp * cs, ss);
    right = scene(cp, sp, 0);
    up = direction.cross(right);
    source = arm.isocentre - arm.sod * direction;
}

CArmPoint project(const CArmView& view, const Vec3& point)
{
    const Vec3 x = point - view.source;
    CArmPoint at;
    at.depth = x.dot(view.direction);
    at.magnification = view.sid / at.depth;
    at.column = 0.5 * (view.columns - 1) + at.magnification * x.dot(view.right) / view.pixel;
    at.row = 0.5 * (view.rows - 1) - at.magnification * x.dot(view.up) / view.pixel;
    return at;
}

void set_angles(CArm& arm, const std::string& text)
{
    const std::vector<std::string> words = words_of(text);
    double primary = 0, secondary = 0;
    const bool plain = words.size() == 2 && number_of(words[0], primary) && number_of(words[1], secondary);
    if (!plain && !named_angles(words, primary, secondary)) refuse(text);
    if (std::abs(primary) > 180 || std::abs(secondary) > 90) refuse(text);
    arm.primary = primary * degree;
    arm.secondary = secondary * degree;
}

std::string angle_words(const CArm& arm)
{
    return fmt::format("{} {:.4g}, {} {:.4g}", arm.primary < 0 ? "RAO" : "LAO", std::abs(arm.primary) / degree,
                       arm.secondary < 0 ? "CAU" : "CRA", std::abs(arm.secondary) / degree);
}

void check(const CArm& arm)
{
    if (!(arm.sod > 0 && arm.sid > arm.sod && arm.sid <= 10))
        throw Error(ErrorKind::BadScene, fmt::format("SID {} m, SOD {} m: expected 0 < SOD < SID <= 10 m", arm.sid, arm.sod));
    if (!(arm.field > 0 && arm.field <= 2))
        throw Error(ErrorKind::BadScene,
                    fmt::format("--field: got {} m; expected the detector's width above 0, at most 2 m", arm.field));
    if (arm.columns < 1 || arm.rows < 1 || arm.columns > 8192 || arm.rows > 8192)
        throw Error(ErrorKind::BadScene,
                    fmt::format("--size: got {}x{}; expected 1x1 to 8192x8192 pixels", arm.columns, arm.rows));
}

}  // namespace seldinger

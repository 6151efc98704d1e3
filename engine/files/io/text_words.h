#pragma once
// Words, lines and numbers of a text, one after the other and without copies. Numbers are the doubles nearest to the text.

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

namespace seldinger {

class TextWords {
public:
    explicit TextWords(std::string_view text) : text_(text) {}

    /// The next word, "" at the end.
    std::string_view word()
    {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
        const std::size_t start = at_;
        while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        return text_.substr(start, at_ - start);
    }
    /// The rest of this line, without its end ("\n", "\r\n" or "\r"); the next call gives the next line.
    std::string_view line()
    {
        const std::size_t start = at_;
        while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
        const std::string_view result = text_.substr(start, at_ - start);
        if (at_ + 1 < text_.size() && text_[at_] == '\r' && text_[at_ + 1] == '\n') ++at_;
        if (at_ < text_.size()) ++at_;
        return result;
    }
    [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }
    [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }

private:
    static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }
    std::string_view text_;
    std::size_t at_ = 0;
};

/// The text behind the byte-order mark that some editors and spreadsheets put before UTF-8.
inline std::string_view without_mark(std::string_view text)
{
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

/// The whole of `word` as a number; nothing where it is none. Beyond the range of a double: infinity, or the double nearest to
/// 0.
inline std::optional<double> number(std::string_view word)
{
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range) return std::strtod(std::string(word).c_str(), nullptr);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

/// The beginning of `text` for a message, without control characters.
inline std::string excerpt(std::string_view text)
{
    std::string shown(text.substr(0, 48));
    for (char& c : shown)
        if (c < ' ' || c > '~') c = '?';
    return shown;
}

/// The text without blanks and tabs around it.
inline std::string_view trimmed(std::string_view text)
{
    const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// The text with A to Z as a to z.
inline std::string lower_case(std::string_view text)
{
    std::string lower(text);
    for (char& c : lower) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
    return lower;
}

/// @param lower  in lower case
inline bool same_word(std::string_view word, std::string_view lower)
{
    if (word.size() != lower.size()) return false;
    for (std::size_t k = 0; k < word.size(); ++k)
        if ((word[k] >= 'A' && word[k] <= 'Z' ? word[k] + 32 : word[k]) != lower[k]) return false;
    return true;
}

/// `lower`, in any case, somewhere in the text.
inline bool has_word(std::string_view text, std::string_view lower)
{
    for (std::size_t k = 0; k + lower.size() <= text.size(); ++k)
        if ((text[k] | 32) == lower[0] && same_word(text.substr(k, lower.size()), lower)) return true;
    return false;
}

}  // namespace seldinger

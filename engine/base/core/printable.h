#pragma once
// Makes text from a file safe for a terminal, a log and one line of an error.

#include <string>
#include <string_view>

namespace seldinger {

/// `text` with a '?' for everything that a terminal might obey or a reader not see. These are control characters (but a line's
/// end stays), bytes that are no UTF-8, marks that turn the direction of writing, characters without width. Tabs become blanks. A
/// text that is longer than `most` bytes ends in "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

/// Shortens each word of more than `most` bytes: its middle is replaced by its length. A line that quotes a name of a million
/// letters still shows the fault. @param most  of a word, 64 or more
[[nodiscard]] std::string with_short_words(std::string_view text, std::size_t most);

/// The text with line ends and other control characters made spaces: a message is one line, whatever it quotes.
[[nodiscard]] std::string one_line(std::string text);

/// "1 part", "3 parts".
[[nodiscard]] std::string count_of(std::size_t n, std::string_view one, std::string_view many);

}  // namespace seldinger

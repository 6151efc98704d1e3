#pragma once
// What a command takes from the command line: options by name and type, written like CLI11's own, which command_line.cpp alone
// includes (it costs every file that does three seconds of compiling).

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace seldinger::apps {

/// The fault of a word; empty if it is right.
using ArgumentCheck = std::function<std::string(const std::string& word)>;
[[nodiscard]] ArgumentCheck in_range(int least, int most);
[[nodiscard]] ArgumentCheck in_range(double least, double most);
[[nodiscard]] ArgumentCheck positive();
[[nodiscard]] ArgumentCheck not_negative();
[[nodiscard]] ArgumentCheck one_of(std::initializer_list<const char*> words);

/// An option or a flag; calls can be chained.
class Argument {
public:
    explicit Argument(CLI::Option* option) : option_(option) {}
    Argument* type_name(const std::string& name);
    Argument* required();
    /// A scene's file, or the name of one that comes with the program.
    Argument* scene();
    Argument* check(ArgumentCheck check);
    Argument* excludes(Argument* other);
    Argument* delimiter(char between);
    /// Whether one `--name` takes all words that follow.
    Argument* allow_extra_args(bool allowed);
    /// Not for people: --help does not tell it.
    Argument* hidden();

private:
    CLI::Option* option_;
};

/// A command, or the program above its commands.
class CommandLine {
public:
    CommandLine(const std::string& description, const std::string& name);
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    CommandLine* add_subcommand(const std::string& name, const std::string& description);
    /// @param to  text, path or number, one that may be missing (std::optional), or a list of texts or paths
    template <class T>
    Argument* add_option(const std::string& names, T& to, const std::string& description = {});
    Argument* add_flag(const std::string& names, bool& to, const std::string& description = {});
    /// Runs each time the flag is read.
    void add_flag_callback(const std::string& names, std::function<void()> run, const std::string& description);
    void set_version_flag(const std::string& name, const std::string& version);
    /// Runs when this command was on the line and all of it was read.
    void callback(std::function<void()> run);
    /// How many commands below this one may be on the line.
    void require_subcommand(int least, int most);
    /// Words that are no option's are kept (remaining()) instead of refused.
    void allow_extras();
    CommandLine* hidden();

    /// null: there is none of that name
    [[nodiscard]] CommandLine* subcommand(const std::string& name) const;
    /// Whether a command below this one was on the line.
    [[nodiscard]] bool went_below() const;
    /// Whether the command below this one that was on the line has this option, and it was given.
    [[nodiscard]] bool below_was_given(const std::string& option) const;
    [[nodiscard]] std::vector<std::string> remaining() const;

    /// What came of reading a line.
    struct Parsed {
        std::string error;       // what is wrong with it; empty: nothing
        bool printed = false;    // help or version was asked for, and printed
    };
    Parsed parse(int argc, const char* const* argv);
    /// @param words  as the shell would give them, without the program's name
    Parsed parse(std::vector<std::string> words);

private:
    explicit CommandLine(CLI::App& below);

    std::unique_ptr<CLI::App> owned_;  // of the program's own
    CLI::App& app_;
    std::vector<std::unique_ptr<CommandLine>> below_;
    std::vector<std::unique_ptr<Argument>> arguments_;
};

}  // namespace seldinger::apps

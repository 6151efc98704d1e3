// The one file that knows CLI11.
#include "command_line.h"

#include "assets.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace seldinger::apps {

ArgumentCheck in_range(int least, int most)
{
    return [check = CLI::Range(least, most)](const std::string& word) { return check(word); };
}
ArgumentCheck in_range(double least, double most)
{
    return [check = CLI::Range(least, most)](const std::string& word) { return check(word); };
}
ArgumentCheck positive()
{
    return [](const std::string& word) { return CLI::PositiveNumber(word); };
}
ArgumentCheck not_negative()
{
    return [](const std::string& word) { return CLI::NonNegativeNumber(word); };
}
ArgumentCheck one_of(std::initializer_list<const char*> words)
{
    const std::vector<std::string> list(words.begin(), words.end());
    return [check = CLI::IsMember(list)](const std::string& word) { return check(word); };
}

Argument* Argument::type_name(const std::string& name)
{
    option_->type_name(name);
    return this;
}
Argument* Argument::scene()
{
    option_->transform([](const std::string& word) { return scene_file(word); });
    return this;
}

Argument* Argument::required()
{
    option_->required();
    return this;
}
Argument* Argument::check(ArgumentCheck check)
{
    option_->check(std::move(check));
    return this;
}
Argument* Argument::excludes(Argument* other)
{
    option_->excludes(other->option_);
    return this;
}
Argument* Argument::delimiter(char between)
{
    option_->delimiter(between);
    return this;
}
Argument* Argument::allow_extra_args(bool allowed)
{
    option_->allow_extra_args(allowed);
    return this;
}

Argument* Argument::hidden()
{
    option_->group("");
    return this;
}

CommandLine::CommandLine(const std::string& description, const std::string& name)
    : owned_(std::make_unique<CLI::App>(description, name)), app_(*owned_)
{
}
CommandLine::CommandLine(CLI::App& below) : app_(below) {}
CommandLine::~CommandLine() = default;

CommandLine* CommandLine::add_subcommand(const std::string& name, const std::string& description)
{
    below_.push_back(std::unique_ptr<CommandLine>(new CommandLine(*app_.add_subcommand(name, description))));
    return below_.back().get();
}

template <class T>
Argument* CommandLine::add_option(const std::string& names, T& to, const std::string& description)
{
    arguments_.push_back(std::make_unique<Argument>(app_.add_option(names, to, description)));
    return arguments_.back().get();
}

Argument* CommandLine::add_flag(const std::string& names, bool& to, const std::string& description)
{
    arguments_.push_back(std::make_unique<Argument>(app_.add_flag(names, to, description)));
    return arguments_.back().get();
}

void CommandLine::add_flag_callback(const std::string& names, std::function<void()> run, const std::string& description)
{
    app_.add_flag_callback(names, std::move(run), description);
}
void CommandLine::set_version_flag(const std::string& name, const std::string& version) { app_.set_version_flag(name, version); }
void CommandLine::callback(std::function<void()> run) { app_.callback(std::move(run)); }
void CommandLine::require_subcommand(int least, int most)
{
    app_.require_subcommand(static_cast<std::size_t>(least), static_cast<std::size_t>(most));
}
void CommandLine::allow_extras() { app_.allow_extras(); }
CommandLine* CommandLine::hidden()
{
    app_.group("");
    return this;
}

CommandLine* CommandLine::subcommand(const std::string& name) const
{
    const auto it =
        std::find_if(below_.begin(), below_.end(), [&](const auto& command) { return command->app_.get_name() == name; });
    return it == below_.end() ? nullptr : it->get();
}
bool CommandLine::below_was_given(const std::string& name) const
{
    const auto commands = app_.get_subcommands();
    const CLI::Option* option = commands.empty() ? nullptr : commands.front()->get_option_no_throw(name);
    return option && option->count() > 0;
}
bool CommandLine::went_below() const { return !app_.get_subcommands().empty(); }
std::vector<std::string> CommandLine::remaining() const { return app_.remaining(); }

namespace {

template <class Parse>
CommandLine::Parsed parsed(CLI::App& app, const Parse& parse)
{
    try {
        parse();
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) return {error.what(), false};
        app.exit(error);  // prints
        return {{}, true};
    }
    return {};
}

}  // namespace

CommandLine::Parsed CommandLine::parse(int argc, const char* const* argv)
{
    return parsed(app_, [&] { app_.parse(argc, argv); });
}
CommandLine::Parsed CommandLine::parse(std::vector<std::string> words)
{
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    return parsed(app_, [&] { app_.parse(std::move(words)); });
}

// every type that an option of this program has
#define SEL_OPTION_OF(...) template Argument* CommandLine::add_option(const std::string&, __VA_ARGS__&, const std::string&)
SEL_OPTION_OF(std::string);
SEL_OPTION_OF(std::filesystem::path);
SEL_OPTION_OF(int);
SEL_OPTION_OF(double);
SEL_OPTION_OF(std::size_t);
SEL_OPTION_OF(std::uint16_t);
SEL_OPTION_OF(std::optional<std::string>);
SEL_OPTION_OF(std::optional<std::filesystem::path>);
SEL_OPTION_OF(std::optional<int>);
SEL_OPTION_OF(std::optional<double>);
SEL_OPTION_OF(std::optional<std::int64_t>);
SEL_OPTION_OF(std::optional<std::uint64_t>);
SEL_OPTION_OF(std::vector<int>);
SEL_OPTION_OF(std::vector<std::string>);
SEL_OPTION_OF(std::vector<std::filesystem::path>);
#undef SEL_OPTION_OF

}  // namespace seldinger::apps

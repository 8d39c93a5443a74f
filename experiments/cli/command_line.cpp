#include "experiments/cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "experiments/settings/fields.hpp"
#include "experiments/settings/writing.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

using lab_data::UserError;

constexpr std::string_view exit_statuses =
    "Exit status: 0 done, 1 ran but failed, 2 the input is at fault, 130 interrupted (finished runs are "
    "kept).";

std::string general_help() {
    std::string text =
        "loam: calibrates discrete-element models of soil from laboratory curves\n\nusage: loam VERB "
        "...\n\nverbs:\n";
    for (const Verb& verb : verbs())
        text += fmt::format("  {:<22}{}\n", fmt::format("{} {}", verb.name, verb.argument), verb.meaning);
    text += "\n`loam VERB --help` shows the options of a verb, `loam --version` the version.\n";
    return text + std::string(exit_statuses) + "\n";
}

const Verb& verb_of(const std::string& name) {
    std::vector<std::string_view> valid;
    for (const Verb& verb : verbs()) {
        if (verb.name == name) return verb;
        valid.push_back(verb.name);
    }
    throw UserError(
        {.value = name, .constraint = "is not a verb", .remedy = lab_data::suggest_name(name, valid)});
}

std::string option_name(std::string_view key) {
    std::string name = fmt::format("--{}", key);
    std::ranges::replace(name, '_', '-');
    return name;
}

/// "loam bulk, loam bench": the verbs with settings that have an option of their own by that name; else
/// empty.
std::string verbs_with_option(std::string_view name) {
    std::string text;
    for (const Field& field : fields())
        if (field.verbs && option_name(field.key) == name)
            for (const std::string_view verb : field.verbs())
                text += fmt::format("{}loam {}", text.empty() ? "" : ", ", verb);
    return text;
}

/// "particles in a specimen (default 700)"; names of files and lists say themselves what is done without
/// them.
std::string meaning_with_default(const Field& field) {
    const std::string value = value_text(Settings{}, field.path());
    const bool is_said = field.option == "flag" || value == "\"\"" || value == "[]";
    return is_said ? std::string(field.meaning) : fmt::format("{} (default {})", field.meaning, value);
}

bool takes_settings(const Verb& verb) {
    return std::holds_alternative<RunWithSettings>(verb.run);
}

/// The options of one verb, bound to strings: the settings' own reader makes values of them.
class VerbParser {
  public:
    explicit VerbParser(const Verb& verb)
        : verb_(verb), app_(std::string(verb.meaning), fmt::format("loam {}", verb.name)) {
        if (!verb.argument.empty())
            app_.add_option(std::string(verb.argument), argument_, std::string(verb.argument_meaning))
                ->option_text(" ");
        if (takes_settings(verb))
            add_settings();
        else
            add_plain();
        app_.set_help_flag("-h,--help", "this text");
        app_.footer(fmt::format("{}Example: {}\n\n{}",
                                takes_settings(verb)
                                    ? "Numbers are in SI unless their name says otherwise, angles in rad.\n\n"
                                    : "",
                                verb.example, exit_statuses));
        app_.allow_extras();
    }

    Command parse(std::vector<std::string> words) {
        Command command{.verb = &verb_};
        std::ranges::reverse(words);  // as CLI11 wants them
        try {
            app_.parse(words);
        } catch (const CLI::CallForHelp&) {
            command.help = app_.help();
            return command;
        } catch (const CLI::ParseError& error) {
            throw UserError(
                {.constraint = error.what(), .remedy = fmt::format("see loam {} --help", verb_.name)});
        }
        refuse_extras();
        return takes_settings(verb_) ? with_settings(std::move(command)) : with_path(std::move(command));
    }

  private:
    void add_settings() {
        app_.add_option("--config", configuration_, "settings to start from")->type_name("FILE.toml");
        for (const Field& field : fields()) {
            if (!field.is_option_of(verb_.name)) continue;
            const std::string meaning = meaning_with_default(field);
            if (field.option == "flag")
                app_.add_flag(option_name(field.key), flags_[field.key], meaning);
            else
                app_.add_option(option_name(field.key), values_[field.key], meaning)
                    ->type_name(std::string(field.option));
        }
        app_.add_option("--set", fixed_,
                        "a parameter in SI, by name, held fixed; may be repeated (see `loam effects`)")
            ->type_name("NAME=VALUE")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->allow_extra_args(false);
    }

    void add_plain() {
        app_.add_flag("--json", flags_["json"], "the result on standard output as JSON");
        app_.add_flag("--quiet", flags_["quiet"], "no more than the result");
    }

    void refuse_extras() const {
        for (const std::string& word : app_.remaining()) {
            const bool is_option = word.starts_with("-") && word != "-";
            if (!is_option)
                throw UserError({.value = word,
                                 .constraint = "is one word too many",
                                 .remedy = fmt::format("see loam {} --help", verb_.name)});
            std::vector<std::string> names;
            for (const CLI::Option* option : app_.get_options())
                for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
            const std::vector<std::string_view> valid(names.begin(), names.end());
            const std::string name = word.substr(0, word.find('='));
            const std::string others = takes_settings(verb_) ? verbs_with_option(name) : "";
            throw UserError({.value = name,
                             .constraint = fmt::format("is not an option of loam {}", verb_.name),
                             .remedy = !others.empty() ? fmt::format("it is one of {}", others)
                                                       : lab_data::suggest_name(name, valid)});
        }
    }

    Command with_settings(Command command) const {
        command.configuration = configuration_;
        if (app_.count("--config") > 0 && configuration_.empty())
            throw UserError({.column = "--config", .constraint = "needs a path"});
        if (!argument_.empty())
            command.overrides.push_back(
                {std::string(verb_.name == "bench" ? "benchmark" : "sample"), argument_});
        for (const Field& field : fields()) {
            if (!field.is_option_of(verb_.name) || app_.count(option_name(field.key)) == 0) continue;
            const bool is_flag = field.option == "flag";
            command.overrides.push_back({std::string(field.key), !is_flag ? values_.at(field.key)
                                                                 : flags_.at(field.key) ? "true"
                                                                                        : "false"});
        }
        for (const std::string& text : fixed_) command.overrides.push_back({"set", text});
        return command;
    }

    Command with_path(Command command) const {
        if (!verb_.argument.empty() && argument_.empty())
            throw UserError({.column = std::string(verb_.argument),
                             .constraint = "is missing",
                             .remedy = fmt::format("as in: {}", verb_.example)});
        command.plain = {argument_, flags_.at("json"), flags_.at("quiet")};
        return command;
    }

    const Verb& verb_;
    CLI::App app_;
    std::string argument_, configuration_;
    std::map<std::string_view, std::string> values_;
    std::map<std::string_view, bool> flags_;
    std::vector<std::string> fixed_;
};

}  // namespace

Command parse_command_line(const std::vector<std::string>& words) {
    if (words.empty())
        throw UserError({.constraint = "a verb is missing", .remedy = "loam --help lists them"});
    if (words.front() == "--help" || words.front() == "-h") return {.help = general_help()};
    if (words.front() == "--version") return {.help = "loam " LOAM_VERSION "\n"};
    return VerbParser(verb_of(words.front())).parse({words.begin() + 1, words.end()});
}

}  // namespace loam::experiments

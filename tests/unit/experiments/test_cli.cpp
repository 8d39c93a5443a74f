// The words of the command line.
#include <gtest/gtest.h>

#include "experiments/cli/command_line.hpp"
#include "experiments/settings/fields.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

using lab_data::UserError;

std::string complaint(const std::vector<std::string>& words) {
    try {
        parse_command_line(words);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

TEST(CommandLine, EveryVerbHasHelpWithItsExample) {
    for (const Verb& verb : verbs()) {
        const Command command = parse_command_line({std::string(verb.name), "--help"});
        EXPECT_NE(command.help.find(verb.example), std::string::npos) << verb.name;
        EXPECT_NE(command.help.find(verb.meaning), std::string::npos) << verb.name;
        EXPECT_EQ(parse_command_line({"--help"}).help.find(verb.name) == std::string::npos, false)
            << verb.name;
    }
}

TEST(CommandLine, PlainVerbsGetTheirPath) {
    const Command command = parse_command_line({"check", "some/where", "--json"});
    EXPECT_EQ(command.verb->name, "check");
    EXPECT_EQ(command.plain.path, "some/where");
    EXPECT_TRUE(command.plain.json);
    EXPECT_FALSE(command.plain.quiet);
}

TEST(CommandLine, MistakesAreAnswered) {
    EXPECT_NE(complaint({}).find("a verb is missing"), std::string::npos);
    EXPECT_NE(complaint({"chekc"}).find("value 'chekc' is not a verb; did you mean 'check'?"),
              std::string::npos);
    EXPECT_NE(complaint({"fit"}).find("use one of check"), std::string::npos);
    EXPECT_NE(complaint({"check"}).find("'PATH' is missing"), std::string::npos);
    EXPECT_NE(complaint({"check", "a", "b"}).find("'b' is one word too many"), std::string::npos);
    EXPECT_NE(complaint({"check", "a", "--jsno"})
                  .find("'--jsno' is not an option of loam check; did you mean '--json'?"),
              std::string::npos);
}

}  // namespace
}  // namespace loam::experiments

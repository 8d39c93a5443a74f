// Settings: what the table says is what the reader, the writer and the checks do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/settings/fields.hpp"
#include "experiments/settings/parameters.hpp"
#include "experiments/settings/reading.hpp"
#include "experiments/settings/validation.hpp"
#include "experiments/settings/writing.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

using lab_data::UserError;

Settings from_text(std::string_view text) {
    Draft draft;
    read_toml(draft, text, "conf.toml");
    return complete(draft);
}

/// What the settings' reader says to this text; empty if it says nothing.
std::string complaint(std::string_view text) {
    try {
        from_text(text);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

/// Another valid value for whatever a slot points to.
struct Change {
    const Field& field;

    void operator()(bool* slot) const { *slot = !*slot; }
    void operator()(int* slot) const { *slot += 1; }
    void operator()(std::uint64_t* slot) const { *slot = 9223372036854775807u; }
    void operator()(double* slot) const { *slot = *slot * (1 + 1e-15) + 1e-17; }
    void operator()(std::optional<double>* slot) const {
        *slot = field.key == "porosity" ? 0.1 + 0.2 : field.key == "box_diameters" ? 14.1 : 2651.5;
    }
    void operator()(std::filesystem::path* slot) const { *slot = "/some folder/\"quoted\" \\ back\tslash"; }
    void operator()(std::string* slot) const {
        *slot = field.choices            ? std::string(field.choices().back())
                : field.key == "confirm" ? "7"
                                         : "a \"name\"\n";
    }
    void operator()(std::vector<std::string>* slot) const {
        slot->push_back(field.choices ? std::string(field.choices().back()) : "b.csv");
    }
};

TEST(Settings, DefaultsAreValidAndCarryThePriorsOfTheLaw) {
    const Settings settings = from_text("");
    ASSERT_EQ(settings.priors.size(), 5u);
    // De Pue et al. 2019, Table 2
    EXPECT_EQ(settings.priors.at("young_modulus").kind, engine::PriorKind::lognormal);
    EXPECT_DOUBLE_EQ(settings.priors.at("young_modulus").mean, 8.5);
    EXPECT_DOUBLE_EQ(settings.priors.at("young_modulus").sd, 0.8);
    EXPECT_DOUBLE_EQ(settings.priors.at("stiffness_ratio").mean, 0.4);
}

TEST(Settings, EveryLawWithEveryEffectSurvivesTheRoundTripThroughAFile) {
    for (const engine::LawInfo& law : engine::laws())
        for (const engine::EffectInfo& effect : engine::effects()) {
            if (!effect.goes_with(law.name)) continue;
            const std::string text =
                fmt::format("law = \"{}\"\neffects = [\"{}\"]\nrotation = \"free\"\n", law.name, effect.name);
            const Settings settings = from_text(text);
            EXPECT_EQ(settings.priors.size() + settings.set.size(),
                      law.parameters.size() + effect.parameters.size());
            EXPECT_EQ(from_text(to_toml(settings)), settings) << to_toml(settings);
        }
}

TEST(Settings, AParameterThatIsHeldIsFittedWhereAPriorIsStated) {
    const Settings usual = from_text("law = \"linear-damped\"");
    EXPECT_DOUBLE_EQ(usual.set.at("stiffness_ratio"), 1 / 1.2);
    EXPECT_FALSE(usual.priors.contains("stiffness_ratio"));
    const Settings stated = from_text("law = \"linear-damped\"\n[priors.stiffness_ratio]\nupper = 0.9");
    EXPECT_FALSE(stated.set.contains("stiffness_ratio"));
    EXPECT_DOUBLE_EQ(stated.priors.at("stiffness_ratio").upper, 0.9);
}

TEST(Settings, EverySettingSurvivesTheRoundTripThroughAFile) {
    Settings settings = from_text("[set]\nfriction_angle = 0.5");
    settings.set["friction_angle"] = 0.1 + 0.2;  // 17 digits
    settings.priors["shear_cohesion"] = {engine::PriorKind::loguniform, 0, 0, 101.0 / 3, 1e7};
    settings.priors["young_modulus"].mean = 8.1 + 1e-15;
    for (const Field& field : fields()) {
        if (field.key == "law" || field.key == "effects") continue;  // they bring parameters: see below
        const Settings before = settings;
        std::visit([&](auto* slot) { Change{field}(slot); }, field.slot(settings));
        const bool has_no_other_value = field.choices && field.choices().size() == 1;
        EXPECT_TRUE(has_no_other_value || settings != before) << field.path() << " is not compared";
        EXPECT_EQ(from_text(to_toml(settings)), settings) << field.path() << "\n" << to_toml(settings);
    }
}

TEST(Settings, DefaultsSurviveTheRoundTripToo) {
    const Settings settings = from_text("");
    EXPECT_EQ(from_text(to_toml(settings)), settings);
}

TEST(Settings, NamesOfFieldsAreDistinct) {
    std::vector<std::string> paths;
    for (const Field& field : fields()) paths.push_back(field.path());
    std::ranges::sort(paths);
    EXPECT_EQ(std::ranges::adjacent_find(paths), paths.end());
}

TEST(Settings, EachLayerOverridesTheOneBelow) {
    Draft draft;
    read_toml(draft, "particles = 300\nruns = 50\n[set]\nfriction_angle = 0.4\nyoung_modulus = 1e8",
              "conf.toml");
    read_override(draft, {"particles", "400"});
    read_override(draft, {"set", "friction_angle=0.6"});
    const Settings settings = complete(draft);
    EXPECT_EQ(settings.seed, 1u);
    EXPECT_EQ(settings.runs, 50);
    EXPECT_EQ(settings.particles, 400);
    EXPECT_DOUBLE_EQ(settings.set.at("friction_angle"), 0.6);
    EXPECT_DOUBLE_EQ(settings.set.at("young_modulus"), 1e8);
    EXPECT_EQ(settings.priors.size(), 3u);
}

TEST(Settings, AFaultyValueThatIsOverriddenDoesNotCount) {
    Draft draft;
    read_toml(draft, "particles = 3", "conf.toml");
    EXPECT_THROW(complete(draft), UserError);
    read_override(draft, {"particles", "300"});
    EXPECT_EQ(complete(draft).particles, 300);
}

TEST(Settings, FixingAParameterDropsItsPriorWhateverTheFileSays) {
    Draft draft;
    read_toml(draft, to_toml(from_text("")), "conf.toml");
    read_override(draft, {"set", "young_modulus=3e8"});
    const Settings settings = complete(draft);
    EXPECT_FALSE(settings.priors.contains("young_modulus"));
    EXPECT_EQ(settings.priors.size(), 4u);
}

TEST(Settings, AnOptionFixesWhatTheFileHasAPriorOf) {
    Draft draft;
    read_toml(draft, "[priors.young_modulus]\nsd = 0.3\n[set]\nfriction_angle = 0.5", "conf.toml");
    read_override(draft, {"set", "young_modulus=3e8"});
    const Settings settings = complete(draft);
    EXPECT_DOUBLE_EQ(settings.set.at("young_modulus"), 3e8);
    // As the run's own configuration it can be read again.
    EXPECT_EQ(from_text(to_toml(settings)), settings);
}

TEST(Settings, PathsOfAFileAreRelativeToItsFolder) {
    Draft draft;
    read_toml(draft, "sample = \"../soils/a\"\nout = \"/runs/x\"", "/home/me/conf/run.toml");
    EXPECT_EQ(draft.settings.sample, "/home/me/soils/a");
    EXPECT_EQ(draft.settings.out, "/runs/x");
}

TEST(Settings, APriorKeepsWhatTheFileLeavesOut) {
    const Prior prior = from_text("[priors.young_modulus]\nsd = 0.3").priors.at("young_modulus");
    EXPECT_EQ(prior.kind, engine::PriorKind::lognormal);
    EXPECT_DOUBLE_EQ(prior.mean, 8.5);
    EXPECT_DOUBLE_EQ(prior.sd, 0.3);
    const Prior uniform = from_text("[priors.friction_angle]\nkind = \"uniform\"\nlower = 0.1\nupper = 0.7")
                              .priors.at("friction_angle");
    EXPECT_EQ(uniform, (Prior{engine::PriorKind::uniform, 0, 0, 0.1, 0.7}));
}

struct BadSetting {
    const char* text;
    const char* message;  // a part of what is said
};

class BadSettings : public testing::TestWithParam<BadSetting> {};

TEST_P(BadSettings, AreAnsweredWithPlaceValueAndRemedy) {
    const std::string said = complaint(GetParam().text);
    EXPECT_NE(said.find(GetParam().message), std::string::npos) << "said: " << said;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadSettings,
    testing::Values(
        BadSetting{"seed = 1\nparticles = = 3", "conf.toml:2:13: is not TOML"},
        BadSetting{"seed = 1\nseed = 2", "conf.toml:2:"},
        BadSetting{"particels = 3",
                   "conf.toml:1:1: key 'particels' is not a setting; did you mean 'particles'?"},
        BadSetting{"[engin]\ndamping = 0.3", "key 'engin' is not a setting; did you mean 'engine'?"},
        BadSetting{"[engine]\n  dampin = 0.3",
                   "conf.toml:2:3: key 'dampin' is not a setting; did you mean 'damping'?"},
        BadSetting{"engine = 3", "key 'engine': value '3' must be a table; write [engine]"},
        BadSetting{"particles = 700.5", "key 'particles': value '700.5' must be an integer"},
        BadSetting{"particles = \"700\"", "must be an integer"},
        BadSetting{"particles = 10", "key 'particles': value '10' must be at least 100"},
        BadSetting{"particles = 100000000000",
                   "value '100000000000' must be at least 100 and at most 2000000"},
        BadSetting{"[calibration]\nspecimen_particles = 3000000000",
                   "value '3000000000' must be at least 0 and at most 2147483647"},
        BadSetting{"seed = -1", "key 'seed': value '-1' must be at least 0"},
        BadSetting{"quiet = 1", "key 'quiet': value '1' must be true or false"},
        BadSetting{"law = 3", "key 'law': value '3' must be text in quotes"},
        BadSetting{"law = \"linear-cohesiv\"", "did you mean 'linear-cohesive'?"},
        BadSetting{"law = \"\"", "key 'law' is not known here"},
        BadSetting{"rotation = \"fre\"",
                   "key 'rotation': value 'fre' is not known here; did you mean 'free'?"},
        BadSetting{"tests = [\"oedometre\"]",
                   "value 'oedometre' is not known here; did you mean 'oedometer'?"},
        BadSetting{"tests = [\"oedometer\", \"oedometer\"]", "value 'oedometer' is there twice"},
        BadSetting{"tests = [\"oedometer\", 3]", "must be a list of texts in quotes"},
        BadSetting{"seed = 3\nhold_out = [\"a.csv\", \"\"]",
                   "conf.toml:2:1: key 'hold_out': value '[ 'a.csv', '' ]' has an empty item; fill it in"},
        BadSetting{"hold_out = \"\"", "conf.toml:1:1: key 'hold_out': value "},
        BadSetting{"hold_out = \"\"", "has an empty item"},
        BadSetting{"effects = [\"rolling_resistance\"]",
                   "value 'rolling_resistance' needs particles that rotate; add --rotation free"},
        BadSetting{"law = \"hertz-mindlin\"\neffects = [\"hertzian_stiffness\"]",
                   "value 'hertzian_stiffness' does not go with the law hertz-mindlin; it goes with "
                   "linear-cohesive and linear-damped"},
        BadSetting{"effects = [\"cementation\"]\n[engine]\nfragile = false",
                   "value 'cementation' needs bonds that break; write fragile = true under [engine]"},
        BadSetting{"[set]\nrolling_friction = 0.1", "is a parameter of the effect rolling_resistance"},
        BadSetting{"effects = [\"creep\"]", "value 'creep' is not known here"},
        BadSetting{"[engine]\ndamping = \"high\"", "key 'engine.damping': value ''high'' must be a number"},
        BadSetting{"[engine]\ndamping = true", "must be a number"},
        BadSetting{"[engine]\ndamping = 1.0", "value '1' must be at least 0 and below 1"},
        BadSetting{"[engine]\ndamping = nan", "value 'nan' must be at least 0 and below 1"},
        BadSetting{"[specimen]\npreparation_stress_kPa = inf", "value 'inf' must be above 0"},
        BadSetting{"[specimen]\nporosity = 1.2",
                   "key 'specimen.porosity': value '1.2' must be above 0.05 and below 0.6"},
        BadSetting{"[calibration]\ndesign = \"sobel\"", "did you mean 'sobol'?"},
        BadSetting{"[set]\nfriction_angel = 0.3",
                   "conf.toml:2:1: key 'set.friction_angel': value 'friction_angel' is not a parameter of "
                   "the law linear-cohesive; did you mean 'friction_angle'?"},
        BadSetting{"[set]\nfriction_angle = 30",
                   "value '30' must lie in 0 to 1.56 rad; values are in SI, angles in rad"},
        BadSetting{"[set]\nfriction_angle = \"30 deg\"", "must be a number"},
        BadSetting{"set = 3", "must be a table; write [set]"},
        BadSetting{"[priors.youngs_modulus]\nmean = 8", "did you mean 'young_modulus'?"},
        BadSetting{"[priors]\nyoung_modulus = 8", "must be a table; write [priors.young_modulus]"},
        BadSetting{"[priors.young_modulus]\naverage = 8",
                   "conf.toml:2:1: key 'priors.young_modulus.average' is not a part of a prior"},
        BadSetting{"[priors.young_modulus]\nkind = \"log-normal\"",
                   "is not a kind of prior; did you mean 'lognormal'?"},
        BadSetting{"[priors.young_modulus]\nkind = \"normal\"", "needs mean and sd"},
        BadSetting{"[priors.young_modulus]\nkind = \"uniform\"\nmean = 8",
                   "conf.toml:3:1: key 'priors.young_modulus.mean' has no meaning for a uniform prior"},
        BadSetting{"[priors.young_modulus]\nsd = 0", "value '0' must be above 0"},
        BadSetting{"[priors.young_modulus]\nmean = 3e8", "value '300000000' must lie between the bounds"},
        BadSetting{"[priors.young_modulus]\nupper = 1e20", "must lie in the law's range"},
        BadSetting{"[priors.young_modulus]\nlower = 1e9\nupper = 1e8",
                   "conf.toml:2:1: key 'priors.young_modulus.lower': value '1000000000' must be below upper"},
        BadSetting{"[set]\nyoung_modulus = 1e8\n[priors.young_modulus]\nsd = 0.3",
                   "conf.toml:3:9: key 'priors.young_modulus' contradicts set.young_modulus, which holds the "
                   "parameter fixed; leave one of the two out"},
        BadSetting{"[priors.young_modulus]\n[set]\nyoung_modulus = 1e8", "contradicts set.young_modulus"},
        BadSetting{"[priors.friction_angle]\nkind = \"loguniform\"\nlower = 0",
                   "must be above 0 for a loguniform prior"}));

struct BadOption {
    Override given;
    const char* message;
};

class BadOptions : public testing::TestWithParam<BadOption> {};

TEST_P(BadOptions, AreAnsweredWithTheOption) {
    Draft draft;
    std::string said;
    try {
        read_override(draft, GetParam().given);
        complete(draft);
    } catch (const UserError& error) {
        said = error.what();
    }
    EXPECT_NE(said.find(GetParam().message), std::string::npos) << "said: " << said;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadOptions,
    testing::Values(
        BadOption{{"particles", "7e2"}, "option '--particles': value '7e2' must be an integer"},
        BadOption{{"particles", ""}, "option '--particles' must be an integer"},
        BadOption{{"runs", "0"}, "option '--runs': value '0' must be at least 1"},
        BadOption{{"jobs", "99999999999999999999"}, "must be an integer"},
        BadOption{{"jobs", "99999999999999999999"},
                  "value '99999999999999999999' must be an integer and must be at least 0 and at most 4096"},
        BadOption{{"particles", "-99999999999999999999"}, "must be at least 100 and at most 2000000"},
        BadOption{{"seed", "9223372036854775808"}, "must be at least 0 and at most 9223372036854775807"},
        BadOption{{"seed", "99999999999999999999x"}, "must be an integer; write it in digits"},
        BadOption{{"tests", "oedometer,,triaxial"}, "has an empty item"},
        BadOption{{"hold_out", ""}, "option '--hold-out' has an empty item"},
        BadOption{{"out", ""}, "option '--out' needs a path"},
        BadOption{{"set", "young_modulus"}, "option '--set': value 'young_modulus' must be NAME=VALUE"},
        BadOption{{"set", "=3"}, "must be NAME=VALUE"},
        BadOption{{"set", "young_modulus="}, "must be a number"},
        BadOption{{"set", "young_modulus=1,5e8"}, "value '1,5e8' must be a number; write 1.5e8"},
        BadOption{{"set", "young_modulus=1e8Pa"}, "must be a number"},
        BadOption{{"set", "young_modulus=nan"}, "must be a number"},
        BadOption{{"set", "young_modulus=1e3"}, "option '--set young_modulus': value '1000' must lie in"},
        BadOption{{"set", "youngmodulus=1e8"}, "did you mean 'young_modulus'?"}));

TEST(Settings, AParameterIsFixedOnceOnTheCommandLine) {
    Draft draft;
    read_override(draft, {"set", "young_modulus=1e8"});
    EXPECT_THROW(read_override(draft, {"set", "young_modulus=2e8"}), UserError);
}

TEST(Settings, ACalibrationNeedsSomethingToFit) {
    Settings settings = from_text("");
    for (const auto& [name, prior] : settings.priors) settings.set[name] = prior.lower;
    settings.priors.clear();
    settings.verb = "simulate";
    EXPECT_NO_THROW(validate(settings));
    settings.verb = "calibrate";
    EXPECT_THROW(validate(settings), UserError);
}

TEST(Settings, ACalibrationNeedsRunsForItsParameters) {
    Settings settings = from_text("runs = 24");
    settings.verb = "calibrate";
    EXPECT_THROW(validate(settings), UserError);  // five parameters take 25
    settings.runs = 25;
    EXPECT_NO_THROW(validate(settings));
}

TEST(Settings, ResumingComparesWhatChangesAResult) {
    const Settings stored = from_text("");
    Settings now = stored;
    now.jobs = 7;
    now.quiet = now.json = true;
    now.out = "/elsewhere";
    now.sample = "/moved";
    EXPECT_EQ(first_difference(stored, now), "");
    now.engine.damping = 0.3;
    EXPECT_EQ(first_difference(stored, now), "engine.damping");
    now = stored;
    now.seed = 2;
    EXPECT_EQ(first_difference(stored, now), "seed");
    now = stored;
    now.priors["young_modulus"].sd = 0.5;
    EXPECT_EQ(first_difference(stored, now), "priors.young_modulus");
    now = stored;
    now.set["young_modulus"] = 1e8;
    EXPECT_EQ(first_difference(stored, now), "set.young_modulus");
    EXPECT_EQ(first_difference(now, stored), "set.young_modulus");
}

}  // namespace
}  // namespace loam::experiments

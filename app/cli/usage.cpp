#include "usage.hpp"

#include "definition.hpp"
#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace rodwake::cli {

namespace {

using Words = std::vector<std::string>;

std::string suggestion(const std::string& word, const Words& known) {
    if (word.size() == 2 && word[0] == '-') // every letter is near every other
        return "";
    const std::vector<std::string_view> views(known.begin(), known.end());
    return did_you_mean(word, views);
}

bool has(const Words& words, const std::string& word) {
    return std::ranges::find(words, word) != words.end();
}

std::string command_of(const CLI::App& app) {
    return app.get_parent() ? "rodwake " + app.get_name() : "rodwake";
}

/// The verb of the line, or the program itself.
const CLI::App& verb_of(const CLI::App& app) {
    const auto verbs = app.get_subcommands();
    return verbs.empty() ? app : *verbs.front();
}

std::string unknown_option(const CLI::App& verb, const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    const Words known = option_names(verb);
    if (has(known, name)) // it was not taken as the verb's, so it stands before it
        return fmt::format("{}: comes after the verb: {} {}", name, command_of(verb), name);
    for (const CLI::App* other : verb.get_subcommands({}))
        if (has(option_names(*other), name))
            return fmt::format("{}: comes after a verb, for example rodwake {} {}", name, other->get_name(),
                               name);
    return fmt::format("{}: {} has no such option{}", name, command_of(verb), suggestion(name, known));
}

/// SCENE, or nothing.
std::string positional_names(const CLI::App& verb) {
    Words names;
    for (const CLI::Option* option : verb.get_options())
        if (option->get_positional())
            names.push_back(option->get_name(true));
    return names.empty() ? "no arguments" : fmt::format("one {}", fmt::join(names, " "));
}

std::string missing_value(const CLI::App& verb, const std::string& text) {
    const std::string option = text.substr(0, text.find(':'));
    const std::string use = option == "--set" ? ", table.key=value" : "";
    return fmt::format("{}: its value is missing{}; see {} --help", option, use, command_of(verb));
}

std::string other_error(const CLI::App& verb, const CLI::ParseError& error) {
    std::string text = error.what();
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
        return missing_value(verb, text);
    if (dynamic_cast<const CLI::RequiredError*>(&error))
        return fmt::format("{}; see {} --help", text, command_of(verb));
    if (const auto at = text.find(" excludes "); dynamic_cast<const CLI::ExcludesError*>(&error))
        return fmt::format("{} and {}: give one of them", text.substr(0, at), text.substr(at + 10));
    return text;
}

} // namespace

const CLI::App* find_verb(const CLI::App& app, const std::string& name) {
    const auto found = app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
    return found.empty() ? nullptr : found.front();
}

CLI::ValidationError unknown_verb(const CLI::App& app, const std::string& word) {
    Words verbs;
    for (const CLI::App* verb : app.get_subcommands({}))
        verbs.push_back(verb->get_name());
    const std::string near = suggestion(word, verbs);
    return CLI::ValidationError(
        word, word.ends_with(".toml") ? fmt::format("a verb comes first, for example rodwake run {}", word)
              : near.empty()          ? fmt::format("no such verb; there are {}", fmt::join(verbs, ", "))
                                      : "no such verb" + near);
}

void refuse_misread_words(const CLI::App& app, std::span<const std::string> words) {
    if (words.empty())
        return;
    const CLI::App* verb = find_verb(app, words[0]);
    if (!verb && !words[0].starts_with("-"))
        throw unknown_verb(app, words[0]);
    const Words known = option_names(verb ? *verb : app);
    for (const std::string& word : words) {
        const std::string twice = "-" + word.substr(0, word.find('='));
        if (word.size() > 2 && word[0] == '-' && word[1] != '-' && has(known, twice))
            throw CLI::ValidationError(twice.substr(1), "a long option has two dashes: " + twice);
    }
}

std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& verb = verb_of(app);
    const Words left = app.remaining(true);
    const auto option = std::ranges::find_if(left, [](const auto& w) { return w.size() > 1 && w[0] == '-'; });
    if (option != left.end())
        return unknown_option(verb, *option);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) && !left.empty())
        return fmt::format("{}: not expected; {} takes {}", left.front(), command_of(verb),
                           positional_names(verb));
    return other_error(verb, error);
}

} // namespace rodwake::cli

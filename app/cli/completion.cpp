// Completion of verbs, options, their choices and the keys of -s, for bash and zsh.

#include "definition.hpp"
#include "rodwake/scene/document.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::cli {

namespace {

using Words = std::vector<std::string>;

std::string joined(const Words& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// "{rods,bed}" of the type that help shows, as words.
Words choices(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const auto begin = type.find('{'), end = type.find('}');
    return end == std::string::npos ? Words{}
                                    : CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

/// Keys as -s takes them; of lists those of the first entry.
Words settable_keys() {
    Words keys;
    for (const scene::KeyInfo& info : scene::scene_keys()) {
        std::string key = info.table.empty() ? info.name : info.table + "." + info.name;
        for (auto at = key.find("[]"); at != std::string::npos; at = key.find("[]"))
            key.replace(at, 2, ".0");
        keys.push_back(key);
    }
    return keys;
}

constexpr const char* bash = R"(# bash completion of rodwake; made by rodwake info --completion bash
_rodwake() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} verb=${{COMP_WORDS[1]}} words=
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W "{verbs} {options}" -- "$word"))
        return
    fi
    case $verb:$before in
    help:help) [[ $word == -* ]] || words="{verbs}" ;;
    *:-s | *:--set)
        compopt -o nospace
        COMPREPLY=($(compgen -W "{keys}" -S = -- "$word"))
        return ;;
    *:-o | *:--output)
        COMPREPLY=($(compgen -d -- "$word"))
        return ;;
{values}    esac
    if [[ -z $words && $word == -* ]]; then
        case $verb in
{by_verb}        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _rodwake rodwake
)";

/// Text within the single quotes and brackets of zsh's _arguments.
std::string zsh_text(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '\''                          ? "'\\''"
               : c == '[' || c == ']' || c == ':' ? std::string("\\") + c
                                                  : std::string(1, c);
    return out;
}

std::string zsh_argument(const CLI::Option& option) {
    const Words names = option_names(option);
    if (names.empty())
        return fmt::format(" \\\n        '*:{}:_files'", option.get_name(true));
    const std::string described = "[" + zsh_text(option.get_description()) + "]";
    std::string value;
    if (const Words words = choices(option); takes_value(option)) {
        const auto is = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
        value = ":value:" + (!words.empty()   ? "(" + joined(words) + ")"
                             : is("--set")    ? "_rodwake_keys"
                             : is("--output") ? "_files -/"
                                              : "_files");
    }
    const char* again = option.get_items_expected_max() > 1 ? "*" : ""; // may be given more than once
    const std::string quoted =
        names.size() == 1 ? fmt::format("'{}{}{}{}'", again, names[0], described, value)
                          : fmt::format("'{}'{{{}}}'{}{}'", again, fmt::join(names, ","), described, value);
    return fmt::format(" \\\n        {}", quoted);
}

constexpr const char* zsh = R"(#compdef rodwake
# zsh completion of rodwake; made by rodwake info --completion zsh
_rodwake_keys() {{
    compadd -S = -- {keys}
}}
_rodwake() {{
    local -a verbs=({verbs})
    if ((CURRENT == 2)); then
        _describe verb verbs
        return
    fi
    shift words
    ((CURRENT--))
    case $words[1] in
    help) _describe verb verbs ;;
{by_verb}    esac
}}
_rodwake "$@"
)";

} // namespace

std::string bash_completion(const CLI::App& app) {
    std::string values, by_verb;
    for (const CLI::App* verb : app.get_subcommands({})) {
        // A case over "verb:option" lists the values that bash offers behind an option.
        for (const CLI::Option* option : verb->get_options())
            if (const Words words = choices(*option); !words.empty() && !option->get_positional())
                for (const std::string& name : option_names(*option))
                    values +=
                        fmt::format("    {}:{}) words=\"{}\" ;;\n", verb->get_name(), name, joined(words));
        by_verb +=
            fmt::format("        {}) words=\"{}\" ;;\n", verb->get_name(), joined(option_names(*verb)));
    }
    Words verbs;
    for (const CLI::App* item : app.get_subcommands({}))
        verbs.push_back(item->get_name());
    return fmt::format(bash, fmt::arg("verbs", joined(verbs)), fmt::arg("options", joined(option_names(app))),
                       fmt::arg("keys", joined(settable_keys())), fmt::arg("values", values),
                       fmt::arg("by_verb", by_verb));
}

std::string zsh_completion(const CLI::App& app) {
    std::string verbs, by_verb;
    for (const CLI::App* verb : app.get_subcommands({})) {
        verbs += fmt::format("'{}:{}' ", verb->get_name(), zsh_text(verb->get_description()));
        std::string arguments;
        for (const CLI::Option* option : verb->get_options())
            arguments += zsh_argument(*option);
        if (verb->get_name() != "help")
            by_verb += fmt::format("    {}) _arguments{} ;;\n", verb->get_name(), arguments);
    }
    return fmt::format(zsh, fmt::arg("verbs", verbs), fmt::arg("keys", joined(settable_keys())),
                       fmt::arg("by_verb", by_verb));
}

} // namespace rodwake::cli

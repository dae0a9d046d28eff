#include "suggest.hpp"

#include "node.hpp"
#include "rodwake/scene/document.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

/// " ([coupling] has it)" for a key that stands in the wrong table.
std::string where_it_belongs(const std::string& name) {
    for (const auto& known : scene_keys())
        if (known.name == name && !known.table.empty())
            return fmt::format(" ([{}] has it)", known.table);
    return "";
}

} // namespace

std::string one_of_text(Names legal, std::string_view found) {
    return fmt::format("must be one of {}{}", comma_list(legal), did_you_mean(found, legal));
}

std::string unknown_key_text(const std::string& title, const std::string& name, Names known) {
    const std::string near = did_you_mean(name, known);
    return fmt::format(
        "{} {}{}. Known keys: {}", title.empty() ? "unknown table or key" : title + " unknown key",
        describe_value(Node{{}, name}), near.empty() ? where_it_belongs(name) : near, comma_list(known));
}

} // namespace rodwake::scene

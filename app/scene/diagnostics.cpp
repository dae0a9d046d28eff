#include "diagnostics.hpp"

#include "node.hpp"
#include "rodwake/scene/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace rodwake::scene {

namespace {

std::vector<Diagnostic> in_order(std::vector<Diagnostic> diagnostics) {
    const auto before = [](const Diagnostic& a, const Diagnostic& b) {
        return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    };
    std::stable_sort(diagnostics.begin(), diagnostics.end(), before);
    return diagnostics;
}

std::string listing(const std::vector<Diagnostic>& diagnostics, std::size_t unstored) {
    std::string text;
    const std::size_t listed = std::min(diagnostics.size(), SceneError::listed_at_most);
    for (std::size_t i = 0; i < listed; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : "\n", diagnostics[i].text());
    if (const std::size_t more = diagnostics.size() - listed + unstored; more > 0)
        text += fmt::format("\n... and {} more", more);
    return text;
}

} // namespace

std::string Diagnostic::text() const {
    return line > 0 ? fmt::format("{}:{}:{}: {}", file, line, column, message)
                    : fmt::format("{}: {}", file, message);
}

SceneError::SceneError(std::vector<Diagnostic> diagnostics, std::size_t unstored)
    : InputError(listing(in_order(diagnostics), unstored)), diagnostics_(in_order(std::move(diagnostics))) {}

void Diagnostics::add(const SourcePosition& position, std::string key, std::string message) {
    add(Diagnostic{position.source ? *position.source : "", position.line, position.column, std::move(key),
                   std::move(message)});
}

void Diagnostics::add(Diagnostic problem) {
    const auto same = [&](const Diagnostic& diagnostic) {
        return diagnostic.line == problem.line && diagnostic.column == problem.column &&
               diagnostic.message == problem.message;
    };
    if (std::ranges::any_of(list_, same)) // of a key that is read twice
        return;
    if (list_.size() < stored_at_most)
        list_.push_back(std::move(problem));
    else
        ++unstored_;
}

void Diagnostics::throw_if_any() const {
    if (!list_.empty())
        throw SceneError(list_, unstored_);
}

std::string one_of_text(Names legal, std::string_view found) {
    return fmt::format("must be one of {}{}", comma_list(legal), did_you_mean(found, legal));
}

std::string unknown_key_text(const std::string& title, const std::string& name, Names known) {
    for (const char* gone : {"speed_deviations", "deviation_lag"})
        if (name == gone)
            return fmt::format(
                "{} {}: large deviations of a rod's speed were measured up to version 0.3 only, which "
                "is tag v0.3.0; leave the key out",
                title, name);
    std::string near = did_you_mean(name, known);
    if (near.empty()) { // it may stand in the wrong table
        const std::vector<KeyInfo> keys = scene_keys();
        const auto other = std::ranges::find_if(
            keys, [&](const KeyInfo& one) { return one.name == name && !one.table.empty(); });
        if (other != keys.end())
            near = fmt::format(" ([{}] has it)", other->table);
    }
    return fmt::format("{} {}{}. Known keys: {}",
                       title.empty() ? "unknown table or key" : title + " unknown key",
                       describe_value(Node{{}, name}), near, comma_list(known));
}

} // namespace rodwake::scene

#include "problems.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace rodwake::scene {

namespace {

std::vector<Problem> in_order(std::vector<Problem> problems) {
    const auto before = [](const Problem& a, const Problem& b) {
        return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    };
    std::stable_sort(problems.begin(), problems.end(), before);
    return problems;
}

std::string listing(const std::vector<Problem>& problems, std::size_t unstored) {
    std::string text;
    const std::size_t listed = std::min(problems.size(), SceneError::listed_at_most);
    for (std::size_t i = 0; i < listed; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : "\n", problems[i].text());
    if (const std::size_t more = problems.size() - listed + unstored; more > 0)
        text += fmt::format("\n... and {} more", more);
    return text;
}

} // namespace

std::string Problem::text() const {
    return line > 0 ? fmt::format("{}:{}:{}: {}", file, line, column, message)
                    : fmt::format("{}: {}", file, message);
}

SceneError::SceneError(std::vector<Problem> problems, std::size_t unstored)
    : InputError(listing(in_order(problems), unstored)), problems_(in_order(std::move(problems))) {}

void Problems::add(const Place& place, std::string key, std::string message) {
    add(Problem{place.source ? *place.source : "", place.line, place.column, std::move(key),
                std::move(message)});
}

void Problems::add(Problem problem) {
    const auto same = [&](const Problem& one) {
        return one.line == problem.line && one.column == problem.column && one.message == problem.message;
    };
    if (std::ranges::any_of(list_, same)) // of a key that is read twice
        return;
    if (list_.size() < stored_at_most)
        list_.push_back(std::move(problem));
    else
        ++unstored_;
}

void Problems::throw_if_any() const {
    if (!list_.empty())
        throw SceneError(list_, unstored_);
}

} // namespace rodwake::scene

// Setter: the way through tables and lists to the keys, their values, and alternatives.

#include "setter.hpp"

#include "node.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rodwake::scene {

std::string SetterTarget::path_text(std::size_t count) const {
    return scene::path_text(std::span(path).first(count));
}

Setter::Setter(std::span<SetterTarget> targets) : Setter(targets, {}) { found_ = targets; }

Setter::Setter(std::span<const SetterTarget> targets, std::span<const Value> values) : values_(values) {
    progress_.reserve(targets.size());
    for (const SetterTarget& target : targets)
        progress_.push_back({&target});
    given_.reserve(32); // more than any table has
    frames_.reserve(8);
    frames_.push_back({});
}

std::optional<std::string> Setter::finish() {
    leave();
    return std::move(error_);
}

bool Setter::is_here(const TargetProgress& p, std::string_view name) const {
    const std::size_t depth = frames_.back().depth;
    return !p.is_done && p.matched == depth && p.target->path[depth].name == name;
}

bool Setter::enter(std::size_t segments, const Key& key, long index) {
    const std::size_t depth = frames_.back().depth;
    const SetterTarget* through = nullptr;
    for (TargetProgress& p : progress_)
        if (is_here(p, key.name) && (index < 0 || p.target->path[depth + 1].index == index)) {
            p.matched += segments;
            through = p.target;
        }
    if (through)
        frames_.push_back({depth + segments, given_.size(), known_.size(), through});
    return through;
}

bool Setter::enter_table(const Key& key, bool present) {
    const bool is_wanted = here(key, [&](TargetProgress& p) {
        const std::size_t below = frames_.back().depth + 1;
        if (present && p.target->path.size() > below)
            return;
        const std::string path = p.target->path_text(below);
        p.is_done = true;
        fail(present ? fmt::format("{} is a table: give a key in it", path)
                     : fmt::format("the scene has no [{}]", path));
    });
    return is_wanted && enter(1, key, -1);
}

Entries Setter::enter_list(const Key& key, std::size_t count) {
    Entries visited{count, count, 0};
    here(key, [&](TargetProgress& p) {
        const std::size_t below = frames_.back().depth + 1;
        const long index = below < p.target->path.size() ? p.target->path[below].index : -1;
        if (index >= 0 && static_cast<std::size_t>(index) < count && p.target->path.size() > below + 1) {
            visited.first = std::min(visited.first, static_cast<std::size_t>(index));
            visited.last = std::max(visited.last, static_cast<std::size_t>(index) + 1);
            return;
        }
        p.is_done = true;
        fail(index < 0 || static_cast<std::size_t>(index) < count
                 ? fmt::format("{} is a list: give an index from 0 and a key", p.target->path_text(below))
                 : fmt::format("no entry {}: {} has {} (numbered from 0)", index, p.target->path_text(below),
                               count));
    });
    return visited.first < visited.last ? visited : Entries{count, 0, 0};
}

bool Setter::enter_entry(const Key& key, std::size_t index) {
    return enter(2, key, static_cast<long>(index));
}

void Setter::leave() {
    const VisitedTable frame = frames_.back();
    for (TargetProgress& p : progress_)
        if (!p.is_done && p.matched == frame.depth) {
            p.is_done = true;
            if (!is_compiling()) {
                fail(fmt::format("the scene has no key {}", p.target->key));
                continue;
            }
            const bool is_entry = frame.depth > 0 && p.target->path[frame.depth - 1].index >= 0;
            const std::string path = p.target->path_text(is_entry ? frame.depth - 1 : frame.depth);
            const char *open = is_entry ? "[[" : "[", *close = is_entry ? "]]" : "]";
            fail(unknown_key_text(path.empty() ? "" : open + path + close, p.target->path[frame.depth].name,
                                  std::span(known_).subspan(frame.first_known)));
        }
    given_.resize(frame.first_given);
    known_.resize(frame.first_known);
    frames_.pop_back();
}

void Setter::use_units(const Units& units) {
    if (is_compiling())
        units_ = units;
}

bool Setter::wants(Forms forms) const {
    const std::size_t depth = frames_.back().depth;
    return is_compiling() || std::ranges::any_of(progress_, [&](const TargetProgress& p) {
               return !p.is_done && p.matched == depth &&
                      std::ranges::any_of(forms, [&](const KeyAlternative& form) {
                          return form.has(p.target->path[depth].name);
                      });
           });
}

int Setter::form_given(Forms forms) {
    std::vector<GivenKey> given;
    for (const GivenKey& key : std::span(given_).subspan(frames_.back().first_given))
        if (std::ranges::any_of(forms, [&](const KeyAlternative& form) { return form.has(key.name); }))
            given.push_back(key);
    const auto names = effective_names(given, forms);
    const int form = matching_form(names, forms);
    if (names.empty())
        fail(fmt::format("{} needs one of {}", frame_path(), forms_text(forms)));
    else if (form < 0)
        fail(fmt::format("{} gives {}: give one of {}", frame_path(), fmt::join(names, " and "),
                         forms_text(forms)));
    return is_compiling() || error_ ? -1 : form;
}

std::string Setter::frame_path() const {
    const VisitedTable& frame = frames_.back();
    return frame.through ? frame.through->path_text(frame.depth) : "";
}

void Setter::complain(std::string_view key, const std::string& message) {
    fail(fmt::format("{}.{} {}", frame_path(), key, message));
}

void Setter::visit(const Key& key, void* value, const Codec& codec) {
    const bool is_target = here(key, [&](TargetProgress& p) {
        p.is_done = true;
        const auto number = static_cast<std::size_t>(&p - progress_.data());
        if (const std::string why = misfit(key, p, value, codec); !why.empty())
            return fail(why);
        if (!is_compiling()) {
            current_ = &p;
            const Node node = std::visit([](const auto& v) { return Node{{}, v}; }, values_[number]);
            codec.set({key, node, nullptr, *this}, value, p.target->path);
            return;
        }

        // The target is only looked up, and learns what it is.
        SetterTarget& target = found_[number];
        if (key.is_unit)
            fail(fmt::format(
                "{} defines the units of the scene, so it can only be set before the numbers are read",
                target.key));
        target.is_quantity = codec.is_quantity();
        target.dimension = key.dimension;
        target.units = units_;
    });
    if (!is_target && !key.is_written && codec.depth() == 0 && codec.is_quantity())
        codec.clear(value); // an alternative, as if the scene had been written and read
    if (is_target || (key.is_written && codec.is_present(value)))
        given_.push_back({key.name, is_target});
}

std::string Setter::misfit(const Key& key, const TargetProgress& p, const void* value,
                           const Codec& codec) const {
    const SetterTarget& target = *p.target;
    const std::size_t below = frames_.back().depth + 1, size = target.path.size();
    if (codec.depth() < 0)
        return fmt::format("{} holds no single values: it can be set only before the scene is read",
                           target.path_text(below));
    const auto rest = static_cast<std::size_t>(codec.depth());
    if (size > below + rest)
        return fmt::format("{} is not a table", target.path_text(below + rest));
    if (size < below + rest)
        return fmt::format("{} has several values: give one of them by an index from 0 or a name",
                           target.path_text());
    return rest == 0 ? "" : codec.misses(key, value, target.path);
}

void Setter::add(const SourcePosition&, const std::string& below, const std::string& message) {
    fail(current_->target->path_text() + below + message);
}

void Setter::fail(const std::string& message) {
    if (!error_)
        error_ = message;
}

} // namespace rodwake::scene

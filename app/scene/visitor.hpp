#pragma once
// A field list is a function that shows every key of a struct to a visitor. Visitors read, write, set and
// document.

#include "codec.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {

/// Which entries of a list of `count` are visited: those in [first, last).
struct Entries {
    std::size_t count = 0, first = 0, last = 0;
};

class Visitor {
public:
    virtual ~Visitor() = default;

    /// A value of any type that has a codec.
    template<class T>
    void operator()(const Key& key, T& value) {
        visit(key, &value, codec_of<T>());
    }

    // What only refers to values.
    void operator()(const Key& key, Choice value) { visit(key, &value, codec_of<Choice>()); }
    void operator()(const Key& key, TimeOrTravel value) { visit(key, &value, codec_of<TimeOrTravel>()); }
    void operator()(const Key& key, Settings value) { visit(key, &value, codec_of<Settings>()); }

    /// A count or a seed: the key's range keeps it from being negative.
    void operator()(const Key& key, std::size_t& value) {
        long number = static_cast<long>(value);
        (*this)(key, number);
        value = static_cast<std::size_t>(number);
    }

    template<class T>
    void table(const Key& key, std::optional<T>& value) {
        table(key, value, [this](T& present) { fields(*this, present); });
    }

    /// The same with a field list of its own.
    template<class T, class Fields>
    void table(const Key& key, std::optional<T>& value, Fields each) {
        if (!enter_table(key, value.has_value()))
            return;
        if (!value)
            value.emplace();
        each(*value);
        leave();
    }

    /// A table that may be left out: its defaults hold.
    template<class T>
    void table(const Key& key, T& value) {
        table(key, value, [this](T& present) { fields(*this, present); });
    }

    template<class T, class Fields>
    void table(const Key& key, T& value, Fields each) {
        if (!enter_table(key, true))
            return;
        each(value);
        leave();
    }

    template<class T>
    void list(const Key& key, std::vector<T>& values) {
        list(key, values, [this](T& value) { fields(*this, value); });
    }

    /// The same with a field list of its own.
    template<class T, class Fields>
    void list(const Key& key, std::vector<T>& values, Fields each) {
        const Entries visited = enter_list(key, values.size());
        values.resize(visited.count);
        for (std::size_t i = visited.first; i < visited.last; ++i)
            if (enter_entry(key, i)) {
                each(values[i]);
                leave();
            }
    }

    /// Of these forms exactly one must be given: `resolve` gets its index. Only where values are read or set.
    template<class Resolve>
    void one_form(Forms forms, Resolve resolve) {
        if (const int form = form_given(forms); form >= 0)
            resolve(form);
    }

    /// What follows from the keys before it. Only where values are read or set.
    template<class Resolve>
    void derive(Resolve resolve) {
        if (derives())
            resolve();
    }

    /// Whether keys of these forms are of interest. If not, a field list may leave them out, which saves what
    /// it takes to show them.
    virtual bool wants(Forms) const { return true; }
    /// Unit system for the keys that follow.
    virtual void use_units(const Units& units) = 0;
    /// A key of the present table has a value that is wrong beside others. Called only from `resolve`.
    virtual void complain(std::string_view key, const std::string& message) = 0;

protected:
    virtual void visit(const Key& key, void* value, const Codec& codec) = 0;
    virtual int form_given(Forms forms) = 0; ///< -1: none, nothing to resolve
    virtual bool derives() const = 0;
    virtual bool enter_table(const Key& key, bool present) = 0;
    virtual Entries enter_list(const Key& key, std::size_t count) = 0;
    virtual bool enter_entry(const Key& key, std::size_t index) = 0;
    virtual void leave() = 0;
};

} // namespace rodwake::scene

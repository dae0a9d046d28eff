#pragma once
// A field list is a function that shows every key of a struct to a visitor. Visitors read, write and
// document.

#include "key.hpp"
#include "rodwake/scene/scene.hpp"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {

/// Key names that give the same thing in different ways: {{"alpha"}, {"xi"}}, {{"eta"}, {"lame_lambda",
/// "mu"}}.
using Forms = std::vector<std::vector<std::string>>;

class Visitor {
public:
    virtual ~Visitor() = default;

    virtual void operator()(const Key& key, double& value) = 0;
    /// Reading sets the value to nothing when the key is absent.
    virtual void operator()(const Key& key, std::optional<double>& value) = 0;
    virtual void operator()(const Key& key, long& value) = 0;
    /// Reading sets the value to nothing when the key is absent.
    virtual void operator()(const Key& key, std::optional<long>& value) = 0;
    virtual void operator()(const Key& key, bool& value) = 0;
    virtual void operator()(const Key& key, std::string& value) = 0;
    virtual void operator()(const Key& key, std::vector<double>& value) = 0;
    virtual void operator()(const Key& key, std::vector<long>& value) = 0;
    virtual void operator()(const Key& key, std::vector<std::vector<double>>& value) = 0;
    /// Some of key.choices, each at most once; reading keeps the value when the key is absent.
    virtual void operator()(const Key& key, std::vector<std::string>& value) = 0;
    virtual void operator()(const Key& key, const Choice& value) = 0;
    /// Tables whose keys are among key.choices: numbers, [low, high], [other name, factor].
    virtual void operator()(const Key& key, std::map<std::string, double>& value) = 0;
    virtual void operator()(const Key& key, std::map<std::string, Interval>& value) = 0;
    virtual void operator()(const Key& key, std::map<std::string, Tie>& value) = 0;
    /// A table of "path.to.key" = value, held as "path.to.key=value".
    virtual void settings(const Key& key, std::vector<std::string>& value) = 0;

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
        if (!enter_table(key, true))
            return;
        fields(*this, value);
        leave();
    }

    template<class T>
    void list(const Key& key, std::vector<T>& values) {
        list(key, values, [this](T& value) { fields(*this, value); });
    }

    /// The same with a field list of its own.
    template<class T, class Fields>
    void list(const Key& key, std::vector<T>& values, Fields each) {
        values.resize(enter_list(key, values.size()));
        for (std::size_t i = 0; i < values.size(); ++i)
            if (enter_entry(key, i)) {
                each(values[i]);
                leave();
            }
    }

    /// A table of the contract that this version does not have.
    virtual void planned(const std::string& name) = 0;
    /// Unit system for the keys that follow.
    virtual void use_units(const Units& units) = 0;
    /// Of these forms exactly one must be given. Reading calls resolve with its index; other visitors do not
    /// call it.
    virtual void one_form(const Forms& forms, const std::function<void(int)>& resolve) = 0;
    /// What follows from the keys before it. Reading calls it; other visitors do not.
    virtual void derive(const std::function<void()>& resolve) = 0;
    /// A key of the present table has a value that is wrong beside others. Called only from `resolve`.
    virtual void complain(const std::string& key, const std::string& message) = 0;

protected:
    virtual bool enter_table(const Key& key, bool present) = 0;
    virtual std::size_t enter_list(const Key& key, std::size_t count) = 0; ///< number of entries to visit
    virtual bool enter_entry(const Key& key, std::size_t index) = 0;
    virtual void leave() = 0;
};

} // namespace rodwake::scene

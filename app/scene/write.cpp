#include "rodwake/scene/write.hpp"

#include "apply_overrides.hpp"
#include "fields.hpp"
#include "node.hpp"

#include <fmt/format.h>

#include <sstream>

namespace rodwake::scene {

namespace {

std::string value_text(const Value& value) {
    if (const auto* flag = std::get_if<bool>(&value))
        return *flag ? "true" : "false";
    if (const auto* whole = std::get_if<std::int64_t>(&value))
        return std::to_string(*whole);
    if (const auto* real = std::get_if<double>(&value))
        return number_text(*real);
    return in_quotes(std::get<std::string>(value));
}

class Writer : public Visitor {
public:
    const std::string& text() const { return text_; }

    void operator()(const Key& key, double& value) override {
        line(key, quantity_text(value, key.dimension, units_));
    }
    void operator()(const Key& key, std::optional<double>& value) override {
        if (value)
            line(key, quantity_text(*value, key.dimension, units_));
        else
            absent(key);
    }
    void operator()(const Key& key, long& value) override { line(key, std::to_string(value)); }
    void operator()(const Key& key, std::optional<long>& value) override {
        if (value)
            line(key, std::to_string(*value));
        else
            absent(key);
    }
    void operator()(const Key& key, bool& value) override { line(key, value ? "true" : "false"); }
    void operator()(const Key& key, const Choice& value) override {
        line(key, in_quotes(value.name(value.current)));
    }
    void operator()(const Key& key, std::string& value) override {
        if (value.empty())
            absent(key);
        else
            line(key, in_quotes(value));
    }
    void operator()(const Key& key, const TimeOrTravel& value) override { (*this)(key, value.time); }
    void operator()(const Key& key, BoxSize& value) override {
        const std::string side = quantity_text(value.x, key.dimension, units_);
        if (value.fit)
            line(key, fmt::format("\"fit {} {}\"", side, si_unit(key.dimension)));
        else
            line(key, value.x == value.y ? side : list_text(key, {value.x, value.y}));
    }
    void operator()(const Key& key, std::optional<PeriodicBox>& value) override {
        if (!value)
            absent(key);
        else
            line(key, value->square() ? quantity_text(value->x, key.dimension, units_)
                                      : list_text(key, {value->x, value->y}));
    }
    void operator()(const Key& key, std::vector<double>& value) override {
        if (value.empty())
            absent(key);
        else
            line(key, list_text(key, value));
    }
    void operator()(const Key& key, std::vector<std::vector<double>>& value) override {
        std::string inner;
        for (const auto& item : value)
            inner += (inner.empty() ? "" : ", ") + list_text(key, item);
        if (!value.empty())
            line(key, "[" + inner + "]");
    }
    void operator()(const Key& key, std::optional<Value>& value) override {
        if (value)
            line(key, value_text(*value));
        else
            absent(key);
    }
    void operator()(const Key& key, std::vector<Value>& value) override {
        std::string inner;
        for (const Value& item : value)
            inner += (inner.empty() ? "" : ", ") + value_text(item);
        if (value.empty())
            absent(key);
        else
            line(key, "[" + inner + "]");
    }
    void operator()(const Key& key, std::vector<std::string>& value) override {
        std::string inner;
        for (const auto& item : value)
            inner += (inner.empty() ? "" : ", ") + in_quotes(item);
        line(key, "[" + inner + "]");
    }
    void operator()(const Key& key, std::vector<long>& value) override {
        if (value.empty())
            absent(key);
        else
            line(key, fmt::format("[{}]", fmt::join(value, ", ")));
    }
    void operator()(const Key& key, std::map<std::string, double>& value) override {
        entries(key, value, [](double number) { return number_text(number); });
    }
    void operator()(const Key& key, std::map<std::string, Interval>& value) override {
        entries(key, value,
                [](Interval i) { return fmt::format("[{}, {}]", number_text(i.low), number_text(i.high)); });
    }
    void operator()(const Key& key, std::map<std::string, Tie>& value) override {
        entries(key, value, [](const Tie& tie) {
            return fmt::format("[{}, {}]", in_quotes(tie.to), number_text(tie.factor));
        });
    }
    void settings(const Key& key, std::vector<std::string>& value) override {
        line(key, settings_text(value));
    }

    void use_units(const Units& units) override { units_ = units; }
    void complain(std::string_view, const std::string&) override {}

protected:
    int form_given(Forms) override { return -1; }
    bool derives() const override { return false; }
    bool enter_table(const Key& key, bool present) override {
        if (present)
            open(key, "\n[{}]\n");
        return present;
    }
    Entries enter_list(const Key&, std::size_t count) override { return {count, 0, count}; }
    bool enter_entry(const Key& key, std::size_t) override {
        open(key, "\n[[{}]]\n");
        return true;
    }
    void leave() override { path_.pop_back(); }

private:
    void open(const Key& key, const char* header) {
        path_.push_back(path_.empty() ? std::string(key.name) : fmt::format("{}.{}", path_.back(), key.name));
        text_ += fmt::format(fmt::runtime(header), path_.back());
    }

    void line(const Key& key, const std::string& value) {
        if (key.is_written)
            text_ += fmt::format("{} = {}\n", key.name, value);
    }

    void absent(const Key& key) {
        if (key.is_written && !key.absent_text.empty())
            text_ += fmt::format("# {}: {}\n", key.name, key.absent_text);
    }

    template<class T, class Text>
    void entries(const Key& key, const std::map<std::string, T>& values, Text text) {
        std::string inner;
        for (const auto& [name, value] : values)
            inner += fmt::format("{}{} = {}", inner.empty() ? "" : ", ", key_text(name), text(value));
        if (values.empty())
            absent(key);
        else
            line(key, "{ " + inner + " }");
    }

    std::string list_text(const Key& key, const std::vector<double>& values) const {
        std::string inner;
        for (const double value : values)
            inner += (inner.empty() ? "" : ", ") + quantity_text(value, key.dimension, units_);
        return "[" + inner + "]";
    }

    std::string text_;
    std::vector<std::string> path_;
    Units units_;
};

} // namespace

std::string to_toml(const Scene& scene) {
    Scene copy = scene; // a field list may change what it visits; writing does not
    Writer writer;
    fields(writer, copy);
    return writer.text();
}

std::string to_plain_toml(const Scene& scene) {
    std::istringstream lines(to_toml(scene));
    std::string plain;
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("#"))
            plain += line + "\n";
    return plain;
}

} // namespace rodwake::scene

#include "rodwake/scene/read.hpp"

#include "fields.hpp"

#include <fmt/format.h>

#include <sstream>

namespace rodwake::scene {

namespace {

class Writer : public Visitor {
public:
    const std::string& text() const { return text_; }

    void use_units(const Units& units) override { units_ = units; }
    void complain(std::string_view, const std::string&) override {}

protected:
    void visit(const Key& key, void* value, const Codec& codec) override {
        const std::string value_text = codec.print(key, value, units_);
        if (!key.is_written)
            return;
        if (!value_text.empty())
            text_ += fmt::format("{} = {}\n", key.name, value_text);
        else if (!key.absent_text.empty())
            text_ += fmt::format("# {}: {}\n", key.name, key.absent_text);
    }
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
    Scene used = scene;
    if (used.granular)
        used.granular->gap.emplace(used.granular->plates.gap); // the bed is the same if this is the default
    std::istringstream lines(to_toml(used));
    std::string plain;
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("#"))
            plain += line + "\n";
    return plain;
}

} // namespace rodwake::scene

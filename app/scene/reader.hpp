#pragma once
// The visitor that fills a Scene from a document and collects what is wrong with it.

#include "node.hpp"
#include "problems.hpp"
#include "visitor.hpp"

namespace rodwake::scene {

class Reader : public Visitor {
public:
    /// Both must outlive the reader.
    Reader(const Node& root, Problems& problems);

    /// Reports the unknown keys at top level; call after the fields.
    void finish() { leave(); }

    void operator()(const Key& key, double& value) override;
    void operator()(const Key& key, std::optional<double>& value) override;
    void operator()(const Key& key, long& value) override;
    void operator()(const Key& key, std::optional<long>& value) override;
    void operator()(const Key& key, bool& value) override;
    void operator()(const Key& key, std::string& value) override;
    void operator()(const Key& key, std::vector<double>& value) override;
    void operator()(const Key& key, BoxSize& value) override;
    void operator()(const Key& key, const TimeOrTravel& value) override;
    void operator()(const Key& key, std::optional<PeriodicBox>& value) override;
    void operator()(const Key& key, std::vector<long>& value) override;
    void operator()(const Key& key, std::vector<std::vector<double>>& value) override;
    void operator()(const Key& key, std::optional<Value>& value) override;
    void operator()(const Key& key, std::vector<Value>& value) override;
    void operator()(const Key& key, std::vector<std::string>& value) override;
    void operator()(const Key& key, const Choice& value) override;
    void operator()(const Key& key, std::map<std::string, double>& value) override;
    void operator()(const Key& key, std::map<std::string, Interval>& value) override;
    void operator()(const Key& key, std::map<std::string, Tie>& value) override;
    void settings(const Key& key, std::vector<std::string>& value) override;
    void use_units(const Units& units) override;
    void complain(std::string_view key, const std::string& message) override;

protected:
    int form_given(Forms forms) override;
    bool derives() const override { return true; }
    bool enter_table(const Key& key, bool present) override;
    Entries enter_list(const Key& key, std::size_t count) override;
    bool enter_entry(const Key& key, std::size_t index) override;
    void leave() override;

private:
    /// The table being read.
    struct Frame {
        const Node* table;
        std::string path;  ///< "rods[1]"; empty: top level
        std::string title; ///< "[medium]", "[[rods]]"
        std::vector<std::string_view> known;
    };

    const Entry* find(const Key& key);
    std::string path_of(std::string_view key) const;
    void wrong(const Node& node, const std::string& path, const std::string& message);
    void wrong_type(const Node& node, const std::string& path, const std::string& expected,
                    const std::string& why = "");
    std::optional<double> number(const Key& key, const Node& node, const std::string& path);
    std::optional<Value> written(const Node& node, const std::string& path);
    std::optional<double> quantity(const Key& key, const Node& node, const std::string& path);
    std::optional<std::vector<double>> numbers(const Key& key, const Node& node, const std::string& path);
    /// Entries of a table whose keys are among key.choices; `read` gives the value of one, or nothing.
    template<class T, class Read>
    void entries(const Key& key, std::map<std::string, T>& value, const std::string& of, Read read);
    const std::string* text(const Key& key, const Node& node, const std::string& path);
    bool is_choice(Names names, const Node& node, const std::string& path);
    const Node::List* list_of(const Key& key, const Node& node, const std::string& path, std::string_view of);
    void missing_scales(const Node& node, const std::string& path, const std::string& what);
    void report_forms(std::span<const std::string_view> given, Forms forms);
    void unknown_key(const Frame& frame, const Entry& entry);

    Problems& problems_;
    std::vector<Frame> frames_;
    Units units_;
    bool scales_reported_ = false;
};

} // namespace rodwake::scene

#pragma once
// The visitor that fills a Scene from a document and collects what is wrong with it.

#include "diagnostics.hpp"
#include "node.hpp"
#include "visitor.hpp"

namespace rodwake::scene {

class Reader : public Visitor, private Faults {
public:
    /// Both must outlive the reader.
    Reader(const Node& root, Diagnostics& diagnostics);

    /// Reports the unknown keys at top level; call after the fields.
    void finish() { leave(); }

    void use_units(const Units& units) override;
    void complain(std::string_view key, const std::string& message) override;

protected:
    void visit(const Key& key, void* value, const Codec& codec) override;
    int form_given(Forms forms) override;
    bool derives() const override { return true; }
    bool enter_table(const Key& key, bool present) override;
    Entries enter_list(const Key& key, std::size_t count) override;
    bool enter_entry(const Key& key, std::size_t index) override;
    void leave() override;

private:
    /// The table being read.
    struct OpenTable {
        const Node* table;
        std::string path;  ///< "rods[1]"; empty: top level
        std::string title; ///< "[medium]", "[[rods]]"
        std::vector<std::string_view> known;
    };

    const Entry* find(const Key& key);
    std::string path_of(std::string_view key) const;
    void add(const SourcePosition& position, const std::string& below, const std::string& message) override;
    void add_missing_scales(const SourcePosition& place, const std::string& below,
                            const std::string& message) override;
    void wrong_type(const Node& node, const std::string& path, const std::string& expected);
    void missing_scales(const SourcePosition& place, const std::string& path, const std::string& what);

    Diagnostics& diagnostics_;
    std::vector<OpenTable> frames_;
    std::string_view current_; ///< the key whose value is read
    Units units_;
    bool scales_reported_ = false;
};

} // namespace rodwake::scene

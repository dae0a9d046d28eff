#pragma once
// The visitor that finds keys of a typed scene and sets their values.

#include "rodwake/scene/set.hpp"
#include "visitor.hpp"

namespace rodwake::scene {

/// One key to be set, and what it was found to be.
struct SetterTarget {
    std::string key;
    std::vector<PathSegment> path;
    bool is_quantity = false; ///< a number, of this dimension in these units
    Dimension dimension = Dimension::none;
    Units units{};

    /// The first `count` segments as in messages: "rods[1].position".
    std::string path_text(std::size_t count) const;
    std::string path_text() const { return path_text(path.size()); }
};

class Setter : public Visitor, private Faults {
public:
    /// Looks the targets up and fills in what they are; sets nothing.
    explicit Setter(std::span<SetterTarget> targets);
    /// Sets the targets. Both must outlive the setter.
    Setter(std::span<const SetterTarget> targets, std::span<const Value> values);

    /// What went wrong first; call after the fields.
    std::optional<std::string> finish();

    bool wants(Forms forms) const override;
    void use_units(const Units& units) override;
    void complain(std::string_view key, const std::string& message) override;

protected:
    void visit(const Key& key, void* value, const Codec& codec) override;
    int form_given(Forms forms) override;
    bool derives() const override { return !is_compiling() && !error_; }
    bool enter_table(const Key& key, bool present) override;
    Entries enter_list(const Key& key, std::size_t count) override;
    bool enter_entry(const Key& key, std::size_t index) override;
    void leave() override;

private:
    /// How far a target has been followed.
    struct TargetProgress {
        const SetterTarget* target;
        std::size_t matched = 0; ///< segments that lead into the present table
        bool is_done = false;
    };
    /// The table being visited.
    struct VisitedTable {
        std::size_t depth = 0; ///< segments that lead to it
        std::size_t first_given = 0, first_known = 0;
        const SetterTarget* through = nullptr; ///< some target in it
    };

    bool is_compiling() const { return !found_.empty(); }
    bool is_here(const TargetProgress& p, std::string_view name) const;
    /// Calls each(progress) for the targets that are this key of the present table or below it.
    template<class Each>
    bool here(const Key& key, Each each) {
        if (is_compiling())
            known_.push_back(key.name);
        bool any = false;
        for (TargetProgress& p : progress_)
            if (is_here(p, key.name)) {
                any = true;
                each(p);
            }
        return any;
    }

    /// What is wrong with what the target has below this key; empty: nothing.
    std::string misfit(const Key& key, const TargetProgress& p, const void* value, const Codec& codec) const;

    void add(const SourcePosition& position, const std::string& below, const std::string& message) override;

    bool enter(std::size_t segments, const Key& key, long index);

    std::string frame_path() const;
    void fail(const std::string& message);

    std::span<SetterTarget> found_; ///< empty: values are set
    std::span<const Value> values_;
    std::vector<TargetProgress> progress_;
    const TargetProgress* current_ = nullptr; ///< the target that is being set
    std::vector<GivenKey> given_;
    std::vector<std::string_view> known_;
    std::vector<VisitedTable> frames_;
    Units units_;
    std::optional<std::string> error_;
};

} // namespace rodwake::scene

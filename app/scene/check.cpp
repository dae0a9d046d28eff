#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace rodwake::scene {

namespace {

/// Below this separation two starts count as the same point, f/mu.
constexpr double same_point = 1e-9;
constexpr long max_grid_points = 4'000'000;

class Checker {
public:
    /// Without a document (null) no places are given.
    Checker(const Scene& scene, const Node* root, Diagnostics& diagnostics)
        : scene_(scene), root_(root), diagnostics_(diagnostics) {}

    void tables() {
        const bool listed = has("rods"), random = has("rods_random"), rods = listed || random,
                   run = has("rods_run"), field = has("field"), bed = has("granular"), tracks = has("tracks");
        if (!rods && !run && !field && !bed && !tracks && !has("fit"))
            add("",
                "nothing to do: give [[rods]] with [rods_run], or [field], or [granular], or [tracks], or "
                "[fit]");
        if (listed && random)
            add("rods", "[[rods]] and [rods_random] are given: leave one out");
        if (rods && !run)
            add(listed ? "rods" : "rods_random", "[[rods]] need [rods_run] with t_end");
        if (run && !rods)
            add("rods_run", "[rods_run] needs [[rods]], or [rods_random]");
        if (has("rods_order") && !run && !bed)
            add("rods_order",
                "[rods_order] needs rods to analyse: add [rods_run], or motile rods in [granular]");
        if (field && !has("medium"))
            add("field", "[field] needs [medium]");
        if (scene_.rods.size() > 1 && has("coupling") && !has("medium"))
            add("coupling", "[coupling] with two or more rods needs [medium]");
        if (has("variants") && !rods && !bed)
            add("variants", "[[variants]] run the rods or the bed again: they need [[rods]] or [granular]");
        if (has("measure") && !bed && !tracks)
            add("measure", "[measure] needs [granular], the bed that is measured, or [tracks]");
        if (tracks && bed)
            add("tracks",
                "[tracks] and [granular] are given, but tracks replace a simulated bed: leave one out");
        if (tracks && !has("measure"))
            add("tracks", "[tracks] needs [measure], for example with order = true");
    }

    void values() {
        // The two rods that start nearest to each other must not start at one point, unless that is a
        // contact.
        const auto& rods = scene_.rods;
        double smallest = HUGE_VAL;
        std::size_t first = 0, second = 0;
        for (std::size_t j = 1; j < rods.size() && !scene_.rods_random; ++j)
            for (std::size_t i = 0; i < j; ++i) {
                const auto &a = rods[i].position, &b = rods[j].position;
                const double distance = std::hypot(a[0] - b[0], a[1] - b[1]);
                if (distance < smallest)
                    smallest = distance, first = i, second = j;
            }
        if (smallest < same_point && !(scene_.rods_run && scene_.rods_run->contact_distance)) {
            const std::string a = fmt::format("rods.{}.position", first),
                              b = fmt::format("rods.{}.position", second);
            add(b,
                fmt::format("{} and {} start at the same point", place_of(fmt::format("rods[{}]", first), a),
                            place_of(fmt::format("rods[{}]", second), b)));
        }

        if (scene_.field)
            field(*scene_.field);
        const auto report = [this](const std::string& path, const std::string& message) {
            add(path, message);
        };
        check_medium(scene_, report);
        check_figures(scene_, report);
        check_rods(scene_, report);
        check_granular(scene_, report);
        check_measure(scene_, report);
        check_tracks(scene_, report);
        check_measured_tracks(scene_, report);
        check_fit(scene_, report);
        check_scan(scene_, report);
        unique_names(scene_.figures, "figures");
        unique_names(scene_.variants, "variants");
        if (!scene_.fit)
            return;
        const Fit& fit = *scene_.fit;
        unique_names(fit.models, "fit.models");
        for (std::size_t i = 0; i < fit.models.size(); ++i)
            if (fit.models[i].name == fit.name)
                add(fmt::format("fit.models.{}.name", i),
                    fmt::format("the name \"{}\" is already taken by the fit itself (fit.name): choose "
                                "another name, or set fit.name",
                                fit.name));
    }

private:
    bool has(std::string_view table) const {
        // A table that could not be read is missing in the scene, not in the document.
        const std::pair<std::string_view, bool> in_scene[] = {
            {"medium", scene_.medium.has_value()},
            {"coupling", scene_.coupling.has_value()},
            {"rods", !scene_.rods.empty() && !scene_.rods_random},
            {"rods_random", scene_.rods_random.has_value()},
            {"rods_order", scene_.rods_order.has_value()},
            {"rods_run", scene_.rods_run.has_value()},
            {"field", scene_.field.has_value()},
            {"granular", scene_.granular.has_value()},
            {"tracks", scene_.tracks.has_value()},
            {"measure", scene_.measure.has_value()},
            {"fit", scene_.fit.has_value()},
            {"variants", !scene_.variants.empty()}};
        if (!root_)
            return std::ranges::any_of(in_scene,
                                       [&](const auto& known) { return known == std::pair(table, true); });
        const Entry* entry = root_->find(table);
        const auto* list = entry ? entry->value.as<Node::List>() : nullptr;
        return entry && !(table == "rods" && list && list->empty());
    }

    void add(const std::string& path, const std::string& message) {
        if (root_)
            diagnostics_.add(locate(*root_, path), path, message);
        else
            diagnostics_.add({scene_.path, 0, 0, path, message});
    }

    /// "rods[0].name (line 7)"; of a value from the command line, and without a document, the name alone.
    std::string place_of(const std::string& name, const std::string& path) const {
        const long line = root_ ? locate(*root_, path).line : 0;
        return line > 0 ? fmt::format("{} (line {})", name, line) : name;
    }

    void field(const Field& field) {
        if (field.x.empty() != field.y.empty())
            add(field.x.empty() ? "field.y" : "field.x", "field.x and field.y come together");
        else if (field.x.empty() && field.cuts.empty())
            add("field", "[field] has neither a grid (x and y) nor [[field.cuts]]: nothing to evaluate");
        const auto report = [this](const std::string& path, const std::string& message) {
            add(path, message);
        };
        check_window(field.x, "field.x", report);
        check_window(field.y, "field.y", report);
        if (field.nx * field.ny > max_grid_points)
            add("field",
                fmt::format("field: nx * ny is {}; at most {}", field.nx * field.ny, max_grid_points));
        for (std::size_t i = 0; i < field.cuts.size(); ++i)
            if (!(field.cuts[i].from < field.cuts[i].to))
                add(fmt::format("field.cuts.{}.to", i),
                    fmt::format("field.cuts[{}]: from = {} must be below to = {}", i, field.cuts[i].from,
                                field.cuts[i].to));
    }

    template<class Named>
    void unique_names(const std::vector<Named>& items, const std::string& list) {
        std::map<std::string, std::size_t> seen;
        for (std::size_t i = 0; i < items.size(); ++i) {
            const auto [it, is_new] = seen.emplace(items[i].name, i);
            const std::string first = fmt::format("{}.{}.name", list, it->second);
            if (!is_new)
                add(fmt::format("{}.{}.name", list, i),
                    fmt::format("the name \"{}\" is taken by {}", items[i].name,
                                place_of(fmt::format("{}[{}]", list, it->second), first)));
        }
    }

    const Scene& scene_;
    const Node* root_;
    Diagnostics& diagnostics_;
};

} // namespace

void check(const Scene& scene, const Node* root, Diagnostics& diagnostics) {
    const bool values_hold = diagnostics.empty();
    Checker checker(scene, root, diagnostics);
    checker.tables();
    if (values_hold)
        checker.values();
}

void check_window(const std::vector<double>& range, const std::string& path, const Report& report) {
    if (range.size() == 2 && !(range[0] < range[1]))
        report(path, fmt::format("{}: min = {} must be below max = {}", path, range[0], range[1]));
}

} // namespace rodwake::scene

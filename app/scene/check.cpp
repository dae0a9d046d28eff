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

/// Whether the scene has this table. One that could not be read is missing in the scene, not in the document.
bool has_table(const Scene& scene, std::string_view name) {
    const std::pair<std::string_view, bool> tables[] = {{"medium", scene.medium.has_value()},
                                                        {"coupling", scene.coupling.has_value()},
                                                        {"rods", !scene.rods.empty() && !scene.rods_random},
                                                        {"rods_random", scene.rods_random.has_value()},
                                                        {"rods_order", scene.rods_order.has_value()},
                                                        {"rods_run", scene.rods_run.has_value()},
                                                        {"field", scene.field.has_value()},
                                                        {"granular", scene.granular.has_value()},
                                                        {"tracks", scene.tracks.has_value()},
                                                        {"measure", scene.measure.has_value()},
                                                        {"fit", scene.fit.has_value()},
                                                        {"variants", !scene.variants.empty()}};
    const auto* found = std::ranges::find(tables, name, &std::pair<std::string_view, bool>::first);
    return found != std::end(tables) && found->second;
}

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
        if (!scene_.rods_random)
            separations();
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
        if (scene_.fit)
            models(*scene_.fit);
    }

private:
    bool has(std::string_view table) const {
        if (!root_)
            return has_table(scene_, table);
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

    void separations() {
        const auto& rods = scene_.rods;
        double smallest = HUGE_VAL;
        std::size_t first = 0, second = 0;
        for (std::size_t j = 1; j < rods.size(); ++j)
            for (std::size_t i = 0; i < j; ++i) {
                const auto &a = rods[i].position, &b = rods[j].position;
                const double distance = std::hypot(a[0] - b[0], a[1] - b[1]);
                if (distance < smallest) {
                    smallest = distance;
                    first = i;
                    second = j;
                }
            }
        report_separation(smallest, first, second);
    }

    void report_separation(double smallest, std::size_t i, std::size_t j) {
        const std::string a = fmt::format("rods.{}.position", i), b = fmt::format("rods.{}.position", j);
        const bool contact = scene_.rods_run && scene_.rods_run->contact_distance; // then it is at time 0
        if (smallest < same_point && !contact)
            add(b, fmt::format("{} and {} start at the same point", place_of(fmt::format("rods[{}]", i), a),
                               place_of(fmt::format("rods[{}]", j), b)));
    }

    void field(const Field& field) {
        if (field.x.empty() != field.y.empty())
            add(field.x.empty() ? "field.y" : "field.x", "field.x and field.y come together");
        else if (field.x.empty() && field.cuts.empty())
            add("field", "[field] has neither a grid (x and y) nor [[field.cuts]]: nothing to evaluate");
        window(field.x, "field.x");
        window(field.y, "field.y");
        if (field.nx * field.ny > max_grid_points)
            add("field",
                fmt::format("field: nx * ny is {}; at most {}", field.nx * field.ny, max_grid_points));
        for (std::size_t i = 0; i < field.cuts.size(); ++i)
            if (!(field.cuts[i].from < field.cuts[i].to))
                add(fmt::format("field.cuts.{}.to", i),
                    fmt::format("field.cuts[{}]: from = {} must be below to = {}", i, field.cuts[i].from,
                                field.cuts[i].to));
    }

    void window(const std::vector<double>& range, const std::string& path) {
        if (range.size() == 2 && !(range[0] < range[1]))
            add(path, fmt::format("{}: min = {} must be below max = {}", path, range[0], range[1]));
    }

    void models(const Fit& fit) {
        unique_names(fit.models, "fit.models");
        for (std::size_t i = 0; i < fit.models.size(); ++i)
            if (fit.models[i].name == fit.name)
                add(fmt::format("fit.models.{}.name", i),
                    fmt::format("the name \"{}\" is already taken by the fit itself (fit.name): choose "
                                "another name, or set fit.name",
                                fit.name));
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

void check(const Scene& scene, const Node& root, Diagnostics& diagnostics) {
    const bool values_hold = diagnostics.empty();
    Checker checker(scene, &root, diagnostics);
    checker.tables();
    if (values_hold)
        checker.values();
}

void check(const Scene& scene, Diagnostics& diagnostics) {
    Checker checker(scene, nullptr, diagnostics);
    checker.tables();
    checker.values();
}

} // namespace rodwake::scene

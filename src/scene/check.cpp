#include "check.hpp"

#include "check_fit.hpp"
#include "check_granular.hpp"
#include "check_measure.hpp"

#include <cmath>
#include <fmt/format.h>
#include <map>

namespace rodwake::scene {

namespace {

/// Below this separation two starts count as the same point, f/mu.
constexpr double same_point = 1e-9;
constexpr long max_grid_points = 4'000'000;

class Checker {
public:
    Checker(const Scene& scene, const Node& root, Problems& problems)
        : scene_(scene), root_(root), problems_(problems) {}

    void tables() {
        const bool rods = has_rods(), run = root_.find("rods_run"), field = root_.find("field");
        if (!rods && !run && !field && !root_.find("granular") && !root_.find("fit"))
            add("", "nothing to do: give [[rods]] with [rods_run], or [field], or [granular], or [fit]");
        if (rods && !run)
            add("rods", "[[rods]] need [rods_run] with t_end");
        if (run && !rods)
            add("rods_run", "[rods_run] needs [[rods]]");
        if (field && !root_.find("medium"))
            add("field", "[field] needs [medium]");
        if (scene_.rods.size() > 1 && root_.find("coupling") && !root_.find("medium"))
            add("coupling", "[coupling] of two or more rods needs [medium]");
        if (root_.find("variants") && !rods && !root_.find("granular"))
            add("variants", "[[variants]] run the rods or the bed again: they need [[rods]] or [granular]");
        if (root_.find("measure") && !root_.find("granular"))
            add("measure", "[measure] needs [granular], the bed that is measured");
    }

    void values() {
        separations();
        if (scene_.field)
            field(*scene_.field);
        for (std::size_t i = 0; i < scene_.figures.size(); ++i)
            figure(scene_.figures[i], fmt::format("figures.{}", i));
        check_granular(scene_,
                       [this](const std::string& path, const std::string& message) { add(path, message); });
        check_measure(scene_,
                      [this](const std::string& path, const std::string& message) { add(path, message); });
        check_fit(scene_,
                  [this](const std::string& path, const std::string& message) { add(path, message); });
        unique_names(scene_.figures, "figures");
        unique_names(scene_.variants, "variants");
    }

private:
    bool has_rods() const {
        const Entry* rods = root_.find("rods");
        const auto* list = rods ? rods->value.as<Node::List>() : nullptr;
        return rods && !(list && list->empty());
    }

    void add(const std::string& path, const std::string& message) {
        problems_.add(locate(root_, path), path, message);
    }

    long line_of(const std::string& path) const { return locate(root_, path).line; }

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
        if (smallest < same_point)
            add(b, fmt::format("rods[{}] (line {}) and rods[{}] (line {}) start at the same point", i,
                               line_of(a), j, line_of(b)));
        else if (scene_.rods_run && scene_.rods_run->contact_distance &&
                 *scene_.rods_run->contact_distance >= smallest)
            add("rods_run.contact_distance",
                fmt::format(
                    "rods_run.contact_distance is {} f/mu, but rods[{}] and rods[{}] start only {} apart",
                    *scene_.rods_run->contact_distance, i, j, smallest));
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

    void figure(const Figure& figure, const std::string& path) {
        const bool streamlines = figure.kind == "polar_streamlines", cut = figure.kind == "cut";
        window(figure.x, path + ".x");
        window(figure.y, path + ".y");
        if (figure.kind == "trajectories" && scene_.rods.empty())
            add(path + ".kind", "a figure of kind trajectories needs [[rods]]");
        if ((streamlines || figure.kind == "extensional_axis") && !(scene_.field && !scene_.field->x.empty()))
            add(path + ".kind", fmt::format("a figure of kind {} needs [field] with x and y", figure.kind));
        if (streamlines && figure.gammas.empty())
            add(path, "a figure of kind polar_streamlines needs gammas = [[gamma1, gamma2], ...]");
        if (!streamlines && !figure.gammas.empty())
            add(path + ".gammas", "gammas belong to kind polar_streamlines only");
        if (cut)
            cut_exists(figure, path);
        if (!cut)
            no_cut_keys(figure, path, figure.kind == "profile");
    }

    void no_cut_keys(const Figure& figure, const std::string& path, bool profile) {
        const Figure unset;
        const auto refuse = [&](bool differs, const std::string& key) {
            if (differs)
                add(path + "." + key, key + (key == "cut" ? " belongs to kind cut only"
                                                          : " belongs to kinds cut and profile only"));
        };
        refuse(figure.cut != unset.cut, "cut");
        if (profile)
            return;
        refuse(figure.component != unset.component, "component");
        refuse(figure.sqrt_scaled != unset.sqrt_scaled, "sqrt_scaled");
    }

    void cut_exists(const Figure& figure, const std::string& path) {
        const std::size_t cuts = scene_.field ? scene_.field->cuts.size() : 0;
        if (cuts == 0)
            add(path + ".kind", "a figure of kind cut needs [[field.cuts]]");
        else if (static_cast<std::size_t>(figure.cut) >= cuts)
            add(path + ".cut",
                fmt::format("there is no cut {}: field.cuts has {} (numbered from 0)", figure.cut, cuts));
    }

    template<class Named>
    void unique_names(const std::vector<Named>& items, const std::string& list) {
        std::map<std::string, std::size_t> seen;
        for (std::size_t i = 0; i < items.size(); ++i) {
            const auto [it, is_new] = seen.emplace(items[i].name, i);
            const std::string first = fmt::format("{}.{}.name", list, it->second);
            if (!is_new)
                add(fmt::format("{}.{}.name", list, i),
                    fmt::format("the name \"{}\" is taken by {}[{}] (line {})", items[i].name, list,
                                it->second, line_of(first)));
        }
    }

    const Scene& scene_;
    const Node& root_;
    Problems& problems_;
};

} // namespace

void check(const Scene& scene, const Node& root, Problems& problems) {
    const bool values_hold = problems.empty();
    Checker checker(scene, root, problems);
    checker.tables();
    if (values_hold)
        checker.values();
}

} // namespace rodwake::scene

#include "rodwake/app/scan.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/scan/lattice.hpp"
#include "scan_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using scene::ScanAxis;
using scene::Value;
using VariedKey = ScanPlan::VariedKey;

/// Limit for beds: all their points are prepared before the first is evaluated.
constexpr std::int64_t most_places_of_beds = 100'000;

bool is_number(const Value& value) {
    return std::holds_alternative<double>(value) || std::holds_alternative<std::int64_t>(value);
}

std::string word_text(const Value& value) {
    if (const auto* flag = std::get_if<bool>(&value))
        return *flag ? "true" : "false";
    return std::get<std::string>(value);
}

/// The value of one key at a point.
Value value_at(const VariedKey& key, double at) {
    if (!key.words.empty())
        return key.words[static_cast<std::size_t>(at)];
    if (key.whole)
        return static_cast<std::int64_t>(std::llround(at * key.factor));
    return at * key.scale;
}

/// `at`: the value on each axis.
std::optional<std::string> set_values(const ScanPlan& plan, scene::Scene& scene, std::span<const double> at) {
    std::array<Value, 16> values;
    std::vector<Value> many;
    std::span<Value> all = values;
    if (plan.keys.size() > values.size()) {
        many.resize(plan.keys.size());
        all = many;
    }
    for (std::size_t k = 0; k < plan.keys.size(); ++k)
        all[k] = value_at(plan.keys[k], at[plan.keys[k].axis]);
    return plan.setter.set(scene, all.first(plan.keys.size()));
}

class Planner {
public:
    explicit Planner(const scene::Scene& scene)
        : base_(scan_base(scene)), subject_(scan_subject(scene)), scan_(*scene.scan) {}

    ScanPlan plan(const std::optional<ScanList>& list) {
        scan::Design design;
        design.kind = static_cast<scan::Kind>(scan_.design);
        if (scan_.design == scene::ScanDesign::critical) // critical values of each point of a grid or a list
            design.kind = scan_.file.empty() ? scan::Kind::grid : scan::Kind::list;
        design.samples = scan_.samples;
        design.seed = static_cast<std::uint64_t>(scan_.seed);
        design.resolution = scan_.resolution;
        design.audit = scan_.audited();
        design.boundary_tolerance = scan_.boundary_tolerance.value_or(0.0);
        design.runs = of_beds() ? base_.granular->runs : 0;
        if (list)
            take_list(design, *list);
        else
            for (const ScanAxis& axis : scan_.axes)
                design.axes.push_back(resolve(axis, design.axes.size()));
        std::optional<CriticalPlan> critical;
        if (scan_.design == scene::ScanDesign::critical)
            critical = take_solved_key(design);
        require_size(design);
        // Where t_end varies, the outputs of `base_` fit all of its values.
        for (const VariedKey& key : keys_) {
            if (key.key != "rods_run.t_end")
                continue;
            const scan::Axis& axis = design.axes[key.axis];
            double earliest = std::min(axis.from, axis.to);
            for (const double value : axis.values)
                earliest = std::min(earliest, value);
            if (earliest > 0.0) // else refused where it is tried
                base_.rods_run->t_end = earliest * key.scale;
            leave_out_outputs(base_.rods_run);
        }
        scene::ValueSetter all = setter_of(keys_);
        scan::Columns columns = of_beds() ? columns_of_beds(base_) : columns_of_rods(base_);
        ScanPlan plan{subject_,        std::move(design), std::move(columns), {},
                      base_,           std::move(all),    std::move(keys_),   {},
                      scan_.time_limit};
        plan.critical = std::move(critical);
        plan.labels.resize(plan.design.axes.size());
        std::ranges::transform(scan_.axes, plan.labels.begin(), &ScanAxis::label);
        for (const scene::ScanRefine& refine : scan_.refine) {
            const auto& names = plan.columns.observables;
            const auto at = std::ranges::find(names, refine.observable);
            if (at == names.end())
                throw InputError(fmt::format("{}: scan.refine: no column \"{}\"; there are {}", base_.path,
                                             refine.observable, fmt::join(names, ", ")));
            plan.design.drivers.push_back({static_cast<std::size_t>(at - names.begin()), refine.step});
        }
        try_ends(plan);
        if (of_beds())
            plan.design.costs = costs_of_beds(plan);
        else
            plan.certificates = scan_.certificates, plan.decide = scan_.decide || plan.critical;
        return plan;
    }

private:
    void take_list(scan::Design& design, const ScanList& list) {
        for (std::size_t k = 0; k < list.keys.size(); ++k) {
            scan::Axis axis;
            axis.name = list.keys[k];
            if (!can_vary(axis.name, subject_))
                refuse(axis.name, "is not what this scan can vary");
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (const auto& row : list.rows) {
                low = std::min(low, row[k]);
                high = std::max(high, row[k]);
            }
            axis.from = low;
            axis.to = high;
            add_keys({list.keys[k]}, {}, k, axis.name);
            axis.whole = keys_.back().whole;
            for (const auto& row : list.rows)
                require_value(axis, row[k]);
            design.axes.push_back(std::move(axis));
        }
        design.rows = list.rows;
    }

    scan::Axis resolve(const ScanAxis& given, std::size_t number) {
        scan::Axis axis;
        axis.name = given.name();
        axis.count = given.count;
        const std::size_t first = keys_.size();
        add_keys(given.key.empty() ? given.keys : std::vector{given.key}, given.factor, number, axis.name);
        axis.whole = std::ranges::any_of(std::span(keys_).subspan(first), &VariedKey::whole);
        if (given.values.empty()) {
            axis.spacing =
                given.spacing == scene::ScanSpacing::log ? scan::Spacing::log : scan::Spacing::linear;
            axis.from = plain(*given.from, axis.name);
            axis.to = plain(*given.to, axis.name);
            require_value(axis, axis.from);
            require_value(axis, axis.to);
            if (axis.from == axis.to)
                refuse(axis.name, fmt::format("from and to are both {:g}: the axis is empty", axis.from));
            if (axis.spacing == scan::Spacing::log && !(axis.from * axis.to > 0.0))
                refuse(axis.name, fmt::format("spacing \"log\" needs ends of one sign, found {:g} and {:g}",
                                              axis.from, axis.to));
            return axis;
        }

        // Listed values are numbers or words: "5 s" is a number for a key that is a time, "bdf" a word.
        axis.spacing = scan::Spacing::listed;
        axis.count = static_cast<long>(given.values.size());
        const scene::ValueSetter setter = compiled(axis.name, axis.name);
        const bool words = !is_number(held(setter, given.values.front(), axis.name));
        for (const Value& value : given.values) {
            if (words == is_number(held(setter, value, axis.name)))
                refuse(axis.name, "values are numbers or words, not both");
            if (words) {
                axis.values.push_back(static_cast<double>(axis.words.size()));
                axis.words.push_back(word_text(value));
            } else {
                axis.values.push_back(plain(value, axis.name));
                require_value(axis, axis.values.back());
            }
        }
        for (std::size_t k = first; words && k < keys_.size(); ++k)
            keys_[k].words = given.values;
        axis.from = axis.values.front();
        axis.to = axis.values.back();
        return axis;
    }

    /// The key with critical values becomes the last axis: the values of the coarse pass, and between them
    /// random ones, which estimate how often a value is missed.
    CriticalPlan take_solved_key(scan::Design& design) {
        constexpr std::size_t most_axes = 4; // a bracket takes two numbers of a point
        if (design.axes.size() > most_axes)
            throw InputError(
                fmt::format("{}: scan.file has {} columns, design = \"critical\" takes at most {}",
                            base_.path, design.axes.size(), most_axes));
        for (const scan::Axis& other : design.axes)
            if (other.name.starts_with("rods_run.rtol") || other.name.starts_with("rods_run.atol"))
                refuse(other.name, "cannot vary where critical values are checked at another tolerance");
        ScanAxis given;
        given.key = scan_.solve_for;
        given.from = scan_.from, given.to = scan_.to;
        given.spacing = scan_.spacing, given.count = scan_.count;
        scan::Axis axis = resolve(given, design.axes.size());
        if (axis.whole)
            refuse(axis.name, "a whole number has no critical value");
        std::vector<std::pair<double, bool>> fractions;
        for (long k = 0; k < scan_.count; ++k)
            fractions.emplace_back(static_cast<double>(k) / static_cast<double>(scan_.count - 1), false);
        RandomStream random(static_cast<std::uint64_t>(scan_.seed), 0x63726974);
        for (long k = 0; k < design.audit; ++k)
            fractions.emplace_back(random.uniform(), true);
        if (axis.from > axis.to)
            std::swap(axis.from, axis.to);
        std::ranges::sort(fractions);
        CriticalPlan critical{scan_.between, scan_.tolerance, {}};
        for (const auto& [fraction, audited] : fractions)
            if (const double value = axis.at(fraction); axis.values.empty() || value > axis.values.back()) {
                axis.values.push_back(value);
                critical.audited.push_back(audited);
            }
        axis.spacing = scan::Spacing::listed;
        axis.count = static_cast<long>(axis.values.size());
        std::vector<std::vector<double>> rows;
        for (const std::vector<double>& row : design.rows)
            for (const double value : axis.values) {
                rows.push_back(row);
                rows.back().push_back(value);
            }
        design.rows = std::move(rows);
        design.axes.push_back(std::move(axis));
        return critical;
    }

    void add_keys(const std::vector<std::string>& names, const std::vector<double>& factors, std::size_t axis,
                  const std::string& of) {
        for (std::size_t k = 0; k < names.size(); ++k) {
            VariedKey key;
            key.axis = axis;
            key.key = names[k];
            key.factor = factors.empty() ? 1.0 : factors[k];
            const scene::ValueSetter set_value = compiled(names[k], of);
            const Value unit = set_value.held(Value(1.0));
            key.scale = key.factor * std::get<double>(unit);
            scene::Scene trial = base_; // a key that takes 1 and not 1.0 is a whole number
            const auto wrong = set_value.set(trial, Value(1.0));
            key.whole = wrong && wrong->find("expected an integer") != std::string::npos;
            keys_.push_back(std::move(key));
        }
    }

    scene::ValueSetter compiled(const std::string& key, const std::string& axis) const {
        try {
            return scene::compile_setter(base_, key);
        } catch (const InputError& error) {
            refuse(axis, error.what());
        }
    }

    /// As ValueSetter::held.
    Value held(const scene::ValueSetter& setter, const Value& value, const std::string& axis) const {
        try {
            return setter.held(value);
        } catch (const InputError& error) {
            refuse(axis, error.what());
        }
    }

    [[noreturn]] void refuse(const std::string& axis, const std::string& why) const {
        throw InputError(fmt::format("{}: scan axis {}: {}", base_.path, axis, why));
    }

    /// In the unit that plain numbers have for the key.
    double plain(const Value& value, const std::string& name) const {
        if (const auto* real = std::get_if<double>(&value))
            return *real;
        if (const auto* whole = std::get_if<std::int64_t>(&value))
            return static_cast<double>(*whole);
        const scene::ValueSetter setter = compiled(name, name);
        const Value number = held(setter, value, name);
        if (!std::holds_alternative<double>(number))
            refuse(name, fmt::format("expected a number, found {}", word_text(value)));
        return std::get<double>(number) / std::get<double>(setter.held(Value(1.0)));
    }

    void require_value(const scan::Axis& axis, double value) const {
        if (!std::isfinite(value) || (axis.whole && value != std::round(value)))
            refuse(axis.name,
                   fmt::format("{} is not a {} number", value, std::isfinite(value) ? "whole" : "finite"));
    }

    void require_size(const scan::Design& design) const {
        const auto require_fewer = [&](std::int64_t points, const char* when, const char* remedy) {
            if (points > scan_.max_points)
                throw InputError(fmt::format(
                    "{}: the scan has {} points{}, more than scan.max_points = {}; a pair takes "
                    "0.02 to 0.2 ms, so these take {:.2g} to {:.2g} CPU hours: {}, or raise scan.max_points",
                    base_.path, points, when, scan_.max_points, static_cast<double>(points) * 2e-5 / 3600.0,
                    static_cast<double>(points) * 2e-4 / 3600.0, remedy));
        };
        if (design.kind == scan::Kind::adaptive) {
            scan::Design start = design;
            const scan::Lattice lattice(start); // refuses an illegal resolution
            start.resolution = start.axes.front().count;
            return require_fewer(scan::size(start), " at the start", "take a smaller count");
        }
        const std::int64_t runs = scan::size(design), points = scan::places(design);
        if (runs == 0)
            throw InputError(base_.path + ": the scan has no points");
        if (!of_beds())
            return require_fewer(runs, "", "take fewer points, design = \"adaptive\"");
        if (runs > scan_.max_points)
            throw InputError(fmt::format("{}: the scan has {} points of {} runs, {} runs in all, more than "
                                         "scan.max_points = {}: take fewer points or granular.runs, or raise "
                                         "scan.max_points",
                                         base_.path, points, design.runs, runs, scan_.max_points));
        if (points > most_places_of_beds)
            throw InputError(fmt::format("{}: the scan has {} points; a scan of beds has at most {}",
                                         base_.path, points, most_places_of_beds));
    }

    scene::ValueSetter setter_of(const std::vector<VariedKey>& keys) const {
        std::vector<std::string> names(keys.size());
        std::ranges::transform(keys, names.begin(), &VariedKey::key);
        try {
            return scene::compile_setter(base_, names);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: scan: {}", base_.path, error.what()));
        }
    }

    /// Ranges of keys are intervals: if both ends of an axis are legal, so is what lies between.
    void try_ends(const ScanPlan& plan) const {
        std::vector<double> first, last;
        for (std::size_t k = 0; k < plan.design.axes.size(); ++k) {
            const scan::Axis& axis = plan.design.axes[k];
            std::vector<VariedKey> keys;
            std::ranges::copy_if(plan.keys, std::back_inserter(keys),
                                 [&](const VariedKey& key) { return key.axis == k; });
            const scene::ValueSetter setter = setter_of(keys);
            std::vector<double> tried = axis.values;
            tried.insert(tried.end(), {axis.from, axis.to});
            std::vector<Value> values(keys.size());
            scene::Scene scene = plan.base;
            for (const double value : tried) {
                std::ranges::transform(keys, values.begin(),
                                       [&](const VariedKey& key) { return value_at(key, value); });
                if (const auto wrong = setter.set(scene, values))
                    refuse(axis.name, *wrong);
            }
            first.push_back(axis.from);
            last.push_back(axis.to);
        }
        scene::Scene scene = plan.base;
        for (const std::vector<double>& at : {first, last})
            if (const auto wrong = set_values(plan, scene, at))
                throw InputError(fmt::format("{}: scan: {}", base_.path, *wrong));
    }

    bool of_beds() const { return subject_ == scene::ScanSubject::beds; }

    scene::Scene base_;
    scene::ScanSubject subject_;
    const scene::Scan& scan_;
    std::vector<VariedKey> keys_;
};

} // namespace

ScanPlan plan_scan(const scene::Scene& scene, const std::optional<ScanList>& list) {
    ScanPlan plan = Planner(scene).plan(list);
    plan.description = scan_key(scene);
    if (list) { // lists differ in their values, too
        std::string bytes;
        for (const auto& row : list->rows)
            bytes.append(reinterpret_cast<const char*>(row.data()), row.size() * sizeof(double));
        plan.description += fmt::format("list: {} rows of {}, {:016x}\n", list->rows.size(),
                                        fmt::join(list->keys, ","), std::hash<std::string>{}(bytes));
    }
    return plan;
}

std::optional<std::string> set_point(const ScanPlan& plan, scene::Scene& scene, const scan::Point& point) {
    return set_values(plan, scene, values_of(plan.design, point));
}

} // namespace rodwake::app

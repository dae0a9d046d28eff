#include "granular_summary.hpp"

#include "rodwake/core/json_text.hpp"
#include "rodwake/store/csv.hpp"
#include "run/catalogue.hpp"
#include "run/record_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

/// What was modelled; the same in the files of a run and of an ensemble.
struct BedHeader {
    std::size_t beads;
    double phi_b, beads_fraction, bead_radius;
    std::variant<double, std::array<double, 2>> box;
    std::optional<std::string> container;
    double time_step, gamma, frequency, gap, orientation;
    std::uint64_t seed;

    static constexpr auto fields() {
        using R = BedHeader;
        return std::tuple{
            field("beads", &R::beads, {"1", "number of the beads"}),
            field("phi_b", &R::phi_b,
                  {"1", "area fraction requested in the scene: of beads, and of rods where they count"}),
            field("beads_fraction", &R::beads_fraction,
                  {"1", "area fraction of the beads alone, N pi a^2/(Lx Ly)"}),
            field("bead_radius", &R::bead_radius, {"m", "a"}),
            field("box", &R::box,
                  {"m", "side of the periodic box, or both; of a container: of what it fits into"}),
            field("container", &R::container, {"", "circle or rectangle (absent: the bed is periodic)"}),
            field("time_step", &R::time_step, {"s", "of the simulation"}),
            field("gamma", &R::gamma, {"1", "largest acceleration of the plates over gravity"}),
            field("frequency", &R::frequency, {"Hz", "of the plates"}),
            field("gap", &R::gap, {"m", "between the plates"}),
            field("orientation", &R::orientation, {"rad", "of the close-packed rows from x"}),
            field("seed", &R::seed, {"", "of all random numbers"})};
    }
};

ordered_json header(const BedPlan& bed, double beads_fraction) {
    const granular::GranularProblem& p = bed.problem;
    const PeriodicBox& sides = granular::bed_sides(p);
    BedHeader h{p.beads,     phi_b(bed),     beads_fraction,     p.bead_radius, sides.x,       {},
                p.time_step, p.plates.gamma, p.plates.frequency, p.plates.gap,  p.orientation, p.seed};
    if (!sides.square())
        h.box = std::array{sides.x, sides.y};
    if (p.container)
        h.container = p.container->kind == granular::ContainerKind::circle ? "circle" : "rectangle";
    return record_json(h);
}

/// The error is null where one run is all there is.
void put_mean(ordered_json& out, const std::string& name, std::span<const double> values) {
    const Estimate mean = mean_of(values);
    out[name] = mean.value;
    out[name + "_error"] = finite_or_null(mean.error);
}

template<class Member, Described Record>
std::vector<Member> members(std::span<const Record> runs, Member Record::*member) {
    std::vector<Member> list;
    for (const Record& run : runs)
        list.push_back(run.*member);
    return list;
}

/// What runs have in common, as their description says, but for their largest values.
template<Described Record>
ordered_json means_json(std::span<const Record> runs) {
    ordered_json out;
    for_each_field<Record>([&](const auto& field) {
        const std::string name(field.name);
        const auto values = members(runs, field.get);
        using Member = typename std::remove_cvref_t<decltype(values)>::value_type;
        if constexpr (Described<Member>) {
            out[name] = means_json(std::span(values));
        } else if constexpr (std::is_same_v<Member, double>) {
            if (field.info.over_runs == OverRuns::mean)
                put_mean(out, name, values);
            else if (field.info.over_runs == OverRuns::sum)
                out[name] = mean_of(values).value * static_cast<double>(runs.size());
            else if (field.info.over_runs == OverRuns::mean_of_known) {
                std::vector<double> known = values;
                std::erase_if(known, [](double value) { return std::isnan(value); });
                if (!field.info.known_runs.empty())
                    out[std::string(field.info.known_runs)] = known.size();
                if (!known.empty())
                    put_mean(out, name, known);
            }
        } else if constexpr (std::is_same_v<Member, std::string>) {
            out[name] = values.front(); // OverRuns::same
        }
    });
    return out;
}

/// Numbers of a part of the summary. Its place in the file begins with `before`, its columns end with
/// `behind`.
template<class Get>
void add_numbers(std::vector<SummaryNumber>& all, const Get& part, const std::string& before,
                 const std::string& behind, bool largest = false) {
    using Record = std::remove_cvref_t<decltype(part(std::declval<const GranularSummary&>()))>;
    for_each_field<Record>([&](const auto& field) {
        const auto described = [&](std::string_view column) {
            return column.empty() ? std::string() : std::string(column) + behind;
        };
        if constexpr (std::is_same_v<decltype(field.get), double Record::*>)
            if ((field.info.over_runs == OverRuns::largest) == largest)
                all.push_back({before + std::string(field.name), described(field.column()),
                               described(field.scan_column()), field.info.unit, field.info.meaning,
                               field.info.over_runs, [part, member = field.get](const GranularSummary& s) {
                                   return part(s).*member;
                               }});
    });
}

/// Seconds of wall clock.
ordered_json cost_json(const RunCost& cost) {
    ordered_json parts;
    for (const CostPart& part : cost_parts)
        parts[part.name] = cost.*part.seconds;
    parts["particle_steps"] = cost.particle_steps;
    parts["particle_steps_per_second"] = cost.particle_steps_per_second();
    return parts;
}

RunCost cost_of(const json& j) {
    RunCost cost;
    for (const CostPart& part : cost_parts)
        cost.*part.seconds = j.at(part.name);
    cost.particle_steps = j.at("particle_steps");
    return cost;
}

} // namespace

RunCost cost_of(std::span<const GranularSummary> runs) {
    RunCost all;
    for (const GranularSummary& run : runs)
        all += run.cost;
    return all;
}

double phi_b(const BedPlan& bed) {
    return bed.of.scene.granular->phi_b.value_or(granular::bead_area_fraction(bed.problem));
}

std::string summary_json(const BedPlan& bed, const GranularSummary& s) {
    ordered_json out = record_json(s);
    if (!s.kinds.empty())
        out["kinds"] = member_json(s.kinds);
    out["state_hash"] = hash_text(s.state_hash);
    out["run"] = s.run + 1; // as its folder
    out["runs"] = 1;
    out.update(header(bed, s.beads_fraction));
    out["cost"] = cost_json(s.cost);
    return json_text(out, 2) + "\n";
}

std::string ensemble_json(const BedPlan& bed, std::span<const GranularSummary> runs, std::size_t asked) {
    ordered_json out = means_json(runs);
    for_each_field<GranularSummary>([&](const auto& field) {
        if constexpr (std::is_same_v<decltype(field.get), double GranularSummary::*>)
            if (field.info.over_runs == OverRuns::largest)
                out[std::string(field.name)] = std::ranges::max(members(runs, field.get));
    });
    out["absorbing_runs"] = std::ranges::count(runs, true, &GranularSummary::absorbing_state);
    out["rods"] = ordered_json::array();
    for (std::size_t i = 0; i < runs[0].rods.size(); ++i) {
        std::vector<RodSummary> rod;
        for (const GranularSummary& summary : runs)
            rod.push_back(summary.rods[i]);
        out["rods"].push_back(means_json(std::span<const RodSummary>(rod)));
    }
    if (bed.problem.rods.size() == 2) {
        std::vector<PairSummary> pairs;
        for (const GranularSummary& run : runs)
            pairs.push_back(run.pair.value_or(PairSummary{}));
        out["pair"] = means_json(std::span<const PairSummary>(pairs));
    }
    for (std::size_t k = 0; k < runs[0].kinds.size(); ++k) {
        std::vector<KindSummary> kind;
        for (const GranularSummary& summary : runs)
            kind.push_back(summary.kinds[k]);
        ordered_json means = {{"radius", kind[0].radius}, {"beads", kind[0].beads}};
        means.update(means_json(std::span<const KindSummary>(kind)));
        means["absorbing_runs"] = std::ranges::count(kind, true, &KindSummary::absorbing_state);
        out["kinds"].push_back(means);
    }
    out["state_hash"] = hash_text(granular::combined_hash(members(runs, &GranularSummary::state_hash)));
    out["runs"] = asked;
    out["finished_runs"] = runs.size();
    const bool same = granular::bead_mix(bed.problem).equal(); // to the last digit
    out.update(header(bed, same ? runs[0].beads_fraction
                                : mean_of(members(runs, &GranularSummary::beads_fraction)).value));
    out["cost"] = cost_json(cost_of(runs));
    return json_text(out, 2) + "\n";
}

std::vector<std::string> numbers_to(std::size_t count) {
    std::vector<std::string> numbers;
    for (std::size_t k = 0; k < count; ++k)
        numbers.push_back(std::to_string(k));
    return numbers;
}

std::vector<SummaryNumber> summary_numbers(const std::vector<std::string>& rods, bool pair,
                                           const std::vector<std::string>& kinds) {
    std::vector<SummaryNumber> all;
    const auto whole = [](const GranularSummary& s) -> const GranularSummary& { return s; };
    for (const bool largest : {false, true})
        add_numbers(all, whole, "", "", largest);
    add_numbers(
        all, [](const GranularSummary& s) -> const PressureSummary& { return s.pressure; }, "pressure.", "");
    for (std::size_t i = 0; i < rods.size(); ++i)
        add_numbers(
            all, [i](const GranularSummary& s) -> const RodSummary& { return s.rods[i]; },
            "rods." + rods[i] + ".", rods[i]);
    if (pair)
        add_numbers(
            all, [](const GranularSummary& s) -> const PairSummary& { return s.pair.value(); }, "pair.", "");
    for (std::size_t k = 0; k < kinds.size(); ++k)
        add_numbers(
            all, [k](const GranularSummary& s) -> const KindSummary& { return s.kinds[k]; },
            "kinds." + kinds[k] + ".", kinds[k]);
    return all;
}

std::string ensemble_csv(const granular::GranularProblem& problem, std::span<const GranularSummary> runs) {
    std::vector<std::string> names = {"run"};
    std::vector<std::vector<double>> columns(1);
    for (const GranularSummary& s : runs)
        columns[0].push_back(static_cast<double>(s.run + 1));
    for (const SummaryNumber& number :
         summary_numbers(numbers_to(problem.rods.size()), problem.rods.size() == 2,
                         numbers_to(runs.empty() ? 0 : runs[0].kinds.size())))
        if (!number.column.empty()) {
            names.push_back(number.column);
            std::ranges::transform(runs, std::back_inserter(columns.emplace_back()), number.of);
        }
    return store::to_csv(names, columns);
}

std::vector<ColumnInfo> runs_columns() {
    std::vector<ColumnInfo> columns = {{"run", "1", "number of the run, from 1"}};
    for (const SummaryNumber& number : summary_numbers({"<k>"}, true, {"<k>"}))
        if (!number.column.empty())
            columns.push_back(column_info(number.column, number.unit, number.meaning));
    return columns;
}

std::vector<ColumnInfo> summary_values() {
    std::vector<ColumnInfo> values;
    for (const SummaryNumber& number : summary_numbers({"<k>"}, true, {"<k>"}))
        values.push_back(column_info(number.path, number.unit, number.meaning));
    for_each_field<BedHeader>([&](const auto& field) {
        if (!field.info.unit.empty())
            values.push_back({field.name, field.info.unit, field.info.meaning});
    });
    values.insert(values.end(),
                  {{"cost.particle_steps", "1", "spheres times steps"},
                   {"cost.particle_steps_per_second", "1/s", "of wall clock, without the start"},
                   {"cost.<k>", "s", "of wall clock"}});
    return values;
}

std::optional<GranularSummary> read_summary(const std::filesystem::path& file,
                                            const granular::GranularProblem& problem, std::uint32_t run) {
    std::ifstream in(file);
    const json parsed = json::parse(in, nullptr, false);
    if (!parsed.is_object())
        return std::nullopt;
    try {
        GranularSummary summary;
        summary.run = run;
        read_record(parsed, summary);
        summary.state_hash = std::stoull(parsed.at("state_hash").get<std::string>(), nullptr, 16);
        summary.beads_fraction = parsed.at("beads_fraction");
        if (parsed.contains("kinds")) // of several kinds of beads
            read_member(parsed.at("kinds"), summary.kinds);
        if (parsed.contains("cost")) // not in files of earlier versions
            summary.cost = cost_of(parsed.at("cost"));
        return summary.rods.size() == problem.rods.size() ? std::optional(std::move(summary)) : std::nullopt;
    } catch (const std::exception&) { // a file of another version: the run is done again
        return std::nullopt;
    }
}

} // namespace rodwake::app

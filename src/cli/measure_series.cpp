// series.csv and the lines for the terminal: one row, a few lines, for each case.

#include "measure_results.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::cli {

namespace {

using measure::Estimate;

std::string field(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : ""; }

std::string field(const std::optional<double>& value, double scale) {
    return value ? field(*value * scale) : "";
}

/// "value,error"; empty fields for what was not measured or is not known.
std::string fields(const Estimate* e, double scale) {
    if (!e || e->samples == 0)
        return ",";
    return field(e->value * scale) + "," + (e->known() ? field(e->error * scale) : "");
}

std::string class_number(measure::Decay decay) {
    switch (decay) {
    case measure::Decay::exponential:
        return "0";
    case measure::Decay::algebraic:
        return "1";
    case measure::Decay::long_range:
        return "2";
    case measure::Decay::undetermined:
        break;
    }
    return "";
}

std::string row(const CaseResults& r) {
    const double a = r.bead_radius, to_a = 1.0 / a;
    const auto* s = r.structure ? &*r.structure : nullptr;
    const auto* m = r.microrheology ? &*r.microrheology : nullptr;
    const auto* p = r.pairs ? &*r.pairs : nullptr;
    const auto* f = r.force ? &*r.force : nullptr;
    return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.name, field(r.phi_b),
                       field(r.separation, to_a), field(r.imposed_speed, to_a),
                       fields(s ? &s->psi6 : nullptr, 1.0), fields(s ? &s->decay.exponent : nullptr, 1.0),
                       s ? class_number(s->decay.decay) : "", fields(m ? &m->stiffness_zero : nullptr, a * a),
                       fields(p ? &p->half_box_change : nullptr, to_a), r.runs,
                       fields(p ? &p->non_reciprocity : nullptr, 1.0), fields(f ? &f->force : nullptr, 1.0),
                       fields(f ? &f->speed : nullptr, to_a));
}

std::string text(const Estimate& e, double scale = 1.0) {
    return e.known() ? fmt::format("{:.4g} +- {:.2g}", e.value * scale, e.error * scale)
                     : fmt::format("{:.4g} (error unknown)", e.value * scale);
}

nlohmann::ordered_json line_json(const measure::LineFit& fit) {
    const auto number = [](const Estimate& e, double scale) {
        return nlohmann::ordered_json{{"value", e.value * scale}, {"error", e.error * scale}};
    };
    return {{"intercept_N", number(fit.intercept, 1.0)},
            {"slope_N_s_per_m", number(fit.slope, 1.0)},
            {"chi2", fit.chi2},
            {"dof", fit.dof},
            {"probability", measure::chi2_probability(fit.chi2, fit.dof)}};
}

/// f = f0 + c v and f = c v; empty without three imposed speeds with errors.
nlohmann::ordered_json force_lines(const std::vector<CaseResults>& cases) {
    std::vector<double> v, f, error;
    for (const CaseResults& one : cases)
        if (one.imposed_speed && one.force && one.force->force.known() && one.force->force.error > 0.0) {
            v.push_back(*one.imposed_speed);
            f.push_back(one.force->force.value);
            error.push_back(one.force->force.error);
        }
    if (v.size() < 3 || std::ranges::count(v, v[0]) == static_cast<long>(v.size()))
        return {};
    return {{"line", line_json(measure::fit_line(v, f, error))},
            {"proportional", line_json(measure::fit_proportional(v, f, error))}};
}

} // namespace

void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases) {
    std::string content =
        "# a row for the scene and one for each variant; lengths in a, speeds in a/s, force in N, stiffness "
        "in 1/a^2; class 0 "
        "exponential, 1 algebraic, 2 long-range; empty: not measured\n"
        "name,phi_b,d0,imposed_speed,psi6,psi6_error,exponent,exponent_error,class,stiffness,stiffness_error,"
        "delta_y,"
        "delta_y_error,runs,non_reciprocity,non_reciprocity_error,force,force_error,speed,speed_error\n";
    for (const CaseResults& one : cases)
        content += row(one);
    store::write_atomically(folder / "series.csv", content);
    if (const auto lines = force_lines(cases); !lines.empty())
        store::write_atomically(folder / "series.json",
                                nlohmann::ordered_json{{"force_against_imposed_speed", lines}}.dump(2) +
                                    "\n");
}

std::vector<std::string> describe(const CaseResults& r) {
    const double a = r.bead_radius, to_a = 1.0 / a;
    const std::string name = r.label.empty() ? "measure" : fmt::format("measure ({})", r.label);
    std::vector<std::string> lines;
    const auto say = [&](const std::string& line) { lines.push_back(name + ": " + line); };
    if (r.structure)
        say(fmt::format("psi6 {}, g_B {} ({}); neighbours within {:.3g} a", text(r.structure->psi6),
                        to_string(r.structure->decay.decay), phase_of(r.structure->decay.decay),
                        r.structure->cutoff / a));
    if (r.microrheology)
        say(fmt::format("stiffness {} /a^2, spring {} N/m", text(r.microrheology->stiffness_zero, a * a),
                        text(r.microrheology->spring)));
    if (r.flow)
        say(fmt::format("beads near the rod move at {:.3g} a/s and are dragged by {} of its way",
                        r.flow->near_speed / a, text(r.flow->drag_share)));
    if (r.displacement)
        say(fmt::format("displacement field ({}) from {} frames in {} blocks; rod at {:.3g} a/s",
                        to_string(r.displacement->method), r.displacement->frames, r.displacement->blocks,
                        r.displacement->mean_speed * to_a));
    if (r.pairs)
        say(fmt::format(
            "separation changes by {} a over half the box ({} of {} runs); contact {}, pursuit {}, "
            "escape {}; non-reciprocity {}",
            text(r.pairs->half_box_change, to_a), r.pairs->half_box_change.samples, r.pairs->runs.size(),
            r.pairs->contact, r.pairs->pursuit, r.pairs->escape, text(r.pairs->non_reciprocity)));
    if (r.force)
        say(fmt::format("force on the beads {} uN at {} a/s", text(r.force->force, 1e6),
                        text(r.force->speed, to_a)));
    return lines;
}

} // namespace rodwake::cli

// The report as a page.

#include "diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Value and error with as many decimals as two digits of the error need.
std::string with_error(double value, double error, bool known) {
    if (!known && error != 0.0)
        return fmt::format("{:.6g}, error unknown", value);
    if (!std::isfinite(error))
        return fmt::format("{:.6g} +- infinite", value);
    if (error <= 0.0)
        return fmt::format("{:.8g}", value);
    const int of_error = static_cast<int>(std::floor(std::log10(error)));
    const int of_value = value == 0.0 ? of_error : static_cast<int>(std::floor(std::log10(std::abs(value))));
    if (std::max(of_error, of_value) > 6 || std::max(of_error, of_value) < -4)
        return fmt::format("{:.{}e} +- {:.1e}", value, std::clamp(of_value - of_error + 1, 1, 16), error);
    const int decimals = std::clamp(1 - of_error, 0, 17);
    return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, error, decimals);
}

std::string interval(double low, double high) { return fmt::format("[{:.5g}, {:.5g}]", low, high); }

std::string bounds(const Parameter& p) {
    const bool below = std::isfinite(p.lower), above = std::isfinite(p.upper);
    if (below && above)
        return interval(p.lower, p.upper);
    return below ? fmt::format(">= {:.5g}", p.lower) : above ? fmt::format("<= {:.5g}", p.upper) : "";
}

std::string kind(const Parameter& p, const Estimate& e) {
    if (p.fixed)
        return "fixed";
    if (!e.tied_to.empty())
        return fmt::format("{:g} {}", e.tie_factor, e.tied_to);
    return e.at_lower                      ? "on lower bound"
           : e.at_upper                    ? "on upper bound"
           : p.transform == Transform::log ? "log"
                                           : "";
}

using Row = std::vector<std::string>;

std::string table(const std::vector<Row>& rows) {
    std::vector<std::size_t> width(rows.front().size());
    for (const Row& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c)
            width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (const Row& row : rows) {
        std::string line = " ";
        for (std::size_t c = 0; c < row.size(); ++c)
            line += fmt::format(" {:<{}} ", row[c], width[c]);
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

std::string estimates(const Problem& problem, const Report& report) {
    std::vector<Row> rows{{"parameter", "value +- error", "95 % interval", "start", "bounds", ""}};
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const Estimate& e = report.estimates[i];
        const Parameter& p = problem.parameters[i];
        const bool known = std::isfinite(report.error_factor);
        rows.push_back({e.name, with_error(e.value, e.standard_error, known),
                        known && e.low < e.high ? interval(e.low, e.high) : "",
                        e.tied_to.empty() ? fmt::format("{:.5g}", p.start) : "", p.free() ? bounds(p) : "",
                        kind(p, e)});
    }
    return table(rows);
}

std::string correlations(const Problem& problem, const Report& report) {
    if (report.free.size() < 2)
        return {};
    constexpr std::size_t most = 12; // parameters with which starts of tracks are shown too
    std::vector<Row> rows{{""}};
    std::string strong;
    for (std::size_t a = 0; a < report.free.size(); ++a) {
        if (report.free.size() > most && !problem.parameters[report.free[a]].spreads)
            break; // the rest are poses
        rows.front().push_back(report.estimates[report.free[a]].name);
        Row row{report.estimates[report.free[a]].name};
        for (std::size_t b = 0; b <= a; ++b) {
            const double c = report.correlation(a, b);
            row.push_back(fmt::format("{:.3f}", c));
            if (a != b && std::abs(c) > 0.9)
                strong += fmt::format("  {} and {} are strongly correlated ({:.4f})\n",
                                      report.estimates[report.free[b]].name,
                                      report.estimates[report.free[a]].name, c);
        }
        rows.push_back(row);
    }
    return "\nCorrelations\n" + table(rows) + strong;
}

std::string goodness(const Problem& problem, const Fit& fit, const Report& report) {
    std::string text = fmt::format("\nchi2 = {:.6g}, {} data", report.chi2, problem.residuals);
    if (problem.independent < 1.0)
        text += fmt::format(" worth {} independent ones", independent_values(problem));
    text += fmt::format(", {} degrees of freedom", report.dof);
    if (report.dof > 0)
        text += fmt::format(", chi2/dof = {:.4g}", report.chi2 / static_cast<double>(report.dof));
    if (problem.sigma_known && report.dof > 0)
        text += ", probability " + describe_probability(report.probability);
    if (fit.loss != Loss::squares)
        text += fmt::format("\nobjective of the loss = {:.6g}", fit.objective);
    return text + fmt::format("\n{} after {} evaluations; {}\n", to_string(fit.termination), fit.evaluations,
                              fit.reason);
}

/// The waterfall: objectives from the best up, at most ten.
std::string starts(const Fit& fit, const Report& report) {
    if (fit.starts.size() < 2)
        return {};
    std::vector<StartResult> sorted = fit.starts;
    std::ranges::stable_sort(sorted, {}, &StartResult::objective);
    std::string text =
        fmt::format("\nStarts: {} of {} ended at the best objective\n", report.same_optimum, sorted.size());
    std::vector<Row> rows{{"start", "objective", "above the best", "evaluations", "ended"}};
    for (std::size_t i = 0; i < std::min<std::size_t>(sorted.size(), 10); ++i) {
        const StartResult& s = sorted[i];
        const double above =
            std::isfinite(s.objective) ? std::max(s.objective - fit.objective, 0.0) : s.objective;
        rows.push_back({fmt::format("{}", s.index), fmt::format("{:.8g}", s.objective),
                        fmt::format("{:.3g}", above), fmt::format("{}", s.evaluations),
                        s.termination.substr(0, s.termination.find(':'))});
    }
    text += table(rows);
    return text + (sorted.size() > 10 ? fmt::format("  and {} more\n", sorted.size() - 10) : "");
}

std::string diagnostics(const Report& report) {
    std::string text = report.diagnostics.empty() ? "" : "\nRemarks\n";
    for (const std::string& remark : report.diagnostics)
        text += "  - " + remark + "\n";
    return text;
}

} // namespace

std::string to_text(const Problem& problem, const Fit& fit, const Report& report) {
    return estimates(problem, report) + correlations(problem, report) + goodness(problem, fit, report) +
           starts(fit, report) + diagnostics(report);
}

} // namespace rodwake::fitting

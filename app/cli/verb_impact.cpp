// rodwake impact --cases: the contact law by itself, one impact a row, to standard output.

#include "rodwake/core/error.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/store/csv.hpp"
#include "verbs.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cstdio>
#include <limits>

namespace rodwake::cli {

namespace {

constexpr const char* impact_header = "Px,Py,Pz,wx,wy,wz\n";

struct ImpactRow : granular::ImpactCase {
    std::size_t line; ///< of the file
};

} // namespace

int verb_impact(const Options& options) {
    const std::vector<std::string> names = {"Kxx", "Kxy", "Kxz", "Kyy", "Kyz", "Kzz",
                                            "vx",  "vy",  "vz",  "mu",  "e"};
    const store::Table table = store::read_csv(options.cases, names);
    std::vector<ImpactRow> cases(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const auto at = [&](const char* name) { return (*table.find(name))[i]; };
        ImpactRow& c = cases[i];
        c.inverse_mass << at("Kxx"), at("Kxy"), at("Kxz"), at("Kxy"), at("Kyy"), at("Kyz"), at("Kxz"),
            at("Kyz"), at("Kzz");
        c.velocity = {at("vx"), at("vy"), at("vz")};
        c.surface = {at("mu"), at("e")};
        c.line = table.lines[i];
    }
    std::string messages;
    const auto complain = [&](std::size_t line, const std::string& what) {
        messages += fmt::format("{}{}:{}:1: {}", messages.empty() ? "" : "\n", options.cases, line, what);
    };
    for (const ImpactRow& c : cases) {
        // Smallest eigenvalue of K over the largest absolute one, scaled against under- and overflow.
        double least = 0.0;
        if (const double size = c.inverse_mass.cwiseAbs().maxCoeff(); size > 0.0) {
            const Eigen::Matrix3d scaled = c.inverse_mass / size;
            const Eigen::Vector3d values =
                Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scaled).eigenvalues();
            least = values[0] / values.cwiseAbs().maxCoeff();
        }
        if (!(least > 4.0 * std::numeric_limits<double>::epsilon()))
            complain(c.line,
                     fmt::format("K is not positive definite: smallest over largest eigenvalue = {:.3g}, "
                                 "must be > 1e-15 (an inverse mass is)",
                                 least));
        if (!(c.surface.friction >= 0.0))
            complain(c.line, fmt::format("mu = {}: must be >= 0", c.surface.friction));
        if (!(c.surface.restitution >= 0.0 && c.surface.restitution <= 1.0))
            complain(c.line, fmt::format("e = {}: must be from 0 to 1", c.surface.restitution));
    }
    if (!messages.empty())
        throw InputError(messages);
    fmt::memory_buffer out; // every row before the first is printed: a bad one leaves nothing half-written
    out.append(std::string_view(impact_header));
    for (const ImpactRow& c : cases)
        try {
            const granular::Impact i = granular::stronge_impact(c.inverse_mass, c.velocity, c.surface);
            if (!i.impulse.allFinite() || !i.velocity.allFinite()) {
                complain(c.line, "impulse or velocity is beyond the range of a double; choose other units");
                continue;
            }
            fmt::format_to(std::back_inserter(out), "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n",
                           i.impulse.x(), i.impulse.y(), i.impulse.z(), i.velocity.x(), i.velocity.y(),
                           i.velocity.z());
        } catch (const RunError& error) {
            throw RunError(fmt::format("{}:{}:1: {}", options.cases, c.line, error.what()));
        }
    if (!messages.empty())
        throw InputError(messages);
    if (options.dry_run)
        return 0;
    if (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0)
        throw RunError("cannot write to standard output");
    return 0;
}

} // namespace rodwake::cli

// rodwake check: the resolved scene, what will be modelled and what not and why, and what it will cost.

#include "check_bed.hpp"
#include "check_fit.hpp"
#include "problems.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/scene/write.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace rodwake::cli {

namespace {

void add_medium_lines(const scene::Scene& scene, std::vector<CheckLine>& lines) {
    if (!scene.medium)
        return;
    const scene::Medium& m = *scene.medium;
    lines.push_back({true, m.fitted ? std::string("medium: eta and xi from the fit")
                                    : fmt::format("medium: eta = {:g}, xi = {:g}", m.eta, m.xi)});
    lines.push_back({m.periodic.has_value(),
                     m.periodic ? fmt::format("periodic box of {:g} for rods and field", *m.periodic)
                                : "periodic images of rods: no medium.periodic, infinite plane"});
}

void add_field_lines(const scene::Scene& scene, std::vector<CheckLine>& lines) {
    if (!scene.field) {
        lines.push_back({false, "field maps: no [field] table"});
        return;
    }
    const long points = scene.field->x.empty() ? 0 : scene.field->nx * scene.field->ny;
    lines.push_back(
        {true, fmt::format("field of one rod: {} grid points, {} cuts", points, scene.field->cuts.size())});
}

void add_rod_lines(const scene::Scene& scene, std::vector<CheckLine>& lines) {
    if (!scene.rods_run) {
        lines.push_back({false, "rod dynamics: no [[rods]] and [rods_run]"});
        return;
    }
    const rods::RodProblem problem = rod_problem(scene);
    const rods::Couplings& c = problem.couplings;
    const bool interacting = problem.medium && c.any() && problem.rods.size() > 1;
    lines.push_back({true, fmt::format("{} rods to t = {:g}, {} variants", problem.rods.size(), problem.t_end,
                                       scene.variants.size())});
    if (!interacting)
        lines.push_back({false, problem.rods.size() < 2
                                    ? "interaction: a single rod feels no other; no field is evaluated"
                                : problem.medium ? "interaction: no coupling, so no field is evaluated"
                                                 : "interaction: no [medium]; rods walk straight"});
    lines.push_back({interacting && c.apolar(),
                     c.apolar() ? "alignment with the strain axis (kappa)"
                                : "alignment with the strain axis: kappa is 0, strain is not evaluated"});
    lines.push_back({interacting && c.polar(),
                     c.polar()
                         ? "polar turning (gamma1, gamma2)"
                         : "polar turning: gamma1 and gamma2 are 0, strain gradients are not evaluated"});
    lines.push_back({problem.contact_distance.has_value(),
                     problem.contact_distance
                         ? fmt::format("contact stops the run at {:g}", *problem.contact_distance)
                         : "contact: no rods_run.contact_distance"});
}

/// What the scene names and this version leaves out.
void add_unused_lines(const scene::Scene& scene, std::vector<CheckLine>& lines) {
    if (scene.medium && scene.medium->table)
        lines.push_back({false, "medium.table.tolerance: not used with field = \"exact\""});
    if (scene.noise)
        lines.push_back({false, "noise: rotational_diffusion is 0"});
    else if (scene.rods_run)
        lines.push_back({false, "noise: no [noise] table"});
}

std::string cost(const scene::Scene& scene, const BedReport& bed, const FitCheck& fit) {
    constexpr double point_seconds = 1.2e-7; // bench/: strain at one point
    std::string text = bed.cost + fit.cost;
    if (scene.field && !scene.field->x.empty())
        text += fmt::format("  field maps: about {:.2g} s\n",
                            2.0 * point_seconds * static_cast<double>(scene.field->nx * scene.field->ny));
    if (scene.rods_run) {
        const double n = static_cast<double>(scene.rods.size()), pairs = n * (n - 1.0);
        text += fmt::format(
            "  one right-hand side: {:.0f} field points, about {:.2g} us; a pair run takes some hundred to a "
            "few thousand of them\n",
            pairs, 1e6 * (pairs * point_seconds + 5e-8 * n));
    }
    return text.empty() ? "  nothing to compute\n" : text;
}

} // namespace

int verb_check(const Options& options) {
    const scene::Scene scene = scene::read_scene(options.target, options.overrides);
    std::vector<CheckLine> lines;
    add_medium_lines(scene, lines);
    add_field_lines(scene, lines);
    add_rod_lines(scene, lines);
    add_unused_lines(scene, lines);
    const BedReport bed = check_bed(scene, options.seed);
    lines.insert(lines.end(), bed.lines.begin(), bed.lines.end());
    const FitCheck fit = check_fit(scene, options);
    lines.insert(lines.end(), fit.lines.begin(), fit.lines.end());
    fmt::print("{}\n# modelled\n", scene::to_toml(scene));
    for (const CheckLine& line : lines)
        if (line.modelled)
            fmt::print("  {}\n", line.text);
    fmt::print("\n# not modelled\n");
    for (const CheckLine& line : lines)
        if (!line.modelled)
            fmt::print("  {}\n", line.text);
    fmt::print("\n# expected cost\n{}\n{}: ok\n", cost(scene, bed, fit), options.target);
    return 0;
}

} // namespace rodwake::cli

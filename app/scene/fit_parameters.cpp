// What [fit] says of a parameter, with its defaults.

#include "fit_parameters.hpp"

#include "diagnostics.hpp"
#include "rodwake/scene/fit.hpp"

#include <algorithm>
#include <map>

namespace rodwake::scene {

const std::vector<FitParameter>& fit_parameter_list() {
    static const std::vector<FitParameter> list = {
        {"f_over_mu", "f/\\mu", "force of the rod over the shear modulus, a length"},
        {"f2d_over_mu", "f_2 d/\\mu", "y force dipole over the shear modulus"},
        {"eta", "\\eta", "(lambda_L + mu)/mu of the medium"},
        {"xi", "\\xi", "screening length mu/(zeta v0) of the medium"},
        {"alpha", "\\alpha", "f_over_mu/xi, instead of xi"},
        {"drag_area", "f/\\zeta v", "f_over_mu times xi, instead of xi: force over drag and speed, an area"},
        {"x0", "x_0", "where the force acts, ahead of the rod's centre"},
        {"amplitude", "A", "of maps: factor by which the monopole exceeds its prediction, force"},
        {"force", "f", "of maps: force of the rod on the medium along its heading"},
        {"p_xx", "P_{xx}", "of maps: force dipole along the rod, positive if it pushes outward"},
        {"p_yy", "P_{yy}", "of maps: force dipole across the rod, the inclusion that its slot is"},
        {"q_xxx", "Q_{xxx}", "of maps: second moment of the force along the rod, by x^2"},
        {"q_xyy", "Q_{xyy}", "of maps: second moment of the force along the rod, by y^2"},
        {"q_yxy", "Q_{yxy}", "of maps: second moment of the force across the rod, by xy"},
        {"t_xxxx", "T_{xxxx}", "of maps: third moment of the force along the rod, by x^3"},
        {"t_xxyy", "T_{xxyy}", "of maps: third moment of the force along the rod, by x y^2"},
        {"h_xxxxx", "H_{xxxxx}", "of maps: fourth moment of the force along the rod, by x^4"},
        {"h_xxxyy", "H_{xxxyy}", "of maps: fourth moment of the force along the rod, by x^2 y^2"},
        {"c11", "C_{11}", "of maps: elastic constant along the heading"},
        {"c22", "C_{22}", "of maps: elastic constant across the heading"},
        {"c12", "C_{12}", "of maps: elastic constant that couples both"},
        {"c66", "C_{66}", "of maps: shear modulus"},
        {"zeta", "\\zeta", "of maps: drag per area"},
        {"rho", "\\rho", "of maps: mass per area"},
        {"eta_s", "\\eta_s", "of maps: viscosity"},
        {"offset", "U_x^{(0)}", "added to Ux"},
        {"offset_y", "U_y^{(0)}", "added to Uy"},
        {"kappa", "\\kappa", "coupling to strain, from trajectories, in mu v0/f in either system of units"},
        {"gamma1", "\\gamma_1", "first polar coupling, from trajectories, in v0"},
        {"gamma2", "\\gamma_2", "second polar coupling, from trajectories, in v0"},
        {"gamma_flow", "\\gamma_v", "coupling to the medium's velocity, from trajectories, in mu/f"},
        {"gamma_rows", "\\gamma_6", "turning into the rows of a crystal, from trajectories, in mu v0/f"},
        {"rows_direction", "\\theta_0", "direction of these rows, from trajectories, in rad"},
        {"stall_overlap", "s", "of [body], from trajectories of rods that touch"},
        {"mobility_ratio", "b", "of [body], from trajectories of rods that touch"},
        {"D_r", "D_r", "rotational diffusion of the rods, from trajectories, in rad^2 mu v0/f"},
        {"D_t", "D_t", "translational diffusion of the rods, from trajectories, in f v0/mu"},
    };
    return list;
}

std::span<const std::string_view> fit_parameter_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const FitParameter& parameter : fit_parameter_list())
            all.push_back(parameter.name);
        return all;
    }();
    return names;
}

bool is_map_parameter(std::string_view parameter) {
    static const std::vector<std::string_view> names = {
        "amplitude", "force", "p_xx", "p_yy", "q_xxx", "q_xyy", "q_yxy", "t_xxxx", "t_xxyy",   "h_xxxxx",
        "h_xxxyy",   "c11",   "c22",  "c12",  "c66",   "zeta",  "rho",   "eta_s",  "drag_area"};
    return std::ranges::find(names, parameter) != names.end();
}

double fit_default_start(const Fit& fit, const std::string& parameter) {
    if (parameter == "xi" && fit.profiles.empty()) // tracks alone: in f/mu, so 1/alpha
        return 1.0;
    static const std::map<std::string, double> starts = {
        {"f_over_mu", 1.0},     {"eta", 1.0},       {"xi", 10.0},
        {"alpha", 1.0},         {"drag_area", 1e3}, {"kappa", 1.0},
        {"gamma_rows", 0.1},    {"amplitude", 1.0}, {"force", 1.0},
        {"c11", 1.0},           {"c22", 1.0},       {"c66", 1.0},
        {"D_r", 0.01},          {"D_t", 1e-4},      {"stall_overlap", 0.05},
        {"mobility_ratio", 1.0}};
    const auto it = starts.find(parameter);
    return it == starts.end() ? 0.0 : it->second;
}

std::optional<Interval> fit_bounds(const Fit& fit, const std::string& parameter) {
    if (const auto it = fit.bounds.find(parameter); it != fit.bounds.end())
        return it->second;
    if (rods::is_noise(parameter))
        return Interval{0.0, 100.0};
    if (parameter == "stall_overlap" || parameter == "mobility_ratio")
        return parameter == "stall_overlap" ? Interval{1e-4, 0.5} : Interval{1e-3, 1e3};
    return parameter == "eta" || parameter == "xi" || parameter == "alpha"
               ? std::optional(Interval{1e-6, 1e6})
               : std::nullopt;
}

bool fit_in_log(const Fit& fit, const std::string& parameter) {
    const auto bounds = fit_bounds(fit, parameter);
    return contains(fit.log, parameter) && bounds && bounds->low > 0.0;
}

bool fit_is_free(const Fit& fit, const std::string& parameter) { return contains(fit.parameters, parameter); }

bool fit_has(const Fit& fit, const std::string& parameter) {
    return fit_is_free(fit, parameter) || fit.fixed.contains(parameter) || fit.tied.contains(parameter) ||
           (fit.measured_drag && parameter == "drag_area");
}

bool fit_is_isotropic(const Fit& fit) {
    return !fit.maps.empty() && !fit_has(fit, "c66") && fit_has(fit, "eta");
}

bool fit_knows_xi(const Fit& fit) {
    return fit_has(fit, "xi") || fit_has(fit, "alpha") || fit_has(fit, "drag_area");
}

std::vector<std::string> fit_used(const Fit& fit) {
    std::vector<std::string> used;
    for (const std::string_view name : fit_parameter_names())
        if (fit_has(fit, std::string(name)))
            used.emplace_back(name);
    return used;
}

} // namespace rodwake::scene

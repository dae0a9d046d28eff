#pragma once
// Maps of a known medium, with and without noise.

#include "rodwake/fitting/map.hpp"
#include "toy_problems.hpp"

namespace made_up_map {

using namespace rodwake::fitting;

inline const MapModel model{.rod_length = 11.25, .source_width = 3.0};

/// A strained crystal with everything that moves in it; amplitude of 0.8 of the prediction.
inline const std::vector<Parameter> truth = {
    {.name = "amplitude", .start = 0.8}, {.name = "force", .start = 2.0},  {.name = "p_xx", .start = -3.0},
    {.name = "p_yy", .start = 9.0},      {.name = "c11", .start = 3.1},    {.name = "c22", .start = 4.4},
    {.name = "c12", .start = 1.3},       {.name = "c66", .start = 1.0},    {.name = "zeta", .start = 0.05},
    {.name = "rho", .start = 0.03},      {.name = "eta_s", .start = 0.15}, {.name = "offset", .start = 0.02},
    {.name = "offset_y", .start = -0.01}};

using toy::starts;

inline std::vector<double> true_values() { return starts(truth); }

/// The parameters with those named free and the others fixed at the truth.
inline std::vector<Parameter> free_ones(const std::vector<std::string>& names) {
    std::vector<Parameter> out = truth;
    for (Parameter& p : out)
        p.fixed = std::ranges::find(names, p.name) == names.end();
    return out;
}

inline std::size_t index_of(const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(truth, name, &Parameter::name) - truth.begin());
}

/// The map with displacements as these parameters make them.
inline Map made_by(Map map, const std::vector<Parameter>& parameters) {
    auto u = predict(model, map, parameters, starts(parameters));
    map.Ux = std::move(u.Ux);
    map.Uy = std::move(u.Uy);
    return map;
}

/// n x n bins of the box 72 x 66, all known; sigma the same for all.
inline Map map_of(std::size_t n, double sigma) {
    Map map{.name = "made up", .lx = 72.0, .ly = 66.0, .speed = 1.7};
    for (std::size_t k = 0; k < n; ++k) {
        const double at = static_cast<double>(k) / static_cast<double>(n) - 0.5;
        map.x.push_back(map.lx * at);
        map.y.push_back(map.ly * at);
    }
    map = made_by(std::move(map), truth);
    map.known.assign(map.bins(), true);
    map.sigma_x.assign(map.bins(), sigma);
    map.sigma_y = map.sigma_x;
    return map;
}

inline Map with_noise(Map map, rodwake::RandomStream& random) {
    for (std::size_t i = 0; i < map.bins(); ++i) {
        map.Ux[i] += map.sigma_x[i] * toy::normal(random);
        map.Uy[i] += map.sigma_y[i] * toy::normal(random);
    }
    return map;
}

} // namespace made_up_map

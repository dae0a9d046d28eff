#pragma once
// Two rods that swim past each other, without noise: a trajectory whose sum of squares has plateaus far from
// the truth.

#include "rodwake/fitting/trajectory.hpp"

#include <map>

namespace rodwake::test {

/// What the pair is made with.
inline const std::map<std::string, double> pair_truth{
    {"kappa", 0.5}, {"gamma1", 0.3}, {"gamma2", -0.2}, {"eta", 1.0}, {"alpha", 1.0}};

/// `name` free from `start`, the others held at the truth. xi may stand for alpha.
inline std::vector<fitting::Parameter> pair_parameters(const std::string& name = {}, double start = 0.0) {
    std::vector<fitting::Parameter> all;
    for (const auto& [of, value] : pair_truth) {
        fitting::Parameter p;
        p.name = of == "alpha" && name == "xi" ? name : of;
        p.fixed = p.name != name;
        p.start = p.fixed ? value : start;
        if (!p.fixed && (name == "eta" || name == "xi" || name == "alpha")) {
            p.lower = 1e-6;
            p.upper = 1e6;
            p.transform = fitting::Transform::log;
        }
        all.push_back(p);
    }
    return all;
}

/// At (0, 2.5) heading 0 and (1, -2.5) heading 0.3, at t = 0, 0.5, ..., 12; sigma 1.
inline fitting::Trajectory swimming_pair() {
    fitting::Trajectory data;
    data.name = "pair";
    for (int i = 0; i <= 24; ++i)
        data.times.push_back(0.5 * i);
    data.states.assign(data.times.size(), {0.0, 2.5, 0.0, 1.0, -2.5, 0.3});
    const std::vector<fitting::Parameter> truth = pair_parameters();
    std::vector<double> values;
    for (const fitting::Parameter& p : truth)
        values.push_back(p.start);
    data.states = fitting::predict({}, data, 0, truth, values);
    return data;
}

inline fitting::Problem pair_problem(const std::string& name, double start, double sigma = 1.0) {
    fitting::Trajectory data = swimming_pair();
    data.sigma_position = data.sigma_heading = sigma;
    return fitting::trajectory_problem({}, {data}, pair_parameters(name, start));
}

} // namespace rodwake::test

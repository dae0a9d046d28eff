// Errors of map fits against the truth of many noisy maps: of the curvature, and of the jackknife where the
// noise of neighbouring bins goes together.

#include "made_up_map.hpp"
#include "rodwake/fitting/refits.hpp"

#include <catch2/catch.hpp>

using namespace made_up_map;

namespace {

constexpr int sets = 120;
const MapMask mask{.strip = 8.0, .radius = 10.0};

/// Three standard deviations of a binomial count of 68.3 %.
double slack(int count) { return 3.0 * std::sqrt(0.683 * 0.317 / count); }

/// Waves of a box's longest lengths, with random strengths: noise that goes together over many bins.
Map with_waves(Map map, rodwake::RandomStream& random) {
    for (int m = 0; m < 3; ++m)
        for (int n = 0; n < 3; ++n) {
            const double size = 0.01 * toy::normal(random), phase = 6.283185307 * random.uniform();
            for (std::size_t i = 0; i < map.bins(); ++i)
                map.Ux[i] += size * std::cos(6.283185307 *
                                                 (m * map.place_x(i) / map.lx + n * map.place_y(i) / map.ly) +
                                             phase);
        }
    return map;
}

} // namespace

TEST_CASE("68 % of 120 noisy maps have the truth within one error, of every parameter") {
    const std::vector<std::string> free = {"amplitude", "p_xx", "p_yy", "c11", "c22", "zeta", "offset"};
    const auto parameters = free_ones(free);
    // a rod that shows clearly, so that the constants are in the linear range of their errors
    const Map clean = map_of(12, 0.002);
    std::map<std::string, int> within, within_two;
    double chi2 = 0.0;
    long dof = 0;
    for (int set = 0; set < sets; ++set) {
        rodwake::RandomStream random(static_cast<std::uint64_t>(set), 5);
        const Problem problem = map_problem(model, {with_noise(clean, random)}, mask, parameters);
        const Report r = report(problem, fit(problem, {}));
        chi2 += r.chi2;
        dof += r.dof;
        for (const std::string& name : free) {
            const ParameterEstimate& e = r.estimates[index_of(name)];
            const double off = std::abs(e.value - truth[index_of(name)].start) / e.standard_error;
            within[name] += off < 1.0;
            within_two[name] += off < 2.0;
        }
    }
    for (const std::string& name : free) {
        CAPTURE(name, within[name], within_two[name]);
        CHECK(std::abs(within[name] / double(sets) - 0.683) < slack(sets));
        CHECK(std::abs(within_two[name] / double(sets) - 0.954) < 3.0 * std::sqrt(0.954 * 0.046 / sets));
    }
    // mean 1, standard deviation sqrt(2/dof)
    CHECK(std::abs(chi2 / double(dof) - 1.0) < 4.0 * std::sqrt(2.0 / double(dof)));
}

TEST_CASE("the jackknife holds where bins share noise, the curvature does not") {
    constexpr int experiments = 40, runs = 6;
    const auto parameters = free_ones({"amplitude", "p_yy"});
    const Map clean = map_of(10, 0.02);
    double squares = 0.0, jackknife = 0.0, curvature = 0.0;
    for (int experiment = 0; experiment < experiments; ++experiment) {
        rodwake::RandomStream random(static_cast<std::uint64_t>(experiment), 6);
        std::vector<Map> maps;
        for (int run = 0; run < runs; ++run)
            maps.push_back(with_waves(with_noise(clean, random), random));
        const Problem problem = map_problem(model, maps, mask, parameters);
        const Fit best = fit(problem, {});
        std::vector<std::vector<double>> without;
        for (int run = 0; run < runs; ++run) {
            auto others = maps;
            others.erase(others.begin() + run);
            without.push_back(refit(map_problem(model, others, mask, parameters), {}, best.values).values);
        }
        squares += std::pow(best.values[0] - 0.8, 2) / experiments;
        jackknife += std::pow(jackknife_error({without})[0], 2) / experiments;
        curvature += std::pow(report(problem, best).estimates[0].standard_error, 2) / experiments;
    }
    // The variance of 40 values is known to sqrt(2/40), that of the mean of 40 jackknives of 6 to
    // sqrt(2/(5 40)): together 25 %, three times that is 0.74.
    CAPTURE(squares, jackknife, curvature);
    CHECK(jackknife / squares == Approx(1.0).margin(0.74));
    CHECK(squares > 3.0 * curvature);
}

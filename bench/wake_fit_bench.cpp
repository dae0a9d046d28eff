// One fit of a displacement profile (f_over_mu, eta, xi), many times: bench/wake_fit.py calls it beside SciPy
// on the same file.
//
//   bench_wake_fit PROFILE.csv METHOD REPETITIONS [BOX]      prints JSON: milliseconds (median), evaluations,
//   parameters

#include "rodwake/fitting/report.hpp"
#include "rodwake/fitting/wake.hpp"
#include "rodwake/store/csv.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace rodwake;
using namespace rodwake::fitting;

Profile read_profile(const char* file) {
    const std::vector<std::string> names = {"x", "value", "sigma"};
    const store::Table table = store::read_csv(file, names);
    Profile profile;
    profile.name = file;
    profile.place = *table.find("x"), profile.value = *table.find("value"),
    profile.sigma = *table.find("sigma");
    return profile;
}

Algorithm algorithm_named(const std::string& name) {
    for (const Algorithm one : {Algorithm::slsqp, Algorithm::lbfgs, Algorithm::mma, Algorithm::bobyqa})
        if (to_string(one) == name)
            return one;
    std::fprintf(stderr, "unknown method %s\n", name.c_str());
    std::exit(2);
}

} // namespace

int main(int count, char** words) {
    if (count < 4) {
        std::fprintf(stderr, "usage: bench_wake_fit PROFILE.csv METHOD REPETITIONS [BOX]\n");
        return 2;
    }
    WakeModel model;
    if (count > 4)
        model.box = std::atof(words[4]);
    const std::vector<Parameter> parameters = {
        {.name = "f_over_mu", .start = 1.0},
        {.name = "eta", .start = 1.0, .lower = 1e-6, .upper = 1e6, .transform = Transform::log},
        {.name = "xi", .start = 10.0, .lower = 1e-6, .upper = 1e6, .transform = Transform::log}};
    const Profile profile = read_profile(words[1]);
    Method method;
    method.algorithm = algorithm_named(words[2]);
    std::vector<double> milliseconds;
    Fit found;
    for (int i = 0; i < std::atoi(words[3]); ++i) {
        const auto start = std::chrono::steady_clock::now();
        const Problem problem = wake_problem(model, {profile}, parameters);
        found = fit(problem, method);
        report(problem, found);
        milliseconds.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::ranges::sort(milliseconds);
    const nlohmann::json out = {{"milliseconds", milliseconds[milliseconds.size() / 2]},
                                {"evaluations", found.evaluations},
                                {"chi2", found.chi2},
                                {"values", found.values}};
    std::puts(out.dump().c_str());
    return 0;
}

// What the page's JavaScript calls (explorer/kernel.mjs): flat numbers in, flat numbers out. Compiled by
// tools/explorer alone, to WebAssembly.

#include "encounter.hpp"
#include "rodwake/core/error.hpp"

#include <emscripten.h>

#include <string>

using namespace rodwake;

namespace {

struct Answer {
    std::string error, reason;
    app::EncounterPath encounter;
};

constexpr std::size_t problem_numbers = 7; ///< eta, alpha, kappa, gamma1, gamma2, t_end, contact distance

/// Then x, y, theta of each rod.
rods::RodProblem problem_of(const double* numbers, std::size_t rods) {
    rods::RodProblem problem;
    problem.medium = elastic::Medium{numbers[0], elastic::xi_from_alpha(numbers[1])};
    problem.couplings = {numbers[2], numbers[3], numbers[4]};
    problem.t_end = numbers[5];
    if (numbers[6] != 0.0)
        problem.contact_distance = numbers[6];
    for (const double* rod = numbers + problem_numbers; rods > 0; --rods, rod += 3)
        problem.rods.push_back({rod[0], rod[1], rod[2]});
    return problem;
}

/// What the work throws is kept as its text.
template<class Work>
void guarded(Answer& answer, const Work& work) {
    try {
        work();
    } catch (const std::exception& error) {
        answer.error = describe(error);
    }
}

} // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE Answer* rw_answer() { return new Answer; }
EMSCRIPTEN_KEEPALIVE void rw_free(Answer* answer) { delete answer; }
EMSCRIPTEN_KEEPALIVE const char* rw_error(const Answer* answer) { return answer->error.c_str(); }
EMSCRIPTEN_KEEPALIVE const char* rw_reason(const Answer* answer) {
    return answer->encounter.outcome.reason.c_str();
}

/// The numbers of a run: ending, time, smallest separation, when, and the number of rows.
EMSCRIPTEN_KEEPALIVE void rw_encounter(Answer* answer, const double* numbers, std::size_t rods, double rtol,
                                       double* out) {
    guarded(*answer, [&] {
        answer->encounter = app::encounter(problem_of(numbers, rods), rtol);
        const rods::RodOutcome& outcome = answer->encounter.outcome;
        out[0] = static_cast<double>(outcome.ending);
        out[1] = outcome.time;
        out[2] = outcome.min_separation;
        out[3] = outcome.min_separation_time;
        out[4] = static_cast<double>(answer->encounter.rows.size());
    });
}
EMSCRIPTEN_KEEPALIVE const double* rw_rows(const Answer* answer) { return answer->encounter.rows.data(); }

/// Pairs, 13 numbers each; of each ending, time, smallest separation and both turns.
EMSCRIPTEN_KEEPALIVE void rw_encounters(Answer* answer, const double* numbers, std::size_t pairs, double rtol,
                                        double* out) {
    guarded(*answer, [&] {
        std::vector<rods::RodProblem> problems;
        for (std::size_t i = 0; i < pairs; ++i)
            problems.push_back(problem_of(numbers + i * (problem_numbers + 6), 2));
        std::vector<app::EncounterSummary> ends(pairs);
        app::encounters(problems, rtol, ends);
        for (const app::EncounterSummary& end : ends) {
            const double row[] = {static_cast<double>(end.ending), end.time, end.min_separation, end.turn[0],
                                  end.turn[1]};
            out = std::copy(std::begin(row), std::end(row), out);
        }
    });
}

/// Strain of a rod at the origin heading along +x.
EMSCRIPTEN_KEEPALIVE void rw_strain(Answer* answer, double eta, double alpha, double x, double y,
                                    double* out) {
    guarded(*answer, [&] {
        const auto strain = elastic::Field({eta, elastic::xi_from_alpha(alpha)}).strain(x, y);
        out[0] = strain.xx;
        out[1] = strain.xy;
        out[2] = strain.yy;
    });
}

/// Columns of `points` numbers, one after the other: exx, exy, eyy, lap u, grad div u and, if asked for, u.
EMSCRIPTEN_KEEPALIVE void rw_wakes(Answer* answer, double eta, double alpha, const double* rods,
                                   std::size_t rod_count, const double* x, const double* y,
                                   std::size_t points, int displacement, double* out) {
    guarded(*answer, [&] {
        std::vector<elastic::Source> sources;
        for (std::size_t i = 0; i < rod_count; ++i)
            sources.push_back({rods[3 * i], rods[3 * i + 1], rods[3 * i + 2]});
        const auto column = [&](std::size_t k) { return std::span(out + k * points, points); };
        app::WakeColumns columns{
            {column(0), column(1), column(2)}, {column(3), column(4), column(5), column(6)}, {}, {}};
        if (displacement != 0) {
            columns.displacement_x = column(7);
            columns.displacement_y = column(8);
        }
        app::wakes({eta, elastic::xi_from_alpha(alpha)}, sources, {{x, points}, {y, points}}, columns);
    });
}

} // extern "C"

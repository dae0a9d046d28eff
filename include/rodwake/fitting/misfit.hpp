#pragma once
// Whether a model describes the data it was fitted to, and how well it foretells data it was not fitted to.
//
// With the right model and sigmas the residuals are standard normal numbers less what k fitted parameters
// take of them, r = (1 - Q Q^T) z, Q an orthonormal basis of the Jacobian's columns. Four numbers are looked
// at:
//
//   chi2      sum r^2 against n - k; not where sigmas are unknown
//   runs      stretches of one sign in each Series, too few of which are a trend that the model lacks
//   largest   max |r_i|/sqrt(1 - |Q_i|^2) among n
//   regions   sum r^2 over a third of a Series' range, or over a whole set of data where there are many
//
// Each has a probability of its own. `probability` is that of so small a smallest one, from 200 to 1000 draws
// of z: it is uniform whatever n, k and the design, to first order in the parameters. Errors:
// studies/reports/fitting.md.

#include "rodwake/fitting/fit.hpp"
#include "rodwake/fitting/report.hpp"

#include <optional>

namespace rodwake::fitting {

struct MisfitTest {
    std::string name; ///< "chi2", "runs", "largest", "regions"
    double value = 0.0, expected = 0.0;
    double probability = 1.0; ///< by itself; that of `regions` is of the worst among all
    std::string text;         ///< what is seen, as a part of a sentence
};

struct MisfitRegion {
    std::string name; ///< "pair, headings, last third"
    double chi2 = 0.0, expected = 0.0, probability = 1.0;
};

struct Misfit {
    std::vector<MisfitTest>
        tests; ///< of neighbours that share noise (Problem::independent < 1) chi2 and regions
    std::vector<MisfitRegion> regions; ///< of two or more
    std::optional<double> probability; ///< absent if no degree of freedom is left
    std::string worst;                 ///< text of the test that speaks loudest

    bool describes() const { return !probability || *probability >= least_probability; }
    static constexpr double least_probability = 0.05;
};

/// Deterministic: the draws depend on `seed` alone. The fit must have finite residuals.
Misfit misfit(const Problem& problem, const Fit& fit, std::uint64_t seed);

/// Log-likelihood of stretches of the data, each foretold by a fit of the others, up to what is the same for
/// all models of the data. A stretch is the same share of every Series, so that starts of tracks stay known.
struct CrossValidation {
    std::vector<double> blocks; ///< of each stretch

    double sum() const;
    double error() const; ///< of the sum, from the scatter of the stretches; of one it is infinite
};

/// The search begins at the fit's end. Nothing where a Series is shorter than two stretches, or where the
/// others have fewer data than there are parameters. Throws RunError where no fit of the others ends.
std::optional<CrossValidation> cross_validate(const Problem& problem, const Method& method, const Fit& fit,
                                              std::size_t blocks = 8);

} // namespace rodwake::fitting

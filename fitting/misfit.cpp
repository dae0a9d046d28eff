#include "rodwake/fitting/misfit.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/integrate/additive_noise.hpp"
#include "search.hpp"

#include <boost/math/special_functions/gamma.hpp>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace rodwake::fitting {

namespace {

using Index = Eigen::Index;

/// Probability of a chi2 at least as large.
double chi2_tail(double chi2, double dof) {
    return dof > 0.0 ? boost::math::gamma_q(0.5 * dof, 0.5 * std::max(chi2, 0.0)) : 1.0;
}

double normal_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

/// Probability that the smallest of `count` probabilities is as small.
double among(double probability, double count) {
    return probability >= 1.0 ? 1.0 : -std::expm1(count * std::log1p(-probability));
}

/// Residuals of one scale, which is known or follows from their scatter.
struct ResidualGroup {
    std::string name;
    std::vector<std::size_t> residuals;
    double dof = 0.0;
};

/// Results of the tests on residuals.
struct Findings {
    std::optional<double> chi2, runs, largest, region; ///< probabilities
    double runs_value = 0.0, runs_expected = 0.0, largest_value = 0.0;
    std::size_t largest_at = 0, region_at = 0;

    double least() const {
        double p = 1.0;
        for (const auto& probability : {chi2, runs, largest, region})
            p = std::min(p, probability.value_or(1.0));
        return p;
    }
};

struct ResidualSet {
    ResidualSet(const Problem& problem, const Fit& fit);

    /// The tests of `residuals`.
    Findings look(const Eigen::VectorXd& residuals) const;
    /// Residuals that the right model would leave, drawn at random.
    Eigen::VectorXd drawn(std::uint64_t seed, std::uint32_t draw) const;
    /// Factor of r^2: 1 with known sigmas.
    double scale(const Eigen::VectorXd& residuals) const {
        const double chi2 = residuals.squaredNorm();
        return problem.sigma_known || !(chi2 > 0.0) ? 1.0 : independent_dof / chi2;
    }

    const Problem& problem;
    std::vector<Series> series;
    Eigen::VectorXd r;      ///< of the fit
    Eigen::MatrixXd basis;  ///< Q
    Eigen::VectorXd remain; ///< 1 - |Q_i|^2
    double independent_dof = 0.0;
    std::vector<ResidualGroup> groups;
};

ResidualSet::ResidualSet(const Problem& fitted, const Fit& fit) : problem(fitted), series(series_of(fitted)) {
    const auto rows = static_cast<Index>(problem.residuals);
    r = Eigen::VectorXd::Zero(rows);
    Eigen::MatrixXd by_value = Eigen::MatrixXd::Zero(rows, static_cast<Index>(problem.parameters.size()));
    problem.evaluate(fit.values, r, &by_value);

    // A basis of the directions that the parameters take up. Columns get one length, so that the rank does
    // not depend on units.
    constexpr double rank_tolerance = 1e-10; // as ReportOptions
    Eigen::MatrixXd columns = SearchSpace(problem).chain(by_value, fit.values);
    for (Index k = 0; k < columns.cols(); ++k)
        if (const double length = columns.col(k).norm(); length > 0.0)
            columns.col(k) /= length;
    basis = Eigen::MatrixXd(columns.rows(), 0);
    remain = Eigen::VectorXd::Ones(columns.rows());
    if (columns.cols() > 0) {
        Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
        qr.setThreshold(rank_tolerance);
        basis = qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
        remain -= basis.rowwise().squaredNorm();
    }
    independent_dof = problem.independent * static_cast<double>(r.size()) - static_cast<double>(basis.cols());

    // The groups are thirds of each quantity of a set of data, and whole ones if there are many sets.
    constexpr std::size_t few = 3;
    static constexpr const char* thirds[] = {", first third", ", middle third", ", last third"};
    std::map<std::string, std::size_t> sets, place;
    for (const Series& s : series)
        sets.emplace(s.data, 0);
    for (const Series& s : series)
        for (std::size_t i = 0; i < s.residuals.size(); ++i) {
            std::string name = s.quantity == "values" ? s.data : s.data + ", " + s.quantity;
            if (sets.size() <= few && s.residuals.size() > 2)
                name += thirds[3 * i / s.residuals.size()];
            const auto [at, fresh] = place.emplace(name, groups.size());
            if (fresh)
                groups.push_back({name, {}, 0.0});
            ResidualGroup& group = groups[at->second];
            group.residuals.push_back(s.residuals[i]);
            group.dof += problem.independent - (1.0 - remain[static_cast<Index>(s.residuals[i])]);
        }
    std::erase_if(groups, [](const ResidualGroup& group) { return group.dof < 1.0; });
}

Findings ResidualSet::look(const Eigen::VectorXd& residuals) const {
    constexpr double least_remainder = 1e-3; // of a residual that the parameters take nearly all of
    Findings found;
    const double factor = scale(residuals);
    if (problem.sigma_known)
        found.chi2 = chi2_tail(residuals.squaredNorm(), independent_dof);
    double least = 1.0;
    for (std::size_t g = 0; g < groups.size() && groups.size() > 1; ++g) {
        double chi2 = 0.0;
        for (const std::size_t i : groups[g].residuals)
            chi2 += residuals[static_cast<Index>(i)] * residuals[static_cast<Index>(i)];
        if (const double p = chi2_tail(factor * chi2, groups[g].dof); p < least) {
            least = p;
            found.region_at = g;
        }
    }
    if (groups.size() > 1)
        found.region = among(least, static_cast<double>(groups.size()));
    if (problem.independent < 1.0)
        return found;

    // Wald and Wolfowitz's runs of all series together, given how many of each sign there are.
    double runs = 0.0, expected = 0.0, variance = 0.0;
    for (const Series& s : series) {
        double plus = 0.0, own = 0.0;
        for (std::size_t i = 0; i < s.residuals.size(); ++i) {
            const bool up = residuals[static_cast<Index>(s.residuals[i])] > 0.0;
            plus += up ? 1.0 : 0.0;
            own += i == 0 || up != (residuals[static_cast<Index>(s.residuals[i - 1])] > 0.0) ? 1.0 : 0.0;
        }
        const auto n = static_cast<double>(s.residuals.size());
        if (n < 2.0)
            continue;
        const double both = 2.0 * plus * (n - plus);
        runs += own;
        expected += 1.0 + both / n;
        variance += both * (both - n) / (n * n * (n - 1.0));
    }
    const auto dof = static_cast<double>(r.size() - basis.cols());
    if (variance > 0.0 && residuals.squaredNorm() > (problem.sigma_known ? 1e-2 : 1e-14) * dof) {
        found.runs_value = runs;
        found.runs_expected = expected;
        found.runs = normal_tail((expected - runs) / std::sqrt(variance));
    }

    double most = 0.0;
    for (Index i = 0; i < residuals.size(); ++i)
        if (const double size = factor * residuals[i] * residuals[i] / remain[i];
            remain[i] > least_remainder && size > most) {
            most = size;
            found.largest_at = static_cast<std::size_t>(i);
        }
    found.largest_value = std::sqrt(most);
    found.largest = among(2.0 * normal_tail(found.largest_value), static_cast<double>(residuals.size()));
    return found;
}

Eigen::VectorXd ResidualSet::drawn(std::uint64_t seed, std::uint32_t draw) const {
    constexpr std::uint32_t use = 0x4d495346; // of no RandomStream: their second counter is 0
    Eigen::VectorXd z(r.size());
    for (Index i = 0; i < z.size(); i += 2) {
        const integrate::Normals pair = integrate::normals_of(
            philox_block({static_cast<std::uint32_t>(i), use, draw, 0},
                         {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}));
        z[i] = pair[0];
        if (i + 1 < z.size())
            z[i + 1] = pair[1];
    }
    if (basis.cols() > 0)
        z -= basis * (basis.transpose() * z);
    return z;
}

void add_tests(const Problem& problem, const ResidualSet& data, const Findings& found, Misfit& out) {
    const double factor = data.scale(data.r);
    if (found.chi2)
        out.tests.push_back({"chi2", data.r.squaredNorm(), data.independent_dof, *found.chi2,
                             fmt::format("chi2 is {:.4g} for {:.4g} degrees of freedom", data.r.squaredNorm(),
                                         data.independent_dof)});
    if (found.runs)
        out.tests.push_back({"runs", found.runs_value, found.runs_expected, *found.runs,
                             fmt::format("the residuals {}, {:.0f} runs where {:.0f} are expected",
                                         *found.runs < 0.05   ? "keep their sign too long"
                                         : *found.runs > 0.95 ? "change their sign too often"
                                                              : "change their sign as noise does",
                                         found.runs_value, found.runs_expected)});
    if (found.largest) {
        const std::size_t at = found.largest_at;
        out.tests.push_back(
            {"largest", found.largest_value, 0.0, *found.largest,
             fmt::format("{} is {:.3g} standard errors off",
                         problem.residual_name ? problem.residual_name(at) : fmt::format("residual {}", at),
                         found.largest_value)});
    }
    for (const ResidualGroup& group : data.groups) {
        double chi2 = 0.0;
        for (const std::size_t i : group.residuals)
            chi2 += factor * data.r[static_cast<Index>(i)] * data.r[static_cast<Index>(i)];
        out.regions.push_back({group.name, chi2, group.dof, chi2_tail(chi2, group.dof)});
    }
    if (!found.region)
        return;
    const MisfitRegion& worst = out.regions[found.region_at];
    out.tests.push_back(
        {"regions", worst.chi2, worst.expected, *found.region,
         fmt::format("{} has chi2 {:.3g} where {:.3g} is expected", worst.name, worst.chi2, worst.expected)});
}

} // namespace

Misfit misfit(const Problem& problem, const Fit& fit, std::uint64_t seed) {
    if (problem.log_scales > 0) { // the test is of the data without the logarithms of scales behind them
        Problem alone = problem;
        alone.residuals = data_count(problem);
        alone.log_scales = 0;
        alone.evaluate = [problem](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, // NOLINT
                                   Eigen::MatrixXd* jacobian) {
            Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Index>(problem.residuals));
            Eigen::MatrixXd slopes =
                Eigen::MatrixXd::Zero(jacobian ? all.size() : 0, static_cast<Index>(p.size()));
            problem.evaluate(p, all, jacobian ? &slopes : nullptr);
            r = all.head(r.size());
            if (jacobian)
                *jacobian = slopes.topRows(r.size());
        };
        return misfit(alone, fit, seed);
    }
    Misfit out;
    const ResidualSet data(problem, fit);
    if (!(data.independent_dof >= 1.0) || !data.r.allFinite())
        return out;
    const Findings found = data.look(data.r);
    add_tests(problem, data, found, out);
    if (out.tests.empty())
        return out;
    out.worst = std::ranges::min_element(out.tests, {}, &MisfitTest::probability)->text;

    // The probability of a smallest probability like this comes from draws; beyond them it is bounded by the
    // sum over the tests, and so it is for noise that neighbours share, which draws lack.
    constexpr double work = 4e6;
    const auto draws =
        static_cast<std::uint32_t>(std::clamp(work / static_cast<double>(data.r.size()), 200.0, 1000.0));
    double tests = 0.0;
    for (const auto& probability : {found.chi2, found.runs, found.largest, found.region})
        tests += probability ? 1.0 : 0.0;
    const double bound = std::min(1.0, tests * found.least());
    out.probability = bound;
    if (problem.independent < 1.0)
        return out;
    std::uint32_t as_small = 0;
    for (std::uint32_t draw = 0; draw < draws; ++draw)
        as_small += data.look(data.drawn(seed, draw)).least() <= found.least() ? 1 : 0;
    const double share = (1.0 + as_small) / (1.0 + draws);
    out.probability = as_small == 0 ? std::min(share, bound) : share;
    return out;
}

namespace {

/// Log-likelihood of the residuals that are left out, as predicted by a fit of the others, which begins at
/// the end of the fit of all. Nothing if that has no degree of freedom.
std::optional<double> predicted(const Problem& problem, const Method& method, const Fit& fit,
                                const std::vector<bool>& left_out) {
    Problem rest = problem;
    rest.residuals = static_cast<std::size_t>(std::ranges::count(left_out, false));
    rest.series.clear();
    rest.residual_name = nullptr;
    rest.evaluate = [&problem, &left_out](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, // NOLINT
                                          Eigen::MatrixXd* jacobian) {
        const auto rows = static_cast<Index>(problem.residuals);
        Eigen::VectorXd all = Eigen::VectorXd::Zero(rows);
        Eigen::MatrixXd slopes;
        if (jacobian)
            slopes.setZero(rows, jacobian->cols());
        problem.evaluate(p, all, jacobian ? &slopes : nullptr);
        Index to = 0;
        for (Index from = 0; from < rows; ++from) {
            if (left_out[static_cast<std::size_t>(from)])
                continue;
            r[to] = all[from];
            if (jacobian)
                jacobian->row(to) = slopes.row(from);
            ++to;
        }
    };
    const long dof = degrees_of_freedom(rest);
    if (dof < 1)
        return std::nullopt;
    const SearchSpace space(rest);
    Evaluator evaluator(rest, space, {method.loss, method.loss_width}, method.stop_requested);
    std::vector<double> start;
    for (const std::size_t i : space.free)
        start.push_back(fit.values[i]);
    const SearchResult end = levenberg_marquardt(evaluator, space.coordinates(start));
    evaluator.require_memory();
    if (!std::isfinite(end.objective))
        throw RunError("no finite residuals: " + end.reason);

    // The variance of a residual comes from the others if sigmas are unknown.
    const double variance = rest.sigma_known ? 1.0 : end.objective / static_cast<double>(dof);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Index>(problem.residuals));
    problem.evaluate(space.values(end.u), r, nullptr);
    double chi2 = 0.0;
    for (Index i = 0; i < r.size(); ++i)
        chi2 += left_out[static_cast<std::size_t>(i)] ? r[i] * r[i] : 0.0;
    const double count = problem.independent * static_cast<double>(std::ranges::count(left_out, true));
    return -0.5 * (chi2 / variance + count * std::log(variance));
}

} // namespace

double CrossValidation::sum() const {
    double sum = 0.0;
    for (const double block : blocks)
        sum += block;
    return sum;
}

double CrossValidation::error() const {
    const auto n = static_cast<double>(blocks.size());
    double squares = 0.0;
    for (const double block : blocks)
        squares += (block - sum() / n) * (block - sum() / n);
    return n > 1.0 ? std::sqrt(n * squares / (n - 1.0)) : HUGE_VAL;
}

std::optional<CrossValidation> cross_validate(const Problem& problem, const Method& method, const Fit& fit,
                                              std::size_t blocks) {
    if (problem.log_scales > 0) // the Kalman filter predicts from the residuals that are left out
        return std::nullopt;
    for (const Series& series : series_of(problem))
        if (series.residuals.size() > 1) // a time of contact stays with its stretch
            blocks = std::min(blocks, series.residuals.size());
    CrossValidation out;
    for (std::size_t block = 0; block < blocks; ++block) {
        std::vector<bool> left_out(problem.residuals, false);
        for (const Series& series : series_of(problem))
            for (std::size_t i = 0; i < series.residuals.size(); ++i)
                left_out[series.residuals[i]] = blocks * i / series.residuals.size() == block;
        const auto log_likelihood = blocks < 2 ? std::nullopt : predicted(problem, method, fit, left_out);
        if (!log_likelihood)
            return std::nullopt;
        out.blocks.push_back(*log_likelihood);
    }
    return out;
}

} // namespace rodwake::fitting

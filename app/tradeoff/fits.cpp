// Ways to fit: the search, whether it is polished, how many starts, where intervals come from.

#include "fit/fit_stage.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rodwake::app {

namespace {

using fitting::Algorithm;

constexpr Algorithm local[] = {Algorithm::slsqp, Algorithm::lbfgs, Algorithm::mma, Algorithm::bobyqa,
                               Algorithm::nelder_mead};
constexpr Algorithm global[] = {Algorithm::mlsl, Algorithm::crs, Algorithm::isres, Algorithm::direct_l};
constexpr std::size_t many_starts = 10, reference_starts = 50;
constexpr double long_fit = 0.5; ///< s; such a fit is not repeated
constexpr int repeats = 3;

struct FitWay {
    Algorithm algorithm = Algorithm::slsqp;
    bool polish = true;
    std::size_t starts = 1;
    bool likelihood = false;
};

using Bounds = std::pair<double, double>; ///< 95 % interval of a parameter; not finite: none

/// What a fit gave: of the free parameters, in their order.
struct FitAnswer {
    std::vector<double> values, errors;
    std::vector<Bounds> intervals;
    double objective = HUGE_VAL;
    double seconds = 0.0;
    std::string failure;
};

std::vector<FitWay> all_ways(const fitting::Problem& problem) {
    std::vector<FitWay> ways;
    for (const Algorithm algorithm : local)
        for (const bool polish : {true, false})
            for (const std::size_t starts : {std::size_t{1}, many_starts})
                ways.push_back({algorithm, polish, starts, false});
    const bool bounded = std::ranges::all_of(problem.parameters, [](const fitting::Parameter& p) {
        return !p.free() || (std::isfinite(p.lower) && std::isfinite(p.upper));
    });
    for (const Algorithm algorithm : global)
        for (const bool polish : {true, false})
            if (bounded)
                ways.push_back({algorithm, polish, 1, false});
    for (const std::size_t starts : {std::size_t{1}, many_starts})
        ways.push_back({Algorithm::slsqp, true, starts, true});
    return ways;
}

std::vector<std::string> keys_of(const FitWay& way, const fitting::Problem& problem) {
    std::vector<std::string> names;
    for (const std::size_t i : fitting::free_parameters(problem))
        names.push_back(fmt::format("\"{}\"", problem.parameters[i].name));
    return {
        fmt::format("fit.method=\"{}\"", to_string(way.algorithm)), fmt::format("fit.polish={}", way.polish),
        fmt::format("fit.starts={}", way.starts),
        fmt::format("fit.likelihood=[{}]", way.likelihood ? fmt::format("{}", fmt::join(names, ", ")) : "")};
}

Bounds likelihood_interval(const fitting::Problem& problem, const fitting::Method& method,
                           const fitting::Fit& fit, std::size_t parameter) {
    const fitting::ProfileLikelihood profile = fitting::profile_likelihood(problem, method, fit, parameter);
    return {profile.low.value_or(-HUGE_VAL), profile.high.value_or(HUGE_VAL)};
}

class FitTarget : public Target {
public:
    FitTarget(const scene::Scene& scene, FitPlan plan, const RunContext& context)
        : plan_(std::move(plan)), ways_(all_ways(plan_.problem)), limit_(context.tradeoff.limit),
          context_(context) {
        table.work = fit_key(scene, plan_);
        table.reference =
            "the better one of slsqp and nelder-mead, 50 starts each, polished, intervals by likelihood";
        for (const FitWay& way : ways_)
            table.ways.push_back({.keys = keys_of(way, plan_.problem), .seconds = 0.0});
    }

    bool attempt(std::size_t k) override {
        if (!reference_ && !make_reference())
            return false;
        FitAnswer answer = solve(ways_[k], method_of(ways_[k]), limit_);
        for (int turn = 1; turn < repeats && answer.seconds < long_fit && answer.failure.empty(); ++turn)
            answer.seconds = std::min(answer.seconds, solve(ways_[k], method_of(ways_[k]), limit_).seconds);
        Way& way = table.ways[k];
        way.seconds = answer.seconds;
        way.runs = 1;
        if (answer.failure.empty())
            way.found = errors_of(answer);
        else
            way.status = answer.failure;
        return !context_.stopped();
    }

private:
    fitting::Method method_of(const FitWay& way) const {
        fitting::Method method = plan_.method;
        method.algorithm = way.algorithm;
        method.levenberg_marquardt = way.polish;
        method.starts = way.starts;
        method.threads = 1;
        return method;
    }

    FitAnswer solve(const FitWay& way, fitting::Method method, double limit) const {
        const Stopwatch watch;
        method.stop_requested = [&] { return context_.stopped() || watch.seconds() > limit; };
        const fitting::Fit fit = fitting::fit(plan_.problem, method);
        FitAnswer answer;
        if (fit.termination == fitting::Termination::failed)
            answer.failure = "failed: " + fit.reason;
        else if (fit.termination != fitting::Termination::interrupted)
            read(fit, way, method, answer);
        answer.seconds = watch.seconds();
        if (answer.failure.empty() && answer.seconds > limit)
            answer.failure = fmt::format("took more than {:g} s", limit);
        return answer;
    }

    void read(const fitting::Fit& fit, const FitWay& way, const fitting::Method& method,
              FitAnswer& answer) const {
        const fitting::Report report = fitting::report(plan_.problem, fit);
        answer.objective = fit.objective;
        for (const std::size_t i : fitting::free_parameters(plan_.problem)) {
            const fitting::Estimate& e = report.estimates[i];
            answer.values.push_back(e.value);
            answer.errors.push_back(has_error(report, e) ? e.standard_error : HUGE_VAL);
            answer.intervals.push_back(way.likelihood ? likelihood_interval(plan_.problem, method, fit, i)
                                                      : Bounds{e.low, e.high});
        }
    }

    /// The better one of two searches that have nothing in common but the polish.
    bool make_reference() {
        if (!no_reference_.empty())
            throw RunError(no_reference_);
        std::array<FitAnswer, 2> pair;
        for (std::size_t k = 0; k < pair.size(); ++k) {
            const FitWay way{k == 0 ? Algorithm::slsqp : Algorithm::nelder_mead, true, reference_starts,
                             true};
            fitting::Method method = method_of(way);
            method.threads = context_.thread_count();
            method.tolerance = 1e-13;
            pair[k] = solve(way, method, HUGE_VAL);
            if (context_.stopped())
                return false;
            if (!pair[k].failure.empty())
                throw RunError(no_reference_ = "no reference: " + pair[k].failure);
        }
        const std::size_t best = pair[1].objective < pair[0].objective ? 1 : 0;
        reference_ = pair[best];
        if (context_.log)
            context_.log(Severity::info,
                         fmt::format("tradeoff: two searches of {} starts agree to {:.2g} standard errors",
                                     reference_starts, distance(pair[1 - best])));
        return true;
    }

    /// Largest difference of a parameter from the reference, in its standard errors.
    double distance(const FitAnswer& answer) const {
        double largest = 0.0;
        for (std::size_t i = 0; i < answer.values.size(); ++i)
            if (const double e = reference_->errors[i]; std::isfinite(e) && e > 0.0)
                largest = std::max(largest, std::abs(answer.values[i] - reference_->values[i]) / e);
        return largest;
    }

    /// Largest shift of an end of an interval, in half its width; NaN if the reference has no interval.
    double interval_error(const FitAnswer& answer) const {
        double largest = NAN;
        for (std::size_t i = 0; i < answer.intervals.size(); ++i) {
            const auto [low, high] = reference_->intervals[i];
            if (!std::isfinite(high - low))
                continue;
            const double shift = std::max(std::abs(answer.intervals[i].first - low),
                                          std::abs(answer.intervals[i].second - high));
            largest = std::fmax(largest, 2.0 * shift / (high - low));
        }
        return largest;
    }

    std::vector<Found> errors_of(const FitAnswer& answer) const {
        std::vector<Found> all{
            error_found("optimum", "standard errors", distance(answer)),
            error_found("interval", "half widths", interval_error(answer)),
            error_found("objective", "of chi2", std::max(0.0, answer.objective - reference_->objective))};
        std::erase_if(all, [](const Found& f) { return std::isnan(f.value); });
        return all;
    }

    FitPlan plan_;
    std::vector<FitWay> ways_;
    double limit_;
    const RunContext& context_;
    std::optional<FitAnswer> reference_;
    std::string no_reference_; ///< why, if it was tried in vain
};

} // namespace

std::unique_ptr<Target> fit_target(const scene::Scene& scene, const std::filesystem::path& results,
                                   const RunContext& context) {
    if (!scene.fit)
        throw InputError(scene.path + ": no [fit] table, so there is no fit whose cost and error could be "
                                      "measured");
    return std::make_unique<FitTarget>(
        scene, fit_plan(*scene.fit, read_fit_inputs(scene, results, OwnFiles::required)), context);
}

} // namespace rodwake::app

#include "search.hpp"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace rodwake::fitting {

namespace {

using Handle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

/// NLopt works on v = stretch u and objective/unit. With gradients, stretch makes the curvature's diagonal 1
/// at the start, so that first steps along the gradient have a sensible length.
struct NloptStage {
    Evaluator& evaluator;
    nlopt_opt handle = nullptr;
    Eigen::VectorXd stretch{};
    double unit = 1.0, worst = 1e6;
};

double objective(unsigned, const double* v, double* gradient, void* data) {
    NloptStage& stage = *static_cast<NloptStage*>(data);
    const Eigen::VectorXd u =
        Eigen::Map<const Eigen::VectorXd>(v, stage.stretch.size()).cwiseQuotient(stage.stretch);
    const SearchPoint point = stage.evaluator(u, gradient != nullptr);
    if (stage.evaluator.stopped())
        nlopt_force_stop(stage.handle);
    if (!point.finite()) {
        // A wall that rises away from the best point, higher than anything met so far.
        const Eigen::VectorXd away = stage.evaluator.found() ? Eigen::VectorXd(u - stage.evaluator.best_u())
                                                             : Eigen::VectorXd::Zero(u.size());
        if (gradient)
            Eigen::Map<Eigen::VectorXd>(gradient, u.size()).setZero();
        if (gradient && away.squaredNorm() > 0.0)
            Eigen::Map<Eigen::VectorXd>(gradient, u.size()) =
                (stage.worst / away.squaredNorm() * away).cwiseQuotient(stage.stretch);
        return 2.0 * stage.worst;
    }
    if (gradient)
        Eigen::Map<Eigen::VectorXd>(gradient, u.size()) =
            stage.evaluator.gradient(point).cwiseQuotient(stage.stretch) / stage.unit;
    stage.worst = std::max(stage.worst, point.objective / stage.unit);
    return point.objective / stage.unit;
}

nlopt_algorithm of_nlopt(Algorithm algorithm) {
    switch (algorithm) {
    case Algorithm::bobyqa:
        return NLOPT_LN_BOBYQA;
    case Algorithm::nelder_mead:
        return NLOPT_LN_NELDERMEAD;
    case Algorithm::slsqp:
        return NLOPT_LD_SLSQP;
    case Algorithm::lbfgs:
        return NLOPT_LD_LBFGS;
    case Algorithm::mma:
        return NLOPT_LD_MMA;
    case Algorithm::mlsl:
        return NLOPT_G_MLSL_LDS;
    case Algorithm::crs:
        return NLOPT_GN_CRS2_LM;
    case Algorithm::isres:
        return NLOPT_GN_ISRES;
    case Algorithm::direct_l:
        break;
    }
    return NLOPT_GN_DIRECT_L;
}

std::string meaning(nlopt_result result) {
    switch (result) {
    case NLOPT_SUCCESS:
    case NLOPT_STOPVAL_REACHED:
        return "finished";
    case NLOPT_FTOL_REACHED:
        return "the objective changes less than the tolerance";
    case NLOPT_XTOL_REACHED:
        return "the parameters change less than the tolerance";
    case NLOPT_MAXEVAL_REACHED:
    case NLOPT_MAXTIME_REACHED:
        return "out of evaluations";
    case NLOPT_ROUNDOFF_LIMITED:
        return "rounding errors stop it; the best point is kept";
    case NLOPT_FORCED_STOP:
        return "interrupted";
    case NLOPT_INVALID_ARGS:
        return "not made for this problem";
    default:
        return "it could not go on; the best point is kept";
    }
}

Handle make(const Method& method, Algorithm algorithm, const NloptStage& stage) {
    const auto n = static_cast<unsigned>(stage.stretch.size());
    Handle opt(nlopt_create(of_nlopt(algorithm), n), &nlopt_destroy);
    if (!opt)
        throw std::bad_alloc();
    const SearchSpace& space = stage.evaluator.space();
    const Eigen::VectorXd lower = space.lower.cwiseProduct(stage.stretch);
    const Eigen::VectorXd upper = space.upper.cwiseProduct(stage.stretch);
    nlopt_set_lower_bounds(opt.get(), lower.data());
    nlopt_set_upper_bounds(opt.get(), upper.data());
    nlopt_set_ftol_rel(opt.get(), method.tolerance);
    nlopt_set_xtol_rel(opt.get(), method.tolerance);
    nlopt_set_maxeval(opt.get(), static_cast<int>(std::min<long>(method.max_evaluations, 1'000'000'000)));
    if (!is_global(algorithm) && !needs_gradient(algorithm)) {
        const Eigen::VectorXd first_steps =
            (0.3 * (space.upper - space.lower)).cwiseMin(0.25).cwiseProduct(stage.stretch);
        nlopt_set_initial_step(opt.get(), first_steps.data());
    }
    return opt;
}

SearchResult one_stage(Evaluator& evaluator, const Method& method, Algorithm algorithm,
                       const Eigen::VectorXd& start) {
    const bool with_gradient = needs_gradient(algorithm);
    const SearchPoint first = evaluator(start, with_gradient);
    NloptStage stage{evaluator};
    stage.stretch = Eigen::VectorXd::Ones(start.size());
    if (first.jacobian.size() > 0 && first.objective != 0.0) {
        // No first step goes beyond a factor e in the logarithm, and ten natural steps else if those are
        // known: a slope that is small far from the minimum must not send the search past it.
        const SearchSpace& space = evaluator.space();
        const Weighted w = evaluator.weighted(first);
        for (Eigen::Index k = 0; k < start.size(); ++k) {
            const double least = space.logarithmic(k)   ? 1.0 / space.coordinate(k, std::numbers::e)
                                 : space.scale_known(k) ? 0.1
                                                        : 1e-8;
            stage.stretch[k] = std::clamp(w.a.col(k).stableNorm() / std::sqrt(first.objective), least, 1e8);
        }
    }
    if (first.finite() && first.objective > 0.0)
        stage.unit = first.objective;
    const Handle opt = make(method, algorithm, stage);
    stage.handle = opt.get();
    nlopt_set_min_objective(opt.get(), objective, &stage);
    if (algorithm == Algorithm::mlsl)
        nlopt_set_local_optimizer(opt.get(), make(method, Algorithm::slsqp, stage).get());
    Eigen::VectorXd v = start.cwiseProduct(stage.stretch);
    double smallest = 0.0;
    const nlopt_result result = nlopt_optimize(opt.get(), v.data(), &smallest);
    if (result == NLOPT_OUT_OF_MEMORY) // the start would end early and count as converged
        throw std::bad_alloc();
    SearchResult end{evaluator.found() ? evaluator.best_u() : start,
                     evaluator.best(),
                     result == NLOPT_FORCED_STOP ? Termination::interrupted
                     : result == NLOPT_MAXEVAL_REACHED || result == NLOPT_MAXTIME_REACHED
                         ? Termination::budget
                     : result > 0 ? Termination::converged
                                  : Termination::roundoff,
                     {}};
    const char* name = nlopt_result_to_string(result);
    end.reason = fmt::format("{}: {} ({})", to_string(algorithm), name ? name : "unknown", meaning(result));
    return end;
}

} // namespace

SearchResult nlopt_search(Evaluator& evaluator, const Method& method, const Eigen::VectorXd& start,
                          std::uint32_t seed) {
    nlopt_srand(seed); // NLopt's generator is of the thread
    // NLopt's BOBYQA is for two parameters and more.
    const bool too_few = method.algorithm == Algorithm::bobyqa && start.size() == 1;
    SearchResult end =
        one_stage(evaluator, method, too_few ? Algorithm::nelder_mead : method.algorithm, start);
    if (too_few)
        end.reason = "bobyqa needs two parameters; instead " + end.reason;
    if (is_global(method.algorithm) && evaluator.found() && !evaluator.stopped()) {
        const std::string before = end.reason;
        end = one_stage(evaluator, method, Algorithm::slsqp, end.u);
        end.reason = before + "; " + end.reason;
    }
    if (!evaluator.found())
        end.termination = evaluator.stopped() ? Termination::interrupted : Termination::failed;
    return end;
}

} // namespace rodwake::fitting

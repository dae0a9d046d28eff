// What rods in the elastic medium cost: their right-hand side term by term, and a run.

#include "rodwake/core/stopwatch.hpp"
#include "rodwake/medium/simulate.hpp"
#include "run/cost_parts.hpp"
#include "wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace rodwake::app {

namespace {
using rods::RodProblem;

/// A long run is not over in `of_its_pace`, but rods that start apart have come among each other by then.
constexpr double of_its_pace = 0.6 * cost_budget, of_a_run = 0.2 * cost_budget,
                 of_a_rate = 0.03 * cost_budget;

/// Runs of all cases of a kind, with noise or in draws of a measured field; `most`: as many as
/// noise.capture_error may add up to.
struct Runs {
    double least = 0.0, most = 0.0;
};

Runs runs_of(const RodsPlan& plan) {
    const scene::Scene& scene = plan.of.scene;
    if (plan.noise) { // the first is done twice
        const auto least = static_cast<double>(plan.noise->runs);
        const double most = plan.noise->capture_error ? static_cast<double>(plan.noise->most_runs) : least;
        return {1.0 + least, 1.0 + std::max(least, most)};
    }
    const bool measured = scene.medium && scene.medium->field == scene::FieldBackend::measured;
    const double samples = measured ? static_cast<double>(scene.medium->measured->samples) : 0.0;
    return {1.0 + samples, 1.0 + samples};
}

/// What tells cases apart that do not take about as long.
struct Kind {
    bool dynamic = false;
    medium::Closure closure = medium::Closure::none;

    bool operator==(const Kind&) const = default;
};

Kind kind_of(const RodsPlan& plan) {
    const auto& medium = plan.of.scene.medium;
    return medium && medium->is_dynamic() ? Kind{true, medium->memory().closure} : Kind{};
}

Runs runs_of_kind(const Plan& plan, const Kind& kind) {
    Runs all;
    for (const RodsPlan& one : plan.rods)
        if (kind_of(one) == kind) {
            const Runs runs = runs_of(one);
            all.least += runs.least;
            all.most += runs.most;
        }
    return all;
}

/// Seconds of a right-hand side at the start.
double rates_time(const RodProblem& problem) {
    const rods::RodModel model = rods::model_of(problem);
    const std::vector<double> y = rods::to_state(problem.rods);
    std::vector<double> ydot(y.size());
    return seconds_of([&] { model.rhs(y, ydot); }, of_a_rate);
}

/// The same of a problem that is changed before.
template<class Change>
double rates_time(RodProblem problem, const Change& change) {
    change(problem);
    return rates_time(problem);
}

double jacobian_time(const RodProblem& problem) {
    const rods::RodModel model = rods::model_of(problem);
    const std::vector<double> y = rods::to_state(problem.rods);
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(y.size()), static_cast<Eigen::Index>(y.size()));
    return seconds_of([&] { model.jacobian(y, jacobian); }, of_a_rate);
}

void to_plane(RodProblem& problem) {
    problem.box.reset();
    problem.field = nullptr;
}

/// A run, or as much of it as there was time for; numbers are those of the whole.
struct Pace {
    bool whole = true;
    double reached = 0.0, seconds = 0.0;
    double steps = 0.0, rates = 0.0, jacobians = 0.0;
    std::string failure;
};

using Simulate = std::function<rods::RodResult(const RodProblem&, const rods::RodOptions&)>;

Simulate simulation(const std::optional<NoisePlan>& noise) {
    return [noise](const RodProblem& problem, const rods::RodOptions& options) {
        return noise ? rods::simulate(problem, options, noise->noise, 0) : rods::simulate(problem, options);
    };
}

Pace pace_of(const RodProblem& problem, const rods::RodOptions& given, const Simulate& simulate) {
    // The wall clock is asked at each step: CPU time is dearer, and asked only when that is over.
    rods::RodOptions options = given;
    Pace pace;
    const auto last = std::chrono::steady_clock::now() + std::chrono::duration<double>(of_its_pace);
    options.ode.on_step = [&](const integrate::Step& step) { pace.reached = step.time; };
    const Stopwatch watch;
    options.ode.stop_requested = [&] {
        return std::chrono::steady_clock::now() > last && watch.seconds() > of_its_pace;
    };
    const integrate::Solution solution = simulate(problem, options).solution;
    pace.seconds = watch.seconds();
    pace.whole = solution.status.termination != integrate::Termination::interrupted;
    if (!solution.status.ok())
        pace.failure = solution.status.message();
    else if (pace.whole)
        pace.seconds = seconds_of([&] { simulate(problem, given); }, of_a_run);
    const double scale = pace.whole || !(pace.reached > 0.0) ? 1.0 : problem.t_end / pace.reached;
    pace.seconds *= scale;
    pace.steps = scale * static_cast<double>(solution.statistics.steps);
    pace.rates = scale * static_cast<double>(solution.statistics.rhs_evaluations);
    pace.jacobians = scale * static_cast<double>(solution.statistics.jacobian_evaluations);
    return pace;
}

/// The rows of a problem whose run has this pace.
class Rows {
public:
    Rows(const RodsPlan& plan, const RodProblem& problem, const Pace& pace, double full)
        : plan_(plan), problem_(problem), pace_(pace), full_(full) {}

    std::vector<CostRow> all() {
        add_terms();
        add_jacobian();
        const double rest = pace_.seconds - parts_;
        if (rest > 0.0)
            add_part("solver, separations, contact",
                     duration_text(rest / std::max(pace_.steps, 1.0)) + " a step", rest, {});
        add_runs();
        add_looser_sums();
        // parts timed at another moment may add up to more than the run
        for (CostRow& row : rows_) {
            if (row.share)
                *row.share /= std::max(parts_, pace_.seconds);
            if (row.saved)
                *row.saved /= std::max(parts_, pace_.seconds);
        }
        return rows_;
    }

private:
    /// Shares and savings in seconds of the run, until all are known.
    void add_part(std::string term, std::string each, double seconds, std::optional<double> saved) {
        parts_ += seconds;
        rows_.push_back({std::move(term), std::move(each), seconds, saved});
    }

    /// Of a right-hand side; `without`: what is left of it.
    void add_rates(std::string term, double seconds, std::optional<double> without) {
        seconds = std::max(seconds, 0.0);
        add_part(std::move(term), duration_text(seconds) + " a right-hand side", pace_.rates * seconds,
                 without ? std::optional(pace_.rates * (full_ - *without)) : std::nullopt);
    }

    void add_terms() {
        const rods::Couplings& c = problem_.couplings;
        const double walking = rates_time(problem_, [](RodProblem& p) { p.couplings = {}; });
        add_rates("walking straight", walking, {});
        if (!rods::model_of(problem_).interacting())
            return;
        const bool images = problem_.box && !problem_.field;
        const auto without_polar = [](RodProblem& p) { p.couplings = rods::without(p.couplings, true); };
        const auto without_apolar = [](RodProblem& p) { p.couplings = rods::without(p.couplings, false); };
        const RodProblem all = problem_;
        RodProblem near = problem_; // without images, where those can be told apart
        if (images)
            to_plane(near);
        const double of_all = images ? rates_time(near) : full_;
        const double strain = !c.apolar() ? walking : c.polar() ? rates_time(near, without_polar) : of_all;
        if (c.apolar())
            add_rates(fmt::format("strain ({})", rods::coupling_names(false)), strain - walking,
                      c.polar() ? rates_time(all, without_apolar) : walking);
        if (c.polar())
            add_rates(fmt::format("polar turning ({})", rods::coupling_names(true)), of_all - strain,
                      c.apolar() ? rates_time(all, without_polar) : walking);
        if (images)
            add_rates("images in the box (medium.periodic)", full_ - of_all, of_all);
    }

    void add_jacobian() {
        if (!(pace_.jacobians > 0.0) || !rods::model_of(problem_).has_jacobian())
            return;
        const double each = jacobian_time(problem_);
        add_part(fmt::format("Jacobian ({:.0f} of them)", pace_.jacobians), duration_text(each) + " each",
                 pace_.jacobians * each, {});
    }

    /// A run of its own, for a setting that changes its steps.
    void add_run(std::string setting, const RodProblem& problem, const rods::RodOptions& options) {
        const Pace other = pace_of(problem, options, simulation(plan_.noise));
        if (other.failure.empty() && (other.whole || other.reached > 0.0))
            rows_.push_back({std::move(setting),
                             duration_text(other.seconds) + " the run",
                             {},
                             pace_.seconds - other.seconds});
    }

    void add_runs() {
        const double rtol = plan_.options.ode.rtol;
        rods::RodOptions looser = plan_.options;
        looser.ode.rtol = std::min(100.0 * rtol, 1e-3);
        looser.ode.atol *= looser.ode.rtol / rtol;
        if (looser.ode.rtol > rtol && !plan_.noise) // whose steps have no tolerance
            add_run(fmt::format("rods_run.rtol = {:g} instead of {:g}", looser.ode.rtol, rtol), problem_,
                    looser);
        if (const std::size_t times = problem_.output_times.size(); times > 2) { // the start and the end
            RodProblem silent = problem_;
            silent.output_times.clear();
            add_run(fmt::format("the end alone instead of {} output times", times), silent, plan_.options);
        }
    }

    void add_setting(std::string setting, double rates) {
        rows_.push_back({std::move(setting),
                         duration_text(rates) + " a right-hand side",
                         {},
                         pace_.rates * (full_ - rates)});
    }

    void add_looser_sums() {
        using elastic::Accuracy;
        if (!rods::model_of(problem_).interacting())
            return;
        if (problem_.field && problem_.sums.turning_tolerance == 0.0 &&
            problem_.sums.accuracy == Accuracy::full)
            add_setting("medium.field = \"exact\"",
                        rates_time(problem_, [](RodProblem& p) { p.field = nullptr; }));
        constexpr std::size_t fewest = 8; // rods for which the sums have these settings
        if (problem_.field || problem_.box || problem_.rods.size() < fewest)
            return;
        if (problem_.sums.accuracy == Accuracy::full)
            add_setting("rods_run.precision = \"fine\"",
                        rates_time(problem_, [](RodProblem& p) { p.sums.accuracy = Accuracy::fine; }));
        if (problem_.sums.accuracy != Accuracy::single)
            add_setting("rods_run.precision = \"single\"",
                        rates_time(problem_, [](RodProblem& p) { p.sums.accuracy = Accuracy::single; }));
        const double tolerance = std::max(1e-4, 100.0 * problem_.sums.turning_tolerance);
        if (problem_.rods.size() >= elastic::fewest_far_rods && tolerance <= 1e-2)
            add_setting(fmt::format("rods_run.turning_tolerance = {:g}", tolerance),
                        rates_time(problem_, [&](RodProblem& p) { p.sums.turning_tolerance = tolerance; }));
    }

    const RodsPlan& plan_;
    const RodProblem& problem_;
    const Pace& pace_;
    double full_, parts_ = 0.0;
    std::vector<CostRow> rows_;
};

std::string run_text(const RodsPlan& plan, const Pace& pace, double full, const Runs& runs) {
    std::string text = fmt::format("  rods{}: about {}", plan.of.suffix(), duration_text(pace.seconds));
    if (runs.most > 1.0)
        text += fmt::format(" each, {} for {:g} runs", duration_text(runs.least * pace.seconds), runs.least);
    if (runs.most > runs.least)
        text += fmt::format(", with noise.capture_error up to {} for {:g}",
                            duration_text(runs.most * pace.seconds), runs.most);
    text += fmt::format(": {:.0f} steps, {:.0f} right-hand sides of {}", pace.steps, pace.rates,
                        duration_text(full));
    return text + (pace.whole ? "\n"
                              : fmt::format(", at the pace of the first {:.3g} of {:g}\n", pace.reached,
                                            plan.problem.t_end));
}

/// Rods and medium together: of their steps no part can be left out by itself.
std::string dynamic_cost(const RodsPlan& plan, const Runs& runs) {
    const scene::Medium& medium = *plan.of.scene.medium;
    const Pace pace =
        pace_of(plan.problem, plan.options, [&](const RodProblem& problem, const rods::RodOptions& options) {
            return static_cast<rods::RodResult>(
                medium::simulate({problem, medium.memory()}, options, [](const medium::FilmFrame&) {}));
        });
    if (!pace.failure.empty())
        return fmt::format("  rods: the solver gives up ({})\n", pace.failure);
    if (!pace.whole && !(pace.reached > 0.0))
        return fmt::format("  rods: a step takes more than {}\n", duration_text(pace.seconds));
    return run_text(plan, pace, pace.seconds / std::max(pace.rates, 1.0), runs);
}

/// The problem in the field of the scene, and in words what that field cost to make.
struct Made {
    RodProblem problem;
    std::string text;
};

Made with_field(const RodsPlan& plan, const std::filesystem::path& folder, const RunContext& context) {
    Made made{plan.problem, {}};
    if (!made.problem.medium || !rods::model_of(made.problem).interacting())
        return made;
    const scene::FieldBackend field = plan.of.scene.medium->field;
    if (field == scene::FieldBackend::measured)
        made.text = "  the measured field is smoothed before, some seconds; timed in the field of theory\n";
    if (field == scene::FieldBackend::exact || field == scene::FieldBackend::measured)
        return made;
    const auto start = std::chrono::steady_clock::now();
    made.problem.field = WakeFields(context, folder, make_silent_logger()).of(plan.of.scene);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    made.text = fmt::format("  {} for the field of the medium before, made or read\n",
                            duration_text(seconds.count()));
    return made;
}

/// `parts`: with a table of what it consists of.
std::string case_cost(const RodsPlan& plan, const Runs& runs, bool parts, const std::filesystem::path& folder,
                      const RunContext& context) {
    if (kind_of(plan).dynamic)
        return dynamic_cost(plan, runs);
    const Made made = with_field(plan, folder, context);
    const double full = rates_time(made.problem);
    if (full > 0.1 * cost_budget) // a step is some ten of them
        return made.text + fmt::format("  rods: a right-hand side takes {}, so each step some {}\n",
                                       duration_text(full), duration_text(10.0 * full));
    const Pace pace = pace_of(made.problem, plan.options, simulation(plan.noise));
    if (!pace.failure.empty())
        return made.text + fmt::format("  rods: the solver gives up ({})\n", pace.failure);
    if (!pace.whole && !(pace.reached > 0.0))
        return made.text + fmt::format("  rods: a step takes more than {}\n", duration_text(pace.seconds));
    return made.text + run_text(plan, pace, full, runs) +
           (parts ? cost_table(Rows(plan, made.problem, pace, full).all()) : "");
}

} // namespace

std::string rods_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context) {
    std::string text;
    std::vector<Kind> told;
    for (const RodsPlan& one : plan.rods) {
        const Kind kind = kind_of(one);
        if (std::ranges::find(told, kind) != told.end())
            continue;
        text += case_cost(one, runs_of_kind(plan, kind), told.empty(), folder, context);
        told.push_back(kind);
    }
    return text;
}

} // namespace rodwake::app

#pragma once
// What the files of the theory hold: rods.csv, outcome.json, ensemble.csv, noise.json, and those of
// [rods_order].

#include "rodwake/core/encounter.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/core/record.hpp"
#include "run/record_members.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rodwake::app {

/// rods.csv: the time, then each rod.
struct TimeRow {
    double t;

    static constexpr auto fields() { return std::tuple{field("t", &TimeRow::t, {"{time}", "time"})}; }
};

struct PoseRow {
    double x, y, theta;

    static constexpr auto fields() {
        using R = PoseRow;
        return std::tuple{field("x", &R::x, {"{length}", "position of the rod, unwrapped"}),
                          field("y", &R::y, {"{length}", "position of the rod, unwrapped"}),
                          field("theta", &R::theta,
                                {"rad", "heading of the rod from +x, counter-clockwise, without jumps"})};
    }
};

struct UnitNames {
    std::string length, time;
    std::optional<std::string> turn;

    static constexpr auto fields() {
        using R = UnitNames;
        return std::tuple{field("length", &R::length, {"", "unit of lengths"}),
                          field("time", &R::time, {"", "unit of times"}),
                          field("turn", &R::turn, {"", "unit of turns"})};
    }
};

struct SolverReport {
    std::string method, form, field_name;
    std::optional<std::string> evaluation;
    std::optional<double> field_tolerance;
    std::optional<int> run;
    std::optional<double> time_step, rtol, atol;
    std::string status;
    long steps = 0, rhs_evaluations = 0, jacobian_evaluations = 0, error_test_failures = 0,
         convergence_failures = 0;
    std::optional<double> director_drift;
    std::optional<std::string> message;

    static constexpr auto fields() {
        using R = SolverReport;
        return std::tuple{
            field("method", &R::method, {"", "of integration"}),
            field("form", &R::form, {"", "of the equations"}),
            field("field", &R::field_name, {"", "how the wakes were computed"}),
            field("evaluation", &R::evaluation, {"", "of a dynamic medium: mesh or sums"}),
            field("field_tolerance", &R::field_tolerance, {"1", "of a table of the field"}),
            field("run", &R::run, {"", "of the runs with noise"}),
            field("time_step", &R::time_step, {"{time}", "of the first run with noise"}),
            field("rtol", &R::rtol, {"1", "relative tolerance"}),
            field("atol", &R::atol, {"1", "absolute tolerance, in reduced units"}),
            field("status", &R::status, {"", "how the integration ended"}),
            field("steps", &R::steps, {"1", "of the solver"}),
            field("rhs_evaluations", &R::rhs_evaluations, {"1", "of the right-hand side"}),
            field("jacobian_evaluations", &R::jacobian_evaluations, {"1", "of the Jacobian"}),
            field("error_test_failures", &R::error_test_failures, {"1", "steps that were taken again"}),
            field("convergence_failures", &R::convergence_failures, {"1", "of Newton's iteration"}),
            field("director_drift", &R::director_drift,
                  {"1", "largest deviation of a director's length from 1 after a step"}),
            field("message", &R::message, {"", "of a failure"})};
    }
};

/// Mean and standard deviation of one sample.
struct Spread {
    OrNull<double> mean, spread;
    std::size_t samples = 0;

    static constexpr auto fields() {
        using R = Spread;
        return std::tuple{field("mean", &R::mean, {"", "in the unit of the value"}),
                          field("spread", &R::spread, {"", "standard deviation of one sample"}),
                          field("samples", &R::samples, {"1", "behind it"})};
    }
};

/// How many of several runs ended how.
struct EndingCounts {
    std::int64_t contact = 0, pursuit = 0, escape = 0, undecided = 0, orbit = 0, bound = 0, failed = 0;

    void add(Ending ending) {
        switch (ending) {
        case Ending::contact:
            ++contact;
            break;
        case Ending::pursuit:
            ++pursuit;
            break;
        case Ending::escape:
            ++escape;
            break;
        case Ending::undecided:
            ++undecided;
            break;
        case Ending::orbit:
            ++orbit;
            break;
        case Ending::bound:
            ++bound;
            break;
        }
    }

    static constexpr auto fields() {
        using R = EndingCounts;
        return std::tuple{field("contact", &R::contact, {"1", "runs that ended so"}),
                          field("pursuit", &R::pursuit, {"1", "runs that ended so"}),
                          field("escape", &R::escape, {"1", "runs that ended so"}),
                          field("undecided", &R::undecided, {"1", "runs that ended so"}),
                          field("orbit", &R::orbit, {"1", "runs that ended so"}),
                          field("bound", &R::bound, {"1", "runs that ended so"}),
                          field("failed", &R::failed, {"1", "runs in which the solver failed"})};
    }
};

/// Rods in fields drawn from a measured one and its errors.
struct DrawnReport : EndingCounts {
    std::size_t samples = 0;
    Spread final_separation, min_separation, contact_time;

    static constexpr auto fields() {
        using R = DrawnReport;
        return std::tuple_cat(
            std::tuple{field("samples", &R::samples, {"1", "draws of the field's errors"})},
            EndingCounts::fields(),
            std::tuple{field("final_separation", &R::final_separation, {"{length}", "of the closest pair"}),
                       field("min_separation", &R::min_separation, {"{length}", "of any pair at any time"}),
                       field("contact_time", &R::contact_time, {"{time}", "of the draws with contact"})});
    }
};

struct OutcomeReport {
    std::string outcome, certificate;
    double time = 0.0, min_separation = unknown_error, min_separation_time = unknown_error;
    OrNull<std::array<std::size_t, 2>> pair;
    std::vector<double> turn;
    std::optional<std::vector<double>> own_turn;
    std::optional<double> min_gap, min_gap_time;
    std::optional<double> separation, omega;
    std::optional<bool> separation_grows, stable;
    std::string reason;
    UnitNames units;
    SolverReport solver;
    std::optional<DrawnReport> ensemble;

    static constexpr auto fields() {
        using R = OutcomeReport;
        return std::tuple{
            field("outcome", &R::outcome, {"", "contact, bound, orbit, pursuit, escape or undecided"}),
            field("certificate", &R::certificate,
                  {"", "how well the outcome is known: verified, checked or open"}),
            field("time", &R::time, {"{time}", "of contact, else the end of the run"}),
            field("min_separation", &R::min_separation,
                  {"{length}", "smallest separation of any pair at any time"}),
            field("min_separation_time", &R::min_separation_time, {"{time}", "when"}),
            field("min_gap", &R::min_gap,
                  {"{length}", "smallest gap between two bodies at any time, below 0 where they overlap"}),
            field("min_gap_time", &R::min_gap_time, {"{time}", "when"}),
            field("pair", &R::pair, {"", "the rods that came so near"}),
            field("turn", &R::turn, {"rad", "of each rod from start to end"}),
            field("own_turn", &R::own_turn, {"rad", "of it by the rod's own field"}),
            field("separation", &R::separation,
                  {"{length}", "of an orbit, and of a pursuit or a bound pair at the end of the run"}),
            field("omega", &R::omega, {"rad/({time})", "turning rate of an orbit, + counterclockwise"}),
            field("separation_grows", &R::separation_grows,
                  {"", "of a pursuit of two rods: whether it does at the end"}),
            field("stable", &R::stable,
                  {"", "of a pursuit of two rods: whether rods in line are, so far apart"}),
            field("reason", &R::reason, {"", "of the outcome, in words"}),
            field("units", &R::units, {"", "of lengths, times and turns"}),
            field("solver", &R::solver, {"", "what it did"}),
            field("ensemble", &R::ensemble, {"", "of draws of a measured field's errors"})};
    }
};

/// How an ending is written into a table.
constexpr double ending_code(Ending ending) { return static_cast<double>(static_cast<int>(ending)); }

inline constexpr std::string_view outcome_codes =
    "0 contact, 1 pursuit, 2 escape, 3 undecided, 4 orbit, 5 bound (empty: the solver failed)";

/// ensemble.csv: a draw of a measured field's errors.
struct DrawnRow {
    double sample, outcome, time, final_separation, min_separation, turn0;

    static constexpr auto fields() {
        using R = DrawnRow;
        return std::tuple{field("sample", &R::sample, {"1", "number of the draw, from 0"}),
                          field("outcome", &R::outcome, {"1", outcome_codes}),
                          field("time", &R::time, {"{time}", "of contact, else the end of the run"}),
                          field("final_separation", &R::final_separation,
                                {"{length}", "of the closest pair then (empty: one rod)"}),
                          field("min_separation", &R::min_separation,
                                {"{length}", "smallest separation of any pair at any time"}),
                          field("turn0", &R::turn0, {"rad", "of rod 0 from start to end"})};
    }
};

/// ensemble.csv: a run with noise.
struct NoisyRow {
    double run, outcome, time, min_separation, first, second;

    static constexpr auto fields() {
        using R = NoisyRow;
        return std::tuple{field("run", &R::run, {"1", "number of the run with noise, from 0"}),
                          field("outcome", &R::outcome, {"1", outcome_codes}),
                          field("time", &R::time, {"{time}", "of contact, else the end of the run"}),
                          field("min_separation", &R::min_separation,
                                {"{length}", "smallest separation of any pair at any time"}),
                          field("first", &R::first, {"1", "rod of the captured pair, else of the closest"}),
                          field("second", &R::second, {"1", "the other rod of that pair"})};
    }
};

struct FirstContact {
    OrNull<double> mean;
    double error = unknown_error;
    std::size_t runs = 0;

    static constexpr auto fields() {
        using R = FirstContact;
        return std::tuple{field("mean", &R::mean, {"{time}", "of the runs with contact"}),
                          field("error", &R::error, {"{time}", "its standard error"}),
                          field("runs", &R::runs, {"1", "with contact"})};
    }
};

/// A row a time, a column a rod.
struct RodTable {
    std::vector<double> values;
    std::size_t rods = 1;
};

struct NoiseReport {
    std::size_t runs = 0;
    OrNull<double> capture_probability, capture_low, capture_high;
    double capture_confidence = 0.95;
    EndingCounts endings;
    FirstContact first_contact_time;
    std::optional<std::string> failure;
    double rotational_diffusion = 0.0, translational_diffusion = 0.0, speed = 0.0, time_step = 0.0;
    std::uint64_t seed = 0;
    std::vector<double> times, runs_at_time;
    RodTable mean_square_displacement, mean_square_displacement_error, heading_correlation,
        heading_correlation_error;
    UnitNames units;

    static constexpr auto fields() {
        using R = NoiseReport;
        return std::tuple{
            field("runs", &R::runs, {"1", "with noise"}),
            field("capture_probability", &R::capture_probability,
                  {"1", "share of the runs that end in contact, bound, orbit or pursuit"}),
            field("capture_low", &R::capture_low, {"1", "lower end of its interval"}),
            field("capture_high", &R::capture_high, {"1", "upper end of its interval"}),
            field("capture_confidence", &R::capture_confidence, {"1", "of that interval"}),
            field("endings", &R::endings, {"", "of the runs"}),
            field("first_contact_time", &R::first_contact_time, {"{time}", "of the runs with contact"}),
            field("failure", &R::failure, {"", "why the first that failed did"}),
            field("rotational_diffusion", &R::rotational_diffusion, {"1/({time})", "of each heading"}),
            field("translational_diffusion", &R::translational_diffusion,
                  {"({length})^2/({time})", "of each coordinate"}),
            field("speed", &R::speed, {"({length})/({time})", "of a rod, v0"}),
            field("time_step", &R::time_step, {"{time}", "of the integration"}),
            field("seed", &R::seed, {"", "of the noise"}),
            field("times", &R::times, {"{time}", "of the rows of the tables below"}),
            field("runs_at_time", &R::runs_at_time, {"1", "runs that went on at each of the times"}),
            field("mean_square_displacement", &R::mean_square_displacement,
                  {"({length})^2", "a row a time, a column a rod"}),
            field("mean_square_displacement_error", &R::mean_square_displacement_error,
                  {"({length})^2", "its standard error"}),
            field("heading_correlation", &R::heading_correlation, {"1", "a row a time, a column a rod"}),
            field("heading_correlation_error", &R::heading_correlation_error, {"1", "its standard error"}),
            field("units", &R::units, {"", "of lengths and times"})};
    }
};

/// rods_order.csv: means over the runs.
struct OrderRow {
    double t = 0.0, polar = 0.0, nematic = 0.0, clusters = 0.0, mean_size = 0.0, weighted_size = 0.0,
           largest = 0.0;

    static constexpr auto fields() {
        using R = OrderRow;
        return std::tuple{
            field("t", &R::t, {"{order time}", "time"}),
            field("polar", &R::polar, {"1", "polar order |<exp(i theta)>|"}),
            field("nematic", &R::nematic, {"1", "nematic order |<exp(2 i theta)>|"}),
            field("clusters", &R::clusters, {"1", "number of clusters"}),
            field("mean_size", &R::mean_size, {"1", "rods by clusters"}),
            field("weighted_size", &R::weighted_size, {"1", "mean size of the cluster that a rod is in"}),
            field("largest", &R::largest, {"1", "rods of the largest cluster"})};
    }
};

struct ClusterRow {
    double size, clusters, share;

    static constexpr auto fields() {
        using R = ClusterRow;
        return std::tuple{field("size", &R::size, {"1", "rods of a cluster; sizes that occur"}),
                          field("clusters", &R::clusters,
                                {"1", "clusters of this size at an instant, mean from rods_order.from on"}),
                          field("share", &R::share, {"1", "of the rods that are in them"})};
    }
};

/// fluctuations.csv.
struct FluctuationRow {
    double cell, rods, fluctuation, fluctuation_error;

    static constexpr auto fields() {
        using R = FluctuationRow;
        return std::tuple{field("cell", &R::cell,
                                {"{order length}", "root of a cell's area; cells divide the periodic box, or "
                                                   "a square in the middle of the crowd"}),
                          field("rods", &R::rods, {"1", "mean number in a cell"}),
                          field("fluctuation", &R::fluctuation,
                                {"1", "variance of that number over its mean, mean from rods_order.from on; "
                                      "1: independent positions"}),
                          field("fluctuation_error", &R::fluctuation_error,
                                {"1", "its standard error, by blocks (empty: not known)"})};
    }
};

/// rods_order.json.
struct OrderReport {
    Estimate polar, nematic, mean_size, weighted_size, largest;
    std::optional<double> link;
    double from = 0.0, block = 0.0;
    OrNull<double> touch_lifetime;
    std::size_t runs = 0, instants = 0, blocks = 0;
    UnitNames units;

    static constexpr auto fields() {
        using R = OrderReport;
        return std::tuple{
            field("polar", &R::polar, {"1", "polar order, mean from `from` on"}),
            field("nematic", &R::nematic, {"1", "nematic order, mean from `from` on"}),
            field("mean_size", &R::mean_size, {"1", "rods by clusters"}),
            field("weighted_size", &R::weighted_size, {"1", "mean size of the cluster that a rod is in"}),
            field("largest", &R::largest, {"1", "rods of the largest cluster"}),
            field("link", &R::link,
                  {"{order length}", "rods nearer than this are linked (absent: rods whose bodies touch)"}),
            field("from", &R::from, {"{order time}", "means are from then on"}),
            field("block", &R::block, {"{order time}", "of time, for the errors"}),
            field("touch_lifetime", &R::touch_lifetime,
                  {"{order time}",
                   "mean time that two bodies stay in touch, by the output times: their time in "
                   "touch over the number of touches that end (null: none ended)"}),
            field("runs", &R::runs, {"1", "behind the means"}),
            field("instants", &R::instants, {"1", "behind the means"}),
            field("blocks", &R::blocks, {"1", "of time, behind the errors"}),
            field("units", &R::units, {"", "of lengths and times"})};
    }
};

} // namespace rodwake::app

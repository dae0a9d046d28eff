#pragma once
// Critical values: values of one key at which the end of an encounter changes from one group of outcomes to
// another, each with an error (docs/scans.md). Values lie on the last axis of the plan's design. The coarse
// pass evaluates its values at each point of the other axes. Two neighbours of different groups are a
// bracket, which a corrector narrows:
//
//   grazing      the closest approach D passes the contact distance smoothly, on the way or, of an orbit that
//                shrinks, in the end: a root of D(p) - d_c (TOMS 748)
//   separatrix   D jumps: on it lies an unstable fixed point of the pair's flow. Bisection
//   unbinding    pursuit gives way to escape: the square of the angle at which the rods part is linear in p
//                there, and its zero is extrapolated from angles ever closer to it
//   fold         the orbit in which the rods end vanishes: the fold of its branch (rods/pair_branches.hpp)
//
// Along the first axis values are predicted from those of lower levels (critical_search.cpp), and a bracket
// around the prediction is tried first.
//
// A bracket's result depends on the scene and the bracket alone, and brackets on lower levels alone, so that
// bits depend on neither threads nor ranks. What lies between two values of the coarse pass and leaves no
// trace at them is not seen: the audit says how likely that is.

#include "rodwake/app/scan.hpp"
#include "rodwake/core/record.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/run.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <utility>

namespace rodwake::app {

/// `other`: a change of outcome that `between` does not ask for, on the way to one that it does.
enum class CriticalKind { grazing, separatrix, unbinding, fold, other };
inline constexpr std::array critical_kinds = {"grazing", "separatrix", "unbinding", "fold", "other"};

/// Values in the unit of the key, lengths and rates in output units; NaN: there is none.
struct CriticalValue {
    double value = std::numeric_limits<double>::quiet_NaN(), low = value, high = value;
    double closest_below = value, closest_above = value, lambda = value, lambda_error = value;
    double below = -1.0, above = -1.0; ///< numbers of the outcomes
    double encounters = 0.0;
    double rest = std::numeric_limits<double>::quiet_NaN(); ///< upper end of the bracket itself

    static constexpr auto fields() {
        using R = CriticalValue;
        return std::tuple{
            field("value", &R::value, {"{solved key}", "critical value"}),
            field("low", &R::low,
                  {"{solved key}",
                   "lower end of its range: the bracket, and 1.5 times the change at rtol/100"}),
            field("high", &R::high, {"{solved key}", "upper end of its range"}),
            field("closest_below", &R::closest_below,
                  {"{scan length}",
                   "closest approach just below the value; in contact up to the first minimum"}),
            field("closest_above", &R::closest_above,
                  {"{scan length}", "closest approach just above the value"}),
            field("lambda", &R::lambda,
                  {"1/({scan time})", "rate at which rods leave the unstable fixed point on a separatrix"}),
            field("lambda_error", &R::lambda_error,
                  {"1/({scan time})",
                   "difference from the rate by the times of eight decades of distance from "
                   "the value (empty: there are too few such times)"}),
            field("below", &R::below, {"1", "outcome just below the value"}),
            field("above", &R::above, {"1", "outcome just above the value"}),
            field("encounters", &R::encounters,
                  {"1", "encounters that the value took, without the coarse pass and the check at rtol/100"}),
            field("bracket_high", &R::rest, {"{solved key}", "in the ledger: above it the search goes on"})};
    }
};

/// Brackets as points: the values of the axes, the last two numbers its ends, which may lie within the values
/// of the coarse pass around them where the critical value was predicted.
inline constexpr const char* critical_ledger = "critical.log";
inline constexpr std::int64_t first_bracket = std::int64_t{1} << 48;
/// The width that a bracket between these values is narrowed to.
double critical_width(const ScanPlan& plan, double from, double to);
/// The bracket in which the critical value lies for certain.
std::pair<double, double> coarse_bracket(const ScanPlan& plan, const scan::Point& bracket);
scan::Columns columns_of_critical();
/// The plan must outlive it. A bracket that fails is a result that says why.
scan::Evaluate evaluate_brackets(const ScanPlan& plan, std::function<bool()> stop);

/// The group of an outcome: 0 or 1 as in `between`, 2 neither; of ["any"] its own number.
int critical_group(const CriticalPlan& critical, std::int32_t outcome);

struct CriticalSearch {
    bool complete = false;
    std::vector<scan::Result> values; ///< that `between` asks for, by point, then by value
    std::vector<scan::Result> failed;
    std::int64_t audited = 0, missed = 0; ///< random values; those that end otherwise than both neighbours
};

/// Narrows the brackets that the coarse pass left. `ledger` holds the coarse pass, `found` the brackets.
CriticalSearch find_critical(const ScanPlan& plan, const scan::Ledger& ledger, scan::Ledger& found,
                             const scan::Execute& execute,
                             const std::function<void(std::int64_t done, std::int64_t total)>& progress);

/// critical.csv and critical.json. Throws RunError.
void write_critical(const std::filesystem::path& folder, const ScanPlan& plan, const scan::Ledger& ledger,
                    const CriticalSearch& search);

} // namespace rodwake::app

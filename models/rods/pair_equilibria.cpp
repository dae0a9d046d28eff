#include "rodwake/rods/pair_equilibria.hpp"

#include "interaction.hpp"
#include "pair_reduced.hpp"

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

namespace {

constexpr double quarter_turn = 0.5 * std::numbers::pi;

/// Between two values of different sign, to rounding. Signs are those of signbit, here and where roots are
/// looked for, so a value of 0 at a node belongs to one side.
template<class Function>
double bracketed_root(const Function& f, double low, double high, double f_low, double f_high) {
    if (f_low == 0.0 || f_high == 0.0)
        return f_low == 0.0 ? low : high;
    std::uintmax_t calls = 200;
    const auto [a, b] = boost::math::tools::toms748_solve(
        f, low, high, f_low, f_high, boost::math::tools::eps_tolerance<double>(50), calls);
    return 0.5 * (a + b);
}

/// A point of a curve of zeros of (a): the left side of (b) there, and how it changes along the curve.
struct OnCurve {
    Reduced place;
    double value, slope;
};

/// Roots of (b) on a piece of a curve, `at` t from 0 to 1. If (b) falls towards 0 from both ends without a
/// change of sign, its extremum is looked for, and the roots on either side of it.
template<class Curve>
void add_roots(const Curve& at, std::vector<Reduced>& roots) {
    const OnCurve first = at(0.0), last = at(1.0);
    std::vector<std::pair<double, double>> cuts = {{0.0, first.value}, {1.0, last.value}};
    if (std::signbit(first.value) == std::signbit(last.value) && first.value * first.slope < 0.0 &&
        last.value * last.slope > 0.0) {
        const auto slope = [&](double t) { return at(t).slope; };
        const double turn = bracketed_root(slope, 0.0, 1.0, first.slope, last.slope);
        cuts.insert(cuts.begin() + 1, {turn, at(turn).value});
    }
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
        if (std::signbit(cuts[k].second) != std::signbit(cuts[k + 1].second)) {
            const auto value = [&](double t) { return at(t).value; };
            roots.push_back(at(bracketed_root(value, cuts[k].first, cuts[k + 1].first, cuts[k].second,
                                              cuts[k + 1].second))
                                .place);
        }
}

/// The curve of zeros of (a) from P to Q, both on it and in one cell: from the point t of the chord along its
/// normal.
OnCurve on_curve(const ScaledPair& pair, Family family, Reduced P, Reduced Q, double t) {
    const double du = Q.u - P.u, db = Q.b - P.b, chord = std::hypot(du, db);
    const double normal_u = -db / chord, normal_b = du / chord;
    Reduced place{P.u + t * du, P.b + t * db};
    ReducedEquations equations = reduced_equations(pair, family, place);
    for (int iteration = 0; iteration < 12; ++iteration) {
        const double across = equations.by_place(0, 0) * normal_u + equations.by_place(0, 1) * normal_b;
        const double step = std::clamp(-equations.values[0] / across, -0.5 * chord, 0.5 * chord);
        if (!(std::abs(step) > 1e-15))
            break;
        place = {place.u + step * normal_u, place.b + step * normal_b};
        equations = reduced_equations(pair, family, place);
    }
    // Along the curve (a) does not change: the tangent is normal to its gradient, and points to Q.
    double tangent_u = -equations.by_place(0, 1), tangent_b = equations.by_place(0, 0);
    const double forward = tangent_u * du + tangent_b * db > 0.0 ? 1.0 : -1.0;
    return {place, equations.values[1],
            forward * (equations.by_place(1, 0) * tangent_u + equations.by_place(1, 1) * tangent_b)};
}

std::vector<double> steps_between(double first, double last, std::size_t steps) {
    std::vector<double> values(steps + 1);
    for (std::size_t k = 0; k <= steps; ++k)
        values[k] = first + (last - first) * static_cast<double>(k) / static_cast<double>(steps);
    return values;
}

/// Roots of (a) and (b).
std::vector<Reduced> roots_of(const ScaledPair& pair, Family family) {
    // Those with b < pi/2, by marching squares over the signs of (a).
    // On the borders b = 0 and b = pi/2 (a) vanishes by symmetry; the grid ends just short of them.
    const auto u = steps_between(std::log(least_searched), std::log(most_searched), 200);
    const auto b = steps_between(1e-6, quarter_turn - 1e-6, 80);
    std::vector<std::vector<double>> values(u.size(), std::vector<double>(b.size()));
    for (std::size_t i = 0; i < u.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
            values[i][j] = unequal_turning(pair, family, {u[i], b[j]});
    // Where a side of a cell, from node (i, j) along u or along b, is crossed.
    const auto crossing = [&](std::size_t i, std::size_t j, bool along_u) -> std::optional<Reduced> {
        const std::size_t k = i + (along_u ? 1 : 0), l = j + (along_u ? 0 : 1);
        if (std::signbit(values[i][j]) == std::signbit(values[k][l]))
            return {};
        const auto moved = [&](double t) { return along_u ? Reduced{t, b[j]} : Reduced{u[i], t}; };
        const auto f = [&](double t) { return unequal_turning(pair, family, moved(t)); };
        return moved(along_u ? bracketed_root(f, u[i], u[k], values[i][j], values[k][l])
                             : bracketed_root(f, b[j], b[l], values[i][j], values[k][l]));
    };
    std::vector<Reduced> roots;
    for (std::size_t i = 0; i + 1 < u.size(); ++i)
        for (std::size_t j = 0; j + 1 < b.size(); ++j) {
            // The crossings in order around the cell. With four of them two curves pass, and the sign at the
            // centre says which corners they cut off.
            std::vector<Reduced> around;
            for (const auto& side : {crossing(i, j, true), crossing(i + 1, j, false),
                                     crossing(i, j + 1, true), crossing(i, j, false)})
                if (side)
                    around.push_back(*side);
            if (around.size() == 4) {
                const double centre =
                    unequal_turning(pair, family, {0.5 * (u[i] + u[i + 1]), 0.5 * (b[j] + b[j + 1])});
                if (std::signbit(centre) != std::signbit(values[i][j]))
                    std::rotate(around.begin(), around.begin() + 1, around.end());
            }
            for (std::size_t k = 0; k + 1 < around.size(); k += 2)
                if (std::hypot(around[k].u - around[k + 1].u, around[k].b - around[k + 1].b) > 0.0)
                    add_roots([&](double t) { return on_curve(pair, family, around[k], around[k + 1], t); },
                              roots);
        }

    // Those of (b) at b = pi/2, where rods are opposite or abreast.
    for (std::size_t i = 0; i + 1 < u.size(); ++i)
        add_roots(
            [&](double t) {
                const Reduced place{u[i] + t * (u[i + 1] - u[i]), quarter_turn};
                const ReducedEquations equations = reduced_equations(pair, family, place);
                return OnCurve{place, equations.values[1], equations.by_place(1, 0)};
            },
            roots);
    return roots;
}

/// Whether the equations change at a root by more than rounding. Beside a rod its wakes cancel but for the
/// longitudinal one, which at eta < 0 falls off fast: only rounding is left far out.
bool is_resolved(const ScaledPair& pair, Family family, Reduced at) {
    const double r = std::exp(at.u), x = r * std::cos(at.b), y = r * std::sin(at.b);
    double rounding = 0.0;
    for (const double sign : {-1.0, 1.0}) {
        const elastic::FieldValues f = pair.field.at(sign * x, sign * y, {.strain = true, .polar = true});
        rounding += 1e-12 * r *
                    (std::abs(pair.couplings.kappa) * std::hypot(f.strain.xx, f.strain.xy) +
                     std::hypot(pair.couplings.gamma1, pair.couplings.gamma2) *
                         std::hypot(f.laplacian.x, f.laplacian.y));
    }
    const Eigen::Matrix2d by_place = reduced_equations(pair, family, at).by_place;
    const bool opposite = at.b > quarter_turn - 1e-9; // (a) is an identity there
    return by_place.row(1).norm() > rounding && (opposite || by_place.row(0).norm() > rounding);
}

std::array<std::complex<double>, 2> in_line(const ScaledPair& pair, double distance) {
    const TurningRate front = turning_derivatives(pair, distance, 0.0, 0.0);
    const TurningRate rear = turning_derivatives(pair, -distance, 0.0, 0.0);
    const double D = distance, half_sum = 0.5 * (rear.by_phi + front.by_phi);
    const double product = -D * front.by_y * (rear.by_phi + D * front.by_y + front.by_phi) -
                           (1.0 - D * D * front.by_y - D * front.by_phi) * (rear.by_y + front.by_y);
    const std::complex<double> root = std::sqrt(std::complex<double>(half_sum * half_sum - product));
    return {(half_sum + root) / pair.xi, (half_sum + (-root)) / pair.xi};
}

/// Intervals of distances in line by the sign of the largest real part, whose changes are bracketed.
std::vector<PairEquilibrium> in_line_intervals(const ScaledPair& pair) {
    const auto u = steps_between(std::log(least_searched), std::log(most_searched), 600);
    const auto largest = [&](double at) { return in_line(pair, std::exp(at))[0].real(); };
    std::vector<double> ends = {least_searched};
    double before = largest(u.front());
    for (std::size_t k = 1; k < u.size(); ++k) {
        const double here = largest(u[k]);
        if ((before < 0.0) != (here < 0.0))
            ends.push_back(std::exp(bracketed_root(largest, u[k - 1], u[k], before, here)));
        before = here;
    }
    ends.push_back(most_searched);
    std::vector<PairEquilibrium> found;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
        const double middle = std::sqrt(ends[k] * ends[k + 1]);
        const auto [first, second] = in_line(pair, middle);
        PairEquilibrium interval{EquilibriumKind::in_line,
                                 {-middle * pair.xi, 0.0, 0.0},
                                 {ends[k] * pair.xi, ends[k + 1] * pair.xi},
                                 0.0,
                                 {first, second, 0.0}};
        std::stable_sort(interval.eigenvalues.begin(), interval.eigenvalues.end(),
                         [](std::complex<double> a, std::complex<double> b) { return a.real() > b.real(); });
        found.push_back(interval);
    }
    return found;
}

} // namespace

std::string to_string(EquilibriumKind kind) {
    return kind == EquilibriumKind::orbit      ? "orbit"
           : kind == EquilibriumKind::parallel ? "parallel"
                                               : "in_line";
}

bool PairEquilibrium::stable() const {
    const auto negative = [](std::complex<double> value) { return value.real() < 0.0; };
    return std::count_if(eigenvalues.begin(), eigenvalues.end(), negative) ==
           (kind == EquilibriumKind::in_line ? 2 : 3);
}

PairFlow pair_flow(const elastic::Medium& medium, const Couplings& couplings, const Pose& pose) {
    const ScaledPair pair(medium, couplings);
    const double xi = medium.xi;
    PairFlow flow = flow_at(pair, {pose.x / xi, pose.y / xi, pose.heading});
    flow.rates[2] /= xi;
    flow.by_pose.topLeftCorner<2, 2>() /= xi;
    flow.by_pose(2, 2) /= xi;
    flow.by_pose.bottomLeftCorner<1, 2>() /= xi * xi;
    for (double& rate : flow.turning)
        rate /= xi;
    return flow;
}

std::array<std::complex<double>, 2> in_line_eigenvalues(const elastic::Medium& medium,
                                                        const Couplings& couplings, double distance) {
    return in_line(ScaledPair(medium, couplings), distance / medium.xi);
}

std::optional<PairEquilibrium> equilibrium_near(const elastic::Medium& medium, const Couplings& couplings,
                                                const Pose& pose, double longest_first_step) {
    return newton(ScaledPair(medium, couplings), {pose.x / medium.xi, pose.y / medium.xi, pose.heading},
                  longest_first_step);
}

std::vector<PairEquilibrium> pair_equilibria(const elastic::Medium& medium, const Couplings& couplings) {
    const ScaledPair pair(medium, couplings);
    std::vector<PairEquilibrium> found;
    for (const Family family : {Family::orbit, Family::parallel}) {
        if (!couplings.any())
            continue;
        std::vector<Reduced> roots = roots_of(pair, family);
        std::erase_if(roots, [&](const Reduced& root) { return !is_resolved(pair, family, root); });
        std::sort(roots.begin(), roots.end(), [](const Reduced& a, const Reduced& b) { return a.u < b.u; });
        for (const Reduced root : roots) {
            // Newton in three unknowns confirms the root of two, and must not go elsewhere.
            const Pose pose = pose_of(family, root);
            const auto confirmed = newton(pair, pose);
            const bool here =
                confirmed && std::abs(confirmed->separation[0] / pair.xi / std::exp(root.u) - 1.0) < 1e-5;
            found.push_back(here ? *confirmed : described(pair, pose));
        }
    }
    for (const PairEquilibrium& interval : in_line_intervals(pair))
        found.push_back(interval);
    return found;
}

} // namespace rodwake::rods

#include "slip.hpp"

#include "kernels.hpp"
#include "rodwake/core/error.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

namespace rodwake::granular {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

double impulse_to_turn(const NormalMotion& motion, double rate) {
    if (motion.velocity >= 0.0)
        return 0.0;
    return rate > 0.0 ? -motion.velocity / rate : endless;
}

/// Smallest p >= 0 with velocity p + rate p^2/2 = wanted, without cancellation for either sign of rate.
double impulse_to_regain(const NormalMotion& motion, double rate, double wanted) {
    const double square = motion.velocity * motion.velocity + 2.0 * rate * wanted;
    return square < 0.0 ? endless : 2.0 * wanted / (motion.velocity + std::sqrt(square));
}

void advance(NormalMotion& motion, double rate, double impulse) {
    motion.regained += impulse * (motion.velocity + 0.5 * rate * impulse);
    motion.velocity += rate * impulse;
}

} // namespace

void NormalMotion::turn() {
    velocity = 0.0;
    compression -= std::min(regained, 0.0);
    regained = std::max(regained, 0.0);
}

SlipPiece follow_straight(NormalMotion& motion, double rate, double length, double restitution) {
    const double compressing = impulse_to_turn(motion, rate);
    if (compressing > length) {
        advance(motion, rate, length);
        return {length, false};
    }
    if (motion.velocity < 0.0) {
        motion.regained += 0.5 * motion.velocity * compressing;
        motion.turn();
    }
    const double wanted = motion.wanted(restitution);
    const double restoring = wanted > 0.0 ? impulse_to_regain(motion, rate, wanted) : 0.0;
    if (compressing + restoring <= length)
        return {compressing + restoring, true};
    advance(motion, rate, length - compressing);
    return {length, false};
}

namespace {

// Linear algebra of zero slip: 2x2 systems solved to rounding, and the direction in which slip goes on.

/// a b - c d by Kahan's method: error of 1.5 units in the last place at most (Jeannerod, Louvet, Muller
/// 2013).
double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// xx yy - xy^2, relative error of a few units in the last place.
double determinant(double xx, double xy, double yy) { return difference_of_products(xx, yy, xy, xy); }

/// A^-1 b, each component to a few units in the last place however near A is to singular.
Eigen::Vector2d solve(const Eigen::Matrix2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d adjugate(difference_of_products(a(1, 1), b.x(), a(0, 1), b.y()),
                                   difference_of_products(a(0, 0), b.y(), a(0, 1), b.x()));
    return adjugate / determinant(a(0, 0), a(0, 1), a(1, 1));
}

/// Newton on 1/|s(lambda)| - 1, concave and rising: from below it converges without overshoot, in three or
/// four steps. lambda >= |q| - mu tr A because |q| <= lambda + mu |A|.
/// The s with (lambda + mu A) s = q, |s| = 1, lambda > 0: slip along it grows, dr/dp = lambda, and keeps its
/// direction. There is exactly one if |A^-1 q| > mu.
Eigen::Vector2d resumed_direction(const ContactTerms& contact) {
    const Eigen::Matrix2d drag = contact.friction * contact.tangential;
    double lambda = std::max(0.0, contact.coupling.norm() - drag.trace());
    Eigen::Vector2d s;
    for (int k = 0; k < 100; ++k) { // every step at least halves the distance; ends at rounding long before
        const Eigen::Matrix2d shifted = drag + lambda * Eigen::Matrix2d::Identity();
        s = solve(shifted, contact.coupling);
        const double length = s.norm();
        const double step = (length - 1.0) * length * length / s.dot(solve(shifted, s));
        if (!(std::abs(length - 1.0) > 2.0 * std::numeric_limits<double>::epsilon() &&
              lambda + step > lambda))
            break;
        lambda += step;
    }
    return s.normalized();
}

/// Of scale: h below this is rounding of q, A and s.
constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();

/// g, h and dh/dphi of a direction.
struct DirectionRates {
    double growth, turn, slope;
};

DirectionRates turning(const ContactTerms& contact, const Eigen::Vector2d& s) {
    const Eigen::Vector2d rate = contact.slip_rate(s), t(-s.y(), s.x());
    const double growth = s.dot(rate);
    return {growth, t.dot(rate), -growth - contact.friction * t.dot(product(contact.tangential, t))};
}

/// Onto the root of h next to the direction.
void settle(const ContactTerms& contact, Eigen::Vector2d& s) {
    for (int k = 0; k < 3; ++k) { // Newton, from a distance of 1e-3 at most
        const DirectionRates at = turning(contact, s);
        s = (s - at.turn / at.slope * Eigen::Vector2d(-s.y(), s.x())).normalized();
    }
}

/// Whether the direction has settled: h is rounding; or in what is left of a dying slip, p = r/(-g), it turns
/// v_t by no more than counts; or the root that attracts it is so near that v_t may be moved there. Without
/// the last, a path that has settled but neither grows nor dies would be followed in steps of its fast time
/// scale.
bool is_straight(const ContactTerms& contact, ImpactProgress& at) {
    const DirectionRates now = turning(contact, at.direction);
    const double turn = std::abs(now.turn);
    if (turn <= rounding * contact.scale || turn * at.speed <= -now.growth * contact.tolerance)
        return true;
    if (!(turn * std::max(at.speed, 1e3 * contact.tolerance) <= -now.slope * contact.tolerance))
        return false;
    settle(contact, at.direction);
    return true;
}

[[noreturn]] void refuse_singular() {
    throw RunError("impact: friction holds the bodies together without end; the inverse mass is not positive "
                   "definite to rounding (see Impact in rodwake/granular/impact.hpp)");
}

void add_piece(const ContactTerms& contact, ImpactProgress& at, const Eigen::Vector2d& pull, double rate,
               double length) {
    if (!(length < endless || rate > 0.0))
        refuse_singular();
    const SlipPiece piece = follow_straight(at.normal, rate, length, contact.restitution);
    at.tangential_impulse += piece.impulse * pull;
    at.normal_impulse += piece.impulse;
    at.ended = piece.ended;
}

} // namespace

ContactTerms::ContactTerms(const Eigen::Matrix2d& a, const Eigen::Vector2d& q, const Surface& surface)
    : tangential(a), coupling(q), friction(surface.friction), restitution(surface.restitution),
      scale(q.lpNorm<1>() + friction * a.trace()),
      tolerance(1e-14 * determinant(a(0, 0), a(0, 1), a(1, 1)) / a.trace()) {}

void slide_curved(const ContactTerms& contact, ImpactProgress& at) {
    while (!at.ended && at.speed > contact.tolerance) {
        if (is_straight(contact, at))
            return;
        if (++at.steps > most_slip_steps)
            throw RunError("impact: the slip was not followed to its end in " +
                           std::to_string(most_slip_steps) +
                           " steps; the inverse mass is not positive definite or not finite");
        const SlipSeries series(contact, at);
        series.advance(at, series.stop());
    }
    if (!(at.speed > contact.tolerance))
        at.speed = 0.0;
}

void slide_straight(const ContactTerms& contact, ImpactProgress& at) {
    const double growth = at.direction.dot(contact.slip_rate(at.direction));
    const double to_stop = growth < 0.0 ? -at.speed / growth : endless;
    add_piece(contact, at, -contact.friction * at.direction, contact.normal_rate(at.direction), to_stop);
    at.speed = 0.0;
}

void go_on_from_rest(const ContactTerms& contact, ImpactProgress& at) {
    const Eigen::Vector2d hold = solve(contact.tangential, contact.coupling);
    if (hold.norm() <= contact.friction) {
        add_piece(contact, at, -hold, 1.0 - contact.coupling.dot(hold), endless);
        return;
    }
    const Eigen::Vector2d s = resumed_direction(contact);
    add_piece(contact, at, -contact.friction * s, contact.normal_rate(s), endless);
}

void follow_impact(const ContactTerms& contact, ImpactProgress& at) {
    slide_curved(contact, at);
    if (!at.ended && at.speed > 0.0)
        slide_straight(contact, at);
    if (!at.ended)
        go_on_from_rest(contact, at);
}

namespace {

// Root of a function in a bracket: Newton, bisection where Newton leaves the bracket.

struct ValueAndSlope {
    double value, slope;
};

/// f(low) and f(high) have opposite signs, f(high) > 0 if `rising`; accurate to the rounding of f. The
/// bracket shrinks with every evaluation, and 200 of them halve it below the last bit.
template<class Function>
double bracketed_root(Function f, double low, double high, double guess, bool rising) {
    double x = guess > low && guess < high ? guess : 0.5 * (low + high);
    for (int k = 0; k < 200; ++k) {
        const ValueAndSlope at = f(x);
        ((at.value < 0.0) == rising ? low : high) = x;
        double next = x - at.value / at.slope;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (std::abs(next - x) <= 2.0 * std::numeric_limits<double>::epsilon() * std::abs(next))
            return next;
        x = next;
    }
    return x;
}

constexpr int order = SlipSeries::order;
using Coefficients = std::array<double, order + 1>;

constexpr int work_order = SlipSeries::work_order;

constexpr auto reciprocals = [] {
    std::array<double, work_order + 1> one_over{};
    for (int k = 1; k <= work_order; ++k)
        one_over[k] = 1.0 / k;
    return one_over;
}();

template<std::size_t size>
double value(const std::array<double, size>& c, double u) {
    double sum = c[size - 1];
    for (std::size_t k = size - 1; k-- > 0;)
        sum = sum * u + c[k];
    return sum;
}

template<std::size_t size>
ValueAndSlope value_and_slope(const std::array<double, size>& c, double u) {
    double sum = c[size - 1], slope = 0.0;
    for (std::size_t k = size - 1; k-- > 0;) {
        slope = slope * u + sum;
        sum = sum * u + c[k];
    }
    return {sum, slope};
}

/// Inserts the sign changes of f between neighbouring cuts, which must be at most one each.
template<class Function>
int cut_at_roots(Function f, std::array<double, 6>& u, int count) {
    std::array<double, 6> cut{u[0]};
    int found = 1;
    for (int k = 1; k < count; ++k) {
        const double low = f(u[k - 1]).value, high = f(u[k]).value;
        if (low * high < 0.0 && found + (count - k) < 6)
            cut[found++] = bracketed_root(f, u[k - 1], u[k], -1.0, high > 0.0);
        cut[found++] = u[k];
    }
    u = cut;
    return found;
}

} // namespace

SlipSeries::SlipSeries(const ContactTerms& contact, const ImpactProgress& from)
    : contact_(contact), from_(from), wanted_(from.normal.wanted(contact.restitution)) {
    expand();
    const double length = step_length();
    scale_to(length);
    impulse_ = from.speed * length / contact.scale;
    integrate_normal();
    integrate_work();
}

/// In tau' = scale tau, so that no power over- or underflows.
void SlipSeries::expand() {
    const double unit = 1.0 / contact_.scale;
    const Eigen::Vector2d q = unit * contact_.coupling;
    const Eigen::Matrix2d drag = unit * contact_.friction * contact_.tangential;
    x_[0] = from_.direction.x(), y_[0] = from_.direction.y(), r_[0] = 1.0;
    for (int k = 1; k <= order; ++k) {
        const double x = x_[k - 1], y = y_[k - 1], r = r_[k - 1];
        x_[k] = (q.x() * r - (drag(0, 0) * x + drag(0, 1) * y)) * reciprocals[k];
        y_[k] = (q.y() * r - (drag(0, 1) * x + drag(1, 1) * y)) * reciprocals[k];
        double xx = 0.0, yy = 0.0, rr = 0.0; // products of two inner coefficients, each pair once
        for (int i = 1, j = k - 1; i < j; ++i, --j)
            xx += x_[i] * x_[j], yy += y_[i] * y_[j], rr += r_[i] * r_[j];
        if (const int m = k / 2; k % 2 == 0)
            xx += 0.5 * x_[m] * x_[m], yy += 0.5 * y_[m] * y_[m], rr += 0.5 * r_[m] * r_[m];
        r_[k] = x_[0] * x_[k] + y_[0] * y_[k] + (xx + yy - rr);
    }
}

namespace {

/// Less than the binary logarithm by up to 0.09: a straight line from one power of two to the next.
double rough_log2(double x) { return 0x1p-52 * static_cast<double>(std::bit_cast<std::int64_t>(x)) - 1023.0; }

} // namespace

/// So long, or up to 0.5 % less, that the last terms are below rounding or, of slow slip, below the contact's
/// tolerance.
double SlipSeries::step_length() const {
    const double remainder = std::clamp(0.01 * contact_.tolerance / from_.speed, 1e-17, 1e-3);
    const auto limit = [&](int k) {
        const double size = std::max({std::abs(x_[k]), std::abs(y_[k]), std::abs(r_[k]), 1e-280});
        return rough_log2(remainder / size) / k;
    };
    return repeatable::exp(std::numbers::ln2 * std::min(limit(order), limit(order - 1)));
}

void SlipSeries::scale_to(double length) {
    double power = length;
    for (int k = 1; k <= order; ++k, power *= length)
        x_[k] *= power, y_[k] *= power, r_[k] *= power;
}

void SlipSeries::integrate_normal() {
    const Eigen::Vector2d pull = contact_.friction * contact_.coupling;
    v_[0] = from_.normal.velocity;
    for (int k = 1; k <= order; ++k)
        v_[k] = impulse_ * (r_[k - 1] - (pull.x() * x_[k - 1] + pull.y() * y_[k - 1])) * reciprocals[k];
}

void SlipSeries::integrate_work() {
    // This multiplies the series r and v_z; zeros on both sides of v_z stand for terms that it does not have.
    std::array<double, order + product_lanes> v{};
    std::array<double, product_lanes> product;
    std::ranges::copy(v_, v.begin() + order);
    series_product(r_.data(), order, v.data() + order, product.data());
    w_[0] = 0.0;
    for (int k = 1; k <= work_order; ++k)
        w_[k] = impulse_ * product[k - 1] * reciprocals[k];
}

/// 0, 1, and what lies between of the extrema of v_z: only friction that can pull the bodies together
/// (mu |q| > 1) lets v_z fall. dv_z/dp = 1 - mu q.s is monotone between the directions with q.t = 0.
int SlipSeries::cuts(std::array<double, 6>& u) const {
    u[0] = 0.0, u[1] = 1.0;
    const Eigen::Vector2d q = contact_.friction * contact_.coupling;
    if (q.squaredNorm() < 1.0)
        return 2;
    const auto across = [&](double at) {
        const ValueAndSlope x = value_and_slope(x_, at), y = value_and_slope(y_, at);
        return ValueAndSlope{q.y() * x.value - q.x() * y.value, q.y() * x.slope - q.x() * y.slope};
    };
    const auto rate = [&](double at) {
        const ValueAndSlope x = value_and_slope(x_, at), y = value_and_slope(y_, at),
                            r = value_and_slope(r_, at);
        return ValueAndSlope{r.value - q.x() * x.value - q.y() * y.value,
                             r.slope - q.x() * x.slope - q.y() * y.slope};
    };
    return cut_at_roots(rate, u, cut_at_roots(across, u, 2));
}

/// v_z is monotone between low and high, so v_z and W - wanted have at most one root each there.
SlipSeries::Stop SlipSeries::stop_between(double low, double high) const {
    const auto velocity = [this](double u) { return value_and_slope(v_, u); };
    const auto work = [this](double u) {
        const ValueAndSlope w = value_and_slope(w_, u);
        return ValueAndSlope{w.value - wanted_, w.slope};
    };
    const double before = value(v_, low), after = value(v_, high);
    if (before < 0.0)
        return after < 0.0 ? Stop{}
                           : Stop{bracketed_root(velocity, low, high, -v_[0] / v_[1], true), true, false};
    const double last = after < 0.0 ? bracketed_root(velocity, low, high, -1.0, false) : high;
    if (value(w_, last) < wanted_)
        return {};
    // As if dv_z/dp were constant; good where the step is long against what is left.
    const double square = v_[0] * v_[0] + 2.0 * v_[1] / impulse_ * wanted_;
    const double guess = 2.0 * wanted_ / (impulse_ * (v_[0] + std::sqrt(std::max(square, 0.0))));
    return {bracketed_root(work, low, last, guess, true), false, true};
}

SlipSeries::Stop SlipSeries::stop() const {
    std::array<double, 6> u{};
    const int count = cuts(u);
    for (int k = 1; k < count; ++k)
        if (const Stop found = stop_between(u[k - 1], u[k]); found.turned || found.ended)
            return found;
    return {};
}

void SlipSeries::advance(ImpactProgress& at, const Stop& stop) const {
    const double u = stop.u;
    double x = x_[order], y = y_[order], px = 0.0, py = 0.0, p = 0.0; // v_t, and integrals of v_t and r
    for (int k = order; k-- > 0;) {
        px = (px + x_[k] * reciprocals[k + 1]) * u, py = (py + y_[k] * reciprocals[k + 1]) * u;
        p = (p + r_[k] * reciprocals[k + 1]) * u;
        x = x * u + x_[k], y = y * u + y_[k];
    }
    const double r = std::sqrt(x * x + y * y);
    at.tangential_impulse -= contact_.friction * impulse_ * Eigen::Vector2d(px, py);
    at.normal_impulse += impulse_ * p;
    at.normal.regained += value(w_, u);
    at.normal.velocity = value(v_, u);
    if (stop.turned)
        at.normal.turn();
    at.direction = Eigen::Vector2d(x, y) / r;
    at.speed *= r;
    at.ended = stop.ended || (stop.turned && at.normal.wanted(contact_.restitution) <= 0.0);
}

} // namespace rodwake::granular

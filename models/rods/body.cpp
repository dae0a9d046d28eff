#include "rodwake/rods/body.hpp"

#include "interaction.hpp"
#include "sweep.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace rodwake::rods {

std::optional<BodyFault> fault_of(const BodyShape& shape) {
    constexpr std::size_t most = 1000;
    constexpr double rounding = 1e-9; // two ways to write one number
    const double back = 0.5 * shape.thick_diameter, front = 0.5 * shape.thin_diameter;
    if (shape.spheres < 1 || shape.spheres > most || shape.spheres == 2)
        return BodyFault{"spheres",
                         fmt::format("is {}: must be 1 or 3 to {}; two leave the rod's centre bare, "
                                     "where its wake is singular",
                                     shape.spheres, most)};
    if (!(back > 0.0 && std::isfinite(back)))
        return BodyFault{"thick_diameter",
                         fmt::format("is {}: must be > 0 and finite", shape.thick_diameter)};
    if (!(front > 0.0 && front <= back))
        return BodyFault{"thin_diameter", fmt::format("is {}: must be > 0 and at most thick_diameter = {}",
                                                      shape.thin_diameter, shape.thick_diameter)};
    if (shape.spheres == 1) {
        const bool disc = std::abs(shape.length - shape.thick_diameter) <= rounding * shape.length &&
                          std::abs(shape.length - shape.thin_diameter) <= rounding * shape.length;
        if (disc)
            return std::nullopt;
        return BodyFault{"spheres",
                         fmt::format("is 1: one disc needs length = thick_diameter = thin_diameter, "
                                     "but they are {}, {} and {}",
                                     shape.length, shape.thick_diameter, shape.thin_diameter)};
    }
    if (!(shape.length > back + front && std::isfinite(shape.length)))
        return BodyFault{"length", fmt::format("is {}: must be finite and above {}, the radii of both ends",
                                               shape.length, back + front)};
    // The thinnest neighbours are the first to part. A centre between two discs is half a spacing from each.
    const auto gaps = static_cast<double>(shape.spheres - 1);
    const double spacing = (shape.length - back - front) / gaps;
    const double touching = 2.0 * front + (back - front) / gaps;
    if (!(spacing < touching))
        return BodyFault{"spheres", fmt::format("is {}: leaves gaps in the row; its thinnest neighbours are "
                                                "{:.6g} apart and must be less than {:.6g}: use more spheres",
                                                shape.spheres, spacing, touching)};
    return std::nullopt;
}

/// BodyDisc k of rod a and disc m of rod b, which overlap: the force on the former, its derivative by the
/// place of the former, and the lever arms. Forces times M.
struct BodyForces::Touch {
    std::size_t a, b;
    double along_a, along_b;
    double force_x, force_y;
    double xx, xy, yy;
};

BodyForces::BodyForces(const RodBodies& bodies, std::size_t rods, Box box) : bodies_(bodies), box_(box) {
    if (!bodies.any())
        return;
    if (bodies.shapes.size() != 1 && bodies.shapes.size() != rods)
        throw InputError(fmt::format("{} bodies for {} rods: give one for all or one for each",
                                     bodies.shapes.size(), rods));
    if (!(bodies.stall_overlap >= 1e-4 && bodies.stall_overlap <= 0.5))
        throw InputError(fmt::format("stall_overlap = {}: must be 1e-4 to 0.5", bodies.stall_overlap));
    if (!(bodies.mobility_ratio > 0.0 && std::isfinite(bodies.mobility_ratio)))
        throw InputError(fmt::format("mobility_ratio = {}: must be > 0 and finite", bodies.mobility_ratio));
    double longest = 0.0;
    for (const BodyShape& shape : bodies.shapes) {
        if (const auto fault = fault_of(shape))
            throw InputError(fmt::format("{} {}", fault->option, fault->message));
        const double back = 0.5 * shape.thick_diameter, front = 0.5 * shape.thin_diameter;
        const double row = shape.length - back - front;
        const auto gaps = static_cast<double>(std::max<std::size_t>(shape.spheres - 1, 1));
        DiscRow discs{{},
                      shape.spheres > 1 ? 0.5 * row : 0.0,
                      row / gaps,
                      shape.spheres > 1 ? (front - back) / row : 0.0};
        for (std::size_t k = 0; k < shape.spheres; ++k) {
            const double u = shape.spheres > 1 ? static_cast<double>(k) / gaps : 0.5;
            discs.discs.push_back({(u - 0.5) * row, back + u * (front - back)});
            const BodyDisc& disc = discs.discs.back();
            thinnest_ = thinnest_ == 0.0 ? disc.radius : std::min(thinnest_, disc.radius);
            reach_ = std::max(reach_, std::abs(disc.along) + disc.radius);
        }
        longest = std::max(longest, shape.length);
        rows_.push_back(std::move(discs));
    }
    if (box && !(box->shorter() > 2.0 * longest))
        throw InputError(
            fmt::format("box = {}: its sides must exceed {}, twice the length of the longest rod",
                        to_string(*box), 2.0 * longest));
    strength_ = std::pow(bodies.stall_overlap, -1.5);
}

const BodyForces::DiscRow& BodyForces::row_of(std::size_t rod) const {
    return rows_[rows_.size() == 1 ? 0 : rod];
}

/// Calls see(a, b, d), a < b, once for each pair of rods whose centres are nearer than `range`; d is the
/// offset of a from b.
template<class See>
void BodyForces::each_near(integrate::State y, double range, See&& see) const {
    const std::size_t rods = y.size() / 3;
    const auto look = [&](std::size_t a, std::size_t b) {
        const Offset d = offset(y, a, b, box_);
        if (d.x * d.x + d.y * d.y < range * range)
            see(a, b, d);
    };
    constexpr std::size_t few = 16; // cells do not pay below
    if (rods <= few || !std::ranges::all_of(y, [](double value) { return std::isfinite(value); })) {
        for (std::size_t a = 0; a < rods; ++a)
            for (std::size_t b = a + 1; b < rods; ++b)
                look(a, b);
        return;
    }
    std::array<std::vector<double>, 2> at;
    std::array<double, 2> sides{};
    for (std::size_t axis : {0, 1}) {
        for (std::size_t a = 0; a < rods; ++a)
            at[axis].push_back(y[3 * a + axis]);
        const auto [low, high] = std::ranges::minmax(at[axis]);
        sides[axis] = high - low + 2.0 * range; // on the plane nobody is near round the end
    }
    const CellList cells(at[0], at[1], box_ ? *box_ : PeriodicBox(sides[0], sides[1]), range);
    cells.pairs([&](std::size_t p, std::size_t q) {
        const auto [a, b] = std::minmax(cells.member()[p], cells.member()[q]);
        look(a, b);
    });
}

/// Two rods, as rod b sees them: disc k of rod a is at (u + along_k c, v + along_k w), rod b on the axis u.
struct BodyForces::Facing {
    const DiscRow &of_a, &of_b;
    Offset d;
    Direction na, nb;
    double u = d.x * nb.cosine + d.y * nb.sine, v = d.y * nb.cosine - d.x * nb.sine;
    double c = na.cosine * nb.cosine + na.sine * nb.sine, w = na.sine * nb.cosine - na.cosine * nb.sine;

    /// The gap is at least this: of all points of one row from the line through the other.
    double least_gap() const {
        const double other_v = std::abs(d.y * na.cosine - d.x * na.sine), turned = std::abs(w);
        return std::max({std::abs(v) - of_a.half * turned, other_v - of_b.half * turned,
                         std::hypot(d.x, d.y) - of_a.half - of_b.half}) -
               of_a.thickest() - of_b.thickest();
    }
    /// The discs of b around the places `from` to `to` of its axis, the one before and after included.
    std::pair<std::size_t, std::size_t> discs_around(double from, double to) const {
        const auto last = static_cast<double>(of_b.discs.size() - 1);
        if (last == 0.0)
            return {0, 0};
        constexpr double rounding = 1e-6; // of a spacing
        const double first = std::floor((from + of_b.half) / of_b.spacing - rounding),
                     end = std::ceil((to + of_b.half) / of_b.spacing + rounding);
        const auto index = [&](double at) {
            return static_cast<std::size_t>(std::max(0.0, std::min(last, at)));
        };
        return {index(first), index(end)};
    }
};

BodyForces::Facing BodyForces::facing(integrate::State y, std::size_t a, std::size_t b, Offset d) const {
    return {row_of(a), row_of(b), d, direction(y, a), direction(y, b)};
}

/// Calls use(touch) for all overlapping discs of two rods. Of each disc of the first only those discs of the
/// second are looked at whose centres are near enough for the thickest of them.
template<class Use>
void BodyForces::each_touch(integrate::State y, Use&& use) const {
    each_near(y, farthest_touch(), [&](std::size_t a, std::size_t b, Offset d) {
        const Facing pair = facing(y, a, b, d);
        if (pair.least_gap() > 0.0)
            return;
        const auto& [of_a, of_b, offset, na, nb, u, v, c, w] = pair;
        for (const BodyDisc& k : of_a.discs) {
            const double aside = v + k.along * w, widest = k.radius + of_b.thickest();
            if (!(std::abs(aside) <= widest))
                continue;
            const double along = u + k.along * c, room = std::sqrt(widest * widest - aside * aside);
            const auto [first, last] = pair.discs_around(along - room, along + room);
            for (std::size_t i = first; i <= last; ++i) {
                const BodyDisc& m = of_b.discs[i];
                const double dx = d.x + k.along * na.cosine - m.along * nb.cosine,
                             dy = d.y + k.along * na.sine - m.along * nb.sine;
                const double touching = k.radius + m.radius, square = dx * dx + dy * dy;
                if (square >= touching * touching || square == 0.0)
                    continue;
                const double r = std::sqrt(square), overlap = 1.0 - r / touching, root = std::sqrt(overlap);
                const double force = strength_ * overlap * root, ux = dx / r, uy = dy / r;
                // The force falls along the line of centres and turns with it.
                const double fall = -1.5 * strength_ * root / touching, turn = force / r;
                use(Touch{a, b, k.along, m.along, force * ux, force * uy, fall * ux * ux + turn * uy * uy,
                          (fall - turn) * ux * uy, fall * uy * uy + turn * ux * ux});
            }
        }
    });
}

void BodyForces::add_rates(integrate::State y, std::span<double> ydot) const {
    if (!any())
        return;
    const double across = bodies_.mobility_ratio;
    const auto push = [&](std::size_t rod, double along, double fx, double fy) {
        const auto [c, s] = direction(y, rod);
        const double ahead = c * fx + s * fy, aside = c * fy - s * fx, length = bodies_.of(rod).length;
        ydot[3 * rod] += ahead * c - across * aside * s;
        ydot[3 * rod + 1] += ahead * s + across * aside * c;
        ydot[3 * rod + 2] += 12.0 / (length * length) * along * aside;
    };
    each_touch(y, [&](const Touch& t) {
        push(t.a, t.along_a, t.force_x, t.force_y);
        push(t.b, t.along_b, -t.force_x, -t.force_y);
    });
}

void BodyForces::add_jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const {
    if (!any())
        return;
    const double b = bodies_.mobility_ratio;
    each_touch(y, [&](const Touch& t) {
        const auto row = [](std::size_t rod) { return static_cast<Eigen::Index>(3 * rod); };
        const Direction n[] = {direction(y, t.a), direction(y, t.b)};
        const double along[] = {t.along_a, t.along_b};
        const std::size_t rods[] = {t.a, t.b};
        // The force on the disc of rod a by the poses of both rods.
        Eigen::Matrix<double, 2, 6> by_pose;
        Eigen::Matrix2d by_place;
        by_place << t.xx, t.xy, t.xy, t.yy;
        for (Eigen::Index side = 0; side < 2; ++side) {
            const Eigen::Vector2d aside(-n[side].sine, n[side].cosine);
            const double sign = side == 0 ? 1.0 : -1.0;
            by_pose.middleCols<2>(3 * side) = sign * by_place;
            by_pose.col(3 * side + 2) = sign * along[side] * by_place * aside;
        }
        for (Eigen::Index side = 0; side < 2; ++side) {
            const Eigen::Vector2d ahead(n[side].cosine, n[side].sine), aside(-ahead.y(), ahead.x());
            const double sign = side == 0 ? 1.0 : -1.0, length = bodies_.of(rods[side]).length;
            const double arm = 12.0 / (length * length) * along[side];
            const Eigen::Vector2d force = sign * Eigen::Vector2d(t.force_x, t.force_y);
            Eigen::Matrix<double, 3, 2> response; // of the rates to the force
            response.topRows<2>() = ahead * ahead.transpose() + b * aside * aside.transpose();
            response.row(2) = arm * aside.transpose();
            const Eigen::Matrix<double, 3, 6> block = sign * response * by_pose;
            const Eigen::Index r = row(rods[side]);
            jacobian.block<3, 3>(r, row(t.a)) += block.leftCols<3>();
            jacobian.block<3, 3>(r, row(t.b)) += block.rightCols<3>();
            // The response turns with the rod.
            jacobian.block<2, 1>(r, r + 2) +=
                (1.0 - b) * (aside * ahead.dot(force) + ahead * aside.dot(force));
            jacobian(r + 2, r + 2) -= arm * ahead.dot(force);
        }
    });
}

BodyContact BodyForces::contact(integrate::State y, std::size_t a, std::size_t b) const {
    return contact(a, b, facing(y, a, b, offset(y, a, b, box_)));
}

/// Along rod b both the gap to a disc of rod a, a convex function, and the overlap have one extreme. With r
/// the slope of the radii, R + r x the sum of both at x and (u, v) the place of the disc:
///
///   gap      x = u + r |v|/sqrt(1 - r^2),   overlap  x = u + r v^2/(R + r u)
///
/// and the discs before and after x have it. Where the slope leaves none the thick end has it.
BodyContact BodyForces::contact(std::size_t a, std::size_t b, const Facing& pair) const {
    BodyContact contact{a, b, std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
    const DiscRow& of_b = pair.of_b;
    const double slope = of_b.slope, middle = of_b.thickest() + slope * of_b.half;
    for (const BodyDisc& k : pair.of_a.discs) {
        const double u = pair.u + k.along * pair.c, v = pair.v + k.along * pair.w;
        const double ahead = k.radius + middle + slope * u;
        const double extremes[] = {slope > -1.0 ? u + slope * std::abs(v) / std::sqrt(1.0 - slope * slope)
                                                : -of_b.half,
                                   ahead > 0.0 ? u + slope * v * v / ahead : -of_b.half};
        for (const double x : extremes) {
            const auto [first, last] = pair.discs_around(x, x);
            for (std::size_t i = first; i <= last; ++i) {
                const BodyDisc& m = of_b.discs[i];
                const double apart = std::hypot(u - m.along, v), touching = k.radius + m.radius;
                contact.gap = std::min(contact.gap, apart - touching);
                contact.overlap = std::max(contact.overlap, 1.0 - apart / touching);
            }
        }
    }
    return contact;
}

std::vector<BodyContact> BodyForces::contacts(integrate::State y, double reach) const {
    std::vector<BodyContact> found;
    each_near(y, farthest_touch() + reach, [&](std::size_t a, std::size_t b, Offset d) {
        const Facing pair = facing(y, a, b, d);
        if (pair.least_gap() >= reach)
            return;
        const BodyContact near = contact(a, b, pair);
        if (near.gap < reach)
            found.push_back(near);
    });
    std::sort(found.begin(), found.end(), [](const BodyContact& one, const BodyContact& other) {
        return std::pair(one.first, one.second) < std::pair(other.first, other.second);
    });
    return found;
}

BodyContact BodyForces::closest(integrate::State y) const {
    BodyContact best = contact(y, 0, 1);
    const auto see = [&](std::size_t a, std::size_t b, Offset d) {
        const Facing pair = facing(y, a, b, d);
        if (pair.least_gap() > best.gap)
            return;
        const BodyContact near = contact(a, b, pair);
        if (std::tuple(near.gap, a, b) < std::tuple(best.gap, best.first, best.second))
            best = near;
    };
    each_near(y, farthest_touch(), see);
    if (best.gap > 0.0) // else no pair farther apart comes nearer
        Sweep(y, box_).pairs([&](double gap) { return gap > farthest_touch() + best.gap; },
                             [&](std::size_t a, std::size_t b) { see(a, b, offset(y, a, b, box_)); });
    return best;
}

double BodyForces::step_limit(integrate::State y, double share) const {
    constexpr double slowest = 0.5, look_ahead = 1.0; // of time: a longer step needs no limit from bodies
    double limit = look_ahead;
    const auto see = [&](std::size_t a, std::size_t b, Offset d) {
        const double speed = std::max(2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2]))), slowest);
        const auto limit_at = [&](double gap) { return (0.5 * gap + share * thinnest_) / speed; };
        const Facing pair = facing(y, a, b, d);
        if (limit_at(pair.least_gap()) >= limit)
            return;
        if (const double gap = contact(a, b, pair).gap; gap > 0.0) // else the right-hand side sees it already
            limit = std::min(limit, limit_at(gap));
    };
    // No relative speed is above 2; the nearest leave little for those farther away.
    each_near(y, farthest_touch(), see);
    each_near(y, farthest_touch() + 4.0 * limit, see);
    return limit;
}

double BodyForces::relaxation_rate(integrate::State y) const {
    std::vector<double> rates(y.size() / 3);
    each_touch(y, [&](const Touch& t) {
        const double stiffest = std::max(std::abs(t.xx) + std::abs(t.xy), std::abs(t.yy) + std::abs(t.xy));
        const auto add = [&](std::size_t rod, double along) {
            const double arm = along / bodies_.of(rod).length;
            rates[rod] += 2.0 * stiffest * (std::max(1.0, bodies_.mobility_ratio) + 12.0 * arm * arm);
        };
        add(t.a, t.along_a);
        add(t.b, t.along_b);
    });
    return rates.empty() ? 0.0 : *std::max_element(rates.begin(), rates.end());
}

} // namespace rodwake::rods

#include "rodwake/rods/body.hpp"

#include "interaction.hpp"
#include "sweep.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
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
        std::vector<BodyDisc> discs;
        for (std::size_t k = 0; k < shape.spheres; ++k) {
            const double u =
                shape.spheres > 1 ? static_cast<double>(k) / static_cast<double>(shape.spheres - 1) : 0.5;
            discs.push_back({(u - 0.5) * row, back + u * (front - back)});
            thinnest_ = thinnest_ == 0.0 ? discs.back().radius : std::min(thinnest_, discs.back().radius);
            reach_ = std::max(reach_, std::abs(discs.back().along) + discs.back().radius);
        }
        longest = std::max(longest, shape.length);
        discs_.push_back(std::move(discs));
    }
    if (box && !(box->shorter() > 2.0 * longest))
        throw InputError(
            fmt::format("box = {}: its sides must exceed {}, twice the length of the longest rod",
                        to_string(*box), 2.0 * longest));
    strength_ = std::pow(bodies.stall_overlap, -1.5);
}

std::span<const BodyForces::BodyDisc> BodyForces::discs_of(std::size_t rod) const {
    return discs_[discs_.size() == 1 ? 0 : rod];
}

/// Calls use(touch) for all overlapping discs of two rods. Rods farther apart than their reach are left out.
template<class Use>
void BodyForces::each_touch(integrate::State y, Use&& use) const {
    const double farthest = 2.0 * reach_;
    const auto pair = [&](std::size_t a, std::size_t b) {
        const Offset d = offset(y, a, b, box_);
        if (d.x * d.x + d.y * d.y >= farthest * farthest)
            return;
        const Direction na = direction(y, a), nb = direction(y, b);
        for (const BodyDisc& k : discs_of(a))
            for (const BodyDisc& m : discs_of(b)) {
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
    };
    // A pair may be seen twice: when it comes up again it must be as if it had not.
    std::vector<std::pair<std::size_t, std::size_t>> near;
    const std::size_t rods = y.size() / 3;
    if (rods <= 2) {
        if (rods == 2)
            pair(0, 1);
        return;
    }
    Sweep(y, box_).pairs([&](double gap) { return gap >= farthest; },
                         [&](std::size_t a, std::size_t b) { near.emplace_back(a, b); });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const auto& [a, b] : near)
        pair(a, b);
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
    const Offset d = offset(y, a, b, box_);
    const Direction na = direction(y, a), nb = direction(y, b);
    BodyContact contact{a, b, std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
    for (const BodyDisc& k : discs_of(a))
        for (const BodyDisc& m : discs_of(b)) {
            const double apart = std::hypot(d.x + k.along * na.cosine - m.along * nb.cosine,
                                            d.y + k.along * na.sine - m.along * nb.sine);
            const double touching = k.radius + m.radius;
            contact.gap = std::min(contact.gap, apart - touching);
            contact.overlap = std::max(contact.overlap, 1.0 - apart / touching);
        }
    return contact;
}

std::vector<BodyContact> BodyForces::contacts(integrate::State y, double reach) const {
    std::vector<BodyContact> found;
    Sweep(y, box_).pairs([&](double gap) { return gap >= farthest_touch() + reach; },
                         [&](std::size_t a, std::size_t b) {
                             const Offset d = offset(y, a, b, box_);
                             if (std::hypot(d.x, d.y) >= farthest_touch() + reach)
                                 return;
                             const BodyContact pair = contact(y, a, b);
                             if (pair.gap < reach)
                                 found.push_back(pair);
                         });
    const auto pair_of = [](const BodyContact& one) { return std::pair(one.first, one.second); };
    std::sort(found.begin(), found.end(),
              [&](const BodyContact& a, const BodyContact& b) { return pair_of(a) < pair_of(b); });
    found.erase(
        std::unique(found.begin(), found.end(),
                    [&](const BodyContact& a, const BodyContact& b) { return pair_of(a) == pair_of(b); }),
        found.end());
    return found;
}

BodyContact BodyForces::closest(integrate::State y) const {
    BodyContact best = contact(y, 0, 1);
    Sweep(y, box_).pairs([&](double gap) { return gap > farthest_touch() + best.gap; },
                         [&](std::size_t a, std::size_t b) {
                             const Offset d = offset(y, a, b, box_);
                             if (std::hypot(d.x, d.y) > farthest_touch() + best.gap)
                                 return;
                             const BodyContact pair = contact(y, a, b);
                             if (std::tuple(pair.gap, a, b) < std::tuple(best.gap, best.first, best.second))
                                 best = pair;
                         });
    return best;
}

double BodyForces::step_limit(integrate::State y, double share) const {
    constexpr double slowest = 0.5, look_ahead = 1.0; // of time: a longer step needs no limit from bodies
    double limit = std::numeric_limits<double>::infinity();
    for (const BodyContact& pair : contacts(y, 4.0 * look_ahead)) {
        if (pair.gap <= 0.0) // the right-hand side sees it already
            continue;
        const double speed = 2.0 * std::abs(std::sin(0.5 * (y[3 * pair.first + 2] - y[3 * pair.second + 2])));
        limit = std::min(limit, (0.5 * pair.gap + share * thinnest_) / std::max(speed, slowest));
    }
    return std::min(limit, look_ahead);
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

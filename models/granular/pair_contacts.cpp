#include "pair_contacts.hpp"

#include "bodies.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

using Eigen::Matrix3d;

constexpr int most_sweeps = 8; // while a pair is deeper than `deep`

/// Where two spheres touch, in the middle of their overlap: normal, and arms from the centres of their
/// bodies.
struct Touch {
    Vector3 n, arm1, arm2;
    double lever; ///< from the first sphere's centre along -n
};

/// r: from the second sphere's centre to the first's; offsets: of the spheres' centres from those of their
/// bodies.
Touch touch(const Vector3& r, double radius1, double radius2, const Vector3& offset1,
            const Vector3& offset2) {
    const double distance = r.norm(), overlap = radius1 + radius2 - distance;
    const Vector3 n = r / distance;
    const double lever = radius1 - overlap / 2.0;
    return {n, offset1 - lever * n, offset2 + (radius2 - overlap / 2.0) * n, lever};
}

/// Adds what an impulse P on the first of two bodies carries over r, from the second's centre to the first's.
void add_virial(PlaneTensor& virial, const Vector3& r, const Vector3& P) {
    virial[0] += r.x() * P.x();
    virial[1] += (r.x() * P.y() + r.y() * P.x()) / 2.0;
    virial[2] += r.y() * P.y();
}

HWY_INLINE void fetch_ahead(const Bodies& bodies, std::span<const Pair> pairs, std::size_t k) {
    const Pair& later = pairs[std::min(k + fetched_ahead, pairs.size() - 1)];
    bodies.fetch(later.first);
    bodies.fetch(later.second);
}

/// Earlier, or as early and deeper.
bool first(double back, double length, double other_back, double other_length) {
    return back > other_back || (back == other_back && length < other_length);
}

} // namespace

Vector3 PairContacts::apart(const Bodies& bodies, const Pair& pair) const {
    Vector3 r = row(bodies.position, pair.first) - row(bodies.position, pair.second);
    r.x() = nearest_image_rounded(r.x(), setting_.box.x);
    r.y() = nearest_image_rounded(r.y(), setting_.box.y);
    return r;
}

template<bool equal>
std::optional<PairContacts::TouchingPair> PairContacts::meeting(const Bodies& bodies, const Pair& pair,
                                                                WorstOverlap& worst) const {
    const Vector3 r = apart(bodies, pair);
    const double one = bodies.radius_of<equal>(pair.first), two = bodies.radius_of<equal>(pair.second),
                 reach = one + two, distance = r.norm();
    if (!(distance < reach)) // an impulse before took them apart
        return {};
    const double radii = (reach - distance) / std::min(one, two);
    if (radii > worst.radii)
        worst = {radii, pair};
    const Vector3 v = bodies.velocity_of(pair.first) - bodies.velocity_of(pair.second);
    const double along = r.dot(v), speed2 = v.squaredNorm();
    const double excess = (reach - distance) * (reach + distance);
    const double root = std::sqrt(along * along + speed2 * excess);
    const double back = along < 0.0 ? excess / (root - along) : (along + root) / speed2;
    if (back <= setting_.time_step)
        return TouchingPair{pair, back, reach};
    return along < 0.0 ? std::optional(TouchingPair{pair, 0.0, distance}) : std::nullopt;
}

template<bool equal>
void PairContacts::bead_bead(Bodies& bodies, const TouchingPair& meeting, PlaneTensor& virial) const {
    if constexpr (!equal)
        return unequal_beads(bodies, meeting, virial);
    const auto [one, two] = meeting.pair;
    auto v1 = row(bodies.velocity, one), v2 = row(bodies.velocity, two);
    const Vector3 difference = v1 - v2;
    const Vector3 n = (apart(bodies, meeting.pair) - meeting.back * difference) / meeting.length;
    // both touch at the middle of what overlap is left
    const double approach = n.dot(difference), arm = meeting.length / 2.0;
    const Vector3 spin = row(bodies.spin, one) + row(bodies.spin, two);
    const Vector3 relative = difference - arm * spin.cross(n);
    const double k_n = 2.0 / bodies.bead_mass, k_t = k_n + 2.0 * arm * arm / bodies.bead_inertia;
    const Vector3 impulse = uncoupled_along(n, relative, approach, k_t, k_n, setting_.table.bead_bead);
    const Vector3 change = impulse / bodies.bead_mass;
    v1 += change;
    v2 -= change;
    row(bodies.position, one) += meeting.back * change;
    row(bodies.position, two) -= meeting.back * change;
    const Vector3 turn =
        (-arm / bodies.bead_inertia) * n.cross(impulse); // arms -arm n and +arm n, impulses P and -P
    row(bodies.spin, one) += turn;
    row(bodies.spin, two) += turn;
    add_virial(virial, meeting.length * n, impulse);
}

/// As bead_bead, of beads that differ in size.
void PairContacts::unequal_beads(Bodies& bodies, const TouchingPair& meeting, PlaneTensor& virial) const {
    const auto [one, two] = meeting.pair;
    auto v1 = row(bodies.velocity, one), v2 = row(bodies.velocity, two), w1 = row(bodies.spin, one),
         w2 = row(bodies.spin, two);
    const double radius1 = bodies.radius_of_bead(one), radius2 = bodies.radius_of_bead(two),
                 half_overlap = (radius1 + radius2 - meeting.length) / 2.0, arm1 = radius1 - half_overlap,
                 arm2 = radius2 - half_overlap;
    const double per_mass1 = 1.0 / bodies.mass_of_bead(one), per_mass2 = 1.0 / bodies.mass_of_bead(two),
                 turning1 = arm1 / bodies.inertia_of_bead(one), turning2 = arm2 / bodies.inertia_of_bead(two);
    // The contact is at -arm1 n from the first centre and at arm2 n from the second.
    const Vector3 difference = v1 - v2;
    const Vector3 n = (apart(bodies, meeting.pair) - meeting.back * difference) / meeting.length;
    const double approach = n.dot(difference), k_n = per_mass1 + per_mass2,
                 k_t = k_n + arm1 * turning1 + arm2 * turning2;
    const Vector3 turning = arm1 * w1 + arm2 * w2;
    const Vector3 relative = difference - turning.cross(n);
    const Vector3 impulse = uncoupled_along(n, relative, approach, k_t, k_n, setting_.table.bead_bead);
    // Both have flown on since the touch, with the velocities that they get now.
    const Vector3 change1 = per_mass1 * impulse, change2 = per_mass2 * impulse;
    v1 += change1;
    v2 -= change2;
    row(bodies.position, one) += meeting.back * change1;
    row(bodies.position, two) -= meeting.back * change2;
    const Vector3 turn = n.cross(impulse);
    w1 -= turning1 * turn;
    w2 -= turning2 * turn;
    add_virial(virial, meeting.length * n, impulse);
}

void PairContacts::bead_rod(Bodies& bodies, const TouchingPair& meeting, Counters& tallies) const {
    const auto [bead, sphere] = meeting.pair;
    const std::uint32_t index = bodies.rod_of[sphere - bodies.beads];
    MovingRod& rod = bodies.rods[index];
    const auto fly_both = [&, bead = bead](double time) {
        auto x = row(bodies.position, bead), v = row(bodies.velocity, bead);
        x += v * time;
        x.z() -= setting_.gravity * time * time / 2.0;
        v.z() -= setting_.gravity * time;
        rod.move(time, setting_.gravity);
        bodies.place_rod_spheres(index);
    };
    fly_both(-meeting.back);
    const auto [n, arm1, arm2, lever] = touch(apart(bodies, meeting.pair), bodies.radius_of_bead(bead),
                                              bodies.radius[sphere], Vector3::Zero(), bodies.arm_of(sphere));
    const Vector3 spin = row(bodies.spin, bead);
    const Vector3 relative = row(bodies.velocity, bead) + spin.cross(arm1) - rod.velocity_at(arm2);
    if (relative.dot(n) < 0.0) {
        const double mass = bodies.mass_of_bead(bead), inertia = bodies.inertia_of_bead(bead);
        const Matrix3d along = n * n.transpose();
        const Matrix3d of_bead =
            Matrix3d::Identity() / mass + (Matrix3d::Identity() - along) * (lever * lever / inertia);
        const Matrix3d inverse_mass = of_bead + rod.inverse_mass_at(arm2);
        const Vector3 impulse = impulse_along(n, inverse_mass, relative, setting_.table.bead_rod);
        row(bodies.velocity, bead) += impulse / mass;
        row(bodies.spin, bead) += arm1.cross(impulse) / inertia;
        rod.push(-impulse, arm2);
        tallies.impulse_on_beads[index] += impulse;
        add_virial(tallies.virial, arm2 - arm1, impulse);
        ++tallies.bead_rod;
    }
    fly_both(meeting.back);
}

void PairContacts::rod_rod(Bodies& bodies, const TouchingPair& meeting, Counters& tallies) const {
    const auto [sphere1, sphere2] = meeting.pair;
    const std::uint32_t first = bodies.rod_of[sphere1 - bodies.beads],
                        second = bodies.rod_of[sphere2 - bodies.beads];
    MovingRod &one = bodies.rods[first], &two = bodies.rods[second];
    const auto fly_both = [&](double time) {
        one.move(time, setting_.gravity);
        two.move(time, setting_.gravity);
        bodies.place_rod_spheres(first);
        bodies.place_rod_spheres(second);
    };
    fly_both(-meeting.back);
    const auto [n, arm1, arm2, lever] =
        touch(apart(bodies, meeting.pair), bodies.radius[sphere1], bodies.radius[sphere2],
              bodies.arm_of(sphere1), bodies.arm_of(sphere2));
    const Vector3 relative = one.velocity_at(arm1) - two.velocity_at(arm2);
    if (relative.dot(n) < 0.0 && !(one.held() && two.held())) {
        const Matrix3d inverse_mass = one.inverse_mass_at(arm1) + two.inverse_mass_at(arm2);
        const Vector3 impulse = impulse_along(n, inverse_mass, relative, setting_.table.rod_rod);
        one.push(impulse, arm1);
        two.push(-impulse, arm2);
        add_virial(tallies.virial, arm2 - arm1, impulse);
        ++tallies.rod_rod;
    }
    fly_both(meeting.back);
}

/// Pairs with both beads below `end`, the first number after the block; the others are left.
template<bool equal>
void PairContacts::within_block(Bodies& bodies, std::span<const Pair> pairs, std::size_t end,
                                ContactBlock& block) const {
    block.left.clear();
    block.worst = {};
    block.impulses = 0;
    block.virial = {};
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Pair pair = pairs[k];
        fetch_ahead(bodies, pairs, k);
        if (pair.second >= end) {
            block.left.push_back(pair);
            continue;
        }
        if (const auto found = meeting<equal>(bodies, pair, block.worst)) {
            bead_bead<equal>(bodies, *found, block.virial);
            ++block.impulses;
        }
    }
}

template<bool equal>
void PairContacts::one_by_one(Bodies& bodies, std::span<const Pair> pairs, WorstOverlap& worst,
                              Counters& tallies) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Pair pair = pairs[k];
        fetch_ahead(bodies, pairs, k);
        std::optional<TouchingPair> found = meeting<equal>(bodies, pair, worst);
        if (bodies.is_bead(pair.second)) {
            if (found) {
                bead_bead<equal>(bodies, *found, tallies.virial);
                ++tallies.bead_bead;
            }
            continue;
        }
        if (!bodies.is_bead(pair.first)) {
            if (!found)
                continue;
            // of the contacts of two rods the first is kept
            const std::uint32_t one = bodies.rod_of[pair.first - bodies.beads],
                                two = bodies.rod_of[pair.second - bodies.beads];
            const auto known = std::ranges::find_if(rod_contacts_, [&](const RodContact& c) {
                return c.first_rod == one && c.second_rod == two;
            });
            if (known == rod_contacts_.end())
                rod_contacts_.push_back({one, two, *found});
            else if (first(found->back, found->length, known->meeting.back, known->meeting.length))
                known->meeting = *found;
            continue;
        }
        // the contacts of a bead with the spheres of one rod follow each other
        for (; k + 1 < pairs.size() && pairs[k + 1].first == pair.first &&
               bodies.same_rod(pairs[k + 1].second, pair.second);
             ++k) {
            const auto next = meeting<equal>(bodies, pairs[k + 1], worst);
            if (next && (!found || first(next->back, next->length, found->back, found->length)))
                found = next;
        }
        if (found)
            bead_rod(bodies, *found, tallies);
    }
}

/// Moves spheres that are deeper in each other than `deep` until they are that deep, by `most_moved` at most,
/// rods where there are two of them only; velocities stay. Returns a bound of how far one was moved.
double PairContacts::move_apart(Bodies& bodies, std::span<const Pair> pairs) const {
    double moved = 0.0;
    const auto shift = [&](std::uint32_t sphere, const Vector3& way) {
        if (bodies.is_bead(sphere)) {
            row(bodies.position, sphere) += way;
            return;
        }
        const std::uint32_t rod = bodies.rod_of[sphere - bodies.beads];
        if (!bodies.rods[rod].held())
            bodies.rods[rod].shift(way);
        bodies.place_rod_spheres(rod);
    };
    for (const Pair& pair : pairs) {
        const Vector3 r = apart(bodies, pair);
        const double one = bodies.radius[pair.first], two = bodies.radius[pair.second];
        const double least = std::min(one, two),
                     excess = std::min(one + two - r.norm() - deep * least, most_moved * least);
        if (!(excess > 0.0))
            continue;
        const double share = bodies.is_bead(pair.first) && !bodies.is_bead(pair.second) ? 1.0 : 0.5;
        const Vector3 way = excess * r.normalized();
        shift(pair.first, share * way);
        if (share < 1.0)
            shift(pair.second, -share * way);
        moved += excess;
    }
    return moved;
}

WorstOverlap PairContacts::resolve(Bodies& bodies, std::span<const Pair> overlapping, Counters& tallies,
                                   ThreadPool& team, bool settles) {
    return bodies.equal_beads ? resolve_as<true>(bodies, overlapping, tallies, team, settles)
                              : resolve_as<false>(bodies, overlapping, tallies, team, settles);
}

template<bool equal>
WorstOverlap PairContacts::resolve_as(Bodies& bodies, std::span<const Pair> overlapping, Counters& tallies,
                                      ThreadPool& team, bool settles) {
    tallies.overlaps += static_cast<std::int64_t>(overlapping.size());
    blocks_.resize((bodies.beads + beads_per_block - 1) / beads_per_block);
    const auto first_from = [&](std::size_t bead) {
        return std::ranges::lower_bound(overlapping, bead, {}, &Pair::first);
    };
    team.run(blocks_.size(), [&](std::size_t b) {
        const std::size_t end = std::min(bodies.beads, (b + 1) * beads_per_block);
        within_block<equal>(bodies, {first_from(b * beads_per_block), first_from(end)}, end, blocks_[b]);
    });
    WorstOverlap worst;
    rod_contacts_.clear();
    for (const ContactBlock& block : blocks_) {
        if (block.worst.radii > worst.radii)
            worst = block.worst;
        tallies.bead_bead += block.impulses;
        for (std::size_t k = 0; k < tallies.virial.size(); ++k)
            tallies.virial[k] += block.virial[k];
    }
    for (const ContactBlock& block : blocks_)
        one_by_one<equal>(bodies, block.left, worst, tallies);
    one_by_one<equal>(bodies, {first_from(bodies.beads), overlapping.end()}, worst, tallies);
    for (const RodContact& contact : rod_contacts_)
        rod_rod(bodies, contact.meeting, tallies);
    WorstOverlap left = worst;
    for (int sweep = 1; left.radii > deep && sweep < most_sweeps; ++sweep) {
        left = {};
        rod_contacts_.clear();
        one_by_one<equal>(bodies, overlapping, left, tallies);
        for (const RodContact& contact : rod_contacts_)
            rod_rod(bodies, contact.meeting, tallies);
    }
    if (left.radii > deep && !settles)
        worst.shift = move_apart(bodies, overlapping);
    tallies.max_overlap = std::max(tallies.max_overlap, worst.radii);
    return worst;
}

} // namespace rodwake::granular

#include "pair_contacts.hpp"

#include "bodies.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

using Eigen::Matrix3d;

/// Of a point at distance `arm` from the centre along the normal.
Matrix3d bead_inverse_mass(const Bodies& bodies, const Vector3& normal, double arm) {
    const Matrix3d along = normal * normal.transpose();
    return Matrix3d::Identity() / bodies.bead_mass +
           (Matrix3d::Identity() - along) * (arm * arm / bodies.bead_inertia);
}

void push(Bodies& bodies, std::size_t bead, const Vector3& impulse, const Vector3& arm) {
    row(bodies.velocity, bead) += impulse / bodies.bead_mass;
    row(bodies.spin, bead) += arm.cross(impulse) / bodies.bead_inertia;
}

/// Place in its rod's row of spheres.
std::size_t sphere_of_rod(const Bodies& bodies, std::size_t sphere) {
    std::size_t k = sphere - bodies.beads, first = k;
    while (first > 0 && bodies.rod_of[first - 1] == bodies.rod_of[k])
        --first;
    return k - first;
}

} // namespace

PairContacts::Touch PairContacts::touch(const Bodies& bodies, const Pair& pair) const {
    Vector3 apart = row(bodies.position, pair.first) - row(bodies.position, pair.second);
    for (int k : {0, 1})
        apart[k] = nearest_image_rounded(apart[k], box_);
    const double distance = apart.norm();
    const double depth = bodies.radius[pair.first] + bodies.radius[pair.second] - distance;
    return {distance > 0.0 ? Vector3(apart / distance) : Vector3(Vector3::UnitZ()), depth};
}

void PairContacts::bead_bead(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const {
    auto v1 = row(bodies.velocity, pair.first), v2 = row(bodies.velocity, pair.second);
    const Vector3& n = touch.normal;
    const Vector3 difference = v1 - v2;
    const double approach = n.dot(difference);
    if (!(approach < 0.0))
        return;
    // both touch at the middle of the overlap
    const double arm = bodies.bead_radius - touch.depth / 2.0;
    const Vector3 spin = row(bodies.spin, pair.first) + row(bodies.spin, pair.second);
    const Vector3 relative = difference - arm * spin.cross(n);
    const double k_n = 2.0 / bodies.bead_mass, k_t = k_n + 2.0 * arm * arm / bodies.bead_inertia;
    // the slip frame: the law needs only its size
    const Vector3 slip = relative - approach * n;
    const double speed = slip.norm();
    const Vector3 p = uncoupled_impact(k_t, k_n, Vector3(speed, 0.0, approach), table_.bead_bead).impulse;
    const Vector3 impulse =
        p.z() * n + (speed > 0.0 ? Vector3(p.x() / speed * slip) : Vector3(Vector3::Zero()));
    v1 += impulse / bodies.bead_mass;
    v2 -= impulse / bodies.bead_mass;
    const Vector3 turn =
        (-arm / bodies.bead_inertia) * n.cross(impulse); // arms -arm n and +arm n, impulses P and -P
    row(bodies.spin, pair.first) += turn;
    row(bodies.spin, pair.second) += turn;
    ++tallies.bead_bead;
}

void PairContacts::bead_rod(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const {
    const std::uint32_t index = bodies.rod_of[pair.second - bodies.beads];
    MovingRod& rod = bodies.rods[index];
    const Vector3& n = touch.normal;
    const double bead_arm = bodies.bead_radius - touch.depth / 2.0;
    const double rod_arm = bodies.radius[pair.second] - touch.depth / 2.0;
    const Vector3 arm1 = -bead_arm * n;
    const Vector3 arm2 = rod.clump().offset[sphere_of_rod(bodies, pair.second)] * rod.axis() + rod_arm * n;
    const Vector3 spin = row(bodies.spin, pair.first);
    const Vector3 relative = row(bodies.velocity, pair.first) + spin.cross(arm1) - rod.velocity_at(arm2);
    if (!(relative.dot(n) < 0.0))
        return;
    const Matrix3d inverse_mass = bead_inverse_mass(bodies, n, bead_arm) + rod.inverse_mass_at(arm2);
    const Vector3 impulse = impulse_along(n, inverse_mass, relative, table_.bead_rod);
    push(bodies, pair.first, impulse, arm1);
    rod.push(-impulse, arm2);
    tallies.impulse_on_beads[index] += impulse;
    ++tallies.bead_rod;
}

void PairContacts::rod_rod(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const {
    MovingRod& one = bodies.rods[bodies.rod_of[pair.first - bodies.beads]];
    MovingRod& two = bodies.rods[bodies.rod_of[pair.second - bodies.beads]];
    const Vector3& n = touch.normal;
    const Vector3 arm1 = one.clump().offset[sphere_of_rod(bodies, pair.first)] * one.axis() -
                         (bodies.radius[pair.first] - touch.depth / 2.0) * n;
    const Vector3 arm2 = two.clump().offset[sphere_of_rod(bodies, pair.second)] * two.axis() +
                         (bodies.radius[pair.second] - touch.depth / 2.0) * n;
    const Vector3 relative = one.velocity_at(arm1) - two.velocity_at(arm2);
    if (!(relative.dot(n) < 0.0) || (one.held() && two.held()))
        return;
    const Matrix3d inverse_mass = one.inverse_mass_at(arm1) + two.inverse_mass_at(arm2);
    const Vector3 impulse = impulse_along(n, inverse_mass, relative, table_.rod_rod);
    one.push(impulse, arm1);
    two.push(-impulse, arm2);
    ++tallies.rod_rod;
}

void PairContacts::keep_deepest(const Bodies& bodies, const Pair& pair, const Touch& touch) {
    const std::uint32_t one = bodies.rod_of[pair.first - bodies.beads],
                        two = bodies.rod_of[pair.second - bodies.beads];
    const auto known = std::find_if(rod_contacts_.begin(), rod_contacts_.end(), [&](const RodContact& c) {
        return c.first_rod == one && c.second_rod == two;
    });
    if (known == rod_contacts_.end())
        rod_contacts_.push_back({one, two, pair, touch});
    else if (touch.depth > known->touch.depth)
        *known = {one, two, pair, touch};
}

WorstOverlap PairContacts::resolve(Bodies& bodies, std::span<const Pair> overlapping, Tallies& tallies) {
    WorstOverlap worst;
    rod_contacts_.clear();
    tallies.overlaps += static_cast<std::int64_t>(overlapping.size());
    const auto look = [&](const Pair& pair) {
        const Touch found = touch(bodies, pair);
        const double radii = found.depth / std::min(bodies.radius[pair.first], bodies.radius[pair.second]);
        if (radii > worst.radii)
            worst = {radii, pair};
        return found;
    };
    for (std::size_t k = 0; k < overlapping.size(); ++k) {
        Pair pair = overlapping[k];
        Touch deepest = look(pair);
        if (bodies.is_bead(pair.second)) {
            bead_bead(bodies, pair, deepest, tallies);
            continue;
        }
        if (!bodies.is_bead(pair.first)) {
            keep_deepest(bodies, pair, deepest);
            continue;
        }
        // the contacts of a bead with the spheres of one rod follow each other
        const std::uint32_t rod = bodies.rod_of[pair.second - bodies.beads];
        for (; k + 1 < overlapping.size() && overlapping[k + 1].first == pair.first &&
               bodies.rod_of[overlapping[k + 1].second - bodies.beads] == rod;
             ++k) {
            const Touch next = look(overlapping[k + 1]);
            if (next.depth > deepest.depth) {
                deepest = next;
                pair = overlapping[k + 1];
            }
        }
        bead_rod(bodies, pair, deepest, tallies);
    }
    for (const RodContact& contact : rod_contacts_)
        rod_rod(bodies, contact.pair, contact.touch, tallies);
    tallies.max_overlap = std::max(tallies.max_overlap, worst.radii);
    return worst;
}

} // namespace rodwake::granular

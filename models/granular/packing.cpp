#include "packing.hpp"

#include "neighbours.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

constexpr double aim = 2e-4; // wanted free distance, of two radii: converges to `separation` in finite time
constexpr double skin_share = 0.6; // of a radius
constexpr double push = 0.55;      // share of the overlap that each of two beads gives way
constexpr double kick = 0.1;       // of a radius, when shaken
constexpr int sweeps_a_round = 2500, rounds = 4;

struct Place {
    double x, y, z;
};

class PushApart {
public:
    PushApart(Places& places, const Room& room)
        : places_(places), room_(room), skin_(skin_share * room.radius), diameter_(2.0 * room.radius) {}

    /// Largest overlap left.
    double settle(int sweeps) {
        double left = find();
        for (int k = 0; k < sweeps && left > 0.0; ++k) {
            left = sweep();
            if (furthest_move() > 0.5 * skin_)
                left = refresh(); // pairs that are not listed may have met
            else if (left == 0.0)
                left = largest_overlap(); // later pairs may have pushed earlier ones
        }
        return refresh();
    }

    void shake(RandomStream& random) {
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const double angle = random.uniform(0.0, 2.0 * M_PI),
                         step = kick * room_.radius * random.uniform();
            places_.x[i] += step * std::cos(angle);
            places_.y[i] += step * std::sin(angle);
            places_.z[i] = lifted(places_.z[i], kick * room_.radius * random.uniform(-1.0, 1.0));
        }
    }

private:
    struct Gap {
        double x, y, z, distance;
    };

    static Gap gap(const Place& a, const Place& b, const PeriodicBox& box) {
        const double x = nearest_image_rounded(a.x - b.x, box.x);
        const double y = nearest_image_rounded(a.y - b.y, box.y);
        const double z = a.z - b.z;
        return {x, y, z, std::sqrt(x * x + y * y + z * z)};
    }
    Gap gap_to_rod(Near pair) const {
        const Disc& disc = room_.rods[pair.other];
        return gap(p_[pair.bead], {disc.x, disc.y, disc.height}, room_.box);
    }
    double touching(Near pair) const { return room_.rods[pair.other].radius + room_.radius; }

    double lifted(double z, double step) const { return std::clamp(z + step, -room_.height, room_.height); }

    /// Pairs of the places as they are; the largest overlap.
    double find() {
        near_ = neighbours(places_, room_, skin_);
        p_.clear();
        for (const std::uint32_t i : near_.order)
            p_.push_back({places_.x[i], places_.y[i], places_.z[i]});
        found_at_ = p_;
        return largest_overlap();
    }

    /// The same after sweeps.
    double refresh() {
        for (std::size_t k = 0; k < p_.size(); ++k) {
            const std::uint32_t i = near_.order[k];
            places_.x[i] = p_[k].x;
            places_.y[i] = p_[k].y;
            places_.z[i] = p_[k].z;
        }
        return find();
    }

    /// In plan view since the pairs were found.
    double furthest_move() const {
        double square = 0.0;
        for (std::size_t k = 0; k < p_.size(); ++k) {
            const double x = p_[k].x - found_at_[k].x, y = p_[k].y - found_at_[k].y;
            square = std::max(square, x * x + y * y);
        }
        return std::sqrt(square);
    }

    double largest_overlap() const {
        double largest = 0.0;
        for (const Near pair : near_.beads)
            largest = std::max(largest, diameter_ * (1.0 + separation) -
                                            gap(p_[pair.bead], p_[pair.other], room_.box).distance);
        for (const Near pair : near_.rods)
            largest = std::max(largest, touching(pair) * (1.0 + separation) - gap_to_rod(pair).distance);
        return largest;
    }

    /// Every pair once; the largest overlap met on the way.
    double sweep() {
        double largest = part_beads();
        for (const Near pair : near_.rods)
            largest = std::max(largest, part_from_rod(pair));
        return largest;
    }

    /// All that is constant is local: the compiler could not know that places are not among the members.
    double part_beads() {
        const PeriodicBox box = room_.box;
        const double top = room_.height, wanted = diameter_ * (1.0 + aim),
                     enough = diameter_ * (1.0 + separation);
        const auto move = [top](Place& at, double x, double y, double z) {
            at = {at.x + x, at.y + y, std::clamp(at.z + z, -top, top)};
        };
        double largest = 0.0;
        for (const Near pair : near_.beads) {
            Place &a = p_[pair.bead], &b = p_[pair.other];
            const Gap g = gap(a, b, box);
            const double missing = wanted - g.distance;
            if (missing <= 0.0)
                continue;
            if (g.distance > 0.0) {
                const double share = push * missing / g.distance;
                move(a, share * g.x, share * g.y, share * g.z);
                move(b, -share * g.x, -share * g.y, -share * g.z);
            } else { // the same place: any direction will do
                move(a, push * missing, 0.0, 0.0);
            }
            largest = std::max(largest, enough - g.distance);
        }
        return largest;
    }

    /// In the plane only: a bead cannot leave a rod upwards.
    double part_from_rod(Near pair) {
        const Gap g = gap_to_rod(pair);
        const double wanted = touching(pair) * (1.0 + aim);
        if (g.distance >= wanted)
            return 0.0;
        const double in_plane = std::hypot(g.x, g.y),
                     missing = std::sqrt(wanted * wanted - g.z * g.z) - in_plane;
        Place& bead = p_[pair.bead];
        bead.x += in_plane > 0.0 ? missing * g.x / in_plane : missing;
        bead.y += in_plane > 0.0 ? missing * g.y / in_plane : 0.0;
        return std::max(0.0, touching(pair) * (1.0 + separation) - g.distance);
    }

    Places& places_;
    const Room& room_;
    double skin_, diameter_;
    Neighbours near_;
    std::vector<Place> p_, found_at_; ///< cell by cell; now, and when the pairs were found
};

} // namespace

double push_apart(Places& places, const Room& room, RandomStream random) {
    PushApart work(places, room);
    double left = work.settle(sweeps_a_round);
    for (int round = 1; round < rounds && left > 0.0; ++round) {
        work.shake(random);
        left = work.settle(sweeps_a_round);
    }
    return left;
}

} // namespace rodwake::granular
